"""Theorem 4.2 on one mesh: the bounds are the proved ones, and no step is left out."""

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from changed import overridden, problems

from study.fem.mesh import OneDiagonal
from study.fem.naming import resolve
from study.solve.evolution import norm
from study.statements.thm_4_2 import gaps

STEPS = 4


@lru_cache
def both(name="full-contact"):
    return problems(resolve(name).solution, OneDiagonal(), 4)


def found(change, name="full-contact"):
    """What is found if Problem 3.2 reports its states with a change."""
    displacements, honest = both(name)

    def march(steps):
        for n, state in enumerate(honest.march(steps)):
            yield change(n, state)

    return gaps(displacements, overridden(replace(honest), march=march), STEPS)


@pytest.mark.parametrize(("name", "q"), [("full-contact", 1.0), ("softening", 4 / 3)])
def test_the_bounds_are_those_of_the_proof_for_the_duality_gaps_of_the_steps(name, q):
    """(q k)^{1/2} R and (L_A/k + L_G)^{1/2} R over the largest sizes, R = Σ q^{N−n} g_n^{1/2}, kγ = 1 − 1/q."""
    displacements, honest = both(name)
    law = honest.law
    k = displacements.T / STEPS
    states = [*honest.march(STEPS)][1:]
    size_u = max(norm(displacements, state.u) for state in states)
    size_s = max(np.linalg.norm(np.sqrt(honest.space.volumes) * state.stress) for state in states)
    for left in ((1e-6, 0.0, 0.0, 0.0), (1e-8, 4e-8, 9e-8, 1.6e-7)):
        R = np.polyval(np.sqrt(left), q)
        now = found(lambda n, state, left=left: replace(state, gap=left[n - 1] if n else 0.0), name)
        assert now.displacement_bound == pytest.approx(np.sqrt(q * k) * R / size_u)
        assert now.stress_bound == pytest.approx(np.sqrt(law.A.lipschitz / k + law.G.lipschitz) * R / size_s)


@pytest.mark.parametrize("step", [None, *range(1, STEPS + 1)])
@pytest.mark.parametrize(
    ("what", "seen_by"),
    [
        ("u", {"displacement_gap", "energy_gap", "membership"}),
        ("stress", {"stress_gap", "admissibility", "energy_gap"}),
    ],
)
def test_no_step_is_left_out(step, what, seen_by):
    """1 % of random numbers in the displacement or the stress of one step."""

    def off(n, state):
        value = getattr(state, what)
        noise = np.random.default_rng(n).standard_normal(value.shape) * abs(value).max()
        return replace(state, **{what: value + 0.01 * noise}) if n == step else state

    seen = {name for name, value in found(off)._asdict().items() if value > 1e-6}
    assert seen == (seen_by if step else set())
