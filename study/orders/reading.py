"""Reads tables of errors from text: finds rows, columns and names in the forms in which people paste tables.

These forms are understood: values separated by commas, semicolons, tabs, pipes (Markdown, pytools, box drawing), ``&``
(LaTeX) or blanks; headers that are comments or have two rows; transposed tables; ``name = value`` lines; lists ``name =
[1, 2, 3]``; ``label 51: 0.1, 101: 0.02`` lines. The meaning of a column is decided in ``columns.py``.
"""

import codecs
import csv
import math
import re
from collections import Counter
from dataclasses import dataclass, replace
from itertools import groupby
from typing import NamedTuple

from .cells import SIZES, UNIT, is_missing, role, to_number, uses_decimal_commas
from .sequences import OrderError

MAX_BYTES = 8_000_000
MAX_ROWS = 100_000
MAX_CELL = 2_000
MOST_GROUPED = 1_000
"""Largest number of names in a header of two rows; with more names, reading would take too long."""
UNNAMED = ""
"""Stands in place of the name of a column without a name."""
EXAMPLE = (
    "expected a header such as 'h error' and one line for each mesh, for example 'h,error', '0.5,0.1', '0.25,0.025'"
)


@dataclass(frozen=True)
class RawTable:
    """A table with names of columns and cells as text.

    Attributes:
        form: the form of the table in words, such as ``CSV``.
        names: names of the columns; an empty text for a column without a name.
        rows: the cells, one list for each mesh.
        lines: the line number of each row in the text.
        caption: the text above the table.
        label: name of the case, such as ``degree 2``, if the table is a part of a larger table.
    """

    form: str
    names: list[str]
    rows: list[list[str]]
    lines: list[int]
    caption: str = ""
    label: str = ""


@dataclass(frozen=True)
class Line:
    """A line of the input text, without the sign that marks a comment, such as ``#``."""

    number: int
    text: str
    is_comment: bool


def decode(data: bytes) -> str:
    """Return the text in bytes that are encoded in UTF-8, UTF-16 or Windows-1252.

    Raises:
        OrderError: there are more than 8 MB, or the bytes are not text.
    """
    if len(data) > MAX_BYTES:
        raise OrderError(
            f"it has more than {MAX_BYTES // 10**6} MB: a table of errors has one line for each mesh; {EXAMPLE}"
        )
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        encoding = "utf-16"
    elif len(data) > 3 and data[1::2].count(0) > 0.4 * len(data):
        encoding = "utf-16-le"
    elif len(data) > 3 and data[::2].count(0) > 0.4 * len(data):
        encoding = "utf-16-be"
    else:
        encoding = "utf-8-sig"
    for candidate in (encoding, "cp1252"):
        try:
            text = data.decode(candidate)
        except UnicodeDecodeError:
            continue
        odd = next((sign for sign in text if ord(sign) < 32 and sign not in "\t\n\r\f\v\x1b"), None)
        if odd is None:
            return text
        line = text[: text.index(odd)].count("\n") + 1
        raise OrderError(
            f"line {line} contains the byte {ord(odd):#04x}: a binary file? Save the table as text in UTF-8"
        )
    raise OrderError("it is not text but binary: save the table as text in UTF-8")


def read_tables(data: bytes | str) -> list[RawTable]:
    """Return all tables in a text, in the order in which they occur.

    Parameters:
        data: the text, or the content of a file.

    Raises:
        OrderError: no table is recognised, a row has too few or too many cells, or the input is too large.
    """
    text = decode(data) if isinstance(data, bytes) else data
    lines = _lines(text)
    if not lines:
        raise OrderError(f"it is empty; {EXAMPLE}")
    for find in (_lists, _labelled_pairs, _delimited, _key_values):
        tables = [table for table in find(lines) if table.rows]
        if tables:
            return [_plain(table) for table in tables]
    seen = next((line.text for line in lines if re.search(r"\d", line.text)), lines[0].text).strip()
    raise OrderError(f"no table was recognised, the first line with a number is '{_short(seen)}'; {EXAMPLE}")


def _short(text: str, width: int = 60) -> str:
    return text if len(text) <= width else text[: width - 1] + "…"


