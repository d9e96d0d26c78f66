"""No false alarms: the verdicts hold on other random meshes, and the record of seeds adds and never replaces."""

from __future__ import annotations

import gzip
import re
import shutil
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import cache
from itertools import count
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from study.cli import seeds
from study.cli.main import main
from study.controls import alarms
from study.controls.alarms import CountedCheck, compare_record, newer, tally, text
from study.controls.record import Line, Record, packed, place, unpacked
from study.controls.rules import row_of, rules
from study.controls.seeded import LIGHT, NOT_CLAIMED, WHOLE, claimed, costly, seeded
from study.fem.mesh import Shaken
from study.fem.naming import family_named, resolve
from study.ledger.criterion import Criterion, exactly
from study.ledger.datafiles import AlarmSummary, DataError, read_csv
from study.ledger.files import UsageError
from study.ledger.verdict import FAILS, HOLDS, UNDECIDED, Verdict, row
from study.ledger.window import Window, around, at_least, at_most
from study.run.executor import Pool, Processes
from study.run.plan import Job, Plan, full
from study.run.store import Store
from study.statements.contact_work import WorkOfContact
from study.statements.enclosure import Bounds
from study.statements.fully_discrete import FullyDiscrete
from study.statements.landings import Landings
from study.statements.other_codes import OtherCodes
from study.statements.pictures import Pictures
from study.statements.prop_5_4 import FirstOrder
from study.statements.rollers import Rollers
from study.statements.shared.base import Statement
from study.statements.shared.scope import SLOW
from study.statements.thm_4_2_own_space import OwnSpace
from study.statements.uniqueness import OneTrajectory

RESULTS = Path(__file__).parents[2] / "results"
WINDOW = around(1, 0.1)
ROW = ("Prop. 5.4", "order", "advance-recede")


@pytest.fixture(scope="module")
def committed() -> Record:
    return Record.read(RESULTS)


@pytest.fixture(scope="module")
def counted(committed: Record) -> pd.DataFrame:
    return tally(committed)


def judged(value: float, key: str = "order", window: Window = WINDOW, state: str = "") -> Verdict:
    verdict = state or (HOLDS if window.contains(value) else FAILS)
    return row(FirstOrder(), key, f"the {key}", window, (value, (value, value), verdict), "advance-recede", "shaken-7")


def after(values: list[float], rule: str = "a", record: Record | None = None, part: str = WHOLE) -> Record:
    """A record with so many more seeds."""
    record = record or Record()
    for value in values:
        seed = 100 + len(record.draws)
        record = record.drawn(seed, part).judged(seed, [judged(value)], {ROW: rule}, claimed)
    return record


@pytest.mark.parametrize(
    ("value", "window", "expected"),
    [
        (1.05, around(1, 0.1), 0.5),
        (0.9, around(1, 0.1), -1.0),
        (0.3, at_most(0.6), 0.5),
        (-0.05, at_most(0.1, low=-np.inf), -0.5),
        (8.0, at_least(4), 0.5),
        (3.0, at_least(0.0), 0.0),
    ],
)
def test_a_place_is_the_share_of_the_window_that_a_row_uses(value: float, window: Window, expected: float) -> None:
    assert place(judged(value, window=window)) == pytest.approx(expected, abs=1e-9)


def test_an_alarm_is_a_place_beyond_whatever_raised_it() -> None:
    assert place(judged(1.2)) == pytest.approx(2.0)
    assert place(judged(0.85)) == pytest.approx(-1.5)
    for value, state in ((float("nan"), FAILS), (1.0, UNDECIDED), (1.1 + 1e-9, FAILS)):
        assert abs(unpacked(packed(place(judged(value, state=state))))[0]) > 1


def test_what_is_written_is_read_again(tmp_path: Path) -> None:
    record = after([1.0, 1.05, 0.95, 1.2])
    record.write(tmp_path)
    again = Record.read(tmp_path)
    assert again == record
    (line,) = again.lines.values()
    assert unpacked(line.places) == pytest.approx([0, 0.5, -0.5, 2.0], abs=2e-3)
    assert [draw.alarms for draw in again.draws] == [0, 0, 0, 1]


