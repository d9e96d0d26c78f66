"""Shares of a bound add up to it, meshes follow them, and a tolerance that is said to be reached is guaranteed."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pandas as pd
import pytest
from bodies import ANGLE, CLAMPED, CONTACT, LAW, LOADED
from hypothesis import given
from hypothesis import strategies as st
from measures import smallest_angle
from on_meshes import discretised_on
from places import CERTIFICATES
from sympy import Rational, exp
from test_terms import discretised, terms_of

from manufactured import Data, isotropic, named, polygon, pos, static, t
from manufactured.factor import x1, x2
from study.bound import adaptive
from study.bound.adaptive import Stage, adapted, marked, next_stage
from study.bound.enclosing import compute_static, enclose, enclose_static
from study.bound.remainders import GUARANTEED
from study.bound.terms import Majorant, part_that_changes
from study.bound.trajectory import Refined, SmoothedInTime, compute
from study.cli.bound import contact_edges
from study.fem.mesh import Unstructured, boundary_parts, cell_volumes, facet_measures
from study.present.outcome import adaptive_text
from study.solve.tableau import MIDPOINT


def wedge(**load):
    """On a slanted foundation."""
    body = polygon([(0, 0), (2, -0.5), (2, 1), (0, 1)], [CONTACT, LOADED, LOADED, CLAMPED])
    return Data.formulas(body, LAW, **load)


def first_stage(data, level=2, steps=4):
    mesh = Unstructured()(data.body, level)
    return Stage(mesh, steps)


# ---- shares


PROBLEMS = {
    "rolling": {"f0": (0, 0), "f2": {2: (0, -4 * t * pos(1 - (x1 - Rational(3, 4) - t / 2) ** 2, 3))}},
    "with a start": {"f0": (0, -t), "u0": (0, x1**2 * (1 + x2) / 10)},
    "at rest": {"f0": (0, 0)},
}


def enclosed(name, trajectory):
    """The moduli of the law, and the enclosure."""
    data = wedge(**PROBLEMS[name])
    discretisation = discretised_on(data, 2, Unstructured())
    return discretisation.moduli, enclose(discretisation, compute(discretisation, MIDPOINT, 3), trajectory)


@pytest.mark.parametrize("name", PROBLEMS)
@pytest.mark.parametrize("trajectory", [SmoothedInTime(), Refined(0, 2)])
def test_shares_are_not_negative_and_add_up_to_the_bound(name, trajectory):
    moduli, enclosure = enclosed(name, trajectory)
    shares = enclosure.shares(moduli)
    assert shares.total == pytest.approx(enclosure.highest, abs=1e-12)
    assert min(shares.cells.min(), shares.time) >= -1e-12
    for one in enclosure.intervals:
        left = one.at_b - moduli.decay(one.b - one.a) * one.at_a
        assert one.shares.total == pytest.approx(left, abs=1e-12)


def test_shares_of_a_static_bound_belong_to_cells_alone_and_add_up_to_the_bound():
    data = static(wedge(f0=(0, 0)).body, isotropic(2.0, 3.0), (0, -1))
    discretisation = discretised_on(data, 2, Unstructured())
    enclosure, shares = enclose_static(discretisation, compute_static(discretisation), None)
    assert shares.time == 0
    assert shares.cells.sum() == pytest.approx(enclosure.highest)
    assert shares.cells.min() >= 0


def test_what_comes_after_the_largest_bound_has_no_share_in_it():
    moduli, found = enclosed("rolling", SmoothedInTime())
    between = found.between.copy()
    between[0] = 2 * found.highest
    first, *others = found.intervals
    louder = first, *(replace(one, shares=10 * one.shares) for one in others)
    early = [replace(found, between=between, intervals=intervals) for intervals in (found.intervals, louder)]
    one, same = (enclosure.shares(moduli) for enclosure in early)
    assert one.total == pytest.approx(2 * found.highest)
    assert same.time == pytest.approx(one.time)
    assert same.cells == pytest.approx(one.cells)


def test_a_load_on_few_cells_gives_them_the_shares():
    data = wedge(f0=(0, -50 * t * exp(-20 * ((x1 - 1.5) ** 2 + (x2 - 0.3) ** 2))))
    stage = first_stage(data, 4)
    found = adapted(data, None, stage, MIDPOINT).shares.cells
    middles = stage.mesh.p[:, stage.mesh.t].mean(axis=1)
    near = np.hypot(middles[0] - 1.5, middles[1] - 0.3) < 0.5
    volumes = cell_volumes(stage.mesh)
    assert found[near].sum() / found.sum() > 1.5 * volumes[near].sum() / volumes.sum()


def test_the_verdict_is_about_the_last_mesh_and_each_mesh_with_more_unknowns_has_an_order():
    """Each time bounds are halved and, but for the last mesh, unknowns are four times as many."""
    same = {"cells": 1, "steps": 1, "in_time": 0.5, "error": np.nan}
    rows = [same | {"mesh": n, "dofs": 4 ** min(n, 3), "bound": 2.0**-n, "percent": 80 / 2**n} for n in (1, 2, 3, 4)]
    first, *shown = adaptive_text("ramp", adaptive.table(rows), "6 %", "", [])
    assert first.startswith("ramp: max")
    assert first.endswith("≤ 0.0625, 5 % of u, ≤ 6 %, the tolerance is reached")
    heads, *lines = shown[shown.index("") + 1 :]
    end = heads.index("order") + len("order")
    assert [line[:end].split()[-1] for line in lines[1:3]] == ["0.50", "0.50"]
    assert not any(line[end - len("order") : end].strip() for line in (lines[0], lines[3]))


@given(st.lists(st.floats(0, 1), min_size=1, max_size=8), st.floats(0.05, 1))
def test_marked_cells_are_the_fewest_that_have_a_part(shares, part):
    values = np.array(shares)
    chosen = marked(values, part)
    enough = part * values.sum() * (1 - 1e-9)
    assert values[chosen].sum() >= enough
    fewer = combinations(range(len(values)), len(chosen) - 1)
    assert all(values[list(some)].sum() < part * values.sum() * (1 + 1e-9) or values.sum() == 0 for some in fewer)


def test_what_changes_within_a_piece_is_that_of_time():
    def share(coefficients):
        products = np.multiply.outer(coefficients, coefficients)
        quadratic = np.array([[6, 3, 1], [3, 4, 3], [1, 3, 6]]) / 30
        return float(part_that_changes(products[..., None], np.array([np.vdot(quadratic, products)]))[0])

    assert share([2.0, 2.0, 2.0]) == pytest.approx(0)
    assert share([-1.0, 0.0, 1.0]) == pytest.approx(1)
    # 1 + θ: the variance is 1/12, the mean square 7/3.
    assert share([1.0, 1.5, 2.0]) == pytest.approx(1 / 28)
    assert share([0.0, 0.0, 0.0]) == 0


def test_the_shares_of_cells_and_of_time_are_linear_in_the_part_that_changes(monkeypatch):
    d = discretised((t**3, 0))
    terms = terms_of(d)

    def shares(part):
        monkeypatch.setattr("study.bound.terms.part_that_changes", lambda _, squares: np.full_like(squares, part))
        return Majorant(d)._interval(terms, 0.0).shares

    none = shares(0.0)
    quarter = shares(0.25)
    all_of_it = shares(1.0)
    assert quarter.cells == pytest.approx(0.75 * none.cells + 0.25 * all_of_it.cells)
    assert quarter.time == pytest.approx(0.75 * none.time + 0.25 * all_of_it.time)


# ---- meshes and steps


def test_parts_of_the_boundary_stay_and_angles_do_not_degenerate(rng):
    """By marks at random, concentrated at one end of the slanted foundation, many times."""
    data = wedge(f0=(0, 0))
    stage = first = first_stage(data)
    for _ in range(14):
        middles = stage.mesh.p[:, stage.mesh.t].mean(axis=1)
        shares = rng.random(stage.cells) / np.linalg.norm(middles - [[2.0], [-0.5]], axis=0) ** 4
        coarser = stage
        stage = next_stage(stage, shares, 0.0)
        assert stage.steps == first.steps
        assert stage.cells > coarser.cells
        lengths = [facet_measures(stage.mesh, facets).sum() for facets in boundary_parts(stage.mesh, data.body)]
        assert lengths == pytest.approx([part.measure for part in data.body.parts])
    least, found = (smallest_angle(each.mesh.p[:, each.mesh.t]) for each in (first, stage))
    assert found > least / 2.01
    edges = facet_measures(stage.mesh, stage.mesh.boundary_facets())
    assert edges.max() > 30 * edges.min()


def test_time_is_refined_where_it_has_the_share_and_space_where_cells_have_it():
    stage = first_stage(wedge(f0=(0, 0)))
    ones = np.ones(stage.cells)
    only_space, both, only_time = (next_stage(stage, ones, part * stage.cells) for part in (0.1, 1.0, 10.0))
    assert only_space.steps == 4
    assert both.steps == 8
    assert only_time.steps == 8
    assert only_space.cells == both.cells > only_time.cells == stage.cells


def test_edges_of_the_foundation_are_in_contact_where_nothing_opens():
    data = wedge(f0=(0, 0))
    mesh = Unstructured()(data.body, 4)
    normal = next(part.normal for part in data.body.parts if part.kind is CONTACT)
    open_right = -np.outer(normal, np.maximum(mesh.p[0] - 1.0, 0.0))
    ends, closed = contact_edges(data, mesh, open_right)
    assert (closed == (ends[0].max(axis=0) <= 1.0 + 1e-12)).all()
    assert 0 < closed.sum() < len(closed)


# ---- the tolerance


def test_no_error_is_above_a_bound_and_bounds_fall():
    case = named("advance-recede")
    data = Data.of(case.solution)
    stage = first_stage(data, 2, 2)
    first = adapted(data, case, stage, MIDPOINT)
    second = adapted(data, case, next_stage(stage, first.shares.cells, first.shares.time), MIDPOINT)
    assert second.enclosure.error.max() <= second.enclosure.highest < first.enclosure.highest


@pytest.mark.slow
def test_the_bracket_has_the_best_order_in_unknowns_on_adapted_meshes_and_not_on_others():
    """The corner's exponent 0.54 allows N^{−0.27} on meshes that are refined everywhere."""
    body = polygon(ANGLE, [CONTACT, LOADED, LOADED, LOADED, CLAMPED, LOADED])
    data = Data.formulas(body, LAW, f0=(0, -t), f2={1: (2 * t, 0)})
    orders = []
    for everywhere in (False, True):
        stage = first_stage(data, 2, 8)
        points = []
        while stage.cells < 2500:
            found = adapted(data, None, stage, MIDPOINT)
            points.append((found.computed.space.dofs, found.enclosure.highest))
            cells = np.ones(stage.cells) if everywhere else found.shares.cells
            following = next_stage(stage, cells, 0.0)
            mesh = stage.mesh.refined()
            stage = Stage(mesh, stage.steps) if everywhere else following
        unknowns, bounds = np.log(np.array(points)[-4:]).T
        orders.append(-np.polyfit(unknowns, bounds, 1)[0])
    assert orders[0] == pytest.approx(0.5, abs=0.05)
    assert orders[1] < 0.36