_RULE = re.compile(
    r"(?:[\s|+:=_#*~.─━═┼╪┌┐└┘├┤┬┴╞╡╤╧╭╮╯╰╌╍-]|\\[a-z]+rule(?:\[.*?\]|\{.*?\}|\(.*?\))*|\\hline)*(?:\\\\)?"
)
_LATEX_LINE = re.compile(r"\s*\\(?:begin|end|label|centering|small|caption|tabcolsep)")
_LATEX_END = re.compile(r"\\\\(?:\[.*?\])?\s*(?:\\[a-z]+(?:\{.*?\}|\[.*?\])*\s*)*$|\\tabularnewline.*$")
_LONG_CELL = re.compile(rf"(?<![^\s,;|&])[^\s,;|&]{{{MAX_CELL},}}")
_BRACED = r"\{((?:[^{}]|\{(?:[^{}]|\{[^{}]*\})*\}){0,200})\}"
_MULTIROW = re.compile(rf"\\multirow(?:\[\w+\])?\{{[^{{}}]*\}}\{{[^{{}}]*\}}{_BRACED}")
_MULTICOLUMN = re.compile(rf"\\multicolumn\{{(\d{{1,2}})\}}\{{(?:[^{{}}]|\{{[^{{}}]*\}}){{0,80}}\}}{_BRACED}")
_LATEX_START = re.compile(
    r"^\s*(?:\\(?:hline|[a-z]+rule|rowcolor\{.*?\}|c(?:mid)?(?:rule|line)(?:\(.*?\))?\{.*?\}|addlinespace)\s*)+"
)


def _lines(text: str) -> list[Line]:
    """Return the lines of a text that may belong to a table.

    Colour codes, quote marks, rules and LaTeX commands for the layout are removed.
    """
    text = re.sub(r"\x1b\[[0-9;]*[A-Za-z]", "", text)
    text = re.sub(r"\b(?:(?:np\.|numpy\.)?float\d*|tensor|array)\(([^()\[\]]*)\)", r"\1", text)
    signs: dict[str, str | int | None] = {"│": "|", "┃": "|", "║": "|", "┆": "|", "\u200b": None, "\ufeff": None}
    text = text.translate(str.maketrans(signs))
    raw = re.split(r"\r\n|\r|\n", text)
    for k in range(len(raw) - 1, 0, -1):
        # A row of a LaTeX table that ends with & continues on the next line, so both lines are joined.
        if raw[k - 1].rstrip().endswith("&") and len(raw[k]) < MAX_CELL:
            raw[k - 1 : k + 1] = [f"{raw[k - 1]} {raw[k]}", ""]
    quoted = sum(line.lstrip().startswith("> ") for line in raw)
    found = []
    for number, line in enumerate(raw, start=1):
        if len(line) > MAX_CELL and (long := _LONG_CELL.search(line)):
            raise OrderError(f"line {number} has a cell of {len(long[0])} characters; {EXAMPLE}")
        if quoted > len(raw) / 2:
            line = re.sub(r"^\s*(?:> ?)+", "", line)
        caption = re.match(r"\s*\\caption\{(.*)\}", line)
        if caption:
            line = caption[1]
        if _RULE.fullmatch(line) or _LATEX_LINE.match(line) or line.lstrip().startswith("```"):
            continue
        if "\\" in line:
            # pandas ends the header of a part of a wide table with a backslash.
            line = re.sub(r"\s\\$", "", line)
            line = _MULTIROW.sub(r"\1", _LATEX_START.sub("", _LATEX_END.sub("", line)))
            line = _MULTICOLUMN.sub(lambda found: found[2] + " &" * (int(found[1]) - 1), line)
        comment = re.match(r"\s*(?:#+|%+|//|!)[ \t]*(?=[^\d.\s]|\s*[\d.])", line)
        found.append(Line(number, line[comment.end() :] if comment else line, comment is not None))
        if len(found) > MAX_ROWS:
            raise OrderError(
                f"it has more than {MAX_ROWS} lines: a table of errors has one line for each mesh; {EXAMPLE}"
            )
    return found


# Tables with separators between the cells of a row.

_WITHIN_NUMBER = re.compile(r"(?<=[\d.])\s+(%(?!\S)|(?:±|\+/-|\\pm|x|×|\\times|\\cdot|·)\s*(?=\d))")
_PAIRS = re.compile(r"(?<!\S)([^\s:]+:) +(?=[-+.\d])")
_NORM = re.compile(r"\\?\|\\?\|[^|]+\\?\|\\?\||\\\|[^|]+\\\|")
NUMBER, MISSING, TEXT = "number", "missing", "text"
"""What a cell contains: a number; nothing, or a sign for a missing number; any other text."""


def _kind(cell: str) -> str:
    """Return what a cell contains. A number may have a decimal comma, or a unit behind it; nan is a number."""
    value = to_number(cell)
    if is_missing(cell, value):
        return MISSING
    value = to_number(cell, decimal_comma=True) if value is None else value
    if value is None and (found := UNIT.fullmatch(cell)):
        value = to_number(found["number"])
    return TEXT if value is None else NUMBER


class Cell(NamedTuple):
    """A cell or a heading with its place: characters of the line if blanks separate cells, otherwise the column."""

    text: str
    start: int
    end: int


