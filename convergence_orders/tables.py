"""Cuts a text into tables: finds rows, columns and names in the forms in which people paste tables.

A text is JSON, or lists ``name = [1, 2, 3]`` and ``name: 1, 2, 3``, or lines whose cells are separated by pipes, ``&``,
tabs, semicolons, commas or blanks, or lines ``name = value``. What a column means is decided in ``columns.py``.
"""

import csv
import json
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import count, pairwise, repeat
from typing import Any

from .cells import SIZES, kind_of, role, to_number
from .orders import OrderError

MAX_BYTES = 8_000_000
MAX_LINES, MAX_LINE, MAX_CELL = 100_000, 130_000, 2_000
EXAMPLE = "expected a header such as 'h,error' and one line for each mesh, for example '0.5,0.1', '0.25,0.025'"


@dataclass(frozen=True)
class Table:
    """A table with names of columns and cells as text.

    Attributes:
        form: the form of the table in words, such as ``CSV``.
        names: names of the columns; an empty text for a column without a name.
        rows: the cells, one list for each mesh.
        lines: the line number of each row in the text.
        breaks: indices of the rows with a blank line, a rule or other lines above them.
        caption: the text above the table.
    """

    form: str
    names: list[str]
    rows: list[list[str]]
    lines: list[int]
    breaks: frozenset[int] = frozenset()
    caption: str = ""


def read_tables(data: bytes | str) -> list[Table]:
    """Return all tables in a text, in the order in which they occur.

    Parameters:
        data: the text, or the content of a file.

    Raises:
        OrderError: no table is recognised, a row has too few or too many cells, or the input is too large.
    """
    text = decode(data) if isinstance(data, bytes) else data
    if not text.strip():
        raise OrderError(f"it is empty; {EXAMPLE}")
    if tables := _json(text):
        return tables
    lines = _lines(text)
    for cut in (_lists, _grids, _records):
        if tables := cut(lines):
            return [replace(table, names=[_norms(name) for name in table.names]) for table in tables]
    first = next((line.text.strip() for line in lines if re.search(r"\d", line.text)), "")
    said = f"the first line with a number is '{shorten(first)}'" if first else "no line with numbers"
    raise OrderError(f"no table was recognised, {said}; {EXAMPLE}")


def decode(data: bytes) -> str:
    """Return the text in bytes that are encoded in UTF-8, UTF-16 with its mark, or Windows-1252.

    Raises:
        OrderError: there are more than 8 MB, or the bytes are not text.
    """
    if len(data) > MAX_BYTES:
        raise OrderError(f"it has more than 8 MB; {EXAMPLE}")
    wide = data[:2] in (b"\xff\xfe", b"\xfe\xff")
    for encoding in ["utf-16"] if wide else ["utf-8-sig", "cp1252"]:
        try:
            text = data.decode(encoding)
        except UnicodeDecodeError:
            continue
        if control := re.search(r"[\0-\x08\x0e-\x1a\x1c-\x1f]", text):
            line = text.count("\n", 0, control.start()) + 1
            raise OrderError(f"line {line} contains {control[0]!r}: a binary file? Save the table as text in UTF-8")
        return text
    raise OrderError("it is not text but binary: save the table as text in UTF-8")


def _norms(text: str) -> str:
    """Return a text with the signs of norms that ``_CLEANED`` replaced."""
    return text.replace("‖", "\\|").replace("¦", "|")


def shorten(text: str, width: int = 60) -> str:
    """Return a text with at most ``width`` signs."""
    return text if len(text) <= width else text[: width - 1] + "…"


# Lines without the signs of LaTeX, Markdown and programs.

