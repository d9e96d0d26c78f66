"""The contact data on one piece of Γ3."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy as sp

from manufactured.body import Part
from manufactured.contact.lifting import Lifting
from manufactured.face_strain import Coupled, FaceStrain, Memory, relaxation_rate
from manufactured.law import KelvinVoigt, LawError, Linear
from manufactured.profile import Profile, cutoff
from manufactured.symbols import FormulaError, Jet, s, s1, s2
from manufactured.tensors import Points

VARIABLES = {2: (s,), 3: (s1, s2)}
"""The coordinates along a face of a body of dimension d."""


PLAIN = cutoff()
"""The usual profile, φ = HERMITE down to depth 1."""


@dataclass(frozen=True, eq=False)
class ContactFace:
    """The contact data on one piece of Γ3 and their lifting into the body.

    Attributes:
        part: the piece Γ3,i.
        gap: w(s, t), a SymPy formula of ``symbols.s`` (of s1 and s2 in 3D) and ``symbols.t``.
        strain: (q, r)(s, t).
        level: ψ(s, t); the contact zone is stated to be {ψ ≥ 0}.
        profile: how the data fade into the body.
        rough: the coordinates s at which the strain is singular or kinked for all times, so that
            quadrature can split cells there.
    """

    part: Part
    gap: sp.Expr
    strain: FaceStrain
    level: sp.Expr
    profile: Profile = PLAIN
    rough: tuple[float, ...] = ()

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
        profile: Profile = PLAIN,
        rough: tuple[float, ...] = (),
    ) -> ContactFace:
        """The face for a linear law, where gap and pressure say everything (``face_strain.Memory``).

        Raises:
            LawError: G is not linear (give q with ``face_strain.Prescribed`` instead), or ``initial`` is
                given for a law that couples nn with sn.
            FormulaError: the pressure is not piecewise polynomial in t.
        """
        if not isinstance(law.G, Linear):
            raise LawError(f"{law.name}: only a linear G turns a pressure into a strain; prescribe the strain")
        pressure, variables = sp.sympify(pressure), VARIABLES[law.dim]
        viscous, elastic = law.A.face_block(part.frame), law.G.face_block(part.frame)
        scale, stiffness = (tensor.factor.along(part.start, part.frame[:, :-1], variables) for tensor in (law.A, law.G))
        if all(abs(block[0, 1:]).max() <= 1e-14 * abs(block).max() for block in (viscous, elastic)):
            a, g = float(viscous[0, 0]) * scale, float(elastic[0, 0]) * stiffness
            return cls(part, gap, Memory(pressure, a, g, T, initial, variables), level, profile, rough)
        if initial is not None:
            raise LawError(f"{law.name} couples nn with sn: it starts in elastic equilibrium, leave ``initial`` out")
        coupled = Coupled.of(pressure, viscous, relaxation_rate(stiffness, scale) * elastic, scale, T, variables)
        return cls(part, gap, coupled, level, profile, rough)

    @property
    def variables(self) -> tuple[sp.Symbol, ...]:
        """The coordinates along the face."""
        return VARIABLES[len(self.part.frame)]

    @cached_property
    def gap_jet(self) -> Jet:
        return Jet(sp.sympify(self.gap), self.variables)

    @cached_property
    def gap_rate_jet(self) -> Jet:
        return self.gap_jet.rate()

    @cached_property
    def level_jet(self) -> Jet:
        return Jet(sp.sympify(self.level), self.variables)

    @cached_property
    def pressure_jet(self) -> Jet | None:
        """The jet of p as it was prescribed, None if it follows from the law."""
        stated = getattr(self.strain, "pressure", None)
        return None if stated is None else Jet(stated, self.variables)

    @property
    def exponents_in(self) -> sp.Expr:
        """The formula with the truncated powers of the pressure side."""
        return self.strain.formula

    def at(self, x: Points) -> Lifting:
        """The lifted fields at fixed points of Ω̄, (d, ...)."""
        return Lifting(self, x)
