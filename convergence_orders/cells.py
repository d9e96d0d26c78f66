"""Reads the numbers in the cells of a table, and says what a column contains from its name.

Numbers are understood in the forms in which people write them: 1.2D-3, 1.2(-3), 16x16, 1,5e-3, 1.2×10⁻³, 1/8, 5 %,
−0.5, 1 024, \\num{1e-3}, \\sfrac{1}{2^{3}}.
"""

import math
import re
from functools import cache

NUMBER, MISSING, TEXT = "number", "missing", "text"
"""What a cell contains: a number; nothing, or a sign for a missing number; any other text."""
_ABSENT = re.compile(r"(?i)(?:[-_*.…~/\\]*|n/?a|none|null|missing)")
_TRANSLATED = str.maketrans("−–—‐‑⁻⁰¹²³⁴⁵⁶⁷⁸⁹⁺", "------0123456789+", "\u00a0\u202f\u2009`$")
_BRACED = r"\{((?:[^{}]|\{[^{}]*\})*)\}"
_REWRITTEN = [
    (r"(?<=[\d.])(?=[⁻⁺]?[⁰¹²³⁴⁵⁶⁷⁸⁹])", "^"),
    (r"\\[a-z]?frac\s*" + _BRACED + r"\s*" + _BRACED, r"\1/\2"),
    (r"\\(?:num|mathbf|textbf|bf|boldsymbol|mathrm|text|underline)\s*" + _BRACED, r"\1"),
    (r"\{,\}", ","),
    (r"\\,\s*10\s*\^", "×10^"),
    (r"\\,|^[*'\"\s]+|[*'\"\s]+$", ""),
    (r"∞|\\infty", "inf"),
    (r"(?:±|\+/-|\\pm)\s*[\d.]+(?:[eE][-+]?\d+)?", ""),
    (
        r"\s*(?:×|\\times|\\cdot|·|\*|(?<=\d)\s*[xX])\s*10\s*(?:\^|\*\*)\s*[{(]?\s*([-+−⁻]?[\d⁰¹²³⁴⁵⁶⁷⁸⁹]+)\s*[})]?",
        r"e\1",
    ),
    (r"(?<=[\d.])[dDqQ](?=[-+]?\d)", "e"),
    (r"^([-+]?\d*\.\d+)([-+]\d{3})$", r"\1e\2"),
    (r"^([-+]?\d*\.?\d+)\s*\(([-+]\d{1,3})\)", r"\1e\2"),
    (r"(?<=[\d.%])\s*\([^()]*\)$", ""),
    (r"^(\d+)(?:\s*(?:[x×*]|\\times)\s*\1)+$", r"\1"),
    (r"\s*\\?%$", "%"),
]
"""Patterns and the texts that replace them in a cell, one after the other."""
_THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2}(?:[,]\d{3})+(?:\.\d*)?")
_GROUPED = re.compile(r"[-+]?\d{1,3}(?:[ '’]\d{3})+(?:\.\d*)?")
_POINTS_GROUPED = re.compile(r"[-+]?[1-9]\d{0,2}(?:\.\d{3})+")
_DECIMAL_COMMA = re.compile(r"[-+−]?\d*,\d+(?:[eEdD][-+−]?\d+)?\s*%?")
_POWER = re.compile(r"([-+]?\d+(?:\.\d*)?)\s*(?:\^|\*\*)\s*[{(]?\s*([-+]?\d+)\s*[})]?")
_WITH_UNIT = re.compile(r"(?P<number>[-+−*]*[\d.][^a-zA-Z]*(?:[eE][-+−]?\d+)?)\s*(?P<unit>[^\W\d_][\w/%°µ]*|°)[*\s]*")
UNITS = frozenset(
    [
        "m",
        "km",
        "cm",
        "mm",
        "µm",
        "um",
        "nm",
        "s",
        "ms",
        "us",
        "min",
        "kB",
        "MB",
        "GB",
        "KiB",
        "MiB",
        "GiB",
        "°",
        "deg",
        "Pa",
        "kPa",
        "MPa",
        "N",
    ]
)
ALONG_SIDES = re.compile(r"\$?\s*(\d+)(?:\s*(?:[x×]|\\times)\s*\1)+\s*\$?")
WHOLE = re.compile(r"\d+(?:\.0)?|\d{1,3}(?:[ ,'’\u00a0\u202f]\d{3})+")
"""Matches a whole number, also as pandas writes it in a table of floats: 512, 512.0, 1 024, 1,024."""


