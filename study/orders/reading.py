"""Text → tables. Finds the rows, columns and names of a table of errors in the form in which people paste it.

Forms that are read: values separated by commas, semicolons, tabs, pipes (Markdown, pytools, box drawing), ``&`` (LaTeX)
or blanks; headers that are comments or take two rows; transposed tables; ``name = value`` lines; lists
``name = [1, 2, 3]``; ``label 51: 0.1, 101: 0.02`` lines. What a column means is decided in ``columns.py``.
"""

from __future__ import annotations

import codecs
import csv
import math
import re
from collections import Counter
from dataclasses import dataclass, field

from study.orders.errors import OrderError
from study.orders.numbers import UNIT, to_number, uses_decimal_commas

MAX_BYTES = 8_000_000
MAX_ROWS = 100_000
MAX_CELL = 2_000
UNNAMED = ""
EXAMPLE = (
    "expected a header such as 'h error' and one line for each mesh, for example 'h,error', '0.5,0.1', '0.25,0.025'"
)


@dataclass(frozen=True)
class RawTable:
    """Names and cells as text.

    Attributes:
        form: what the table looks like, in words.
        names: names of the columns; an empty name is none.
        rows: cells, one list for each mesh.
        lines: line number of every row.
        caption: text above the table.
        notes: what was left out.
    """

    form: str
    names: list[str]
    rows: list[list[str]]
    lines: list[int]
    caption: str = ""
    notes: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class Line:
    number: int
    text: str
    is_comment: bool


