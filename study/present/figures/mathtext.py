"""What Matplotlib sets from plain text with Unicode mathematics in it."""

from __future__ import annotations

import re

from study.present.latex import encode


def mathtext(text: str) -> str:
    """Mathematics between dollar signs, the rest as it stands."""
    pieces = re.split(r"\\\((.*?)\\\)", encode(text))
    prose = [re.sub(r"\\([&%_#{}])", r"\1", piece.replace(r"\textasciitilde{}", "~")) for piece in pieces[::2]]
    # Of the commands of LaTeX that are in use, this one is unknown to Matplotlib; the character is known.
    formulas = [f"${piece}$".replace(r"\surd", "√") for piece in pieces[1::2]]
    return "".join(piece for pair in zip(prose, [*formulas, ""], strict=True) for piece in pair)
