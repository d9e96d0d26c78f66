"""Shares of a bound add up to it, meshes follow them, and a tolerance that is said to be reached is guaranteed."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sympy import Rational

from manufactured import Data, KelvinVoigt, Kind, isotropic, polygon, pos, static, t
from manufactured.factor import x1, x2
from study.bound.adaptive import Stage, marked, next_stage
from study.bound.discretisation import Discretisation
from study.bound.enclosing import enclose
from study.bound.static import compute_static, enclose_static
from study.bound.terms import part_that_changes
from study.bound.trajectory import Refined, SmoothedInTime, compute
from study.cli.main import main
from study.fem.mesh import Unstructured, boundary_parts, facet_measures
from study.solve.tableau import MIDPOINT

LAW = KelvinVoigt(isotropic(1, 0.5), isotropic(2, 3), "linear")
CONTACT, LOADED, CLAMPED = Kind.CONTACT, Kind.LOADED, Kind.CLAMPED


def wedge(**load) -> Data:
    """On a slanted foundation."""
    body = polygon([(0, 0), (2, -0.5), (2, 1), (0, 1)], [CONTACT, LOADED, LOADED, CLAMPED])
    return Data.formulas(body, LAW, **load)


def first_stage(data: Data, level: int = 2, steps: int = 4) -> Stage:
    mesh = Unstructured()(data.body, level)
    return Stage(mesh.p, mesh.t, steps)


# ---- shares


PROBLEMS = {
    "rolling": {"f0": (0, 0), "f2": {2: (0, -4 * t * pos(1 - (x1 - Rational(3, 4) - t / 2) ** 2, 3))}},
    "with a start": {"f0": (0, -t), "u0": (0, x1**2 * (1 + x2) / 10)},
    "at rest": {"f0": (0, 0)},
}


@pytest.mark.parametrize("name", PROBLEMS)
@pytest.mark.parametrize("trajectory", [SmoothedInTime(), Refined(0, 2)], ids=["u_h alone", "enclosure"])
def test_shares_are_not_negative_and_add_up_to_the_bound(name: str, trajectory) -> None:
    data = wedge(**PROBLEMS[name])
    discretisation = Discretisation(data, Unstructured()(data.body, 2))
    enclosure = enclose(discretisation, compute(discretisation, MIDPOINT, 3), trajectory)
    shares = enclosure.shares(discretisation.moduli)
    assert shares.total == pytest.approx(enclosure.highest, abs=1e-12)
    assert min(shares.cells.min(), shares.time) >= -1e-12
    for one in enclosure.intervals:
        left = one.at_b - discretisation.moduli.decay(one.b - one.a) * one.at_a
        assert one.shares.total == pytest.approx(left, abs=1e-12)


def test_shares_of_a_static_bound_belong_to_cells_alone_and_add_up_to_the_bound() -> None:
    data = static(wedge(f0=(0, 0)).body, isotropic(2.0, 3.0), (0, -1))
    discretisation = Discretisation(data, Unstructured()(data.body, 2))
    enclosure, shares = enclose_static(discretisation, compute_static(discretisation), None)
    assert shares.time == 0
    assert shares.cells.sum() == pytest.approx(enclosure.highest)
    assert shares.cells.min() >= 0


@given(st.lists(st.floats(0, 1), min_size=1, max_size=8), st.floats(0.05, 1))
def test_marked_cells_are_the_fewest_that_have_a_part(shares: list[float], part: float) -> None:
    values = np.array(shares)
    chosen = marked(values, part)
    enough = part * values.sum() * (1 - 1e-9)
    assert values[chosen].sum() >= enough
    fewer = combinations(range(len(values)), len(chosen) - 1)
    assert all(values[list(some)].sum() < part * values.sum() * (1 + 1e-9) or values.sum() == 0 for some in fewer)


def test_what_changes_within_a_piece_is_that_of_time() -> None:
    def share(coefficients: list[float]) -> float:
        products = np.multiply.outer(coefficients, coefficients)
        quadratic = np.array([[6, 3, 1], [3, 4, 3], [1, 3, 6]]) / 30
        return float(part_that_changes(products[..., None], np.array([np.vdot(quadratic, products)]))[0])

    assert share([2.0, 2.0, 2.0]) == pytest.approx(0)
    assert share([-1.0, 0.0, 1.0]) == pytest.approx(1)
    # 1 + θ: the variance is 1/12, the mean square 7/3.
    assert share([1.0, 1.5, 2.0]) == pytest.approx(1 / 28)
    assert share([0.0, 0.0, 0.0]) == 0


# ---- meshes and steps


def smallest_angle(stage: Stage) -> float:
    sides = stage.p[:, np.roll(stage.t, -1, axis=0)] - stage.p[:, stage.t]
    unit = sides / np.linalg.norm(sides, axis=0)
    return float(np.arccos((-unit * np.roll(unit, 1, axis=1)).sum(axis=0)).min())


def test_parts_of_the_boundary_stay_and_angles_do_not_degenerate() -> None:
    """By marks at random, concentrated at one end of the slanted foundation, many times."""
    data, rng = wedge(f0=(0, 0)), np.random.default_rng(0)
    stage = first_stage(data)
    least = smallest_angle(stage)
    for _ in range(14):
        middles = stage.p[:, stage.t].mean(axis=1)
        shares = rng.random(stage.cells) / np.linalg.norm(middles - [[2.0], [-0.5]], axis=0) ** 4
        coarser, stage = stage, next_stage(stage, shares, 0.0)
        assert stage.steps == coarser.steps
        assert stage.cells > coarser.cells
        for part, facets in zip(data.body.parts, boundary_parts(stage.mesh, data.body), strict=True):
            assert facet_measures(stage.mesh, facets).sum() == pytest.approx(part.measure)
    assert smallest_angle(stage) > least / 2.01
    edges = facet_measures(stage.mesh, stage.mesh.boundary_facets())
    assert edges.max() > 30 * edges.min()


def test_time_is_refined_where_it_has_the_share_and_space_where_cells_have_it() -> None:
    stage = first_stage(wedge(f0=(0, 0)))
    ones = np.ones(stage.cells)
    only_space, both, only_time = (next_stage(stage, ones, part * stage.cells) for part in (0.1, 1.0, 10.0))
    assert (only_space.steps, both.steps, only_time.steps) == (4, 8, 8)
    assert only_space.cells == both.cells > only_time.cells == stage.cells


# ---- the tolerance


# ---- the command


SQUARE = f"{Path(__file__).parents[2]}/examples/certificates/problems.py:square"


def adapt(out: Path, *options: str) -> int:
    return main(["bound", SQUARE, "--levels", "2", "--steps", "4", "--out", str(out), *options])


def test_a_limit_stops_with_the_reason_and_keeps_what_there_is(tmp_path, capsys) -> None:
    assert adapt(tmp_path / "out", "--adapt", "1e-6", "--cells", "10") == 1
    printed = " ".join(capsys.readouterr().out.split())
    assert "> 1e-06, the tolerance is not reached: the next mesh has" in printed
    assert "10 are permitted: raise --cells or the tolerance" in printed
    assert pd.read_csv(tmp_path / "out" / "square" / "adaptive.csv")["cells"].max() <= 10


@pytest.mark.slow
def test_memory_that_is_not_there_stops_with_the_reason(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.setattr("study.cli.adapt.available", lambda: 0.5 * 2.0**30)
    assert adapt(tmp_path / "out", "--adapt", "1e-6") == 1
    assert "GiB of memory" in capsys.readouterr().out
