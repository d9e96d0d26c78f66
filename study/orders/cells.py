"""Reads the numbers in the cells of a table, and guesses the meaning of a column from its name.

Numbers are understood in the forms in which people write them: 1.2D-3, 1.2(-3), 16x16, 1,5e-3, 1.2×10⁻³, 1/8, 5 %,
−0.5, 1 024, \\num{1e-3}.
"""

import math
import re

MISSING = re.compile(r"(?i)(?:[-–—−_*.…~/\\]*|n/?a|none|null|missing)")
"""Matches a cell that has no number: an empty cell, dashes, n/a."""
THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2}(?:,\d{3})+(?:\.\d*)?")
DECIMAL_COMMA = re.compile(r"[-+−]?\d*,\d+(?:[eEdD][-+−]?\d+)?\s*%?")
UNIT = re.compile(r"(?P<number>.*[\d.])\s*(?P<unit>[kcmnµu]?m|[mµu]?s|min|[kMG]i?B|°|deg|[kM]?Pa|N)")

_DASHES = str.maketrans("−–‐‑⁻", "-----", "\u00a0\u202f\u2009`$")
_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻", "0123456789+-")
_SUPERSCRIPT = re.compile(r"[⁺⁻]?[⁰¹²³⁴⁵⁶⁷⁸⁹]+")
_LATEX = re.compile(r"\\(?:num|mathbf|textbf|bf|boldsymbol|mathrm|text|underline)\s*\{(.*)\}")
_LATEX_FRACTION = re.compile(r"\\[dt]?frac\s*\{([^{}]*)\}\s*\{([^{}]*)\}")
_TIMES_TEN = re.compile(r"\s*(?:×|\\times|\\cdot|·|\*|(?<=\d)\s*[xX])\s*10\s*(?:\^|\*\*)\s*[{(]?\s*([-+]?\d+)\s*[})]?")
_POWER = re.compile(r"(\d+(?:\.\d*)?)\s*(?:\^|\*\*)\s*[{(]?\s*([-+]?\d+)\s*[})]?")
_FORTRAN = re.compile(r"(?<=[\d.])[dDqQ](?=[-+]?\d)")
_NO_LETTER = re.compile(r"([-+]?\d*\.\d+)([-+]\d{3})")
_GROUPED = re.compile(r"[-+]?\d{1,3}(?:[ '’]\d{3})+(?:\.\d*)?")
_POINTS_GROUPED = re.compile(r"[-+]?[1-9]\d{0,2}(?:\.\d{3})+")
WHOLE = re.compile(r"\d+(?:\.0)?|\d{1,3}(?:[ ,'’\u00a0\u202f]\d{3})+")
"""Matches a whole number, also as pandas writes it in a table of floats: 512, 512.0, 1 024, 1,024."""
ALONG_SIDES = re.compile(r"(\d+)(?:\s*[x×]\s*\1)+")
_POWER_IN_BRACKETS = re.compile(r"^([-+]?\d*\.?\d+)\s*\(([-+]\d{1,3})\)")
_UNCERTAINTY = re.compile(r"(?:±|\+/-|\\pm)\s*[\d.]+(?=\s*(?:×|\\times|\\cdot|·)\s*10)")
_REMARK = re.compile(r"(.*[\d.%])\s*(?:\([^()]*\)|±.*|\+/-.*|\\pm.*)")


def to_number(cell: str, decimal_comma: bool = False) -> float | None:
    """Return the number in a cell; NaN for a cell that is empty or says that a number is missing; None for other text.

    Parameters:
        cell: the text, with or without surrounding blanks.
        decimal_comma: whether ``1,5`` is 1.5 and ``1.024`` is 1024.
    """
    try:
        if not (decimal_comma and _POINTS_GROUPED.fullmatch(cell.strip())):
            return float(cell)
    except ValueError:
        pass
    if len(cell) > 100:
        return None
    text = _SUPERSCRIPT.sub(lambda found: "^" + found[0].translate(_SUPERSCRIPTS), cell)
    text = text.translate(_DASHES).strip().strip("*'\"").strip()
    if MISSING.fullmatch(text):
        return math.nan
    text = _UNCERTAINTY.sub("", re.sub(r"\\,\s*10\s*\^", r"\\times10^", text))
    text = _LATEX_FRACTION.sub(r"\1/\2", text).replace("{,}", ",").replace("\\,", "").replace("∞", "inf")
    while found := _LATEX.fullmatch(text):
        text = found[1].strip()
    if decimal_comma:
        text = re.sub(r"(?<=\d)\.(?=\d{3}(?:\D|$))", "", text).replace(",", ".")
    text = _POWER_IN_BRACKETS.sub(r"\1e\2", text)
    if found := _REMARK.fullmatch(text):
        text = found[1].strip()
    if found := ALONG_SIDES.fullmatch(text):
        return float(found[1])
    scale = 1.0
    if text.endswith("%"):
        text, scale = text.rstrip("%").rstrip("\\ "), 0.01
    if THOUSANDS.fullmatch(text):
        text = text.replace(",", "")
    if _GROUPED.fullmatch(text):
        text = re.sub(r"[ '’]", "", text)
    numerator, slash, denominator = _TIMES_TEN.sub(r"e\1", text).partition("/")
    if slash and re.search(r"[eEdD]", numerator):
        return None  # an error and its order, such as 1.2e-3/1.98
    above, below = _plain(numerator), _plain(denominator) if slash else 1.0
    return scale * above / below if above is not None and below else None