def _split(line: str, separator: str) -> list[Cell]:
    """Return the cells of a line.

    Parameters:
        line: the line.
        separator: the sign between two cells; a blank stands for one or more blanks.
    """
    if separator == " ":
        # ``h = 1/2`` is one cell, ``h: 0.5 error: 0.1`` are two. A bar or comma between blanks is no cell.
        joined = _WITHIN_NUMBER.sub(lambda found: found[1].strip(), line)
        line = re.sub(r"(?<=\S) *(=+) *(?=\S)", r"\1", joined)
        if len(_PAIRS.findall(line)) > 1:
            line = _PAIRS.sub(r"\1", line)
        return [cell for cell in _places(r"\S+", line) if cell.text not in ("|", ",")]
    if separator in ",;":
        try:
            cells = next(csv.reader([line.strip()], delimiter=separator, skipinitialspace=True), [])
        except csv.Error:
            cells = line.strip().split(separator)
    elif separator == "|":
        # Bars in a norm such as ||u - u_h|| do not separate cells, but bars around a number do.
        protected = _NORM.sub(
            lambda found: found[0] if _kind(found[0].strip("|\\ ")) == NUMBER else found[0].replace("|", "\0"), line
        )
        protected = protected if "|" in protected else line
        cells = [cell.replace("\0", "|") for cell in re.sub(r"^\s*\||\|\s*$", "", protected).split("|")]
    else:
        cells = re.split(r"(?<!\\)&", line) if separator == "&" else line.strip("\n\r ").split(separator)
    return [Cell(cell.strip(), k, k + 1) for k, cell in enumerate(cells)]


def _places(pattern: str, text: str) -> list[Cell]:
    return [Cell(found[0], *found.span()) for found in re.finditer(pattern, text)]


class Row:
    """A line that is divided into cells by a separator.

    Attributes:
        number, is_comment: the line number, and whether the line is a comment.
        text: the line without surrounding blanks; ``raw`` is the line with them.
        cells, texts, kinds: the cells, their texts, and what they contain.
        numbers: number of the cells with numbers.
        used: number of the cells up to the last one that is not empty.
    """

    def __init__(self, line: Line, separator: str) -> None:
        self.number, self.raw, self.is_comment = line.number, line.text, line.is_comment
        self.text, self.separator = line.text.strip(), separator
        self.cells = _split(line.text, separator)
        self.texts = [cell.text for cell in self.cells]
        self.kinds = [_kind(text) for text in self.texts]
        self.numbers = self.kinds.count(NUMBER)
        self.used = max((k for k, text in enumerate(self.texts, start=1) if text), default=0)

    def score(self) -> float:
        """Return the share of cells with or without a number; 0 if the separator does not divide the line well."""
        kinds = self.kinds[: min(self.used, 50)]
        filled = len(kinds) - kinds.count(TEXT)
        return filled / len(kinds) if filled > 1 and NUMBER in kinds and not self.is_comment else 0.0

    def is_data(self, width: int = 0, named: bool = False) -> bool:
        """Return whether the line is a row of a table, because at least half of its cells are numbers.

        One number is enough for a line with as many cells as the table.

        Parameters:
            width: number of columns of the table above the line; 0 if no table has begun.
            named: whether rows begin with words. If not, a line that begins with ``mean`` or ``order`` sums up others.
        """
        if self.is_comment or not self.numbers or (not named and _SUMMARY.match(self.texts[0])):
            return False
        words = sum(map(bool, self.texts))
        if self.separator != " " and width == len(self.texts):
            return True
        return words >= 2 * self.kinds.count(TEXT) and (words > 1 or width > 1)

    def labelled(self) -> tuple[str, list[str]] | None:
        """Return label and values of a line that consists of a label and at least two numbers; otherwise None."""
        end = len(self.texts) if self.separator == "|" else self.used
        first = next((k for k in range(1, end) if self.texts[k] and self.kinds[k] != TEXT), end)
        kinds = self.kinds[first:end]
        if self.is_comment or kinds.count(NUMBER) < 2 or TEXT in kinds or self.kinds[0] == NUMBER:
            return None
        if self.separator != " " and first > 2:
            return None
        return " ".join(self.texts[:first]).strip(), self.texts[first:end]


_FORMS = {"|": "columns separated by |", "&": "LaTeX rows", "\t": "columns separated by tabs"}
_FORMS |= {";": "columns separated by semicolons", ",": "CSV", " ": "columns separated by blanks"}
"""Separator ↦ the form of a table in words; of separators that divide lines equally well, the first one is taken."""
_SUMMARY = re.compile(r"(?i)\W*(?:mean|average|avg|overall|total|fit|fitted|slope|eoc|rate|order|median|min|max)\b")
_NO_CAPTION = re.compile(rf"{_SUMMARY.pattern}|\W*$|\.\.|[@\\]")
_TYPE_OR_UNIT = re.compile(
    r"(?i)u?int\d*|float\d*\??|[fiu]\d+|<\w+>|str(?:ing)?|double|real|bool|\[.*\]|\(.*\)|[-–—1%]?|[kcmµ]?m|m?s|[kMG]?Pa|deg|°"
)


