"""What the controls look for, and how they are told apart.

That every deliberate defect turns its named row to *fails*, and without one all rows hold, is what ``make controls``
measures, a step of continuous integration beside this suite.
"""

from __future__ import annotations

import copy
import re
import subprocess
import sys
from dataclasses import replace
from functools import cache, lru_cache
from importlib.util import find_spec
from pathlib import Path

import pandas as pd
import pytest

from study.cli.main import main
from study.controls.baselines import Equivalence, Sweep
from study.controls.contact_test import DEFECTS, OF_THE_PROGRAM, contact_tests, defective, write_contact_test
from study.controls.control import Control, patched
from study.controls.replacements import no_contact
from study.controls.run_controls import NO_DEFECT, Outcome, _key, alike, controls_text, outcomes, settings, work
from study.controls.sensitivity import CLOSE, LEAST, Place, lines
from study.controls.small_defects import DEFECTS as SMALL_DEFECTS
from study.controls.small_defects import START
from study.controls.table import CONTROLS, ELASTICITY, MEMBERS
from study.fem.mesh import OneDiagonal
from study.fem.naming import resolve
from study.ledger.datafiles import read_claims
from study.ledger.verdict import FAILS, HOLDS, UNCLAIMED, UNDECIDED, Verdict, row
from study.ledger.window import around
from study.present.outcome import contact_test_text
from study.run.plan import Plan, quick
from study.run.store import Store
from study.solve.tableau import MIDPOINT
from study.statements import contact_force, prop_5_4
from study.statements.prop_5_4 import FirstOrder, Measurement
from study.statements.shared.base import Setting
from study.statements.shared.experiment import Experiment
from study.statements.shared.scope import Levels
from study.statements.thm_4_2 import Derived, Sides, StandsAlone, independence


@cache
def rows(setting, control=None) -> list[Verdict]:
    return work(setting, control)


def named(name: str) -> Control:
    (found,) = (control for control in CONTROLS if control.name == name)
    return found


RESULTS = Path(__file__).parents[2] / "results"
BY_TESTS = """
data | missing
  test_propositions.py::test_missing_rows_leave_the_data_undecided
beyond: initial gap | discrete-order-others discrete-time-share start-share parallelogram time-share
  test_propositions.py::test_every_row_about_an_initial_gap_can_fail
beyond: initial gap | residual clamped quadrature leading-term leading-order order-finest interpolation-order-finest
  test_propositions.py::test_every_row_about_an_initial_gap_can_fail
enclosure | tight-above tight-below
  test_enclosure.py::test_ends_are_close_where_it_was_announced
enclosure | order
  test_enclosure.py::test_an_order_is_judged_where_nobody_knows_the_error
beyond: O(h + k) | data solution constant between midpoint order uniform reference
  test_time_errors.py::test_every_row_about_backward_euler_can_fail
beyond: work on edges | solution all constant branches
  test_contact_work.py::test_every_row_about_edges_can_fail
beyond: work of contact | order order-mean spread share
  test_contact_work.py::test_work_of_another_order_a_spread_that_stays_and_work_that_cannot_be_seen_fail
beyond: rollers | bound time step order-equal order-alternating order-shaken order-standing
  test_rollers.py::test_every_row_about_rollers_can_fail
Prop. 5.4 | leading-order
  test_propositions.py::test_an_error_that_stagnates_and_a_leading_term_that_is_not_of_order_h_are_alarms
beyond: landings | backward-euler-two midpoint-two
  test_time_errors.py::test_landings_are_judged_and_a_scheme_without_loss_would_be_noticed
(5.23) | smooth-random u-0.23-random u-0.61-random
  test_statements_static.py::test_the_order_in_v_is_judged_from_both_sides
other codes | snesvi getfem freefem kratos
  test_other_codes.py::test_an_error_that_is_another_turns_the_row_of_its_code_to_fails
other codes | own-digits
  test_other_codes.py::test_a_column_that_was_copied_is_noticed
(5.20)–(5.21), (5.42) | growth-5.21 growth-5.42
  test_statements_evolution.py::test_a_bound_of_lower_order_must_be_lower_by_what_is_predicted
"""
"""Rows without a small setting, or never worse than undecided, each with its test in tests/statements."""


