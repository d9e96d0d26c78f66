"""Deliberate defects with a given relative size δ in parts of Problem 5.1, for ``study.controls.sensitivity``."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

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
    """A deliberate defect of any relative size.

    Attributes:
        name: name of the defect.
        apply: function of an experiment and the relative size, which returns the experiment with the defect.
    """

    name: str
    apply: Callable[[Experiment, float], Experiment]


def loaded_by(more: Callable[[Experiment], Callable[[float], Array]]) -> Callable[[Experiment, float], Experiment]:
    """Return the function ``SmallDefect.apply`` for a load F with an additional part.

    Parameters:
        more: function that returns the part, t ↦ (n_dofs,), for an experiment; δ times the part is added to F.
    """

    def apply(setup: Experiment, amount: float) -> Experiment:
        part = more(setup)
        return replaced(setup, "problem.load", lambda load: lambda time: load(time) + amount * part(time))

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


def changed(place: str, change: Callable[[Any, float], Any]) -> Callable[[Experiment, float], Experiment]:
    """Return the function ``SmallDefect.apply`` that changes an attribute of the experiment.

    Parameters:
        place: the attribute, as for ``replaced``.
        change: function that returns the wrong value, given the correct one and δ.
    """
    return lambda setup, amount: replaced(setup, place, lambda right: change(right, amount))


def shear(tensor: Linear) -> Array:
    """Return the shear part 2μ I of an isotropic tensor."""
    return (tensor.matrix[0, 0] - tensor.matrix[0, 1]) * np.eye(len(tensor.matrix))


def bulk(tensor: Linear) -> Array:
    """Return the volumetric part λ 1 ⊗ 1 of an isotropic tensor."""
    unit = identity(tensor.dim)
    return tensor.matrix[0, 1] * np.multiply.outer(unit, unit)


def modulus(matrix: str, tensor: str, part: Callable[[Linear], Array]) -> Callable[[Experiment, float], Experiment]:
    """Return the function ``SmallDefect.apply`` that multiplies a modulus of A or G by 1 + δ in the solver.

    Parameters:
        matrix: the matrix of the problem, "M" or "reference".
        tensor: "A" or "G".
        part: function that returns the part of the tensor that belongs to the modulus, (D, D).
    """

    def apply(setup: Experiment, amount: float) -> Experiment:
        law: Linear = getattr(setup.solution.law, tensor)
        wrong = amount * setup.space.form(part(law), means(setup.space, law.factor))
        altered = solving(lambda problem: replaced(problem, matrix, lambda right: right + wrong))
        return replaced(setup, "scheme", altered)

    return apply


START = SmallDefect("start u_0^h", changed("problem.u0", lambda u0, amount: (1 + amount) * u0))
DEFECTS = (
    SmallDefect("load f", loaded_by(lambda setup: setup.problem.load)),
    SmallDefect("surface load f_2", loaded_by(surface_load)),
    SmallDefect("body force f_0", loaded_by(body_force)),
    SmallDefect("contact load", loaded_by(contact_load)),
    SmallDefect("contact force λ", changed("problem.solver", lambda right, amount: forces_times(1 + amount)(right))),
    SmallDefect("μ of A", modulus("M", "A", shear)),
    SmallDefect("λ of A", modulus("M", "A", bulk)),
    SmallDefect("μ of G", modulus("reference", "G", shear)),
    SmallDefect("λ of G", modulus("reference", "G", bulk)),
    START,
    SmallDefect("time t", changed("problem.load", lambda load, amount: lambda time: load((1 - amount) * time))),
)


def by_amount(name: str, amount: float) -> Replacement:
    """Return the named defect of ``DEFECTS`` with a fixed relative size, as a replacement for a control."""
    (defect,) = (each for each in DEFECTS if each.name == name)
    return lambda setup: defect.apply(setup, amount)
