"""Tables of trials in ``results/trials``: rows that are kept are not made again, and a page shows their sum."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from time import process_time
from typing import Any

import pandas as pd

from study.ledger.files import write_text
from study.present.pages import put

ROOT = Path(__file__).parents[2]
OUT = ROOT / "results" / "trials"
PAGE = ROOT / "docs" / "explanation" / "bounds.md"


def made(file: Path, keys: Iterable[Any], row: Callable[[Any], dict[str, Any]]) -> pd.DataFrame:
    """The table with a row for every key, those on disk as they are; written after every new row."""
    kept = pd.read_csv(file).to_dict("records") if file.is_file() else []
    known = {one["trial"] for one in kept}
    for key in keys:
        if key not in known:
            began = process_time()
            kept.append({"trial": key, **row(key)})
            write_text(file, pd.DataFrame(kept).sort_values("trial").to_csv(index=False, lineterminator="\n"))
            print(f"{process_time() - began:6.1f} s  {kept[-1]}", flush=True)
    return pd.read_csv(file)


def refresh(page: Path, tables: dict[str, str]) -> None:
    """Put tables into a page."""
    text = page.read_text(encoding="utf-8")
    for name, table in tables.items():
        text = put(text, name, table)
    write_text(page, text)
