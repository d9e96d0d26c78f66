"""An exact solution {u, σ} of Problem 2.1, with the data f_0, f_2, u_0 that belong to it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval

from manufactured.body import Body, Kind, Part
from manufactured.contact import ContactFace
from manufactured.law import KelvinVoigt
from manufactured.memory import Memory
from manufactured.tensors import Array, Points, Tensors, Vectors, basis, traction


@dataclass(frozen=True, eq=False)
class ExactSolution:
    """u = Σ_i (lifting of the contact data on Γ3,i), σ = A ε(u̇) + G ε(u), f_0 = −Div σ, f_2 = σν.

    Attributes:
        body: Ω, Γ1, Γ2, Γ3, T.
        law: A and G.
        faces: one entry per piece of Γ3, in the order of ``body.of(Kind.CONTACT)``; the lifting of
            one face must vanish near the others and on Γ1.

    Raises:
        ValueError: the law's dimension is not the body's, or the faces are not the pieces of Γ3.
    """

    body: Body
    law: KelvinVoigt
    faces: tuple[ContactFace, ...]

    def __post_init__(self) -> None:
        if self.law.dim != self.body.dim:
            raise ValueError(f"the law acts in dimension {self.law.dim}, the body has dimension {self.body.dim}")
        pieces = self.body.of(Kind.CONTACT)
        if [face.part for face in self.faces] != list(pieces):
            raise ValueError(f"the body has {len(pieces)} piece(s) Γ3,i, so give one contact face for each, in order")
        for face in self.faces:
            deepest = float(face.part.coordinates(self.body.vertices)[1].max())
            if deepest > face.depth * (1 + 1e-12) and abs(polyval(1.0, polyder(face.cutoff))) > 1e-12:
                raise ValueError(
                    f"the body is {deepest:g} deep, the lifting ends at {face.depth:g} with a kink (φ'(1) ≠ 0): "
                    "take the depth of Γ1 or a cut-off with φ'(1) = 0 such as HERMITE"
                )

    def at(self, x: Points) -> Fields:
        """The solution at fixed points of Ω̄, (d, ...): evaluate it at as many times as needed."""
        return Fields(self, x)

    def on(self, face: ContactFace, s: Array) -> FaceFields:
        """The solution at fixed points of a contact face."""
        return FaceFields(face, self.law, s, self.body.T)


class FaceFields:
    """w, p and the contact zone at fixed points s (d−1, ...) of one face.

    There ε = q n⊗n, so p = −(A (q̇ n⊗n) + G(q n⊗n))·(n⊗n) needs no lifting.
    """

    def __init__(self, face: ContactFace, law: KelvinVoigt, s: Array, T: float) -> None:
        self.face, self.law, self.s, self.T = face, law, s, T
        self.normal = np.tensordot(basis(law.dim), np.multiply.outer(face.part.normal, face.part.normal))
        self._strain = face.strain.at(s)

    def pressure(self, time: float) -> Array:
        """p = −σ_ν, (...)."""
        zero = (0,) * len(self.s)
        q, rate = (np.multiply.outer(self.normal, values[zero]) for values in self._strain(time, 0))
        return -np.tensordot(self.normal, self.law.stress(rate, q), axes=1)

    def stated_pressure(self, time: float) -> Array:
        """p as it was prescribed, where it was; else as the law gives it, (...)."""
        strain = self.face.strain
        if isinstance(strain, Memory):
            return strain.pressure_jet(self.s, time)[(0,) * len(self.s)]
        return self.pressure(time)

    def stress_scale(self) -> float:
        """The size of stresses that the largest strains on the face would cause, for tolerances."""
        strains = [abs(self._strain(t, 0)[0][(0,) * len(self.s)]).max() for t in np.linspace(0, self.T, 9)]
        gaps = [abs(self.gap(t)).max() for t in np.linspace(0, self.T, 9)]
        return (self.law.A.lipschitz + self.law.G.lipschitz) * float(max(*strains, *gaps, 0.0))

    def traces(self, time: float) -> tuple[Array, ...]:
        """w, ∂_s w, q and their derivatives ∂_s w, ∂_s² w, ∂_s q along a face of one dimension, (...) each."""
        w, q = self.face.gap_jet(self.s, time, 2), self._strain(time, 1)[0]
        return w[0,], w[1,], q[0,], w[1,], w[2,], q[1,]

    def gap(self, time: float) -> Array:
        """w = −u_ν, (...)."""
        return self.face.gap_jet(self.s, time)[(0,) * len(self.s)]

    def level(self, time: float) -> Array:
        """ψ, (...): the contact zone is {ψ ≥ 0}."""
        return self.face.level_jet(self.s, time)[(0,) * len(self.s)]


class Fields:
    """The fields of an exact solution at fixed points x (d, ...), as functions of time."""

    def __init__(self, solution: ExactSolution, x: Points) -> None:
        self.law = solution.law
        self._liftings = [face.at(x) for face in solution.faces]

    @cached_property
    def _first(self) -> Array:
        return basis(self.law.dim)

    def displacement(self, time: complex) -> Vectors:
        """u, (d, ...)."""
        return _sum([lifting.displacement(time) for lifting in self._liftings])

    def velocity(self, time: complex) -> Vectors:
        """u̇, (d, ...)."""
        return _sum([lifting.displacement(time, rate=True) for lifting in self._liftings])

    def strain(self, time: complex) -> Tensors:
        """ε(u), (D, ...)."""
        return _sum([lifting.strain(time) for lifting in self._liftings])

    def strain_rate(self, time: complex) -> Tensors:
        """ε(u̇), (D, ...)."""
        return _sum([lifting.strain(time, rate=True) for lifting in self._liftings])

    def strain_gradient(self, time: complex) -> Array:
        """∂_j ε(u), (D, d, ...)."""
        return _sum([lifting.strain_gradient(time) for lifting in self._liftings])

    def stress(self, time: complex) -> Tensors:
        """σ = A ε(u̇) + G ε(u), (2.1), (D, ...)."""
        return self.law.stress(self.strain_rate(time), self.strain(time))

    def body_force(self, time: complex) -> Vectors:
        """f_0 = −Div σ, (2.2): −∂_j σ_ij with ∂_j σ = A ∂_j ε̇ + G'(ε)[∂_j ε], (d, ...)."""
        strain, gradient = self.strain(time), self.strain_gradient(time)
        rate_gradient = _sum([lifting.strain_gradient(time, rate=True) for lifting in self._liftings])
        return -_sum(
            [
                np.tensordot(
                    self._first[:, :, j], self.law.A(rate) + self.law.G.derivative(strain, change), ((0,), (0,))
                )
                for j, (rate, change) in enumerate(
                    zip(np.moveaxis(rate_gradient, 1, 0), np.moveaxis(gradient, 1, 0), strict=True)
                )
            ]
        )

    def surface_load(self, part: Part, time: complex) -> Vectors:
        """f_2 = σν, (2.4), for points on ``part``, (d, ...)."""
        return traction(self.stress(time), part.normal)


def _sum(terms: list[Array]) -> Array:
    total = terms[0]
    for term in terms[1:]:
        total = total + term
    return total