# ---- the command


@pytest.fixture
def adapt(out, told):
    """``study bound --adapt`` for the square of the certificates, with a tolerance and further options."""
    command = f"bound {CERTIFICATES}/problems.py:square --levels 2 --steps 4 --out {out} --adapt"
    return lambda options, code=0: told(f"{command} {options}", code)


@pytest.mark.slow
def test_a_tolerance_is_reached_and_a_smaller_one_goes_on_from_there(out, adapt, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    printed = adapt("0.15")
    assert "≤ 0.15, the tolerance is reached" in printed
    assert "guaranteed" in printed
    table = printed.partition("\n\n")[2]
    assert max(map(len, table.splitlines())) <= 80
    directory = out / "square"
    rows = pd.read_csv(directory / "adaptive.csv")
    assert rows["bound"].iloc[-1] <= 0.15 < rows["bound"].iloc[-2]
    assert (rows["kind"] == GUARANTEED).all()
    assert (directory / "adaptive.png").stat().st_size > 1000
    with np.load(directory / f"adapted-{len(rows) - 1}.npz") as found:
        assert found["t"].shape == (3, rows["cells"].iloc[-1])
        total = found["shares"].sum() + found["in_time"]
        assert (total, found["in_time"] / total) == pytest.approx(rows[["bound", "in_time"]].iloc[-1], abs=1e-4)

    calls = []
    monkeypatch.setattr("study.cli.bound.adapted", lambda *given: calls.append(given) or adapted(*given))
    adapt("0.15")
    assert not calls
    adapt("0.11")
    again = pd.read_csv(directory / "adaptive.csv")
    assert len(calls) == len(again) - len(rows) > 0
    pd.testing.assert_frame_equal(again[: len(rows)], rows)


def test_a_limit_stops_with_the_reason_and_keeps_what_there_is(out, adapt):
    printed = " ".join(adapt("1e-6 --cells 10", code=1).split())
    assert "> 1e-06, the tolerance is not reached: the next mesh has" in printed
    assert "10 are permitted: raise --cells or the tolerance" in printed
    assert pd.read_csv(out / "square" / "adaptive.csv")["cells"].max() <= 10


@pytest.mark.slow
def test_memory_that_is_not_there_stops_with_the_reason(adapt, monkeypatch):
    monkeypatch.setattr("study.run.executor.available", lambda: 0.5 * 2.0**30)
    assert "GiB of memory" in adapt("1e-6", code=1)