def test_every_kind_of_row_that_is_claimed_is_named_by_a_control_or_by_a_test() -> None:
    """By its statement, too: rows of two statements may have a key in common, and be judged by different code."""
    claims, caught = read_claims(RESULTS), pd.read_csv(RESULTS / "data" / "controls.csv", keep_default_na=False)
    claimed = claims[~claims["verdict"].isin(UNCLAIMED)]
    labels = dict(zip(caught["defect"], caught["label"], strict=True))
    named = {(labels[control.name], key) for control in CONTROLS for key in control.keys}
    kinds = set(claimed[["label", "key"]].itertuples(index=False, name=None))
    heads, places = BY_TESTS.split("\n")[1:-1:2], BY_TESTS.split("\n")[2::2]
    pairs = [(*head.split(" | "), place.strip()) for head, place in zip(heads, places, strict=True)]
    by_tests = {(label, key): place for label, keys, place in pairs for key in keys.split()}
    assert kinds - named == set(by_tests)
    for place in by_tests.values():
        file, _, name = place.partition("::")
        assert f"def {name}(" in (RESULTS.parent / "tests" / "statements" / file).read_text(encoding="utf-8")


def test_the_committed_controls_are_those_of_the_list_and_all_did_their_duty() -> None:
    caught = pd.read_csv(RESULTS / "data" / "controls.csv", keep_default_na=False)
    expected = [NO_DEFECT] * len(settings(CONTROLS)) + [control.name for control in CONTROLS]
    assert caught["defect"].tolist() == expected
    assert len({control.name for control in CONTROLS}) == len(CONTROLS)
    assert set(caught["caught"]) == {"", "yes"}
    assert set(caught["verdict"][caught["defect"] == NO_DEFECT]) == {HOLDS}


def test_a_mistake_in_the_code_is_undone() -> None:
    right = Measurement.quadrature_change
    with patched(named("blind: quadrature").changes):
        assert Measurement.quadrature_change is not right
    assert Measurement.quadrature_change is right


def test_an_attribute_of_what_is_measured_is_replaced_in_a_copy() -> None:
    setup = Experiment.at(Setting("full-contact", "one-diagonal", 4), MIDPOINT, 8)
    wrong = named("few steps")(named("load too large")(named("size of a mesh")(setup)))
    assert (wrong.steps, setup.steps) == (1, 8)
    assert wrong.problem.load(0.5) == pytest.approx(1.1 * setup.problem.load(0.5))
    assert (wrong.space.h, setup.space.h) == (pytest.approx(1 / 2), 0.25)


def test_a_finished_measurement_is_found_again_by_a_later_call_and_no_two_share_a_file() -> None:
    places = [*((setting, "") for setting in settings(CONTROLS)), *((one.setting, one.name) for one in CONTROLS)]
    keys = [_key(setting, name) for setting, name in places]
    # Copies have other addresses in memory, as in another process.
    assert [_key(copy.deepcopy(setting), name) for setting, name in places] == keys
    assert len(set(keys)) == len(keys)


def test_a_flipped_normal_does_more_than_drop_the_constraint_where_a_gap_is_open() -> None:
    # The residuals of two exact solves are rounding, and differ.
    setting = Sweep("advance-recede", levels=(4, 8))
    dropped = Control("dropped", "V^h", setting, "problem", no_contact, "order")
    found = [[row for row in work(setting, one) if row.key != "residual"] for one in (named("normal flipped"), dropped)]
    assert not alike(*found)


def verdict(key: str, state: str, observed: float = 0.5) -> Verdict:
    return row(FirstOrder(), key, f"the {key}", around(1, 0.15), (observed, (observed, observed), state), "a")


def test_the_named_row_decides_and_another_one_that_fails_does_not() -> None:
    control = Control("wrong", "something", Sweep("full-contact"), "", copy.copy, "named")
    for state, other in ((FAILS, HOLDS), (HOLDS, FAILS), (HOLDS, UNDECIDED)):
        found = Outcome.of_control(control, [verdict("other", other), verdict("named", state)])
        assert (found.row.key, found.caught) == ("named", state == FAILS)
    with pytest.raises(KeyError, match="named"):
        Outcome.of_control(control, [verdict("other", FAILS)])


