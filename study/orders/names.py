"""What the name of a column says about its numbers."""

from __future__ import annotations

import re

_COUNTED = r"cells|elements|elems?|dofs?|unknowns|nodes|points|vertices|degrees of freedom|grid ?points"
_KINDS = {
    "size": r"hs?|h ?max|h ?min|max ?h|lc|d[xyz]|δ ?[xyz]|delta ?[xyz]|(?:mesh|grid|cell|element) "
    r"?(?:size|width|spacing)(?: hs?)?|spacing|resolution (?:k?m|deg)|1/n",
    "count": r"ns?|n ?[xyz] ?[1-3]?|1/h|resolution|cells per (?:side|unit length|direction)",
    "total": rf"(?:n |n|number of |no of |total )?(?:(?:active )?(?:{_COUNTED}))(?: total)?",
    "step": r"dt|δ ?t|delta ?t|tau|τ|(?:time ?step(?: size)?|step ?size)(?: (?:dt|δ ?t|τ|tau))?",
    "level": r"(?:refinement |ref |mesh )?(?:level|lvl|cycle)s?|refinements?|refine",
}
SIZES = ("size", "count", "total", "step")
"""Roles of columns that tell the size of a mesh or of a time step, the preferred one first."""
_ORDER = (
    r"\b(?:e?oc|eoc|orders?|rates?|roc|ooc|slope|ratio|reduction|log2|ordnung|ordre|konvergenzrate)\b|"
    r"^(?:p|q|r|conv|red)$"
)
_METHOD = r"(?:\d+(?:st|nd|rd|th)|first|second|third|fourth|fifth|sixth) orders?$"
_ERROR = r"err|fehler|erreur|norm|l ?(?:1|2|inf|∞)\b|h ?[12]\b|linf|l∞|rmse|mae|\|"
_OTHER = (
    r"\b(?:time|times|cpu|wall|runtime|elapsed|seconds|mem|memory|cond|condition|kappa|nnz|iter|iters|iteration|iterations|"
    r"its|niter|newton|cg|gmres|degree|deg|cfl|speedup|efficiency|effectivity|procs|cores|ranks|threads|index|row|id|seed|"
    r"steps?|cells|dofs?|ndofs?|elements|nodes|points|step|mesh|grid)\b|^(?:t|i|j|k|#|no|nr|)$"
)
_THEORY = r"\b(?:expected|theory|theoretical|predicted)\b"


def role(name: str) -> str:
    """``error``, ``order``, ``size``, ``count``, ``total``, ``step`` (of time), ``level``, ``other`` or ``unknown``.

    A ``count`` is a number along a side, a ``total`` a number of all cells, vertices or unknowns.
    """
    if name.strip(" $") == "T":
        # A temperature; time is t.
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
