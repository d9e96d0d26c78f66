"""Measure every control and its baseline, and report whether the named checks noticed the defect."""

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
"""Two defects count as the same mistake if their numbers in a setting agree to this relative tolerance. In checks that
hold, some of which measure round-off, absolute differences of this size are ignored as well."""


@dataclass(frozen=True)
class Outcome:
    """The outcome of one control, or of a setting without a defect (a baseline).

    Attributes:
        defect: name of the control, or ``NO_DEFECT``.
        what: a description of the defect, in one line.
        setting: name of the setting.
        row: for a control, the first of its checks that does not fail, or else its first check; for a baseline, the
            first check that does not hold, or else its first check.
        caught: whether every check that the control names fails; None for a baseline.
        other_faults: other faults: a check that no control names, or a defect that equals another one.
    """

    defect: str
    what: str
    setting: str
    row: Verdict
    caught: bool | None
    other_faults: str = ""

    @property
    def passes(self) -> bool:
        """Whether the defect was noticed, or all checks of the baseline hold, and there is no other fault."""
        return not self.other_faults and (self.row.verdict == HOLDS if self.caught is None else self.caught)

    @classmethod
    def of_control(cls, control: Control, verdicts: list[Verdict], other_faults: str = "") -> Outcome:
        """Return the outcome of a control; only the checks that it names can notice the defect.

        Raises:
            KeyError: the setting has no check with the key that the control gives.
        """
        by_key = {verdict.key: verdict for verdict in verdicts}
        named = [by_key[key] for key in control.keys]
        shown = next((verdict for verdict in named if verdict.verdict != FAILS), named[0])
        return cls(control.name, control.what, str(control.setting), shown, shown.verdict == FAILS, other_faults)

    @classmethod
    def of_baseline(cls, setting: Baseline[Any], verdicts: list[Verdict], named: set[str]) -> Outcome:
        """Return the outcome of a baseline: all checks hold, each is named by a control, and no key occurs twice.

        If no control named a check, it could be weakened or removed without any control failing.
        """
        row = next((verdict for verdict in verdicts if verdict.verdict != HOLDS), verdicts[0])
        keys = [verdict.key for verdict in verdicts]
        twice = [f"two checks are called {key}" for key in dict.fromkeys(keys) if keys.count(key) > 1]
        unnamed = [f"no control names the check {key}" for key in dict.fromkeys(keys) if key not in named]
        other_faults = "; ".join(twice + unnamed)
        return cls(NO_DEFECT, f"all {len(verdicts)} rows must hold", str(setting), row, None, other_faults)


def settings(controls: Sequence[Control]) -> list[Baseline[Any]]:
    """Return the settings of the controls without repetition."""
    return list(dict.fromkeys(control.setting for control in controls))


def run_controls(
    controls: Sequence[Control], executor: Executor, store: Store, notify: Callable[[], object]
) -> list[Outcome]:
    """Return the outcomes of the baselines, one per setting, and of the controls, in this order.

    Measurements that are stored for the same code are not repeated. ``notify`` is called after every measurement.
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
    """Return the outcomes, from the checks of every setting and of every control."""
    named = {key for control, _ in defective for key in control.keys}
    other_faults: dict[str, str] = {}
    for (one, first), (other, second) in combinations(defective, 2):
        if one.setting == other.setting and alike(first, second):
            other_faults[other.name] = f"the same mistake as {one.name}"
    return [
        *(Outcome.of_baseline(place, verdicts, named) for place, verdicts in sound.items()),
        *(Outcome.of_control(one, verdicts, other_faults.get(one.name, "")) for one, verdicts in defective),
    ]


def alike(first: list[Verdict], second: list[Verdict]) -> bool:
    """Return whether two defects give the same numbers in every check, up to rounding."""
    if [verdict.verdict for verdict in first] != [verdict.verdict for verdict in second]:
        return False
    one, other = (np.array([verdict.observed for verdict in rows]) for rows in (first, second))
    rounding = np.array([0.0 if verdict.verdict == FAILS else SAME for verdict in first])
    return bool(np.isclose(one, other, rtol=SAME, atol=rounding).all())


def _key(setting: Baseline[Any], name: str) -> str:
    """Return the file name of a finished measurement; a hash distinguishes settings with the same name."""
    words = re.sub(r"[^\w.]+", "-", name or str(setting)).strip("-")
    return f"control__{words}__{sha256(repr((name, setting)).encode()).hexdigest()[:8]}"


def work_by_name(setting: Baseline[Any], name: str) -> list[Verdict]:
    """Return the checks of a setting with the defect of this name in the table; without a defect if the name is empty.

    The name is passed, because functions in the table cannot be sent to another process. One thread is used, because
    the processes already use all cores.
    """
    named = [one for one in table.CONTROLS if one.name == name and one.setting == setting]
    with threadpool_limits(1):
        return work(setting, named[0] if name else None)


def work(setting: Baseline[Any], control: Control | None = None) -> list[Verdict]:
    """Return the checks of a setting, with a defect if one is given."""
    if control is None:
        return setting.verdicts(lambda measured: measured)
    with control.patched():
        return setting.verdicts(control)


def write_controls(directory: Path, findings: Sequence[Outcome]) -> Path:
    """Write ``controls.csv`` with one line for each outcome; return its path."""
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
    """Return text: the settings without a defect, the defects with the check that noticed each, and the counts."""
    baselines = [finding for finding in findings if finding.caught is None]
    controls = [finding for finding in findings if finding.caught is not None]
    return "\n".join(
        [
            _table(["without a defect", "checks", "verdict"], [_baseline_line(finding) for finding in baselines]),
            "",
            _table(["defect", "noticed by", "expected", "observed"], [_control_line(finding) for finding in controls]),
            "",
            f"{len(baselines)} settings without a defect: in {sum(f.passes for f in baselines)} every check holds",
            f"{len(controls)} defects: {sum(f.passes for f in controls)} noticed",
            *(f"NOT IN ORDER: {f.setting}, {f.defect}: {f.other_faults}" for f in findings if f.other_faults),
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
    by = f"{row.label}: {row.quantity}" if finding.caught else f"NOT NOTICED by {row.label}: {row.quantity}"
    return f"{finding.defect}: {finding.what}\n({finding.setting})", by, row.expected, cell(row.observed)
