"""Imports all public names of the package ``manufactured`` from the modules that define them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from manufactured.arguments import checked
from manufactured.body import Body, BodyError, Kind, Part, box, polygon, unit_square
from manufactured.case import Case, CaseError
from manufactured.catalogue import catalogue, named
from manufactured.contact import ContactFace
from manufactured.data import Data, LoadError
from manufactured.exact import ExactSolution, Fields
from manufactured.face_strain import Memory, Prescribed
from manufactured.factor import Factor, x1, x2, x3
from manufactured.law import (
    Combined,
    DeviatoricBall,
    FrobeniusBall,
    Indefinite,
    KelvinVoigt,
    LawError,
    Linear,
    NonSymmetric,
    Yield,
    isotropic,
    isotropic_matrix,
)
from manufactured.profile import HERMITE, PARABOLA, QUARTIC, Profile, cutoff, layered, slab
from manufactured.regularity import Regularity
from manufactured.self_proof import SelfProofError, examine, gradient, prove, shifted_fields
from manufactured.singular import Monomial, SingularFace, SingularField, TravellingField, kolosov
from manufactured.static import Static, plane_strain, plane_stress, static
from manufactured.symbols import FormulaError, pos, s, s1, s2, t
from manufactured.tensors import Array, Tensors, Vectors, traction


@dataclass(frozen=True, eq=False)
class Evaluation:
    """The fields of an exact solution at given points, (d, ...), and one time; tensors are Mandel vectors, (D, ...).

    Attributes:
        displacement: the displacement u, (d, ...).
        velocity: the velocity u̇, (d, ...).
        gradient: the displacement gradient ∂_j u_i, (d, d, ...), computed by the complex step, which is exact up to
            rounding.
        strain: the strain ε(u), (D, ...).
        strain_rate: the strain rate ε(u̇), (D, ...).
        stress: the stress σ = A ε(u̇) + G ε(u), (D, ...).
        body_force: the body force f_0 = −Div σ, (d, ...).
    """

    displacement: Vectors
    velocity: Vectors
    gradient: Array
    strain: Tensors
    strain_rate: Tensors
    stress: Tensors
    body_force: Vectors

    def surface_load(self, part: Part) -> Vectors:
        """Return the traction σν at the points, which must lie on the given boundary part, (d, ...).

        On Γ2 it is the load f_2, on Γ3 it is −p ν with the contact pressure p.
        """
        return traction(self.stress, part.normal)


@checked(ValueError)
def evaluate(of: Case | ExactSolution, x: ArrayLike, time: float) -> Evaluation:
    """Return all fields of a case or exact solution at points x, (d, ...), and a time.

    For many times, use ``solution.at(x)``, which processes the points only once.

    >>> import numpy as np
    >>> from manufactured import Kind, evaluate, named
    >>> case = named("advance-recede")
    >>> found = evaluate(case, [[0.2, 0.6], [0.5, 0.0]], 0.5)  # the points (0.2, 0.5) and (0.6, 0)
    >>> found.displacement.shape, found.gradient.shape, found.stress.shape, found.body_force.shape
    ((2, 2), (2, 2, 2), (3, 2), (2, 2))
    >>> bool(np.allclose(found.gradient[0, 0], found.strain[0]))
    True
    >>> (floor,) = case.solution.body.of(Kind.CONTACT)
    >>> bool(abs(evaluate(case, [[0.6], [0.0]], 0.5).surface_load(floor)[0]).max() < 1e-12)  # no friction
    True

    Args:
        of: the case or the exact solution.
        x: the points, (d, ...): first the list of all x1, then the list of all x2, in 3D then the list of all x3.
        time: the time, from 0 to T.

    Raises:
        ValueError: x has a wrong shape, a point lies outside the body, or the time lies outside [0, T].
    """
    solution = of.solution if isinstance(of, Case) else of
    fields = solution.at(x)
    steps = shifted_fields(solution, np.asarray(x, float))
    return Evaluation(
        fields.displacement(time),
        fields.velocity(time),
        gradient(steps, Fields.displacement, time),
        fields.strain(time),
        fields.strain_rate(time),
        fields.stress(time),
        fields.body_force(time),
    )


__all__ = [
    "HERMITE",
    "PARABOLA",
    "QUARTIC",
    "Body",
    "BodyError",
    "Case",
    "CaseError",
    "Combined",
    "ContactFace",
    "Data",
    "DeviatoricBall",
    "Evaluation",
    "ExactSolution",
    "Factor",
    "FormulaError",
    "FrobeniusBall",
    "Indefinite",
    "KelvinVoigt",
    "Kind",
    "LawError",
    "Linear",
    "LoadError",
    "Memory",
    "Monomial",
    "NonSymmetric",
    "Part",
    "Prescribed",
    "Profile",
    "Regularity",
    "SelfProofError",
    "SingularFace",
    "SingularField",
    "Static",
    "TravellingField",
    "Yield",
    "box",
    "catalogue",
    "cutoff",
    "evaluate",
    "examine",
    "isotropic",
    "isotropic_matrix",
    "kolosov",
    "layered",
    "named",
    "plane_strain",
    "plane_stress",
    "polygon",
    "pos",
    "prove",
    "s",
    "s1",
    "s2",
    "slab",
    "static",
    "t",
    "unit_square",
    "x1",
    "x2",
    "x3",
]
