"""Every fault is seen by the covering set of cases, and the judge names its cause; right answers have none."""

import re
from io import StringIO

import contact_judge as judge
import faults
import numpy as np
import pandas as pd
import pytest
import this_study
from judged_codes import answers, assessed, exported, judged
from places import CODES

PAGE = (CODES / "faults.md").read_text(encoding="utf-8")
FAULTS = {fault.name: fault for fault in faults.FAULTS}


def in_page():
    """The table of the page: whether a case, in a column, shows a fault, in a row."""
    rows = [line.strip("| ") for line in PAGE.splitlines() if " | " in line]
    table = pd.read_csv(StringIO("\n".join(rows)), sep=r" \| ", engine="python", index_col=0)
    return table.drop("---").rename(columns=lambda name: name.strip("*")) != "–"


SHOWN = in_page()
COVERING = faults.covering({case: set(SHOWN.index[SHOWN[case]]) for case in faults.CASES})
"""The covering set that the page names, computed again from its table."""


def test_the_page_names_every_fault_and_the_smallest_set_of_cases_that_shows_all():
    assert set(SHOWN.index) == set(FAULTS)
    assert f"Smallest set of cases that shows every fault: {', '.join(COVERING)}." in PAGE


@pytest.mark.parametrize("name", FAULTS)
def test_the_covering_set_shows_a_fault_and_the_judge_names_its_cause(name):
    fault = FAULTS[name]
    case = next(case for case in COVERING if SHOWN.at[name, case])
    found = judged(fault.make, exported(case))
    assert found.verdict != "exact for P1"
    assert found.outcome() != "holds"
    assert fault.cause in found.cause
    assert fault.cause or "Most likely" not in found.cause


@pytest.mark.slow
def test_the_table_of_the_page_is_measured():
    assert "\n".join(faults.table({case: exported(case) for case in faults.CASES})) in PAGE


# Time steps


def marched(task, C, H, wrong_steps=(), late=0):
    """What is found for a march with the stiffness C and the history H ε(u_{n−1}); in some steps that of u_{n−2}."""
    other = judge.copy.copy(task)
    other.stiffness = C
    step = this_study.make(other)
    states = [task.start(), task.start()]
    for n in range(task.count):
        load, _ = task.step(np.clip(n - late, 0, task.count - 1), states[-1])
        before = states[-2] if n in wrong_steps else states[-1]
        states.append(step(load, np.einsum("cij,cj->ci", H, task.strain(before))))
    return assessed(task, states[2:])


def midpoint(A, G):
    return A + G / 2, G / 2 - A


MARCHES = {
    "the viscous stress is missing": (lambda A, G: (G, 0 * G), {}),
    "θ = 1/2 of the time scheme (1 in backward Euler) is counted twice": (lambda A, G: (A + G, -A), {}),
    "the viscous stress A ε(u̇) (or 1/k) is halved": (lambda A, G: midpoint(A / 2, G), {}),
    "the stress of the previous step is missing": (lambda A, G: (A + G / 2, 0 * G), {}),
    "the stress of the previous step is counted twice": (lambda A, G: (A + G / 2, G - 2 * A), {}),
    "in step 3 alone the history is that of the step before last": (midpoint, {"wrong_steps": (2,)}),
    "in steps 3, 5 the history is that of the step before last": (midpoint, {"wrong_steps": (2, 4)}),
    "the load of the step before is used": (midpoint, {"late": 1}),
    "the load of the next step is used": (midpoint, {"late": -1}),
    "": (midpoint, {}),
}


@pytest.mark.parametrize("cause", MARCHES)
def test_a_fault_of_the_history_of_one_step_or_of_the_load_is_named(cause):
    """A is divided by the step; the last march is the midpoint rule."""
    task = exported("anisotropic", 4, steps=5)
    law, options = MARCHES[cause]
    found = marched(task, *law(task.A / task.data["step"], task.G), **options)
    if cause:
        assert f"Most likely: {cause}" in found.cause
    else:
        assert found.verdict == "exact for P1"
        assert found.cause == ""


# Contact that differs in the first step


def forces_kept(W, free, memory):
    return memory.setdefault("kept", judge.active_set(W, free))


def vertices_kept(W, free, memory):
    return judge.active_set(W, free, memory.setdefault("held", judge.active_set(W, free) > 0), updates=0)


