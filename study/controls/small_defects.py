"""Defects of a given relative size in parts of Problem 5.1, for ``study.controls.sensitivity``."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from manufactured.body import Kind
from manufactured.law import Linear
from manufactured.tensors import Array, identity
from study.controls.control import Replacement, replaced
from study.controls.replacements import forces_times, solving
from study.fem.error_norm import ErrorNorm
from study.fem.independent import work_on
from study.fem.space import means
from study.statements.shared.experiment import Experiment


@dataclass(frozen=True)
class SmallDefect:
    """A deliberate defect: its name, and a function that puts it into an experiment with a relative size."""

    name: str
    apply: Callable[[Experiment, float], Experiment]


def loaded_by(more: Callable[[Experiment], Callable[[float], Array]]) -> Callable[[Experiment, float], Experiment]:
    """Return the defect that adds δ times a part of the load F to it."""

    def apply(setup: Experiment, amount: float) -> Experiment:
        part = more(setup)
        return _replaced(setup, "problem.load", lambda load: lambda time: load(time) + amount * part(time))

    return apply


def surface_load(setup: Experiment) -> Callable[[float], Array]:
    """Return the load of the tractions, t ↦ (f_2, v)_{L²(Γ2)}."""
    return cache(lambda time: work_on(Kind.LOADED, setup.solution, setup.space, time))


def body_force(setup: Experiment) -> Callable[[float], Array]:
    """Return the load of the body force, t ↦ (f_0, v)_H: the load (3.7) without the tractions."""
    load, surface = setup.problem.load, surface_load(setup)
    return lambda time: load(time) - surface(time)


def contact_load(setup: Experiment) -> Callable[[float], Array]:
    """Return the function t ↦ ∫_{Γ3} σ_ν v_ν, which Green's formula subtracts from (σ, ε(v))_Q."""
    v_norm = ErrorNorm(setup.solution, setup.space)
    amplitudes = v_norm._amplitudes
    return cache(lambda time: v_norm._contact_work(*(amplitudes(time, rate) for rate in (False, True))))


def slow_clock(setup: Experiment, amount: float) -> Experiment:
    """Deliberate defect: the load F((1 − δ) t) instead of F(t)."""
    return _replaced(setup, "problem.load", lambda load: lambda time: load((1 - amount) * time))


def wrong_start(setup: Experiment, amount: float) -> Experiment:
    """Deliberate defect: the initial displacement (1 + δ) Π^h u_0."""
    return _replaced(setup, "problem.u0", lambda u0: (1 + amount) * u0)


def wrong_forces(setup: Experiment, amount: float) -> Experiment:
    """Deliberate defect: the contact forces (1 + δ) λ; u^h is correct."""
    return _replaced(setup, "problem.solver", forces_times(1 + amount))


def _replaced(setup: Experiment, place: str, replacement: Replacement) -> Experiment:
    changed: Experiment = replaced(setup, place, replacement)
    return changed


def shear(tensor: Linear) -> Array:
    """Return the shear part 2μ I of an isotropic tensor."""
    return (tensor.matrix[0, 0] - tensor.matrix[0, 1]) * np.eye(len(tensor.matrix))


def bulk(tensor: Linear) -> Array:
    """Return the volumetric part λ 1 ⊗ 1 of an isotropic tensor."""
    unit = identity(tensor.dim)
    return tensor.matrix[0, 1] * np.multiply.outer(unit, unit)


def modulus(matrix: str, tensor: str, part: Callable[[Linear], Array]) -> Callable[[Experiment, float], Experiment]:
    """Return the defect that multiplies a modulus of A or G by 1 + δ in the matrix of the solver."""

    def apply(setup: Experiment, amount: float) -> Experiment:
        law: Linear = getattr(setup.solution.law, tensor)
        wrong = amount * setup.space.form(part(law), means(setup.space, law.factor))
        altered = solving(lambda problem: replaced(problem, matrix, lambda right: right + wrong))
        return _replaced(setup, "scheme", altered)

    return apply


START = SmallDefect("start u_0^h", wrong_start)
DEFECTS = (
    SmallDefect("load f", loaded_by(lambda setup: setup.problem.load)),
    SmallDefect("surface load f_2", loaded_by(surface_load)),
    SmallDefect("body force f_0", loaded_by(body_force)),
    SmallDefect("contact load", loaded_by(contact_load)),
    SmallDefect("contact force λ", wrong_forces),
    SmallDefect("μ of A", modulus("M", "A", shear)),
    SmallDefect("λ of A", modulus("M", "A", bulk)),
    SmallDefect("μ of G", modulus("reference", "G", shear)),
    SmallDefect("λ of G", modulus("reference", "G", bulk)),
    START,
    SmallDefect("time t", slow_clock),
)


def by_amount(name: str, amount: float) -> Replacement:
    """Return one of ``DEFECTS`` by its name, with a fixed size."""
    (defect,) = (each for each in DEFECTS if each.name == name)
    return lambda setup: defect.apply(setup, amount)
