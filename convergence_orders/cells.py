"""Reads the numbers in the cells of a table, and says what a column contains from its name."""

import math
import re
from collections.abc import Callable
from functools import cache

from .orders import OrderError

MISSING = re.compile(r"(?i)[-_*.…~/\\]*|n/?a|none|null|missing")
"""Matches an empty cell and signs for a missing number."""
_TRANSLATED = str.maketrans("−–—‐⁻⁰¹²³⁴⁵⁶⁷⁸⁹⁺", "-----0123456789+", "`$\"'{}\u200b")
Rewriting = list[tuple[str, str | Callable[[re.Match[str]], str]]]
"""Patterns and what replaces them, one after the other."""
_REWRITTEN: Rewriting = [
    (r"(?<=[\d.])(?=[⁻⁺]?[⁰¹²³⁴⁵⁶⁷⁸⁹])", "^"),
    (r"\\[a-z]?frac\s*\{([^{}]*)\}\s*\{((?:[^{}]|\{[^{}]*\})*)\}", r"\1/\2"),
    (r"(?<=\d)\*\*(?=[-+\d])", "^"),
    (r"\\times|\\cdot|[×·X]|\*(?=\s*10)|\\,(?=10\^)", "x"),
    (r"±|\\pm", "+/-"),
    (r"\\infty|∞", "inf"),
    (r"\\%", "%"),
    (r"\\(?:num|mathbf|textbf|bf|boldsymbol|mathrm|text|underline|[,;! ])|^[*\s]+|[*\s]+$", ""),
]
"""Ways to write numbers."""
_PLAIN: Rewriting = [
    (r"\s*\+/-\s*[\d.]+(?:[eE][-+]?\d+)?", ""),
    (r"\s*([x^/%])\s*", r"\1"),
    (r"^(\d+)(?:x\1)+$", r"\1"),
    (r"(?<=[\d.])(?:x10\^|[dD])\(?([-+]?\d+)\)?", r"e\1"),
    (r"^([-+]?[\d.]+)\s*\(([-+]\d+)\)$", r"\1e\2"),
    (r"(?<=[\d.%])\s*\([^()]*\)$", ""),
]
"""The same for the text without dollar signs, quotes and braces."""
_GROUPED = re.compile(r"[-+]?[1-9]\d{0,2}([ ,’\u00a0\u202f])\d{3}(?:\1\d{3})*(?:\.\d*)?")
_FACTOR = r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[-+]?inf|nan)(?:\^([-+]?\d{1,4}))?"
_VALUE = re.compile(rf"{_FACTOR}(?:/{_FACTOR})?(%?)")
_DECIMAL_COMMA = re.compile(r"[-+−]?\d*,\d+(?:[eEdD][-+−]?\d+)?\s*%?")
_THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2}(?:,\d{3})+")
_POINTS_GROUPED = re.compile(r"[-+]?[1-9]\d{0,2}(?:\.\d{3})+")
_BEFORE_WORDS = re.compile(r"(.*?\d[.%]?)\**\s*(?!fail|div|no)[^\W\d_]+\**\s*")


def rewrite(text: str, rewriting: Rewriting) -> str:
    """Return a text in which patterns are replaced, one after the other.

    Parameters:
        text: the text.
        rewriting: pairs of a regular expression and what replaces each match: a text, or a function of the match.
    """
    for pattern, replacement in rewriting:
        text = re.sub(pattern, replacement, text)
    return text


@cache
def to_number(cell: str, decimal_comma: bool = False) -> float | None:
    """Return the number in a cell; NaN for a cell that is empty or says that a number is missing; None for other text.

    Parameters:
        cell: the text, with or without surrounding blanks.
        decimal_comma: whether ``1,5`` is 1.5 and ``1.024`` is 1024.
    """
    text = cell.strip()
    if decimal_comma and ("," in text or _POINTS_GROUPED.fullmatch(text)):
        text = re.sub(r"(?<=\d)\.(?=\d{3}(?:\D|$))", "", text).replace(",", ".")
    if len(text) > 100:
        return None
    try:
        return float(text)
    except ValueError:
        pass
    text = rewrite(text, _REWRITTEN).translate(_TRANSLATED).strip()
    if MISSING.fullmatch(text):
        return math.nan
    text = rewrite(text, _PLAIN).strip()
    if grouped := _GROUPED.fullmatch(text):
        text = text.replace(grouped[1], "")
    found = _VALUE.fullmatch(text)
    # An error and its order, such as 1.2e-3/1.98, are not a fraction.
    if found is None or (found[3] and "e" in found[1]):
        return None
    try:
        above = float(found[1]) ** int(found[2] or 1)
        below = float(found[3] or 1) ** int(found[4] or 1)
        return above / below * (0.01 if found[5] else 1)
    except (OverflowError, ZeroDivisionError):
        return None


def without_words(cell: str) -> str:
    """Return a cell without the unit or the word behind its number, such as 5 for ``5 mm``.

    Cells whose word begins with fail, div or no, such as ``5 failed``, are returned unchanged.
    """
    found = _BEFORE_WORDS.fullmatch(cell) if len(cell) < 100 else None
    return found[1] if found else cell


def is_missing(cell: str) -> bool:
    """Return whether a cell is empty or says that a number is missing; a cell with the text nan has a number."""
    return "nan" not in cell.lower() and math.isnan(to_number(cell) or 0)