def not_in_the_first_step(W, free, memory):
    return judge.active_set(W, free) if memory.setdefault("step", []) or memory["step"].append(1) else 0 * free


# Single values, and factors


@pytest.mark.parametrize(("value", "text"), [(np.nan, "nan"), (-np.inf, "-inf"), (1e200, "1e+200")])
def test_a_single_value_that_is_no_displacement_is_named_and_no_singular_matrix(value, text):
    task, u, *_ = reported()
    name = f"u_x of vertex 3 in step 2 is {text}"
    u[1, 3, 0] = value
    found = assessed(task, u)
    assert found.verdict == "wrong"
    assert "singular" not in found.cause
    assert f"has values that are not numbers or too large (1): {name}" in found.cause


@pytest.mark.parametrize(
    ("factor", "displacements", "stiffness"), [(1.00001, "1.00001", "0.99999"), (0.5, "0.5", "2"), (-1, "-1", "-1")]
)
def test_a_factor_has_the_digits_that_differ_from_one_and_gives_that_of_the_stiffness(factor, displacements, stiffness):
    task, u, *_ = reported()
    found = assessed(task, factor * u)
    assert f"the displacements are {displacements} times the right ones (other units?)" in found.cause
    assert f"or the stiffness is {stiffness} times the right one (" in found.cause


# Causes


def two_faults(task):
    """The initial stress is reversed and the stiffness has another coupling: no cause that is tried is right."""
    coupling = np.array([[1.0, 1.3, 1.0], [1.3, 0.8, 1.0], [1.0, 1.0, 1.1]])
    step = faults.misread(lambda task: {"stiffness": task.stiffness * coupling})(task)
    return lambda load, stress: step(load, -0.5 * stress)


def of_law(change):
    normal = np.array([[1, 1, 0], [1, 1, 0], [0, 0, 0]])
    return faults.misread(lambda task: {"stiffness": change(task.stiffness, normal)})


def exchanged(C, normal):
    lam = C[:, :1, 1:2]
    mu = C[:, 2:, 2:] / 2
    return 2 * lam * np.eye(3) + mu * normal


def four_digits(task, u, _):
    return np.array([float(f"{x:.3e}") for x in u.ravel()]).reshape(u.shape)


FLAT = "layered", 4
SOLID = "cube-disc", 3
NOT_HELD = "component 2 is not held, the matrix is singular or nearly so"
SHEARS = "the components of shear have the order 12, 23, 13 in the initial stress"
CAUSES = [
    *(
        (cause, faults.in_contact(fault), ("parabolic-gap", 8, steps))
        for steps in (0, 4)
        for cause, fault in (
            ("contact is missing in the first step", not_in_the_first_step),
            ("the contact forces of the first step are kept in all steps", forces_kept),
            ("the vertices in contact are found in the first step only and kept", vertices_kept),
        )
    ),
    # Where the body is not held, nothing else is said.
    *(
        (f"On Γ1 {what} at {count} vertices.*of n = 4.*is not held", make, ("anisotropic", 4))
        for what, count, make in (
            ("component 2 is not zero", 5, faults.first_component_held),
            ("u is not zero", 2, FAULTS["only every second vertex on Γ1 held"].make),
        )
    ),
    *((NOT_HELD, faults.first_component_held, case) for case in (FLAT, ("rotated", 4))),
    # Before the clamp, a format is named.
    *(
        (f"Most likely: {re.escape(FAULTS[name].cause)}", FAULTS[name].make, (*case, steps))
        for name in ("all u_x written before all u_y", "deformed coordinates written")
        for case in (FLAT, SOLID)
        for steps in (0, 3)
    ),
    (
        "not a number in step 1; the matrix is probably singular: the body is not held, or one",
        faults.changed(lambda task, u, _: np.nan * u),
        ("corner", 4),
    ),
    ("perhaps u is not held, or the vertices are in", faults.changed(lambda task, u, _: u[::-1]), FLAT),
    ("^Not explained", two_faults, FLAT),
    ("Most likely: λ and μ are exchanged", of_law(exchanged), FLAT),
    (SHEARS, faults.other_stress(lambda s: s[:, [0, 1, 2, 5, 3, 4]]), ("cube-two-faces", 3)),
    ("Most likely: the displacements are written with 4 digits", faults.changed(four_digits), FLAT),
    ("Most likely: the mesh is mirrored in x", lambda task: this_study.make(task.moved(task.vertices * [-1, 1])), FLAT),
    (
        "Most likely: the vertices of the answer are in another order: sorted",
        faults.changed(lambda task, u, _: u[np.lexsort(task.vertices.T)]),
        ("rotated", 4),
    ),
    (
        "Most likely: the load at 8 vertices",
        faults.balance_with(lambda task, b: b * (task.vertices[:, :1] < 0.9)),
        ("corner", 8),
    ),
    (
        r"Most likely: the stiffness of 1 cell \(5 at",
        of_law(lambda C, normal: np.where(np.arange(len(C))[:, None, None] == 5, 3 * C, C)),
        FLAT,
    ),
]


