"""The texts for readers that would be written now, for those files that are there."""

from __future__ import annotations

from pathlib import Path

from study.present.drawing import caption_text
from study.present.figures import drawings
from study.present.full_run import FullRun
from study.present.pages import badges, refreshed
from study.present.tables import texts

TABLES, FIGURES, PAGES = "study tables --out {}", "study figures --out {}", "make pages"
"""The commands that write tables and inputs of the papers, figures with captions, and the README with its badges."""


def expected_texts(directory: Path) -> dict[Path, tuple[str, str]]:
    """Returns path ↦ (text, command that writes it) for the files of a run that follow from its data alone.

    These are tables, inputs of the papers and captions of figures; for a full run also the badges and the README of
    the repository that the run belongs to. Files that are not there are left out.

    Raises:
        DataError: a data file is missing or damaged.
    """
    found = {path: (text, TABLES) for path, text in texts(directory).items()}
    for drawing in drawings(directory):
        found[directory / "figures" / f"{drawing.name}.txt"] = caption_text(drawing), FIGURES
    data, root = FullRun.read(directory), directory.resolve().parent
    if data and (root / "pyproject.toml").is_file():
        for name, badge in badges(data, root / "pyproject.toml").items():
            found[directory / "badges" / name] = badge.svg(), PAGES
        if (root / "README.md").is_file():
            found[root / "README.md"] = refreshed(root / "README.md", data), PAGES
    return {path: (text, made_by.format(directory)) for path, (text, made_by) in found.items() if path.is_file()}
