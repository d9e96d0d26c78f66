"""No false alarms: the verdicts hold on other random meshes, and the record of seeds adds and never replaces."""

from dataclasses import replace
from functools import cache
from itertools import count
from types import SimpleNamespace

import numpy as np
import pytest
from commands import study
from places import RESULTS
from scipy import stats

from study.cli import controls
from study.controls.seeded import SeededScope, on_shaken, rules, seeded
from study.fem.mesh import Shaken
from study.fem.naming import family_named, resolve
from study.ledger.controls import FalseAlarms, Seed, SeedRecord, interval, seeds_needed
from study.ledger.datafiles import DataError
from study.ledger.files import UsageError
from study.ledger.verdict import FAILS, HOLDS, UNDECIDED, Verdict
from study.ledger.window import at_most
from study.run.plan import Plan
from study.statements.shared.base import ListedNumbers, grid
from study.statements.thm_4_2 import OwnSpace
from study.statements.time_steps import FullyDiscrete
from study.statements.wellposed import BoundedVelocity

RULES = "r1"


def after(alarms, rules=RULES, record=None):
    """A record with one more seed for each number of alarms."""
    record = record or SeedRecord()
    for number in alarms:
        seed = 100 + len(record.rows)
        record = record.drawn(seed).judged(rules, 2, number)
    return record


def test_the_interval_has_the_tails_that_clopper_and_pearson_ask_for():
    assert interval(0, 0) == (0, 1)
    low, high = interval(1, 100)
    assert [stats.binom.sf(0, 100, low), stats.binom.cdf(1, 100, high)] == pytest.approx([0.025, 0.025])


@pytest.mark.parametrize(
    ("red", "quiet", "verdict"),
    [(0, 0, UNDECIDED), (0, seeds_needed() - 1, UNDECIDED), (0, seeds_needed(), HOLDS), (5, 95, FAILS)],
)
def test_the_count_of_seeds_alone_decides(red, quiet, verdict):
    alarms = FalseAlarms(after([3] * red + [0] * quiet))
    assert alarms.seeds == red + quiet
    assert alarms.red == red
    assert alarms.verdict == verdict


def test_seeds_judged_by_other_rules_count_for_nothing():
    """Else a window could be widened, or a check removed, until the seeds that were drawn before are quiet."""
    alarms = FalseAlarms(after([0, 0, 1], "r2", after([2, 0])))
    assert alarms.seeds == 3
    assert alarms.red == 1
    assert alarms.checks == 2


def test_a_seed_that_is_begun_is_in_the_record_and_counts_for_nothing(tmp_path):
    record = after([0, 1]).drawn(7)
    record.write(tmp_path)
    assert SeedRecord.read(tmp_path) == record
    assert record.pending() == Seed(7)
    assert FalseAlarms(record).seeds == 2
    assert SeedRecord.read(tmp_path / "empty") == SeedRecord()


def test_nothing_in_the_record_is_replaced():
    record = after([0, 1])
    with pytest.raises(DataError, match="the last seed was already judged"):
        record.judged(RULES, 2, 0)
    assert after([0], record=record).rows[:2] == record.rows


DAMAGED = {
    "a seed twice": (Seed(5, "r", 2, 0), Seed(5, "r", 2, 0)),
    "more alarms than checks": (Seed(5, "r", 2, 3),),
    "an unfinished seed before another": (Seed(5), Seed(6, "r", 2, 0)),
}


@pytest.mark.parametrize("name", DAMAGED)
def test_a_damaged_record_is_refused(name, tmp_path):
    SeedRecord(DAMAGED[name]).write(tmp_path)
    with pytest.raises(DataError, match=r"seeds\.csv.*restore the file"):
        SeedRecord.read(tmp_path)


def test_the_committed_record_has_no_false_alarm():
    alarms = FalseAlarms(SeedRecord.read(RESULTS))
    assert alarms.seeds > alarms.red == 0
    assert max(map(len, alarms.text().splitlines())) <= 80


@cache
def plan_of_three():
    return seeded(3)


def test_a_seed_in_its_name_gives_other_shaken_meshes():
    body = resolve("full-contact").solution.body
    own, three, four = (family_named(name)(body, 4).p for name in ("shaken", "shaken-3", "shaken-4"))
    assert np.array_equal(three, Shaken(seed=3)(body, 4).p)
    assert not np.array_equal(three, four)
    assert not np.array_equal(three, own)
    with pytest.raises(UsageError, match="unknown mesh family 'shaken-x'"):
        family_named("shaken-x")


def few(seed):
    """Two quick settings of a statement in place of all."""
    every = plan_of_three()
    jobs = [job for job in every.jobs if isinstance(job.statement, BoundedVelocity)][:2]
    family = f"shaken-{seed}"
    return Plan(every.scope, tuple(replace(job, setting=replace(job.setting, family=family)) for job in jobs))