def _delimited(lines: list[Line]) -> list[RawTable]:
    """Return the tables whose cells are separated by a sign or by blanks.

    The separator is the one that divides most lines into cells with numbers.
    """
    scores = {separator: sum(Row(line, separator).score() for line in lines[:300]) for separator in _FORMS}
    best = max(scores.values())
    if best > 0:
        separator = next(separator for separator, score in scores.items() if score > best - 1e-9)
        rows = [Row(line, separator) for line in lines]
        return _transposed(rows) or _blocks(rows)
    if any(re.search(r"[=:]", line.text) for line in lines):
        return []
    rows = [Row(line, " ") for line in lines]
    first = _short(rows[0].text)
    if not any(NUMBER in row.kinds[:50] for row in rows):
        raise OrderError(f"no line with numbers; the first line is '{first}'; {EXAMPLE}")
    if any(len(row.cells) != 1 for row in rows):
        return []
    names = [row.text for row in rows if _kind(row.text) != NUMBER]
    if len(names) > 1:
        raise OrderError(f"there is one column only ('{first}'); {EXAMPLE}")
    rows = [row for row in rows if _kind(row.text) == NUMBER]
    return [RawTable("one column", names or ["error"], [[row.text] for row in rows], [row.number for row in rows])]


def _blocks(rows: list[Row]) -> list[RawTable]:
    """Return the tables in the lines of a text. A table is a block of rows with a header above it."""
    tables: list[RawTable] = []
    above: list[Row] = []
    block: list[Row] = []
    comments: list[Row] = []
    first = Counter(row.kinds[0] for row in rows if row.numbers and not row.is_comment)
    named = first[TEXT] > first[NUMBER]
    rows = _without_remarks(rows)
    for i, row in enumerate(rows):
        # A line such as "Table 1" above a header is a caption, and "Elapsed 12.3" below rows of numbers ends the table.
        caption = row.kinds[:1] == [TEXT] and not any(below.numbers for below in rows[i + 1 : i + 2])
        caption = caption and row.separator == " " and (not block or block[0].kinds[0] == NUMBER)
        if not caption and row.is_data(len(block[0].cells) if block else 0, named):
            block.append(row)
        elif block and row.is_comment and not _starts_table(rows[i:], block[0]):
            comments.append(row)
        else:
            if block:
                tables += _table(above, block, tables)
                above, block, comments = comments, [], []
            above.append(row)
    return tables + (_table(above, block, tables) if block else [])


def _without_remarks(rows: list[Row]) -> list[Row]:
    """Return the lines of a text, without remarks behind the numbers of a row."""
    found = [*rows]
    for step in (-1, 1):
        for i in range(len(rows))[::-step]:
            if 0 <= i + step < len(rows):
                found[i] = _without_remark(found[i], found[i + step])
    return found


def _without_remark(row: Row, near: Row) -> Row:
    """Return a line without a remark behind its numbers, if the line above or below, ``near``, is a row of a table.

    Raises:
        OrderError: the line begins with a number, like the row, but has words where the row has numbers. The
            computation on this mesh may have failed, so it must not be left out.
    """
    beside = near.is_data() and abs(row.number - near.number) == 1 and row.separator == " " and not row.is_comment
    if not beside or row.is_data(len(near.cells)) or not row.kinds[:1] == near.kinds[:1] == [NUMBER]:
        return row
    width = (*near.kinds, TEXT).index(TEXT)
    if len(row.cells) < width or TEXT in row.kinds[:width]:
        raise OrderError(
            f"line {row.number}, '{_short(row.text)}', begins like a row of the table, but has words where "
            "numbers are expected: write the numbers, or nan if the computation failed, or # in front of the line"
        )
    return Row(Line(row.number, row.raw[: row.cells[width - 1].end], False), row.separator)


def _starts_table(rows: list[Row], data: Row) -> bool:
    """Return whether a comment between rows of numbers is the header of another table.

    Parameters:
        rows: the comment and the lines below it.
        data: a row of the table above the comment.
    """
    following = next((row for row in rows if not row.is_comment), None)
    widths = {len(row.cells) for row in (rows[0], data, following) if row}
    return following is not None and not rows[0].numbers and widths == {len(data.cells)} != {1}