_RULED = r"(?:\\(?:[a-z]*(?:rule|line)|rowcolor|addlinespace)(?:\{[^{}\n]*\}|\[[^]\n]*\]|\([^)\n]*\))*[ \t]*)"
_ROW_END = r"(?:\\\\(?:\[[^]\n]*\])?|\\tabularnewline|[ \t]\\)[ \t]*"
_BRACED = r"\{((?:[^{}\n]|\{(?:[^{}\n]|\{[^{}\n]*\})*\}){0,200})\}"
_SPANNED = re.compile(r"\\multicolumn\{([1-8])\}\{(?:[^{}\n]|\{[^{}\n]*\}){0,80}\}" + _BRACED)
_VARIABLES = re.compile(r'(?m)^\s*VARIABLES\s*=\s*"(.*)"')
_COMPUTED = re.compile(r"(?<!\S)(\S{1,30}) \((?:computed|numerical)\),? +(\S+) \((?:analytical|exact|reference)\)")
GAP = "\x1e"
"""Sign behind a line with a rule below it."""
_CLEANED: list[tuple[str, str]] = [
    (r"\x1b\[[0-9;]*[A-Za-z]|[\u200b\ufeff]", ""),
    (r"\r\n|\r", "\n"),
    (r"[│┃║┆]", "|"),
    (r"\b(?:(?:np\.|numpy\.)?float\d*|tensor|array)\(([^()\[\]]*)\)", r"\1"),
    (r"(?m)^\s*\[\d+,\]", "      "),
    (r"(?m)^(?:[ \t]*[>*](?:[ \t]|$))+", ""),
    (r"=[ \t]*[^\W\d]\w*[ \t]*(?==)", ""),
    (r'(?m)^\s*ZONE\s+T\s*=\s*"([^"\n]*)"', r"\1"),
    (r"&[ \t]*\n(.*)\n", r"& \1\n\n"),
    (r"(?m)^[ \t]*(?:\\(?:begin|end|label|centering|small|tabcolsep)|```|@f|\.\. code).*$", ""),
    (r"(?m)^[ \t]*\\caption\{(.*)\}", r"\1"),
    (rf"(?m){_ROW_END}{_RULED}+$", GAP),
    (rf"(?m){_ROW_END}$", ""),
    (rf"(?m)^(?:[\s|+:=_#*~.─━═┼╪┌┐└┘├┤┬┴╞╡╤╧╭╮╯╰╌╍-]|{_RULED})*$", ""),
    (rf"(?m)^[ \t]*{_RULED}+", ""),
    (rf"\\multirow(?:\[\w+\])?\{{[^{{}}\n]*\}}\{{[^{{}}\n]*\}}{_BRACED}", r"\1"),
    (r"\\\|", "‖"),
    (r"\|\|(?=[^|\n]*[^|\n\d.\s][^|\n]*\|\|)([^|\n]+)\|\|", r"¦¦\1¦¦"),
]
"""Patterns and the texts that replace them, one after the other; none of them changes the number of lines."""


@dataclass(frozen=True)
class Line:
    """A line of a text: its number, its text without the sign of a comment, and what stands around it.

    Attributes:
        gap: whether a blank line or a rule is above it.
        comment: whether the line is a comment.
    """

    number: int
    text: str
    gap: bool
    comment: bool


def _lines(text: str) -> list[Line]:
    """Return the lines that may belong to a table.

    Raises:
        OrderError: the text has too many lines, or a cell is too long.
    """
    if text.count("\n") > MAX_LINES:
        raise OrderError(f"it has more than {MAX_LINES} lines: a table of errors has one line for each mesh; {EXAMPLE}")
    if max(map(len, text.split("\n"))) > MAX_LINE:
        raise OrderError(f"it has a line of more than {MAX_LINE} characters; {EXAMPLE}")
    if long := re.search(rf"(?<![^\s,;|&])[^\s,;|&]{{{MAX_CELL},}}", text):
        raise OrderError(f"it has a cell of {len(long[0])} characters; {EXAMPLE}")
    for pattern, replacement in _CLEANED:
        text = re.sub(pattern, replacement, text)
    text = _SPANNED.sub(lambda found: found[2] + " &" * (int(found[1]) - 1), text)
    text = _VARIABLES.sub(lambda found: re.sub(r'"[, ]+"', "\t", found[1]), text)
    text = _COMPUTED.sub(_difference, text)
    lines: list[Line] = []
    gap = False
    for number, line in enumerate(text.split("\n"), start=1):
        filled = re.search(r"\w", line)
        if filled:
            bare = re.sub(r"^\s*(?:#+|%+|//|!)[ \t]*(?=\S)", "", line)
            lines.append(Line(number, bare.rstrip(GAP), gap, bare != line))
        gap = line.endswith(GAP) or not filled
    return lines


