"""Measure every control and its baseline, and say whether the ledger noticed."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, Future, as_completed
from dataclasses import asdict, dataclass
from hashlib import sha256
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from tabulate import tabulate
from threadpoolctl import threadpool_limits

from study.controls import table
from study.controls.baselines import Baseline
from study.controls.control import Control
from study.ledger.files import write_text
from study.ledger.text import cell, is_narrow
from study.ledger.verdict import FAILS, HOLDS, Verdict
from study.run.fingerprint import of_everything
from study.run.store import Store

NO_DEFECT = "none"
SAME = 1e-3
"""Two defects are one mistake if their numbers in a setting agree to this relative tolerance. In rows that hold,
of which some are about rounding, absolute differences of this size do not count either."""


@dataclass(frozen=True)
class Outcome:
    """What the ledger says to one control, or to a setting without a defect.

    Attributes:
        defect: name of the control, or ``NO_DEFECT``.
        what: is wrong, in a line.
        setting: where.
        row: the row that the control names; of several rows, the first that does not fail, or the first. Of a
            baseline, the first row, or the first that does not hold.
        caught: whether every row that the control names fails; None for a baseline.
        besides: what else is wrong: a row that no defect is there for, a defect that is another one once more.
    """

    defect: str
    what: str
    setting: str
    row: Verdict
    caught: bool | None
    besides: str = ""

    @property
    def passes(self) -> bool:
        """A defect is caught, or without one every row holds, and nothing else is wrong."""
        return not self.besides and (self.row.verdict == HOLDS if self.caught is None else self.caught)

    @classmethod
    def of_control(cls, control: Control, verdicts: list[Verdict], besides: str = "") -> Outcome:
        """Whether a defect is caught by the rows that are there for it: another one may fail for another reason.

        Raises:
            KeyError: the setting has no row with the key that the control gives.
        """
        by_key = {verdict.key: verdict for verdict in verdicts}
        named = [by_key[key] for key in control.keys]
        shown = next((verdict for verdict in named if verdict.verdict != FAILS), named[0])
        return cls(control.name, control.what, str(control.setting), shown, shown.verdict == FAILS, besides)

    @classmethod
    def of_baseline(cls, setting: Baseline[Any], verdicts: list[Verdict], named: set[str]) -> Outcome:
        """Whether every row holds without a defect, and is one that a control names, and no other row's namesake.

        A row that no defect is there for could be weakened or left out, and all controls would still do their duty.
        """
        row = next((verdict for verdict in verdicts if verdict.verdict != HOLDS), verdicts[0])
        keys = [verdict.key for verdict in verdicts]
        twice = [f"two rows are called {key}" for key in dict.fromkeys(keys) if keys.count(key) > 1]
        unnamed = [f"no defect is there for the row {key}" for key in dict.fromkeys(keys) if key not in named]
        besides = "; ".join(twice + unnamed)
        return cls(NO_DEFECT, f"all {len(verdicts)} rows must hold", str(setting), row, None, besides)


def settings(controls: Sequence[Control]) -> list[Baseline[Any]]:
    """Where the controls are measured: the baselines, each once."""
    return list(dict.fromkeys(control.setting for control in controls))


def run_controls(
    controls: Sequence[Control], executor: Executor, store: Store, notify: Callable[[], object]
) -> list[Outcome]:
    """Findings of the baselines, one per setting, and of the controls, in this order.

    What the store holds of the same code is not measured again. ``notify`` is called after every measurement, of a
    baseline or of a control.
    """
    places = settings(controls)
    measured = [(place, "") for place in places] + [(control.setting, control.name) for control in controls]
    keys = [_key(*one) for one in measured]
    found: dict[str, list[Verdict]] = {}
    running: dict[Future[list[Verdict]], str] = {}
    made_by = of_everything()
    for key, (setting, name) in zip(keys, measured, strict=True):
        kept = store.load(key, made_by)
        if kept is None:
            running[executor.submit(work_by_name, setting, name)] = key
        else:
            found[key] = [Verdict(**row) for row in kept["rows"]]
            notify()
    try:
        for future in as_completed(running):
            key = running[future]
            found[key] = future.result()
            store.save(key, made_by, {"rows": [asdict(verdict) for verdict in found[key]]})
            notify()
    finally:
        for future in running:
            future.cancel()
    rows = [found[key] for key in keys]
    return outcomes(dict(zip(places, rows, strict=False)), list(zip(controls, rows[len(places) :], strict=True)))


def outcomes(
    sound: Mapping[Baseline[Any], list[Verdict]], defective: Sequence[tuple[Control, list[Verdict]]]
) -> list[Outcome]:
    """What is found, from the rows of every setting and those of every control."""
    named = {key for control, _ in defective for key in control.keys}
    besides: dict[str, str] = {}
    for (one, first), (other, second) in combinations(defective, 2):
        if one.setting == other.setting and alike(first, second):
            besides[other.name] = f"the same mistake as {one.name}"
    return [
        *(Outcome.of_baseline(place, verdicts, named) for place, verdicts in sound.items()),
        *(Outcome.of_control(one, verdicts, besides.get(one.name, "")) for one, verdicts in defective),
    ]


def alike(first: list[Verdict], second: list[Verdict]) -> bool:
    """Whether two defects show the same in every row, but for rounding."""
    if [verdict.verdict for verdict in first] != [verdict.verdict for verdict in second]:
        return False
    one, other = (np.array([verdict.observed for verdict in rows]) for rows in (first, second))
    rounding = np.array([0.0 if verdict.verdict == FAILS else SAME for verdict in first])
    return bool(np.isclose(one, other, rtol=SAME, atol=rounding).all())


def _key(setting: Baseline[Any], name: str) -> str:
    """The name of a file among finished work; settings that are called alike are told apart by value."""
    words = re.sub(r"[^\w.]+", "-", name or str(setting)).strip("-")
    return f"control__{words}__{sha256(repr((name, setting)).encode()).hexdigest()[:8]}"


def work_by_name(setting: Baseline[Any], name: str) -> list[Verdict]:
    """The rows of a setting with the defect of this name in the table, "" for none: functions in the table stay there.

    One thread, as the processes share the cores already.
    """
    named = [one for one in table.CONTROLS if one.name == name and one.setting == setting]
    with threadpool_limits(1):
        return work(setting, named[0] if name else None)


def work(setting: Baseline[Any], control: Control | None = None) -> list[Verdict]:
    """The rows of a setting with a defect, or without one."""
    if control is None:
        return setting.verdicts(lambda measured: measured)
    with control.patched():
        return setting.verdicts(control)


def write_controls(directory: Path, findings: Sequence[Outcome]) -> Path:
    """``controls.csv``: one line per finding."""
    table = pd.DataFrame(
        {
            "defect": finding.defect,
            "what": finding.what,
            "setting": finding.setting,
            "label": finding.row.label,
            "quantity": finding.row.quantity,
            "expected": finding.row.expected,
            "observed": finding.row.observed,
            "verdict": finding.row.verdict,
            "caught": {None: "", True: "yes", False: "no"}[finding.caught],
        }
        for finding in findings
    )
    text = table.to_csv(index=False, float_format="%.9g", lineterminator="\n")
    return write_text(directory / "data" / "controls.csv", text)


def controls_text(findings: Sequence[Outcome]) -> str:
    """The settings without a defect, the defects with the row that caught each, and how many did their duty."""
    baselines = [finding for finding in findings if finding.caught is None]
    controls = [finding for finding in findings if finding.caught is not None]
    return "\n".join(
        [
            _table(["without a defect", "rows", "verdict"], [_baseline_line(finding) for finding in baselines]),
            "",
            _table(["defect", "caught by", "expected", "observed"], [_control_line(finding) for finding in controls]),
            "",
            f"{len(baselines)} settings without a defect: in {sum(f.passes for f in baselines)} every row holds",
            f"{len(controls)} defects: {sum(f.passes for f in controls)} caught",
            *(f"NOT IN ORDER: {f.setting}, {f.defect}: {f.besides}" for f in findings if f.besides),
        ]
    )


def _table(head: list[str], rows: list[tuple[str, ...]]) -> str:
    widths = [30, 23, 12, 9] if is_narrow() else [48, 31, 17, 9]
    return tabulate(rows, head, "simple", disable_numparse=True, maxcolwidths=widths[: len(head)])


def _baseline_line(finding: Outcome) -> tuple[str, ...]:
    row = finding.row
    if row.verdict == HOLDS:
        return finding.setting, finding.what, HOLDS
    return finding.setting, f"{row.label}: {row.quantity}: {cell(row.observed)}", row.verdict


def _control_line(finding: Outcome) -> tuple[str, ...]:
    row = finding.row
    by = f"{row.label}: {row.quantity}" if finding.caught else f"NOT CAUGHT by {row.label}: {row.quantity}"
    return f"{finding.defect}: {finding.what}\n({finding.setting})", by, row.expected, cell(row.observed)