def _table(above: list[Row], block: list[Row], before: list[RawTable]) -> list[RawTable]:
    """Return the table that consists of a block of rows, in a list; the list is empty if it is not a table.

    The header is the nearest line above the block with a name for each column.

    Parameters:
        above: the lines above the block.
        block: the rows.
        before: tables above the block. If the block has no header, it gets the header of the last one.
    """
    rows, width = _aligned(block)
    names, used = _header(above, rows, width)
    if not names and before and len(before[-1].names) == width:
        names = before[-1].names
    if not names and len(block) < 2 and above:
        return []
    if not names:
        first, sign = block[0], block[0].separator.replace("\t", " ")
        others = f"; the line above is '{_short(above[-1].text)}'" if above else ""
        raise OrderError(
            f"the table that begins in line {first.number}, '{_short(first.text)}', has {width} columns, but no line "
            f"above names them{others}: add a header such as '{_short(sign.join(['h', *['error'] * (width - 1)]))}'"
        )
    captions = [row.text for row in above if row not in used]
    caption = next((text for text in reversed(captions) if not _NO_CAPTION.match(text)), "")
    return [RawTable(_FORMS[block[0].separator], names, rows, [row.number for row in block], _short(caption, 100))]


def _aligned(block: list[Row]) -> tuple[list[list[str]], int]:
    """Return lines as rows with equal numbers of cells, and this number.

    If columns are separated by blanks, the position of the other cells shows which cell of a line is empty.
    """
    lengths, separator = [len(row.cells) for row in block], block[0].separator
    width = max(lengths) if separator == " " else Counter(lengths).most_common(1)[0][0]
    model = block[lengths.index(width)].cells
    rows = []
    for row, length in zip(block, lengths, strict=True):
        cells: list[str] | None = row.texts
        if length < width and separator == " ":
            cells = _place(row.cells, model)
        elif 1 < length < width and separator in "\t&|":
            cells = row.texts + [""] * (width - length)
        if cells is None or len(cells) < width or any(cells[width:]):
            hint = "; decimal commas? Then separate columns by semicolons" if separator == "," else ""
            raise OrderError(f"line {row.number}: {length} entries, expected {width}: '{_short(row.text)}'{hint}")
        rows.append(cells[:width])
    return rows, width


def _place(cells: list[Cell], model: list[Cell]) -> list[str] | None:
    """Return the cells of an incomplete row in the columns of a complete row, with empty cells for missing ones.

    The position of a cell in its line shows its column. None is returned if two cells belong to the same column.
    """
    placed = [""] * len(model)
    for cell, start, end in cells:
        overlap = [min(end, right) - max(start, left) for _, left, right in model]
        k = max(range(len(model)), key=overlap.__getitem__)
        if placed[k] or overlap[k] < 0:
            return None
        placed[k] = cell
    return placed


def _header(above: list[Row], rows: list[list[str]], width: int) -> tuple[list[str], list[Row]]:
    """Find the header of a table among the lines above it.

    Parameters:
        above: these lines.
        rows, width: the rows of the table, and the number of its columns.

    Returns:
        The names of the columns, and the lines of the header; two empty lists if no line is a header.
    """
    units = [row for row in above if all(map(_TYPE_OR_UNIT.fullmatch, row.texts))]
    for k, row in reversed([*enumerate(above)]):
        names = None if row in units else _names(row, rows, width)
        if names is None or any(name == "=" or (_kind(name) == NUMBER and not name.isalpha()) for name in names):
            continue
        near = k > 0 and row.number - above[k - 1].number <= 2
        if near and (grouped := _grouped(above[k - 1], row, names)):
            return grouped, [row, above[k - 1], *units]
        return names, [row, *units]
    return [], []


def _names(row: Row, rows: list[list[str]], width: int) -> list[str] | None:
    """Return the names of columns in a line; None if the line does not have enough names.

    A name may be missing for columns of orders, and for the first column if it only counts the rows.

    Parameters:
        row: the line.
        rows, width: the rows of the table, and the number of its columns.
    """
    # A bar or comma between blanks is not part of a name.
    wide = re.split(r"\s{2,}|\t", re.sub(r"(?<!\S)[|,](?!\S)", "  ", row.raw).strip())
    if row.separator != " ":
        candidates = [row.texts[: max(width, row.used)]]
        candidates += [wide] if row.separator == "\t" else []
        candidates += [row.text.split()] if row.separator != "," else []
        return next((words for words in candidates if len(words) == width), None)
    counts = [to_number(cells[0]) for cells in rows]
    indexed = any(counts == [float(k) for k in range(start, start + len(rows))] for start in (0, 1))
    primary = [k for k in range(width) if _kind(rows[0][k]) != MISSING]
    # Names of several words may happen to have as many words as the table has columns.
    narrow = wide if len(wide) == len(primary) < width and len(rows) > 1 else row.texts
    for words in (wide, narrow):
        if len(words) == width:
            return words
        if len(words) == width - 1 and indexed and row.raw[:1].isspace():
            return [UNNAMED, *words]
    for words in (wide, narrow):
        if len(words) == len(primary) < width and len(rows) > 1:
            named = dict(zip(primary, words, strict=True))
            last = [max((j for j in primary if j <= k), default=primary[0]) for k in range(width)]
            return [named.get(k, f"order of {named[last[k]]}") for k in range(width)]
        if len(words) == width - 1 and indexed:
            return [UNNAMED, *words]
    return None