def _difference(found: re.Match[str]) -> str:
    """Return the error of a computed value beside an exact one."""
    computed, exact = to_number(found[1]), to_number(found[2])
    return found[0] if computed is None or exact is None else f"{abs(computed - exact):.9g}"


# Grids: rows of cells below a header.

_FORMS = {
    "|": "columns separated by |",
    "&": "LaTeX rows",
    "\t": "columns separated by tabs",
    ";": "columns separated by semicolons",
    ",": "CSV",
    " ": "columns separated by blanks",
}
"""Separator ↦ the form of a table in words; the first separator that divides lines into cells with numbers is taken."""
_WITHIN_NUMBER = re.compile(r"(?<=[\d.])\s+(%(?!\S)|(?:±|\+/-|\\pm|x|×|\\times|\\cdot|·)\s*(?=\d))")
_SUMMARY = re.compile(
    r"(?i)\W*(?:mean|average|avg|overall|total|fit|fitted|slope|eoc|rate|order|median|min|max|theo\w*|expected)\b"
)
_UNIT = re.compile(
    r"(?i)u?int\d*|float\d*\??|[fiu]\d+|<\w+>|str(?:ing)?|double|real|\[.*\]|\(.*\)|[-–—1%]?|[kcmµ]?m|m?s"
)


class Row:
    """A line that is divided into cells.

    Attributes:
        line: the line.
        cells: the cells.
        places: beginning and end of each cell, if blanks separate the cells.
        kinds: what the cells contain, one letter for each: 9 for a number, - for a missing number, a for other text.
    """

    def __init__(self, line: Line, sign: str) -> None:
        self.line = line
        self.places: list[tuple[int, int]] = []
        if sign == " ":
            # A bar or comma between blanks is no cell.
            joined = _WITHIN_NUMBER.sub(lambda found: found[1].strip(), line.text)
            found = list(re.finditer(r"(?![|,](?!\S))\S+", joined))
            self.cells = [cell[0] for cell in found]
            self.places = [cell.span() for cell in found]
        else:
            text = re.sub(r"^\s*\||\|\s*$", "", line.text) if sign == "|" else line.text.strip("\n ")
            (cells,) = csv.reader([text], delimiter=sign, skipinitialspace=True)
            self.cells = [cell.strip() for cell in cells]
        self.kinds = "".join(map(kind_of, self.cells))

    @property
    def is_data(self) -> bool:
        """Whether the line may be a row of a table: at least half of its cells are numbers or missing."""
        filled = len(self.cells) - self.cells.count("")
        enough = "9" in self.kinds and filled > 1 and filled >= 2 * self.kinds.count("a")
        return enough and not self.line.comment and len(re.findall(r"=|:\s", self.line.text)) < 2

    def cut(self, width: int) -> None:
        """Leave out the cells behind the first ones."""
        self.cells, self.kinds = self.cells[:width], self.kinds[:width]


def _grids(lines: list[Line]) -> list[Table]:
    """Return the tables whose cells are separated by a sign or by blanks."""
    rows = {sign: [Row(line, sign) for line in lines] for sign in _FORMS}
    scores = {sign: sum(row.kinds.count("9") for row in rows[sign] if row.is_data) for sign in _FORMS}
    sign = next((sign for sign in _FORMS if 2 * scores[sign] > max(scores.values())), "")
    return _blocks(rows[sign], sign) if sign else []


