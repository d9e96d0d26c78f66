"""The displacement fields whose sum is a solution."""

from __future__ import annotations

from typing import Protocol

import sympy as sp

from manufactured.body import Part
from manufactured.jet import Jet
from manufactured.modes import Modes
from manufactured.tensors import Array, Points, Tensors, Vectors


class ContributionAtPoints(Protocol):
    """A displacement field at fixed points, as a function of time; with ``rate`` its time derivative.

    Times (n,) give arrays with one axis more, the last one.
    """

    def displacement(self, time: Array | complex, rate: bool = False) -> Vectors: ...
    def strain(self, time: Array | complex, rate: bool = False) -> Tensors: ...
    def strain_gradient(self, time: Array | complex, rate: bool = False) -> Array: ...
    def modes(self) -> Modes: ...


class Contribution(Protocol):
    """A displacement field; ``at`` fixes the points."""

    def at(self, x: Points) -> ContributionAtPoints: ...


class Face(Contribution, Protocol):
    """A displacement field that makes contact on one piece of Γ3: ``ContactFace`` or ``SingularFace``.

    ``gap``, ``level`` are formulas with the jets below; ``initial_gap`` is that of g, 0 in the paper;
    ``pressure_jet`` is that of p as it was stated, None if it follows from the law; ``exponents_in`` has
    the truncated powers of the pressure side; ``rough`` the coordinates s at which the strain is singular
    for all times.
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