def _grouped(group: Row, row: Row, names: list[str]) -> list[str] | None:
    """Return the names of columns from a header of two rows; None if it is no such header.

    Each heading in the upper row spans several columns, and is joined with the names below it.

    Parameters:
        group, row: the upper and the lower row.
        names: the names in the lower row.
    """
    if row.separator == " ":
        # Between two headings there are two or more blanks.
        upper, wide = (_places(r"\S+(?: \S+)*", line.raw) for line in (group, row))
        lower = wide if len(wide) == len(names) else row.cells
    else:
        upper = [cell for cell in group.cells if cell.text]
        lower = [Cell(name, k, k + 1) for k, name in enumerate(names)]
    repeated = len(set(names)) < len(names) == len(lower)
    if not repeated or not 1 < len(upper) <= len(names) <= MOST_GROUPED:
        return None
    labels = _labels_of_repeated(upper, lower) or _labels_from_left(upper, lower)
    if labels is None:
        return None
    combined = []
    for name, label in zip(names, labels, strict=True):
        # The heading replaces a name such as ``error``. But a heading such as h is joined with the name, because an
        # error of a quantity h must not be taken as the mesh size.
        is_error = re.fullmatch(r"(?i)err(?:or)?s?|e", name) and role(label) not in SIZES
        combined.append(label if label and is_error else f"{label} {name}".strip())
    return combined


def _labels_of_repeated(upper: list[Cell], lower: list[Cell]) -> list[str] | None:
    """Return for each column name the heading in the upper row of a header; None if the columns form no groups.

    A group has different names, which are repeated in the next group, and one heading above it. Columns of mesh sizes
    belong to no group; their heading is empty.

    Parameters:
        upper, lower: headings and names with their positions.
    """
    names = [name for name, *_ in lower]
    groups: list[list[int]] = []
    for k, name in enumerate(names):
        if names.count(name) == 1 and role(name) in (*SIZES, "level"):
            continue
        if not groups or name in [names[j] for j in groups[-1]]:
            groups.append([])
        groups[-1].append(k)
    if len(groups) != len(upper):
        return None
    labels, before = [""] * len(names), 0
    for (label, begin, end), group in zip(upper, groups, strict=True):
        left, right = lower[group[0]][1], lower[group[-1]][2]
        if begin < before or not left <= (begin + end) / 2 <= right:
            return None
        labels[group[0] : group[-1] + 1] = [label] * (group[-1] + 1 - group[0])
        before = right
    return labels


def _labels_from_left(upper: list[Cell], lower: list[Cell]) -> list[str] | None:
    """Return for each column name the last heading of the upper row that begins above the name or left of it.

    None is returned if a heading does not begin above the beginning of a name.

    Parameters:
        upper, lower: headings and names with their positions.
    """
    if any(all(abs(begin - start) > 1 for _, start, _ in lower) for _, begin, _ in upper):
        return None
    near = 0 if all(end - start == 1 for _, start, end in lower) else 1
    return [next((label for label, begin, _ in reversed(upper) if begin <= start + near), "") for _, start, _ in lower]


def _transposed(rows: list[Row]) -> list[RawTable]:
    """Return the tables with one line for each quantity and one column for each mesh.

    The list is empty if there is no such table.
    """
    labelled = {i: parts for i, row in enumerate(rows) if (parts := row.labelled())}
    if any(row.is_data() and row.kinds[0] == NUMBER for i, row in enumerate(rows) if i not in labelled):
        return []
    # Consecutive lines have the same difference of line and place among the labelled lines.
    runs = [[i for _, i in run] for _, run in groupby(enumerate(labelled), lambda pair: pair[1] - pair[0])]
    for attempt in (runs, [[*labelled]] if labelled else []):
        tables = [table for run in attempt if (table := _transposed_run(rows, run, [labelled[i] for i in run]))]
        if tables:
            return tables
    return []


