"""One scale for all times of a picture, so that its drawings can be compared."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

from study.present.picture.face_history import Array
from study.present.picture.picture import Picture
from study.present.picture.proportions import ARROW, magnification
from study.present.picture.view import View

STRESSES = "YlGnBu"
"""Colour map of the stress: light for small stresses, so that the mesh stays visible, and darker throughout."""
PRESSURES = "OrRd"
"""Colour map of the pressure on the faces of solids."""
SHADES = 16
CLIPPED = 0.005
"""The fraction of cells, those at a singular corner, whose stress may lie beyond the end of the colours."""


@dataclass(frozen=True, eq=False)
class BodyScale:
    """What all times of a picture are drawn to.

    Attributes:
        view: from the body to the drawing.
        size: the body's longest side.
        magnification: of displacements.
        limits: of what is drawn to the right and upwards, (2, 2).
        pressure: the largest one shown.
        stress: the end of the colours.
    """

    view: View
    size: float
    magnification: float
    limits: Array
    pressure: float
    stress: float

    @classmethod
    def of(cls, picture: Picture) -> BodyScale:
        """Room for every shape and for arrows of full length."""
        view = View.of(picture)
        factor = magnification(picture.vertices, [shape.displacement for shape in picture.shapes])
        pressures = [face.pressure[picture.instants].max() for face in picture.faces]
        return cls(
            view=view,
            size=picture.size,
            magnification=factor,
            limits=_limits(picture, view, factor),
            pressure=float(max(pressures, default=0.0)),
            stress=float(np.quantile([shape.von_mises for shape in picture.shapes], 1 - CLIPPED)) or 1.0,
        )

    @property
    def aspect(self) -> float:
        """Height over width."""
        return float(np.ptp(self.limits[1]) / np.ptp(self.limits[0]))

    @property
    def stress_colours(self) -> ScalarMappable:
        """From 0 to the end of the colours."""
        return ScalarMappable(Normalize(0, self.stress), colormaps[STRESSES].resampled(SHADES))

    @property
    def pressure_colours(self) -> ScalarMappable:
        """From 0 to the largest pressure."""
        return ScalarMappable(Normalize(0, self.pressure or 1.0), colormaps[PRESSURES].resampled(SHADES))


def _limits(picture: Picture, view: View, factor: float) -> Array:
    points = [picture.vertices] + [picture.vertices + factor * shape.displacement for shape in picture.shapes]
    points += [face.x + ARROW * picture.size * face.normal[:, None] for face in picture.segments]
    everything = view.flat(np.hstack(points))
    margin = 0.02 * picture.size * np.array([-1, 1])
    return np.column_stack([everything.min(axis=1), everything.max(axis=1)]) + margin
