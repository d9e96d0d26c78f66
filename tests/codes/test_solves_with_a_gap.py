"""Contact solves with N u ≤ g, and who refuses an initial gap."""

from __future__ import annotations

from dataclasses import replace

import faults
import numpy as np
import pytest
import this_study
from judged_codes import exported, judged, task

from manufactured import catalogue, named, s
from manufactured.data import Data
from study.bound.bounded import check_problem
from study.bound.problem import BoundError
from study.bound.trajectory import Refined
from study.fem.error_norm import gaps_at_vertices
from study.fem.mesh import OneDiagonal, Shaken, Unstructured
from study.fem.space import Space, form
from study.run.plan import Plan, full, quick
from study.run.tasks import frozen
from study.solve.multigrid import Multigrid
from study.solve.signorini import Signorini
from study.solve.stress_problem import StressError
from study.solve.tableau import MIDPOINT
from study.statements.initial_gap import InitialGap
from study.statements.pictures import Pictures
from study.statements.shared.experiment import Experiment
from study.statements.thm_4_2 import problems


def test_the_solution_satisfies_complementarity_with_the_gap_and_multigrid_finds_the_same() -> None:
    """On a cube, for a load that closes some gaps and opens others."""
    solution = named("cube-bowl").solution
    space = Space(Shaken()(solution.body, 6), solution.body)
    S, N, gap, x = form(space, solution.law.A), space.N, gaps_at_vertices(solution, space), space.free_points
    b = S @ np.random.default_rng(1).standard_normal(space.dofs)
    u, forces = Signorini(S, N, x, gap)(b)
    left = gap - N @ u
    assert S @ u + N.T @ forces == pytest.approx(b, abs=1e-10 * abs(b).max())
    assert left.min() >= -1e-12
    assert forces.min() >= 0
    assert abs(forces * left).max() <= 1e-12 * forces.max()
    assert 0 < np.count_nonzero(forces) < len(gap)
    found, pressed = Multigrid(S, N, x, 1e-11, gap)(b)
    assert found == pytest.approx(u, abs=1e-7 * abs(u).max())
    assert pressed == pytest.approx(forces, abs=1e-6 * forces.max())
    assert ((gap - N @ found) >= -1e-12).all()


def test_every_face_has_its_own_gap_in_the_order_of_the_constraints() -> None:
    solution = named("hexagon").solution
    faces = tuple(replace(face, initial_gap=(i + 1) * s**2) for i, face in enumerate(solution.faces))
    space = Space(Unstructured()(solution.body, 8), solution.body)
    wanted = [
        (i + 1) * np.linalg.norm(space.mesh.p[:, vertex] - part.start) ** 2
        for i, (part, vertices) in enumerate(space.contact)
        for vertex in vertices
    ]
    assert gaps_at_vertices(replace(solution, faces=faces), space) == pytest.approx(wanted)


def test_the_residual_of_a_step_knows_the_gap() -> None:
    setup = Experiment.of(named("parabolic-gap").solution, OneDiagonal(), 8, MIDPOINT, 4)
    assert max(state.residual() for state in setup.scheme.march(setup.problem, 4)) < 1e-10
    wrong = replace(setup.problem, gap=0.0)
    assert next(setup.scheme.march(wrong, 4)).u == pytest.approx(setup.problem.u0)
    step = setup.problem.stepper(MIDPOINT, 0.25)
    step.problem = wrong  # the residual of a correct step, with respect to the cone of the paper
    assert step(1, [setup.problem.initial()]).residual() > 1e-3


def test_theorem_4_2_is_not_about_a_gap() -> None:
    with pytest.raises(StressError, match="initial gap"):
        problems(named("closing-gap").solution, OneDiagonal(), 4)


def test_bounds_refuse_a_gap() -> None:
    with pytest.raises(BoundError, match="initial gap; give a problem"):
        check_problem(Data.of(named("closing-gap").solution), None, Refined(0, 1))


@pytest.mark.parametrize("scope", [quick, full])
def test_no_statement_but_its_own_is_measured_on_a_gap(scope) -> None:
    gaps = {case.name for case in catalogue() if case.solution.has_initial_gap}
    about = {type(job.statement) for job in Plan.of(scope()).jobs if getattr(job.setting, "case", None) in gaps}
    assert about == {InitialGap, Pictures}


@pytest.mark.parametrize("scale", [1.0, 10.0])
def test_a_task_has_the_gap_in_the_units_of_its_loads(scale: float) -> None:
    mine = task("parabolic-gap", 4)
    (piece,) = frozen(mine, (0.5,), scale)["contact"]
    x = mine.space.mesh.p[0, piece["vertices"]]
    assert piece["gap"] == pytest.approx(scale * 2 * (x - 0.5) ** 2)
    assert "gap" not in frozen(task("full-contact", 4), (0.5,))["contact"][0]


def test_our_adapter_solves_a_task_with_a_gap_and_the_judge_names_a_gap_that_is_forgotten_or_reversed() -> None:
    tasks = [exported("parabolic-gap", n) for n in (8, 16)]
    assert judged(this_study.make, *tasks).verdict == "exact for P1"
    causes = {0.0: "the initial gap is forgotten", -1.0: "the initial gap is taken with the reversed sign"}
    for factor, cause in causes.items():
        found = judged(faults.gap_times(factor), *tasks)
        assert found.verdict not in ("exact for P1", "consistent")
        assert cause in found.cause
