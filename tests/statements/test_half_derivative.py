"""Half a derivative of the velocity, nodal errors of P_h, and the work at an advancing front: each check can fail."""

from dataclasses import replace
from itertools import count

import numpy as np
import pytest
import scipy.sparse as sps
from measured_rows import measured, verdicts

from manufactured.catalogue import NATURAL_MOTION
from study.fem.space import form
from study.ledger.verdict import FAILS, HOLDS
from study.solve.evolution import SemiDiscrete
from study.solve.signorini import Signorini
from study.statements import moving_fronts
from study.statements.moving_fronts import AdvancingFront, HalfDerivative, NodalErrors
from study.statements.shared.base import Setting, grid


def found(statement, *levels, case=NATURAL_MOTION, families=("one-diagonal",)):
    """Key ↦ verdict on what a statement measures."""
    return verdicts(statement, measured(statement, grid((case,), families, levels)))


def every_second_step(S, N):
    """A contact solver that imposes the constraint in every second step only."""
    contact = Signorini(S, N)
    free = Signorini(S, N[:0])
    calls = count()

    def solve(b):
        return contact(b) if next(calls) % 2 else (free(b)[0], np.zeros(N.shape[0]))

    return solve


class Bouncing(HalfDerivative):
    """The body is held by its foundation in every second step only, so that its velocity jumps back and forth."""

    def setup(self, setting):
        right = super().setup(setting)
        return replace(right, solved=replace(right.problem, solver=every_second_step))


@pytest.mark.parametrize(("statement", "verdict"), [(HalfDerivative(), HOLDS), (Bouncing(), FAILS)])
def test_velocities_without_half_a_derivative_are_noticed(statement, verdict):
    assert set(found(statement, 4, 8, 16, case="full-contact").values()) == {verdict}


def test_the_quotient_of_a_velocity_that_jumps_once_is_known():
    """u̇ = 1 up to T/2, then 0, with g = 1 and K = (−∞, T/2].

    So M = Ξ = 1, W = 0, C_2 = 3/2, and both sides are δ/2 and C_2 δ.
    """
    steps = 32
    times = np.linspace(0, 1, steps + 1)
    one, zero = (sps.csc_array([[value]]) for value in (1.0, 0.0))
    problem = SemiDiscrete(one, zero, None, one, lambda times: np.ones((1, times.size)), np.zeros(1), 1.0)
    states = np.minimum(times, 0.5)[:, None]
    assert moving_fronts.half_quotient(problem, states) == pytest.approx(1 / 3)


def test_nodal_errors_of_a_projection_in_another_norm_are_noticed(monkeypatch):
    assert found(NodalErrors(), 16) == {"constant": HOLDS}
    monkeypatch.setattr(moving_fronts, "form", lambda space, tensor: form(space, tensor) / 4)
    assert found(NodalErrors(), 16) == {"constant": FAILS}


def test_with_one_diagonal_the_nodal_errors_have_one_sign_and_shaken_meshes_are_needed_for_both():
    """The fault is a family of shaken meshes whose vertices do not move."""
    assert found(NodalErrors(), 32, families=("shaken", "shaken-1"))["sign"] == HOLDS
    plain = measured(NodalErrors(), [Setting(NATURAL_MOTION, "one-diagonal", 32)]).assign(family="shaken")
    assert verdicts(NodalErrors(), plain)["sign"] == FAILS


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "wrong", "key"),
    [
        ("Signorini", lambda M, N: Signorini(M, -N), "local"),
        ("front_at", lambda solution, time: 0.45, "pairing"),
    ],
)
def test_at_an_advancing_front_a_wrong_normal_or_a_front_at_rest_is_noticed(monkeypatch, name, wrong, key):
    monkeypatch.setattr(moving_fronts, "FROM", 8)
    assert found(AdvancingFront(), 8, 16)[key] == HOLDS
    monkeypatch.setattr(moving_fronts, name, wrong)
    assert found(AdvancingFront(), 8, 16)[key] == FAILS
