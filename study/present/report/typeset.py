"""HTML and SVG from the plain Unicode text of the data files: ‖u − u^h‖_V with its scripts raised and lowered."""

from __future__ import annotations

import re
from collections.abc import Iterator

from markupsafe import Markup, escape

_SCRIPT = re.compile(r"(?<=\S)([\^_])(\{(?:[^{}]|\{[^{}]*\})*\}|\([^()]*\)|\d+(?:\.\d+)?|\w)")
_TAGS = {"^": "sup", "_": "sub"}
_OFFSETS = {"": 0.0, "^": -0.35, "_": 0.2}
_SIZE = 0.72
"""Of scripts, and how far their baseline is below that of the line, both in font sizes of the line."""


def typeset(text: str) -> Markup:
    """Escaped text in which x^y, x_y, x^{yz}, x^1.5 and x^(1+s) have scripts; braces of scripts are dropped."""
    out = Markup()
    for piece, script in _pieces(text):
        tag = Markup(_TAGS.get(script, ""))
        out += Markup("<{0}>{1}</{0}>").format(tag, typeset(piece)) if script else escape(piece)
    return out


def typeset_svg(text: str) -> Markup:
    """The same as the content of a text element; scripts of scripts stand on their line."""
    out, baseline = Markup(), 0.0
    for piece, script in _pieces(text):
        size = _SIZE if script else 1.0
        shift = Markup('<tspan dy="{:.3g}em" font-size="{:g}em">{}</tspan>')
        out += shift.format((_OFFSETS[script] - baseline) / size, size, piece)
        baseline = _OFFSETS[script]
    return out


def _pieces(text: str) -> Iterator[tuple[str, str]]:
    """Pieces of a line, each with "^" or "_" for a script and "" for the line itself."""
    end = 0
    for match in _SCRIPT.finditer(text):
        if match.start() > end:
            yield text[end : match.start()], ""
        yield match[2][1:-1] if match[2].startswith("{") else match[2], match[1]
        end = match.end()
    if end < len(text):
        yield text[end:], ""