def test_nothing_in_it_is_replaced() -> None:
    record = after([1.0, 1.05])
    with pytest.raises(DataError, match="seed 100 is already in the record"):
        record.drawn(100, LIGHT)
    with pytest.raises(DataError, match="seed 100 was already judged"):
        record.judged(100, [judged(1.0)], {ROW: "a"}, claimed)
    longer = after([0.9], record=record)
    (before,), (behind,) = record.lines.values(), longer.lines.values()
    assert behind.places.startswith(before.places)
    assert longer.draws[:2] == record.draws


def test_seeds_judged_by_another_rule_count_for_nothing() -> None:
    """Else a window could be widened until the seeds that were drawn before are quiet."""
    old = after([1.2] * 5 + [1.0] * 5)
    record = after([1.0] * 3, rule="b", record=old)
    table = tally(record)
    line = table[table["key"] == "order"].iloc[0]
    assert (line["rule"], line["seeds"], line["alarms"], line["since"]) == ("b", 3, 0, 11)
    assert AlarmSummary(table).seeds == 3
    assert len(record.lines) == 2


def with_size(record: Record, value: float) -> Record:
    """The record with one more whole seed, on which the check "size" is judged for the first time."""
    rules = {ROW: "a", (ROW[0], "size", ROW[2]): "c"}
    return record.drawn(9, WHOLE).judged(9, [judged(1.0), judged(value, key="size")], rules, claimed)


def test_a_row_with_a_newer_rule_than_the_others_is_named() -> None:
    assert list(newer(tally(with_size(after([1.0, 1.01]), 1.0)))["key"]) == ["size"]


def test_rows_that_cost_little_are_counted_on_every_seed() -> None:
    found = AlarmSummary(tally(with_size(after([1.0, 1.2, 1.0], part=LIGHT), 1.3)))
    assert (found.rows, found.seeds, found.red, found.light_seeds, found.light_red) == (2, 1, 1, 4, 1)
    assert found.verdict == "fails"


def test_a_seed_that_is_begun_is_in_the_record_and_counts_for_nothing(tmp_path: Path) -> None:
    record = after([1.0]).drawn(7, LIGHT)
    record.write(tmp_path)
    assert Record.read(tmp_path).pending() == record.draws[-1]
    assert AlarmSummary(tally(record)).seeds == 1


def test_a_row_whose_tail_leaves_the_window_is_named() -> None:
    """No alarm has been seen, and one is to be expected on one seed in a hundred."""
    rng = np.random.default_rng(3)
    record = after(list(np.minimum(1.0 + rng.normal(0.06, 0.017, 60), 1.099)))
    table = tally(record)
    assert table["alarms"].sum() == 0
    assert re.search(r"^Prop. 5.4, order +advance-recede +0 of 60", text(table), re.MULTILINE)
    assert AlarmSummary(table).by_tail > 1e-3


def with_line(change: Callable[[str], str]) -> Callable[[bytes], bytes]:
    """A change of the second line of a packed file."""

    def changed(packed: bytes) -> bytes:
        head, line = gzip.decompress(packed).decode().splitlines(keepends=True)
        return gzip.compress((head + change(line)).encode())

    return changed


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (with_line(lambda line: line.replace(line[-3:-1], "!!")), "is damaged"),
        (with_line(lambda line: line[:-1] + "aaaa\n"), "is damaged"),
        (with_line(lambda line: line[:-2] + "\n"), "is damaged"),
        (lambda packed: packed[:-9], r"places.csv.gz is not a table"),
        (lambda packed: b"label,key", r"places.csv.gz is not a table"),
    ],
)
def test_a_damaged_record_is_refused(tmp_path: Path, damage: Callable[[bytes], bytes], message: str) -> None:
    after([1.0, 1.05]).write(tmp_path)
    path = tmp_path / "data" / "seeds" / "places.csv.gz"
    path.write_bytes(damage(path.read_bytes()))
    with pytest.raises(DataError, match=message):
        Record.read(tmp_path)


def test_the_committed_record_takes_less_than_1_kB_for_each_seed(committed: Record) -> None:
    sizes = (path.stat().st_size for path in (RESULTS / "data" / "seeds").iterdir())
    assert sum(sizes) < 1000 * len(committed.draws)


TABLE, DRAWN, PLACES = "seeds.csv", "seeds/drawn.csv", "seeds/places.csv.gz"
Change = Callable[[list[str]], list[str]]


