"""The forces of a motion are in equilibrium; Problem 3.2 on the strains of V^h has the stresses of the motion."""

from dataclasses import replace

import numpy as np
import pytest
from changed import problems
from costly_cases import slow

from manufactured import named
from manufactured.law import NonSymmetric
from manufactured.tensors import mandel
from study.fem.error_norm import ErrorNorm
from study.fem.mesh import FAMILIES, OneDiagonal, Shaken, Unstructured
from study.fem.naming import resolve
from study.solve import stress_problem
from study.solve.motion import Motion, von_mises
from study.solve.steps import StepsError
from study.solve.stress_problem import Accuracy, StressError
from study.statements.thm_4_2 import gaps

CASES = ("advance-recede", "yield-and-release", "heterogeneous", "cube-disc")
RNG = np.random.default_rng(2002)


@pytest.mark.parametrize("case", CASES)
def test_stress_and_contact_forces_are_in_equilibrium_with_the_load(case):
    """To round-off or the tolerance of the fixed point."""
    solution = resolve(case).solution
    family, level = (Unstructured(), 6) if solution.body.dim == 2 else (FAMILIES[0], 3)
    motion = Motion.of(solution, family, level, 8)
    space = motion.space
    load = ErrorNorm(motion.solution, motion.space).load
    for frame in motion.frames[1:]:
        force = load(frame.time)
        defect = space.functional(frame.stress) + space.N.T @ frame.multipliers - force
        assert np.linalg.norm(defect) <= 1e-10 * np.linalg.norm(force)


def test_von_mises_is_that_of_principal_stresses_and_least_in_the_plane():
    """In the plane it is the smallest value for any stress across the plane, which is that for half of the trace."""
    stress = RNG.normal(size=(3, 3))
    stress += stress.T
    a, b, c = np.linalg.eigvalsh(stress)
    assert von_mises(mandel(stress)) == pytest.approx(np.sqrt(((a - b) ** 2 + (b - c) ** 2 + (c - a) ** 2) / 2))
    stress[2, :2] = stress[:2, 2] = 0.0
    stress[2, 2] = np.trace(stress[:2, :2]) / 2
    assert von_mises(mandel(stress[:2, :2])) == pytest.approx(von_mises(mandel(stress)))


@pytest.mark.parametrize("name", ["advance-recede", slow("yield-and-release")])
def test_what_the_duality_gap_allows_holds_for_a_solver_that_stops_early(name, monkeypatch):
    """With gaps of 1e-4 the solutions differ by 1e-6 and more of their size, and by no more than the gap allows."""
    monkeypatch.setattr(stress_problem, "AIM", Accuracy(1e-4, stress_problem.AIM.feasibility))
    found = gaps(*problems(named(name).solution, Shaken(), 6), steps=12)
    assert 1e-6 <= found.displacement_gap <= found.displacement_bound
    assert 1e-6 <= found.stress_gap <= found.stress_bound


def test_an_interior_point_that_rounding_breaks_off_is_asked_for_less(monkeypatch):
    """On a mesh on which the programme at t = T breaks off before its aim."""
    _, stresses = problems(named("yield-on-a-part").solution, Shaken(7), 4)
    assert len(list(stresses.march(8))) == 9
    monkeypatch.setattr(stress_problem, "ACCEPTED", stress_problem.AIM)
    with pytest.raises(StressError, match="was not solved"):
        list(stresses.march(8))


@pytest.mark.parametrize("name", ["advance-recede", "yield-and-release"])
def test_the_history_of_strains_is_compatible_though_it_knows_no_displacement(name):
    _, stresses = problems(named(name).solution, Shaken(), 6)
    for state in stresses.march(10):
        strain = stresses.space.strain(state.u)
        assert abs(state.strain - strain).max() <= 1e-7 * max(abs(strain).max(), 1e-3)


def test_a_law_without_a_known_potential_and_a_run_without_steps_are_refused():
    _, stresses = problems(named("advance-recede").solution, OneDiagonal(), 4)
    with pytest.raises(StepsError, match="one step or more"):
        list(stresses.march(0))

    without_potential = NonSymmetric([[1.0, 0.5, 0.0], [-0.5, 1.0, 0.0], [0.0, 0.0, 1.0]])
    strange = replace(stresses, law=replace(stresses.law, G=without_potential))
    with pytest.raises(StressError, match="complementary potential"):
        list(strange.march(2))


@pytest.mark.parametrize(("law", "u", "stress", "gap"), [(1, 4, 4, 16), (4, 1, 4, 4)])
def test_four_times_the_loads_or_all_forces_change_the_solution_and_its_duality_gap_in_their_units(law, u, stress, gap):
    """Powers of two change no digit."""
    _, one = problems(named("full-contact").solution, OneDiagonal(), 4)
    A, G = (replace(operator, matrix=law * operator.matrix) for operator in (one.law.A, one.law.G))
    stiffer = replace(one.law, A=A, G=G)
    other = replace(one, law=stiffer, load=lambda time: 4 * one.load(time), u0=u * one.u0)
    first, second = ([*each.march(2)][-1] for each in (one, other))
    assert second.u == pytest.approx(u * first.u, rel=1e-12)
    assert second.stress == pytest.approx(stress * first.stress, rel=1e-12)
    assert second.gap / first.gap == pytest.approx(gap)


def test_theorem_4_2_is_not_about_a_gap():
    with pytest.raises(StressError, match="initial gap"):
        problems(named("closing-gap").solution, OneDiagonal(), 4)
