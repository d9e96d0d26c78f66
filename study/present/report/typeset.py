"""HTML from the plain Unicode text of the data files: ‖u − u^h‖_V with its scripts raised and lowered."""

from __future__ import annotations

import re

from markupsafe import Markup, escape

_SCRIPT = re.compile(r"(?<=\S)([\^_])(\{(?:[^{}]|\{[^{}]*\})*\}|\([^()]*\)|\d+(?:\.\d+)?|\w)")
_TAGS = {"^": "sup", "_": "sub"}


def typeset(text: str) -> Markup:
    """Escaped text in which x^y, x_y, x^{yz}, x^1.5 and x^(1+s) have scripts; braces of scripts are dropped."""
    out, end = Markup(), 0
    for match in _SCRIPT.finditer(text):
        tag, script = _TAGS[match[1]], match[2]
        inner = typeset(script[1:-1] if script.startswith("{") else script)
        out += escape(text[end : match.start()]) + Markup("<{0}>{1}</{0}>").format(Markup(tag), inner)
        end = match.end()
    return out + escape(text[end:])
