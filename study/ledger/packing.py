"""Many small numbers in little space: few digits, or multiples of a unit, as differences in time, compressed."""

from __future__ import annotations

import zlib
from base64 import b64decode, b64encode
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

STEPS = 999
"""Multiples of the unit up to the largest value: three digits, a tenth of a pixel in a picture of a body."""
FINE = 32_000
"""For values of which the signs and digits are read, not only seen: as many as 16 bits hold."""


@dataclass(frozen=True, eq=False)
class Packed:
    """Values over time, rounded to multiples of a unit.

    Attributes:
        unit: the largest absolute value / steps; 1 where all vanish.
        multiples: the values / unit, between −steps and steps, (times, ...).
    """

    unit: float
    multiples: NDArray[np.int16]

    @classmethod
    def of(cls, values: NDArray[np.float64], steps: int = STEPS) -> Packed:
        """Values over time, (times, ...), to within half a unit; ``steps`` is STEPS or FINE."""
        unit = float(f"{np.max(np.abs(values), initial=0.0) / steps:.6g}") or 1.0
        return cls(unit, np.round(values / unit).astype(np.int16))

    @property
    def values(self) -> NDArray[np.float64]:
        """The rounded values, (times, ...)."""
        return self.unit * self.multiples.astype(np.float64)

    def record(self) -> dict[str, Any]:
        """For a JSON file: the first time and then the changes, as they compress to a third."""
        changes = np.diff(self.multiples, axis=0, prepend=np.int16(0)).astype("<i2")
        return {
            "unit": self.unit,
            "shape": list(changes.shape),
            "changes": b64encode(zlib.compress(changes.tobytes(), 9)).decode("ascii"),
        }

    @classmethod
    def read(cls, record: Mapping[str, Any]) -> Packed:
        """What ``record`` made.

        Raises:
            KeyError, TypeError, ValueError: it was not made so.
        """
        try:
            content = zlib.decompress(b64decode(record["changes"], validate=True))
        except zlib.error as error:
            raise ValueError(str(error)) from error
        changes = np.frombuffer(content, dtype="<i2").reshape(record["shape"])
        return cls(float(record["unit"]), np.cumsum(changes, axis=0, dtype=np.int16))


def short(values: NDArray[np.float64]) -> Any:
    """Lists of numbers with four significant digits: what a figure can show."""
    return np.vectorize(lambda v: float(f"{v:.4g}"), otypes=[float])(values).tolist()
