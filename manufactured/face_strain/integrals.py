"""Hereditary integrals at fixed points, interval of contact by interval of contact."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from manufactured.face_strain.contact_times import PressureTerm
from manufactured.face_strain.strain_on_face import Components
from manufactured.symbols import Values
from manufactured.tensors import Array

if TYPE_CHECKING:
    from manufactured.face_strain.hereditary import Memory


class MemoryAtPoints:
    """q and q̇ at fixed points; intervals of contact, and integrals over those that have ended, are computed once."""

    def __init__(self, memory: Memory, points: Array) -> None:
        self.memory = memory
        self.points = points
        self.flat = points.reshape(points.shape[0], -1)
        self.contacts = [_ContactIntervals(term, self.flat, memory) for term in memory.terms]
        self._start: dict[int, Values] = {}
        self._last: tuple[complex, int, tuple[Components, Components]] | None = None

    def __call__(self, time: complex, order: int) -> tuple[Components, Components]:
        # A stress asks for strain and strain rate at the same time, which are found together.
        if self._last is None or self._last[:2] != (time, order):
            self._last = time, order, self._evaluate(time, order)
        return self._last[2]

    def _evaluate(self, time: complex, order: int) -> tuple[Components, Components]:
        memory, shape = self.memory, self.points.shape[1:]
        if order not in self._start:
            self._start[order] = memory.start(self.flat, 0.0, order)
        source = memory.source_jet(self.points, time, order)
        fading = np.exp(-memory.decay * time)
        totals = {
            index: (fading * start).astype(np.result_type(self.flat, time))
            for index, start in self._start[order].items()
        }
        for contact in self.contacts:
            contact.subtract(totals, time, order)
        strain = {index: total.reshape(shape) for index, total in totals.items()}
        rate = {index: -source[index] - memory.decay * value for index, value in strain.items()}
        return (strain,), (rate,)


class _ContactIntervals:
    """∫ e^{−λ(t−r)} ∂^i P dr of one term over all intervals of contact, from entry to exit or to the present time.

    Attributes:
        touched: the point of each interval, (M,); a point may have several.
        entry, exit: (M,).
    """

    def __init__(self, term: PressureTerm, points: Array, memory: Memory) -> None:
        self.convolution, self.decay = term.convolution, memory.decay
        entry, exit_ = term.intervals(points.real, memory.T)
        used = entry < exit_
        self.touched = np.nonzero(used)[1]
        self.points = points[:, self.touched]
        self.entry, self.exit = entry[used], exit_[used]
        self._found: dict[int, tuple[Values, Values]] = {}

    def subtract(self, totals: Values, time: complex, order: int) -> None:
        """totals[i] −= the integral up to ``time`` for ∂^i, at the points that are ever touched."""
        taylor, whole = self._at_entry(order)
        now = np.real(time)
        over = np.flatnonzero(self.exit <= now)
        if over.size:
            since = np.exp(-self.decay * (time - self.exit[over]))
            for index, total in totals.items():
                np.subtract.at(total, self.touched[over], since * whole[index][over])
        touching = np.flatnonzero((self.entry < now) & (self.exit > now))
        if touching.size:
            weights = self.convolution.weights(time - self.entry[touching])
            every = touching.size == self.entry.size
            for index, total in totals.items():
                mine = taylor[index] if every else taylor[index][:, touching]
                # A point touches in one interval at a time.
                total[self.touched[touching]] -= np.einsum("jn,jn->n", mine, weights)

    def _at_entry(self, order: int) -> tuple[Values, Values]:
        """Taylor coefficients at the entry, and the integral up to the exit."""
        if order not in self._found:
            taylor = self.convolution.taylor(self.points, self.entry, order)
            weights = self.convolution.weights(self.exit - self.entry)
            whole = {index: np.einsum("jn,jn->n", value, weights) for index, value in taylor.items()}
            self._found[order] = taylor, whole
        return self._found[order]
