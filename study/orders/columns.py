"""Which column is a mesh size, which are errors, and which are left out and why."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from study.orders.errors import OrderError
from study.orders.numbers import to_number
from study.orders.reading import RawTable

_SIZE = r"h|h ?max|h ?min|d[xyz]|δ ?[xyz]|delta ?[xyz]|(?:mesh|grid|cell|element) ?(?:size|width|spacing)|spacing|resolution (?:k?m|deg)|1/n"  # noqa: E501
_COUNT = r"n|n ?[xyz]|1/h|resolution|cells per (?:side|unit length|direction)"
_TOTAL = (
    r"(?:n |n|number of |no of |total )?(?:(?:active )?cells|elements|elems?|dofs?|unknowns|nodes|points|vertices|"
    r"degrees of freedom|grid ?points)(?: total)?"
)
_STEP = r"dt|δ ?t|delta ?t|tau|τ|time ?step(?: size)?|step ?size"
_LEVEL = r"(?:refinement |ref |mesh )?(?:level|lvl|cycle)s?|refinements?|refine"
_ORDER = r"\b(?:e?oc|eoc|orders?|rates?|roc|ooc|slope|ratio|reduction|log2|ordnung|ordre|konvergenzrate)\b|^(?:p|q|r|conv|red)$"  # noqa: E501
_METHOD = r"(?:\d+(?:st|nd|rd|th)|first|second|third|fourth|fifth|sixth) orders?$"
_ERROR = r"err|fehler|erreur|norm|l ?(?:1|2|inf|∞)\b|h ?[12]\b|linf|l∞|rmse|mae|\|"
_OTHER = (
    r"\b(?:time|times|cpu|wall|runtime|elapsed|seconds|mem|memory|cond|condition|kappa|nnz|iter|iters|iteration|iterations|"
    r"its|niter|newton|cg|gmres|degree|deg|cfl|speedup|efficiency|effectivity|procs|cores|ranks|threads|index|row|id|seed|"
    r"steps?|expected|theory|cells|dofs?|ndofs?|elements|nodes|points|step|mesh|grid)\b|^(?:t|i|j|k|#|no|nr|)$"
)


def role(name: str) -> str:
    """size, count, total, step, level, order, error, other, or unknown."""
    if name.strip(" $") == "T":
        # A temperature; time is t.
        return "unknown"
    text = re.sub(r"\[.*?\]|\((?:k?m|s|ms|sec|seconds|cm|mm)\)", " ", name)
    text = text.replace("\\Delta", "Δ").replace("\\tau", "τ").replace("\\", " ").replace("#", " n ")
    text = re.sub(r"[$*`'\"_{}^-]+", " ", text).lower()
    text = re.sub(r"\s+", " ", text).strip(" .:")
    for kind, pattern in (("size", _SIZE), ("count", _COUNT), ("total", _TOTAL), ("step", _STEP), ("level", _LEVEL)):
        if re.fullmatch(pattern, text):
            return kind
    if re.search(_ORDER, text) and not re.search(_METHOD, text):
        return "order"
    if re.search(r"\[(?:s|ms|sec|MB|GB|kB)\]|\((?:s|sec|MB|GB)\)", name) or (
        re.search(_OTHER, text) and not re.search(_ERROR, text)
    ):
        return "other"
    return "error" if re.search(_ERROR, text) else "unknown"


@dataclass(frozen=True)
class Series:
    """Mesh sizes, columns of errors, and words on what was recognised."""

    h: list[float]
    errors: dict[str, list[float]]
    size: str
    ignored: dict[str, str]
    caption: str
    form: str

    @property
    def recognised(self) -> str:
        """One line: size, errors, ignored columns."""
        ignored = f"; ignored: {', '.join(self.ignored)}" if self.ignored else ""
        return f"read as {self.form}; size: {self.size}; errors: {', '.join(self.errors)}{ignored}"


def choose(table: RawTable, dim: int | None = None, size: str | None = None, ratio: float | None = None,
           columns: list[str] | None = None, signed: bool = False) -> Series:  # fmt: skip
    """Sizes and errors of a table.

    Parameters:
        dim: dimension of the meshes, for sizes given as counts of cells or unknowns.
        size: name of the column of sizes.
        ratio: ratio of consecutive mesh sizes, coarse to fine, for tables without a size.
        columns: names of the columns of errors to take.
        signed: whether values below zero are allowed.

    Raises:
        OrderError: no size, more than one reading of it, no errors, or a cell that is no positive number.
    """
    names = [name if table.names.count(name) == 1 else f"{name} ({k + 1})" for k, name in enumerate(table.names)]
    cells = {name: [row[k] for row in table.rows] for k, name in enumerate(names)}
    values = {name: [to_number(cell) for cell in column] for name, column in cells.items()}
    roles = {name: role(table.names[k]) for k, name in enumerate(names)}
    for name in names:
        numbers = values[name]
        if (
            roles[name] == "unknown"
            and all(cell.strip().isdigit() for cell in cells[name])
            and (reason := _is_counter(numbers))
        ):
            roles[name] = reason
        if roles[name] == "count" and numbers in [list(map(float, range(j, j + len(numbers)))) for j in (0, 1)]:
            roles[name] = (
                "other"
                if any(role(other) in ("size", "count", "total") for other in names if other != name)
                else "count"
            )
        if re.fullmatch(r".+ N", table.names[names.index(name)], re.IGNORECASE) and numbers == values[names[0]]:
            roles[name] = "count" if name == names[0] else "other"
    sizes, words, size_name = _sizes(names, values, roles, dim, size, ratio, len(table.rows))
    ignored: dict[str, str] = {}
    errors: dict[str, list[float]] = {}
    for name in names:
        text = [value for value in values[name] if value is not None]
        if columns is not None:
            wanted = name in columns
        else:
            wanted = roles[name] in ("error", "unknown") and name != size_name and bool(text)
        if name == size_name:
            continue
        if not wanted:
            ignored[name or "(no name)"] = roles[name] if text else "text"
            continue
        errors[name] = _checked(name, cells[name], table.lines, signed)
    if columns is not None and (unknown := [name for name in columns if name not in names]):
        raise OrderError(f"there is no column {', '.join(unknown)}; there are {', '.join(filter(None, names))}")
    if not errors:
        raise OrderError(f"no column of errors among {', '.join(filter(None, names))}: name it with --columns")
    if sizes is None:
        ratio = _printed_ratio(names, values, errors, roles)
        if ratio is None:
            raise OrderError(
                f"no column is a mesh size; seen: {', '.join(filter(None, names))}. Give --ratio 2 if each mesh is twice as "  # noqa: E501
                "fine as the one above, or --in NAME for the column of sizes"
            )
        sizes, words = _from_ratio(ratio, len(table.rows)), f"ratio {ratio:g}, which follows from the printed orders"
    for k, value in enumerate(sizes):
        if not (math.isfinite(value) and value > 0):
            cell = cells[size_name][k] if size_name in cells else value
            raise OrderError(f"line {table.lines[k]}: {size_name} = {cell}, but sizes must be positive and finite")
        if value in sizes[:k]:
            raise OrderError(
                f"line {table.lines[k]}: {size_name} = {cells[size_name][k]} stands in line "
                f"{table.lines[sizes.index(value)]} already, expected another size on every mesh: remove one of the rows"  # noqa: E501
            )
    return Series(sizes, errors, words, ignored, table.caption, table.form)


def _is_counter(numbers: list[float | None]) -> str:
    """A word for columns that are integers growing from row to row or constant; empty for others."""
    found = [value for value in numbers if value is not None and math.isfinite(value)]
    if len(found) < 2 or len(found) < len(numbers) or any(value != round(value) for value in found):
        return ""
    steps = np.diff(found)
    return "other" if (steps > 0).all() or ((steps == 0).all() and found[0] > 0) else ""


def _sizes(names: list[str], values: dict[str, list[float | None]], roles: dict[str, str], dim: int | None,
           chosen: str | None, ratio: float | None, rows: int) -> tuple[list[float] | None, str, str]:  # fmt: skip
    """(sizes, words on them, name of the column); no sizes if the table has none."""
    if ratio is not None:
        if not (math.isfinite(ratio) and ratio > 0 and ratio != 1):
            raise OrderError(f"--ratio must be positive and not 1, got {ratio:g}")
        return _from_ratio(ratio, rows), f"ratio {ratio:g}", "(none)"
    if chosen is not None:
        name = chosen if chosen in names else next((n for n in names if n.lower() == chosen.lower()), None)
        if name is None and "" in names and chosen.lower() in ("h", "n"):
            return _convert("", values[""], "size" if chosen.lower() == "h" else "count", dim)
        if name is None:
            raise OrderError(f"--in {chosen}: there is no such column; there are {', '.join(filter(None, names))}")
        kind = roles[name] if roles[name] in ("size", "count", "total", "step") else "size"
        return _convert(name, values[name], kind, dim)
    if (
        names[:1] == [""]
        and roles[""] == "other"
        and not any(role in ("size", "count", "total", "step") for role in roles.values())
        and not all(value == k or value == k + 1 for k, value in enumerate(values[""]))
    ):
        first = values[""][0]
        raise OrderError(
            f"the sizes {first:g}, … have no name: give --in n if they count cells per side, --in h if they are lengths"
        )
    for kind in ("size", "count", "total", "step"):
        found = [name for name in names if roles[name] == kind and len(set(values[name])) > 1]
        if len(found) > 1 and kind == "size" and len(set(map(str.lower, found))) < len(found):
            raise OrderError(f"the sizes may be {' or '.join(found)}: choose with --in {found[0]} or --in {found[1]}")
        if found:
            return _convert(found[0], values[found[0]], kind, dim)
    levels = [name for name in names if roles[name] == "level"]
    if levels:
        raise OrderError(
            f"the only size is the level in column {levels[0]}: give --ratio 2 if each level halves the mesh size"
        )
    return None, "", ""


def _convert(name: str, numbers: list[float | None], kind: str, dim: int | None) -> tuple[list[float], str, str]:
    """Mesh sizes from the numbers in a column."""
    found = [math.nan if value is None else value for value in numbers]
    label = name or "n"
    if kind in ("size", "step"):
        return found, f"{'Δt' if kind == 'step' else 'h'} from column {label}", name
    if any(value <= 0 for value in found):
        return [math.nan if value <= 0 else 1 / value for value in found], label, name
    growth = [max(b / a, a / b) for a, b in pairwise(found)]
    if dim is None and (kind == "total" or (growth and min(growth) >= 3.5)):
        raise OrderError(
            f"column {label} is a count: h = 1/{label} if it counts cells along one side (--dim 1), h = {label}^(-1/2) if it "  # noqa: E501
            f"counts all cells or unknowns in the plane (--dim 2), {label}^(-1/3) in space (--dim 3); give --dim"
        )
    power = dim or 1
    words = f"h = 1/{label}" if power == 1 else f"h = {label}^(-1/{power})"
    return [value ** (-1 / power) for value in found], f"{words} from column {label}", name


def _from_ratio(ratio: float, rows: int) -> list[float]:
    return [max(ratio, 1 / ratio) ** -k if ratio > 1 else ratio**k for k in range(rows)]


def _printed_ratio(names: list[str], values: dict[str, list[float | None]], errors: dict[str, list[float]],
                   roles: dict[str, str]) -> float | None:  # fmt: skip
    """The ratio of mesh sizes with which the orders printed beside the errors were computed; None if there is none."""
    logs = []
    for error, order in pairwise(names):
        if error not in errors or roles[order] != "order":
            continue
        for k in range(1, len(errors[error])):
            p, a, b = values[order][k], errors[error][k - 1], errors[error][k]
            if p is not None and math.isfinite(p) and abs(p) > 0.3 and a > 0 and b > 0:
                logs.append((math.log(a / b), p))
    if not logs:
        return None
    middle = math.exp(float(np.median([change / p for change, p in logs])))
    for ratio in (2.0, math.sqrt(2), 1.5, 3.0, 4.0, 10.0):
        if abs(middle - ratio) < 0.03 * ratio and all(
            abs(change / math.log(ratio) - p) < 0.02 + 0.01 * abs(p) for change, p in logs
        ):
            return ratio
    return None


def _checked(name: str, cells: list[str], lines: list[int], signed: bool) -> list[float]:
    """The numbers of a column of errors; infinite where the text says nan."""
    found = []
    for cell, line in zip(cells, lines, strict=True):
        value = to_number(cell)
        if value is None or (math.isnan(value) and "nan" not in cell.lower()):
            what = f"is '{cell}', not a number" if value is None else "is missing"
            raise OrderError(f"line {line}: the entry of {name} {what}")
        if value < 0 and not signed:
            raise OrderError(f"line {line}: {name} = {cell}, but errors must not be negative: give absolute values")
        found.append(math.inf if math.isnan(value) else value)
    return found