@pytest.mark.parametrize("state", [FAILS, UNDECIDED])
def test_a_baseline_that_does_not_hold_is_no_proof(state: str) -> None:
    sweep = Sweep("full-contact")
    good = Outcome.of_baseline(sweep, [verdict("a", HOLDS), verdict("b", HOLDS)], {"a", "b"})
    bad = Outcome.of_baseline(sweep, [verdict("a", HOLDS), verdict("b", state)], {"a", "b"})
    assert (good.passes, bad.passes, bad.row.key) == (True, False, "b")
    assert "in 1 every check holds" in controls_text([good, bad])


def test_a_row_that_no_defect_is_there_for_and_a_name_of_two_rows_are_not_in_order() -> None:
    """Such a row could be weakened or left out, and every control would still do its duty."""
    sound = [verdict("a", HOLDS), verdict("b", HOLDS), verdict("a", HOLDS)]
    found = Outcome.of_baseline(Sweep("full-contact"), sound, {"a", "c"})
    assert not found.passes
    text = controls_text([found])
    assert "none: two checks are called a; no control names the check b" in text
    assert "in 0 every check holds" in text


def test_a_defect_that_shows_what_another_one_shows_is_the_same_mistake() -> None:
    places = Sweep("full-contact"), Sweep("no-contact")
    names = (("first", 0), ("again", 0), ("elsewhere", 1), ("other", 0))
    controls = [Control(name, "something", places[place], "", copy.copy, "named") for name, place in names]
    shown = [[verdict("named", FAILS, observed)] for observed in (0.5, 0.5004, 0.5, 0.6)]
    found = outcomes({places[0]: [verdict("named", HOLDS)]}, list(zip(controls, shown, strict=True)))
    assert [(one.defect, one.passes) for one in found] == [
        *((NO_DEFECT, True), ("first", True), ("again", False), ("elsewhere", True), ("other", True))
    ]
    assert "ERROR in the controls: full-contact, n = 8 16 32, again: the same mistake as first" in controls_text(found)


def run(monkeypatch, tmp_path, *controls: Control) -> int:
    monkeypatch.setattr("study.controls.table.CONTROLS", controls)
    return main(["controls", "--jobs", "1", "--out", str(tmp_path)])


def test_the_command_prints_and_writes_what_caught_each_defect(monkeypatch, tmp_path, capsys) -> None:
    chosen = [c for c in CONTROLS if c.setting in (ELASTICITY, MEMBERS)]
    assert run(monkeypatch, tmp_path, *chosen) == 0
    text = capsys.readouterr().out
    assert "5 defects: 5 noticed" in text
    assert "2 settings without a defect: in 2 every check holds" in text
    assert len(re.findall(r" all \d+ checks must hold +holds$", text, re.MULTILINE)) == 2
    assert max(map(len, text.splitlines())) <= 110
    assert all(control.name in text for control in chosen)
    table = pd.read_csv(tmp_path / "data" / "controls.csv", keep_default_na=False)
    words = {v.key: v.quantity for c in chosen for v in rows(c.setting)}
    expected = [[c.name, words[c.keys[0]], "yes", FAILS] for c in chosen]
    assert table[["defect", "quantity", "caught", "verdict"]].to_numpy().tolist()[2:] == expected
    assert table[["defect", "caught", "verdict"]].to_numpy().tolist()[:2] == 2 * [[NO_DEFECT, "", HOLDS]]
    assert float(table["observed"][table["defect"] == "G doubled"].iloc[0]) == pytest.approx(2)
    assert {path.name for path in (tmp_path / "data").iterdir()} == {"controls.csv", ".lock", "jobs"}


def test_a_harmless_defect_is_not_caught_and_the_command_fails(monkeypatch, tmp_path, capsys) -> None:
    """A copy that replaces the original is not a defect."""
    harmless = Control("harmless", "a copy", Equivalence("no-contact"), "", copy.copy, "alone-stress")
    assert run(monkeypatch, tmp_path, harmless) == 1
    assert "NOT NOTICED" in capsys.readouterr().out
    assert pd.read_csv(tmp_path / "data" / "controls.csv")["caught"].tolist()[1] == "no"


