"""Every verdict on the contact force can come out otherwise, and its norms are the ones that they are called."""

import numpy as np
import pandas as pd
import pytest
from measured_rows import verdicts
from numpy.testing import assert_allclose

from study.ledger.verdict import FAILS, HOLDS, MISSED, UNCLAIMED, UNDECIDED
from study.solve.tableau import MIDPOINT
from study.statements.contact_force import ContactForce, Forces
from study.statements.shared.base import Experiment, Setting

LEVELS = np.array([8.0, 16.0, 32.0])
STATEMENT = ContactForce()


def table(case="a", family="one-diagonal", **changes):
    h = 1 / LEVELS
    place = {"case": case, "family": family, "level": LEVELS, "h": h}
    sizes = {"pressure": h**1.3, "dual": h**1.7, "resultant": h**2, "penetration": 1e-16, "pulling": 0.0, "clamped": 0}
    shares = {f"{force}_time_share": 0.1 for force in ("pressure", "dual", "resultant")}
    return pd.DataFrame({**place, **sizes, **shares, **changes})


def test_the_predicted_behaviour_holds_in_every_row_and_two_levels_leave_orders_undecided():
    assert set(verdicts(STATEMENT, pd.concat([table(), table(family="criss-cross")])).values()) == {HOLDS}
    found = verdicts(STATEMENT, table().iloc[:2])
    assert {key for key, verdict in found.items() if verdict == UNDECIDED} == {key for key in found if "order" in key}


@pytest.mark.parametrize("family", ["shaken", "unstructured"])
def test_on_irregular_meshes_a_low_order_of_the_pressure_is_a_missed_prediction_and_no_failure(family):
    found = verdicts(STATEMENT, pd.concat([table(), table(family=family, pressure=0.2)]))
    assert found.pop("order-pressure-irregular") == MISSED
    assert set(found.values()) == {HOLDS}
    # Of the dual norm order one is enough there, and less is not.
    found = [verdicts(STATEMENT, table(family="shaken", dual=LEVELS**-order)) for order in (1.0, 0.8)]
    assert [verdict["order-dual-other"] for verdict in found] == [HOLDS, FAILS]


@pytest.mark.parametrize(
    ("column", "value", "key"),
    [
        ("pressure", LEVELS**-0.8, "order-pressure"),
        ("pressure", LEVELS**-2.3, "order-pressure"),
        ("dual", LEVELS**-1.2, "order-dual-superclose"),
        ("resultant", LEVELS**-0.9, "order-resultant"),
        ("resultant", 0.06, "resultant"),
        ("dual_time_share", 0.51, "time-share"),
        ("penetration", 1e-9, "penetration"),
        ("penetration", np.nan, "penetration"),
        ("pulling", 1e-9, "pulling"),
    ],
)
def test_a_wrong_force_fails(column, value, key):
    assert verdicts(STATEMENT, table(**{column: value}))[key] == FAILS


@pytest.mark.parametrize(("name", "pieces"), [("hexagon", 2), ("contact-at-clamp", 1), ("layered", 0), ("corner", 0)])
def test_the_pieces_of_the_contact_side_that_meet_the_clamped_side_are_counted(name, pieces):
    assert Forces(Experiment.at(Setting(name, "unstructured", 4), MIDPOINT, 2)).clamped == pieces


def test_no_order_of_the_resultant_is_claimed_if_a_face_meets_the_clamped_side():
    found = verdicts(STATEMENT, table(clamped=1, resultant=1 / LEVELS**0.5))
    assert found["order-resultant"] == MISSED
    assert found["resultant"] not in UNCLAIMED
    for family, verdict in (("one-diagonal", FAILS), ("unstructured", MISSED)):
        found = verdicts(STATEMENT, table(family=family, clamped=1, dual=1 / LEVELS**0.5))
        assert verdict in [found.get("order-dual-superclose"), found.get("order-dual-other")]


@pytest.mark.parametrize("factor", [1.0, 1.2])
def test_forces_too_large_by_a_factor_are_wrong_by_it_in_the_dual_norm_and_the_resultant(factor):
    """Right moments of the pressure leave an error in L² alone."""
    setup = Experiment.at(Setting("full-contact", "one-diagonal", 4), MIDPOINT, 4)
    forces = Forces(setup)
    times = np.array([0.3, 0.7])
    pressures = [face.weights[:, None] * face.exact.pressure(times).reshape(-1, 2) for face in forces.faces]
    moments = np.concatenate([face.functions.T @ p for face, p in zip(forces.faces, pressures, strict=True)])
    squares, sizes = forces.squares(times, factor * moments.T)
    assert_allclose(np.sqrt(squares / sizes)[1:], factor - 1, rtol=1e-10, atol=3e-13)
    assert 0 < squares[0] < sizes[0]
