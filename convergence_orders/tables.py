"""Cuts a text into tables: finds rows, columns and names in the forms in which people paste tables.

These forms are understood: JSON; lists ``name = [1, 2, 3]`` and ``name: 1, 2, 3``; ``label 51: 0.1, 101: 0.02`` lines;
columns separated by pipes, ``&``, tabs, semicolons, commas or blanks, with a header of one or two rows; the same with
one line for each quantity; ``name = value`` lines. What a column means is decided in ``columns.py``.
"""

import csv
import json
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

from .cells import MISSING, NUMBER, SIZES, TEXT, kind_of, role, to_number
from .orders import OrderError

MAX_BYTES = 8_000_000
MAX_ROWS = 100_000
MAX_CELL = 2_000
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
    for cut in (_json, _lists, _separated, _records):
        if tables := cut(text):
            return [replace(table, names=[_norms(name) for name in table.names]) for table in tables]
    first = next((line.strip() for line in text.splitlines() if re.search(r"\d", line)), "")
    said = f"the first line with a number is '{shorten(first)}'" if first else "no line with numbers"
    raise OrderError(f"no table was recognised, {said}; {EXAMPLE}")


def decode(data: bytes) -> str:
    """Return the text in bytes that are encoded in UTF-8, UTF-16 or Windows-1252.

    Raises:
        OrderError: there are more than 8 MB, or the bytes are not text.
    """
    if len(data) > MAX_BYTES:
        raise OrderError(f"it has more than 8 MB; {EXAMPLE}")
    zeros = data[::2].count(0) - data[1::2].count(0)
    wide = len(data) > 3 and abs(zeros) > 0.4 * len(data)
    encodings = ["utf-16-be" if zeros > 0 else "utf-16-le"] if wide else ["utf-8-sig", "cp1252"]
    for encoding in ["utf-16"] if data[:2] in (b"\xff\xfe", b"\xfe\xff") else encodings:
        try:
            text = data.decode(encoding)
        except UnicodeDecodeError:
            continue
        control = re.search(r"[\0-\x08\x0e-\x1a\x1c-\x1f]", text)
        if control is None:
            return text
        line = text.count("\n", 0, control.start()) + 1
        raise OrderError(f"line {line} contains {control[0]!r}: a binary file? Save the table as text in UTF-8")
    raise OrderError("it is not text but binary: save the table as text in UTF-8")


def _norms(text: str) -> str:
    """Return a text with the signs of norms that ``_CLEANED`` replaced."""
    return text.replace("‖", "\\|").replace("¦", "|")


def shorten(text: str, width: int = 60) -> str:
    """Return a text with at most ``width`` signs."""
    return text if len(text) <= width else text[: width - 1] + "…"


# Rows of cells.