def _blocks(rows: list[Row], sign: str) -> list[Table]:
    """Return the tables in the rows of a text. A table is a block of rows with a header above it."""
    # Where rows begin with words, "mean" may be the name of a row. Elsewhere it begins a line that sums up a column.
    first = Counter(row.kinds[0] for row in rows if row.is_data)
    named = first["a"] > first["9"]
    tables: list[Table] = []
    above: list[Row] = []
    block: list[Row] = []
    breaks: list[int] = []
    for row, following in pairwise([*rows, rows[-1]]):
        sums_up = not named and _SUMMARY.match(row.cells[0] or " ".join(row.cells))
        left_out = row.line.comment or sums_up
        if not left_out and _is_data(row, following, block, sign):
            if row.line.gap or (block and above and above[-1].line.number > block[-1].line.number):
                breaks.append(len(block))
            block.append(row)
        elif block and left_out and row.kinds.strip("a"):
            above.append(row)
        else:
            tables += _table(above, block, breaks, tables, sign)
            above = [row] if block else [*above, row]
            block, breaks = [], []
    return tables + _table(above, block, breaks, tables, sign)


def _is_data(row: Row, following: Row, block: list[Row], sign: str) -> bool:
    """Return whether a line is a row of a table; words behind the numbers of a row are cut off.

    Parameters:
        row, following: the line and the next one.
        block: the rows of the table above the line.
        sign: the sign that separates cells.

    Raises:
        OrderError: the line has words where the table has numbers. The computation on this mesh may have failed, so the
            line must not be left out.
    """
    if sign != " ":
        return row.is_data or (bool(block) and "9" in row.kinds and len(row.cells) == len(block[0].cells))
    model = block[0].kinds if block else following.kinds
    width = row.kinds.find("a")
    if width < 0 or row.is_data:
        # A line such as "Table 1" above a header is a caption, and "Elapsed 12.3" below rows of numbers is no row.
        return row.is_data and (width != 0 or (model[0] == "a" and "9" in model))
    if block and model[0] == "9" and 0 < width < len(model):
        raise OrderError(
            f"line {row.line.number}, '{shorten(row.line.text.strip())}', begins like a row of the table, but has "
            "words where numbers are expected: write the numbers, or nan if the computation failed, or # before it"
        )
    if width > 1:
        row.cut(width)
    return width > 1


def _table(above: list[Row], block: list[Row], breaks: list[int], before: list[Table], sign: str) -> list[Table]:
    """Return the table that consists of a block of rows, in a list; the list is empty if it is not a table.

    Parameters:
        above: the lines above the block; the nearest one with a name for each column is the header.
        block: the rows.
        breaks: indices of the rows with a gap above.
        before: tables above the block. If the block has no header, it gets the header of the last one.
        sign: the sign that separates cells.
    """
    if not block:
        return []
    if across := _across(block):
        return [across]
    rows = _aligned(block, sign)
    names, header = _header(above, block, rows, sign)
    if not names and before and len(before[-1].names) == len(rows[0]):
        names = before[-1].names
    if not names and len(block) < 2:
        return []
    if not names:
        line = block[0].line
        raise OrderError(
            f"the table that begins in line {line.number}, '{shorten(line.text.strip())}', has {len(rows[0])} "
            "columns, but no line above names them: add a header such as 'h error'"
        )
    captions = [row.line.text.strip() for row in above if row not in header]
    captions = [text for text in captions if not _SUMMARY.match(text) and text[0] not in "\\@."]
    lines = [row.line.number for row in block]
    return [Table(_FORMS[sign], names, rows, lines, frozenset(breaks), shorten("".join(captions[-1:]), 100))]