def is_missing(cell: str, value: float | None) -> bool:
    """Return whether a cell is empty or says that a number is missing; a cell with the text nan has a number.

    Parameters:
        cell: the text.
        value: the result of ``to_number`` for this cell.
    """
    return value is not None and math.isnan(value) and "nan" not in cell.lower()


def _plain(text: str) -> float | None:
    text = text.strip()
    if found := _POWER.fullmatch(text):
        try:
            return math.pow(float(found[1]), int(found[2]))
        except (OverflowError, ValueError):
            return None
    text = _FORTRAN.sub("e", text)
    if found := _NO_LETTER.fullmatch(text):
        text = f"{found[1]}e{found[2]}"
    try:
        return float(text)
    except ValueError:
        return None


def uses_decimal_commas(cells: list[str]) -> bool | None:
    """Return whether the commas in cells are decimal commas; None if 1,024 may be 1.024 or 1024."""
    commas = [cell for cell in map(str.strip, cells) if "," in cell]
    if any(DECIMAL_COMMA.fullmatch(cell) and not THOUSANDS.fullmatch(cell) for cell in commas):
        return True
    grouped = any(THOUSANDS.fullmatch(cell) for cell in commas)
    # If some cells have decimal points, the commas separate thousands.
    return None if grouped and not any(re.search(r"\d\.\d|\.\d", cell) for cell in cells) else False


# Patterns for names of columns.

_COUNTED = (
    r"cells|elements|elems?|dofs?|unknowns|nodes|points|vertices|degrees of freedom|grid ?points|"
    r"zellen|elemente|knoten|punkte|unbekannte|freiheitsgrade|mailles|cellules|[ée]l[ée]ments|n(?:oe|œ)uds|inconnues|ddl|"
    r"celdas|elementos|nodos|inc[óo]gnitas|celle|elementi|nodi|incognite"
)
_NUMBER_OF = r"n|number of|no of|total|anzahl(?: der)?|(?:nombre|nb|n[úu]mero)(?: de?| di)?"
_KINDS = {
    "size": r"hs?|h ?max|h ?min|max ?h|lc|d[xyz]|δ ?[xyz]|delta ?[xyz]|(?:mesh|grid|cell|element) "
    r"?(?:size|width|spacing)(?: hs?)?|spacing|resolution (?:k?m|deg)|1/n",
    "count": r"ns?|n ?[xyz] ?[1-3]?|1/h|resolution|cells per (?:side|unit length|direction)",
    "total": rf"(?:(?:{_NUMBER_OF}) |n)?(?:(?:active )?(?:{_COUNTED}))(?: total)?",
    "step": r"dt|δ ?t|delta ?t|tau|τ|(?:time ?step(?: size)?|step ?size)(?: (?:dt|δ ?t|τ|tau))?",
    "level": r"(?:refinement |ref |mesh )?(?:level|lvl|cycle)s?|refinements?|refine",
}
SIZES = ("size", "count", "total", "step")
"""Roles of columns from which mesh sizes or time steps can be computed, the preferred role first."""
_ORDER = (
    r"\b(?:e?oc|eoc|orders?|rates?|roc|ooc|slope|ratio|reduction|log2|ordnung|ordre|konvergenzrate)\b|"
    r"^(?:p|q|r|conv|red)$"
)
_METHOD = r"(?:\d+(?:st|nd|rd|th)|first|second|third|fourth|fifth|sixth) orders?(?: (?:scheme|method|elements?))?\)?$"
_ERROR = r"err|fehler|erreur|norm|l ?(?:1|2|inf|∞)\b|h ?[12]\b|linf|l∞|rmse|mae|\|"
_OTHER = (
    r"\b(?:time|times|cpu|wall|runtime|elapsed|seconds|mem|memory|cond|condition|kappa|nnz|iter|iters|iteration|iterations|"
    r"its|niter|newton|cg|gmres|degree|deg|cfl|speedup|efficiency|effectivity|procs|cores|ranks|threads|index|row|id|seed|"
    r"steps?|cells|dofs?|ndofs?|elements|nodes|points|step|mesh|grid|"
    r"\w*(?:zeit|dauer|iterationen|schritte)|temps|dur[ée]e|it[ée]rations|tiempo|iteraciones|tempo|iterazioni)\b|"
    r"^(?:t|i|j|k|#|no|nr|)$"
)
_THEORY = r"\b(?:expected|theory|theoretical|predicted)\b"


def role(name: str) -> str:
    """Return the role of a column, guessed from its name.

    The roles are ``error``, ``order``, ``size`` (of a mesh), ``step`` (in time), ``count`` (number of cells along a
    side), ``total`` (number of all cells, vertices or unknowns), ``level``, ``other`` (such as times and iterations)
    and ``unknown``.
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
    if timed or re.search(_THEORY, text) or (re.search(_OTHER, text) and not re.search(_ERROR, text)):
        return "other"
    return "error" if re.search(_ERROR, text) else "unknown"