MARCH = """
from manufactured import named
from study.fem.error_norm import ErrorNorm
from study.fem.mesh import OneDiagonal
from study.fem.space import Space
solution = named("advance-recede").solution
space = Space(OneDiagonal()(solution.body, 4), solution.body)
v_norm = ErrorNorm(solution, space)
data = space, solution.law, v_norm.load, v_norm.sample(0.0).interpolant
from study.solve.stress_problem import StressProblem
*_, last = StressProblem.of(*data).march(8)
assert last.time == space.body.T
"""


def test_the_stress_problem_loads_no_solver_of_displacements_while_it_marches() -> None:
    """So it cannot call one, not even on a copy of the other problem, which no change of that one would show."""
    command = [sys.executable, "-c", f"{MARCH}\nimport sys; print(*sys.modules)"]
    loaded = set(subprocess.run(command, capture_output=True, text=True, check=True).stdout.split())
    assert "clarabel" in loaded
    names = "signorini multigrid solver_choice evolution tableau fixed_point factorisation"
    solvers = {f"study.solve.{name}" for name in names.split()}
    assert all(map(find_spec, solvers))
    assert not loaded & solvers


@pytest.mark.parametrize(
    "setting", [*StandsAlone().places(full=False), Setting("yield-on-a-part", "shaken", 4)], ids=str
)
def test_the_comparison_shows_all_of_a_mistake_in_the_displacement_problem_alone(setting: Setting) -> None:
    found = StandsAlone().measure(setting)
    assert found == pytest.approx({"h": 0.25, "displacement_shown": 1, "stress_shown": 1}, abs=1e-6)


def test_a_stress_problem_that_follows_shows_nothing() -> None:
    sides = Sides.of(resolve("advance-recede").solution, OneDiagonal(), 4)
    honest = sides.stresses(sides.displacements)
    following = Sides(sides.displacements, lambda problem: Derived.compared(honest, problem))
    assert set(independence(following, 8).values()) == {0.0}


@pytest.mark.parametrize(("shown", "expected"), [(1.0, HOLDS), (0.0, FAILS), (0.5, FAILS), (float("nan"), FAILS)])
def test_all_of_a_mistake_must_show(shown: float, expected: str) -> None:
    """Without a mistake, 0/0, nothing is shown either."""
    rows = [
        {"case": "a", "family": family, "level": 4, "h": 0.25, "quantity": quantity, "value": value}
        for family, value in (("shaken", 1.0), ("criss-cross", shown))
        for quantity in ("displacement_shown", "stress_shown")
    ]
    assert [v.verdict for v in StandsAlone().judge(pd.DataFrame(rows))] == [expected, expected]


def test_derived_stresses_agree_with_their_displacements_perfectly() -> None:
    """Which is why agreement alone is no evidence, and perfect agreement is none at all."""
    control = named("stress from displacement")
    agreement = [v for v in rows(control.setting, control) if v.key in ("displacement", "stress")]
    assert [v.verdict for v in agreement] == [FAILS, FAILS]
    assert max(v.observed for v in agreement) == 0


@lru_cache
def place() -> Place:
    return Place(Setting("advance-recede", "one-diagonal", 8))


LOADS = "load f", "surface load f_2", "body force f_0", "contact load", "time t"
"""Seen only by the load that is integrated a second time, with a quadrature error between the two."""


@pytest.mark.parametrize("name", SMALL_DEFECTS)
def test_a_millionth_is_seen_except_of_loads_of_which_two_per_cent_are(name: str) -> None:
    assert bool(place().failing(SMALL_DEFECTS[name](place().setup, 1e-6))) is (name not in LOADS)
    if name in LOADS:
        assert place().failing(SMALL_DEFECTS[name](place().setup, 0.02))


def test_the_smallest_defect_fails_and_one_a_little_smaller_or_none_does_not() -> None:
    assert place().failing(place().setup) == []
    load = SMALL_DEFECTS["load f"]
    amount, row = place().smallest(load)
    assert row in place().failing(load(place().setup, amount))
    assert not place().failing(load(place().setup, amount / CLOSE**2))
    assert LEAST < amount < 0.01


def test_of_a_start_that_is_zero_nothing_can_be_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("study.controls.sensitivity.DEFECTS", {START: SMALL_DEFECTS[START]})
    assert lines(Setting("full-contact", "one-diagonal", 8)) == []