@pytest.mark.parametrize(("words", "make", "case"), CAUSES)
def test_a_cause_is_shown_by_undoing_or_imitating_it_and_named(words, make, case):
    found = judged(make, exported(*case))
    assert re.search(words, found.cause)
    uncertain = words.startswith("^Not explained") or "digits" in words
    assert found.verdict == ("undecided" if uncertain else "wrong")
    if "not held" in words:
        assert judge.notes(found) == [found.cause]
        assert "Most likely" not in found.cause


def projected_gauss_seidel(W, free, _):
    """λ after a few sweeps, which are too few."""
    lam = np.zeros(len(free))
    for _ in range(5):
        for i in range(len(free)):
            lam[i] = max(0, lam[i] + (free[i] - W[i] @ lam) / W[i, i])
    return lam


STOPPED = next(fault.make for fault in faults.FAULTS if fault.name.startswith("solver stopped"))


@pytest.mark.parametrize(
    ("words", "make", "levels", "verdict"),
    [
        ("Perhaps: the solver stops too early", STOPPED, (4, 8), "undecided"),
        (
            "Perhaps: the iterations for contact stop too early",
            faults.in_contact(projected_gauss_seidel),
            (4, 8),
            "undecided",
        ),
        ("springs", faults.springs(lambda task: 30 / task.data["h"]), (4, 8, 16), "consistent"),
    ],
)
def test_a_solver_that_stops_early_and_the_springs_of_a_consistent_code_are_named(words, make, levels, verdict):
    found = judged(make, *(exported("layered", n) for n in levels))
    assert found.verdict == verdict
    assert words in found.cause


def test_a_certain_fault_is_wrong_on_three_meshes_although_the_distance_falls():
    def half(task):
        first, *others = task.data["contact"]
        vertices = np.array(first["vertices"])
        left = task.vertices[vertices, 0] < 0.5
        part = {"vertices": vertices[left].tolist(), "gap": task.gaps()[0][left].tolist()}
        return {"data": {**task.data, "contact": [first | part, *others]}}

    tasks = [exported("layered", n) for n in (4, 8, 16)]
    found = judged(faults.misread(half), *tasks)
    assert found.order_of_distance > judge.FALLS
    assert found.verdict == "wrong"
    assert "the constraint is forgotten at 3 vertices" in found.cause
    assert judged(FAULTS["mean gap of each facet"].make, *tasks).verdict == "consistent"


def test_the_last_line_names_the_cause_that_explains_most_cases():
    tasks = [exported(case, 4) for case in ("corner", "layered", "junction")]
    make = FAULTS["vertices never released"].make
    found = judge.assess(tasks, answers(make, tasks))
    (line,) = judge.summary(found)
    assert line.startswith("2 of 3 cases: vertices in contact are never released")
    assert line.endswith("; junction cannot show it")
    assert judge.summary(found[:1]) == []


def test_the_gap_of_the_step_before_is_named():
    task = exported("parabolic-gap", 4, steps=5)
    states = [task.start()]
    for n in range(task.count):
        left = -task.distances(states[-1][None])[0]
        step = faults.misread(lambda task, left=left: {"gaps": lambda: [left]})(task)
        states.append(step(*task.step(n, states[-1])))
    found = assessed(task, states[1:])
    assert "Most likely: the gap that the step before left is taken for the initial gap" in found.cause


