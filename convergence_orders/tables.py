"""Cuts a text into tables: finds rows, columns and names in the forms in which people paste tables.

A text is lists ``name = [1, 2, 3]`` and ``name: 1, 2, 3``, also those of JSON, or lines whose cells are separated by
pipes, ``&``, tabs, semicolons, commas or blanks, or lines ``name = value``. What a column means is decided in
``columns.py``.
"""

import csv
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise, product

import numpy as np

from .cells import SIZES, Rewriting, kind_of, rewrite, role, to_number
from .orders import OrderError, consecutive_orders

Cells = list[str]
Columns = dict[str, Cells]
"""Name of a column ↦ its cells."""
MAX_BYTES = 8_000_000
MAX_LINES = 100_000
MAX_LINE = 130_000
EXAMPLE = "expected a header such as 'h,error' and one line for each mesh, for example '0.5,0.1', '0.25,0.025'"


@dataclass(frozen=True)
class Table:
    """A table with names of columns and cells as text.

    Attributes:
        form: the form of the table in words, such as ``CSV``.
        names: names of the columns; an empty text for a column without a name.
        columns: the cells of each column, one for each mesh.
        places: where the cells of each mesh stand, such as ``line 7``.
        breaks: indices of the meshes with a blank line, a rule or other lines above them.
        caption: the text above the table.
    """

    form: str
    names: Cells
    columns: list[Cells]
    places: Cells
    breaks: Sequence[int] = ()
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
    lines = _lines(text)
    joined = "\n".join(line.text for line in lines)
    lists, singles = _lists(joined)
    if tables := lists or _grids(lines):
        return tables
    if singles:
        return [from_columns("name = value lines", singles)]
    numbers = re.search(r"(?m)^.*\d.*$", joined)
    said = f"the first line with a number is '{shorten(numbers[0].strip())}'" if numbers else "no line with numbers"
    raise OrderError(f"no table was recognised, {said}; {EXAMPLE}")


def decode(data: bytes) -> str:
    """Return the text in bytes that are encoded in UTF-8 or Windows-1252.

    Raises:
        OrderError: there are more than 8 MB, or the bytes are not text.
    """
    if len(data) > MAX_BYTES:
        raise OrderError(f"it has more than 8 MB; {EXAMPLE}")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("cp1252", errors="replace")
    if control := re.search(r"[\0-\x08\x0e-\x1a\x1c-\x1f]", text):
        line = text.count("\n", 0, control.start()) + 1
        raise OrderError(f"line {line} contains {control[0]!r}: a binary file? Save the table as text in UTF-8")
    return text


def shorten(text: str, width: int = 60) -> str:
    """Return a text with at most ``width`` signs."""
    restored = text.translate(NORM_BARS)
    if len(restored) > width:
        return restored[: width - 1] + "…"
    return restored


# Lines without the signs of LaTeX, Markdown and programs.

_RULED = r"(?:\\(?:[a-z]*(?:rule|line)|rowcolor|addlinespace)(?:\{[^{}\n]*\}|\[[^]\n]*\]|\([^)\n]*\))*[ \t]*)"
_ROW_END = r"(?:\\\\(?:\[[^]\n]*\])?|\\tabularnewline|[ \t]\\)[ \t]*"
_BRACED = r"\{((?:[^{}\n]|\{(?:[^{}\n]|\{[^{}\n]*\})*\}){0,200})\}"
GAP = "\x1e"
"""Sign behind a line with a rule below it."""
NORM_BARS = str.maketrans({"\ue000": "\\|", "\ue001": "|"})
"""Sign that replaces a bar of a norm, which separates no cells ↦ the bar."""


def _difference(found: re.Match[str]) -> str:
    """Return the error of a computed value, which a line gives together with the exact one."""
    computed, exact = map(to_number, found.groups())
    if computed is None or exact is None:
        return found[0]
    return f"{abs(computed - exact):.9g}"


