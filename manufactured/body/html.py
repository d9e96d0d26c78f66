"""HTML for notebooks: tables, and a picture of a body with its boundary parts."""

from collections.abc import Iterable, Sequence
from html import escape

import numpy as np

from manufactured.body.part import Kind, Part
from manufactured.colours import BLUE, DARK, GREEN, GREY, VERMILLION

WIDTH = 240
"""Width of the picture of a body in pixels."""
COLOURS = {Kind.CLAMPED: DARK, Kind.LOADED: BLUE, Kind.CONTACT: VERMILLION, Kind.ROLLER: GREEN, Kind.INTERFACE: GREY}
"""Colours of boundary parts. Dark grey, blue and vermillion are distinguishable for people with colour blindness."""
NAMES = {
    Kind.CLAMPED: "Γ1, clamped",
    Kind.LOADED: "Γ2, loaded",
    Kind.CONTACT: "Γ3, contact",
    Kind.ROLLER: "roller",
    Kind.INTERFACE: "interface",
}
"""Names of boundary parts in the legend of a picture."""


def picture(parts: Sequence[Part]) -> str:
    """Return a picture of the parts of a 2D body as SVG, or for a 3D body the number of parts of each kind."""
    kinds = [kind for kind in Kind if any(part.kind is kind for part in parts)]
    if parts[0].dim == 3:
        return "; ".join(f"{NAMES[kind]}: {sum(part.kind is kind for part in parts)} flat parts" for kind in kinds)
    points = np.array([[part.start, part.end] for part in parts])
    low, high = points.min(axis=(0, 1)), points.max(axis=(0, 1))
    scale = WIDTH / max(high - low)
    width, height = (high - low) * scale
    lines = []
    for part, ends in zip(parts, (points - low) * scale, strict=True):
        (x, y), (u, v) = ends
        lines.append(
            f'<line x1="{x:.1f}" y1="{height - y:.1f}" x2="{u:.1f}" y2="{height - v:.1f}" '
            f'stroke="{COLOURS[part.kind]}" stroke-width="4" stroke-linecap="round"/>'
        )
    legend = ", ".join(f'<span style="color:{COLOURS[kind]}">{NAMES[kind]}</span>' for kind in kinds)
    return (
        f'<svg role="img" aria-label="body with its boundary parts" width="{width + 8:.0f}" height="{height + 8:.0f}" '
        f'viewBox="-4 -4 {width + 8:.1f} {height + 8:.1f}">{"".join(lines)}</svg><p>{legend}</p>'
    )


def table(rows: Iterable[tuple[str, object]]) -> str:
    """Return an HTML table of names and values."""
    cells = "".join(f"<tr><th>{escape(name)}</th><td>{escape(str(value))}</td></tr>" for name, value in rows)
    return f"<table>{cells}</table>"
