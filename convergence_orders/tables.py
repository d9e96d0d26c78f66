"""Cuts a text into tables: finds rows, columns and names in the forms in which people paste tables.

A text is JSON; or lists ``name = [1, 2, 3]`` and ``name: 1, 2, 3``; or lines whose cells are separated by pipes, ``&``,
tabs, semicolons, commas or blanks; or lines ``name = value``. What a column means is decided in ``columns.py``.
"""

import csv
import json
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from .cells import SIZES, kind_of, role, to_number
from .orders import OrderError

MAX_BYTES = 8_000_000
MAX_LINES, MAX_CELL = 100_000, 2_000
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
_COMPUTED = re.compile(r"(\S+) \((?:computed|numerical)\),? +(\S+) \((?:analytical|exact|reference)\)")
GAP = "\x1e"
"""Sign behind a line with a rule below it."""
_CLEANED: list[tuple[str, str]] = [
    (r"\x1b\[[0-9;]*[A-Za-z]|[\u200b\ufeff]", ""),
    (r"\r\n|\r", "\n"),
    (r"[│┃║┆]", "|"),
    (r"\b(?:(?:np\.|numpy\.)?float\d*|tensor|array)\(([^()\[\]]*)\)", r"\1"),
    (r"(?m)^\s*\[\d+,\]", "      "),
    (r"(?m)^(?:[ \t]*[>*](?:[ \t]|$))+", ""),
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
_ASSIGNED = re.compile(r"(?<=\S) *(=+) *(?=\S)|(?<=[^\s\d]:) +(?=[-+.\d])")
_SUMMARY = re.compile(
    r"(?i)\W*(?:mean|average|avg|overall|total|fit|fitted|slope|eoc|rate|order|median|min|max|theo\w*|expected)\b"
)
_UNIT = re.compile(r"(?i)u?int\d*|float\d*\??|[fiu]\d+|<\w+>|str(?:ing)?|double|real|\[.*\]|\(.*\)|[-–—1%]?|[kcmµ]?m|m?s")


class Row:
    """A line that is divided into cells.

    Attributes:
        line: the line.
        cells: the cells.
        places: beginning and end of each cell.
        kinds: what the cells contain, one letter for each: 9 for a number, - for a missing number, a for other text.
    """

    def __init__(self, line: Line, sign: str) -> None:
        self.line = line
        if sign == " ":
            # ``h = 1/2`` and ``h: 0.5`` are one cell. A bar or comma between blanks is no cell.
            joined = _WITHIN_NUMBER.sub(lambda found: found[1].strip(), line.text)
            found = [cell for cell in re.finditer(r"\S+", _ASSIGNED.sub(r"\1", joined)) if cell[0] not in "|,"]
            self.cells = [cell[0] for cell in found]
            self.places = [cell.span() for cell in found]
        else:
            text = line.text.strip("\n " if sign == "\t" else None)
            text = re.sub(r"^\||\|$", "", text) if sign == "|" else text
            cells = next(csv.reader([text], delimiter=sign, skipinitialspace=True), [])
            self.cells = [cell.strip() for cell in cells]
            self.places = [(k, k + 1) for k in range(len(cells))]
        self.kinds = "".join(map(kind_of, self.cells))

    @property
    def is_data(self) -> bool:
        """Whether the line may be a row of a table: at least half of its cells are numbers or missing."""
        filled = len(self.cells) - self.cells.count("")
        enough = "9" in self.kinds and filled > 1 and filled >= 2 * self.kinds.count("a")
        return enough and not self.line.comment and self.line.text.count("=") < 2

    def cut(self, width: int) -> None:
        """Leave out the cells behind the first ones."""
        self.cells, self.places, self.kinds = self.cells[:width], self.places[:width], self.kinds[:width]


def _grids(lines: list[Line]) -> list[Table]:
    """Return the tables whose cells are separated by a sign or by blanks."""
    rows = {sign: [Row(line, sign) for line in lines] for sign in _FORMS}
    scores = {sign: sum(row.kinds.count("9") for row in rows[sign] if row.is_data) for sign in _FORMS}
    plain = "," if scores[","] >= scores[" "] else " "
    sign = next((sign for sign in "|&\t;" if 2 * scores[sign] > max(scores.values())), plain)
    return _blocks(rows[sign], sign) if scores[sign] else []


def _blocks(rows: list[Row], sign: str) -> list[Table]:
    """Return the tables in the rows of a text. A table is a block of rows with a header above it."""
    first = Counter(row.kinds[0] for row in rows if row.is_data)
    named = first["a"] > first["9"]
    tables: list[Table] = []
    above: list[Row] = []
    block: list[Row] = []
    starts: list[int] = []
    between: list[Row] = []
    for row, following in pairwise([*rows, rows[-1]]):
        comment = row.line.comment
        sums_up = not named and _SUMMARY.match(row.cells[0] or " ".join(row.cells))
        if not sums_up and not comment and _is_data(row, following, block[0] if block else None, sign):
            if block and (row.line.gap or not all(other.line.comment for other in between)):
                starts.append(len(block))
            block.append(row)
            between = []
        elif block and (sums_up or (comment and row.kinds != "a" * len(block[0].cells))):
            between.append(row)
        else:
            tables += _table(above, block, starts, tables, sign)
            above = [*between, row] if block else [*above, row]
            block, starts, between = [], [], []
    return tables + _table(above, block, starts, tables, sign)


def _is_data(row: Row, following: Row, model: Row | None, sign: str) -> bool:
    """Return whether a line is a row of a table; words behind the numbers of a row are cut off.

    Parameters:
        row, following: the line and the next one.
        model: the first row of the table above the line.
        sign: the sign that separates cells.

    Raises:
        OrderError: the line has words where the table has numbers. The computation on this mesh may have failed, so the
            line must not be left out.
    """
    if sign != " ":
        return row.is_data or (model is not None and "9" in row.kinds and len(row.cells) == len(model.cells))
    if row.kinds[0] == "a":
        # A line such as "Table 1" above a header is a caption, and "Elapsed 12.3" below rows of numbers is no row.
        return row.is_data and (model.kinds[0] == "a" if model else "9" in following.kinds)
    if row.is_data or "a" not in row.kinds:
        return row.is_data
    width = row.kinds.index("a")
    if model and model.kinds[0] == "9" and width < len(model.cells):
        raise OrderError(
            f"line {row.line.number}, '{shorten(row.line.text.strip())}', begins like a row of the table, but has words "
            "where numbers are expected: write the numbers, or nan if the computation failed, or # in front of the line"
        )
    if width > 1:
        row.cut(width)
    return width > 1


def _table(above: list[Row], block: list[Row], starts: list[int], before: list[Table], sign: str) -> list[Table]:
    """Return the table that consists of a block of rows, in a list; the list is empty if it is not a table.

    Parameters:
        above: the lines above the block; the nearest one with a name for each column is the header.
        block: the rows.
        starts: indices of the rows with a gap above.
        before: tables above the block. If the block has no header, it gets the header of the last one.
        sign: the sign that separates cells.
    """
    if not block:
        return []
    if across := _across(above, block):
        return [across]
    rows = _aligned(block, sign)
    names, header = _header(above, block, rows, sign)
    if not names and before and len(before[-1].names) == len(rows[0]):
        names = before[-1].names
    if not names and len(block) < 2 and above:
        return []
    if not names:
        example = shorten(sign.join(["h", *["error"] * (len(rows[0]) - 1)]).replace("\t", " "))
        line = block[0].line
        raise OrderError(
            f"the table that begins in line {line.number}, '{shorten(line.text.strip())}', has {len(rows[0])} "
            f"columns, but no line above names them: add a header such as '{example}'"
        )
    captions = [row.line.text.strip() for row in above if row not in header]
    captions = [text for text in captions if not _SUMMARY.match(text) and text[0] not in "\\@."]
    lines = [row.line.number for row in block]
    return [Table(_FORMS[sign], names, rows, lines, frozenset(starts), shorten("".join(captions[-1:]), 100))]


def _aligned(block: list[Row], sign: str) -> list[list[str]]:
    """Return lines as rows with equal numbers of cells.

    If columns are separated by blanks, the position of the other cells shows which cell of a line is empty.
    """
    usual = Counter(len(row.cells) for row in block).most_common(1)[0][0]
    for row in block:
        # Words behind the numbers of a row are a remark.
        if sign == " " and set(row.kinds[usual:]) == {"a"}:
            row.cut(usual)
    width = max(len(row.cells) for row in block) if sign == " " else usual
    model = next(row.places for row in block if len(row.cells) >= width)
    rows = []
    for row in block:
        cells = row.cells
        if sign == " ":
            words = dict(zip([_nearest(place, model) for place in row.places], cells, strict=True))
            cells = [words.get(k, "") for k in range(width)] if len(words) == len(cells) < width else cells
        elif sign in "\t&|":
            cells = cells + [""] * (width - len(cells))
        if len(cells) < width or any(cells[width:]):
            hint = "; decimal commas? Then separate columns by semicolons" if sign == "," else ""
            text = shorten(row.line.text.strip())
            raise OrderError(f"line {row.line.number}: {len(row.cells)} entries, expected {width}: '{text}'{hint}")
        rows.append(cells[:width])
    return rows


def _nearest(place: tuple[int, int], model: list[tuple[int, int]]) -> int:
    """Return the index of the place in ``model`` that shares most characters with a place, or is nearest to it."""
    shared = [min(place[1], end) - max(place[0], start) for start, end in model]
    return shared.index(max(shared))


def _header(above: list[Row], block: list[Row], rows: list[list[str]], sign: str) -> tuple[list[str], list[Row]]:
    """Return the names of columns in the nearest header above a table, and its lines; empty lists without a header."""
    units = [row for row in above if all(map(_UNIT.fullmatch, row.cells))]
    lines = [row for row in above if row not in units]
    for upper, row in reversed([*pairwise([None, *lines])]):
        names = _names(row, block, rows, sign)
        if names and all(re.search(r"[^\W\d_]|[#‖¦|]", name) for name in names if name):
            grouped = _grouped(upper, names, sign) if upper and row.line.number - upper.line.number <= 2 else []
            return grouped or names, [row, *units, *([upper] if upper and grouped else [])]
    return [], []


def _headings(text: str) -> list[str]:
    """Return the headings in a line that are separated by two or more blanks; single bars or commas do not count."""
    return re.findall(r"\S+(?: \S+)*", re.sub(r"(?<!\S)[|,](?!\S)|\t", " ", text))


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
    for names in (_headings(row.line.text), [], row.line.text.split()):
        if not names and (placed := _placed(row, block, named)):
            return placed
        for columns in (every, named, every[index:], named[index:]):
            if len(columns) == len(names):
                known = dict(zip(columns, names, strict=True))
                return [known.get(k, "") for k in every]
    return []


def _placed(row: Row, block: list[Row], named: list[int]) -> list[str]:
    """Return the names of columns that follow from the places of the words in the header; empty if a column has none.

    Parameters:
        row, block: the header and the rows below it.
        named: indices of the columns that need a name; the columns of orders to the right of each need none.
    """
    if len(_headings(row.line.text)) < 2:
        return []
    width = max(len(other.cells) for other in block)
    ends = [max(other.places[k][1] for other in block if len(other.cells) == width) for k in range(width)]
    regions = [(ends[k - 1] if k else 0, ends[after - 1]) for k, after in pairwise([*named, width])]
    names = [""] * width
    for word in re.finditer(r"\S+", row.line.text):
        k = named[_nearest(word.span(), regions)]
        names[k] = f"{names[k]} {word[0]}".strip()
    return names if all(names[k] for k in named) else []


def _grouped(upper: Row, names: list[str], sign: str) -> list[str]:
    """Return names of columns that are joined with the headings above them; empty if the columns form no groups.

    The names to the right of some columns must be repeated once for each heading, as in ``error order error order``.
    """
    for start in range(len(names) - 1):
        headings = _headings(upper.line.text) if sign == " " else [*filter(None, upper.cells[start:])]
        size, rest = divmod(len(names) - start, max(len(headings), 1))
        if len(headings) < 2 or rest or names[start:] != names[start : start + size] * len(headings):
            continue
        joined = [_join(headings[k // size], name) for k, name in enumerate(names[start:])]
        left = [name or cell for name, cell in zip(names[:start], upper.cells, strict=False)]
        return left + joined
    return []


def _join(heading: str, name: str) -> str:
    """Return the name of a column below a heading.

    The heading replaces a name such as ``error``. But a heading such as h is joined with the name, because an error of
    a quantity h must not be taken as the mesh size.
    """
    if role(name) in SIZES:
        return name
    is_error = re.fullmatch(r"(?i)err(?:or)?s?|e", name)
    return heading if is_error and role(heading) not in SIZES else f"{heading} {name}".strip()


# Tables with one line or one list for each quantity.


def _across(above: list[Row], block: list[Row]) -> Table | None:
    """Return the table with one line for each quantity and one column for each mesh; None if it is no such table."""
    columns: dict[str, list[str]] = {}
    for row in block:
        found = re.fullmatch(r"(a+-*)([9-]*)", row.kinds)
        if found is None or found[2].count("9") < 2:
            return None
        columns[" ".join(row.cells[: found.end(1)]).strip(" :=")] = row.cells[found.end(1) :]
    form, number, length = "one line for each quantity", block[0].line.number, max(map(len, columns.values()))
    if any(role(name) in SIZES for name in columns):
        return _from_columns(form, columns, number)
    sizes = [cell.strip("$").partition("=") for cell in above[-1].cells if cell] if above else []
    if len(sizes) == length and all(number for _, _, number in sizes):
        columns = {sizes[0][0].strip(): [number for _, _, number in sizes]} | columns
        caption = next((row.line.text.strip() for row in above[-2::-1]), "")
        return replace(_from_columns(form + ", sizes in the header", columns, number), caption=caption)
    if length % 2 and all(map(_orders_between, columns.values())):
        # The AMReX library prints errors and orders in turn: error order error order error.
        for name, values in list(columns.items()):
            columns |= {name: values[::2], f"order of {name}": ["", *values[1::2]]}
        return _from_columns(form + ", orders between the errors", columns, number)
    return None


def _orders_between(values: list[str]) -> bool:
    """Return whether errors and orders stand in turn, and all orders are right for halved mesh sizes."""
    numbers = [to_number(cell) or 0.0 for cell in values]
    triples = zip(numbers[::2], numbers[1::2], numbers[2::2], strict=False)
    return all(not fine or (abs(p) < 99 and abs(coarse / fine / 2**p - 1) < 0.02) for coarse, p, fine in triples)


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


_LIST = re.compile(
    r"(?P<name>[^\[\](){}=:\n]{1,80}?)[ \t]*[=:]\s*(?:[\w.]{1,40}\(?)?[\[({](?P<values>[^\[\](){}]*)[\])}]|"
    r"(?m:^)[ \t]*(?P<bare>[^\[\](){}=:\n]{0,40}[^\W\d][^\[\](){}=:\n]{0,40})[=:][ \t]*"
    r"(?P<row>[-+.\d]\S*(?:,[ \t]+[-+.\d][^\s,]*)+)"
)
_PAIR = re.compile(r"(?<![\w.])(\d[\d.]*(?:[eE][-+]?\d+)?)\s*:\s*([-+]?[\d.]+(?:[eEdD][-+]?\d+)?)(?![\w:])")


def _lists(lines: list[Line]) -> list[Table]:
    """Return the tables whose columns are lists.

    They have the form ``name = [1, 2, 3]``, ``name: 1, 2, 3`` or ``label 51: 0.1, 101: 0.02``. A second list of mesh
    sizes begins another table. A heading such as ``Q1:`` is joined with the names below it.
    """
    groups: list[dict[str, list[str]]] = [{}]
    for line in lines:
        pairs = _PAIR.findall(line.text)
        if len(pairs) > 1:
            sizes, values = map(list, zip(*pairs, strict=True))
            _add(groups, "n", sizes)
            _add(groups, _PAIR.split(line.text)[0].strip(" \t,:;-{("), values)
    text = "\n".join(line.text for line in lines)
    for found in [] if groups[0] else _LIST.finditer(text):
        name, bare, row = found["name"], found["bare"], found["values"] or found["row"] or ""
        above = re.findall(r"(?m)^ *([^=:\n]{1,60}):[ \t]*$", text[: found.start() + 1]) if bare else []
        values = re.split(r"[,;\s]+", row.strip(" ,;\n\t"))
        kinds = [kind_of(value) for value in values]
        # A word in a list of numbers is a failure; a list of words is none of numbers.
        fits = "a" not in kinds or len(values) in map(len, groups[-1].values())
        if len(values) > 1 and "9" in kinds and fits:
            _add(groups, " ".join([*above[-1:], (name or bare).strip(" \t,\"'")]), values)
    return [_from_columns("lists", columns) for columns in groups if len(columns) > 1]


def _add(groups: list[dict[str, list[str]]], name: str, values: list[str]) -> None:
    """Add a list to the last table, or begin another table if it has sizes that differ from those of the last one."""
    last = groups[-1]
    if name in last and role(name) in SIZES:
        if last[name] == values:
            return
        groups.append({})
    groups[-1][f"{name} ({len(last) + 1})" if name in groups[-1] else name] = values


_VALUE = re.compile(
    r"[=:]\s*(?P<value>[^\s,;=:]+(?:,\d[^\s,;=:]*)*(?:\s*(?:%|(?:[xX×·*]|\\times|\\cdot)\s*10[^\s,;=:]*))?)(?=[\s,;]|:\s|$)"
)
"""Matches a value with its sign = or :. It may have a decimal comma, a power of ten or a per cent sign."""


def _records(lines: list[Line]) -> list[Table]:
    """Return the table in lines ``name = value``; a name that occurs again begins the next row."""
    records: list[dict[str, str]] = [{}]
    numbers: list[int] = []
    for line in lines:
        # In ``nx = ny = 8`` the first name is taken.
        text, end = re.sub(r"=\s*[^\W\d]\w*\s*(?==)", "", line.text), 0
        for found in _VALUE.finditer(text):
            key = re.split(r"[,;]", text[end : found.start()])[-1].strip(" \t*-\"'{[:")
            end, value = found.end(), found["value"].strip("*|`}]")
            if len(key) > 80 or key[-1:] in "<>!" or not re.search(r"[^\W\d]", key):
                continue
            # Logging programs write the date and INFO in front of the name.
            key = key.split()[-1] if role(key) == "unknown" and role(key.split()[-1]) in SIZES else key
            if key in records[-1] and kind_of(value) != "a":
                records.append({})
            numbers += [line.number] * (len(records) - len(numbers))
            records[-1].setdefault(key, value)
    counts = Counter(key for record in records for key in record)
    names = [key for key, times in counts.items() if times > 1 and times >= len(records) - 1]
    rows = [[record.get(name, "") for name in names] for record in records]
    filled = [k for k, row in enumerate(rows) if any(row)]
    table = Table("name = value lines", names, [rows[k] for k in filled], [numbers[k] for k in filled])
    return [table] if any(kind_of(cell) == "9" for row in rows for cell in row) else []


# JSON.


def _json(text: str) -> list[Table]:
    """Return the tables in JSON: lists of objects, or objects whose entries are lists of equal length."""
    try:
        return list(_json_tables(json.loads(text), ""))
    except (ValueError, RecursionError):
        return []


def _json_tables(data: Any, caption: str) -> Iterator[Table]:
    entries = dict(enumerate(data)) if isinstance(data, list) else data if isinstance(data, dict) else {}
    if isinstance(data, list):
        objects = [dict(_flat(entry, "")) for entry in data]
        names = [name for name in (objects or [{}])[0] if all(name in entry for entry in objects)]
        columns = {name: [entry[name] for entry in objects] for name in names}
    else:
        columns = dict(_flat(data, "")) if any(isinstance(entry, list) for entry in entries.values()) else {}
    cells = {name: [str(cell) for cell in column] for name, column in columns.items() if _is_flat(column)}
    if len(cells) > 1:
        yield replace(_from_columns("JSON", cells), caption=caption)
    else:
        for name, entry in entries.items():
            yield from _json_tables(entry, f"{caption} {name}".strip())


def _is_flat(column: Any) -> bool:
    return isinstance(column, list) and not any(isinstance(cell, dict | list) for cell in column)


def _flat(entry: Any, prefix: str) -> Iterator[tuple[str, Any]]:
    """Yield the entries of an object and of the objects in it; their names are joined by blanks."""
    for name, value in entry.items() if isinstance(entry, dict) else ():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{name} ")
        else:
            yield f"{prefix}{name}", value
