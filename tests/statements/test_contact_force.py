"""Every verdict on the contact force can come out otherwise, and its norms are the ones that they are called."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from manufactured.catalogue import named
from study.fem.mesh import OneDiagonal
from study.ledger.verdict import FAILS, HOLDS, MISSED, REPORTED, UNCLAIMED, UNDECIDED
from study.solve.tableau import MIDPOINT
from study.statements.contact_force import LANDS, ContactForce, Forces, errors_in_time, measure_contact
from study.statements.shared.base import Setting
from study.statements.shared.experiment import Experiment

LEVELS = np.array([8.0, 16.0, 32.0])


def table(case: str = "a", family: str = "one-diagonal", levels=LEVELS, **changes) -> pd.DataFrame:
    h = 1 / levels
    rows = {"case": case, "family": family, "level": levels, "h": h, "penetration": 1e-16, "pulling": 0.0, "clamped": 0}
    rows |= {"pressure": h**1.3, "dual": h**1.7, "resultant": h**2}
    rows |= dict.fromkeys(["pressure_time_share", "dual_time_share", "resultant_time_share"], 0.1)
    return pd.DataFrame(rows).assign(**changes)


def verdicts(rows: pd.DataFrame) -> dict[str, str]:
    return {verdict.key: verdict.verdict for verdict in ContactForce().judge(rows)}


def test_the_predicted_behaviour_holds_in_every_row() -> None:
    assert set(verdicts(pd.concat([table(), table(family="criss-cross")])).values()) == {HOLDS}


def test_on_random_meshes_a_low_order_of_the_pressure_is_a_missed_prediction_and_no_failure() -> None:
    found = verdicts(pd.concat([table(family="one-diagonal"), table(family="shaken", pressure=0.2)]))
    assert found.pop("order-pressure-random") == MISSED
    assert set(found.values()) == {HOLDS}


def test_a_pressure_that_jumps_in_time_has_the_predicted_order_one_half_on_every_mesh() -> None:
    half = {name: 1 / LEVELS**0.5 for name in ("pressure", "dual", "resultant")}
    rows = pd.concat([table(LANDS, **half), table(LANDS, "shaken", **half)])
    found = [verdict for verdict in ContactForce().judge(rows) if verdict.key.startswith("order")]
    assert {verdict.key for verdict in found} >= {"order-pressure", "order-pressure-random"}
    assert all(verdict.verdict == REPORTED and "(met)" in verdict.expected for verdict in found)


@pytest.mark.parametrize(
    ("column", "value", "key"),
    [
        ("pressure", 0.2, "order-pressure"),
        ("pressure", 1 / LEVELS**0.8, "order-pressure"),
        ("pressure", 1 / LEVELS**2.3, "order-pressure"),
        ("dual", 0.2, "order-dual-superclose"),
        ("dual", 1 / LEVELS**1.2, "order-dual-superclose"),
        ("resultant", 1 / LEVELS**0.9, "order-resultant"),
        ("resultant", 0.06, "resultant"),
        ("dual_time_share", 0.51, "time-share"),
        ("penetration", 1e-9, "penetration"),
        ("penetration", np.nan, "penetration"),
        ("pulling", 1e-9, "pulling"),
    ],
)
def test_a_wrong_force_fails(column: str, value, key: str) -> None:
    assert verdicts(table(**{column: value}))[key] == FAILS


def test_no_order_of_the_resultant_is_claimed_if_a_face_meets_the_clamped_side() -> None:
    found = verdicts(table(clamped=1, resultant=1 / LEVELS**0.5))
    assert found["order-resultant"] == MISSED
    assert found["resultant"] not in UNCLAIMED


@pytest.mark.parametrize(("name", "pieces"), [("hexagon", 2), ("contact-at-clamp", 1), ("layered", 0), ("corner", 0)])
def test_the_pieces_of_the_contact_side_that_meet_the_clamped_side_are_counted(name: str, pieces: int) -> None:
    setting = Setting(name, "unstructured", 8)
    assert Forces(Experiment.at(setting, MIDPOINT, 2)).clamped == pieces


def test_on_other_meshes_order_one_is_enough_and_less_is_not() -> None:
    assert verdicts(table(family="shaken", dual=1 / LEVELS))["order-dual-other"] == HOLDS
    assert verdicts(table(family="shaken", dual=1 / LEVELS**0.8))["order-dual-other"] == FAILS


def test_two_levels_leave_orders_undecided() -> None:
    found = verdicts(table().iloc[:2])
    assert {key for key, verdict in found.items() if verdict == UNDECIDED} == {key for key in found if "order" in key}


def test_where_the_face_lands_with_a_velocity_no_order_is_claimed() -> None:
    found = verdicts(table("lift-and-land", pressure=1.0))
    assert {key for key, verdict in found.items() if verdict not in UNCLAIMED} == {"penetration", "pulling"}


@pytest.fixture(scope="module")
def setup() -> Experiment:
    return Experiment.of(named("full-contact").solution, OneDiagonal(), 4, MIDPOINT, 4)


@pytest.mark.parametrize("factor", [1.0, 1.2])
def test_forces_too_large_by_a_factor_are_wrong_by_this_factor_in_the_dual_norm_and_the_resultant(
    setup: Experiment, factor: float
) -> None:
    """Right moments of the pressure leave an error in L² alone."""
    forces, times = Forces(setup), np.array([0.3, 0.7])
    pressures = [face.exact.pressure(times).reshape(-1, len(times)) for face in forces.faces]
    moments = np.concatenate(
        [face.functions.T @ (face.weights[:, None] * p) for face, p in zip(forces.faces, pressures, strict=True)]
    )
    squares, sizes = forces.squares(times, factor * moments.T)
    np.testing.assert_allclose(np.sqrt(squares / sizes)[1:], factor - 1, rtol=1e-10, atol=3e-13)
    assert 0 < squares[0] < sizes[0]


def test_the_dual_norm_is_a_supremum(setup: Experiment) -> None:
    forces, rng = Forces(setup), np.random.default_rng(0)
    y, M, N = rng.standard_normal(setup.space.N.shape[0]), setup.problem.M, setup.space.N
    norm = np.sqrt(y @ forces.W @ y)
    quotients = [abs(y @ (N @ v)) / np.sqrt(v @ M @ v) for v in rng.standard_normal((50, setup.space.dofs))]
    assert max(quotients) < norm
    best = np.linalg.solve(M.toarray(), N.T @ y)
    assert y @ (N @ best) / np.sqrt(best @ M @ best) == pytest.approx(norm)


def test_time_steps_hardly_change_the_contact_force(setup: Experiment) -> None:
    found = measure_contact(setup)
    assert found["pressure_time_share"] < 0.1
    assert found["penetration"] < 1e-14


@pytest.mark.parametrize("peak", range(5))
def test_the_penetration_is_the_largest_one_of_all_times(setup: Experiment, peak: int, monkeypatch) -> None:
    forces, values = Forces(setup), np.where(np.arange(5) == peak, 3.0, 1.0)
    _, shallow, _ = with_penetrations(setup, forces, np.ones(5), monkeypatch)
    assert with_penetrations(setup, forces, values, monkeypatch)[1] == pytest.approx(3 * shallow)
    assert np.isnan(with_penetrations(setup, forces, np.where(values == 3, np.nan, 1.0), monkeypatch)[1])


def with_penetrations(setup: Experiment, forces: Forces, values, monkeypatch) -> tuple[np.ndarray, float, float]:
    """The errors in time if the penetrations at the nodes of time have these values."""
    left = iter(values)
    monkeypatch.setattr(Forces, "penetration", lambda self, u: next(left))
    return errors_in_time(setup, forces, len(values) - 1)
