"""Interfaces of the displacement fields whose sum is an exact solution."""

from __future__ import annotations

from typing import Protocol

import sympy as sp

from manufactured.body import Part
from manufactured.jet import Jet
from manufactured.modes import Modes
from manufactured.tensors import Array, Points, Tensors, Vectors


class ContributionAtPoints(Protocol):
    """The interface of a displacement field at fixed points, as a function of time.

    Its methods return the field, its strain, or the gradient of its strain. If ``rate`` is true, they return the time
    derivatives. For n times, (n,), the results have n as an additional last axis.
    """

    def displacement(self, time: Array | complex, rate: bool = False) -> Vectors: ...
    def strain(self, time: Array | complex, rate: bool = False) -> Tensors: ...
    def strain_gradient(self, time: Array | complex, rate: bool = False) -> Array: ...
    def modes(self) -> Modes: ...


class Contribution(Protocol):
    """The interface of a displacement field on the body; ``at`` returns the field at fixed points, (d, ...)."""

    def at(self, x: Points) -> ContributionAtPoints: ...


class Face(Contribution, Protocol):
    """The interface of a displacement field with contact on one part of Γ3, such as ``ContactFace``.

    Attributes:
        gap, level: the formulas of the gap w and of the level function ψ, where {ψ ≥ 0} is the contact zone.
            ``gap_jet`` and ``level_jet`` evaluate them with their derivatives.
        initial_gap: the formula of the initial gap g; 0 in the paper.
        pressure_jet: evaluates the prescribed pressure; None if the pressure follows from the law.
        exponents_in: a formula whose truncated powers show how smooth the strain is near a front.
        rough: the coordinates s at which the strain is singular at all times.
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
