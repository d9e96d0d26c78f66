"""Values at which a comparison in the bound decides: boxes at a kink, errors of 0, bodies of another size."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from skfem import MeshTri
from test_terms import BODY, discretised, terms_of

from manufactured import Kind, polygon, t
from study.bound.adaptive import Tolerance, table, text
from study.bound.bounded import check_problem
from study.bound.fields import _together
from study.bound.given import SINGLE, _check_cells, _check_fit, _on_boundary
from study.bound.problem import BoundError
from study.bound.ranges import _truncated
from study.bound.terms import Majorant, Shares
from study.bound.trajectory import Parabola, Refined


def test_a_negative_power_has_no_bound_on_a_box_that_begins_at_its_kink() -> None:
    low, high = _truncated((np.zeros(1), np.ones(1)), -0.5)
    assert (low[0], high[0]) == (-math.inf, math.inf)


@pytest.mark.parametrize("size", [0.01, 1, 100])
def test_vertices_are_moved_to_a_side_from_a_distance_relative_to_the_size_of_the_body(size: int) -> None:
    body = polygon([(0, 0), (size, 0), (size, size), (0, size)], [Kind.CONTACT, *[Kind.LOADED] * 2, Kind.CLAMPED])
    p = size * np.array([[0.4, 0.6], [0.5 * SINGLE, 2 * SINGLE]])
    assert np.abs(_on_boundary(body, p)[1] / (size * SINGLE)).tolist() == pytest.approx([0, 2], abs=1e-6)


def test_a_small_cell_far_from_another_one_has_an_area() -> None:
    corner = np.array([[0, 1, 0], [0, 0, 1]])
    _check_cells(MeshTri(np.hstack([1e-7 * corner, 1 + 1e-7 * corner]), np.arange(6).reshape(2, 3).T))


def test_a_mesh_without_the_triangle_at_a_corner_is_refused_with_the_middle_of_its_one_side_inside() -> None:
    half = MeshTri(np.array([[0.0, 1, 1], [0, 0, 1]]), np.array([[0], [1], [2]]))
    with pytest.raises(BoundError, match=r"1 sides of triangles .* the first near x = \(0\.5, 0\.5\)"):
        _check_fit(half, BODY)


@pytest.mark.parametrize("refined", [Refined(-1, 2), Refined(1, 0)], ids=str)
def test_refinements_and_shorter_steps_are_refused_one_by_one(refined: Refined) -> None:
    with pytest.raises(BoundError, match="ũ needs 0 or more refinements"):
        check_problem(discretised().data, None, refined)


def test_a_mesh_that_moves_between_two_times_is_refused() -> None:
    u = {"u": np.zeros((3, 2))}
    meshes = [(time, SimpleNamespace(points=np.full((3, 2), time), point_data=u)) for time in (0.0, 1.0)]
    with pytest.raises(BoundError, match=r"another mesh at t = 1\.0"):
        _together(Path("u.pvd"), meshes, None)


def test_the_polar_form_of_a_parabola_in_time_is_affine_in_both_times() -> None:
    piece = Parabola(0.0, 1.0, *np.random.default_rng(0).normal(size=(3, 2)))
    assert piece.blossom(0.3, 0.3) == pytest.approx(piece.at(0.3))
    assert piece.blossom(0.2, 0.7) == pytest.approx(piece.blossom(0.7, 0.2))
    assert piece.blossom(0.2, 0.6) == pytest.approx((piece.blossom(0.2, 0.4) + piece.blossom(0.2, 0.8)) / 2)


def test_the_shares_of_cells_and_of_time_are_linear_in_the_part_that_changes(monkeypatch) -> None:
    d = discretised((t**3, 0))
    terms = terms_of(d)

    def shares(part: float) -> Shares:
        monkeypatch.setattr("study.bound.terms.part_that_changes", lambda _, squares: np.full_like(squares, part))
        return Majorant(d)._interval(terms, 0.0).shares

    none, quarter, all_of_it = shares(0.0), shares(0.25), shares(1.0)
    assert quarter.cells == pytest.approx(0.75 * none.cells + 0.25 * all_of_it.cells)
    assert quarter.time == pytest.approx(0.75 * none.time + 0.25 * all_of_it.time)


def test_a_table_shows_the_order_of_each_mesh_with_more_unknowns_than_the_one_before() -> None:
    same = {"cells": 1, "steps": 1, "percent": 1.0, "in_time": 0.5, "error": 1.0}
    rows = [same | {"mesh": n, "dofs": 4 ** min(n, 3), "bound": 2.0**-n} for n in (1, 2, 3, 4)]
    shown = text("x", table(rows), Tolerance(0.1), "", [])
    heads, *lines = shown[shown.index("") + 1 :]
    end = heads.index("order") + len("order")
    assert [line[end - len("order") : end].strip() for line in lines[:4]] == ["", "0.50", "0.50", ""]
