"""One step of the bound: never below the worst error that its inequality admits, and close to it for short steps."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from manufactured import FrobeniusBall, Indefinite, KelvinVoigt, Linear, Yield, isotropic, isotropic_matrix, named
from manufactured.factor import Factor, x1
from manufactured.tensors import Array
from study.bound.growth import Sizes, Step, grow, kernel, largest_square, mean_square
from study.bound.problem import moduli

seeds = st.integers(0, 10**6)


def constant(k: float, residual: Array, contact: float = 0.0, rest: float = 0.0) -> Step:
    """A step in which nothing changes, of a residual (directions,) on one cell."""
    sizes = Sizes(residual[:, None] ** 2, np.zeros(1), contact, rest)
    return Step(k, sizes, sizes)


def random_step(seed: int, least: float = 1e-3) -> tuple[Array, Array, Array, Step]:
    """Moduli over six decades, an error, a residual that is constant in a step, and what the step adds."""
    rng = np.random.default_rng(seed)
    g, r, e = 10 ** rng.uniform(np.log10(least), 3, 3), rng.normal(size=3), rng.normal(size=3)
    e *= 10 ** rng.uniform(-2, 1)
    k, contact = 10 ** rng.uniform(-3, 0), float(rng.choice([0.0, 10 ** rng.uniform(-3, 0)]))
    return g, r, e, constant(k, r, contact / k)


def worst(g: Array, r: Array, e: Array, step: Step) -> Array:
    """|e| over a step of e' = r − g e + c e/|e|², for which the inequality of the bound is an equality."""

    def rate(_: float, x: Array) -> Array:
        return r - g * x + step.mean.contact * x / max(float(x @ x), 1e-30)

    solved = solve_ivp(rate, (0, step.k), e, method="LSODA", rtol=1e-9, atol=1e-12)
    return np.linalg.norm(solved.y, axis=0)


@given(seeds)
def test_a_step_bounds_the_error_at_its_end_and_within(seed: int) -> None:
    g, r, e, step = random_step(seed)
    sizes = worst(g, r, e, step)
    at_b, inside = grow(float(np.linalg.norm(e)), g, step)
    assert sizes[-1] <= at_b * (1 + 1e-6)
    assert sizes.max() <= inside * (1 + 1e-6)
    assert at_b <= inside * (1 + 1e-12)


@given(seeds)
def test_short_steps_are_bounded_closely(seed: int) -> None:
    """Where the residual points along the error and nothing is stiff: |e| + k |r|, but for k²."""
    g, r, _, _ = random_step(seed, 0.1)
    g, k = np.minimum(g, 1.0), 1e-3
    e = 3 * r / np.linalg.norm(r)
    step = constant(k, r, 1e-3)
    assert grow(3.0, g, step)[0] == pytest.approx(worst(g, r, e, step)[-1], rel=3e-3)


K = 0.01


@pytest.mark.parametrize(
    ("y", "moduli_", "residual", "least", "most"),
    [
        # In a stiff direction the residual adds a square, elsewhere itself.
        (1.0, (1, 1, 1e6), (0, 0, 1), np.exp(-K), 1 + 1e-6),
        (1.0, (1, 1, 1e6), (1, 0, 0), np.exp(-K) + 0.99 * K, 1 + K),
        # Stiff in all directions and much stiffer in that of the residual: damped and taken up at once.
        (1.0, (100, 100, 1e8), (0, 0, 1e4), np.exp(-100 * K), 1.3 * np.exp(-100 * K)),
        # From no error at all, also where a first iteration would take no part of the residual.
        (0.0, (1, 1, 1e6), (0, 0, 1), 0.98 * np.sqrt(K / 2e6), 1.02 * np.sqrt(K / 2e6)),
    ],
    ids=["stiff", "soft", "all stiff", "no error"],
)
def test_elasticity_takes_up_a_residual_in_a_stiff_direction(y, moduli_, residual, least, most) -> None:
    at_b, _ = grow(y, np.array(moduli_, dtype=float), constant(K, np.array(residual, dtype=float)))
    assert least <= at_b <= most


@pytest.mark.parametrize("stiffness", [1e2, 1e4, 1e6])
def test_what_a_long_step_of_stiff_elasticity_leaves_is_the_error_at_rest(stiffness: float) -> None:
    """|r|/g from the residual, √(c/g) from contact, and what is no part of a cell over g: not the integrals."""
    g, r = np.full(3, stiffness), np.array([0.3, -1.0, 0.5])
    assert grow(1.0, g, constant(1.0, r))[0] == pytest.approx(np.linalg.norm(r) / stiffness, rel=1e-6)
    assert grow(1.0, g, constant(1.0, 0 * r, contact=2.0))[0] == pytest.approx(np.sqrt(2.0 / stiffness), rel=1e-6)
    assert grow(1.0, g, constant(1.0, 0 * r, rest=2.0))[0] == pytest.approx(2.0 / stiffness, rel=1e-6)


