"""Small pictures above the README that say what is so: from the data of the full study and from ``pyproject.toml``.

They are files of the repository, not pictures of a server, and a test compares them with what is so.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from xml.sax.saxutils import escape

from study.ledger.datafiles import caught, count_verdicts
from study.ledger.files import write_text
from study.ledger.verdict import FAILS, HOLDS, UNDECIDED
from study.present.article.source import FullRun
from study.present.charts.palette import BLUE, DARK, GREEN, ORANGE, VERMILLION

HEIGHT, SIZE, LETTER, MARGIN = 20, 11, 6.4, 6
"""Of a badge and of its letters, how wide one is on average, and the room beside them, in pixels."""


@dataclass(frozen=True)
class Badge:
    """A name, what is said of it, and the colour behind that."""

    name: str
    says: str
    colour: str

    def svg(self) -> str:
        """The badge as a picture; letters are fitted into the width that they have on average."""
        left, right = (round(LETTER * len(text)) + 2 * MARGIN for text in (self.name, self.says))
        title = escape(f"{self.name}: {self.says}")
        texts = ((self.name, 0, left), (self.says, left, right))
        return "\n".join(
            [
                f'<svg xmlns="http://www.w3.org/2000/svg" width="{left + right}" height="{HEIGHT}" role="img">',
                f"<title>{title}</title>",
                f'<rect width="{left + right}" height="{HEIGHT}" rx="3" fill="{DARK}"/>',
                f'<path d="M{left} 0h{right - 3}a3 3 0 0 1 3 3v{HEIGHT - 6}a3 3 0 0 1 -3 3h-{right - 3}z" '
                f'fill="{self.colour}"/>',
                f'<g fill="#fff" text-anchor="middle" font-family="DejaVu Sans,Verdana,sans-serif" font-size="{SIZE}">',
                *(
                    f'<text x="{start + width / 2:g}" y="14" textLength="{width - 2 * MARGIN}">{escape(text)}</text>'
                    for text, start, width in texts
                ),
                "</g>",
                "</svg>",
                "",
            ]
        )


def badges(data: FullRun, project: Path) -> dict[str, Badge]:
    """File name ↦ badge: what the ledger says, how many defects were caught, and what ``pyproject.toml`` states."""
    stated = tomllib.loads(project.read_text(encoding="utf-8"))["project"]
    count, (found, injected) = count_verdicts(data.claims), caught(data.controls)
    ledger = VERMILLION if count[FAILS] else ORANGE if count[UNDECIDED] else GREEN
    rows = f"{count[HOLDS]} rows hold, {count[UNDECIDED]} undecided, {count[FAILS]} fail"
    defects = GREEN if found == injected else VERMILLION
    return {
        "ledger.svg": Badge("ledger", rows, ledger),
        "defects.svg": Badge("injected defects", f"{found} of {injected} caught", defects),
        "python.svg": Badge("Python", str(stated["requires-python"]).replace(">=", "≥ "), BLUE),
        "licence.svg": Badge("licence", str(stated["license"]), BLUE),
    }


def write_badges(directory: Path, data: FullRun, project: Path) -> list[Path]:
    """All of them into a directory."""
    return [write_text(directory / name, badge.svg()) for name, badge in badges(data, project).items()]
