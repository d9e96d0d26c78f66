"""What is on record of contact codes and of random trials: no error outside, orders proved, and the pages say so."""

import sys

import numpy as np
import pandas as pd
import pytest
from measures import close
from places import CERTIFICATES, EXAMPLES

from benchmarks.trials import random_problems, record, stiff
from manufactured.problems import ramp
from study.cli.export import march, plain
from study.fem.naming import family_named
from study.present.pages import put

sys.path.append(str(EXAMPLES / "bounds"))
import certify_codes
import judge_codes

BOUNDS = pd.read_csv(judge_codes.TABLE)
PROVED = pd.read_csv(certify_codes.TABLE, dtype={"version": str})
RANDOM, EFFECTIVITY = (pd.read_csv(record.OUT / name) for name in ("random.csv", "effectivity.csv"))
FINEST = BOUNDS[BOUNDS["level"] == BOUNDS["level"].max()]


def test_five_codes_of_others_are_bounded_on_three_meshes_by_at_most_twice_the_errors():
    assert {"Kratos", "NGSolve", "GetFEM", "CalculiX", "scikit-fem"} <= set(BOUNDS["code"])
    assert (BOUNDS.groupby(judge_codes.KEY)["level"].nunique() == 3).all()
    assert (BOUNDS["kind"] == "guaranteed").all()
    assert (BOUNDS["highest"] / BOUNDS["lowest"]).max() < 2


def test_a_fixed_penalty_is_proved_to_have_an_order_below_one_and_codes_that_are_right_have_one_around_it():
    fixed, right = (FINEST[FINEST["method"].str.endswith("fixed") == kind] for kind in (True, False))
    assert len(fixed) >= 4
    assert (fixed["order_high"] < 1).all()
    assert ((right["order_low"] < 1) & (right["order_high"] > 0.95)).all()
    assert (right["order_high"] - right["order_low"]).max() < 0.3


def test_the_bound_with_default_settings_is_at_most_a_quarter_above_the_error():
    """Predicted: with one refinement less, y, a twentieth of d at two refinements, is 2^{3/2} to 4 times as large."""
    middle = BOUNDS[BOUNDS["level"] == judge_codes.DEFAULT]
    assert (middle["default_high"] >= middle["lowest"]).all()
    assert (middle["default_high"] / middle["lowest"]).max() < 1.25


@pytest.mark.parametrize(
    ("page", "name", "table", "remedy"),
    [
        (judge_codes.PAGE, "bounds-of-codes", judge_codes.summary(BOUNDS), "make codes-bounds"),
        (record.PAGE, "effectivity", stiff.summary(EFFECTIVITY), "make trials"),
        (record.PAGE, "random-trials", random_problems.summary(RANDOM), "make trials"),
    ],
)
def test_the_page_shows_the_record(page, name, table, remedy):
    text = page.read_text(encoding="utf-8")
    assert f"<!-- {name} -->" in text
    assert put(text, name, table) == text, f"run: {remedy}"


def test_proved_intervals_of_codes_lie_in_those_in_double_precision():
    """Both use the same ũ. The one in double precision is wider, as it bounds what samples of the moving load miss."""
    assert len(PROVED) == len(PROVED.drop_duplicates(["code", "method", "level"])) >= 11
    assert (PROVED["lowest"] <= PROVED["proved_low"]).all()
    assert (PROVED["proved_low"] < PROVED["proved_high"]).all()
    assert (PROVED["proved_high"] <= PROVED["highest"]).all()


def test_a_certificate_of_a_code_needs_the_mesh_of_the_proof(tmp_path):
    checker = certify_codes.checker
    path = tmp_path / "mine.npz"
    proof = checker.load(CERTIFICATES / "wedge-4.json.gz")
    mesh = certify_codes.in_doubles(checker.Mesh.of(proof["mesh"], checker.Problem(proof["problem"])))
    u = 2 * np.array(proof["computed"])
    times = np.linspace(0, 1, len(u))
    arrays = {"points": mesh.p.T, "triangles": mesh.t.T, "times": times, "u": u.reshape(len(u), -1, 2)}
    np.savez(path, **arrays)
    found = certify_codes.in_place(proof, path)
    assert found == proof | {"computed": u.tolist()}
    wrong = {"vertices": {"points": mesh.p.T + 1e-3}, "triangles": {"triangles": mesh.t.T[:-1]}}
    for message, changed in (wrong | {"time steps": {"times": times**2}}).items():
        np.savez(path, **(arrays | changed))
        with pytest.raises(certify_codes.BoundError, match=message):
            certify_codes.in_place(proof, path)


def test_the_march_that_codes_get_is_the_problem_of_the_study():
    """Static steps of the exported march, solved by condensation, give the displacement of the study."""
    import this_study
    from contact_judge import Task, answer

    data = ramp()
    level = 4
    task = judge_codes.task("ramp", data, family_named("one-diagonal")(data.body, level), level)
    exported = Task("ramp", plain(march(task, level)))
    u = answer(exported, this_study.make)
    _, states = task.march(level)
    expected = [task.space.nodal(state.u).T for state in states]
    assert close(u, np.array(expected[1:]), 1e-10)


# ---- random trials


def test_no_error_on_record_lies_outside():
    assert len(RANDOM) == RANDOM["trial"].nunique() >= 100
    assert RANDOM["trial"].isin(range(2 * random_problems.COUNT)).all()
    refused = RANDOM["outcome"].str.startswith(random_problems.REFUSED)
    assert (refused | (RANDOM["outcome"] == random_problems.ENCLOSED)).all()
    inside = RANDOM[~refused]
    assert (inside["low"] <= inside["error"] * 1.01).all()
    assert (inside["error"] <= inside["high"] * 1.01).all()


def test_they_are_as_rough_as_it_is_said():
    assert RANDOM["width"].min() < 0.02
    assert RANDOM["periods"].max() > 50
    assert set(RANDOM["family"]) == {"one-diagonal", "shaken", "unstructured"}
    assert RANDOM["slope"].nunique() == 3
    assert (RANDOM["zone"] == 1).mean() > 0.5
    assert (RANDOM["blind"] == random_problems.OUTSIDE).sum() > 0


def test_effectivities_are_bounded_for_all_materials():
    assert list(EFFECTIVITY["trial"]) == sorted(stiff.trials())
    wide = stiff.wide(EFFECTIVITY)
    assert wide["enclosure"].max() < 2
    assert wide["plain"].max() < 3
    assert (wide[["enclosure", "plain"]] >= 1).all(axis=None)


@pytest.mark.slow
@pytest.mark.parametrize("trial", ["G 10000 10000", "A 1 1"])
def test_the_record_is_what_the_program_gives(trial):
    (kept,) = EFFECTIVITY[EFFECTIVITY["trial"] == trial].itertuples()
    found = dict(zip(("low", "high", "plain"), stiff.bounds(trial, stiff.USUAL), strict=True))
    assert {name: getattr(kept, name) for name in found} == pytest.approx(found, rel=1e-3)