_RULED = r"(?:\\(?:[a-z]*(?:rule|line)|rowcolor|addlinespace)(?:\{[^{}\n]*\}|\[[^]\n]*\]|\([^)\n]*\))*[ \t]*)"
_BRACED = r"\{((?:[^{}\n]|\{(?:[^{}\n]|\{[^{}\n]*\})*\}){0,200})\}"
_SPANNED = r"\\multicolumn\{%s\}\{(?:[^{}\n]|\{[^{}\n]*\}){0,80}\}" + _BRACED
GAP, SKIPPED = "\x1e", "\x1d"
"""Signs behind a line with a rule below it, and in place of a line that belongs to the layout."""
_CLEANED: list[tuple[str, Any]] = [
    (r"\x1b\[[0-9;]*[A-Za-z]|[\u200b\ufeff]", ""),
    (r"\r\n|\r", "\n"),
    (r"[│┃║┆]", "|"),
    (r"\b(?:(?:np\.|numpy\.)?float\d*|tensor|array)\(([^()\[\]]*)\)", r"\1"),
    (r"(?m)^\s*\[\d+,\]", "      "),
    (r'(?m)^\s*VARIABLES\s*=\s*"(.*)"', lambda line: re.sub(r'"[, ]+"', "\t", line[1])),
    (r'(?m)^\s*ZONE\s+T\s*=\s*"([^"]*)"', r"\1"),
    (r"&[ \t]*\n(.*)\n", r"& \1\n" + SKIPPED + "\n"),
    (r"(?m)^[ \t]*(?:\\(?:begin|end|label|centering|small|tabcolsep)|```|@f|\.\. code).*$", SKIPPED),
    (r"(?m)^[ \t]*\\caption\{(.*)\}", r"\1"),
    (rf"(?m)(?:\\\\(?:\[[^]\n]*\])?|\\tabularnewline|[ \t]\\)[ \t]*{_RULED}+$", GAP),
    (r"(?m)(?:\\\\(?:\[[^]\n]*\])?|\\tabularnewline|[ \t]\\)[ \t]*$", ""),
    (rf"(?m)^(?:[\s|+:=_#*~.─━═┼╪┌┐└┘├┤┬┴╞╡╤╧╭╮╯╰╌╍-]|{_RULED})*$", ""),
    (rf"(?m)^[ \t]*{_RULED}+", ""),
    (rf"\\multirow(?:\[\w+\])?\{{[^{{}}\n]*\}}\{{[^{{}}\n]*\}}{_BRACED}", r"\1"),
    *[(_SPANNED % count, r"\1" + " &" * (count - 1)) for count in range(1, 9)],
    (r"\\\|", "‖"),
    (r"\|\|(?=[^|\n]*[^|\n\d.\s][^|\n]*\|\|)([^|\n]+)\|\|", r"¦¦\1¦¦"),
]
"""Patterns and the texts that replace them, one after the other; none of them changes the number of lines."""
_FORMS = {
    "|": "columns separated by |",
    "&": "LaTeX rows",
    "\t": "columns separated by tabs",
    ";": "columns separated by semicolons",
}
_FORMS |= {",": "CSV", " ": "columns separated by blanks"}
"""Separator ↦ the form of a table in words; the first separator that divides lines into cells with numbers is taken."""
_WITHIN_NUMBER = re.compile(r"(?<=[\d.])\s+(%(?!\S)|(?:±|\+/-|\\pm|x|×|\\times|\\cdot|·)\s*(?=\d))")
_SUMMARY = re.compile(
    r"(?i)\W*(?:mean|average|avg|overall|total|fit|fitted|slope|eoc|rate|order|median|min|max|theo\w*|expected)\b"
)
_UNIT = re.compile(
    r"(?i)u?int\d*|float\d*\??|[fiu]\d+|<\w+>|str(?:ing)?|double|real|bool|\[.*\]|\(.*\)|[-–—1%]?|[kcmµ]?m|m?s|[kMG]?Pa|deg|°"
)
LETTERS = {NUMBER: "9", MISSING: "-", TEXT: "a"}


@dataclass
class Row:
    """A line that is divided into cells.

    Attributes:
        number: the line number.
        text: the line without the sign of a comment.
        cells: the cells.
        places: beginning and end of each cell.
        gap: whether a blank line or a rule is above it.
        comment: whether the line is a comment.
        kinds: what the cells contain, one letter for each: 9 for a number, - for a missing number, a for other text.
    """

    number: int
    text: str
    cells: list[str]
    places: list[tuple[int, int]]
    gap: bool
    comment: bool
    kinds: str = field(init=False)

    def __post_init__(self) -> None:
        self.kinds = "".join(LETTERS[kind_of(cell)] for cell in self.cells)

    @property
    def is_data(self) -> bool:
        """Whether the line may be a row of a table: at least half of its cells are numbers or missing."""
        filled = sum(map(bool, self.cells))
        pairs = self.text.count("=") > 1
        return "9" in self.kinds and filled > 1 and filled >= 2 * self.kinds.count("a") and not (self.comment or pairs)


def _lines(text: str) -> Iterator[tuple[int, str, bool, bool]]:
    """Yield number and text of the lines that may belong to a table, whether a gap is above, and if it is a comment.

    Raises:
        OrderError: the text has too many lines, or a cell is too long.
    """
    if text.count("\n") > MAX_ROWS:
        raise OrderError(f"it has more than {MAX_ROWS} lines: a table of errors has one line for each mesh; {EXAMPLE}")
    if long := re.search(rf"(?<![^\s,;|&])[^\s,;|&]{{{MAX_CELL},}}", text):
        raise OrderError(f"it has a cell of {len(long[0])} characters; {EXAMPLE}")
    for pattern, replacement in _CLEANED:
        text = re.sub(pattern, replacement, text)
    lines = text.split("\n")
    quoted = len(re.findall(r"(?m)^\s*[>*](?:\s|$)", text)) > len(lines) / 2
    gap = False
    for number, line in enumerate(lines, start=1):
        line = re.sub(r"^\s*(?:[>*](?:\s|$))+", "", line) if quoted else line
        if re.search(r"\w", line):
            bare = re.sub(r"^\s*(?:#+|%+|//|!)[ \t]*(?=\S)", "", line)
            yield number, bare.rstrip(GAP), gap, bare != line
        gap = line.endswith(GAP) or (gap if line == SKIPPED else not re.search(r"\w", line))