@cache
def to_number(cell: str, decimal_comma: bool = False) -> float | None:
    """Return the number in a cell; NaN for a cell that is empty or says that a number is missing; None for other text.

    Parameters:
        cell: the text, with or without surrounding blanks.
        decimal_comma: whether ``1,5`` is 1.5 and ``1.024`` is 1024.
    """
    text = cell.strip()
    if not (decimal_comma and _POINTS_GROUPED.fullmatch(text)):
        try:
            return float(text)
        except ValueError:
            pass
    if len(text) > 100:
        return None
    text = re.sub(*_REWRITTEN[0], text).translate(_TRANSLATED).strip()
    if _ABSENT.fullmatch(text):
        return math.nan
    if not re.search(r"\d|∞", text):
        return None
    for pattern, replacement in _REWRITTEN[1:]:
        text = re.sub(pattern, replacement, text)
    if decimal_comma:
        text = re.sub(r"(?<=\d)\.(?=\d{3}(?:\D|$))", "", text).replace(",", ".")
    if _THOUSANDS.fullmatch(text) or _GROUPED.fullmatch(text):
        text = re.sub(r"[ ,'’]", "", text)
    scale = 0.01 if text.endswith("%") else 1.0
    numerator, slash, denominator = text.rstrip("%").partition("/")
    # An error and its order, such as 1.2e-3/1.98, are not a fraction.
    if slash and re.search(r"[eE]", numerator):
        return None
    above, below = _plain(numerator), _plain(denominator) if slash else 1.0
    return scale * above / below if above is not None and below else None


def _plain(text: str) -> float | None:
    """Return the number in a text such as ``2^{10}`` or ``1.5e3``; None for other text."""
    power = _POWER.fullmatch(text.strip())
    try:
        return math.pow(float(power[1]), int(power[2])) if power else float(text)
    except (OverflowError, ValueError):
        return None


def number_and_unit(cell: str) -> tuple[float | None, str]:
    """Return the number in a cell and the unit or word behind it, such as 5 and ``mm`` for ``5 mm``."""
    value = to_number(cell)
    found = _WITH_UNIT.fullmatch(cell.strip()) if value is None and len(cell) < 100 else None
    return (to_number(found["number"].strip("*")), found["unit"]) if found else (value, "")


def is_missing(cell: str, value: float | None) -> bool:
    """Return whether a cell is empty or says that a number is missing; a cell with the text nan has a number.

    Parameters:
        cell: the text.
        value: the result of ``to_number`` for this cell.
    """
    return value is not None and math.isnan(value) and "nan" not in cell.lower()


@cache
def kind_of(cell: str) -> str:
    """Return what a cell contains. A number may have a decimal comma, or a unit behind it; nan is a number."""
    value, unit = number_and_unit(cell)
    if is_missing(cell, value):
        return MISSING
    if value is None or (unit and unit not in UNITS):
        value = to_number(cell, decimal_comma=True)
    return TEXT if value is None else NUMBER


def uses_decimal_commas(cells: list[str]) -> bool | None:
    """Return whether the commas in cells are decimal commas; None if 1,024 may be 1.024 or 1024."""
    commas = [cell for cell in map(str.strip, cells) if "," in cell]
    if any(_DECIMAL_COMMA.fullmatch(cell) and not _THOUSANDS.fullmatch(cell) for cell in commas):
        return True
    grouped = any(_THOUSANDS.fullmatch(cell) for cell in commas)
    # If some cells have decimal points, the commas separate thousands.
    return None if grouped and not any(re.search(r"\d\.\d|\.\d", cell) for cell in cells) else False


# Patterns for names of columns.