WHERE = {
    "a cell left out": ("layered", "at 3 of 25 vertices (of cell 9), in all 3 steps: "),
    "the load lost at a vertex of Γ2": ("layered", "at 1 of 25 vertices (all on Γ2), in all 3 steps"),
    "no slip in contact": (
        "layered",
        "vertices (all on Γ3 where contact forces act), in all 3 steps, all along ±(1, 0): ",
    ),
    "last step not solved": ("layered", "(9 inside, 6 on Γ2, 5 on Γ3), in step 3 alone: "),
    "`factor` forgotten": ("layered", "at 10 of 25 vertices (6 inside, 4 on Γ2, from (0, 0.5) to (1, 0.75)), in all"),
    "a pressure on Γ3 before contact": ("corner", "on Γ3, contact forces act where the gap is open at "),
    "contact forces halved": ("corner", "the body enters the foundation at "),
    "springs of 30, not scaled with *h*": ("corner", "; u_ν − gap ↦ force over area: "),
}


@pytest.mark.parametrize("name", WHERE)
def test_the_first_line_says_where_and_when_the_equations_are_violated(name):
    case, words = WHERE[name]
    found = judged(FAULTS[name].make, exported(case, 4))
    assert judge.notes(found)[0] == found.where
    assert found.where.startswith("n = 4: ")
    assert words in found.where


ROUNDED = {
    "a missing cell": (
        faults.misread(lambda task: {"volumes": np.append(task.volumes[:-1], 0)}),
        "anisotropic",
        "remain outside the cells at Γ3; order of the distance",
    ),
    "contact one step late in a march": (
        faults.in_contact(lambda W, free, memory: 1.000001 * faults.late(W, free, memory)),
        "layered",
        "fits better than a distance that vanishes, order of the",
    ),
}


@pytest.mark.parametrize("name", ROUNDED)
def test_no_class_is_consistent_while_a_fault_fits_better_than_a_vanishing_distance(name):
    """The answer has an error of 1e-7 or 1e-6, so that the fault is likely, but not certain."""
    make, case, why = ROUNDED[name]
    marches = name.endswith("march")
    tasks = [exported(case, n, steps=n * marches) for n in (4, 8, 16)]
    found = answers(make, tasks)
    for task in tasks:
        free = ~np.isin(np.arange(len(task.vertices)), task.clamped)[:, None]
        found[task.name] = found[task.name] + (0 if marches else 1e-7 * free * np.sin(1e5 * task.vertices))
    (one,) = judge.assess(tasks, found)
    assert one.verdict == "undecided"
    assert why in one.why
    assert "Most likely: " in one.cause


# What a code reports

REPORTED = {
    "agrees": lambda r: r,
    "has the reversed sign": lambda r: -r,
    "is halved": lambda r: r / 2,
    "not all are numbers": lambda r: r * np.nan,
}
OTHERS = {
    "is a force, expected force over area": lambda lam, mass: {"pressure": lam},
    "is a pressure, expected pressure times area": lambda lam, mass: {"forces": lam / mass},
    "no contact where a force acts": lambda lam, mass: {"status": 0 * lam},
    "contact where a gap is open": lambda lam, mass: {"status": 0 * lam + 1},
    "": lambda lam, mass: {"status": lam > 1e-9},
}


def reported():
    """A task, the right answer, and its contact forces with the areas of the vertices."""
    task = exported("layered", 4)
    u = judge.answer(task, this_study.make)
    return task, u, judge.Equations(task, u).lam, task.constraints()[2]


@pytest.mark.parametrize("sentence", REPORTED)
def test_what_a_code_reports_is_judged_with_a_sentence(sentence):
    task, u, lam, mass = reported()
    for name, value in {"forces": lam, "pressure": lam / mass, "resultant": task.sums(lam)}.items():
        found = assessed(task, u, **{name: REPORTED[sentence](value)})
        assert [(one.right, sentence in one.sentence) for one in found.reports] == [(sentence == "agrees", True)]
        assert found.outcome() == ("holds" if sentence == "agrees" else "fails")


def test_a_wrong_report_shows_in_the_line_of_the_class_and_names_its_mesh():
    task, u, lam, mass = reported()
    one_facet = np.where(mass > 0.75 * mass.max(), mass / 2, mass)
    found = assessed(task, u, pressure=lam / one_facet)
    assert "exact for P1" in judge.table([found])
    assert ", fails: wrong reported pressure" in judge.table([found]).splitlines()[1]
    assert "n = 4: reported pressure: it takes the area of one facet at each vertex, where" in judge.table([found])


@pytest.mark.parametrize("sentence", OTHERS)
def test_areas_and_status_of_a_report_are_judged(sentence):
    task, u, lam, mass = reported()
    (one,) = judge.judge_reports(task, u, OTHERS[sentence](lam, mass))
    assert one.right == (not sentence)
    assert sentence in one.sentence