_CLEANED: Rewriting = [
    (r"\r\n|\r", "\n"),
    (r"[│┃║┆]", "|"),
    (r"\b(?:(?:np\.|numpy\.)?float\d*|tensor|array)\(([^()\[\]]*)\)", r"\1"),
    (r"(?m)^\s*\[\d+,\]", "      "),
    (r"(?m)^(?:[ \t]*[>*](?:[ \t]|$))+", ""),
    (r"=[ \t]*[^\W\d]\w*[ \t]*(?==)", ""),
    (r'(?m)^\s*ZONE\s+T\s*=\s*"([^"\n]*)"', r"\1"),
    (r"&[ \t]*\n(.*)\n", r"& \1\n\n"),
    (r"(?m)^[ \t]*\\caption\{(.*)\}", r"\1"),
    (rf"(?m){_ROW_END}{_RULED}+$", GAP),
    (rf"(?m){_ROW_END}$", ""),
    (rf"(?m)^(?:[\s|+:=_#*~.─━═┼╪┌┐└┘├┤┬┴╞╡╤╧╭╮╯╰╌╍-]|{_RULED})*$", ""),
    (rf"\\multirow(?:\[\w+\])?\{{[^{{}}\n]*\}}\{{[^{{}}\n]*\}}{_BRACED}", r"\1"),
    (r"\\\|", "\ue000"),
    (r"\|\|(?=[^|\n]*[^|\n\d.\s][^|\n]*\|\|)([^|\n]+)\|\|", "\ue001\ue001\\1\ue001\ue001"),
    (r"(?<=[\d.])[ \t]+%(?!\S)", "%"),
    (r"(?<=[\d.])[ \t]+(±|\+/-|\\pm|x|×|\\times|\\cdot|·)[ \t]*(?=\d)", r"\1"),
    (
        rf"\\multicolumn\{{([1-8])\}}\{{(?:[^{{}}\n]|\{{[^{{}}\n]*\}}){{0,80}}\}}{_BRACED}",
        lambda found: found[2] + " &" * (int(found[1]) - 1),
    ),
    (r'(?m)^\s*VARIABLES\s*=\s*"(.*)"', lambda found: re.sub(r'"[, ]+"', "\t", found[1])),
    (
        r"(?<!\S)(\S{1,30}) \((?:computed|numerical)\),? +(\S{1,30}) \((?:analytical|exact|reference)\)",
        _difference,
    ),
]
"""Signs of LaTeX, Markdown and programs; no replacement changes the number of lines."""


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
        OrderError: the text has too many lines, or a line is too long.
    """
    if text.count("\n") > MAX_LINES or max(map(len, text.split("\n"))) > MAX_LINE:
        raise OrderError(f"it has more than {MAX_LINES} lines, or a line of more than {MAX_LINE} characters; {EXAMPLE}")
    text = rewrite(text, _CLEANED)
    lines = []
    gap = False
    for number, line in enumerate(text.split("\n"), start=1):
        filled = re.search(r"\w", line)
        if filled:
            bare = re.sub(r"^\s*(?:#+|%+|//|!)[ \t]*(?=\S)", "", line)
            lines.append(Line(number, bare.rstrip(GAP), gap, bare != line))
        gap = line.endswith(GAP) or not filled
    return lines


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
_SUMMARY = re.compile(
    r"(?i)\W*(?:mean|average|avg|overall|total|fit|fitted|slope|eoc|rate|order|median|min|max|theo\w*|expected)\b"
)
_UNIT = re.compile(
    r"(?i)u?int\d*|float\d*\??|[fiu]\d+|<\w+>|str(?:ing)?|double|real|\[.*\]|\(.*\)|[-–—1%]?|[kcmµ]?m|m?s"
)


class Row:
    """A line that is divided into cells.

    Attributes:
        line, sign: the line, and the separator of its cells, a key of ``_FORMS``.
        text: the text of the line. If the separator is a blank, blanks replace each bar or comma that stands alone
            between blanks.
        cells: the cells.
        kinds: what the cells contain, one letter for each: 9 for a number, - for a missing number, a for other text.
    """

    def __init__(self, line: Line, sign: str) -> None:
        self.line = line
        self.sign = sign
        self.text = line.text.strip("\n ")
        if sign == " ":
            self.text = re.sub(r"(?<!\S)[|,](?!\S)", " ", line.text)
            self.cells = self.text.split()
        else:
            text = self.text.removeprefix("|").removesuffix("|") if sign == "|" else self.text
            self.cells = [cell.strip() for cell in next(csv.reader([text], delimiter=sign, skipinitialspace=True))]
        self.cells = [cell.translate(NORM_BARS) for cell in self.cells]
        self.kinds = "".join(map(kind_of, self.cells))

    def is_data(self, named: bool) -> bool:
        """Return whether the line may be a row of a table: at least half of its cells are numbers or missing.

        If blanks separate the cells, every line that begins with a number may be a row, even with many words.

        Parameters:
            named: whether rows may begin with a word, the name of the row; matters only if blanks separate the cells.
        """
        filled = len(self.cells) - self.cells.count("")
        if self.line.comment or "9" not in self.kinds or filled < 2 or len(re.findall(r"=|:\s", self.text)) > 1:
            return False
        begins_with_number = self.kinds[0] == "9"
        if self.sign == " " and (begins_with_number or not named):
            return begins_with_number
        return filled >= 2 * self.kinds.count("a")


_WORD = re.compile(r"\S+")
Block = list[Row]
"""Consecutive rows."""


def _grids(lines: list[Line]) -> list[Table]:
    """Return the tables whose cells are separated by a sign or by blanks. A table is rows with a header above them."""
    rows: Block = []
    most = 0
    for sign in reversed(_FORMS):
        divided = [Row(line, sign) for line in lines]
        numbers = sum(row.kinds.count("9") for row in divided if row.is_data(True))
        if 2 * numbers >= most:
            rows = divided
            most = max(most, numbers)
    tables: list[Table] = []
    for above, block in _blocks(rows):
        if table := _across(block) or _below(above, block, tables):
            tables.append(table)
    return tables


def _blocks(rows: Block) -> Iterator[tuple[Block, Block]]:
    """Yield the blocks of consecutive rows that may be tables, each with the lines between it and the block before."""
    # Where rows begin with words, "mean" may be the name of a row. Elsewhere it begins a line that sums up a column.
    first = [row.kinds[0] for row in rows if row.is_data(True)]
    named = first.count("a") > first.count("9")
    above: Block = []
    block: Block = []
    for row in rows:
        left_out = row.line.comment or (not named and _SUMMARY.match(row.cells[0] or row.text))
        as_wide = block and row.sign != " " and "9" in row.kinds and len(row.cells) == len(block[0].cells)
        if not left_out and (as_wide or row.is_data(named)):
            block.append(row)
        elif not (block and left_out and row.kinds.strip("a")):
            if block:
                yield above, block
                above = []
                block = []
            above.append(row)
    if block:
        yield above, block


def _below(above: Block, block: Block, before: list[Table]) -> Table | None:
    """Return the table whose rows stand below the names of its columns; None if it has one row and no names.

    Parameters:
        above: the lines above the block; the nearest one with a name for each column is the header.
        block: the rows.
        before: tables above the block. If the block has no header, it gets the header of the last one.
    """
    first = block[0]
    widths = [len(row.cells) for row in block]
    width = max(widths, key=widths.count)
    above = [row for row in above if not all(map(_UNIT.fullmatch, row.cells))]
    names, header = _header(above, block, width)
    if not names and before and len(before[-1].names) == width:
        names = before[-1].names
    if not names:
        if len(block) < 2:
            return None
        raise OrderError(
            f"the table that begins in line {first.line.number}, '{shorten(first.text)}', has {width} columns, "
            "but no line above names them: add a header such as 'h error'"
        )
    rows = [_cells(row, width, names if row is first else []) for row in block]
    texts = [row.text.strip() for row in above if row not in header]
    captions = [text for text in texts if not (_SUMMARY.match(text) or text[0] in "\\@.")]
    return Table(
        form=_FORMS[first.sign],
        names=names,
        columns=[*map(list, zip(*rows, strict=True))],
        places=[f"line {row.line.number}" for row in block],
        breaks=[
            k
            for k, (upper, row) in enumerate(pairwise(block), start=1)
            if row.line.gap or row.line.number > upper.line.number + 1
        ],
        caption=shorten("".join(captions[-1:]), 100),
    )


def _cells(row: Row, width: int, names: Cells) -> Cells:
    """Return the cells of a row of a table; empty cells at its end may be missing or superfluous.

    Parameters:
        row, width: the row, and the number of columns.
        names: the names of the columns if this is the first row, where orders may be missing.

    Raises:
        OrderError: there are fewer or more cells.
    """
    missing = width - len(row.cells)
    permitted = row.sign not in " ,;" or [*map(role, names[-missing:])] in (["order"], ["quotient"])
    if any(row.cells[width:]) or (missing > 0 and not permitted):
        raise OrderError(
            f"line {row.line.number}: {len(row.cells)} entries, expected {width}: '{shorten(row.text.strip())}'; write "
            "nan if the computation failed, - for a missing order, and # before a line that is no row"
        )
    return [*row.cells[:width], *[""] * missing]


def _header(above: Block, block: Block, width: int) -> tuple[Cells, Block]:
    """Return the names of columns in the nearest header above a table, and its lines; empty lists without a header."""
    for upper, row in reversed([*pairwise([*above[:1], *above])]):
        names = _names(row, block, width)
        if names and all(re.search(r"[^\W\d_]|[#‖|\ue000\ue001]", name) for name in names if name):
            close = 0 < row.line.number - upper.line.number <= 2
            grouped = _grouped(upper, names) if close else []
            if grouped:
                return grouped, [row, upper]
            return names, [row]
    return [], []


def _names(header: Row, block: Block, width: int) -> Cells:
    """Return the names of columns in a line; an empty list if the line does not name the columns.

    If blanks separate the cells, a name may be missing for columns of orders, whose first cell is missing, and for the
    first column if it only counts the rows. Names with blanks are found by their places.
    """
    if header.sign != " ":
        cells = [*header.cells, *[""] * width]
        return [] if len(header.cells) < 2 or any(cells[width:]) else cells[:width]
    numbers = [to_number(row.cells[0]) for row in block]
    index = numbers in ([*range(len(block))], [*range(1, len(block) + 1)])
    every = range(width)
    named = [k for k in every if len(block) < 2 or block[0].kinds[k : k + 1] != "-"]
    headings = re.split(r"\s{2,}", header.text.strip())
    placed = _placed(header, block, width, named) if len(headings) > 1 else []
    for skipped, names, columns in product({0, int(index)}, (headings, placed, header.cells), (every, named)):
        if len(columns[skipped:]) == len(names) > 1:
            known = dict(zip(columns[skipped:], names, strict=True))
            return [known.get(k, "") for k in every]
    return []


def _placed(header: Row, block: Block, width: int, named: list[int]) -> Cells:
    """Return the names of columns that follow from the places of the words in the header; empty if a column has none.

    Parameters:
        header, block: the header and the rows below it.
        width: number of columns.
        named: indices of the columns that need a name; the columns of orders to the right of each need none.
    """
    ends = [[word.end() for word in _WORD.finditer(row.text)] for row in block if len(row.cells) == width]
    # The region of a column with a name ends where the columns of orders to its right end.
    last = np.subtract([*named[1:], width], 1)
    stops = np.max(ends, axis=0)[last]
    names = [""] * len(named)
    for word in _WORD.finditer(header.text):
        middle = sum(word.span()) / 2
        k = min(int(np.searchsorted(stops, middle, "right")), len(stops) - 1)
        names[k] = f"{names[k]} {word[0]}".strip()
    return names if all(names) else []


def _grouped(upper: Row, names: Cells) -> Cells:
    """Return names of columns that are joined with the headings above them; empty if the columns form no groups.

    The names to the right of some columns must be repeated once for each heading, as in ``error order error order``.
    A heading replaces a name such as ``error``. But a heading such as h is joined with the name, because an error of a
    quantity h must not be taken as the mesh size.
    """
    for start in range(len(names)):
        headings = upper.cells if upper.sign == " " else [*filter(None, upper.cells[start:])]
        count = len(headings)
        grouped = names[start:]
        group = grouped[: len(grouped) // max(count, 1)]
        if count > 1 and any(group) and grouped == group * count:
            left = names[:start]
            if upper.sign != " ":
                left = [name or cell for name, cell in zip(left, upper.cells, strict=False)]
            return left + [_joined(heading, name) for heading in headings for name in group]
    return []


def _joined(heading: str, name: str) -> str:
    """Return the name of a column with the heading above it."""
    if role(name) in SIZES:
        return name
    if re.fullmatch(r"(?i)err(?:or)?s?|e", name) and role(heading) not in SIZES:
        return heading
    return f"{heading} {name}".strip()


# Tables with one line or one list for each quantity.


def _across(block: Block) -> Table | None:
    """Return the table with one line for each quantity and one column for each mesh; None if it is no such table."""
    columns: Columns = {}
    for row in block:
        words_and_numbers = re.fullmatch("(a+)[^a]{2,}", row.kinds)
        if not words_and_numbers:
            return None
        start = words_and_numbers.end(1)
        name = " ".join(row.cells[:start])
        columns[name.strip(" :=")] = row.cells[start:]
    if any(role(name) in SIZES for name in columns):
        return from_columns("one line for each quantity", columns)
    if not all(map(_orders_between, columns.values())):
        return None
    # The AMReX library prints errors and orders in turn: error order error order error.
    for name, values in list(columns.items()):
        columns |= {name: values[::2], f"order of {name}": ["", *values[1::2]]}
    return from_columns("one line for each quantity, orders between the errors", columns)


def _orders_between(values: Cells) -> bool:
    """Return whether errors and orders stand in turn, and all orders are right for halved mesh sizes."""
    numbers = np.array([*map(to_number, values)], dtype=float)
    errors = numbers[::2]
    orders = numbers[1::2]
    computed = consecutive_orders(0.5 ** np.arange(len(errors)), errors)
    return len(computed) == len(orders) and not (abs(computed - orders) >= 0.03).any()


def from_columns(form: str, columns: Columns) -> Table:
    """Return the table with the given columns; a column of orders may lack its first cell.

    Raises:
        OrderError: the columns have different lengths.
    """
    length = max(map(len, columns.values()))
    for name, cells in [*columns.items()]:
        if len(cells) == length - 1 and role(name) == "order":
            columns[name] = ["", *cells]
        elif len(cells) < length:
            raise OrderError(
                f"columns of different lengths: {name.translate(NORM_BARS)} has {len(cells)} values, expected "
                f"{length}, one for each mesh: write nan where a computation failed"
            )
    return Table(form, [*columns], [*columns.values()], [f"value {k}" for k in range(1, length + 1)])


_NUMBER = r"[-+.\d][^\s,;:=\]}]*(?:,\d[^\s,;=:\]}]*)*(?:\s*(?:%|(?:[xX×·*]|\\times|\\cdot)\s*10[^\s,;=:]*))?"
_NAMED = re.compile(
    r"(?<![^\s\[\]{},;=:])(?P<name>[^\[\]{},;=:\n]{1,80}?)[ \t]*[=:][ \t]*"
    r"(?:(?:[\w.]{1,40}\(?)?[\[({](?P<list>[^\[\](){}:]*)[\])}]|"
    rf"(?P<row>{_NUMBER}(?:,[ \t]+{_NUMBER})*(?![^\s,;\]}}])|[^\s,;=:\[\](){{}}]+))"
)
"""Matches a name, the sign = or :, and a list in brackets, numbers with commas between them, or one value."""
_PAIRS = re.compile(r"(?m)^(?P<name>[^:\n]{0,60}?)(?P<pairs>(?:[ ,]+\d[\d.]*: ?[\d.eE+-]+){2,})$")


def _lists(text: str) -> tuple[list[Table], Columns]:
    """Return the tables whose columns are lists, and the columns in lines ``name = value``.

    Lists have the form ``name = [1, 2, 3]``, ``name: 1, 2, 3`` or ``label 51: 0.1, 101: 0.02``. A second list of mesh
    sizes begins another table. The single values of a name, one for each mesh, are a column.
    """
    tables: list[Columns] = [{}]
    singles: Columns = {}
    for match in _NAMED.finditer(_PAIRS.sub(_as_lists, text)):
        name = match["name"].strip(" \t*-\"'")
        separator = r"[,;\s]+" if match["list"] else r",\s+"
        values = re.split(separator, (match["list"] or match["row"] or "").strip(" ,;\n\t"))
        if len(values) == 1:
            singles.setdefault(name, []).append(values[0].strip("*|`"))
        elif "9" in map(kind_of, values):
            if name in tables[-1] and role(name) in SIZES:
                tables.append({})
            columns = tables[-1]
            if name in columns:
                name = f"{name} ({len(columns) + 1})"
            columns[name] = values
    lists = [from_columns("lists", columns) for columns in tables if len(columns) > 1]
    return lists, {name: values for name, values in singles.items() if len(values) > 1}


def _as_lists(match: re.Match[str]) -> str:
    """Return two lists, of sizes and of errors, for ``label 51: 0.1, 101: 0.02``."""
    sizes, errors = zip(*re.findall(r"(\S+): ?([^\s,]+)", match["pairs"]), strict=True)
    return f"n = [{', '.join(sizes)}]\n{match['name']} = [{', '.join(errors)}]"