def test_negative_moduli_let_the_error_grow() -> None:
    still = constant(0.5, np.zeros(3))
    assert grow(1.0, np.array([-2.0, 1.0, 1.0]), still) == pytest.approx((np.exp(1.0), np.exp(1.0)))
    assert kernel(0.0, 0.25) == 0.25
    assert kernel(1e-9, 0.25) == pytest.approx(0.25)


def test_what_is_no_part_of_a_cell_is_added_as_it_is() -> None:
    """Damped as little as the slowest direction damps."""
    _, r, _, step = random_step(3)
    g, k = np.array([0.1, 2.0, 30.0]), step.k
    plain, more = (grow(1.0, g, constant(k, r, rest=rest)) for rest in (0.0, 0.25 / k))
    assert np.subtract(more, plain) == pytest.approx(0.25, rel=0.1 * k)


@given(seeds)
def test_the_mean_square_of_a_parabola_is_bounded_by_three_norms(seed: int) -> None:
    rng = np.random.default_rng(seed)
    a, m, b = rng.normal(size=(3, 4))
    x, w = np.polynomial.legendre.leggauss(5)
    x = (x + 1) / 2
    values = np.outer((1 - x) * (1 - 2 * x), a) + np.outer(4 * x * (1 - x), m) + np.outer(x * (2 * x - 1), b)
    exact = float(w / 2 @ np.sum(values**2, axis=1))
    norms = [np.array([np.linalg.norm(v)]) for v in (a, m, b)]
    assert exact <= mean_square(*norms)[0] * (1 + 1e-12)
    assert mean_square(*(np.ones(1) for _ in range(3)))[0] == pytest.approx(41 / 30)
    assert (values**2).sum(axis=1).max() <= largest_square(*norms)[0] * (1 + 1e-12)


LAWS = [
    KelvinVoigt(isotropic(1, 0.5), isotropic(2, 3), "isotropic"),
    KelvinVoigt(isotropic(1, 1e4), Linear(np.diag([1.0, 2.0, 3.0])), "anisotropic"),
    KelvinVoigt(isotropic(1, 0.5), Yield(2.0, FrobeniusBall(0.1)), "(3.3)"),
    *(named(name).solution.law for name in ("anisotropic", "softening", "double-well")),
]


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_moduli_bound_the_work_of_differences_from_below(law: KelvinVoigt) -> None:
    found, rng = moduli(law), np.random.default_rng(0)
    one, other = rng.normal(size=(2, 3, 200))
    parts = found.directions.T @ law.A.matrix @ (one - other)
    work = np.einsum("In,In->n", law.G(one) - law.G(other), one - other)
    assert (work >= found.values @ parts**2 - 1e-9 * abs(work)).all()
    assert np.einsum("in->n", parts**2) == pytest.approx(np.einsum("In,In->n", law.A(one - other), one - other))
    if isinstance(law.G, Linear):
        assert work == pytest.approx(found.values @ parts**2)


def test_moduli_of_a_material_that_varies_take_the_worst_of_both_factors() -> None:
    """Stiff directions by the least G over the largest A, those that soften by the largest G over the least A."""
    A = isotropic(1, 0.5, factor=Factor(1 + x1, 1.0, 2.0))
    law = KelvinVoigt(A, Indefinite(isotropic_matrix(0.5, -1.5), Factor(4 - x1, 3.0, 4.0)), "varies")
    found, rng, x = moduli(law), np.random.default_rng(0), np.linspace(0, 1, 9)[None]
    for strain in rng.normal(size=(50, 3, 1)):
        parts = found.directions.T @ A.matrix @ strain
        local = np.sum(law.G.at(x)(np.broadcast_to(strain, (3, 9))) * strain, axis=0)
        assert (local >= A.factor(x) * (found.values @ parts**2) - 1e-12).all()
    assert found.values.min() == pytest.approx(-2 / 3 * 4)


def test_the_norm_of_residuals_is_that_of_viscosity_where_nothing_is_stiff() -> None:
    law = KelvinVoigt(isotropic(1, 0.5), isotropic(1e-9, 1e-9), "soft")
    assert moduli(law).compliance(3.0) == pytest.approx(3 * np.linalg.inv(law.A.matrix))
