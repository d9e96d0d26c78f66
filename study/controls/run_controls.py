"""Measures every deliberate defect, and reports whether the checks that should notice the defect failed."""

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
from study.controls.control import Control, patched
from study.ledger.files import write_text
from study.ledger.text import cell, is_narrow
from study.ledger.verdict import FAILS, HOLDS, Verdict
from study.run.fingerprint import of_everything
from study.run.store import Store

NO_DEFECT = "none"
SAME = 1e-3
"""Relative tolerance with which two defects in a setting are compared. If all numbers agree, the defects are the same
mistake, and one of them proves nothing. In checks that hold, absolute differences of this size are ignored as well,
because the number may be pure round-off."""


@dataclass(frozen=True)
class Outcome:
    """The result of measuring with one deliberate defect, or of measuring in the same setting without a defect.

    Attributes:
        defect: name of the defect, or ``NO_DEFECT``.
        what: a description of the defect, in one line.
        setting: name of the case, meshes and statement.
        row: the check that is shown. With a defect, it is the first check that should fail and does not, or the first
            one if all fail. Without a defect, it is the first check that does not hold, or the first one if all hold.
        caught: whether all checks that should fail do fail; None without a defect.
        other_faults: other reasons, in words, why this result is not accepted: two checks have the same key, no defect
            is there to make some check fail, or two defects give the same numbers. Empty if there is none.
    """

    defect: str
    what: str
    setting: str
    row: Verdict
    caught: bool | None
    other_faults: str = ""

    @property
    def passes(self) -> bool:
        """Whether the checks gave the required verdicts and there are no other faults.

        With a defect, the checks that should fail must fail. Without a defect, all checks must hold.
        """
        return not self.other_faults and (self.row.verdict == HOLDS if self.caught is None else self.caught)

    @classmethod
    def of_control(cls, control: Control, verdicts: list[Verdict], other_faults: str = "") -> Outcome:
        """Return the result for a defect: whether all checks that must fail because of the defect did fail.

        Parameters:
            control: the defect, with the keys of the checks that must fail.
            verdicts: all checks that were measured with the defect; checks with other keys are ignored.
            other_faults: other reasons, in words, why the result is not accepted; empty if there is none.

        Raises:
            KeyError: the setting has no check with a key that ``control`` names.
        """
        by_key = {verdict.key: verdict for verdict in verdicts}
        named = [by_key[key] for key in control.keys]
        shown = next((verdict for verdict in named if verdict.verdict != FAILS), named[0])
        return cls(control.name, control.what, str(control.setting), shown, shown.verdict == FAILS, other_faults)

    @classmethod
    def of_baseline(cls, setting: Baseline[Any], verdicts: list[Verdict], named: set[str]) -> Outcome:
        """Return the outcome of a measurement without a defect, for which all checks must hold.

        It is a fault if two checks have the same key. It is also a fault if no defect is there to make some check fail,
        because this check could be weakened or removed unnoticed.

        Parameters:
            setting: the case, meshes and statement.
            verdicts: all checks that were measured in this setting.
            named: the keys of all checks that some defect must make fail.
        """
        row = next((verdict for verdict in verdicts if verdict.verdict != HOLDS), verdicts[0])
        keys = [verdict.key for verdict in verdicts]
        twice = [f"two checks are called {key}" for key in dict.fromkeys(keys) if keys.count(key) > 1]
        unnamed = [f"no control names the check {key}" for key in dict.fromkeys(keys) if key not in named]
        other_faults = "; ".join(twice + unnamed)
        return cls(NO_DEFECT, f"all {len(verdicts)} checks must hold", str(setting), row, None, other_faults)


def settings(controls: Sequence[Control]) -> list[Baseline[Any]]:
    """Return the different settings (case, meshes and statement) of some defects."""
    return list(dict.fromkeys(control.setting for control in controls))


def run_controls(
    controls: Sequence[Control], executor: Executor, store: Store, notify: Callable[[], object]
) -> list[Outcome]:
    """Measure with each defect, and without it in the same setting; return the results without defects first.

    Parameters:
        controls: the defects.
        executor: runs the measurements.
        store: keeps finished measurements, so that they are not repeated as long as the code is the same.
        notify: called after every measurement.
    """
    places = settings(controls)
    measured = [(place, "") for place in places] + [(control.setting, control.name) for control in controls]
    keys = [_key(*one) for one in measured]
    found: dict[str, list[Verdict]] = {}
    running: dict[Future[list[Verdict]], str] = {}
    cache_key = of_everything()
    for key, (setting, name) in zip(keys, measured, strict=True):
        stored = store.load(key, cache_key)
        if stored is None:
            running[executor.submit(work_by_name, setting, name)] = key
        else:
            found[key] = [Verdict(**row) for row in stored["rows"]]
            notify()
    try:
        for future in as_completed(running):
            key = running[future]
            found[key] = future.result()
            store.save(key, cache_key, {"rows": [asdict(verdict) for verdict in found[key]]})
            notify()
    finally:
        for future in running:
            future.cancel()
    rows = [found[key] for key in keys]
    return outcomes(dict(zip(places, rows, strict=False)), list(zip(controls, rows[len(places) :], strict=True)))


