"""Defects of any relative size δ in the data or solution of a contact problem, for ``study sensitivity``."""

from collections.abc import Callable
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

SmallDefect = Callable[[Experiment, float], Experiment]
"""Function of an experiment and a relative size; it returns the experiment with a defect of this size."""


def loaded_by(more: Callable[[Experiment], Callable[[float], Array]]) -> SmallDefect:
    """Return the defect that adds a wrong part to the load of an experiment.

    Parameters:
        more: function that returns, for an experiment, the wrong part as a function of time, t ↦ load vector (n_dofs,).
            The wrong part times the relative size of the defect is added to the load.
    """

    def apply(setup: Experiment, amount: float) -> Experiment:
        part = more(setup)
        return replaced(setup, "problem.load", lambda load: lambda time: load(time) + amount * part(time))

    return apply


def surface_load(setup: Experiment) -> Callable[[float], Array]:
    """Return the load vector of the tractions as a function of time, t ↦ (n_dofs,)."""
    return cache(lambda time: work_on(Kind.LOADED, setup.solution, setup.space, time))


def body_force(setup: Experiment) -> Callable[[float], Array]:
    """Return the load vector of the body force as a function of time, t ↦ (n_dofs,)."""
    load, surface = setup.problem.load, surface_load(setup)
    return lambda time: load(time) - surface(time)


def contact_load(setup: Experiment) -> Callable[[float], Array]:
    """Return the work of the contact pressure on each basis function as a function of time, t ↦ (n_dofs,).

    The load of a case follows from its exact stress σ: it is the work of σ on the strain of a displacement v, minus the
    work of the contact pressure on v_ν.
    """
    v_norm = ErrorNorm(setup.solution, setup.space)
    amplitudes = v_norm._amplitudes
    return cache(lambda time: v_norm._contact_work(*(amplitudes(time, rate) for rate in (False, True))))


def changed(place: str, change: Callable[[Any, float], Any]) -> SmallDefect:
    """Return the defect that makes an attribute of an experiment wrong.

    Parameters:
        place: name of the attribute, such as "problem.u0".
        change: function that returns the wrong value, given the correct one and the relative size of the defect.
    """
    return lambda setup, amount: replaced(setup, place, lambda right: change(right, amount))


def modulus(matrix: str, tensor: str, name: str) -> SmallDefect:
    """Return the defect that makes an elastic or viscous modulus too large.

    With the relative size δ, the solver uses 1 + δ times the modulus; the exact solution is unchanged.

    Parameters:
        matrix: the matrix that the solver builds from the tensor: "M" for the viscosity A, "reference" for the
            elasticity G.
        tensor: "A" or "G".
        name: "μ" for the shear modulus, "λ" for the first Lamé constant of the isotropic tensor.
    """

    def apply(setup: Experiment, amount: float) -> Experiment:
        law: Linear = getattr(setup.solution.law, tensor)
        unit, lam = identity(law.dim), law.matrix[0, 1]
        parts = {"μ": (law.matrix[0, 0] - lam) * np.eye(len(law.matrix)), "λ": lam * np.multiply.outer(unit, unit)}
        wrong = amount * setup.space.form(parts[name], means(setup.space, law.factor))
        altered = solving(lambda problem: replaced(problem, matrix, lambda right: right + wrong))
        return replaced(setup, "scheme.march", altered)

    return apply


START = "start u_0^h"
"""Name of the defect that multiplies the initial displacement."""
DEFECTS: dict[str, SmallDefect] = {
    "load f": loaded_by(lambda setup: setup.problem.load),
    "surface load f_2": loaded_by(surface_load),
    "body force f_0": loaded_by(body_force),
    "contact load": loaded_by(contact_load),
    "contact force λ": changed("problem.solver", lambda right, amount: forces_times(1 + amount)(right)),
    "μ of A": modulus("M", "A", "μ"),
    "λ of A": modulus("M", "A", "λ"),
    "μ of G": modulus("reference", "G", "μ"),
    "λ of G": modulus("reference", "G", "λ"),
    START: changed("problem.u0", lambda u0, amount: (1 + amount) * u0),
    "time t": changed("problem.load", lambda load, amount: lambda time: load((1 - amount) * time)),
}


def by_amount(name: str, amount: float) -> Replacement:
    """Return a function that gives an experiment the named defect of ``DEFECTS`` with a fixed relative size."""
    return lambda setup: DEFECTS[name](setup, amount)
