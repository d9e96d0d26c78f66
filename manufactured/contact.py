"""Exact contact by lifting Cauchy data: gap + pressure on a face → displacement in the body.

Near a flat piece of Γ3 use s along the face, y = distance into the body, n = −ν. Given a gap
w(s, t) ≥ 0 (= −u_ν) and a pressure p(s, t) ≥ 0 (= −σ_ν) with w p = 0, let q be the normal strain
that p produces (``manufactured.memory``) and

    u_s = −y ∇_s w φ(y/ℓ),     u_n = (w + y q) φ(y/ℓ),

with a polynomial φ on [0, 1], zero beyond, φ(0) = 1, φ'(0) = 0, φ(1) = 0.

On y = 0: u_n = w, u_s = 0, ε_ss = 0, ε_sn = (−∇_s w + ∇_s w)/2 = 0, ε_nn = q. A law that does not
couple nn with sn then gives σ_τ = 0 and σ_ν = −p, so (2.5) holds exactly, whatever the zone.
The solution vanishes from depth ℓ on, so (2.3) holds on a Γ1 at that depth.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy as sp
from numpy.polynomial.polynomial import polyder, polyval

from manufactured.body import Part
from manufactured.law import KelvinVoigt, LawError, Linear
from manufactured.memory import Memory, NormalStrain
from manufactured.symbols import FormulaError, Jet, Values, s
from manufactured.tensors import Array, Points, Tensors, Vectors, pairs, rotation

HERMITE = (1.0, 0.0, -3.0, 2.0)
"""φ(η) = (1 − η)²(1 + 2η): φ(1) = φ'(1) = 0, so the lifting may end inside the body; no traction on Γ1."""

PARABOLA = (1.0, 0.0, -1.0)
"""φ(η) = 1 − η²: φ(1) = 0 only, for a Γ1 exactly at depth ℓ, which then carries a traction."""


@dataclass(frozen=True, eq=False)
class ContactFace:
    """The contact data on one piece of Γ3 and their lifting into the body.

    Attributes:
        part: the piece Γ3,i.
        gap: w(s, t), a SymPy formula of ``symbols.s`` and ``symbols.t``.
        strain: q(s, t).
        level: ψ(s, t); the contact zone is stated to be {ψ ≥ 0}.
        depth: ℓ.
        cutoff: coefficients of φ, lowest first.
        rough: the coordinates s at which the strain is singular or kinked for all times, so that
            quadrature can split cells there.
    """

    part: Part
    gap: sp.Expr
    strain: NormalStrain
    level: sp.Expr
    depth: float = 1.0
    cutoff: tuple[float, ...] = HERMITE
    rough: tuple[float, ...] = ()
    variables: tuple[sp.Symbol, ...] = (s,)

    def __post_init__(self) -> None:
        # Compiled here, so that a formula that cannot be used is refused where it is written.
        self.gap_rate_jet, self.level_jet  # noqa: B018
        if not np.isfinite(self.rough).all():
            raise FormulaError(f"the rough points {self.rough} are not all numbers")

    @classmethod
    def linear(
        cls,
        part: Part,
        law: KelvinVoigt,
        T: float,
        gap: sp.Expr,
        pressure: sp.Expr,
        level: sp.Expr,
        initial: sp.Expr | None = None,
        depth: float = 1.0,
        cutoff: tuple[float, ...] = HERMITE,
        rough: tuple[float, ...] = (),
    ) -> ContactFace:
        """The face for a linear law, where gap and pressure say everything (``memory.Memory``).

        Raises:
            LawError: G is not linear; give q with ``memory.Prescribed`` instead.
            FormulaError: the pressure is not piecewise polynomial in t.
        """
        if not isinstance(law.G, Linear):
            raise LawError(f"{law.name}: only a linear G turns a pressure into a strain; prescribe the strain")
        a, g = law.A.normal_modulus(part.normal), law.G.normal_modulus(part.normal)
        return cls(part, gap, Memory(sp.sympify(pressure), a, g, T, initial), level, depth, cutoff, rough)

    @cached_property
    def gap_jet(self) -> Jet:
        return Jet(sp.sympify(self.gap), self.variables)

    @cached_property
    def gap_rate_jet(self) -> Jet:
        return self.gap_jet.rate()

    @cached_property
    def level_jet(self) -> Jet:
        return Jet(sp.sympify(self.level), self.variables)

    def at(self, x: Points) -> Lifting:
        """The lifted fields at fixed points of Ω̄, (d, ...)."""
        return Lifting(self, x)


