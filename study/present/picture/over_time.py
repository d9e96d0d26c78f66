"""The deformed body at every time of a picture."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from study.ledger.packing import Packed
from study.present.picture.picture import Picture, Shape


@dataclass(frozen=True, eq=False)
class OverTime:
    """Displacement of the vertices, (times, d, vertices), and von Mises stress of the cells, (times, cells)."""

    displacement: Packed
    von_mises: Packed

    @classmethod
    def of(cls, record: Mapping[str, Any]) -> OverTime:
        """From the content of a file.

        Raises:
            KeyError, TypeError, ValueError: it lacks them, or has them on another mesh.
        """
        times, vertices, cells = len(record["times"]), np.shape(record["vertices"]), np.shape(record["cells"])
        return cls(
            _packed(record["displacement"], (times, *vertices)),
            _packed(record["von_mises"], (times, cells[1])),
        )


def with_every_shape(record: Mapping[str, Any]) -> Picture:
    """The picture with a shape at each of its times.

    Raises:
        KeyError, TypeError, ValueError: as ``OverTime.of``.
    """
    picture, over_time = Picture.of(record), OverTime.of(record)
    every = zip(picture.times, over_time.displacement.values, over_time.von_mises.values, strict=True)
    return replace(picture, shapes=[Shape(float(time), u, stress) for time, u, stress in every])


def _packed(entry: Mapping[str, Any], shape: tuple[int, ...]) -> Packed:
    found = Packed.read(entry)
    if found.multiples.shape != shape:
        raise ValueError(f"shape {found.multiples.shape}, expected {shape}")
    return found