class Toy(ListedNumbers):
    """Without random meshes in the quick study."""

    quick = grid(("full-contact",), ("one-diagonal",), (8,))
    full = grid(("full-contact",), ("one-diagonal", "shaken"), (4, 8, 16))


@pytest.mark.parametrize(
    ("statement", "levels"),
    {BoundedVelocity(): {8, 16}, Toy(): {4, 8}, FullyDiscrete(): set(), OwnSpace(): {8, 16, 32}}.items(),
)
def test_statements_have_their_settings_on_random_meshes(statement, levels):
    """Of the quick study; if it has none, of the full study, but on no finer level."""
    scope = plan_of_three().scope
    assert isinstance(scope, SeededScope)
    settings = on_shaken(statement, scope)
    assert {setting.level for setting in settings} == levels
    assert {setting.family for setting in settings} <= {"shaken-3"}


@pytest.fixture
def quick(monkeypatch):
    """Seeds of few measurements, and a clock that goes on by a second whenever somebody looks at it."""
    monkeypatch.setattr(controls, "seeded", few)
    monkeypatch.setattr(controls, "time", SimpleNamespace(monotonic=count().__next__))


@pytest.mark.usefixtures("quick")
def test_seeds_are_drawn_fresh_and_added_to_the_record_and_one_can_be_repeated(tmp_path, capsys):
    seeds_of(tmp_path, "--seeds 2")
    first = SeedRecord.read(tmp_path)
    assert [(row.judged > 0, row.alarms) for row in first.rows] == [(True, 0)] * 2
    seeds_of(tmp_path, "--seeds 1")
    record = SeedRecord.read(tmp_path)
    assert record.rows[:2] == first.rows
    assert len({row.seed for row in record.rows}) == FalseAlarms(record).seeds == 3
    assert not any((tmp_path / "seeds").iterdir())
    assert seeds_of(tmp_path, f"--seed {first.rows[0].seed}") == 0
    assert f"the record has {first.rows[0].judged} checks and 0 false alarms" in capsys.readouterr().out
    assert seeds_of(tmp_path, "--seed 5") == 0
    assert "the record does not have this seed" in capsys.readouterr().out
    assert SeedRecord.read(tmp_path) == record


@pytest.mark.usefixtures("quick")
def test_an_interrupted_run_loses_nothing(tmp_path):
    """The seed that was begun is finished first, and the results of its finished jobs are used.

    The second look at the clock, after the beginning, comes when one job is done.
    """
    two_seconds = "--minutes 0.03"
    assert seeds_of(tmp_path, two_seconds) == 3
    begun = SeedRecord.read(tmp_path).pending()
    finished = [*tmp_path.glob("seeds/*/data/jobs/*.json")]
    assert len(finished) == 1
    written = finished[0].stat().st_mtime_ns
    seeds_of(tmp_path, two_seconds)
    assert finished[0].stat().st_mtime_ns == written
    seeds_of(tmp_path, "--seeds 1")
    (row,) = SeedRecord.read(tmp_path).rows
    assert row.seed == begun.seed
    assert row.judged > 0


@pytest.mark.usefixtures("quick")
def test_an_alarm_is_counted_printed_and_fails(tmp_path, monkeypatch, capsys):
    first, *others = BoundedVelocity.checks
    monkeypatch.setattr(BoundedVelocity, "checks", (replace(first, window=at_most(-1, low=-2)), *others))
    seeds_of(tmp_path, "--seeds 1")
    (row,) = SeedRecord.read(tmp_path).rows
    assert row.alarms > 0
    assert f"{BoundedVelocity.label}, {first.key}" in capsys.readouterr().out
    assert seeds_of(tmp_path, f"--seed {row.seed}") == 1


def seeds_of(directory, options):
    return study(f"seeds {options} --jobs 1 --out {directory}")


def test_a_window_quantity_or_level_changes_the_hash_of_rules_and_another_seed_does_not():
    row = Verdict(
        "Thm 4.1, 5.2", "u ∈ V", "corner", "q, shaken-3 meshes", "", 0, 0, 0, HOLDS, "k", "shaken-3", "", 0, 1
    )
    again = replace(row, quantity="q, shaken-4 meshes", family="shaken-4", observed=0.5)
    assert (first := rules(few(3), [row])) == rules(few(4), [again])
    for other in (replace(row, window_high=2.0), replace(row, quantity="r, shaken-3 meshes")):
        assert rules(few(3), [other]) != first
    job, *others = few(3).jobs
    finer = replace(job, setting=replace(job.setting, level=9))
    assert rules(replace(few(3), jobs=(finer, *others)), [row]) != first
