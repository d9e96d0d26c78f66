"""Every fault is seen by the covering set of cases, and the judge names its cause; right answers have none."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import contact_judge as judge
import faults
import numpy as np
import pytest
import this_study
from judged_codes import exported, judged

PAGE = (Path(__file__).parents[2] / "docs" / "how-to" / "verify-a-contact-code.md").read_text(encoding="utf-8")
FAULTS = {fault.name: fault for fault in faults.FAULTS}


def in_page() -> dict[str, list[str]]:
    """Rows of the table of the page: fault ↦ cases that show it, in the order of the columns."""
    rows = [line.strip("| \n").split(" | ") for line in PAGE.splitlines() if " | " in line]
    (cases,) = ([cell.strip("*") for cell in row[1:]] for row in rows if row[0] == "fault")
    return {
        row[0]: [case for case, cell in zip(cases, row[1:], strict=True) if cell != "–"]
        for row in rows
        if row[0] in FAULTS
    }


def covering() -> tuple[str, ...]:
    """The covering set that the page names, computed again from its table."""
    table = in_page()
    cases = sorted({case for shown in table.values() for case in shown}, key=faults.CASES.index)
    return faults.covering({case: {name for name, shown in table.items() if case in shown} for case in cases})


def test_the_page_names_every_fault_and_the_smallest_set_of_cases_that_shows_all() -> None:
    assert set(in_page()) == set(FAULTS)
    assert f"Smallest set of cases that shows every fault: {', '.join(covering())}." in PAGE


@pytest.mark.parametrize("name", FAULTS)
def test_the_covering_set_shows_a_fault_and_the_judge_names_its_cause(name: str) -> None:
    fault, case = FAULTS[name], next(case for case in covering() if case in in_page()[name])
    found = judged(fault.make, exported(case))
    assert found.verdict != "exact for P1"
    assert found.outcome() != "holds"
    assert fault.cause in found.cause
    assert fault.cause or "Most likely" not in found.cause


@pytest.mark.slow
def test_the_table_of_the_page_is_measured() -> None:
    assert "\n".join(faults.table({case: exported(case) for case in faults.CASES})) in PAGE


# Time steps


def marched(task: Any, C: np.ndarray, H: np.ndarray, wrong_step: int = -1, load_late: bool = False) -> judge.Judgement:
    """What is found for a march with the stiffness C and the history H ε(u_{n−1}); in one step that of u_{n−2}."""
    other = judge.copy.copy(task)
    other.stiffness = C
    step, states = this_study.make(other), [task.start(), task.start()]
    for n in range(task.count):
        load, _ = task.step(max(n - load_late, 0), states[-1])
        before = states[-2] if n == wrong_step else states[-1]
        states.append(step(load, np.einsum("cij,cj->ci", H, task.strain(before))))
    (found,) = judge.assess([task], {task.name: np.array(states[2:])})
    return found


MARCHES: dict[str, tuple[Any, dict[str, Any]]] = {
    "the viscous stress is missing": (lambda A, G: (G, 0 * G), {}),
    "backward Euler is used": (lambda A, G: (A + G, -A), {}),
    "the stress of the previous step is missing": (lambda A, G: (A + G / 2, 0 * G), {}),
    "the stress of the previous step is counted twice": (lambda A, G: (A + G / 2, G - 2 * A), {}),
    "in step 3 alone the history is that of the step before last": (
        lambda A, G: (A + G / 2, G / 2 - A),
        {"wrong_step": 2},
    ),
    "the load of the step before is used": (lambda A, G: (A + G / 2, G / 2 - A), {"load_late": True}),
    "": (lambda A, G: (A + G / 2, G / 2 - A), {}),
}


@pytest.mark.parametrize("cause", MARCHES)
def test_a_fault_of_the_history_of_one_step_or_of_the_load_is_named(cause: str) -> None:
    """A is divided by the step; the last march is the midpoint rule."""
    task, (law, options) = exported("anisotropic", 4, steps=5), MARCHES[cause]
    found = marched(task, *law(task.A / task.data["step"], task.G), **options)
    if cause:
        assert f"Most likely: {cause}" in found.cause
    else:
        assert (found.verdict, found.cause) == ("exact for P1", "")


def forces_kept(W: np.ndarray, free: np.ndarray, memory: dict) -> np.ndarray:
    return memory.setdefault("kept", judge.active_set(W, free))


def vertices_kept(W: np.ndarray, free: np.ndarray, memory: dict) -> np.ndarray:
    return judge.active_set(W, free, memory.setdefault("held", judge.active_set(W, free) > 0), updates=0)


def not_in_the_first_step(W: np.ndarray, free: np.ndarray, memory: dict) -> np.ndarray:
    return judge.active_set(W, free) if memory.setdefault("step", []) or memory["step"].append(1) else 0 * free


FIRST_STEP = {
    "contact is missing in the first step": not_in_the_first_step,
    "the contact forces of the first step are kept in all steps": forces_kept,
    "the vertices in contact are found in the first step only and kept": vertices_kept,
}


@pytest.mark.parametrize("steps", [0, 4])
@pytest.mark.parametrize("cause", FIRST_STEP)
def test_contact_that_differs_in_the_first_step_is_named(cause: str, steps: int) -> None:
    found = judged(faults.in_contact(FIRST_STEP[cause]), exported("parabolic-gap", 8, steps=steps))
    assert cause in found.cause
    assert found.verdict == "wrong"


# Bodies that are moved or not held, and answers in another format


CLAMPS = {
    "component 1 is zero and component 2 is not, at all 5 vertices": faults.first_component_held,
    "u is not zero at 2 of 5 vertices": faults.misread(lambda task: {"clamped": task.clamped[::2]}),
}


@pytest.mark.parametrize("words", CLAMPS)
def test_a_body_that_is_not_held_on_the_clamped_part_is_wrong_and_the_line_says_where(words: str) -> None:
    found = judged(CLAMPS[words], exported("anisotropic", 4))
    assert found.verdict == "wrong"
    assert f"On Γ1 {words}" in found.cause
    assert "of n = 4" in found.cause
    assert "is not held" in found.why
    assert "Most likely" not in found.cause


@pytest.mark.parametrize(("case", "level"), [("layered", 4), ("cube-disc", 3)])
@pytest.mark.parametrize("steps", [0, 3])
@pytest.mark.parametrize("name", ["all u_x written before all u_y", "deformed coordinates written"])
def test_an_answer_that_is_not_in_the_expected_format_is_named_before_the_clamp(name, steps, case, level) -> None:
    found = judged(FAULTS[name].make, exported(case, level, steps=steps))
    assert f"Most likely: {FAULTS[name].cause}" in found.cause
    assert found.verdict == "wrong"


@pytest.mark.parametrize(("value", "text"), [(np.nan, "nan"), (-np.inf, "-inf"), (1e200, "1e+200")])
def test_a_single_value_that_is_no_displacement_is_named_and_no_singular_matrix(value: float, text: str) -> None:
    (task, u, *_), name = reported(), f"u_x of vertex 3 in step 2 is {text}"
    u[1, 3, 0] = value
    (found,) = judge.assess([task], {task.name: u})
    assert (found.verdict, "singular" in found.cause) == ("wrong", False)
    assert f"has 1 of {u.size} values that are not numbers or too large: {name}" in found.cause


@pytest.mark.parametrize(
    ("factor", "displacements", "stiffness"), [(1.00001, "1.00001", "0.99999"), (0.5, "0.5", "2"), (-1, "-1", "-1")]
)
def test_a_factor_has_the_digits_that_differ_from_one_and_gives_that_of_the_stiffness(
    factor: float, displacements: str, stiffness: str
) -> None:
    task, u, *_ = reported()
    (found,) = judge.assess([task], {task.name: factor * u})
    assert f"the displacements are {displacements} times the right ones (other units?)" in found.cause
    assert f"or the stiffness is {stiffness} times the right one (" in found.cause


# Causes


def test_a_code_whose_solver_stops_early_is_undecided_and_told_to_mend_it_first() -> None:
    noise = next(fault for fault in faults.FAULTS if fault.name.startswith("solver stopped"))
    found = judged(noise.make, exported("layered", 4), exported("layered"))
    assert found.verdict == "undecided"
    assert found.why.endswith("3 meshes are needed; first reduce the tolerance of the solver")


def test_a_certain_cause_is_wrong_on_two_meshes_and_a_consistent_method_is_not() -> None:
    tasks = exported("corner"), exported("corner", 4)
    found = judged(FAULTS["vertices never released"].make, *tasks)
    assert found.verdict == "wrong"
    assert found.why.startswith("vertices in contact are never released")
    where, line = judge.notes(found)
    assert "contact forces pull at" in where
    assert line.startswith("(equations with this fault reproduce the answer up to ")
    found = judged(faults.springs(lambda task: 30 / task.data["h"]), *tasks)
    assert found.verdict == "undecided"
    assert "order of the distance" in found.why


def test_the_last_line_names_the_cause_that_explains_most_cases() -> None:
    tasks = [exported(case, 4) for case in ("corner", "layered", "junction")]
    make = FAULTS["vertices never released"].make
    found = judge.assess(tasks, {task.name: judge.answer(task, make) for task in tasks})
    (line,) = judge.summary(found)
    assert line.startswith("2 of 3 cases: vertices in contact are never released")
    assert line.endswith("; junction cannot show it")
    assert judge.summary(found[:1]) == []


def of_law(change: Any) -> Any:
    return faults.misread(
        lambda task: {"stiffness": change(task.stiffness, np.array([[1, 1, 0], [1, 1, 0], [0, 0, 0]]))}
    )


def exchanged(C: np.ndarray, normal: np.ndarray) -> np.ndarray:
    lam, mu = C[:, :1, 1:2], C[:, 2:, 2:] / 2
    return 2 * lam * np.eye(3) + mu * normal


SHOWN: dict[str, tuple[Any, str]] = {
    "λ and μ are exchanged": (of_law(exchanged), "layered"),
    "the displacements are written with 4 digits": (
        faults.changed(lambda task, u, _: np.array([float(f"{x:.3e}") for x in u.ravel()]).reshape(u.shape)),
        "layered",
    ),
    "the load at 8 vertices": (faults.balance_with(lambda task, b: b * (task.vertices[:, :1] < 0.9)), "corner"),
    "the stiffness of 1 cell (5 at": (
        of_law(lambda C, normal: np.where(np.arange(len(C))[:, None, None] == 5, 3 * C, C)),
        "layered",
    ),
}


@pytest.mark.parametrize("cause", SHOWN)
def test_a_cause_is_shown_by_undoing_or_imitating_it(cause: str) -> None:
    make, case = SHOWN[cause]
    found = judged(make, exported(case, 8 if cause.startswith("the load") else 4))
    assert f"Most likely: {cause}" in found.cause


def test_components_of_shear_in_another_order_are_named_in_space() -> None:
    order = [0, 1, 2, 5, 3, 4]
    found = judged(faults.other_stress(lambda s: s[:, order]), exported("cube-two-faces", 3))
    assert "the components of shear have the order 12, 23, 13 in the initial stress" in found.cause


WHERE = {
    "a cell left out": ("layered", "at 3 of 25 vertices (of cell 9), in all 3 steps: "),
    "the load lost at a vertex of Γ2": ("layered", "at 1 of 25 vertices (all on Γ2), in all 3 steps"),
    "no slip in contact": (
        "layered",
        "vertices (all on Γ3 where contact forces act), in all 3 steps, all along ±(1, 0): ",
    ),
    "last step not solved": ("layered", "(9 inside, 6 on Γ2, 5 on Γ3), in step 3 alone: "),
    "`factor` forgotten": ("layered", "at 10 of 25 vertices (6 inside, 4 on Γ2, within [0, 1] × [0.5, 0.75]), in all"),
    "a pressure on Γ3 before contact": ("corner", "on Γ3, contact forces act where the gap is open at "),
    "contact forces halved": ("corner", "the body enters the foundation at "),
    "springs of 30, not scaled with *h*": ("corner", "; u_ν − gap ↦ force over area: "),
}


@pytest.mark.parametrize("name", WHERE)
def test_the_first_line_says_where_and_when_the_equations_are_violated(name: str) -> None:
    case, words = WHERE[name]
    found = judged(FAULTS[name].make, exported(case, 4))
    assert judge.notes(found)[0] == found.where
    assert found.where.startswith("n = 4: ")
    assert words in found.where


# What a code reports

REPORTED = {
    "agrees": lambda r: r,
    "has the reversed sign": lambda r: -r,
    "is 0.5 times the right one": lambda r: r / 2,
    "not all are numbers": lambda r: r * np.nan,
}
OTHERS: dict[str, Any] = {
    "is a force, expected force over area": lambda lam, mass: {"pressure": lam},
    "is a pressure, expected pressure times area": lambda lam, mass: {"forces": lam / mass},
    "no contact where a force acts": lambda lam, mass: {"status": 0 * lam},
    "contact where a gap is open": lambda lam, mass: {"status": 0 * lam + 1},
    "": lambda lam, mass: {"status": lam > 1e-9},
}


def reported() -> tuple[judge.Task, np.ndarray, np.ndarray, np.ndarray]:
    """A task, the right answer, and its contact forces with the areas of the vertices."""
    task = exported("layered", 4)
    u = judge.answer(task, this_study.make)
    return task, u, judge.Equations(task, u).lam, task.constraints()[2]


@pytest.mark.parametrize("sentence", REPORTED)
def test_what_a_code_reports_is_judged_with_a_sentence(sentence: str) -> None:
    task, u, lam, mass = reported()
    for name, value in {"forces": lam, "pressure": lam / mass, "resultant": task.sums(lam)}.items():
        (found,) = judge.assess([task], {task.name: u}, {task.name: {name: REPORTED[sentence](value)}})
        assert [(one.right, sentence in one.sentence) for one in found.reports] == [(sentence == "agrees", True)]
        assert found.outcome() == ("holds" if sentence == "agrees" else "fails")


@pytest.mark.parametrize("sentence", OTHERS)
def test_areas_and_status_of_a_report_are_judged(sentence: str) -> None:
    task, u, lam, mass = reported()
    (one,) = judge.judge_reports(task, u, OTHERS[sentence](lam, mass))
    assert (one.right, sentence in one.sentence) == (not sentence, True)
