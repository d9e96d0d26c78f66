"""Converts formulas of docstrings, in plain Unicode, to LaTeX for the site."""

import re
import unicodedata

from study.present.notation import typeset

RAISED = str.maketrans("²³", "23")
WORDS = ("Re", "cos", "sin")
PLAIN = {"−": "-", "∂": r"\partial ", "·": r"\cdot ", "≥": r"\ge ", "≤": r"\le "}


def with_formulas(text: str) -> str:
    """Returns a docstring in Markdown; its indented lines are formulas, separated by three spaces."""
    paragraphs = text.split("\n\n")
    return "\n\n".join(_shown(each) if each.startswith("    ") else prose(each) for each in paragraphs)


def prose(text: str) -> str:
    """Returns a text with superscripts and subscripts, except in names of code."""
    pieces = re.split("(``.*?``)", text)
    return "".join(piece if piece.startswith("``") else str(typeset(piece)) for piece in pieces)


def _shown(block: str) -> str:
    """Returns a block of formulas with the same lines; long lines may break between formulas."""
    lines = [re.split(r",? {2,}", re.sub(r":\s+", ": ", line.strip().rstrip(","))) for line in block.splitlines()]
    return "\\\n".join(", ".join(_piece(text) for text in line) for line in lines)


def _piece(text: str) -> str:
    """Returns a formula, with a word and a colon before it or a condition after it if there are any."""
    word, colon, rest = text.rpartition(":")
    formula, condition, bound = (rest if colon else text).strip().partition(" for ")
    said = [f"{word}:"] * bool(colon) + [f"${latex(formula)}$"] * bool(formula)
    return " ".join([*said, "for", f"${latex(bound)}$"] if condition else said)


def latex(formula: str) -> str:
    """Returns LaTeX of a formula with its powers, indices, dots and names of functions."""
    # A dot above a letter is a character of its own; precomposed letters are taken apart.
    text = re.sub("(\\w)\N{COMBINING DOT ABOVE}", r"\\dot{\1}", unicodedata.normalize("NFD", formula))
    text = re.sub("[²³]", lambda power: f"^{power[0].translate(RAISED)}", text)
    text = re.sub(r"_(\w{2,})", r"_{\1}", text)
    text = re.sub(r"Γ(\d(?:,\d)?)", r"Γ_{\1}", text)
    text = re.sub(rf"\b({'|'.join(WORDS)})\b", r"\\operatorname{\1}", text)
    return "".join(PLAIN.get(letter, letter) for letter in text)
