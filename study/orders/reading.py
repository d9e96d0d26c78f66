"""Reads tables of errors from text: finds rows, columns and names in the forms in which people paste tables.

These forms are understood: values separated by commas, semicolons, tabs, pipes (Markdown, pytools, box drawing), ``&``
(LaTeX) or blanks; headers that are comments or have two rows; transposed tables; ``name = value`` lines; lists ``name =
[1, 2, 3]``; ``label 51: 0.1, 101: 0.02`` lines. The meaning of a column is decided in ``columns.py``.
"""

from __future__ import annotations

import codecs
import csv
import math
import re
from collections import Counter
from dataclasses import dataclass, replace

from .cells import SIZES, UNIT, role, to_number, uses_decimal_commas
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

Split = list[tuple[str, int, int]]
"""The cells of a line, each with the positions at which it begins and ends."""
_WITHIN_NUMBER = re.compile(r"(?<=[\d.])\s+(%(?!\S)|(?:±|\+/-|\\pm|x|×|\\times|\\cdot|·)\s*(?=\d))")
_PAIRS = re.compile(r"(?<!\S)([^\s:]+:) +(?=[-+.\d])")
_NORM = re.compile(r"\\?\|\\?\|[^|]+\\?\|\\?\||\\\|[^|]+\\\|")