class Lifting:
    """u, u̇, ε, ε̇ and their gradients at fixed points; what time does not change is kept."""

    def __init__(self, face: ContactFace, x: Points) -> None:
        self.face = face
        self.frame = face.part.frame
        self.rotation = rotation(self.frame)
        self.s, y = face.part.coordinates(x)
        self.strain_on_face = face.strain.at(self.s)
        eta, ell = y / face.depth, face.depth
        phi = [np.where(np.real(eta) < 1, polyval(eta, polyder(face.cutoff, k)), 0.0) / ell**k for k in range(3)]
        # f[k] is the k-th derivative of φ(y/ℓ), g[k] that of y φ(y/ℓ).
        self.f = phi
        self.g = [y * phi[0]] + [y * phi[k] + k * phi[k - 1] for k in range(1, 3)]

    def traces(self, time: complex, rate: bool, order: int) -> tuple[Values, Values]:
        """(w, q), or (ẇ, q̇), with derivatives along the face: w up to order+1, q up to order."""
        gap = self.face.gap_rate_jet if rate else self.face.gap_jet
        return gap(self.s, time, order + 1), self.strain_on_face(time, order)[rate]

    def displacement(self, time: complex, rate: bool = False) -> Vectors:
        """u (or u̇) in global axes, (d, ...)."""
        w, q = self.traces(time, rate, 0)
        zero, first = _indices(len(self.s))[:2]
        local = [-w[i] * self.g[0] for i in first] + [w[zero] * self.f[0] + q[zero] * self.g[0]]
        return np.tensordot(self.frame, np.array(local), axes=1)

    def strain(self, time: complex, rate: bool = False) -> Tensors:
        """ε(u) (or ε(u̇)) in global axes, Mandel (D, ...)."""
        w, q = self.traces(time, rate, 1)
        return np.tensordot(self.rotation, self._local(w, q, (0,) * len(self.s), 0), axes=1)

    def strain_gradient(self, time: complex, rate: bool = False) -> Array:
        """∂_j ε(u) (or of u̇) in global axes, (D, d, ...); exists almost everywhere."""
        w, q = self.traces(time, rate, 2)
        zero, first = _indices(len(self.s))[:2]
        local = np.array([self._local(w, q, i, 0) for i in first] + [self._local(w, q, zero, 1)])
        rotated = np.tensordot(self.frame, np.tensordot(self.rotation, local, axes=([1], [1])), axes=([1], [1]))
        return np.moveaxis(rotated, 0, 1)

    def _local(self, w: Values, q: Values, along: tuple[int, ...], into: int) -> Tensors:
        """∂_s^along ∂_y^into of the local strain, for into ∈ {0, 1}, in the axes (s, n)."""
        variables = len(self.s)
        first = _indices(variables)[1]

        def d(*steps: tuple[int, ...]) -> tuple[int, ...]:
            return tuple(map(sum, zip(along, *steps, strict=True)))

        f, g = self.f, self.g
        n = variables
        # f[into+1] needs the second derivative of φ at most.
        shear = f[into] - g[into + 1]
        root = np.sqrt(0.5)
        components = []
        for i, j in pairs(variables + 1):
            if i == j == n:
                components.append(w[d()] * f[into + 1] + q[d()] * g[into + 1])
            elif j == n:
                components.append(root * (w[d(first[i])] * shear + q[d(first[i])] * g[into]))
            else:
                components.append((-1.0 if i == j else -2 * root) * w[d(first[i], first[j])] * g[into])
        return np.array(components)


def _indices(variables: int) -> tuple[tuple[int, ...], list[tuple[int, ...]]]:
    """The multi-index of the value and those of the first derivatives, coordinate by coordinate."""
    unit = np.eye(variables, dtype=int)
    return (0,) * variables, [tuple(int(i) for i in row) for row in unit]
