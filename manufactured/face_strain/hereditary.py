"""q of a linear law: the hereditary integral of the pressure."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import sympy as sp

from manufactured.face_strain.contact_times import PressureTerm, smooth_branch
from manufactured.face_strain.integrals import MemoryAtPoints
from manufactured.face_strain.strain_on_face import StrainAtPoints, relaxation_rate
from manufactured.symbols import Jet, s, t
from manufactured.tensors import Array


@dataclass(frozen=True, eq=False)
class Memory:
    """q of a linear law, to round-off for a pressure that is piecewise polynomial in t.

    Every term of the expanded pressure is θ(s, t)·∏ pos(ψ_i(s, t), m_i) with θ and the ψ_i that
    move polynomial in t and, for these, integer m_i ≥ 2. At each s the roots of the ψ_i split
    [0, T] into intervals of contact, on which p is a polynomial P(s, ·) and the hereditary integral
    is known in closed form (``convolution``). Since p vanishes where a moving contact begins and ends,
    derivatives along the face pass under the integral: ∂_s^i q is the same expression with ∂_s^i P.

    Attributes:
        pressure: p(s, t).
        viscosity, elasticity: a and g, positive numbers, or formulas of s with a constant ratio.
        T: final time.
        initial: q_0(s); without it −p(s, 0)/g, the elastic equilibrium.

    Raises:
        FormulaError: the pressure is not of this form.
    """

    pressure: sp.Expr
    viscosity: sp.Expr | float
    elasticity: sp.Expr | float
    T: float
    initial: sp.Expr | None = None
    variables: tuple[sp.Symbol, ...] = (s,)

    def __post_init__(self) -> None:
        self.decay  # refused where it is written, not where it is used  # noqa: B018

    @property
    def formula(self) -> sp.Expr:
        """The pressure and the initial strain, from which q is computed."""
        return self.pressure + (0 if self.initial is None else self.initial)

    @cached_property
    def decay(self) -> float:
        """λ = g/a."""
        return relaxation_rate(self.elasticity, self.viscosity)

    @property
    def source(self) -> sp.Expr:
        """p/a."""
        return self.pressure / self.viscosity

    @cached_property
    def start(self) -> Jet:
        """The jet of q_0."""
        elastic = -self.pressure.subs(t, 0) / self.elasticity
        return Jet(elastic if self.initial is None else self.initial, self.variables)

    @cached_property
    def source_jet(self) -> Jet:
        """The jet of p/a."""
        return Jet(self.source, self.variables)

    @cached_property
    def terms(self) -> tuple[PressureTerm, ...]:
        """p/a, terms with the same moving fronts together."""
        branches: dict[tuple[sp.Expr, ...], sp.Expr] = {}
        for term in sp.Add.make_args(sp.expand(self.pressure)):
            fronts, branch = smooth_branch(term, self.variables)
            branches[fronts] = branches.get(fronts, sp.Integer(0)) + branch / self.viscosity
        return tuple(
            PressureTerm.of(fronts, branch, self.variables, self.decay)
            for fronts, branch in branches.items()
            if branch != 0
        )

    def at(self, points: Array) -> StrainAtPoints:
        return MemoryAtPoints(self, points)
