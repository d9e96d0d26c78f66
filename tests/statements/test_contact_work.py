"""The work of contact: the lemma on one edge, its rows, and what must break them."""

import numpy as np
import pandas as pd
import pytest
from measured_rows import invented, measured

from manufactured.exact import FaceFields
from study.fem.naming import resolve
from study.ledger.verdict import FAILS, HOLDS, REPORTED, UNDECIDED
from study.statements.shared.base import Setting, grid
from study.statements.shared.meshes import space_of
from study.statements.work_of_contact import (
    BRANCHES,
    C_0,
    EQUAL_BRANCHES,
    FIRST,
    OF_ALL,
    OVERALL,
    SECOND,
    SEMINORM_PANELS,
    WORK,
    EdgeWork,
    Resolved,
    TotalWork,
    WorkOfContact,
    beta,
    gram,
    least_depth,
    pressing_on,
    seminorm,
    supremum,
    vertices_on,
)

GRID = "one-diagonal"
RHO = 0.05, 0.25, 0.5


def test_a_cell_is_as_deep_as_the_thinnest_contact_data_in_it_and_other_cells_have_none():
    """Of the trains, the j-th lies on the j-th seventh of the bottom, with data up to ℓ/4 = 2^{−(j + 5)} inside."""
    solution = resolve("trains").solution
    first, second = (face.part.start[0] + face.part.measure / 2 for face in solution.faces[:2])
    places = (first, 0.0), (first, 2.0**-5), (second, 2.0**-6 - 1e-9)
    corners = [[[x, x + 0.01, x], [y, y, y + 1e-3]] for x, y in places]
    depths = least_depth(solution, np.moveaxis(corners, 0, -1))
    assert depths == pytest.approx([2.0**-5, np.inf, 2.0**-6])


@pytest.mark.parametrize("rho", RHO)
def test_the_seminorm_of_a_straight_line_is_known_and_hat_functions_have_the_one_of_their_matrix(rho, rng):
    """∬ |x − y|^{1−2ϱ} = 2/((2 − 2ϱ)(3 − 2ϱ))."""
    assert seminorm(FIRST[0], SECOND[0], rho) ** 2 == pytest.approx(2 / ((2 - 2 * rho) * (3 - 2 * rho)), rel=2e-3)
    v = rng.normal(size=SEMINORM_PANELS + 1)
    nodes = np.linspace(0, 1, SEMINORM_PANELS + 1)
    direct = seminorm(np.interp(FIRST[0], nodes, v), np.interp(SECOND[0], nodes, v), 0.5)
    assert v @ gram(SEMINORM_PANELS, 0.5) @ v == pytest.approx(float(direct) ** 2)


def test_both_bounds_meet_where_the_constant_of_the_article_is():
    assert beta(np.array(EQUAL_BRANCHES)) == pytest.approx(C_0)
    assert beta(np.linspace(0.001, 0.999, 999)).max() <= C_0 < 0.388


def contact_sets():
    """Random sets of contact on (0, 1), as unions of panels."""
    rng = np.random.default_rng(2002)
    for changes in (1, 1, 1, 2, 2, 3, 5, 9) * 5:
        ends = np.sort(rng.choice(np.arange(1, SEMINORM_PANELS), changes, replace=False))
        panels = (np.searchsorted(ends, np.arange(SEMINORM_PANELS), side="right") + rng.integers(2)) % 2 == 0
        yield np.repeat(panels, FIRST[0].size // SEMINORM_PANELS)


@pytest.mark.parametrize("rho", RHO)
def test_no_pressure_and_no_gap_exceed_the_bound_on_an_edge_and_some_are_not_small(rho):
    assert 0.02 < max(supremum(touching, rho) for touching in contact_sets()) <= 1


def verdicts(statement, rows):
    """Key ↦ all verdicts with this key."""
    found = {}
    for verdict in statement.judge(rows):
        found.setdefault(verdict.key, set()).add(verdict.verdict)
    return found


def test_the_work_on_every_edge_is_within_its_bound_unless_there_is_pressure_off_the_contact_zone(monkeypatch):
    """A constant is added to the pressure: the seminorm does not see it."""
    settings = grid(("merging-patches",), (GRID,), (16, 32))
    stated = FaceFields.stated_pressure
    assert set().union(*verdicts(EdgeWork(), measured(EdgeWork(), settings)).values()) == {HOLDS}
    monkeypatch.setattr(FaceFields, "stated_pressure", lambda self, time: np.asarray(stated(self, time) + 1e4))
    found = verdicts(EdgeWork(), measured(EdgeWork(), settings[1:]))
    assert FAILS in found["solution"] & found["constant"]


@pytest.mark.parametrize(
    ("quantities", "value", "key"),
    [
        ((WORK,), 1.01, "solution"),
        ((OF_ALL,), 1.01, "all"),
        ((OVERALL,), C_0 + 0.01, "constant"),
        (BRANCHES, 0, "branches"),
    ],
)
def test_every_row_about_edges_can_fail(quantities, value, key):
    numbers = {WORK: 0.5, OF_ALL: 0.5, OVERALL: 0.1, **dict.fromkeys(BRANCHES, 3)}
    wrong = numbers | dict.fromkeys(quantities, value)
    assert [verdicts(EdgeWork(), invented(rows, (16,)))[key] for rows in (numbers, wrong)] == [{HOLDS}, {FAILS}]


def work_rows(work, spread=0.5):
    """Rows with h = 1/n, an error of order 1 and work as given."""
    levels = 16, 32, 64, 128
    n = np.array(levels, dtype=float)
    numbers = {"work": work(n), "mean work": work(n), "spread": n**-spread, "error": 3 / n, "excess": 1 / n}
    return pd.concat([invented(numbers, levels, case="trains", family=family) for family in (GRID, "shaken")])


def test_work_of_order_one_holds_and_is_reported_on_irregular_meshes_and_too_few_levels_decide_nothing():
    rows = work_rows(lambda n: 1 / n)
    found = verdicts(WorkOfContact(), rows)
    assert found["order"] == found["spread"] == found["share"] == {HOLDS}
    assert found["order-irregular"] == found["excess"] == {REPORTED}
    assert verdicts(WorkOfContact(), rows[rows["level"] <= 32])["order"] == {UNDECIDED}


def test_work_of_another_order_a_spread_that_stays_and_work_that_cannot_be_seen_fail():
    for order in (0.8, 1.5):
        found = verdicts(WorkOfContact(), work_rows(lambda n, order=order: n**-order))
        assert found["order"] == found["order-mean"] == {FAILS}
    found = verdicts(WorkOfContact(), work_rows(lambda n: 0.01 / n, spread=0.0))
    assert found["spread"] == found["share"] == {FAILS}


@pytest.fixture(scope="module")
def coarse():
    return Resolved(resolve("trains").solution, space_of(Setting("trains", "shaken", 16)))


def test_the_work_is_the_same_through_the_load_and_on_the_face(coarse):
    """R grows like t², whose midpoint rule with eight nodes is known."""
    solution = coarse.solution
    space = coarse.space
    at_end = -pressing_on(coarse)(1.0) @ space.interpolate(solution.at(space.mesh.p).displacement(1.0))
    expected = at_end * np.mean(((np.arange(8) + 0.5) / 8) ** 2)
    assert TotalWork(solution)(vertices_on(space)) == pytest.approx(expected, rel=1e-3)
