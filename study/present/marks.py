"""Insert tables into pages of Markdown, between ``<!-- NAME -->`` and ``<!-- end -->``."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

END = "<!-- end -->"


def put(text: str, name: str, table: str) -> str:
    """Return a page with a table, or a few words, inserted between the marks of a name; unchanged without such marks.

    A table begins on a new line; words stay in their sentence.
    """
    head, mark, rest = text.partition(f"<!-- {name} -->")
    _, end, tail = rest.partition(END)
    start = "\n" if "\n" in table else ""
    return f"{head}{mark}{start}{table}{end}{tail}" if mark and end else text


def markdown(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    lines = [header, ["---"] * len(header), *rows]
    return "".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |\n" for line in lines)
