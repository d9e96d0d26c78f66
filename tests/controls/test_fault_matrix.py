"""Deliberate faults are measured as the matrix says, and each is the fault that its name promises."""

import math
from dataclasses import replace
from importlib.util import find_spec
from io import StringIO

import numpy as np
import pandas as pd
import pytest
from commands import python
from measures import close

from manufactured.law import isotropic_matrix
from study.controls.faults import FAULTS, axes_exchanged, exchanged, friction, shear_scaled, tangents
from study.controls.matrix import distance_of_solutions, measure_case, measured_on
from study.fem.naming import resolve
from study.ledger import controls
from study.ledger.files import UsageError
from study.solve.signorini import Signorini
from study.solve.tableau import MIDPOINT
from study.statements.shared.base import Experiment, Setting
from study.statements.shared.scope import regular

BY_NAME = {fault.name: fault for fault in FAULTS}
SEVERAL_KINDS = (
    "hexagon",
    "anisotropic",
    "layered",
    "load-w11",
    "yield-on-a-part",
    "parabolic-gap",
    "cube-two-faces",
)


def experiment(name, level=6):
    case = resolve(name)
    return Experiment.at(Setting(name, regular(case).name, level), MIDPOINT, 4)


def test_no_two_faults_have_one_name_and_sizes_fall():
    assert len(BY_NAME) == len(FAULTS)
    assert all(list(fault.sizes) == sorted(fault.sizes, reverse=True) for fault in FAULTS)


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_changes_what_is_solved_in_some_case_and_leaves_the_norm_alone(fault):
    for case in SEVERAL_KINDS:
        right = experiment(case)
        if np.any(right.problem.gap):
            # So that the gap differs from its reversed and from its sorted values.
            gap = right.problem.gap * np.linspace(1, 2, len(right.problem.gap))
            right = replace(right, problem=replace(right.problem, gap=gap))
        faulty = fault.change(right, fault.sizes[0])
        if faulty is None:
            continue
        if faulty.space is right.space:
            assert faulty.problem is right.problem
            assert faulty.v_norm is right.v_norm
        distance = distance_of_solutions(right, faulty)
        if math.isnan(distance) or distance > 1e-8:
            return
    pytest.fail(f"{fault.name} changes nothing in {', '.join(SEVERAL_KINDS)}")


@pytest.mark.parametrize("mu", [0.2, np.inf])
def test_friction_obeys_coulombs_law_at_every_vertex(mu):
    """|λ_τ| ≤ μ λ_ν; where it is less, nothing slides; and λ_τ opposes the sliding."""
    setup = experiment("corner", 8)
    solved = friction(setup, mu).solved
    S = setup.problem.M
    load = setup.problem.load(0.5)
    solver = solved.solver(S, setup.problem.N)
    u, pressure = solver(load)
    T, rows_of_N = tangents(setup.space, 1)
    shear = np.linalg.lstsq(T.toarray().T, load - S @ u - setup.problem.N.T @ pressure, rcond=None)[0]
    room = mu * pressure[rows_of_N] if np.isfinite(mu) else np.where(pressure[rows_of_N] > 0, np.inf, 0.0)
    slides = T @ u
    size = abs(pressure).max()
    assert (abs(shear) <= room + 1e-6 * size).all()
    stuck = abs(shear) < room - 1e-6 * size
    assert abs(slides[stuck]).max(initial=0.0) < 1e-9
    assert (shear * slides >= -1e-9 * size).all()


def test_without_friction_the_frictional_solver_is_the_right_one():
    setup = experiment("corner", 8)
    solver = friction(setup, 0.0).solved.solver(setup.problem.M, setup.problem.N)
    u, pressure = solver(load := setup.problem.load(0.7))
    v, right = Signorini(setup.problem.M, setup.problem.N)(load)
    assert close(u, v, 1e-9)
    assert close(pressure, right, 1e-9)


A = np.arange(9.0).reshape(3, 3)
B = np.diag([1.0, 2, 3, 4, 5, 6])


@pytest.mark.parametrize(
    ("change", "matrix", "size", "expected"),
    [
        (axes_exchanged, A, 1.0, [[4, 3, 5], [1, 0, 2], [7, 6, 8]]),
        (axes_exchanged, B, 1.0, np.diag([2.0, 1, 3, 5, 4, 6])),
        (shear_scaled, A, 1.0, [[0, 1, 4], [3, 4, 10], [12, 14, 32]]),
        (exchanged, isotropic_matrix(1, 3, 2), 1.0, isotropic_matrix(3, 1, 2)),
        (exchanged, isotropic_matrix(1, 3, 3), 0.5, isotropic_matrix(2, 2, 3)),
    ],
)
def test_faults_of_a_tensor_change_it_as_they_say(change, matrix, size, expected):
    assert change(matrix, size) == pytest.approx(np.array(expected))


FORCE = ["Prop. 5.4", "contact force", "Thm 4.2"]


@pytest.mark.parametrize(
    ("case", "labels", "coarsest"),
    [
        ("full-contact", FORCE, 4),
        ("cube-disc", FORCE, 3),
        ("parabolic-gap", ["beyond: initial gap"], 6),
        ("junction", ["Prop. 5.3", "Thm 4.2"], 4),
    ],
)
def test_a_case_meets_the_statements_about_it_on_levels_of_the_quick_study(case, labels, coarsest):
    every = measured_on(case)
    assert [one.statement.label for one in every] == labels
    assert every[-1].settings[0].level == coarsest
    assert len(every[0].settings) > 2