def _row(line: tuple[int, str, bool, bool], separator: str) -> Row:
    number, text, gap, comment = line
    if separator == " ":
        # ``h = 1/2`` and ``h: 0.5`` are one cell. A bar or comma between blanks is no cell.
        joined = _WITHIN_NUMBER.sub(lambda found: found[1].strip(), text)
        joined = re.sub(r"(?<=\S) *(=+) *(?=\S)|(?<=[^\s\d]:) +(?=[-+.\d])", r"\1", joined)
        found = [cell for cell in re.finditer(r"\S+", joined) if cell[0] not in "|,"]
        return Row(number, text, [cell[0] for cell in found], [cell.span() for cell in found], gap, comment)
    if separator in ",;":
        quoted = '"' in text and len(text) < MAX_CELL
        reader = csv.reader([text.strip()], delimiter=separator, skipinitialspace=True)
        cells = next(reader, []) if quoted else text.strip().split(separator)
    elif separator == "&":
        cells = re.split(r"(?<!\\)&", text)
    else:
        cells = re.sub(r"^\s*\||\|\s*$", "", text).strip("\n ").split(separator)
    cells = [cell.strip() for cell in cells]
    return Row(number, text, cells, [(k, k + 1) for k in range(len(cells))], gap, comment)


def _separated(text: str) -> list[Table]:
    """Return the tables whose cells are separated by a sign or by blanks."""
    lines = list(_lines(text))
    found = {separator: [_row(line, separator) for line in lines] for separator in _FORMS}
    scores = {sign: sum(row.kinds.count("9") for row in rows if row.is_data) for sign, rows in found.items()}
    sign = next(
        (sign for sign in "|&\t;" if 2 * scores[sign] > max(scores.values())),
        "," if scores[","] >= max(scores[" "], 1) else " ",
    )
    if scores[sign]:
        return _blocks(found[sign], sign)
    numbers = [row for row in found[" "] if row.kinds == "9"]
    if not numbers or len(lines) > len(numbers) + 1:
        return []
    breaks = frozenset(k for k, row in enumerate(numbers) if k and row.gap)
    name = next((row.text.strip() for row in found[" "] if row.kinds != "9"), "error")
    return [Table("one column", [name], [row.cells for row in numbers], [row.number for row in numbers], breaks)]


def _blocks(rows: list[Row], sign: str) -> list[Table]:
    """Return the tables in the lines of a text. A table is a block of rows with a header above it."""
    first = Counter(row.kinds[0] for row in rows if row.is_data)
    named = first["a"] > first["9"]
    tables: list[Table] = []
    above: list[Row] = []
    block: list[Row] = []
    between: list[Row] = []
    gap = False
    for row, following in zip(rows, [*rows[1:], rows[-1]], strict=True):
        model = block[0] if block else None
        data = row.is_data or (
            model is not None and sign != " " and "9" in row.kinds and len(row.cells) == len(model.cells)
        )
        # A line such as "Table 1" above a header is a caption, and "Elapsed 12.3" below rows of numbers ends the table.
        if sign == " " and row.kinds[0] == "a":
            data = data and (model.kinds[0] == "a" if model else "9" in following.kinds)
        elif sign == " " and row.kinds[0] == "9" and "a" in row.kinds and not data and not row.comment:
            data = _cut_remark(row, model)
        sums_up = not named and _SUMMARY.match(row.cells[0] or " ".join(row.cells))
        if data and not sums_up and not row.comment:
            block.append(row)
            row.gap, gap, between = row.gap or gap, False, []
        elif model and (sums_up or (row.comment and row.kinds != "a" * len(model.cells))):
            gap = gap or not row.comment
            between.append(row)
        else:
            tables += _table(above, block, tables, sign)
            above, block, between = [*between, row] if block else [*above, row], [], []
    return tables + _table(above, block, tables, sign)


