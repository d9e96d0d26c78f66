"""Interfaces of the displacement fields whose sum is an exact solution."""

from typing import Protocol

import sympy as sp

from manufactured.body import Part
from manufactured.jet import Jet
from manufactured.modes import Modes
from manufactured.tensors import Array, Points, Tensors, Vectors


class ContributionAtPoints(Protocol):
    """The interface of a displacement field at fixed points, as a function of time.

    The methods return the displacement, its strain, or the gradient of the strain at a time; if ``rate`` is true, they
    return time derivatives. For n times, (n,), the results have n as an additional last axis. ``modes`` returns the
    strain at all times, as a sum of products.
    """

    def displacement(self, time: Array | complex, rate: bool = False) -> Vectors: ...
    def strain(self, time: Array | complex, rate: bool = False) -> Tensors: ...
    def strain_gradient(self, time: Array | complex, rate: bool = False) -> Array: ...
    def modes(self) -> Modes: ...


class Contribution(Protocol):
    """The interface of a displacement field on the body; ``at`` returns the field at fixed points, (d, ...)."""

    def at(self, x: Points) -> ContributionAtPoints: ...


class Face(Contribution, Protocol):
    """The interface of contact faces: displacement fields with contact on one part of Γ3, such as ``ContactFace``.

    Attributes:
        part: the part of Γ3.
        variables: the symbols of the coordinates s along the part.
        gap, initial_gap: the formulas of the gap w(s, t) and of the initial gap g(s), which is 0 in the paper.
        level: the formula of the level function ψ(s, t); the contact zone is {ψ ≥ 0}.
        gap_jet, level_jet: evaluate w and ψ with their derivatives.
        pressure_jet: evaluates the prescribed pressure with its derivatives; None if the pressure follows from the law.
        exponents_in: the formula from whose truncated powers the exponents of the strain at contact fronts are read
            off, for example the formula of the pressure.
        rough: the coordinates s at which the strain is singular or has a kink at all times.
    """

    @property
    def part(self) -> Part: ...
    @property
    def gap(self) -> sp.Expr: ...
    @property
    def initial_gap(self) -> sp.Expr: ...
    @property
    def level(self) -> sp.Expr: ...
    @property
    def rough(self) -> tuple[float, ...]: ...
    @property
    def variables(self) -> tuple[sp.Symbol, ...]: ...
    @property
    def gap_jet(self) -> Jet: ...
    @property
    def level_jet(self) -> Jet: ...
    @property
    def pressure_jet(self) -> Jet | None: ...
    @property
    def exponents_in(self) -> sp.Expr: ...