def _aligned(block: list[Row], sign: str) -> list[list[str]]:
    """Return lines as rows with equal numbers of cells.

    If columns are separated by blanks, the position of the other cells shows which cell of a line is empty.
    """
    usual = Counter(len(row.cells) for row in block).most_common(1)[0][0]
    width = usual
    for row in block:
        # Words behind the numbers of a row are a remark.
        if set(row.kinds[usual:]) <= {"a" if sign == " " else "-"}:
            row.cut(usual)
        width = max(width, len(row.cells))
    model = next(row.places for row in block if len(row.cells) == width)
    rows = []
    for row in block:
        places = map(_nearest, row.places, repeat(model)) if sign == " " and len(row.cells) < width else count()
        cells = dict(zip(places, row.cells, strict=False))
        if len(cells) < len(row.cells) or (len(cells) < width and sign in ",;") or (width > usual and sign != " "):
            text = shorten(row.line.text.strip())
            raise OrderError(f"line {row.line.number}: {len(row.cells)} entries, expected {usual}: '{text}'")
        rows.append([cells.get(k, "") for k in range(width)])
    return rows


def _nearest(place: tuple[int, int], model: list[tuple[int, int]]) -> int:
    """Return the index of the place in ``model`` that shares most characters with a place, or is nearest to it."""
    shared = [min(place[1], end) - max(place[0], start) for start, end in model]
    return shared.index(max(shared))


def _header(above: list[Row], block: list[Row], rows: list[list[str]], sign: str) -> tuple[list[str], list[Row]]:
    """Return the names of columns in the nearest header above a table, and its lines; empty lists without a header."""
    units = [row for row in above if all(map(_UNIT.fullmatch, row.cells))]
    lines = [row for row in above if row not in units]
    for number, row in reversed([*enumerate(lines)]):
        upper = lines[number - 1] if number else None
        names = _names(row, block, rows, sign)
        if names and all(re.search(r"[^\W\d_]|[#‖¦|]", name) for name in names if name):
            grouped = _grouped(upper, names, sign) if upper and row.line.number - upper.line.number <= 2 else []
            return grouped or names, [row, *units, *([upper] if upper and grouped else [])]
    return [], []


def _headings(text: str) -> list[str]:
    """Return the headings in a line that are separated by two or more blanks; single bars or commas do not count."""
    return re.findall(r"\S+(?: \S+)*", re.sub(r"(?<!\S)[|,](?!\S)", " ", text))


def _names(row: Row, block: list[Row], rows: list[list[str]], sign: str) -> list[str]:
    """Return the names of columns in a line; an empty list if the line does not name the columns.

    A name may be missing for columns of orders, whose first cell is missing, and for the first column if it only counts
    the rows.
    """
    width = len(rows[0])
    if sign != " ":
        cells = [*row.cells, *[""] * (width - len(row.cells))]
        return [] if len(row.cells) < 2 or any(cells[width:]) else cells[:width]
    counts = [to_number(cells[0]) for cells in rows]
    index = len(rows) > 1 and counts in ([*range(len(rows))], [*range(1, len(rows) + 1)])
    every = [*range(width)]
    named = [k for k in every if len(rows) < 2 or kind_of(rows[0][k]) != "-"]
    for names in (_headings(row.line.text), _placed(row, block, named), row.line.text.split()):
        for columns in (every, named, every[index:], named[index:]):
            if len(columns) == len(names) > 1:
                known = dict(zip(columns, names, strict=True))
                return [known.get(k, "") for k in every]
    return []


def _placed(row: Row, block: list[Row], named: list[int]) -> list[str]:
    """Return the names of columns that follow from the places of the words in the header; empty if a column has none.

    Parameters:
        row, block: the header and the rows below it.
        named: indices of the columns that need a name; the columns of orders to the right of each need none.
    """
    width = max(len(other.cells) for other in block)
    ends = [0, *(max(other.places[k][1] for other in block if len(other.cells) == width) for k in range(width))]
    regions = [(ends[k], ends[after]) for k, after in pairwise([*named, width])]
    names = [""] * len(named)
    for word in re.finditer(r"\S+", row.line.text):
        k = _nearest(word.span(), regions)
        names[k] = f"{names[k]} {word[0]}".strip()
    return names if all(names) and len(_headings(row.line.text)) > 1 else []