def _cut_remark(row: Row, model: Row | None) -> bool:
    """Remove words behind the numbers of a row, and return whether enough numbers remain.

    Parameters:
        row: a line that begins with a number and consists mainly of words.
        model: the first row of the table above the line.

    Raises:
        OrderError: the line has words where the table has numbers. The computation on this mesh may have failed, so the
            line must not be left out.
    """
    width = row.kinds.index("a")
    if model and model.kinds[0] == "9" and width < len(model.cells):
        raise OrderError(
            f"line {row.number}, '{shorten(row.text.strip())}', begins like a row of the table, but has words where "
            "numbers are expected: write the numbers, or nan if the computation failed, or # in front of the line"
        )
    if width > 1:
        row.cells, row.places, row.kinds = row.cells[:width], row.places[:width], row.kinds[:width]
    return width > 1


def _table(above: list[Row], block: list[Row], before: list[Table], sign: str) -> list[Table]:
    """Return the table that consists of a block of rows, in a list; the list is empty if it is not a table.

    Parameters:
        above: the lines above the block; the nearest one with a name for each column is the header.
        block: the rows.
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
        raise OrderError(
            f"the table that begins in line {block[0].number}, '{shorten(block[0].text.strip())}', has {len(rows[0])} "
            f"columns, but no line above names them: add a header such as '{example}'"
        )
    captions = [row.text.strip() for row in above if row not in header and re.search(r"\w", row.text)]
    captions = [text for text in captions if not _SUMMARY.match(text) and text[0] not in "\\@."]
    breaks = frozenset(k for k, row in enumerate(block) if k and row.gap)
    lines = [row.number for row in block]
    return [Table(_FORMS[sign], names, rows, lines, breaks, shorten(captions[-1], 100) if captions else "")]


def _aligned(block: list[Row], sign: str) -> list[list[str]]:
    """Return lines as rows with equal numbers of cells.

    If columns are separated by blanks, the position of the other cells shows which cell of a line is empty.
    """
    usual = Counter(len(row.cells) for row in block).most_common(1)[0][0]
    for row in block:
        # Words behind the numbers of a row are a remark.
        if sign == " " and len(row.cells) > usual and set(row.kinds[usual:]) == {"a"}:
            row.cells, row.places = row.cells[:usual], row.places[:usual]
    lengths = [len(row.cells) for row in block]
    width = max(lengths) if sign == " " else usual
    model = block[lengths.index(width)].places
    rows = []
    for row in block:
        cells = (
            [*row.cells, *[""] * (width - len(row.cells))] if sign in "\t&|" or len(row.cells) == width else row.cells
        )
        if len(cells) < width and sign == " ":
            columns = [_overlapping(place, model) for place in row.places]
            words = dict(zip(columns, row.cells, strict=True))
            cells = [words.get(k, "") for k in range(width)] if len(words) == len(columns) else cells
        if len(cells) < width or any(cells[width:]):
            hint = "; decimal commas? Then separate columns by semicolons" if sign == "," else ""
            text = shorten(row.text.strip())
            raise OrderError(f"line {row.number}: {len(row.cells)} entries, expected {width}: '{text}'{hint}")
        rows.append(cells[:width])
    return rows


def _overlapping(place: tuple[int, int], model: list[tuple[int, int]]) -> int:
    """Return the index of the place in ``model`` that shares most characters with a place, or is nearest to it."""
    shared = [min(place[1], end) - max(place[0], start) for start, end in model]
    return shared.index(max(shared))


def _header(above: list[Row], block: list[Row], rows: list[list[str]], sign: str) -> tuple[list[str], list[Row]]:
    """Return the names of columns in the nearest header above a table, and its lines; empty lists without a header."""
    units = [row for row in above if all(map(_UNIT.fullmatch, row.cells))]
    for k, row in reversed([*enumerate(above)]):
        names = [] if row in units else _names(row, block, rows, sign)
        if not names or any(name and not re.search(r"[^\W\d_]|[#‖¦|]", name) for name in names):
            continue
        upper = above[k - 1] if k and row.number - above[k - 1].number <= 2 else None
        if upper and (joined := _joined(upper, row, names, sign)):
            return joined, [row, upper, *units]
        return names, [row, *units]
    return [], []


def _headings(text: str) -> list[re.Match[str]]:
    """Return the headings in a line that are separated by two or more blanks; single bars or commas do not count."""
    return list(re.finditer(r"\S+(?: \S+)*", re.sub(r"(?<!\S)[|,](?!\S)|\t", " ", text)))


def _names(row: Row, block: list[Row], rows: list[list[str]], sign: str) -> list[str]:
    """Return the names of columns in a line; an empty list if the line does not name the columns.

    A name may be missing for columns of orders, whose first cell is missing, and for the first column if it only counts
    the rows.
    """
    width, words = len(rows[0]), row.text.split()
    wide = [heading[0] for heading in _headings(row.text)]
    if sign != " ":
        cells = [*row.cells, *[""] * (width - len(row.cells))]
        if len(row.cells) > 1 and not any(cells[width:]):
            return cells[:width]
        return next((names for names in (wide, words) if len(names) == width), [])
    counts = [to_number(cells[0]) for cells in rows]
    index = len(rows) > 1 and counts in ([*range(len(rows))], [*range(1, len(rows) + 1)])
    named = [k for k in range(width) if len(rows) < 2 or kind_of(rows[0][k]) != MISSING]
    options = [range(width), range(int(index and row.text[0].isspace()), width), named, named[int(index) :]]
    for names in (wide, [], words):
        columns = next((columns for columns in options if len(columns) == len(names)), None)
        if columns:
            known = dict(zip(columns, names, strict=True))
            return [known.get(k, "") for k in range(width)]
        if not names and len(wide) > 1 and (placed := _placed(row, block, named)):
            return placed
    return ["", *words] if index and len(words) == width - 1 else []


def _placed(row: Row, block: list[Row], named: list[int]) -> list[str]:
    """Return the names of columns that follow from the places of the words in the header; empty if a column has none.

    Parameters:
        row, block: the header and the rows below it.
        named: indices of the columns that need a name; the columns of orders to the right of each need none.
    """
    width = max(len(other.cells) for other in block)
    ends = [max(other.places[k][1] for other in block if len(other.cells) == width) for k in range(width)]
    regions = [(ends[k - 1] if k else 0, ends[after - 1]) for k, after in zip(named, [*named[1:], width], strict=True)]
    names = [""] * width
    for word in re.finditer(r"\S+", row.text):
        k = named[_overlapping(word.span(), regions)]
        names[k] = f"{names[k]} {word[0]}".strip()
    return names if all(names[k] for k in named) else []


def _joined(upper: Row, row: Row, names: list[str], sign: str) -> list[str]:
    """Return the names of columns from a header of two rows; an empty list if it is no such header.

    Each heading in the upper row spans several columns, and is joined with the names below it. Either the columns form
    groups with the same names, one below each heading, or a heading begins above the first name of its columns.
    """
    if sign == " ":
        above = [(heading[0], heading.start(), heading.end()) for heading in _headings(upper.text)]
        below = [heading.span() for heading in _headings(row.text)]
        below = below if len(below) == len(names) else row.places
    else:
        above = [(cell, *place) for cell, place in zip(upper.cells, upper.places, strict=True) if cell]
        below = row.places[: len(names)]
    repeated = len(set(names)) < len(names) == len(below)
    if not repeated or not 1 < len(above) <= len(names) <= 1000:
        return []
    groups: list[list[int]] = [[]]
    for k, name in enumerate(names):
        if names.count(name) > 1 or role(name) not in (*SIZES, "level"):
            groups += [[]] if name in [names[j] for j in groups[-1]] else []
            groups[-1].append(k)
    centred = len(groups) == len(above) and all(
        below[group[0]][0] <= (start + end) / 2 <= below[group[-1]][1]
        for (_, start, end), group in zip(above, groups, strict=True)
    )
    if centred:
        labels = {k: heading for (heading, *_), group in zip(above, groups, strict=True) for k in group}
    elif all(any(abs(start - left) < 2 for left, _ in below) for _, start, _ in above):
        near = int(sign == " ")
        labels = {k: text for text, start, _ in above for k, (left, _) in enumerate(below) if start <= left + near}
    else:
        return []
    # The heading replaces a name such as ``error``. But a heading such as h is joined with the name, because an error
    # of a quantity h must not be taken as the mesh size.
    pairs = [(labels.get(k, ""), name) for k, name in enumerate(names)]
    is_error = re.compile(r"(?i)err(?:or)?s?|e")
    return [
        label if label and is_error.fullmatch(name) and role(label) not in SIZES else f"{label} {name}".strip()
        for label, name in pairs
    ]


# Tables with one line for each quantity.


def _across(above: list[Row], block: list[Row]) -> Table | None:
    """Return the table with one line for each quantity and one column for each mesh; None if it is no such table."""
    columns: dict[str, list[str]] = {}
    for row in block:
        found = re.fullmatch(r"(a+-*)([9-]*)", row.kinds)
        if found is None or found[2].count("9") < 2:
            return None
        columns[" ".join(row.cells[: found.end(1)]).strip(" :=")] = row.cells[found.end(1) :]
    form, number, length = "one line for each quantity", block[0].number, max(map(len, columns.values()))
    if any(role(name) in SIZES for name in columns):
        return _from_columns(form, columns, number)
    sizes = [re.fullmatch(r"\$?(\w+) *= *(.+?)\$?", cell) for cell in above[-1].cells if cell] if above else []
    if len(sizes) == length and (first := sizes[0]) and all(sizes):
        columns = {first[1]: [size[2] for size in sizes if size]} | columns
        caption = next((row.text.strip() for row in above[-2::-1]), "")
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
    pairs = zip(numbers[::2], numbers[1::2], numbers[2::2], strict=False)
    return all(not fine or (abs(p) < 99 and abs(coarse / fine / 2**p - 1) < 0.02) for coarse, p, fine in pairs)


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


# Lists, size: error pairs, name = value lines, and JSON.

_LIST = re.compile(
    r"(?P<name>[^\[\](){}=:\n]{1,80}?)[ \t]*[=:]\s*(?:[\w.]{1,40}\(?)?[\[({](?P<values>[^\[\](){}]*)[\])}]|"
    r"(?m:^)[ \t]*(?P<bare>[^\[\](){}=:\n]{0,40}[^\W\d][^\[\](){}=:\n]{0,40})[=:][ \t]*"
    r"(?P<row>[-+.\d]\S*(?:,[ \t]+[-+.\d][^\s,]*)+)"
)
_PAIR = re.compile(r"(?<![\w.])(\d[\d.]*(?:[eE][-+]?\d+)?)\s*:\s*([-+]?[\d.]+(?:[eEdD][-+]?\d+)?)(?![\w:])")


def _lists(text: str) -> list[Table]:
    """Return the tables whose columns are lists.

    They have the form ``name = [1, 2, 3]``, ``name: 1, 2, 3`` or ``label 51: 0.1, 101: 0.02``. A second list of mesh
    sizes begins another table. A heading such as ``Q1:`` is joined with the names below it.
    """
    bare = "\n".join(line for _, line, *_ in _lines(text))
    groups: list[dict[str, list[str]]] = [{}]
    for line in bare.split("\n"):
        pairs = _PAIR.findall(line)
        if len(pairs) > 1:
            sizes, values = map(list, zip(*pairs, strict=True))
            if groups[-1].get("", sizes) != sizes:
                groups.append({})
            groups[-1][""] = sizes
            groups[-1][_PAIR.split(line)[0].strip(" \t,:;-{(=") or f"errors {len(groups[-1])}"] = values
    found = [] if groups[0] else list(_LIST.finditer(bare))
    for one in found:
        name = (one["name"] or one["bare"]).strip(" \t,\"'")
        above = re.findall(r"(?m)^ *([^=:\n]{1,60}):[ \t]*$", bare[: one.start() + 1]) if one["bare"] else []
        values = re.split(r"[,;\s]+", (one["values"] or one["row"]).strip(" ,;\n\t"))
        kinds = [kind_of(value) for value in values]
        lengths = list(map(len, groups[-1].values()))
        if len(values) < 2 or NUMBER not in kinds or (TEXT in kinds and len(values) not in lengths):
            continue
        name = " ".join([*above[-1:], name])
        if name in groups[-1] and role(name) in SIZES:
            groups.append({})
        groups[-1][f"{name} ({len(lengths) + 1})" if name in groups[-1] else name] = values
    alone = len(found) == 1 and found[0][0].strip() == bare.strip(" ;\n")
    form = "lists" if found else "size: error pairs"
    return [_from_columns(form, columns) for columns in groups if len(columns) > 1 or (alone and columns)]


_VALUE = re.compile(
    r"[=:]\s*(?P<value>[^\s,;=:]+(?:,\d[^\s,;=:]*)*(?:\s*(?:%|(?:[xX×·*]|\\times|\\cdot)\s*10[^\s,;=:]*))?)(?=[\s,;]|:\s|$)"
)
"""Matches a value with its sign = or :. It may have a decimal comma, a power of ten or a per cent sign."""


_DIFFERENCE = re.compile(
    r"(?P<a>[-+.\d]\S*)\s*\((?:computed|numerical)\),?\s*(?P<b>[-+.\d]\S*)\s*\((?:analytical|exact|reference)\)"
)


def _difference(found: re.Match[str]) -> str:
    """Return the error of a computed value beside an exact one."""
    computed, exact = to_number(found["a"]), to_number(found["b"])
    return found[0] if computed is None or exact is None else f"{abs(computed - exact):.9g}"


def _records(text: str) -> list[Table]:
    """Return the table in lines ``name = value``; a name that occurs again begins the next row."""
    records: list[dict[str, str]] = []
    numbers: list[int] = []
    for number, line, *_ in _lines(text):
        end = 0
        line = re.sub(r"=\s*[^\W\d]\w*\s*(?==)", "", _DIFFERENCE.sub(_difference, line))
        for found in _VALUE.finditer(line):
            key = re.split(r"[,;]", line[end : found.start()])[-1].strip(" \t*-\"'{[:")
            end, value = found.end(), found["value"].strip("*|`}]")
            if len(key) > 80 or key[-1:] in "<>!" or not re.search(r"[^\W\d]", key):
                continue
            # Logging programs write the date and INFO in front of the name.
            key = key.split()[-1] if role(key) == "unknown" and role(key.split()[-1]) in SIZES else key
            if not records or (key in records[-1] and kind_of(value) != TEXT):
                records.append({})
                numbers.append(number)
            records[-1].setdefault(key, value)
    counts = Counter(key for record in records for key in record)
    names = [key for key, times in counts.items() if times > 1 and times >= len(records) - 1]
    if not any(kind_of(record.get(name, "")) == NUMBER for record in records for name in names):
        return []
    rows = [[record.get(name, "") for name in names] for record in records]
    filled = [k for k, row in enumerate(rows) if any(row)]
    return [Table("name = value lines", names, [rows[k] for k in filled], [numbers[k] for k in filled])]


def _json(text: str) -> list[Table]:
    """Return the tables in JSON: lists of objects, or objects whose entries are lists of equal length."""
    try:
        return list(_json_tables(json.loads(text), ""))
    except (ValueError, RecursionError):
        return []


def _json_tables(data: Any, caption: str) -> Iterator[Table]:
    if isinstance(data, list):
        objects = [dict(_flat(entry)) for entry in data if isinstance(entry, dict)]
        names = [name for name in (objects or [{}])[0] if all(name in entry for entry in objects)]
        columns = {name: [entry[name] for entry in objects] for name in names}
    else:
        flat = isinstance(data, dict) and any(isinstance(entry, list) for entry in data.values())
        columns = {name: entry for name, entry in _flat(data) if isinstance(entry, list) and flat}
    cells = {name: [str(value) for value in column] for name, column in columns.items() if not _nested(column)}
    if len(cells) > 1:
        yield replace(_from_columns("JSON", cells), caption=caption)
        return
    for name, entry in enumerate(data) if isinstance(data, list) else data.items() if isinstance(data, dict) else ():
        yield from _json_tables(entry, f"{caption} {name}".strip())


def _nested(column: list[Any]) -> bool:
    return any(isinstance(value, dict | list) for value in column)


def _flat(entry: Any, prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the entries of an object and of the objects in it; their names are joined by blanks."""
    for name, value in entry.items() if isinstance(entry, dict) else ():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{name} ")
        else:
            yield f"{prefix}{name}", value
