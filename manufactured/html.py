"""HTML for notebooks: tables, and a picture of a body with its boundary parts."""

from collections.abc import Iterable, Sequence
from html import escape

from manufactured.colours import BLUE, DARK, GREEN, GREY, VERMILLION
from manufactured.tensors import Array

WIDTH = 240
"""Width of the picture of a body in pixels."""
LEGEND = {
    "Γ1": (DARK, "Γ1, clamped"),
    "Γ2": (BLUE, "Γ2, loaded"),
    "Γ3": (VERMILLION, "Γ3, contact"),
    "roller": (GREEN, "roller"),
    "interface": (GREY, "interface"),
}
"""Values of ``manufactured.body.Kind`` ↦ colours and names of boundary parts.

Dark grey, blue and vermillion are distinguishable for people with colour blindness.
"""


def picture(kinds: Sequence[str], corners: Array) -> str:
    """Return a picture of the parts of a 2D body as SVG, or for a 3D body the number of parts of each kind.

    Args:
        kinds: the kinds of the parts, as values of ``manufactured.body.Kind``.
        corners: the corners of the parts of a 2D body, (n, 2, 2); for a 3D body an array without entries.
    """
    legend = {kind: words for kind, words in LEGEND.items() if kind in kinds}
    if not corners.size:
        return "; ".join(f"{name}: {kinds.count(kind)} flat parts" for kind, (_, name) in legend.items())
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    scale = WIDTH / max(high - low)
    width, height = (high - low) * scale
    lines = []
    for kind, ((x, y), (u, v)) in zip(kinds, (corners - low) * scale, strict=True):
        lines.append(
            f'<line x1="{x:.1f}" y1="{height - y:.1f}" x2="{u:.1f}" y2="{height - v:.1f}" '
            f'stroke="{LEGEND[kind][0]}" stroke-width="4" stroke-linecap="round"/>'
        )
    words = ", ".join(f'<span style="color:{colour}">{name}</span>' for colour, name in legend.values())
    return (
        f'<svg role="img" aria-label="body with its boundary parts" width="{width + 8:.0f}" height="{height + 8:.0f}" '
        f'viewBox="-4 -4 {width + 8:.1f} {height + 8:.1f}">{"".join(lines)}</svg><p>{words}</p>'
    )


def table(rows: Iterable[tuple[str, object]]) -> str:
    """Return an HTML table of names and values."""
    cells = "".join(f"<tr><th>{escape(name)}</th><td>{escape(str(value))}</td></tr>" for name, value in rows)
    return f"<table>{cells}</table>"