def decode(data: bytes) -> str:
    """Text from bytes in UTF-8 or UTF-16, with or without byte order mark, or in Windows-1252.

    Raises:
        OrderError: more than 8 MB, or bytes that are no text.
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
    raise OrderError("it is not text: save the table as text in UTF-8")


def read_tables(data: bytes | str) -> list[RawTable]:
    """All tables in a text, in the order in which they stand there.

    Raises:
        OrderError: no table was found, a row has too few or too many cells, or the input is too large.
    """
    text = decode(data) if isinstance(data, bytes) else data
    lines = _lines(text)
    if not lines:
        raise OrderError(f"it is empty; {EXAMPLE}")
    for find in (_lists, _labelled_pairs, _delimited, _key_values):
        tables = [table for table in find(lines) if table.rows]
        if tables:
            return [_without_units(_without_empty_columns(table)) for table in tables]
    seen = next((line.text for line in lines if re.search(r"\d", line.text)), lines[0].text).strip()
    raise OrderError(f"no table was recognised, the first line with a number is '{_short(seen)}'; {EXAMPLE}")


def _short(text: str, width: int = 60) -> str:
    return text if len(text) <= width else text[: width - 1] + "…"


_RULE = re.compile(
    r"(?:[\s|+:=_#*~.─━═┼╪┌┐└┘├┤┬┴╞╡╤╧╭╮╯╰╌╍-]|\\[a-z]+rule(?:\[.*?\]|\{.*?\}|\(.*?\))*|\\hline)*(?:\\\\)?"
)
_LATEX_LINE = re.compile(
    r"\s*\\(?:begin|end|label|centering|small|caption|tabcolsep|multicolumn\{\d+\}\{[^}]*\}\{[^}]*\}\s*$)"
)
_LATEX_END = re.compile(r"\\\\(?:\[.*?\])?\s*(?:\\[a-z]+(?:\{.*?\}|\[.*?\])*\s*)*$|\\tabularnewline.*$")
_LATEX_START = re.compile(
    r"^\s*(?:\\(?:hline|[a-z]+rule|rowcolor\{.*?\}|c(?:mid)?(?:rule|line)(?:\(.*?\))?\{.*?\}|addlinespace)\s*)+"
)


def _lines(text: str) -> list[Line]:
    """The lines with content, without colours, quote marks, rules and LaTeX commands that draw."""
    text = re.sub(r"\x1b\[[0-9;]*[A-Za-z]", "", text)
    signs: dict[str, str | int | None] = {"│": "|", "┃": "|", "║": "|", "┆": "|", "\u200b": None, "\ufeff": None}
    text = text.translate(str.maketrans(signs))
    raw = re.split(r"\r\n|\r|\n", text)
    quoted = sum(line.lstrip().startswith("> ") for line in raw)
    found = []
    for number, line in enumerate(raw, start=1):
        if quoted > len(raw) / 2:
            line = re.sub(r"^\s*(?:> ?)+", "", line)
        caption = re.match(r"\s*\\caption\{(.*)\}", line)
        if caption:
            line = caption[1]
        if _RULE.fullmatch(line) or _LATEX_LINE.match(line) or line.lstrip().startswith("```"):
            continue
        line = _LATEX_START.sub("", _LATEX_END.sub("", line)) if "\\" in line else line
        comment = re.match(r"\s*(?:#+|%+|//|!)[ \t]*(?=[^\d.\s]|\s*[\d.])", line)
        found.append(Line(number, line[comment.end() :] if comment else line, comment is not None))
        if len(found) > MAX_ROWS:
            raise OrderError(
                f"it has more than {MAX_ROWS} lines: a table of errors has one line for each mesh; {EXAMPLE}"
            )
    return found


# Tables with separators.

Split = list[tuple[str, int, int]]
"""Cells with the columns of the text where they begin and end."""
_JOIN_TIMES = re.compile(r"(?<=[\d.])\s+(×|\\times|\\cdot|·)\s*(?=10)")
_NORM = re.compile(r"\\?\|\\?\|[^|]+\\?\|\\?\||\\\|[^|]+\\\|")


def _split(line: str, separator: str) -> Split:
    """The cells of a line."""
    if separator == " ":
        return [(found[0], *found.span()) for found in re.finditer(r"\S+", _JOIN_TIMES.sub(r"\1", line))]
    if separator in ",;":
        try:
            cells = next(csv.reader([line.strip()], delimiter=separator, skipinitialspace=True), [])
        except csv.Error:
            cells = line.strip().split(separator)
    elif separator == "|":
        norms: list[str] = []
        protected = _NORM.sub(lambda found: norms.append(found[0]) or f"\0{len(norms) - 1}\0", line)  # type: ignore[func-returns-value]
        if norms and protected.strip("\0 0123456789"):
            cells = re.sub(r"^\s*\||\|\s*$", "", protected).split("|")
            cells = [re.sub("\0(\\d+)\0", lambda found: norms[int(found[1])], cell) for cell in cells]
        else:
            cells = re.sub(r"^\s*\||\|\s*$", "", line).split("|")
    elif separator == "&":
        cells = re.split(r"(?<!\\)&", line)
    else:
        cells = line.strip("\n\r ").split(separator)
    return [(cell.strip(), 0, 0) for cell in cells]


def _is_number(cell: str) -> bool:
    """Whether a cell holds a number, with decimal point or comma."""
    value = to_number(cell)
    value = to_number(cell, decimal_comma=True) if value is None else value
    if value is None and (found := UNIT.fullmatch(cell)):
        value = to_number(found["number"])
    return value is not None and (not math.isnan(value) or "nan" in cell.lower())


def _is_missing(cell: str) -> bool:
    value = to_number(cell)
    return value is not None and math.isnan(value) and "nan" not in cell.lower()


def _separator(lines: list[Line]) -> str | None:
    """What separates cells: the sign with which most lines fall into numbers; None if they do not."""
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
    for line in lines if best else []:
        if (
            len(line.text) > MAX_CELL
            and (longest := max(len(cell) for cell, *_ in _split(line.text, str(best)))) > MAX_CELL
        ):
            raise OrderError(f"line {line.number} has a cell of {longest} characters; {EXAMPLE}")
    return best


_FORMS = {"|": "columns separated by |", "&": "LaTeX rows", "\t": "columns separated by tabs"}
_FORMS |= {";": "columns separated by semicolons", ",": "CSV", " ": "columns separated by blanks"}
_SUMMARY = re.compile(r"(?i)\W*(?:mean|average|avg|overall|total|fit|fitted|slope|eoc|rate|order|median|min|max)\b")


def _delimited(lines: list[Line]) -> list[RawTable]:
    """Tables whose cells are separated by one sign."""
    separator = _separator(lines)
    if separator is None:
        return _headers_without_rows(lines)
    split = [_split(line.text, separator) for line in lines]
    transposed = _transposed(lines, split, separator)
    if transposed:
        return transposed
    tables: list[RawTable] = []
    above: list[int] = []
    block: list[int] = []
    for i, cells in enumerate(split):
        if _is_row(lines[i], cells, separator, len(split[block[0]]) if block else 0):
            block.append(i)
        elif lines[i].is_comment and block and not _starts_table(i, lines, split, block):
            continue
        else:
            if block:
                tables += _table(lines, split, above, block, separator, tables)
                above, block = [], []
            above.append(i)
    if block:
        tables += _table(lines, split, above, block, separator, tables)
    return tables


def _headers_without_rows(lines: list[Line]) -> list[RawTable]:
    """Raises if the text is a header alone, or has a single column of numbers."""
    if all(not re.search(r"[=:]", line.text) for line in lines):
        if not any(_is_number(cell) for line in lines for cell, *_ in _split(line.text, " ")[:50]):
            header = _short(lines[0].text.strip())
            raise OrderError(f"no line with numbers; the first line is '{header}'; {EXAMPLE}")
        if all(len(_split(line.text, " ")) == 1 for line in lines):
            raise OrderError(f"there is one column only ('{_short(lines[0].text.strip())}'); {EXAMPLE}")
    return []


def _is_row(line: Line, cells: Split, separator: str, width: int) -> bool:
    """Whether a line holds numbers of a table: half of its cells, or one where the width is right."""
    if line.is_comment:
        return False
    texts = [cell for cell, *_ in cells]
    numbers = sum(map(_is_number, texts))
    if not numbers or _SUMMARY.match(texts[0]):
        return False
    filled = numbers + sum(cell != "" and _is_missing(cell) for cell in texts)
    used = sum(cell != "" for cell in texts)
    if separator != " " and width:
        return len(cells) == width or filled >= used / 2
    return filled >= used / 2 and (used > 1 or width > 1)


def _starts_table(i: int, lines: list[Line], split: list[Split], block: list[int]) -> bool:
    """Whether a comment between rows is the header of another table."""
    names = [cell for cell, *_ in split[i]]
    following = next((j for j in range(i + 1, len(lines)) if not lines[j].is_comment), None)
    return (
        following is not None
        and len(names) == len(split[block[0]]) > 1
        and not any(map(_is_number, names))
        and len(split[following]) == len(names)
    )


def _table(
    lines: list[Line], split: list[Split], above: list[int], block: list[int], separator: str, before: list[RawTable]
) -> list[RawTable]:
    """The table of a block of rows; its header is the nearest line above that has a name for every column."""
    rows, width = _aligned(lines, split, block, separator)
    names, used = _header(lines, split, above, rows, width, separator, [split[i] for i in block])
    notes: list[str] = []
    if not names and before and len(before[-1].names) == width:
        names = before[-1].names
    if not names:
        if len(block) < 2 and above:
            return []
        first = _short(lines[block[0]].text.strip())
        others = f"; the line above is '{_short(lines[above[-1]].text.strip())}'" if above else ""
        raise OrderError(
            f"line {lines[block[0]].number}, '{first}', has {width} numbers, but no line above names {width} columns"
            f"{others}: add a header such as '{(separator if separator != ' ' else ' ').join(['h', *['error'] * (width - 1)])}'"  # noqa: E501
        )
    caption = " ".join(lines[i].text.strip() for i in above if i not in used)
    return [RawTable(_FORMS[separator], names, rows, [lines[i].number for i in block], _short(caption, 100), notes)]


def _aligned(lines: list[Line], split: list[Split], block: list[int], separator: str) -> tuple[list[list[str]], int]:
    """Rows with equally many cells: blank cells between columns of text are found by their place in the line."""
    width = Counter(len(split[i]) for i in block).most_common(1)[0][0]
    width = max(width, *(len(split[i]) for i in block)) if separator == " " else width
    model = next(split[i] for i in block if len(split[i]) == width)
    rows = []
    for i in block:
        cells = split[i]
        if len(cells) == width:
            rows.append([cell for cell, *_ in cells])
            continue
        texts = [cell for cell, *_ in cells]
        if len(cells) > width and not any(texts[width:]):
            rows.append(texts[:width])
        elif len(cells) < width and separator == " " and (placed := _place(cells, model)):
            rows.append(placed)
        elif len(cells) < width and separator in "\t&|" and len(cells) >= 2:
            rows.append(texts + [""] * (width - len(texts)))
        else:
            hint = "; decimal commas? Then separate columns by semicolons" if separator == "," else ""
            raise OrderError(
                f"line {lines[i].number}: {len(cells)} entries, expected {width}: '{_short(lines[i].text.strip())}'{hint}"  # noqa: E501
            )
    return rows, width


def _place(cells: Split, model: Split) -> list[str] | None:
    """Cells put under those cells of a full row with which they overlap; None if two share one."""
    placed = [""] * len(model)
    for cell, start, end in cells:
        overlap = [min(end, right) - max(start, left) for _, left, right in model]
        k = max(range(len(model)), key=overlap.__getitem__)
        if placed[k] or overlap[k] < 0:
            return None
        placed[k] = cell
    return placed


def _header(
    lines: list[Line],
    split: list[Split],
    above: list[int],
    rows: list[list[str]],
    width: int,
    separator: str,
    cells: list[Split],
) -> tuple[list[str], list[int]]:
    """Names of the columns and the lines they stand in; no names if no line fits."""
    for i in reversed(above):
        names = _names(lines[i].text, split[i], rows, width, separator)
        if names is None or any(_is_number(name) for name in names if name):
            continue
        group = next((j for j in reversed(above) if j < i), None)
        if group is not None and lines[i].number - lines[group].number <= 2:
            grouped = _grouped(split[group], split[i], lines[group].text, names, separator)
            if grouped:
                return grouped, [i, group]
        return names, [i]
    return [], []


def _names(text: str, cells: Split, rows: list[list[str]], width: int, separator: str) -> list[str] | None:
    """The names in a line that has one for every column, or for every column but orders or an index."""
    texts = [cell for cell, *_ in cells]
    if separator != " ":
        while len(texts) > width and not texts[-1]:
            texts.pop()
        if len(texts) == width:
            return texts
        if separator == "\t" and len(re.split(r"\s{2,}", text.strip())) == width:
            return re.split(r"\s{2,}", text.strip())
        words = text.split()
        return words if len(words) == width and separator != "," else None
    indexed = [to_number(row[0]) for row in rows] in [list(map(float, range(k, k + len(rows)))) for k in (0, 1)]
    primary = [k for k in range(width) if not _is_missing(rows[0][k])]
    wide = re.split(r"\s{2,}|\t", text.strip())
    for words in (wide, texts):
        if len(words) == width:
            return words
        if len(words) == width - 1 and indexed and text[:1].isspace():
            return [UNNAMED, *words]
    for words in (wide, texts):
        if len(words) == len(primary) < width and len(rows) > 1:
            named = dict(zip(primary, words, strict=True))
            last = ""
            names = []
            for k in range(width):
                last = named.get(k, last)
                names.append(named.get(k, f"order of {last}"))
            return names
        if len(words) == width - 1 and indexed:
            return [UNNAMED, *words]
    return None


def _grouped(group: Split, cells: Split, text: str, names: list[str], separator: str) -> list[str] | None:
    """Names of two header rows, of which the upper one spans several columns; None if it does not."""
    if len(set(names)) == len(names):
        return None
    if separator == " ":
        upper = [(found[0], found.start()) for found in re.finditer(r"\S+(?: \S+)*", text)]
        starts = [start for _, start, _ in cells]
    else:
        upper = [(cell, k) for k, (cell, *_) in enumerate(group) if cell]
        starts = list(range(len(names)))
    if not 1 < len(upper) <= len(names) or len(starts) != len(names):
        return None
    combined = []
    for name, start in zip(names, starts, strict=True):
        over = [label for label, begin in upper if begin <= start + 1]
        label = over[-1] if over else ""
        combined.append(label if label and re.fullmatch(r"(?i)err(?:or)?s?|e", name) else f"{label} {name}".strip())
    return combined


# Transposed tables: one line for each quantity.

_SIZE_LABEL = re.compile(
    r"(?i)\W*(?:h|h_?max|dx|dy|Δx|\\?delta[ _]?x|mesh[ _-]?(?:size|width)|n|nx|cells|elements|n?dofs?|dt|Δt|tau|τ|resolution|"  # noqa: E501
    r"number of (?:cells|elements|dofs|points|unknowns))\W*(?:\[.*\]|\(.*\))?\W*"
)
_NAMED_SIZE = re.compile(r"(?P<name>[^\W\d][\w ]*|Δx|Δt)\s*=\s*(?P<value>.+)")


def _transposed(lines: list[Line], split: list[Split], separator: str) -> list[RawTable]:
    """A table with a line for each quantity and a column for each mesh, if the labels or the header say so."""
    labelled = []
    for line, cells in zip(lines, split, strict=True):
        texts = [cell for cell, *_ in cells]
        while texts and not texts[-1] and separator != "|":
            texts.pop()
        first = next(
            (k for k, cell in enumerate(texts) if k and (_is_number(cell) or (cell and _is_missing(cell)))), None
        )
        if first is None or line.is_comment or _is_number(texts[0]) or (separator != " " and first > 2):
            continue
        values = texts[first:]
        if sum(map(_is_number, values)) >= 2 and all(_is_number(cell) or _is_missing(cell) for cell in values):
            labelled.append((" ".join(texts[:first]).strip(), values, line.number))
    if not labelled or any(
        _is_row(line, cells, separator, 0) and _is_number(cells[0][0]) for line, cells in zip(lines, split, strict=True)
    ):
        return []
    width = max(len(values) for _, values, _ in labelled)
    if any(_SIZE_LABEL.fullmatch(label) for label, *_ in labelled):
        columns = {label: [""] * (width - len(values)) + values for label, values, _ in labelled}
        return [_from_columns("one line for each quantity", columns, labelled[0][2])]
    if any(len(values) != width for _, values, _ in labelled):
        return []
    first_line = labelled[0][2]
    header = next(
        (cells for line, cells in zip(reversed(lines), reversed(split), strict=True) if line.number < first_line), None
    )
    named = [_NAMED_SIZE.fullmatch(cell.strip("$ ")) for cell, *_ in header] if header else []
    if header and any(named) and all(found is None or to_number(found["value"]) is not None for found in named):
        places = [k - (len(named) - width) for k, found in enumerate(named) if found]
        sizes = [found["value"] for found in named if found]
        name = next(found["name"] for found in named if found)
        columns = {name: sizes} | {label: [values[k] for k in places] for label, values, _ in labelled}
        return [_from_columns("one line for each quantity, sizes in the header", columns, first_line)]
    if header is None and width % 2 and width >= 3:
        return [_alternating(labelled, width)]
    return []


def _alternating(labelled: list[tuple[str, list[str], int]], width: int) -> RawTable:
    """Errors with the orders between them, as AMReX prints: error order error order error."""
    columns: dict[str, list[str]] = {}
    for label, values, _ in labelled:
        columns[label] = values[::2]
        columns[f"order of {label}"] = ["", *values[1::2]]
    return _from_columns("one line for each quantity, orders between the errors", columns, labelled[0][2])


def _from_columns(form: str, columns: dict[str, list[str]], line: int) -> RawTable:
    rows = [list(row) for row in zip(*columns.values(), strict=True)]
    return RawTable(form, list(columns), rows, [line] * len(rows))


# Lists, pairs and lines with names.

_LIST = re.compile(
    r"(?P<name>[^\[\](){}=:\n]{1,80}?)[ \t]*[=:][ \t]*(?:\w[\w.]{0,40}\()?[\[({](?P<values>[^\[\](){}]*)[\])}]"
)


def _lists(lines: list[Line]) -> list[RawTable]:
    """``name = [1, 2, 3]``, one for each column; a list may take several lines."""
    text = "\n".join(line.text for line in lines)
    if not re.search(r"[=:]\s*(?:\w[\w.]{0,40}\()?[\[({]", text):
        return []
    columns: dict[str, list[str]] = {}
    for found in _LIST.finditer(text):
        values = re.split(r"[,;\s]+", found["values"].strip(" ,;\n\t"))
        if len(values) >= 2 and all(map(_is_number, values)):
            columns[found["name"].strip().strip("\"'")] = values
    if len(columns) < 2:
        return []
    length = max(map(len, columns.values()))
    if min(map(len, columns.values())) < length - 1:
        sizes = ", ".join(f"{name} has {len(values)}" for name, values in columns.items())
        raise OrderError(f"lists of different lengths: {sizes}; expected one value for each mesh in every list")
    columns = {name: [""] * (length - len(values)) + values for name, values in columns.items()}
    return [_from_columns("lists", columns, lines[0].number)]


_PAIR = re.compile(
    r"(?<![\w.])(?P<size>\d[\d.]*(?:[eE][-+]?\d+)?)\s*:\s*(?P<value>[-+]?[\d.]+(?:[eEdD][-+]?\d+)?)(?![\w:])"
)


def _labelled_pairs(lines: list[Line]) -> list[RawTable]:
    """``label 51: 0.1, 101: 0.02, 201: 0.005``, one line for each quantity."""
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
                f"line {line.number} has the sizes {', '.join(here)}, line {number} has {', '.join(sizes)}; expected the same"  # noqa: E501
            )
        sizes, number = here, line.number
        columns[label] = [found["value"] for found in pairs]
    return [_from_columns("size: error pairs", {UNNAMED: sizes} | columns, number)] if columns else []


_KEY_VALUE = re.compile(r"(?P<key>(?=[^=:]*[^\W\d])[^=:,;]*?[^\s=:,;<>!])\s*[=:]\s*(?P<value>[^\s,;=:]+)(?=[\s,;]|$)")


def _key_values(lines: list[Line]) -> list[RawTable]:
    """``name = value`` lines; a record ends where a name comes again."""
    records: list[dict[str, str]] = []
    numbers: list[int] = []
    for line in lines:
        for found in _KEY_VALUE.finditer(line.text):
            key, value = found["key"].strip(" \t*-"), found["value"].strip("*|`")
            if not (_is_number(value) or _is_missing(value)):
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
    kept = [k for k, row in enumerate(rows) if any(row)]
    return [RawTable("name = value lines", names, [rows[k] for k in kept], [numbers[k] for k in kept])]


def _without_empty_columns(table: RawTable) -> RawTable:
    """The table without columns that have neither name nor numbers, as a trailing separator makes."""
    kept = [k for k, name in enumerate(table.names) if name or any(not _is_missing(row[k]) for row in table.rows)]
    rows = [[row[k] for k in kept] for row in table.rows]
    return RawTable(table.form, [table.names[k] for k in kept], rows, table.lines, table.caption, table.notes)


def _without_units(table: RawTable) -> RawTable:
    """The table without units in cells, where all cells of a column have the same one; numbers in plain form."""
    cells = [cell for row in table.rows for cell in row]
    comma = uses_decimal_commas(cells)
    if comma is None:
        cell = next(cell for cell in cells if "," in cell)
        raise OrderError(
            f"'{cell}' may be {cell.replace(',', '.')} or {cell.replace(',', '')}: write it without a comma"
        )
    columns = []
    for column in zip(*table.rows, strict=True):
        found = [UNIT.fullmatch(cell) for cell in column if not _is_missing(cell)]
        if found and all(found) and len({match["unit"] for match in found if match}) == 1:
            column = tuple(UNIT.sub(r"\g<number>", cell) for cell in column)
        columns.append([_plain_cell(cell, comma) for cell in column])
    rows = [list(row) for row in zip(*columns, strict=True)]
    form = table.form + (", decimal commas" if comma else "")
    return RawTable(form, table.names, rows, table.lines, table.caption, table.notes)


def _plain_cell(cell: str, comma: bool) -> str:
    value = to_number(cell, comma) if comma else None
    return repr(value) if value is not None and not math.isnan(value) else cell