_COUNTED = (
    r"cells|elements|elems?|eles?|dofs?|unknowns|nodes|points|vertices|degrees of freedom|grid ?points|"
    r"zellen|elemente|knoten|punkte|unbekannte|freiheitsgrade|mailles|cellules|[ée]l[ée]ments|n(?:oe|œ)uds|inconnues|ddl|"
    r"celdas|elementos|nodos|inc[óo]gnitas|celle|elementi|nodi|incognite"
)
_NUMBER_OF = r"n|number of|no of|total|anzahl(?: der)?|(?:nombre|nb|n[úu]mero)(?: de?| di)?"
_KINDS = {
    "size": r"hs?|h ?max|h ?min|max ?h|lc|d[xyz]|δ ?[xyz]|delta ?[xyz]|(?:mesh|grid|cell|element) "
    r"?(?:size|width|spacing)(?: hs?)?|spacing|resolution (?:k?m|deg)|1/n|1/sqrt\(dofs?\)",
    "count": r"ns?|n ?[xyz] ?[1-3]?|1/h|resolution|cells per (?:side|unit length|direction)",
    "total": rf"(?:(?:{_NUMBER_OF}) |n)?(?:(?:active )?(?:{_COUNTED}))(?: total)?|n ?el?",
    "step": r"dt|δ ?t|delta ?t|tau|τ|(?:time ?step(?: size)?|step ?size)(?: (?:dt|δ ?t|τ|tau))?",
    "level": r"(?:refinement |ref |mesh )?(?:level|lvl|cycle)s?|refinements?|refine",
    "degree": r"(?:polynomial )?(?:degrees?|deg)(?: [pkqr])?|poly(?:nomial)? ?(?:order)?|p",
}
SIZES = ("size", "count", "total", "step")
"""Roles of columns from which mesh sizes or time steps can be computed, the preferred role first."""
_ORDER = (
    r"\b(?:e?oc|eoc|orders?|rates?|roc|ooc|slope|ratio|reduction|quotient|factor|log2|ordnung|ordre|konvergenzrate)\b|"
    r"^(?:q|r|conv|red)$"
)
_METHOD = r"(?:\d+(?:st|nd|rd|th)|first|second|third|fourth|fifth|sixth) orders?(?: (?:scheme|method|elements?))?\)?$"
_ERROR = r"err|fehler|erreur|norm|l ?(?:1|2|inf|∞)\b|h ?[12]\b|linf|l∞|rmse|mae|\|"
_OTHER = (
    r"\b(?:time|times|cpu|wall|runtime|elapsed|seconds|mem|memory|cond|condition|kappa|nnz|iter|iters|iteration|iterations|"
    r"its|niter|newton|cg|gmres|cfl|speedup|efficiency|effectivity|procs|cores|ranks|threads|index|row|id|seed|"
    r"g?flops|steps?|cells|dofs?|ndofs?|elements|nodes|points|step|mesh|grid|"
    r"\w*(?:zeit|dauer|iterationen|schritte)|temps|dur[ée]e|it[ée]rations|tiempo|iteraciones|tempo|iterazioni)\b|"
    r"^(?:t|i|j|k|#|no|nr|)$"
)
_THEORY = r"\b(?:expected|theory|theoretical|predicted)\b"


def role(name: str) -> str:
    """Return the role of a column, which follows from its name.

    The roles are ``error``, ``order``, ``size`` (of a mesh), ``step`` (in time), ``count`` (number of cells along a
    side), ``total`` (number of all cells, vertices or unknowns), ``level``, ``degree`` (of polynomials), ``other``
    (such as times and iterations) and ``unknown``.
    """
    if name.strip(" $") == "T":
        # A column T often has errors of a temperature; the time is called t.
        return "unknown"
    text = re.sub(r"\[.*?\]|\((?:k?m|s|ms|sec|seconds|cm|mm)\)", " ", name)
    text = text.replace("\\Delta", "Δ").replace("\\tau", "τ").replace("\\#", " n ").replace("#", " n ")
    text = re.sub(r"[$*`'\"_{}^\\-]+", " ", text).lower()
    text = re.sub(r"\s+", " ", text).strip(" .:")
    for kind, pattern in _KINDS.items():
        if re.fullmatch(pattern, text):
            return kind
    if re.search(_ORDER, text) and not re.search(_METHOD, text):
        return "order"
    timed = re.search(r"\[(?:s|ms|sec|MB|GB|kB)\]|\((?:s|sec|MB|GB)\)", name)
    is_error = re.search(_ERROR, text)
    if timed or re.search(_THEORY, text) or (re.search(_OTHER, text) and not is_error):
        return "other"
    return "error" if is_error else "unknown"