@pytest.fixture
def copied(tmp_path: Path, committed: Record, counted: pd.DataFrame, monkeypatch) -> Path:
    """A copy of the committed record and its table, which is not counted again while the record is unchanged."""
    monkeypatch.setattr(alarms, "tally", lambda record: counted if record == committed else tally(record))
    (tmp_path / "data").mkdir()
    shutil.copy(RESULTS / "data" / TABLE, tmp_path / "data")
    shutil.copytree(RESULTS / "data" / "seeds", tmp_path / "data" / "seeds")
    return tmp_path


def without(line: int) -> Change:
    return lambda lines: [text for number, text in enumerate(lines) if number != line % len(lines)]


def changed(line: int, change: Callable[[str], str]) -> Change:
    return lambda lines: [*lines[:line], change(lines[line]), *lines[line + 1 :]]


def one_alarm_more(text: str) -> str:
    *start, alarms = text.rstrip("\n").split(",")
    return ",".join([*start, f"{int(alarms) + 1}\n"])


TAMPERED: dict[str, tuple[str, Change]] = {
    "the last line of the table deleted": (TABLE, without(-1)),
    "a line of the seeds deleted": (DRAWN, without(80)),
    "the last line of the places deleted": (PLACES, without(-1)),
    "a number of the table": (TABLE, changed(1, lambda text: text.replace(",100,0,", ",101,0,"))),
    "a seed twice": (DRAWN, lambda lines: [*lines[:-1], lines[5], lines[-1]]),
    "an alarm more": (DRAWN, changed(71, one_alarm_more)),
    "another part": (DRAWN, changed(5, lambda text: text.replace("whole", "light"))),
}


def test_the_committed_record_agrees_with_its_table(copied: Path) -> None:
    assert {path.name for path in compare_record(copied)} == {"seeds.csv", "places.csv.gz"}


@pytest.mark.parametrize("name", TAMPERED)
def test_a_change_is_refused(name: str, copied: Path) -> None:
    file, change = TAMPERED[name]
    path = copied / "data" / file
    content = path.read_bytes()
    packed = path.suffix == ".gz"
    lines = (gzip.decompress(content) if packed else content).decode().splitlines(keepends=True)
    assert change(lines) != lines
    text = "".join(change(lines)).encode()
    path.write_bytes(gzip.compress(text) if packed else text)
    with pytest.raises(DataError, match="seeds"):
        compare_record(copied)


@pytest.mark.parametrize("file", [TABLE, DRAWN, PLACES])
def test_a_missing_file_is_refused(file: str, copied: Path) -> None:
    (copied / "data" / file).unlink()
    with pytest.raises(DataError, match=f"{Path(file).name} is missing"):
        compare_record(copied)


EVERY = 3
"""One seed in so many is whole; 5 outside the tests."""


@cache
def plan_of_three() -> Plan:
    return seeded(3)


def test_a_seed_in_its_name_gives_other_shaken_meshes() -> None:
    body = resolve("full-contact").solution.body
    own, three, four = (family_named(name)(body, 4).p for name in ("shaken", "shaken-3", "shaken-4"))
    assert np.array_equal(three, Shaken(seed=3)(body, 4).p)
    assert not np.array_equal(three, four)
    assert not np.array_equal(three, own)
    with pytest.raises(UsageError, match="unknown mesh family 'shaken-x'"):
        family_named("shaken-x")


def test_plans_of_two_seeds_measure_the_same_on_other_meshes() -> None:
    three, four = plan_of_three().jobs, seeded(4).jobs
    assert {job.setting.family for job in three} == {"shaken-3"}
    assert [job.key for job in four] == [job.key.replace("shaken-3", "shaken-4") for job in three]


def test_every_case_and_statement_that_the_ledger_judges_on_shaken_meshes_is_among_them() -> None:
    unwanted = Pictures | Bounds | OtherCodes

    def kinds(jobs: Iterable[Job]) -> set[tuple[Statement, str]]:
        """Statements, and the cases of those that are about cases: on other meshes the others take fewer."""
        of_cases = lambda statement: statement.of_every_case or isinstance(statement, OwnSpace)  # noqa: E731
        return {(job.statement, job.setting.case if of_cases(job.statement) else "") for job in jobs}

    everywhere = (job for job in Plan.of(full()).jobs if not isinstance(job.statement, unwanted))
    shaken = [job for job in everywhere if job.setting.family == "shaken" and job.setting.case not in SLOW]
    assert not any(isinstance(job.statement, unwanted) for job in plan_of_three().jobs)
    # Nothing is claimed of these on shaken meshes.
    missing = {type(statement) for statement, _ in kinds(shaken) - kinds(plan_of_three().jobs)}
    assert missing == {FullyDiscrete, Landings, Rollers, WorkOfContact}