def outcomes(
    sound: Mapping[Baseline[Any], list[Verdict]], defective: Sequence[tuple[Control, list[Verdict]]]
) -> list[Outcome]:
    """Return the results of all measurements, given their checks; results without a defect come first.

    Parameters:
        sound: setting (case, meshes and statement) ↦ the checks that were measured in it without a defect.
        defective: pairs of a defect and the checks that were measured with it.
    """
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
    """Return whether two defects in the same setting give the same numbers in every check, up to rounding."""
    if [verdict.verdict for verdict in first] != [verdict.verdict for verdict in second]:
        return False
    one, other = (np.array([verdict.observed for verdict in rows]) for rows in (first, second))
    rounding = np.array([0.0 if verdict.verdict == FAILS else SAME for verdict in first])
    return bool(np.isclose(one, other, rtol=SAME, atol=rounding).all())


def _key(setting: Baseline[Any], name: str) -> str:
    """Return the file name of a finished measurement.

    It ends with a hash, because two settings may have the same name.
    """
    words = re.sub(r"[^\w.]+", "-", name or str(setting)).strip("-")
    # The address of an object in memory differs between processes.
    whole = re.sub(r" at 0x\w+", "", repr((name, setting)))
    return f"control__{words}__{sha256(whole.encode()).hexdigest()[:8]}"


def work_by_name(setting: Baseline[Any], name: str) -> list[Verdict]:
    """Measure in a setting with the named defect, or without a defect for an empty name; return the checks.

    The defect is given by its name, because a ``Control`` contains functions, which cannot be sent to another process.
    One thread is used, because the processes already use all cores.
    """
    named = [one for one in table.CONTROLS if one.name == name and one.setting == setting]
    with threadpool_limits(1):
        return work(setting, named[0] if name else None)


def work(setting: Baseline[Any], control: Control | None = None) -> list[Verdict]:
    """Measure in a setting, with the defect of ``control`` if one is given, and return the checks."""
    if control is None:
        return setting.verdicts(lambda measured: measured)
    with patched(control.changes):
        return setting.verdicts(control)


def write_controls(directory: Path, findings: Sequence[Outcome]) -> Path:
    """Write ``controls.csv`` with one row for each outcome, and return its path."""
    shown = ("label", "quantity", "expected", "observed", "verdict")
    table = pd.DataFrame(
        {"defect": finding.defect, "what": finding.what, "setting": finding.setting}
        | {name: getattr(finding.row, name) for name in shown}
        | {"caught": {None: "", True: "yes", False: "no"}[finding.caught]}
        for finding in findings
    )
    text = table.to_csv(index=False, float_format="%.9g", lineterminator="\n")
    return write_text(directory / "data" / "controls.csv", text)


def controls_text(findings: Sequence[Outcome]) -> str:
    """Return the text that ``study controls`` prints.

    It has a table of the settings without a defect, a table of the defects, and the numbers of both.
    """
    baselines = [finding for finding in findings if finding.caught is None]
    controls = [finding for finding in findings if finding.caught is not None]
    lines_of_baselines = [
        (f.setting, f.what if f.row.verdict == HOLDS else f"{_name(f.row)}: {cell(f.row.observed)}", f.row.verdict)
        for f in baselines
    ]
    lines_of_controls = [
        (
            f"{f.defect}: {f.what}\n({f.setting})",
            f"{'' if f.caught else 'NOT NOTICED by '}{_name(f.row)}",
            f.row.expected,
            cell(f.row.observed),
        )
        for f in controls
    ]
    return "\n".join(
        [
            _table(["without a defect", "checks", "verdict"], lines_of_baselines),
            "",
            _table(["defect", "noticed by", "expected", "observed"], lines_of_controls),
            "",
            f"{len(baselines)} settings without a defect: in {sum(f.passes for f in baselines)} every check holds",
            f"{len(controls)} defects: {sum(f.passes for f in controls)} noticed",
            *(f"ERROR in the controls: {f.setting}, {f.defect}: {f.other_faults}" for f in findings if f.other_faults),
        ]
    )


def _table(head: list[str], rows: Sequence[tuple[str, ...]]) -> str:
    widths = [30, 23, 12, 9] if is_narrow() else [48, 31, 17, 9]
    return tabulate(rows, head, "simple", disable_numparse=True, maxcolwidths=widths[: len(head)])


def _name(row: Verdict) -> str:
    return f"{row.label}: {row.quantity}"
