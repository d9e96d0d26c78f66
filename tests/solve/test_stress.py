"""Problem 3.2 on the strains of V^h: Theorem 4.2, seen on the discrete level."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from manufactured import named
from study.fem.mesh import OneDiagonal, Shaken
from study.solve import stress_problem
from study.solve.evolution import SemiDiscrete
from study.solve.interior_point import Accuracy
from study.solve.steps import StepsError
from study.solve.stress_problem import StressError, StressProblem
from study.statements.shared.base import Setting
from study.statements.thm_4_2 import StandsAlone, beyond, gaps, problems


def case_on(name: str, family, n: int) -> tuple[SemiDiscrete, StressProblem]:
    return problems(named(name).solution, family, n)


@pytest.mark.parametrize("family", [OneDiagonal(), Shaken()], ids=lambda f: f.name)
@pytest.mark.parametrize(
    "name",
    [
        *("advance-recede", "yield-on-a-part"),
        *(pytest.param(name, marks=pytest.mark.slow) for name in ("travelling-patch", "yield-and-release")),
    ],
)
def test_both_problems_have_one_solution_at_every_step(name: str, family) -> None:
    """Linear law and law (3.3) with both balls; u ∈ K^h, (4.14) and σ ∈ Σ^h come out without being imposed."""
    found = gaps(*case_on(name, family, 6), steps=12)
    assert max(found.admissibility, found.energy_gap, found.membership) <= 1e-7
    assert found.displacement_gap <= found.displacement_bound <= 1e-5
    assert found.stress_gap <= found.stress_bound <= 1e-5


@pytest.mark.parametrize("name", ["advance-recede", pytest.param("yield-and-release", marks=pytest.mark.slow)])
def test_what_the_duality_gap_allows_holds_for_a_solver_that_stops_early(name: str, monkeypatch) -> None:
    """With gaps of 1e-4 the solutions differ by 1e-6 and more of their size, and by no more than the gap allows."""
    monkeypatch.setattr(stress_problem, "AIM", Accuracy(1e-4, stress_problem.AIM.feasibility))
    found = gaps(*case_on(name, Shaken(), 6), steps=12)
    assert 1e-6 <= found.displacement_gap <= found.displacement_bound
    assert 1e-6 <= found.stress_gap <= found.stress_bound


def test_an_interior_point_that_rounding_breaks_off_is_asked_for_less(monkeypatch) -> None:
    """With a mistake in Problem 3.1 alone, on a mesh on which the programme at t = T breaks off before its aim."""
    setting = Setting("yield-on-a-part", "shaken-7", 4)
    assert StandsAlone().measure(setting)["stress_shown"] == pytest.approx(1, abs=1e-6)
    monkeypatch.setattr(stress_problem, "ENOUGH", stress_problem.AIM)
    with pytest.raises(StressError, match="was not solved"):
        StandsAlone().measure(setting)


@pytest.mark.parametrize("name", ["advance-recede", "yield-and-release"])
def test_the_history_of_strains_is_compatible_though_it_knows_no_displacement(name: str) -> None:
    _, stresses = case_on(name, Shaken(), 6)
    for state in stresses.march(10):
        strain = stresses.space.strain(state.u)
        assert abs(state.strain - strain).max() <= 1e-7 * max(abs(strain).max(), 1e-3)


def test_the_distance_from_the_admissible_set_is_zero_for_contact_forces_only() -> None:
    displacements, _ = case_on("advance-recede", OneDiagonal(), 4)
    N = displacements.N
    push = np.linspace(0, 1, N.shape[0])
    assert beyond(N.T @ push, N) <= 1e-12
    assert beyond(-(N.T @ push), N) > 0.1
    sideways = np.zeros(N.shape[1])
    sideways[0] = 1.0
    assert beyond(sideways, N) == pytest.approx(1.0)


def test_a_law_without_a_known_potential_and_a_run_without_steps_are_refused() -> None:
    _, stresses = case_on("advance-recede", OneDiagonal(), 4)
    with pytest.raises(StepsError, match="one step or more"):
        list(stresses.march(0))

    class Other:
        dim, lipschitz, monotonicity, reference = 2, 1.0, 0.0, np.eye(3)

    strange = replace(stresses, law=replace(stresses.law, G=Other()))
    with pytest.raises(StressError, match="complementary potential"):
        list(strange.march(2))


def test_theorem_4_2_is_not_about_a_gap() -> None:
    with pytest.raises(StressError, match="initial gap"):
        problems(named("closing-gap").solution, OneDiagonal(), 4)
