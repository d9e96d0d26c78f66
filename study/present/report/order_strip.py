"""The observed orders of a case on a line, beside the predicted one."""

from __future__ import annotations

from dataclasses import dataclass

import pandas as pd

from study.present.charts.palette import looks


@dataclass(frozen=True)
class OrderStrip:
    """Orders from 0 to ``HIGHEST`` as coordinates from 0 to ``WIDTH``: the predicted one, and those observed."""

    HIGHEST = 1.5
    WIDTH = 150

    predicted: float
    observed: list[tuple[float, str]]

    @classmethod
    def of(cls, rates: pd.DataFrame, expected: float, orders: dict[str, float]) -> OrderStrip:
        """From the order on every mesh family, in the colour of the family."""
        look = looks(rates["family"])
        return cls(cls._at(expected), [(cls._at(order), look[family].colour) for family, order in orders.items()])

    @classmethod
    def _at(cls, order: float) -> float:
        return round(cls.WIDTH * min(max(order / cls.HIGHEST, 0.0), 1.0), 1)