def _split(line: str, separator: str) -> Split:
    """Return the cells of a line with their positions.

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
        return [(found[0], *found.span()) for found in re.finditer(r"\S+", line) if found[0] not in ("|", ",")]
    if separator in ",;":
        try:
            cells = next(csv.reader([line.strip()], delimiter=separator, skipinitialspace=True), [])
        except csv.Error:
            cells = line.strip().split(separator)
    elif separator == "|":
        # Bars in a norm such as ||u - u_h|| do not separate cells, but bars around a number do.
        protected = _NORM.sub(
            lambda found: found[0] if _is_number(found[0].strip("|\\ ")) else found[0].replace("|", "\0"), line
        )
        protected = protected if "|" in protected else line
        cells = [cell.replace("\0", "|") for cell in re.sub(r"^\s*\||\|\s*$", "", protected).split("|")]
    elif separator == "&":
        cells = re.split(r"(?<!\\)&", line)
    else:
        cells = line.strip("\n\r ").split(separator)
    return [(cell.strip(), 0, 0) for cell in cells]


def _is_number(cell: str) -> bool:
    """Return whether a cell contains a number, with a decimal point or a decimal comma, or with a unit."""
    value = to_number(cell)
    value = to_number(cell, decimal_comma=True) if value is None else value
    if value is None and (found := UNIT.fullmatch(cell)):
        value = to_number(found["number"])
    return value is not None and (not math.isnan(value) or "nan" in cell.lower())


def _is_missing(cell: str) -> bool:
    value = to_number(cell)
    return value is not None and math.isnan(value) and "nan" not in cell.lower()


def _separator(lines: list[Line]) -> str | None:
    """Return the separator that divides most lines into cells with numbers; None if there is none."""
    best, most = None, 0.0
    for separator in ("|", "&", "\t", ";", ",", " "):
        score = 0.0
        for line in lines[:300]:
            if line.is_comment or (separator != " " and separator not in line.text):
                continue
            cells = [cell for cell, *_ in _split(line.text, separator)]
            while cells and not cells[-1]:
                cells.pop()
            numbers = sum(map(_is_number, cells[:50]))
            filled = numbers + sum(map(_is_missing, cells[:50]))
            if numbers >= 2 or (numbers == 1 and filled >= 2):
                score += filled / len(cells[:50])
        if score > most + 1e-9:
            best, most = separator, score
    return best


_FORMS = {"|": "columns separated by |", "&": "LaTeX rows", "\t": "columns separated by tabs"}
_FORMS |= {";": "columns separated by semicolons", ",": "CSV", " ": "columns separated by blanks"}
_SUMMARY = re.compile(r"(?i)\W*(?:mean|average|avg|overall|total|fit|fitted|slope|eoc|rate|order|median|min|max)\b")
_NO_CAPTION = re.compile(rf"{_SUMMARY.pattern}|\W*$|\.\.|[@\\]")
_TYPE_OR_UNIT = re.compile(
    r"(?i)u?int\d*|float\d*\??|[fiu]\d+|str(?:ing)?|double|real|bool|\[.*\]|\(.*\)|[-–—1%]?|[kcmµ]?m|m?s|[kMG]?Pa|deg|°"
)


def _delimited(lines: list[Line]) -> list[RawTable]:
    """Return the tables whose cells are separated by a sign or by blanks."""
    separator = _separator(lines)
    if separator is not None:
        grid = _Grid(lines, separator)
        return grid.transposed() or grid.tables()
    if all(not re.search(r"[=:]", line.text) for line in lines):
        first = _short(lines[0].text.strip())
        if not any(_is_number(cell) for line in lines for cell, *_ in _split(line.text, " ")[:50]):
            raise OrderError(f"no line with numbers; the first line is '{first}'; {EXAMPLE}")
        if all(len(_split(line.text, " ")) == 1 for line in lines):
            rows = [line for line in lines if _is_number(line.text.strip())]
            names = [line.text.strip() for line in lines if not _is_number(line.text.strip())]
            if len(names) > 1:
                raise OrderError(f"there is one column only ('{first}'); {EXAMPLE}")
            cells, numbers = [[line.text.strip()] for line in rows], [line.number for line in rows]
            return [RawTable("one column", names or ["error"], cells, numbers)]
    return []


class _Grid:
    """The lines of a text, divided into cells by one separator."""

    def __init__(self, lines: list[Line], separator: str) -> None:
        self.lines, self.separator = lines, separator
        self.split = [_split(line.text, separator) for line in lines]
        self.texts = [[cell for cell, *_ in cells] for cells in self.split]

    def tables(self) -> list[RawTable]:
        """Return the tables in the lines. A table is a block of rows with a header above it."""
        tables: list[RawTable] = []
        above: list[int] = []
        block: list[int] = []
        comments: list[int] = []
        for i in range(len(self.lines)):
            if self._is_row(i, len(self.split[block[0]]) if block else 0):
                block.append(i)
            elif not (block and self.lines[i].is_comment and not self._starts_table(i, block)):
                if block:
                    tables += self._table(above, block, tables)
                    above, block, comments = comments, [], []
                above.append(i)
            else:
                comments.append(i)
        return tables + (self._table(above, block, tables) if block else [])

    def _is_row(self, i: int, width: int) -> bool:
        """Return whether a line is a row of a table, because enough of its cells are numbers.

        At least half of the cells must be numbers. One number is enough for a line with as many cells as the table.

        Parameters:
            i: index of the line.
            width: number of columns of the table above the line; 0 if no table has begun.
        """
        texts = self.texts[i]
        numbers = sum(map(_is_number, texts))
        if self.lines[i].is_comment or not numbers or _SUMMARY.match(texts[0]):
            return False
        filled = numbers + sum(cell != "" and _is_missing(cell) for cell in texts)
        used = sum(cell != "" for cell in texts)
        if self.separator != " " and width:
            return len(texts) == width or filled >= used / 2
        return filled >= used / 2 and (used > 1 or width > 1)

    def _starts_table(self, i: int, block: list[int]) -> bool:
        """Return whether a comment between rows of numbers is the header of another table."""
        width = len(self.texts[i])
        following = next((j for j in range(i + 1, len(self.lines)) if not self.lines[j].is_comment), None)
        if following is None or any(map(_is_number, self.texts[i])):
            return False
        return len(self.split[following]) == width == len(self.split[block[0]]) > 1

    def _table(self, above: list[int], block: list[int], before: list[RawTable]) -> list[RawTable]:
        """Return the table that consists of a block of rows, in a list; the list is empty if it is not a table.

        The header is the nearest line above the block with a name for each column.

        Parameters:
            above: indices of the lines above the block.
            block: indices of the rows.
            before: tables above the block. If the block has no header, it gets the header of the last one.
        """
        rows, width = self._aligned(block)
        names, used = self._header(above, rows, width)
        if not names and before and len(before[-1].names) == width:
            names = before[-1].names
        if not names and len(block) < 2 and above:
            return []
        if not names:
            first, sign = self.lines[block[0]], self.separator.replace("\t", " ")
            others = f"; the line above is '{_short(self.lines[above[-1]].text.strip())}'" if above else ""
            raise OrderError(
                f"the table that begins in line {first.number}, '{_short(first.text.strip())}', has {width} columns, "
                f"but no line above names them{others}: add a header such as "
                f"'{_short(sign.join(['h', *['error'] * (width - 1)]))}'"
            )
        captions = [self.lines[i].text.strip() for i in above if i not in used]
        caption = next((text for text in reversed(captions) if not _NO_CAPTION.match(text)), "")
        numbers = [self.lines[i].number for i in block]
        return [RawTable(_FORMS[self.separator], names, rows, numbers, _short(caption, 100))]

    def _aligned(self, block: list[int]) -> tuple[list[list[str]], int]:
        """Return lines as rows with equal numbers of cells, and this number.

        If columns are separated by blanks, the position of the other cells shows which cell of a line is empty.

        Parameters:
            block: indices of the lines.
        """
        lengths = [len(self.split[i]) for i in block]
        width = max(lengths) if self.separator == " " else Counter(lengths).most_common(1)[0][0]
        model = self.split[block[lengths.index(width)]]
        rows = []
        for i in block:
            texts = self.texts[i]
            placed = _place(self.split[i], model) if self.separator == " " and len(texts) < width else None
            padded = len(texts) > width or (self.separator in "\t&|" and len(texts) > 1)
            if placed or len(texts) == width or (padded and not any(texts[width:])):
                rows.append(placed or (texts + [""] * width)[:width])
                continue
            hint = "; decimal commas? Then separate columns by semicolons" if self.separator == "," else ""
            line = self.lines[i]
            raise OrderError(
                f"line {line.number}: {len(texts)} entries, expected {width}: '{_short(line.text.strip())}'{hint}"
            )
        return rows, width

    def _header(self, above: list[int], rows: list[list[str]], width: int) -> tuple[list[str], list[int]]:
        """Find the header of a table among the lines above it.

        Parameters:
            above: indices of these lines.
            rows, width: the rows of the table, and the number of its columns.

        Returns:
            The names of the columns, and the indices of the lines of the header; two empty lists if no line is a
            header.
        """
        units = [i for i in above if all(map(_TYPE_OR_UNIT.fullmatch, self.texts[i]))]
        for i in (i for i in reversed(above) if i not in units):
            names = self._names(i, rows, width)
            if names is None or any(name == "=" or (_is_number(name) and not name.isalpha()) for name in names):
                continue
            group = next((j for j in reversed(above) if j < i), None)
            if group is not None and self.lines[i].number - self.lines[group].number <= 2:
                grouped = self._grouped(group, i, names)
                if grouped:
                    return grouped, [i, group, *units]
            return names, [i, *units]
        return [], []

    def _names(self, i: int, rows: list[list[str]], width: int) -> list[str] | None:
        """Return the names of columns in a line; None if the line does not have enough names.

        A name may be missing for columns of orders, and for the first column if it only counts the rows.

        Parameters:
            i: index of the line.
            rows, width: the rows of the table, and the number of its columns.
        """
        text, texts = self.lines[i].text, list(self.texts[i])
        # A bar or comma between blanks is not part of a name.
        wide = re.split(r"\s{2,}|\t", re.sub(r"(?<!\S)[|,](?!\S)", "  ", text).strip())
        if self.separator != " ":
            while len(texts) > width and not texts[-1]:
                texts.pop()
            candidates = [
                texts,
                *([wide] if self.separator == "\t" else []),
                *([text.split()] if self.separator != "," else []),
            ]
            return next((words for words in candidates if len(words) == width), None)
        counts = [to_number(row[0]) for row in rows]
        indexed = any(counts == [float(k) for k in range(start, start + len(rows))] for start in (0, 1))
        primary = [k for k in range(width) if not _is_missing(rows[0][k])]
        for words in (wide, texts):
            if len(words) == width:
                return words
            if len(words) == width - 1 and indexed and text[:1].isspace():
                return [UNNAMED, *words]
        for words in (wide, texts):
            if len(words) == len(primary) < width and len(rows) > 1:
                named = dict(zip(primary, words, strict=True))
                last = [max((j for j in primary if j <= k), default=primary[0]) for k in range(width)]
                return [named.get(k, f"order of {named[last[k]]}") for k in range(width)]
            if len(words) == width - 1 and indexed:
                return [UNNAMED, *words]
        return None

    def _grouped(self, group: int, i: int, names: list[str]) -> list[str] | None:
        """Return the names of columns from a header of two rows; None if it is no such header.

        Each heading in the upper row spans several columns, and is joined with the names below it.

        Parameters:
            group, i: indices of the upper and of the lower row.
            names: the names in the lower row.
        """
        if self.separator == " ":
            upper, wide = _phrases(self.lines[group].text), _phrases(self.lines[i].text)
            lower = wide if len(wide) == len(names) else self.split[i]
        else:
            upper = [(cell, k, k + 1) for k, cell in enumerate(self.texts[group]) if cell]
            lower = [(name, k, k + 1) for k, name in enumerate(names)]
        if (
            len(set(names)) == len(names)
            or not 1 < len(upper) <= len(names) <= MOST_GROUPED
            or len(lower) != len(names)
        ):
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

    def transposed(self) -> list[RawTable]:
        """Return the tables with one line for each quantity and one column for each mesh.

        The list is empty if there is no such table.
        """
        runs: list[list[int]] = []
        labelled = {i: parts for i in range(len(self.lines)) if (parts := self._labelled(i))}
        for i in range(len(self.lines)):
            if i not in labelled and self._is_row(i, 0) and _is_number(self.texts[i][0]):
                return []
            if i in labelled and i - 1 in labelled:
                runs[-1].append(i)
            elif i in labelled:
                runs.append([i])
        for attempt in (runs, [sorted(labelled)] if labelled else []):
            tables = [table for run in attempt if (table := self._transposed_run(run, [labelled[i] for i in run]))]
            if tables:
                return tables
        return []

    def _labelled(self, i: int) -> tuple[str, list[str]] | None:
        """Return label and values of a line that consists of a label and at least two numbers; otherwise None."""
        texts = list(self.texts[i])
        while texts and not texts[-1] and self.separator != "|":
            texts.pop()
        first = next(
            (k for k, cell in enumerate(texts) if k and (_is_number(cell) or (cell and _is_missing(cell)))), None
        )
        if first is None or self.lines[i].is_comment or _is_number(texts[0]) or (self.separator != " " and first > 2):
            return None
        values = texts[first:]
        if sum(map(_is_number, values)) < 2 or not all(_is_number(cell) or _is_missing(cell) for cell in values):
            return None
        return " ".join(texts[:first]).strip(), values

    def _transposed_run(self, run: list[int], labelled: list[tuple[str, list[str]]]) -> RawTable | None:
        """Return the table that consists of consecutive lines, one for each quantity; None if it has no mesh sizes.

        Parameters:
            run: indices of the lines.
            labelled: label and values of each line.
        """
        number, width = self.lines[run[0]].number, max(len(values) for _, values in labelled)
        form, caption = "one line for each quantity", ""
        if any(role(label.strip(" :=")) in SIZES for label, _ in labelled):
            return _from_columns(
                form, {label: [""] * (width - len(values)) + values for label, values in labelled}, number
            )
        if any(len(values) != width for _, values in labelled):
            return None
        above = self.texts[run[0] - 1] if run[0] else []
        named = [_NAMED_SIZE.fullmatch(cell.strip("$ ")) for cell in above]
        if any(named) and all(found is None or to_number(found["value"]) is not None for found in named):
            sizes = [(k - (len(named) - width), found) for k, found in enumerate(named) if found]
            columns = {sizes[0][1]["name"]: [found["value"] for _, found in sizes]}
            columns |= {label: [values[k] for k, _ in sizes] for label, values in labelled}
            caption = self.lines[run[0] - 2].text.strip() if run[0] > 1 and run[0] - 2 not in run else ""
            return replace(_from_columns(f"{form}, sizes in the header", columns, number), caption=caption)
        if width % 2 and width >= 3 and (not above or _orders_between(labelled)):
            # The AMReX library prints errors and orders in turn: error order error order error.
            pairs = [((label, values[::2]), (f"order of {label}", ["", *values[1::2]])) for label, values in labelled]
            columns = dict(pair for both in pairs for pair in both)
            return _from_columns(f"{form}, orders between the errors", columns, number)
        return None


def _phrases(text: str) -> Split:
    """Return the phrases of a line with their positions; between two phrases there are two or more blanks."""
    return [(found[0], *found.span()) for found in re.finditer(r"\S+(?: \S+)*", text)]


def _labels_of_repeated(upper: Split, lower: Split) -> list[str] | None:
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


def _labels_from_left(upper: Split, lower: Split) -> list[str] | None:
    """Return for each column name the last heading of the upper row that begins above the name or left of it.

    None is returned if a heading does not begin above the beginning of a name.

    Parameters:
        upper, lower: headings and names with their positions.
    """
    if any(all(abs(begin - start) > 1 for _, start, _ in lower) for _, begin, _ in upper):
        return None
    near = 0 if all(end - start == 1 for _, start, end in lower) else 1
    return [next((label for label, begin, _ in reversed(upper) if begin <= start + near), "") for _, start, _ in lower]


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


def _place(cells: Split, model: Split) -> list[str] | None:
    """Return the cells of an incomplete row in the columns of a complete row, with empty cells for missing ones.

    The position of a cell in its line shows its column. None is returned if two cells belong to the same column.

    Parameters:
        cells: the cells of the incomplete row, with their positions.
        model: the cells of the complete row, with their positions.
    """
    placed = [""] * len(model)
    for cell, start, end in cells:
        overlap = [min(end, right) - max(start, left) for _, left, right in model]
        k = max(range(len(model)), key=overlap.__getitem__)
        if placed[k] or overlap[k] < 0:
            return None
        placed[k] = cell
    return placed


_NAMED_SIZE = re.compile(r"(?P<name>[^\W\d][\w ]*|Δx|Δt)\s*=\s*(?P<value>.+)")


def _from_columns(form: str, columns: dict[str, list[str]], line: int) -> RawTable:
    rows = [list(row) for row in zip(*columns.values(), strict=True)]
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
        if len(values) < 2 or not all(map(_is_number, values)):
            continue
        name = found["name"].strip(" \t,").strip("\"'")
        if name in groups[-1] and role(name) in SIZES:
            groups.append({})
        count = sum(other == name or other.startswith(f"{name} (") for other in groups[-1])
        groups[-1][f"{name} ({count + 1})" if count else name] = values
    alone = _LIST.fullmatch(text.strip(" ;\n")) is not None
    tables = []
    for columns in (columns for columns in groups if len(columns) > 1 or (alone and columns)):
        longest = max(map(len, columns.values()))
        if min(map(len, columns.values())) < longest - 1:
            sizes = ", ".join(f"{name} has {len(values)}" for name, values in columns.items())
            raise OrderError(f"lists of different lengths: {sizes}; expected one value for each mesh in every list")
        filled = {name: [""] * (longest - len(values)) + values for name, values in columns.items()}
        tables.append(_from_columns("lists", filled, lines[0].number))
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


_VALUE = re.compile(r"[=:]\s*(?P<value>[^\s,;=:]+)(?=[\s,;]|$)")


def _key_values(lines: list[Line]) -> list[RawTable]:
    """Return the table in lines ``name = value``; a name that occurs again begins the next row."""
    records: list[dict[str, str]] = []
    numbers: list[int] = []
    for line in lines:
        end = 0
        for found in _VALUE.finditer(line.text):
            before, end, value = line.text[end : found.start()], found.end(), found["value"].strip("*|`}]")
            key = re.split(r"[,;]", before)[-1].strip(" \t*-\"'{[")
            named = len(key) <= 80 and key[-1:] not in "<>!" and re.search(r"[^\W\d]", key)
            if not named or not (_is_number(value) or _is_missing(value)):
                continue
            if not records or key in records[-1]:
                records.append({})
                numbers.append(line.number)
            records[-1][key] = value
    counts = Counter(key for record in records for key in record)
    names = [key for key, times in counts.items() if times >= max(2, len(records) - 1)]
    if len(names) < 2:
        return []
    rows = [[record.get(name, "") for name in names] for record in records]
    filled = [k for k, row in enumerate(rows) if any(row)]
    return [RawTable("name = value lines", names, [rows[k] for k in filled], [numbers[k] for k in filled])]


def _plain(table: RawTable) -> RawTable:
    """Return a table without empty columns, and without units and decimal commas in its cells.

    A column is empty, for example, if each line ends with a separator.
    """
    filled = [k for k, name in enumerate(table.names) if name or any(not _is_missing(row[k]) for row in table.rows)]
    columns = [[row[k] for row in table.rows] for k in filled]
    cells = [cell for column in columns for cell in column]
    comma = uses_decimal_commas(cells)
    if comma is None:
        cell = next(cell for cell in cells if "," in cell)
        raise OrderError(
            f"'{cell}' may be {cell.replace(',', '.')} or {cell.replace(',', '')}: write it without a comma"
        )
    for column in columns:
        found = [UNIT.fullmatch(cell) for cell in column if not _is_missing(cell)]
        if found and all(found) and len({match["unit"] for match in found if match}) == 1:
            column[:] = [UNIT.sub(r"\g<number>", cell) for cell in column]
        if comma:
            numbers = [to_number(cell, decimal_comma=True) for cell in column]
            column[:] = [
                cell if value is None or math.isnan(value) else repr(value)
                for cell, value in zip(column, numbers, strict=True)
            ]
    rows = [list(row) for row in zip(*columns, strict=True)]
    form = table.form + (", decimal commas" if comma else "")
    return replace(table, form=form, names=[table.names[k] for k in filled], rows=rows)
