"""Contact codes judged without an exact solution: what is on record proves orders, and the page says so."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from manufactured.problems import ramp
from study.fem.naming import family_named
from study.present.pages import put
from study.run.tasks import march, plain

ROOT = Path(__file__).parents[2]
sys.path.append(str(ROOT / "examples" / "bounds"))
import certify_codes  # noqa: E402
import judge_codes  # noqa: E402

BOUNDS = pd.read_csv(judge_codes.TABLE)
FINEST = BOUNDS[BOUNDS["level"] == BOUNDS["level"].max()]
FIXED = FINEST["method"].str.endswith("fixed")


def test_at_least_four_codes_of_others_are_bounded_on_three_meshes() -> None:
    assert {"Kratos", "NGSolve", "GetFEM", "CalculiX", "scikit-fem"} <= set(BOUNDS["code"])
    assert (BOUNDS.groupby(judge_codes.KEY)["level"].nunique() == 3).all()
    assert (BOUNDS["kind"] == "guaranteed").all()


def test_a_fixed_penalty_is_proved_to_have_an_order_below_one() -> None:
    assert FIXED.sum() >= 4
    assert (FINEST[FIXED]["order_high"] < 1).all()


def test_codes_that_are_right_have_an_order_around_one() -> None:
    right = FINEST[~FIXED]
    assert (right["order_low"] < 1).all()
    assert (right["order_high"] > 0.95).all()
    assert (right["order_high"] - right["order_low"]).max() < 0.3


def test_upper_bounds_are_at_most_twice_the_errors() -> None:
    assert (BOUNDS["highest"] / BOUNDS["lowest"]).max() < 2


def test_the_bound_with_default_settings_is_at_most_a_quarter_above_the_error() -> None:
    """Predicted: with one refinement less, y, a twentieth of d at two refinements, is 2^{3/2} to 4 times as large."""
    middle = BOUNDS[BOUNDS["level"] == judge_codes.DEFAULT]
    assert (middle["default_high"] >= middle["lowest"]).all()
    assert (middle["default_high"] / middle["lowest"]).max() < 1.25


def test_the_page_shows_the_record() -> None:
    text = judge_codes.PAGE.read_text(encoding="utf-8")
    assert "<!-- bounds-of-codes -->" in text
    assert put(text, "bounds-of-codes", judge_codes.summary(BOUNDS)) == text, "run: make codes-bounds"


def test_proved_intervals_of_codes_lie_in_those_in_double_precision_and_are_on_the_page() -> None:
    """Both use the same ũ. The one in double precision is wider, as it bounds what samples of the moving load miss."""
    proved = pd.read_csv(certify_codes.TABLE, dtype={"version": str})
    assert len(proved) == len(proved.drop_duplicates(["code", "method", "level"])) >= 11
    assert (proved["lowest"] <= proved["proved_low"]).all()
    assert (proved["proved_low"] < proved["proved_high"]).all()
    assert (proved["proved_high"] <= proved["highest"]).all()
    text = certify_codes.PAGE.read_text(encoding="utf-8")
    assert put(text, "certificates-of-codes", certify_codes.summary(proved)) == text, "run: make codes-bounds"


def test_a_certificate_of_a_code_needs_the_mesh_of_the_proof(tmp_path: Path) -> None:
    proof = certify_codes.checker.load(ROOT / "examples" / "certificates" / "wedge-4.json.gz")
    points = certify_codes.in_doubles(
        certify_codes.checker.Mesh.of(proof["mesh"], certify_codes.checker.Problem(proof["problem"]))
    )
    u = np.array(proof["computed"]).reshape(len(proof["computed"]), -1, 2)
    arrays = {"points": points.p.T, "triangles": points.t.T, "times": np.linspace(0, 1, len(u)), "u": 2 * u}
    np.savez(tmp_path / "doubled.npz", **arrays)
    found = certify_codes.in_place(proof, tmp_path / "doubled.npz")
    assert np.array_equal(found["computed"], 2 * np.array(proof["computed"]))
    assert found["stress"] is proof["stress"]
    for name, changed in {
        "vertices": {"points": points.p.T + 1e-3},
        "triangles": {"triangles": points.t.T[:-1]},
        "time steps": {"times": np.linspace(0, 1, len(u)) ** 2},
    }.items():
        np.savez(tmp_path / "wrong.npz", **arrays | changed)
        with pytest.raises(certify_codes.BoundError, match=name):
            certify_codes.in_place(proof, tmp_path / "wrong.npz")


@pytest.mark.parametrize("level", [4])
def test_the_march_that_codes_get_is_the_problem_of_the_study(level: int) -> None:
    """Static steps of the exported march, solved by condensation, give the displacement of the study."""
    import this_study
    from contact_judge import Task, answer

    data = ramp()
    task = judge_codes.task("ramp", data, family_named("one-diagonal")(data.body, level), level)
    exported = Task("ramp", plain(march(task, level)))
    u = answer(exported, this_study.make)
    _, states = task.march(level)
    expected = [task.space.nodal(state.u).T for state in states]
    assert abs(u - expected[1:]).max() <= 1e-10 * abs(u).max()
