"""Whether a bound is guaranteed, and what its samples of the data miss.

*Guaranteed*: it holds for the data as they are, between all quadrature points and times, by ranges of the formulas
(``study.bound.remainders``); rounding and the floating point eigenvalues of its constants are not enclosed.
*Estimated*: some datum is known at sampled points only, and nothing is added for what lies between them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from manufactured.data import Data, Expressions
from manufactured.factor import UNIFORM
from manufactured.law import Linear
from manufactured.symbols import t
from manufactured.tensors import Array
from study.bound.load_constants import LoadConstants, load_constants
from study.bound.remainders import Remainders, Unseen, require_ranges
from study.bound.scales import require_finite
from study.bound.shares import proportional
from study.bound.univariate import RangeError
from study.fem.quadrature import Line, rough_cells
from study.stresses.loads import LeftOut
from study.stresses.oscillation import Oscillation
from study.stresses.stress_space import StressSpace

KEPT = 64
"""Pieces whose remainders are kept."""
GUARANTEED, ESTIMATED = "guaranteed", "estimated"


@dataclass(frozen=True)
class Evidence:
    """What a bound rests on.

    Attributes:
        reasons: why it is estimated; none if it is guaranteed.
        poorly_seen: the datum, the place and the time where samples of the data may miss most, if that is much.
    """

    reasons: tuple[str, ...]
    poorly_seen: str = ""

    @property
    def kind(self) -> str:
        return ESTIMATED if self.reasons else GUARANTEED

    @property
    def sentences(self) -> list[str]:
        """The meaning of the word, and what to do."""
        if self.reasons:
            found = [f"estimated: {reason}; what lies between its samples is not bounded" for reason in self.reasons]
        else:
            found = ["guaranteed: also between quadrature points and times; rounding is not enclosed"]
        if self.poorly_seen:
            found.append(f"{self.poorly_seen}: take finer levels or more --steps for a narrower interval")
        return found


@dataclass(frozen=True, eq=False)
class Missed:
    """What samples of the data of one piece of ũ miss.

    Attributes:
        cells: to be added to η_T at every time, (cells,).
        everywhere: bound of the rest in the dual of V at every time of the piece.
        in_cells: parts of it that finer cells would lessen, (cells,).
    """

    cells: Array
    everywhere: float
    in_cells: Array


@dataclass(frozen=True, eq=False)
class Sampling:
    """The samples of the data on one mesh."""

    data: Data
    space: StressSpace

    @cached_property
    def reasons(self) -> tuple[str, ...]:
        """Why the bound is estimated; none if it is guaranteed."""
        return tuple(self._reasons())

    def _reasons(self) -> Iterator[str]:
        law, data = self.data.law, self.data
        if not isinstance(data.formulas_of, Expressions):
            yield "f_0, f_2 and u_0 are known at points and times only, not as formulas"
        else:
            try:
                require_ranges(data.formulas_of)
            except RangeError as error:
                yield str(error)
        if law.A.factor is not UNIFORM or getattr(law.G, "factor", UNIFORM) is not UNIFORM:
            yield "A or G varies in x, and norms with it are quadratures"
        if not isinstance(law.G, Linear):
            yield f"the term of the nonlinear G of {law.name} is a quadrature"
        lines = [Line(direction, offset) for direction, offset in data.lines]
        if any(cells.size for cells in rough_cells(self.space.mesh, lines, data.points)):
            yield "cells at the lines and points where the data are rough have graded rules, which are not exact"

    @cached_property
    def _unseen(self) -> Unseen:
        assert isinstance(self.data.formulas_of, Expressions)
        return Unseen(self.data, self.space, self.data.formulas_of)

    @cached_property
    def _constants(self) -> LoadConstants:
        assert isinstance(self.data.law.A, Linear)
        return load_constants(self.data.body, self.data.law.A)

    @cached_property
    def _still(self) -> bool:
        """Whether no load depends on time."""
        formulas = self._unseen.expressions
        return not any(f.has(t) for f in (*formulas.force, *(f for _, load in formulas.loads for f in load)))

    def missed(self, oscillation: Oscillation, a: float, b: float) -> Missed:
        """What is missed of f_0 and f_2 for a ≤ t ≤ b; nothing is known of it where the bound is estimated."""
        if self.reasons:
            return Missed(np.zeros(self.space.cells), 0.0, np.zeros(self.space.cells))
        force, surface = self._scaled(a, b)
        inside, on_edges = force.space + force.parabola, surface.space + surface.parabola
        added = LeftOut(inside, inside, on_edges)
        constants = self._constants
        rest = constants.volume * float(np.linalg.norm(2 * force.space + force.cubic))
        rest += constants.surface * float(np.linalg.norm(2 * surface.space + surface.cubic))
        in_cells = constants.volume * proportional((2 * force.space) ** 2)
        at_edges = constants.surface * proportional((2 * surface.space) ** 2)
        np.add.at(in_cells, self.space.mesh.f2t[0], at_edges)
        return Missed(oscillation(added), rest, in_cells)

    def missed_at_start(self) -> float:
        """What is missed of ‖u_0 − ũ(0)‖_V."""
        if self.reasons:
            return 0.0
        require_finite({"what samples of ε(u_0) miss": self._unseen.start})
        return 2 * float(np.sqrt(self.data.law.A.lipschitz) * np.linalg.norm(self._roots * self._unseen.start))

    def worst(self, a: float, b: float) -> str:
        """The datum and the place of which samples for a ≤ t ≤ b may miss most; empty where that is unknown."""
        if self.reasons:
            return ""
        force, surface = (2 * found.space + found.cubic for found in self._scaled(a, b))
        inside = self._constants.volume * force.max() >= self._constants.surface * surface.max(initial=0.0)
        mesh = self.space.mesh
        place = mesh.p[:, mesh.t[:, force.argmax()] if inside else mesh.facets[:, surface.argmax()]].mean(axis=1)
        x = ", ".join(f"{c:.3g}" for c in place)
        return f"{'f_0' if inside else 'f_2'} is seen poorly near x = ({x}), {a:.3g} ≤ t ≤ {b:.3g}"

    @cached_property
    def _roots(self) -> Array:
        return np.sqrt(self.space.volumes)

    def _scaled(self, a: float, b: float) -> tuple[Remainders, Remainders]:
        """The remainders times the roots of the sizes of cells and edges; those of loads at rest are made once."""
        return self._at_rest if self._still else self._kept(a, b)

    @cached_property
    def _kept(self) -> Callable[[float, float], tuple[Remainders, Remainders]]:
        """The remainders of the last pieces, for which other trajectories and ``worst`` ask again."""
        return lru_cache(maxsize=KEPT)(self._made)

    @cached_property
    def _at_rest(self) -> tuple[Remainders, Remainders]:
        return self._made(0.0, 0.0)

    def _made(self, a: float, b: float) -> tuple[Remainders, Remainders]:
        force, surface = self._unseen.force(a, b), self._unseen.surface(a, b)
        for name, found in (("f_0", force), ("f_2", surface)):
            missed = {"space": found.space, "time": np.maximum(found.parabola, found.cubic)}
            require_finite({f"what samples of {name} in {where} miss": value for where, value in missed.items()})
        return force.times(self._roots), surface.times(np.sqrt(self.space.lengths))
