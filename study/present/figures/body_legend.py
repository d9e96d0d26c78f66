"""Legend and colour bars of drawings of a body."""

from __future__ import annotations

from typing import Any

from matplotlib import patches
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from study.present.charts.palette import BLACK, VERMILLION
from study.present.figures.body_scale import BodyScale
from study.present.picture.picture import Picture


def draw_colour_bars(figure: Figure, panels: list[Axes], picture: Picture, scale: BodyScale, **layout: Any) -> None:
    """The colours of the stress and, for a solid, of the pressure, beside or under some axes."""
    bar = figure.colorbar(scale.stress_colours, ax=panels, extend="max", **layout)
    bar.set_label(r"von Mises stress $\sqrt{3/2}\,|\mathrm{dev}\,\sigma|$")
    bar.outline.set_linewidth(0.4)
    if picture.polygons:
        bar = figure.colorbar(scale.pressure_colours, ax=panels, **layout)
        bar.set_label(r"contact pressure $p^h$ on $\Gamma_3$")


def body_handles(picture: Picture, scale: BodyScale) -> list[Artist]:
    """Entries of the legend."""
    body = Line2D([], [], color="0.35", lw=0.6, label=rf"body, displacement $\times\,{scale.magnification:.2g}$")
    if picture.polygons:
        dot: dict[str, Any] = {"color": BLACK, "ls": "", "marker": "o", "ms": 2, "mew": 0}
        return [body, Line2D([], [], label="vertices in contact", **dot)]
    arrow: dict[str, Any] = {"color": VERMILLION, "ls": "", "marker": r"$\uparrow$", "ms": 6, "mew": 0.2}
    return [
        body,
        patches.Patch(facecolor="0.82", edgecolor="0.25", label="foundation"),
        Line2D([], [], label=f"contact pressure, at most {scale.pressure:.3g}", **arrow),
        Line2D([], [], color=BLACK, lw=1.8, label="computed contact zone"),
    ]