def _grouped(upper: Row, names: list[str], sign: str) -> list[str]:
    """Return names of columns that are joined with the headings above them; empty if the columns form no groups.

    The names to the right of some columns must be repeated once for each heading, as in ``error order error order``.
    A heading replaces a name such as ``error``. But a heading such as h is joined with the name, because an error of a
    quantity h must not be taken as the mesh size.
    """
    for start in range(len(names)):
        headings = _headings(upper.line.text) if sign == " " else [*filter(None, upper.cells[start:])]
        group = names[start : start + (len(names) - start) // max(len(headings), 1)]
        if len(headings) > 1 and names[start:] == group * len(headings):
            left = [name or cell for name, cell in zip(names[:start], upper.cells, strict=False)]
            full = [(heading, name) for heading in headings for name in group]
            return left + [
                name
                if role(name) in SIZES
                else heading
                if re.fullmatch(r"(?i)err(?:or)?s?|e", name) and role(heading) not in SIZES
                else f"{heading} {name}".strip()
                for heading, name in full
            ]
    return []


# Tables with one line or one list for each quantity.


def _across(block: list[Row]) -> Table | None:
    """Return the table with one line for each quantity and one column for each mesh; None if it is no such table."""
    columns: dict[str, list[str]] = {}
    for row in block:
        width = len(row.kinds) - len(row.kinds.lstrip("a"))
        name = " ".join(row.cells[:width]).strip(" :=")
        columns[name] = row.cells[width:]
        if not width or "a" in row.kinds[width:] or len(columns[name]) < 2:
            return None
    number = block[0].line.number
    if any(role(name) in SIZES for name in columns):
        return _from_columns("one line for each quantity", columns, number)
    if not all(map(_orders_between, columns.values())):
        return None
    # The AMReX library prints errors and orders in turn: error order error order error.
    for name, values in list(columns.items()):
        columns |= {name: values[::2], f"order of {name}": ["", *values[1::2]]}
    return _from_columns("one line for each quantity, orders between the errors", columns, number)


def _orders_between(values: list[str]) -> bool:
    """Return whether errors and orders stand in turn, and all orders are right for halved mesh sizes."""
    numbers = [to_number(cell) or 0.0 for cell in values]
    triples = zip(numbers[::2], numbers[1::2], numbers[2::2], strict=False)
    right = [not fine or (abs(p) < 99 and abs(coarse / fine / 2**p - 1) < 0.02) for coarse, p, fine in triples]
    return len(values) % 2 == 1 and all(right)


def _from_columns(form: str, columns: dict[str, list[str]], number: int = 1) -> Table:
    """Return the table with the given columns; a column of orders may lack its first cell.

    Raises:
        OrderError: the columns have different lengths.
    """
    length = max(map(len, columns.values()))
    for name, cells in columns.items():
        if len(cells) == length - 1 and role(name) == "order":
            columns[name] = ["", *cells]
        elif len(cells) < length:
            raise OrderError(
                f"lists of different lengths: {name} has {len(cells)} values, expected {length}, one for each mesh: "
                "write nan where a computation failed"
            )
    rows = [list(row) for row in zip(*columns.values(), strict=True)]
    return Table(form, list(columns), rows, [number] * length)


_NUMBER = r"[-+.\d][^\s,;:=]*(?:,\d[^\s,;=:]*)*(?:\s*(?:%|(?:[xX×·*]|\\times|\\cdot)\s*10[^\s,;=:]*))?"
_NAMED = re.compile(
    r"(?<![^\s\[\]{},;=:])(?P<name>[^\[\]{},;=:\n]{1,80}?)[ \t]*[=:][ \t]*"
    r"(?:(?:[\w.]{1,40}\(?)?[\[({](?P<list>[^\[\](){}]*)[\])}]|"
    rf"(?P<row>{_NUMBER}(?:,[ \t]+{_NUMBER})*(?![^\s,;])|[^\s,;=:]+))"
)
"""Matches a name, the sign = or :, and a list in brackets, numbers with commas between them, or one value."""
_PAIRS = re.compile(r"(?m)^(?P<name>[^:\n]{0,60}?)(?P<pairs>(?:[ ,]+\d[\d.]*: ?[\d.eE+-]+){2,})$")


def _lists(lines: list[Line]) -> list[Table]:
    """Return the tables whose columns are lists.

    They have the form ``name = [1, 2, 3]``, ``name: 1, 2, 3`` or ``label 51: 0.1, 101: 0.02``. A second list of mesh
    sizes begins another table.
    """
    text = _PAIRS.sub(_as_lists, "\n".join(line.text for line in lines))
    tables: list[dict[str, list[str]]] = [{}]
    for found in _NAMED.finditer(text):
        name = found["name"].strip(" \t\"'")
        row = re.split(r",\s+", found["row"] or "")
        values = re.split(r"[,;\s]+", found["list"].strip(" ,;\n\t")) if found["list"] else row
        kinds = [kind_of(value) for value in values]
        last = tables[-1]
        # A word in a list of numbers is a failure; a list of words is none of numbers.
        fits = "a" not in kinds or len(values) in map(len, last.values())
        if len(values) < 2 or "9" not in kinds or not fits:
            continue
        if name in last and role(name) in SIZES:
            last = {}
            tables.append(last)
        last[f"{name} ({len(last) + 1})" if name in last else name] = values
    return [_from_columns("lists", columns) for columns in tables if len(columns) > 1]


def _as_lists(found: re.Match[str]) -> str:
    """Return two lists, of sizes and of errors, for ``label 51: 0.1, 101: 0.02``."""
    sizes, errors = zip(*re.findall(r"(\S+): ?([^\s,]+)", found["pairs"]), strict=True)
    return f"n = [{', '.join(sizes)}]\n{found['name']} = [{', '.join(errors)}]"


def _records(lines: list[Line]) -> list[Table]:
    """Return the table in lines ``name = value``; a name that occurs again begins the next row."""
    records: list[dict[str, str]] = [{}]
    numbers: list[int] = []
    for line in lines:
        for found in _NAMED.finditer(line.text):
            name, value = found["name"].strip(" \t*-\"'"), (found["row"] or "").strip("*|`")
            # Logging programs write the date and INFO in front of the name.
            words = name.split()
            name = words[-1] if words and role(words[-1]) in SIZES and role(name) == "unknown" else name
            if name in records[-1] and kind_of(value) != "a":
                records.append({})
            numbers += [line.number] * (len(records) - len(numbers))
            records[-1].setdefault(name, value)
    counts = Counter(name for record in records for name in record)
    names = [name for name, times in counts.items() if times > 1 and times >= len(records) - 1]
    rows = [[record.get(name, "") for name in names] for record in records]
    return [Table("name = value lines", names, rows, numbers)] if names else []


def _json(text: str) -> list[Table]:
    """Return the tables in JSON: numbers with the same name are a column, in lists of objects or objects of lists."""
    columns: dict[tuple[str, ...], list[str]] = {}
    try:
        for path, value in _leaves(json.loads(text), ()):
            columns.setdefault(path, []).append(value)
    except (ValueError, RecursionError):
        return []
    return list(_json_tables({path: column for path, column in columns.items() if path and len(column) > 1}, ""))


def _leaves(data: Any, path: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], str]]:
    """Yield the names of the objects around each number or text, and the number or text."""
    if isinstance(data, dict):
        for name, entry in data.items():
            yield from _leaves(entry, (*path, name))
    elif isinstance(data, list):
        for entry in data:
            yield from _leaves(entry, path)
    else:
        yield path, str(data)


def _json_tables(columns: dict[tuple[str, ...], list[str]], caption: str) -> Iterator[Table]:
    """Yield a table for each object that has a column; the names of the objects around it are its caption."""
    if any(len(path) == 1 for path in columns):
        table = _from_columns("JSON", {" ".join(path): column for path, column in columns.items()})
        yield replace(table, caption=caption)
        return
    for first in dict.fromkeys(path[0] for path in columns):
        inner = {path[1:]: column for path, column in columns.items() if path[0] == first}
        yield from _json_tables(inner, f"{caption} {first}".strip())