@cache
def kind_of(cell: str) -> str:
    """Return what a cell contains: ``9`` for a number, ``-`` for a missing number, and ``a`` for other text."""
    if is_missing(cell):
        return "-"
    values = to_number(cell), to_number(cell, decimal_comma=True)
    return "a" if values == (None, None) else "9"


def uses_decimal_commas(cells: list[str]) -> bool:
    """Return whether the commas in cells are decimal commas.

    Raises:
        OrderError: 1,024 may be 1.024 or 1024.
    """
    commas = [cell.strip() for cell in cells if "," in cell]
    thousands = [cell for cell in commas if _THOUSANDS.fullmatch(cell)]
    if any(_DECIMAL_COMMA.fullmatch(cell) and cell not in thousands for cell in commas):
        return True
    # If some cells have decimal points, the commas separate thousands.
    if thousands and not any(re.search(r"\.\d", cell) for cell in cells):
        raise OrderError(f"'{commas[0]}' may be a decimal fraction or have thousands: write it without a comma")
    return False


# The names of columns.

_COUNTED = r"cells|elem(?:ent)?s?|eles?|dofs?|unknowns|nodes|points|vertices|degrees of freedom|grid ?points"
_ROLES = {
    "size": r"hs?|h ?max|h ?min|max ?h|lc|d[xyz]|δ ?[xyz]|(?:mesh|grid|cell|element) ?(?:size|width|spacing)s?(?: hs?)?"
    r"|spacing|resolution (?:k?m|deg)|1/n|1/sqrt\(dofs?\)",
    "count": r"ns?|n ?[xyz] ?[1-3]?|1/h|resolution|cells per (?:side|unit length|direction)",
    "total": rf"(?:(?:n|number of|no of|total) |n)?(?:active )?(?:{_COUNTED})(?: total)?|n ?el?",
    "step": r"dt|δ ?t|tau|τ|(?:time ?step(?: size)?|step ?size)(?: (?:dt|δ ?t|τ|tau))?",
    "level": r"(?:refinement |ref |mesh )?(?:level|lvl|cycle)s?|ref(?:inements?|ine)?",
    "degree": r"(?:polynomial )?(?:degrees?|deg)(?: [pkqr])?|poly(?:nomial)? ?(?:order)?|p|pk",
}
"""Role ↦ pattern of the whole name."""
SIZES = ("size", "count", "total", "step")
"""Roles of columns from which mesh sizes or time steps can be computed, the preferred role first."""
_NAME_SPELLINGS: Rewriting = [
    (r"\[.*?\]|\((?:k?m|s|ms|sec|seconds|cm|mm)\)", " "),
    (r"h(?:\^\{?-1\}?|⁻¹)", "1/h"),
    (r"\\?[Dd]elta", "Δ"),
    (r"\\tau", "τ"),
    (r"\\?#", " n "),
    (r"[$*`'\"_{}^\\\s-]+", " "),
]
"""Ways to write the names of columns."""
_ORDER = re.compile(r"\b(?:e?oc|orders?|rates?|roc|ooc|slope|log2)(?:(?:l|h)(?:\d|inf))?\b|^(?:conv|red)$")
_QUOTIENT = re.compile(r"\b(?:ratio|reduction|quotient|factor)s?\b")
_METHOD = re.compile(r"(?:\d+(?:st|nd|rd|th)|first|second|third|fourth|fifth|sixth) orders?(?: \w+)?\)?$")
_ERROR = re.compile(r"err|fehler|erreur|norm|l ?(?:1|2|inf|∞)\b|h ?[12]\b|linf|l∞|rmse|mae|\|")
_OTHER = re.compile(
    r"\b(?:time|times|cpu|wall|runtime|elapsed|seconds|mem|memory|cond|condition|kappa|nnz|iter|iters|iterations?|its|"
    r"newton|cfl|speedup|efficiency|effectivity|procs|cores|ranks|threads|index|unnamed|row|id|seed|g?flops|steps?|"
    r"cells|n?dofs?|elements|nodes|points|mesh|grid|expected|theory|theoretical|predicted)\b|^(?:t|i|j|k|#|no|nr|)$"
)


def role(name: str) -> str:
    """Return the role of a column, which follows from its name.

    The roles are ``error``, ``order``, ``quotient`` (of errors), ``size`` (of a mesh), ``step`` (in time), ``count``
    (number of cells along a side), ``total`` (number of all cells, vertices or unknowns), ``level``, ``degree`` (of
    polynomials), ``other`` (such as times and iterations) and ``unknown``.
    """
    if name.strip(" $") == "T":
        # A column T often has errors of a temperature; the time is called t.
        return "unknown"
    timed = re.search(r"[\[(](?:s|ms|sec|MB|GB|kB)[\])]", name)
    text = rewrite(name, _NAME_SPELLINGS).lower().strip(" .:")
    for kind, pattern in _ROLES.items():
        if re.fullmatch(pattern, text):
            return kind
    if _QUOTIENT.search(text):
        return "quotient"
    if _ORDER.search(text) and not _METHOD.search(text):
        return "order"
    is_error = _ERROR.search(text)
    if timed or re.search(r"expected|theor", text) or (_OTHER.search(text) and not is_error):
        return "other"
    return "error" if is_error else "unknown"
