"""The data of a full run, and the templates that papers, README, documentation and report make from them.

In a template, ``checks(label, key)`` are the rows of ``claims.csv`` with this label and key, and a filter makes a text
from them: ``{{ checks("Prop. 5.4", "order")|span }}`` is "0.92 to 1.00". Extreme values are rounded outwards, a
smallest value down and a largest value up, so that no sentence claims more than was measured.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pandas as pd
from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape

from study.ledger.codes import MARCHES, Codes
from study.ledger.controls import LARGEST_RATE, FalseAlarms, SeedRecord, in_words, missed, seeds_needed
from study.ledger.datafiles import (
    DataError,
    count_verdicts,
    planned_keys,
    read_claims,
    read_csv,
    read_rates,
)
from study.ledger.text import above, below
from study.ledger.verdict import NO_ROW, NOT_TESTED, UNCLAIMED, agreement
from study.ledger.window import STEEPER
from study.present.notation import counted, encode, read_page, typeset

NAMED_CASES = {"advance-recede", "natural-front", "rough-trace", "moving-rough", "cube-disc"}
"""The cases that the papers name. If a run lacks one of them, the papers are not made from it."""
MISPRINTS = "slips"
"""The label of the checks that list misprints."""
EVIDENCE_TITLES: dict[str, str] = read_page("article")["evidence"]
"""Name ↦ title of each kind of evidence. Every row of the ledger belongs to exactly one of them."""
ENVIRONMENT = Environment(
    loader=PackageLoader("study.present", "page"),
    autoescape=select_autoescape(["html", "svg"], default_for_string=False),
    undefined=StrictUndefined,
    trim_blocks=True,
)


def least(rows: pd.DataFrame, decimals: int = 2, scale: float = 1) -> str:
    """Return the smallest low end of checks, times a scale, rounded down."""
    return below(scale * rows["low"].min(), decimals)


def most(rows: pd.DataFrame, decimals: int = 2, scale: float = 1) -> str:
    """Return the largest high end of checks, times a scale, rounded up."""
    return above(scale * rows["high"].max(), decimals)


def span(rows: pd.DataFrame, decimals: int = 2) -> str:
    """Return the range of checks as text, such as "0.92 to 1.00"."""
    return f"{least(rows, decimals)} to {most(rows, decimals)}"


def spans(rows: pd.DataFrame) -> str:
    """Return the ranges of checks of each case as text."""
    return "; ".join(f"{case}: {span(part)}" for case, part in rows.groupby("case", sort=False))


def spread(values: Sequence[float]) -> str:
    """Return the smallest and the largest value as text, or the only value."""
    return " … ".join(dict.fromkeys(digits(value) for value in (min(values), max(values))))


def digits(value: float, count: int = 3) -> str:
    """Return a number as text with a number of significant digits."""
    return f"{value:.{count}g}"


def deviation(rows: pd.DataFrame) -> float:
    """Return the largest distance of the ends of checks from 1."""
    return (rows[["low", "high"]] - 1).abs().max(axis=None)


def two_digits_up(value: float) -> float:
    """Return a value rounded up to two significant digits. A value with fewer digits, such as 1e-5, is unchanged."""
    return float(above(value, 1 - math.floor(math.log10(value)))) if value else 0.0


def percent(value: float) -> str:
    """Return a share in per cent as LaTeX, rounded up to two significant digits."""
    return rf"{two_digits_up(100 * value):.2g}\,\%"


def power(value: float) -> str:
    """Return a number as LaTeX with a power of ten, rounded up to two significant digits."""
    return encode(f"{two_digits_up(value):.1e}") if value else "0"


def plain(text: str) -> str:
    """Return a text in which characters that have a meaning in Markdown are escaped."""
    return re.sub(r"([\\|*_<#])", r"\\\1", text)


FILTERS = (
    plain,
    encode,
    least,
    most,
    span,
    spans,
    spread,
    digits,
    deviation,
    two_digits_up,
    percent,
    power,
    typeset,
    counted,
)
ENVIRONMENT.filters |= {function.__name__: function for function in FILTERS} | {"down_to": below, "up_to": above}


def evidence(row: pd.Series) -> str:
    """Return the kind of evidence of a row of ``claims.csv``, as a key of ``EVIDENCE_TITLES``."""
    if row["label"] in (NO_ROW, NOT_TESTED, MISPRINTS):
        return "lines"
    if row["verdict"] in UNCLAIMED:
        return agreement(row) if row["expected"].startswith("predicted") else "numbers"
    return row["kind"]


class FullRun:
    """The contents of the data files of a full run; ``cases`` is indexed by the names of the cases.

    ``codes`` has the results of other people's contact codes, and ``marches`` their results if they use the midpoint
    rule in time; both are None if their files are missing. ``faults`` is the matrix of deliberate faults.
    ``alarms`` has the false-alarm rate on random meshes.

    Parameters:
        directory: the result directory.
        provenance, cases: the contents of ``provenance.json`` and of ``cases.csv``.

    Raises:
        DataError: a file is missing or lacks a column.
    """

    def __init__(self, directory: Path, provenance: dict[str, Any], cases: pd.DataFrame) -> None:
        self.rates = read_rates(directory)
        self.claims = read_claims(directory)
        self.cases = cases.set_index("case", drop=False).rename_axis(None)
        self.bounds = read_csv(directory, "bounds.csv")
        self.equivalence = read_csv(directory, "equivalence.csv")
        self.faults = read_csv(directory, "faults.csv")
        self.alarms = FalseAlarms(SeedRecord.read(directory))
        self.provenance = provenance
        self.codes = Codes.read(directory)
        self.marches = Codes.read(directory, MARCHES)

    @classmethod
    def read(cls, directory: Path) -> FullRun | None:
        """Return the data of a result directory; None if it has no full run with deliberate faults and random meshes.

        Raises:
            DataError: a file is missing or lacks a column.
        """
        needed = [directory / "data" / name for name in ("provenance.json", "faults.csv", "seeds.csv")]
        if not all(path.is_file() for path in needed):
            return None
        made = json.loads(needed[0].read_text(encoding="utf-8"))
        cases = read_csv(directory, "cases.csv")
        is_full = made.get("plan") == "full" and set(cases["case"]) >= NAMED_CASES
        return cls(directory, made, cases) if is_full else None

    def labelled(self, label: str) -> pd.DataFrame:
        """Return the rows of the ledger with a label."""
        return self.claims[self.claims["label"] == label]

    def checks(self, label: str, *keys: str, case: str = "") -> pd.DataFrame:
        """Return the rows of the ledger with a label and one of the keys, of all cases or of one case.

        Raises:
            DataError: there is no row for one of the keys.
        """
        chosen = self.labelled(label)
        chosen = chosen[chosen["key"].isin(keys)]
        chosen = chosen[chosen["case"] == case] if case else chosen
        if lacking := sorted(set(keys) - set(chosen["key"])):
            raise DataError(
                f"claims.csv has no row {label}, {', '.join(lacking)}, {case or 'any case'}: make it with "
                "`study run --full`"
            )
        return chosen


def context(data: FullRun) -> dict[str, Any]:
    """Return the names that templates use: the tables of a full run, its checks, and what is counted in them."""
    counts = data.claims.apply(evidence, axis=1).value_counts()
    orders = data.checks("(5.36)", "order")
    return vars(data) | {
        "checks": data.checks,
        "evidence": {name: counts.get(name, 0) for name in EVIDENCE_TITLES},
        "missed_faults": missed(data.faults),
        "without_5_36": orders[orders["case"].map(data.cases["expected_order"]) == 1],
        "discrete_scheme": data.labelled("beyond: fully discrete").apply(agreement, axis=1).tolist(),
        "STEEPER": STEEPER,
        "LARGEST_RATE": LARGEST_RATE,
        "seeds_needed": seeds_needed(),
        "count_verdicts": count_verdicts,
        "planned_keys": planned_keys,
        "in_words": in_words,
    }


def render(name: str, values: dict[str, Any]) -> str:
    """Return the text that a template in ``page`` makes."""
    return ENVIRONMENT.get_template(name).render(values)
