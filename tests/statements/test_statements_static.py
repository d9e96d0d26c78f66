"""Statements without time: their pieces agree with independent ones, and each verdict can come out otherwise."""

import math

import numpy as np
import pytest
from measured_rows import invented, measured, verdicts
from scipy.linalg import eigh

from manufactured import unit_square
from manufactured.law import isotropic
from study.fem.error_norm import ErrorNorm
from study.fem.mesh import Shaken
from study.fem.naming import resolve
from study.fem.space import Space
from study.ledger.verdict import FAILS, HOLDS, MISSED, REPORTED
from study.statements import interpolation
from study.statements.interpolation import InterpolationInV, InterpolationOnContact
from study.statements.korn import Korn
from study.statements.nodal_start import mean_energy, norm_of_start, spikes
from study.statements.shared import eigen
from study.statements.shared.base import grid

SQUARE = unit_square()
H = 1 / np.array([8.0, 16.0, 32.0])


# Forms and eigenvalues.


def test_the_product_of_h1_is_that_of_functions_and_strains() -> None:
    """∫ v² over a triangle T is |T|/12 (Σ v_i² + (Σ v_i)²) for a linear v with the values v_i at the corners."""
    space = Space(Shaken()(SQUARE, 5), SQUARE)
    v = np.random.default_rng(0).standard_normal(space.dofs)
    corners = space.nodal(v)[:, space.mesh.t]
    squares = ((corners**2).sum(axis=1) + corners.sum(axis=1) ** 2) / 12
    total = np.sum(squares * space.volumes) + np.sum(space.strain(v) ** 2 * space.volumes)
    assert v @ (eigen.h1_product(space) @ v) == pytest.approx(total, rel=1e-12)


def test_extreme_eigenvalues_are_those_of_a_dense_solver() -> None:
    space = Space(Shaken()(SQUARE, 4), SQUARE)
    form, product = space.form(isotropic(1, 3).matrix), eigen.h1_product(space)
    values = eigh(form.toarray(), product.toarray(), eigvals_only=True)
    assert eigen.smallest(form, product) == pytest.approx(values[0], rel=1e-9)
    assert eigen.largest(form, product) == pytest.approx(values[-1], rel=1e-6)


# (2.17).


def test_eigenvalues_that_rise_or_tend_to_zero_fail() -> None:
    for values in ((0.3, 0.2, 0.21), (0.4, 0.2, 0.1), (1 / 3, 1 / 4, 1 / 5), (0.3, 0.25, np.nan)):
        assert FAILS in verdicts(Korn(), invented({"smallest eigenvalue": values})).values(), values


# (5.23), (5.24).


@pytest.mark.parametrize(("family", "scatter"), [("one-diagonal", 1.0), ("shaken", 1.05)])
@pytest.mark.parametrize(
    ("order", "verdict"), [(1.0, HOLDS), (0.8, FAILS), (1.2, FAILS), (2.0, FAILS), (np.nan, FAILS)]
)
def test_the_order_in_v_is_judged_from_both_sides(order: float, verdict: str, family: str, scatter: float) -> None:
    """On random meshes the scatter of the coarsest one hardly counts."""
    errors = dict.fromkeys(interpolation.FIELDS.values(), H**order * [scatter, 1, 1])
    assert set(verdicts(InterpolationInV(), invented(errors, family=family)).values()) == {verdict}


@pytest.mark.parametrize(
    ("tau", "order", "verdict"),
    [
        *((np.inf, order, verdict) for order, verdict in ((2.0, HOLDS), (1.0, FAILS), (2.5, FAILS))),
        *((2.25, order, verdict) for order, verdict in ((2.0, HOLDS), (1.5, FAILS))),
        *((1.75, order, verdict) for order, verdict in ((1.7, REPORTED), (1.0, MISSED))),
    ],
)
def test_the_order_of_traces_is_two_where_it_is_claimed(tau: float, order: float, verdict: str) -> None:
    column = interpolation.TRACE.format(next(iter(interpolation.INSTANTS)), 1)
    rows = invented({interpolation.REGULARITY: tau, "size of Γ3,1": H, column: H**order})
    assert {*verdicts(InterpolationOnContact(), rows).values()} == {verdict}


def test_a_trace_that_is_zero_has_no_order_to_be_judged() -> None:
    rows = measured(InterpolationOnContact(), grid(("full-contact",), ("shaken",), (4, 8, 16)))
    assert list(verdicts(InterpolationOnContact(), rows)) == ["smooth-face-1"]


def test_the_distance_of_a_smooth_field_is_that_of_the_gauge() -> None:
    """The points of ErrorNorm share coordinates, which leaves its rules exact to a lower degree."""
    solution = resolve("no-contact").solution
    space = Space(Shaken()(solution.body, 6), solution.body)
    v_norm = ErrorNorm(solution, space, 4)
    sample = v_norm.sample(0.5)
    found = interpolation.distance_in_V(solution, space, lambda x: solution.at(x).displacement(0.5))
    assert found == pytest.approx(v_norm.distance(sample, sample.interpolant), rel=1e-7)


# The continuous start whose nodal interpolants do not converge.


def test_spikes_have_their_heights_at_odd_multiples_and_vanish_at_other_vertices() -> None:
    v = spikes(np.stack(np.meshgrid(np.arange(17), np.arange(17), indexing="ij")) / 16, 4)
    assert v[1::2, 1::2] == pytest.approx(1 / 4)
    assert v[2::4, 2::4] == pytest.approx(2**-1.5)
    assert v.sum() == pytest.approx(64 / 4 + 16 * 2**-1.5)
    # A spike is continuous and ends at its radius.
    at = np.array([[1 / 8], [1 / 8]]) + np.array([[1.0], [0.0]]) * 4.0**-3 * np.array([0.0, 1e-6, 0.5, 1.0, 1.5])
    expected = [1, 6 * math.log(10) / 64, math.log(2) / 64, 0, 0]
    assert spikes(at, 3) == pytest.approx(2**-1.5 * np.array(expected), abs=1e-9)


def test_the_mean_energy_has_a_closed_form_and_the_bound_of_the_norm_is_the_sum_over_the_levels() -> None:
    A = isotropic(1.5, 0.7)
    assert mean_energy(A) == pytest.approx((3 * 1.5 + 0.7) / 2)
    terms = (math.sqrt(2**-j * 4 ** (j - 1) * 2 * math.pi / 4**j * mean_energy(A)) for j in range(3, 200))
    assert norm_of_start(A) == pytest.approx(sum(terms))
