"""Theorem 4.2 on one mesh: the bounds are the proved ones, and no step is left out."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import pytest
from changed import problems

from study.fem.mesh import OneDiagonal
from study.fem.naming import resolve
from study.solve.stress_problem import StressProblem, StressState
from study.solve.tableau import BACKWARD_EULER
from study.statements.thm_4_2 import gaps

STEPS = 4
Change = Callable[[int, StressState], StressState]


@lru_cache
def both(name="full-contact"):
    return problems(resolve(name).solution, OneDiagonal(), 4)


@dataclass(frozen=True, eq=False)
class Changed(StressProblem):
    """Problem 3.2 whose states are reported with a change."""

    honest: StressProblem
    change: Change

    def march(self, steps):
        for n, state in enumerate(self.honest.march(steps)):
            yield self.change(n, state)


def found(change, name="full-contact"):
    displacements, honest = both(name)
    changed = Changed(honest.space, honest.law, honest.load, honest.u0, honest, change)
    return gaps(displacements, changed, STEPS)


@pytest.mark.parametrize(("name", "q"), [("full-contact", 1.0), ("softening", 4 / 3)])
def test_the_bounds_are_those_of_the_proof_for_the_duality_gaps_of_the_steps(name, q):
    """(q k)^{1/2} R and (L_A/k + L_G)^{1/2} R over the largest sizes by hand, R = Σ q^{N−n} g_n^{1/2}, kγ = 1 − 1/q."""
    displacements, stresses = both(name)
    law, space, k = stresses.law, stresses.space, displacements.T / STEPS
    before, size_u, size_s = displacements.u0, 0.0, 0.0
    for state in list(BACKWARD_EULER.march(displacements, STEPS))[1:]:
        strain, rate = space.strain(state.u), space.strain(state.u - before) / k
        sigma = law.A(rate) + law.G(strain)
        size_u = max(size_u, float(np.sqrt(np.einsum("In,In,n->", law.A(strain), strain, space.volumes))))
        size_s = max(size_s, float(np.sqrt(np.einsum("In,In,n->", sigma, sigma, space.volumes))))
        before = state.u
    largest = [float(abs(np.linalg.eigvalsh(tensor.matrix)).max()) for tensor in (law.A, law.G)]
    for left in ((1e-6, 0.0, 0.0, 0.0), (1e-8, 4e-8, 9e-8, 1.6e-7)):
        R = sum(q ** (STEPS - n) * np.sqrt(gap) for n, gap in enumerate(left, start=1))
        now = found(lambda n, state, left=left: replace(state, gap=left[n - 1] if n else 0.0), name)
        assert now.displacement_bound == pytest.approx(np.sqrt(q * k) * R / size_u, rel=1e-9)
        assert now.stress_bound == pytest.approx(np.sqrt(largest[0] / k + largest[1]) * R / size_s, rel=1e-9)


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