def _transposed_run(rows: list[Row], run: list[int], labelled: list[tuple[str, list[str]]]) -> RawTable | None:
    """Return the table that consists of lines, one for each quantity; None if it has no mesh sizes.

    Parameters:
        rows: all lines.
        run: indices of the lines of the table.
        labelled: label and values of each line of the table.
    """
    start, form, width = run[0], "one line for each quantity", max(len(values) for _, values in labelled)
    number = rows[start].number
    if any(role(label.strip(" :=")) in SIZES for label, _ in labelled):
        return _from_columns(form, dict(labelled), number, width)
    if any(len(values) != width for _, values in labelled):
        return None
    above = rows[start - 1].texts if start else []
    named = [_NAMED_SIZE.fullmatch(cell.strip("$ ")) for cell in above]
    if any(named) and all(found is None or to_number(found["value"]) is not None for found in named):
        sizes = [(k - (len(named) - width), found) for k, found in enumerate(named) if found]
        columns = {sizes[0][1]["name"]: [found["value"] for _, found in sizes]}
        columns |= {label: [values[k] for k, _ in sizes] for label, values in labelled}
        caption = rows[start - 2].text if start > 1 else ""
        return replace(_from_columns(f"{form}, sizes in the header", columns, number), caption=caption)
    if width % 2 and width >= 3 and (not above or _orders_between(labelled)):
        # The AMReX library prints errors and orders in turn: error order error order error.
        pairs = [((label, values[::2]), (f"order of {label}", ["", *values[1::2]])) for label, values in labelled]
        columns = dict(pair for both in pairs for pair in both)
        return _from_columns(f"{form}, orders between the errors", columns, number)
    return None


def _orders_between(labelled: list[tuple[str, list[str]]]) -> bool:
    """Return whether lines have errors and orders in turn: error, order, error, order, error.

    Each order must be the observed order of the errors to its left and right for halved mesh sizes.

    Parameters:
        labelled: label and values of each line.
    """
    checked = []
    for numbers in ([to_number(cell) or math.nan for cell in values] for _, values in labelled):
        for coarse, order, fine in zip(numbers[::2], numbers[1::2], numbers[2::2], strict=False):
            if coarse > 0 and fine > 0 and math.isfinite(order):
                checked.append(abs(math.log2(coarse / fine) - order) < 0.02 + 0.01 * abs(order))
    return bool(checked) and all(checked)


_NAMED_SIZE = re.compile(r"(?P<name>[^\W\d][\w ]*|Δx|Δt)\s*=\s*(?P<value>.+)")


def _from_columns(form: str, columns: dict[str, list[str]], line: int, length: int = 0) -> RawTable:
    """Return the table with the given columns. Columns shorter than ``length`` get empty cells at the top."""
    filled = [[""] * (length - len(cells)) + cells for cells in columns.values()]
    rows = [list(row) for row in zip(*filled, strict=True)]
    return RawTable(form, list(columns), rows, [line] * len(rows))


# Other forms: lists, size: error pairs, and ``name = value`` lines.

_OPENING = r"[=:]\s*(?:[\w.]{1,40}\(?)?[\[({]"
_LIST = re.compile(rf"(?P<name>[^\[\](){{}}=:\n]{{1,80}}?)[ \t]*{_OPENING}(?P<values>[^\[\](){{}}]*)[\])}}]")

_UNNAMED_LIST = re.compile(r"\s*(?:[\w.]{1,40}\()?\[[^\[\]{}:=]*\]\)?[,;]?\s*")


def _lists(lines: list[Line]) -> list[RawTable]:
    """Return the tables whose columns are lists ``name = [1, 2, 3]``.

    A list may continue on further lines. A second list of mesh sizes begins another table.
    """
    text = "\n".join(line.text for line in lines)
    if not re.search(_OPENING, text):
        if lines and all(_UNNAMED_LIST.fullmatch(line.text) for line in lines):
            raise OrderError(
                f"the list in line {lines[0].number} has no name: write 'h = ' in front of the list of sizes and "
                "'error = ' in front of every list of errors"
            )
        return []
    groups: list[dict[str, list[str]]] = [{}]
    for found in _LIST.finditer(text):
        values = re.split(r"[,;\s]+", found["values"].strip(" ,;\n\t"))
        kinds = [_kind(value) for value in values]
        if len(values) < 2 or NUMBER not in kinds:
            continue
        if TEXT in kinds and len(values) not in map(len, groups[-1].values()):
            continue
        name = found["name"].strip(" \t,").strip("\"'")
        if name in groups[-1] and role(name) in SIZES:
            groups.append({})
        count = sum(other == name or other.startswith(f"{name} (") for other in groups[-1])
        groups[-1][f"{name} ({count + 1})" if count else name] = values
    alone = _LIST.fullmatch(text.strip(" ;\n")) is not None
    tables = []
    for columns in (columns for columns in groups if len(columns) > 1 or (alone and columns)):
        lengths = [len(values) for values in columns.values()]
        if min(lengths) < max(lengths) - 1:
            sizes = ", ".join(f"{name} has {len(values)}" for name, values in columns.items())
            raise OrderError(f"lists of different lengths: {sizes}; expected one value for each mesh in every list")
        tables.append(_from_columns("lists", columns, lines[0].number, max(lengths)))
    return tables