def test_vertices_that_are_never_released_stay_on_the_foundation_while_they_are_pulled():
    faulty = BY_NAME["no lift-off after contact"].change(experiment("advance-recede", 8), 1.0)
    states = [*faulty.march(8)]
    forces = np.array([state.multipliers for state in states])
    gaps = np.array([faulty.problem.N @ state.u for state in states])
    touched = np.cumsum(forces != 0, axis=0) > 0
    assert gaps[touched] == pytest.approx(0, abs=1e-12)
    assert gaps[~touched].max() < 1e-12
    assert forces.min() < 0


def test_the_matrix_tells_by_which_checks_and_in_which_cases_a_fault_is_noticed():
    chosen = ("no lift-off", "initial gap reversed")
    rows = pd.DataFrame(measure_case("advance-recede", chosen)).set_index(["fault", "size"])
    assert "order" in rows.loc[("no lift-off", 1.0), "by_error"]
    assert "Thm 4.2 displacement" in rows.loc[("no lift-off", 1.0), "by_others"]
    # There is no initial gap.
    assert "initial gap reversed" not in rows.index
    # Nothing lifts off: to forbid it is no fault here, and nothing can notice it.
    (same,) = measure_case("full-contact", ["no lift-off"])
    assert same["distance"] < 1e-9
    assert same["by_error"] == same["by_others"] == ""


def test_nothing_is_concluded_where_a_check_fails_without_a_fault(monkeypatch):
    for one in measured_on("full-contact"):
        assert one.failing() == []
    monkeypatch.setattr("study.controls.matrix.FAILS", "holds")
    with pytest.raises(UsageError, match=r"full-contact: without a fault these checks fail: .*order, "):
        measure_case("full-contact", [])


def matrix(rows):
    names = ["fault", "size", "case", "dim", "by_error", "by_others"]
    table = pd.read_csv(StringIO(rows), names=names, keep_default_na=False)
    return table.assign(
        equation="(2.5)", distance=1.0, error=1.0, single=table["fault"].str.contains("vertex").astype(int)
    )


@pytest.mark.parametrize(
    ("rows", "lacking"),
    {
        "f,0.1,a,2,order,\nf,0.1,b,2,order,": "none",
        "f,0.1,a,2,order,\nf,0.1,b,2,,force": "f, in the plane",
        "f,0.1,a,2,order,": "none",
        # Only the smallest size counts.
        "f,1,a,2,order,\nf,1,b,2,order,\nf,0.1,a,2,,\nf,0.1,b,2,,": "f, in the plane",
        "f,-1,a,2,order,\nf,-1,c,3,,": "f, in space",
        "one vertex,1,a,2,,force\none vertex,1,b,2,,force": "none",
        "one vertex,1,a,2,,\none vertex,1,b,2,,": "one vertex, in the plane",
        "one vertex,1,a,2,,Thm 4.2 stress\none vertex,1,b,2,,Thm 4.2 stress": "one vertex, in the plane",
    }.items(),
)
def test_a_fault_must_be_noticed_in_two_plane_cases_and_in_one_in_space(rows, lacking):
    assert controls.in_words(controls.missed(matrix(rows))) == lacking


OWN = """
from dataclasses import replace
from manufactured import named
own = replace(named("full-contact"), name="own")
"""


@pytest.mark.parametrize("own", [False, True])
def test_the_command_writes_the_matrix_and_continues(monkeypatch, tmp_path, out, told, own):
    (tmp_path / "own.py").write_text(OWN, encoding="utf-8")
    case = f"{tmp_path}/own.py:own" if own else "full-contact"
    command = f"faults --case {case} --fault 'no contact' --jobs 1 --out {out}"
    assert "noticed by errors" in told(command, 0)
    table = pd.read_csv(out / "data/faults.csv")
    assert table[["fault", "case"]].to_numpy().tolist() == [["no contact", "own" if own else "full-contact"]]
    monkeypatch.setattr("study.cli.controls.measure_case", None)  # nothing is measured again
    told(command, 0)


MARCH = """
from manufactured import named
from study.fem.error_norm import ErrorNorm
from study.fem.mesh import OneDiagonal
from study.fem.space import Space
solution = named("advance-recede").solution
space = Space(OneDiagonal()(solution.body, 4), solution.body)
v_norm = ErrorNorm(solution, space)
data = space, solution.law, v_norm.load, v_norm.sample(0.0).interpolant
from study.solve.stress_problem import StressProblem
*_, last = StressProblem(*data).march(8)
assert last.time == space.body.T
"""


def test_the_stress_problem_loads_no_solver_of_displacements_while_it_marches():
    """So it cannot call one, not even on a copy of the other problem, which no change of that one would show."""
    printed, _ = python(f"{MARCH}\nimport sys; print(*sys.modules)")
    loaded = set(printed.split())
    assert "clarabel" in loaded
    names = "signorini multigrid evolution tableau factorisation"
    solvers = {f"study.solve.{name}" for name in names.split()}
    assert all(map(find_spec, solvers))
    assert not loaded & solvers
