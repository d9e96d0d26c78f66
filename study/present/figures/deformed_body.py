"""The deforming body on its foundation at some times, from ``pictures/CASE.json``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from matplotlib import patches
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from study.present.charts.palette import BLACK, VERMILLION
from study.present.figures.deformed_mesh import GAP, ROUND_OFF, BodyScale, draw_deformed_mesh
from study.present.figures.drawing import COLUMN, dots, entry, legend
from study.present.picture.picture import Picture
from study.present.picture.view import BRIGHTEST


def draw_shapes(
    figure: Figure, panels: Sequence[Axes], picture: Picture, width: float, columns: int, **layout: Any
) -> None:
    """Each shape in axes of its own, so many inches wide, with colour bars and a legend in so many columns."""
    scale = BodyScale.of(picture)
    for axes, shape in zip(panels, picture.shapes, strict=True):
        draw_deformed_mesh(axes, picture, shape, scale, width)
        axes.set_title(f"$t={shape.time:.3g}$")
    draw_keys(figure, list(panels), picture, scale, columns, **layout)
    figure.suptitle(picture.heading)


def draw_keys(
    figure: Figure,
    panels: list[Axes],
    picture: Picture,
    scale: BodyScale,
    columns: int,
    more: Sequence[Artist] = (),
    **layout: Any,
) -> None:
    """A legend, with ``more`` entries, and the colours of the stress and, for a solid, of the pressure, beside axes."""
    ends = [0, scale.stress / 4, scale.stress]
    bar = figure.colorbar(scale.stress_colours, ax=panels, extend="max", ticks=ends, format="%.3g", **layout)
    bar.set_label(r"von Mises stress $\sqrt{3/2}\,|\mathrm{dev}\,\sigma|$")
    bar.outline.set_linewidth(0.4)
    if picture.polygons:
        bar = figure.colorbar(scale.pressure_colours, ax=panels, **layout)
        bar.set_label(r"contact pressure $p^h$ on $\Gamma_3$")
    legend(figure, [*_body_handles(picture, scale), *more], columns=columns)


def _body_handles(picture: Picture, scale: BodyScale) -> list[Artist]:
    body = entry(rf"body, displacement $\times\,{scale.magnification:.2g}$", color="0.35", lw=0.6)
    if picture.polygons:
        return [body, dots("vertices in contact", color=BLACK, ms=2, mew=0)]
    pressure = f"contact pressure, at most {scale.pressure:.3g}"
    gap = [patches.Patch(**GAP, label=f"gap, at most {scale.gap:.3g}")] if scale.gap > ROUND_OFF else []
    return [
        body,
        patches.Patch(facecolor="0.82", edgecolor="0.25", label="foundation"),
        dots(pressure, color=VERMILLION, marker=r"$\uparrow$", ms=6, mew=0.2),
        entry("computed contact zone", color=BLACK, lw=1.8),
        *gap,
    ]


def draw_body(picture: Picture) -> Figure:
    """The magnified deformed mesh at the times of ``shapes``, coloured by its von Mises stress.

    In the plane the foundation of each face is the line of its nodes ``x``, undeformed, with the outer side grey;
    arrows are the ``pressure`` of the foundation on the body and what hangs below is the ``gap``, each to one scale. A
    solid is seen through its foundation,
    and the pressure colours its contact faces.
    """
    count, bars = len(picture.shapes), 2 if picture.polygons else 1
    aspect = BodyScale.of(picture).aspect
    figure = Figure(figsize=(COLUMN, 0.7 + 0.45 * bars + (COLUMN - 0.1) / count * aspect))
    panels = figure.subplots(1, count, squeeze=False)[0]
    layout: dict[str, Any] = {"orientation": "horizontal", "fraction": 0.05, "shrink": 0.7, "pad": 0.02}
    draw_shapes(figure, panels, picture, COLUMN / count, 2, **layout)
    return figure


def caption_body(picture: Picture) -> str:
    """What to see."""
    scale = BodyScale.of(picture)
    shape = max(picture.shapes, key=lambda shape: float(shape.von_mises.max()))
    touching = [sum(int(face.touching[instant].sum()) for face in picture.faces) for instant in picture.instants]
    vertices = sum(face.pressure.shape[1] for face in picture.faces)
    template, seen, deviator = _IN_SPACE if picture.polygons else _IN_THE_PLANE
    drawn = template.format(pressure=scale.pressure, gap=scale.gap if scale.gap > ROUND_OFF else 0.0)
    return (
        f"The deformed body at t = {picture.times_shown} ({picture.place}): displacements times "
        f"{scale.magnification:.2g}, cells coloured by the von Mises stress √(3/2) |dev σ| of the computed "
        f"stress A ε(δu) + G ε(u){deviator}; {drawn}. What to see: where there is "
        f"contact ({', '.join(map(str, touching))} of {vertices} vertices of Γ3), {seen}. The largest von Mises stress "
        f"is {shape.von_mises.max():.3g}, at t = {shape.time:.3g}; colours go with the root of the stress, one "
        f"cell in {1 / (1 - BRIGHTEST):.0f} lies beyond their end, {scale.stress:.3g}."
    )


_IN_THE_PLANE = (
    "arrows are the contact pressure, at most {pressure:.3g}; what hangs below the foundation is the gap, at most "
    "{gap:.3g} and drawn to a scale of its own",
    "the body lies on the foundation and there is pressure, elsewhere it has come off and there is none",
    ", dev σ the deviator in the plane",
)
_IN_SPACE = (
    "the body is turned and seen through its foundation, and Γ3 is coloured by the contact pressure, at most "
    "{pressure:.3g}",
    "Γ3 is flat and there is pressure, elsewhere it has come off and there is none",
    "",
)
