"""The two tables of the README that come from the data: headline rows of the ledger, and where each statement lives."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable
from pathlib import Path

from study.ledger.datafiles import DataError, read_claims
from study.ledger.files import write_text
from study.ledger.verdict import VERDICTS
from study.present.headline import Headlines


def refresh(readme: Path, directory: Path) -> bool:
    """Put both tables of ``directory`` into a text between ``<!-- NAME -->`` and ``<!-- end -->``; whether it changed.

    Raises:
        DataError: the data or the marks are missing.
    """
    text = before = readme.read_text(encoding="utf-8")
    for name, table in (("headline", headline(directory)), ("statements", statements(directory))):
        start, end = f"<!-- {name} -->\n", "<!-- end -->"
        head, found, rest = text.partition(start)
        _, closed, tail = rest.partition(end)
        if not (found and closed):
            raise DataError(f"{readme} lacks {start.strip()} … {end}, between which its {name} table belongs")
        text = f"{head}{start}{table}{end}{tail}"
    write_text(readme, text)
    return text != before


def headline(directory: Path) -> str:
    """What is claimed, what was predicted and seen, and the verdict, in Markdown.

    Numbers that were seen are rounded outwards, so that no row says more than the data.

    Raises:
        DataError: a file is missing, or ``claims.csv`` lacks the rows of a line.
    """
    return _markdown(["claim", "predicted", "observed", "verdict"], Headlines.read(directory).lines())


def statements(directory: Path) -> str:
    """Every statement with its verdicts, the file of the code that judges it and its data, in Markdown."""
    claims = read_claims(directory)
    made = json.loads((directory / "data" / "provenance.json").read_text(encoding="utf-8"))
    lines = []
    for label, rows in claims.groupby("label", sort=False):
        counts = [f"{n} {name}" for name in VERDICTS if (n := int((rows["verdict"] == name).sum()))]
        where = made["statements"].get(str(label), {"code": [], "data": "provenance.json"})
        code = ", ".join(f"[`{path}`]({path})" for path in where["code"])
        lines.append([str(label), str(rows["statement"].iloc[0]), ", ".join(counts), code, f"`{where['data']}`"])
    return _markdown(["statement", "says", "verdicts", "code", "data"], lines)


def _markdown(header: list[str], rows: Iterable[list[str]]) -> str:
    lines = [header, ["---"] * len(header), *rows]
    return "".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |\n" for line in lines)


def main() -> None:
    """``python -m study.present.readme README.md results``."""
    readme, directory = map(Path, sys.argv[1:])
    print(f"{readme}: {'changed' if refresh(readme, directory) else 'up to date'}")


if __name__ == "__main__":
    main()