CASES = """
from dataclasses import replace
from sympy import Rational
from manufactured import Case, ContactFace, ExactSolution, KelvinVoigt, Kind, Regularity
from manufactured import isotropic, named, polygon, pos, s, t

good = replace(named("advance-recede"), name="good")
arch = replace(named("parabolic-gap"), name="arch", families=("one-diagonal",))
apart = replace(named("no-contact"), name="apart")
solid = replace(named("cube-disc"), name="solid")

kinds = [Kind.CONTACT, Kind.LOADED, Kind.LOADED, Kind.LOADED, Kind.CLAMPED, Kind.LOADED]
body = polygon([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)], kinds)
law = KelvinVoigt(isotropic(1, 0.5), isotropic(2, 3), "linear")
(floor,) = body.of(Kind.CONTACT)
zone = Rational(1, 64) - (s - Rational(1, 2) - t / 5) ** 2
face = ContactFace.linear(floor, law, body.T, pos(-zone, 4), 40 * pos(zone, 2), level=zone)
weak = Case(
    name="weak",
    summary="a small pressure on a narrow patch, and a large gap beyond",
    solution=ExactSolution(body, law, (face,)),
    regularity=Regularity(gap=4, pressure=2, moving=True),
    order=1,
    reason="α = 4 > 7/2 and m = 2 > 3/2 give (5.36)",
)
"""


@pytest.fixture(scope="module")
def cases(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path: Path = tmp_path_factory.mktemp("cases") / "cases.py"
    path.write_text(CASES, encoding="utf-8")
    return path


def plan_of(reference: str) -> Plan:
    scope = replace(quick(), cases=(reference,), plane=Levels((4, 8, 16)), every_family=False, statements=False)
    return Plan.of(scope)


def outcome(reference: str, directory: Path) -> tuple[pd.DataFrame, str]:
    """The rows of ``contact-test.csv``, and what a run prints about them."""
    plan, store = plan_of(reference), Store(directory)
    (jobs,) = contact_tests(plan)
    for job in (*jobs, *(job for defect in DEFECTS for job in defective(jobs, defect))):
        store.save(job.key, job.fingerprint(), dict(job.run()))
    (path,) = write_contact_test([jobs], store)
    return pd.read_csv(path, keep_default_na=False), " ".join(contact_test_text(directory).split())


@pytest.mark.slow
def test_a_front_under_a_large_pressure_notices_both_defects(cases: Path, tmp_path: Path) -> None:
    rows, text = outcome(f"{cases}:good", tmp_path)
    assert (rows["noticed"] > 0).all()
    assert "contact force, order-pressure" in rows.set_index("defect").loc["contact in places", "noticed_by"]
    assert "weak" not in text
    assert "contact forces times 1.1: by contact force" in text


@pytest.mark.slow
def test_a_small_pressure_on_a_narrow_patch_is_a_weak_test_with_advice(cases: Path, tmp_path: Path) -> None:
    rows, text = outcome(f"{cases}:weak", tmp_path)
    assert (rows["noticed"] == 0).all()
    assert (rows["holding"] > 0).all()
    assert text.startswith("weak test of contact: weak, unstructured meshes, n = 4 8 16")
    assert "larger pressure relative to moduli and gap, a contact zone that is wider in cells, or finer levels" in text


def test_only_cases_of_users_that_touch_are_tested(cases: Path) -> None:
    assert contact_tests(plan_of("advance-recede")) == contact_tests(plan_of(f"{cases}:apart")) == []
    assert resolve(contact_tests(plan_of(f"{cases}:solid"))[0][0].setting.case).solution.body.dim == 3


@pytest.mark.parametrize(("name", "defect"), [("good", "contact in places"), *(("arch", defect) for defect in DEFECTS)])
def test_rows_about_the_program_do_not_count_and_the_defect_ends_with_the_job(cases: Path, name, defect) -> None:
    assert {"penetration", "pulling", "residual"} <= OF_THE_PROGRAM
    job = defective(contact_tests(plan_of(f"{cases}:{name}"))[0], defect)[0]
    assert job.run() != super(type(job), job).run()
    assert vars(prop_5_4)["Experiment"] is vars(contact_force)["Experiment"] is Experiment
    assert len({job.key, super(type(job), job).key}) == 2