@pytest.mark.parametrize("label", NOT_CLAIMED)
def test_what_is_not_claimed_is_measured_and_raises_no_alarm(label: str) -> None:
    assert not claimed(label)
    assert any(job.statement.label == label for job in plan_of_three().jobs)


def test_the_light_part_lacks_what_costs_most_and_nothing_else() -> None:
    whole, light = plan_of_three().jobs, seeded(3, LIGHT).jobs
    assert set(light) < set(whole)
    costly_ones = "Thm 4.2, own space; Prop. 5.3; Prop. 5.4; beyond: initial gap; (5.24); computed again"
    assert {job.statement.label for job in set(whole) - set(light)} == set(costly_ones.split("; "))
    assert all(job.setting.dim == 3 for job in whole if costly(job) and job.statement.label == "Prop. 5.4")
    assert sum(job.cost for job in light) < 0.15 * sum(job.cost for job in whole)


def few(seed: int, part: str = WHOLE) -> Plan:
    """Two quick settings of each of two statements in place of all; the light part has those of the first."""
    whole, labels = plan_of_three(), ("Thm 4.1, 5.2", "K^h") if part == WHOLE else ("Thm 4.1, 5.2",)
    jobs = (job for label in labels for job in [job for job in whole.jobs if job.statement.label == label][:2])
    family = f"shaken-{seed}"
    return Plan(whole.scope, tuple(replace(job, setting=replace(job.setting, family=family)) for job in jobs))


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Seeds of few measurements, and a clock that goes on by a second whenever somebody looks at it."""
    monkeypatch.setattr(seeds, "seeded", few)
    monkeypatch.setattr(seeds, "EVERY", EVERY)
    monkeypatch.setattr(seeds, "time", SimpleNamespace(monotonic=count().__next__))


@pytest.mark.usefixtures("quick")
def test_seeds_are_drawn_fresh_and_added_to_the_record(tmp_path: Path) -> None:
    seeds_of(tmp_path, "--seeds", "2")
    first = Record.read(tmp_path)
    assert [(draw.part, draw.judged > 0, draw.alarms) for draw in first.draws] == [(LIGHT, True, 0)] * 2
    seeds_of(tmp_path, "--seeds", "1")
    record = Record.read(tmp_path)
    assert record.draws[:2] == first.draws
    assert [draw.part for draw in record.draws] == [LIGHT] * (EVERY - 1) + [WHOLE]
    assert len({draw.seed for draw in record.draws}) == EVERY
    assert all(record.lines[known].places.startswith(line.places) for known, line in first.lines.items())
    assert set(pd.read_csv(tmp_path / "data" / "seeds.csv")["seeds"]) == {1, EVERY}
    assert not any((tmp_path / "seeds").iterdir())


@pytest.mark.usefixtures("quick")
def test_an_interrupted_run_loses_nothing(tmp_path: Path) -> None:
    """The seed that was begun is finished first, and the results of its finished jobs are used.

    The third look at the clock, after the beginning, comes when one job is done.
    """
    three_seconds = "--minutes", "0.05"
    assert seeds_of(tmp_path, *three_seconds) == 3
    begun = Record.read(tmp_path).pending()
    assert begun is not None
    kept = [*tmp_path.glob("seeds/*/data/jobs/*.json")]
    assert len(kept) == 1
    written = kept[0].stat().st_mtime_ns
    seeds_of(tmp_path, *three_seconds)
    assert kept[0].stat().st_mtime_ns == written
    seeds_of(tmp_path, "--seeds", "1")
    (draw,) = Record.read(tmp_path).draws
    assert (draw.seed, draw.judged > 0) == (begun.seed, True)


@pytest.mark.slow
@pytest.mark.usefixtures("quick")
def test_a_seed_can_be_repeated_and_says_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    monkeypatch.setattr(seeds, "EVERY", 2)
    seeds_of(tmp_path, "--seeds", "2")
    before = Record.read(tmp_path)
    assert [draw.part for draw in before.draws] == [LIGHT, WHOLE]
    for draw in (before.draws[0], before.draws[-1]):
        assert main(["seeds", "--seed", str(draw.seed), "--jobs", "1", "--out", str(tmp_path)]) == 0
        assert f"{draw.judged} results are the same, 0 differ" in capsys.readouterr().out
    assert main(["seeds", "--seed", "5", "--jobs", "1", "--out", str(tmp_path)]) == 0
    assert "the record does not have this seed" in capsys.readouterr().out
    assert Record.read(tmp_path) == before


@pytest.fixture(scope="module")
def measured(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Plan]:
    """Data of one seed."""
    directory, plan = tmp_path_factory.mktemp("seed"), few(11)
    with Processes(1) as processes:
        seeds.judged(plan, Store(directory), Pool.of(processes), "", float("inf"))
    return directory, plan


@pytest.mark.slow
def test_the_fingerprint_of_a_rule_is_that_of_every_seed(measured: tuple[Path, Plan], tmp_path: Path) -> None:
    directory, plan = measured
    found, other = rules(directory, plan, plan), few(12)
    with Processes(1) as processes:
        verdicts = seeds.judged(other, Store(tmp_path), Pool.of(processes), "", float("inf"))
    assert rules(tmp_path, other, other) == found
    assert {row_of(verdict) for verdict in verdicts if verdict.label != "data"} == set(found)


def test_another_window_statistic_or_level_is_another_rule_of_these_rows_alone(
    measured: tuple[Path, Plan], monkeypatch: pytest.MonkeyPatch
) -> None:
    directory, plan = measured
    before, (first, *others) = rules(directory, plan, plan), OneTrajectory.rules
    assert isinstance(first, Criterion)
    for change in (
        {"window": at_most(2 * first.window.high)},
        {"measure": lambda table: exactly(2 * table[first.columns[0]].iloc[-1])},
    ):
        monkeypatch.setattr(OneTrajectory, "rules", (replace(first, **change), *others))
        after = rules(directory, plan, plan)
        assert {row[:2] for row in before if after[row] != before[row]} == {(OneTrajectory.label, first.key)}
    monkeypatch.undo()
    finer = [replace(job, setting=replace(job.setting, level=9)) if job is plan.jobs[0] else job for job in plan.jobs]
    longer = Plan(plan.scope, tuple(finer))
    after = rules(directory, longer, longer)
    assert {row[2] for row in before if after[row] != before[row]} == {plan.jobs[0].setting.case}


def test_rows_about_more_than_was_measured_have_no_rule(measured: tuple[Path, Plan]) -> None:
    directory, plan = measured
    first, *others = plan.jobs
    part = rules(directory, Plan(plan.scope, tuple(others)), plan)
    assert first.setting.case not in {row[2] for row in part}


def seeds_of(directory: Path, *options: str) -> int:
    return main(["seeds", *options, "--jobs", "1", "--out", str(directory)])


def test_rows_that_are_no_longer_in_the_ledger_do_not_count(committed: Record, counted: pd.DataFrame) -> None:
    """The last whole seed and those after it do not have them; what is in the record of them stays there."""
    known = ("a label", "a key", "a case", "r000000000")
    gone = replace(committed, lines={**committed.lines, known: Line(0.0, 1.0, packed(2.0))})
    assert known[:3] not in {row.key for row in CountedCheck.of(gone)}
    assert tally(gone).equals(counted)


def test_the_committed_record_keeps_what_is_promised(committed: Record, counted: pd.DataFrame) -> None:
    assert counted.loc[counted["claimed"] == "yes", "alarms"].sum() == 0
    written = read_csv(RESULTS, "seeds.csv", counted.columns)
    assert list(written["key"]) == list(counted["key"])
    assert written["seeds"].equals(counted["seeds"])
    labels = {row.key[0] for row in CountedCheck.of(committed)}
    assert labels >= {"Prop. 5.4", "Prop. 5.3", "Thm 4.2", "Thm 4.2, own space"}


def test_rows_of_the_committed_record_have_the_windows_of_the_ledger(committed: Record) -> None:
    """Or seeds would count for windows that they were not judged by."""
    columns = ["label", "key", "case", "window_low", "window_high"]
    claims = read_csv(RESULTS, "claims.csv", columns)
    windows = {tuple(row[:3]): row[3:] for row in claims[columns].to_numpy()}
    latest = {row.key: committed.lines[(*row.key, row.rule)] for row in CountedCheck.of(committed)}
    shared = [(latest[key], window) for key, window in windows.items() if key in latest]
    assert len(shared) > 400
    assert all((line.window_low, line.window_high) == pytest.approx(window) for line, window in shared)