_PAIR = re.compile(
    r"(?<![\w.])(?P<size>\d[\d.]*(?:[eE][-+]?\d+)?)\s*:\s*(?P<value>[-+]?[\d.]+(?:[eEdD][-+]?\d+)?)(?![\w:])"
)


def _labelled_pairs(lines: list[Line]) -> list[RawTable]:
    """Return the table in lines such as ``label 51: 0.1, 101: 0.02``, with one line for each quantity."""
    columns: dict[str, list[str]] = {}
    sizes: list[str] = []
    number = 0
    for line in lines:
        pairs = list(_PAIR.finditer(line.text))
        if len(pairs) < 2:
            continue
        label = line.text[: pairs[0].start()].strip(" \t,:;-{(=") or f"errors {len(columns) + 1}"
        here = [found["size"] for found in pairs]
        if sizes and here != sizes:
            raise OrderError(
                f"line {line.number} has the sizes {', '.join(here)}, line {number} has {', '.join(sizes)}: give every "
                "quantity on the same meshes"
            )
        sizes, number = here, line.number
        columns[label] = [found["value"] for found in pairs]
    return [_from_columns("size: error pairs", {UNNAMED: sizes} | columns, number)] if columns else []


_VALUE = re.compile(
    r"[=:]\s*(?P<value>[^\s,;=:]+(?:,\d[^\s,;=:]*)*(?:\s*(?:%|(?:[xX×·*]|\\times|\\cdot)\s*10[^\s,;=:]*))?)(?=[\s,;]|:\s|$)"
)
"""Matches a value with its sign = or :. It may have a decimal comma, a power of ten or a per cent sign."""


def _key_values(lines: list[Line]) -> list[RawTable]:
    """Return the table in lines ``name = value``; a name that occurs again begins the next row."""
    records: list[dict[str, str]] = []
    numbers: list[int] = []
    for line in lines:
        end = 0
        for found in _VALUE.finditer(line.text):
            before, end, value = line.text[end : found.start()], found.end(), found["value"].strip("*|`}]")
            key = re.split(r"[,;]", before)[-1].strip(" \t*-\"'{[:")
            named = len(key) <= 80 and key[-1:] not in "<>!" and re.search(r"[^\W\d]", key)
            if not named:
                continue
            if role(key) == "unknown" and role(key.split()[-1]) in SIZES:
                # Logging programs write the date and INFO in front of the name.
                key = key.split()[-1]
            if _kind(value) == TEXT:
                if records:
                    records[-1].setdefault(key, value)
                continue
            if not records or key in records[-1]:
                records.append({})
                numbers.append(line.number)
            records[-1][key] = value
    counts = Counter(key for record in records for key in record)
    numbered = {key for record in records for key, value in record.items() if _kind(value) == NUMBER}
    names = [key for key, times in counts.items() if times >= max(2, len(records) - 1) and key in numbered]
    if len(names) < 2:
        return []
    rows = [[record.get(name, "") for name in names] for record in records]
    filled = [k for k, row in enumerate(rows) if any(row)]
    return [RawTable("name = value lines", names, [rows[k] for k in filled], [numbers[k] for k in filled])]


def _plain(table: RawTable) -> RawTable:
    """Return a table without empty columns, and without units and decimal commas in its cells.

    A column is empty, for example, if each line ends with a separator.
    """
    filled = [k for k, name in enumerate(table.names) if name or any(_kind(row[k]) != MISSING for row in table.rows)]
    columns = [[row[k] for row in table.rows] for k in filled]
    cells = [cell for column in columns for cell in column]
    comma = uses_decimal_commas(cells)
    if comma is None:
        cell = next(cell for cell in cells if "," in cell)
        raise OrderError(
            f"'{cell}' may be {cell.replace(',', '.')} or {cell.replace(',', '')}: write it without a comma"
        )
    for column in columns:
        found = [UNIT.fullmatch(cell) for cell in column if _kind(cell) != MISSING]
        if found and all(found) and len({match["unit"] for match in found if match}) == 1:
            column[:] = [UNIT.sub(r"\g<number>", cell) for cell in column]
        if comma:
            numbers = [to_number(cell, decimal_comma=True) for cell in column]
            column[:] = [
                cell if value is None or math.isnan(value) or not re.search(r"[.,]", cell) else repr(value)
                for cell, value in zip(column, numbers, strict=True)
            ]
    rows = [list(row) for row in zip(*columns, strict=True)]
    form = table.form + (", decimal commas" if comma else "")
    return replace(table, form=form, names=[table.names[k] for k in filled], rows=rows)
