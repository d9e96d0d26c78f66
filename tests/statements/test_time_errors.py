"""O(h + k) for backward Euler with its constants, and what second-order schemes lose at landings."""

import math
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from measured_rows import measured, verdicts, wrong_values

from study.ledger.verdict import FAILS, HOLDS, UNCLAIMED
from study.solve.evolution import furthest, path
from study.solve.tableau import BACKWARD_EULER, BDF2, MIDPOINT
from study.statements import time_steps
from study.statements.shared.base import Setting, grid
from study.statements.time_steps import BackwardEuler, Landings, solution_of_two_unknowns, two_unknowns


@pytest.fixture(scope="module")
def in_time():
    """Errors on one mesh, as if three meshes had the same; the quick study measures all three."""
    rows = measured(BackwardEuler(), grid(("advance-recede",), ("shaken",), (4,)))
    return pd.concat([rows.assign(level=4 * n, h=rows["h"] / n) for n in (1, 2, 4)])


def test_backward_euler_is_judged_by_its_theorem(in_time):
    keys = ["data", "solution", "constant", "between", "midpoint", "order", "uniform", "reference"]
    assert verdicts(BackwardEuler(), in_time) == dict.fromkeys(keys, HOLDS)


@pytest.mark.parametrize(
    ("quantity", "factor", "key"),
    [
        ("4 by data", 11, "data"),
        ("256 by solution", 5, "solution"),
        ("256 constant", 7, "constant"),
        ("4 between", 0.2, "between"),
        ("4 between", 3, "between"),
        ("4 midpoint", 20, "midpoint"),
        ("4 error", 2, "order"),
        ("256 by data", "level", "uniform"),
        ("reference", 0, "reference"),
    ],
)
def test_every_row_about_backward_euler_can_fail(in_time, quantity, factor, key):
    assert verdicts(BackwardEuler(), wrong_values(in_time, quantity, factor))[key] == FAILS


def error_over_k(scheme, steps):
    problem = two_unknowns()
    exact = solution_of_two_unknowns(np.arange(steps + 1) / steps)
    return steps * furthest(problem, path(problem, scheme, steps), exact)


@pytest.mark.parametrize("scheme", [BACKWARD_EULER, MIDPOINT])
@pytest.mark.parametrize("j", [1, 2, 3, 4, 5, 6, 8, 10])
def test_two_unknowns_leave_second_order_schemes_the_order_one(scheme, j):
    """√2 (1 − θ)·3k/40 for a landing at (n + θ)k, θ ≥ 3/20, exactly."""
    theta = 0.4 * 2**j % 1
    assert error_over_k(scheme, 2**j) == pytest.approx(math.sqrt(2) * 0.075 * (1 - theta))


@pytest.mark.parametrize("steps", [32, 33, 64, 128, 256, 391, 512])
def test_two_unknowns_leave_bdf2_the_order_one_whatever_the_place_of_the_landing(steps):
    """√2 (17/80)(1 − 2θ)k or √2 (26θ − 9)k/80 after many steps, at least √2·17k/600."""
    theta = 0.4 * steps % 1
    left = 17 / 80 * (1 - 2 * theta) if theta <= 13 / 30 else (26 * theta - 9) / 80
    assert error_over_k(BDF2, steps) == pytest.approx(math.sqrt(2) * left)
    assert left >= 17 / 600


def test_landings_are_judged_and_a_scheme_without_loss_would_be_noticed(monkeypatch):
    """The problem with two unknowns takes the place of finite elements, whose orders are only reported."""
    monkeypatch.setattr(time_steps, "LANDING_STEPS", 1024)
    small = SimpleNamespace(problem=two_unknowns(), space=SimpleNamespace(dofs=2, h=0.25))
    monkeypatch.setattr(time_steps.Experiment, "at", lambda *given: small)
    monkeypatch.setattr(time_steps, "rolling", lambda space: small.problem.load)
    rows = measured(Landings(), [Setting("travelling-patch", "shaken", 4)])
    found = verdicts(Landings(), rows)
    assert [found.pop(f"{name}-two") for name in ("backward-euler", "midpoint")] == [HOLDS, HOLDS]
    assert {*found} == {f"{name}-{load}" for name in ("bdf2", "midpoint") for load in ("own", "rolling")}
    assert {*found.values()} <= {*UNCLAIMED}
    without_loss = wrong_values(rows, "two midpoint 1024", 1 / 8)
    assert verdicts(Landings(), without_loss)["midpoint-two"] == FAILS
