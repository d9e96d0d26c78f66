"""No false alarms: the verdicts hold on other random meshes (``test_robustness``: for other constants of a case)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from study.cli.main import main
from study.controls.alarms import NOT_CLAIMED, SEEDS, SeededScope, seeded, tally, text
from study.fem.mesh import Shaken
from study.fem.naming import family_named, resolve
from study.ledger.errors import UsageError
from study.ledger.verdict import FAILS, HOLDS, REPORTED, UNDECIDED, Verdict, row
from study.ledger.window import around
from study.run.job import Job
from study.run.plan import Plan, full, quick
from study.statements.contact_force.judge import ContactForce
from study.statements.enclosure.courses import Bounds
from study.statements.fully_discrete import FullyDiscrete
from study.statements.pictures import Pictures
from study.statements.prop_5_4.judge import FirstOrder
from study.statements.recomputed.judge import Recomputed
from study.statements.shared.base import Statement
from study.statements.shared.scope import Scope
from study.statements.thm_4_2.own_space import OwnSpace

RESULTS = Path(__file__).parents[2] / "results"
JOBS = seeded(3).jobs


def test_a_seed_in_its_name_gives_other_shaken_meshes() -> None:
    body = resolve("full-contact").solution.body
    own, three, four = (family_named(name)(body, 4).p for name in ("shaken", "shaken-3", "shaken-4"))
    assert np.array_equal(three, Shaken(seed=3)(body, 4).p)
    assert not np.array_equal(three, four)
    assert not np.array_equal(three, own)
    with pytest.raises(UsageError, match="unknown mesh family 'shaken-x'"):
        family_named("shaken-x")


def test_plans_of_two_seeds_measure_the_same_on_other_meshes() -> None:
    assert {job.setting.family for job in JOBS} == {"shaken-3"}
    assert [job.key for job in seeded(4).jobs] == [job.key.replace("shaken-3", "shaken-4") for job in JOBS]
    assert {job.fingerprint() for job in seeded(4).jobs}.isdisjoint(job.fingerprint() for job in JOBS)


def test_every_case_and_statement_that_the_ledger_judges_on_shaken_meshes_is_among_them() -> None:
    shaken = [
        job
        for job in Plan.of(full()).jobs
        if job.setting.family == "shaken" and not isinstance(job.statement, Pictures | Bounds)
    ]

    def kinds(jobs: Sequence[Job]) -> set[tuple[Statement, str]]:
        """Statements, and the cases of those that are about cases: on other meshes the others take fewer."""
        return {(job.statement, job.setting.case if of_cases(job.statement) else "") for job in jobs}

    def of_cases(statement: Statement) -> bool:
        return statement.of_every_case or isinstance(statement, OwnSpace)

    unshaken = {FullyDiscrete, ContactForce, Recomputed}
    assert {type(statement) for statement, _ in kinds(shaken) - kinds(JOBS)} == unshaken


def test_pictures_and_bounds_are_left_out() -> None:
    assert not any(isinstance(job.statement, Pictures | Bounds) for job in JOBS)


def test_the_study_of_a_seed_is_the_quick_one_but_for_the_seed() -> None:
    assert {field.name for field in fields(SeededScope)} == {field.name for field in fields(full())} | {"seed"}
    scope = seeded(3).scope
    others = {field.name: getattr(scope, field.name) for field in fields(full())}
    assert Scope(**others) == replace(quick(), rough=full().rough, command="study seeds")


def judged(key: str, seed: int, state: str, observed: float = 1.0) -> Verdict:
    """A row about the meshes of a seed."""
    span, family = (observed, observed), f"shaken-{seed}"
    return row(FirstOrder(), key, f"the {key}", around(1, 0.1), (observed, span, state), "advance-recede", family)


VERDICT = judged("order", 0, HOLDS)


def test_alarms_are_counted_row_by_row_whatever_the_meshes_are_called() -> None:
    other, third = judged("order", 1, FAILS, 0.8), judged("order", 2, UNDECIDED, 0.9)
    table = tally({0: [VERDICT, judged("p", 0, REPORTED)], 1: [other], 2: [third]})
    (line,) = table.itertuples(index=False)
    assert (line.key, line.quantity, line.seeds, line.alarms, line.lowest, line.highest, line.claimed) == (
        "order",
        "the order",
        3,
        2,
        0.8,
        1.0,
        "yes",
    )
    assert "1 claimed rows, 3 verdicts: 2 alarms" in text(table)


@pytest.mark.parametrize(("label", "case"), NOT_CLAIMED)
def test_what_is_not_claimed_is_counted_and_raises_no_alarm(label: str, case: str) -> None:
    failing = replace(VERDICT, label=label, case=case or "full-contact", verdict=FAILS)
    table = tally({0: [VERDICT, failing]})
    assert list(table["claimed"]) == ["yes", "no"]
    assert "1 claimed rows, 1 verdicts: 0 alarms" in text(table)


def test_no_seeds_are_refused(tmp_path, capsys) -> None:
    assert main(["seeds", "--seeds", "0", "--out", str(tmp_path)]) == 2
    assert "--seeds must be 1 or more, got 0" in capsys.readouterr().err


@pytest.fixture(scope="module")
def committed() -> pd.DataFrame:
    return pd.read_csv(RESULTS / "data" / "seeds.csv", keep_default_na=False)


def test_the_committed_verdicts_hold_on_twenty_other_random_meshes(committed: pd.DataFrame) -> None:
    claimed = committed[committed["claimed"] == "yes"]
    assert claimed["alarms"].sum() == 0
    (seeds,) = set(committed["seeds"])
    assert seeds == SEEDS
    assert {row.label for row in claimed.itertuples()} >= {"Prop. 5.4", "Prop. 5.3", "Thm 4.2", "Thm 4.2, own space"}


def test_what_is_not_claimed_on_random_meshes_alarms_there(committed: pd.DataFrame) -> None:
    """Or there would be no reason not to claim it."""
    alarms = committed[committed["claimed"] == "no"].groupby(["label", "case"])["alarms"].sum()
    for label, case in NOT_CLAIMED:
        assert alarms[label].sum() > 0 if not case else alarms[label, case] > 0
