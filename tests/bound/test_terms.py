"""Each term of the bound, in a problem in which it is all that counts.

Every term is computed a second time by hand, and both values must agree: a term that is left out, scaled by 0.9, or a
minimum for a mean has another value. For terms that bound an error which no other term sees, the error is computed.
"""

import math

import numpy as np
import pytest
from bodies import CLAMPED, CONTACT, LOADED, SQUARE, YIELDS
from bodies import LAW as ISOTROPIC
from hypothesis import given
from measures import gauss
from on_meshes import discretised_on
from random_examples import RANDOM
from scipy.integrate import solve_ivp
from sympy import Rational

from manufactured import (
    Combined,
    Data,
    FrobeniusBall,
    Indefinite,
    KelvinVoigt,
    Linear,
    Yield,
    isotropic,
    isotropic_matrix,
    named,
    polygon,
    pos,
    t,
)
from manufactured.factor import Factor, x1, x2
from study.bound.enclosing import enclose
from study.bound.problem import load_constants, moduli
from study.bound.remainders import CUBIC_FACTOR, PARABOLA_FACTOR
from study.bound.terms import QUADRATIC, Majorant, Sizes, Step, grow, kernel, largest_square, mean_square
from study.bound.trajectory import Parabola, SmoothedInTime, compute
from study.fem.quadrature import bernstein
from study.solve.tableau import MIDPOINT
from study.stresses.loads import LeftOut

LAW = KelvinVoigt(isotropic(1, 0), isotropic(1, 0), "without contraction")
BODY = polygon(SQUARE, [CONTACT, LOADED, LOADED, CLAMPED])
"""Held at the left side."""
N = 2
EDGE = 1 / N
CELL = 1 / (2 * N * N)
"""Length of an edge and area of a cell."""


def discretised(f0=(0, 0), f2=None, u0=(0, 0), law=LAW):
    return discretised_on(Data.formulas(BODY, law, f0, f2 or {}, u0), N)


def quadratic(d, polar, component, variable=0):
    """A displacement of degree 2 in one component, by its polar form in one variable, x_1 or x_2, (dofs,)."""
    x = d.mesh.p[variable]
    values = polar(*np.hstack([[x, x], x[d.mesh.facets]]))
    return np.outer(values, np.eye(2)[component]).ravel()[d.displacements.free]


def stretch(d, component=0):
    """The displacement (x_1, 0), or (0, x_1), (dofs,)."""
    return quadratic(d, lambda x, y: (x + y) / 2, component)


# ---- what samples miss


def missed(expected, f0=(0, 0), f2=None, a=0.25):
    """In the dual of V: C_Ω or C_Γ times a norm."""
    d = discretised(f0, f2)
    constants = load_constants(BODY, LAW.A)
    constant = constants.surface if f2 else constants.volume
    return d.sampling.missed(d.oscillation, a, 0.5).everywhere, constant * expected


def missed_in_cells(f0=(0, 0), f2=None, inside=0.0, on_edges=0.0):
    """What is added to η_T, for the same remainder in all cells, or on all edges of the right side."""
    d = discretised(f0, f2)
    (edges,) = (edges for part, edges in d.stresses.on(LOADED) if part is BODY.parts[1])
    cells = np.full(d.stresses.cells, inside * math.sqrt(CELL))
    sides = np.zeros(len(d.stresses.lengths))
    sides[edges] = on_edges * math.sqrt(EDGE)
    found = d.sampling.missed(d.oscillation, 0.25, 0.5).cells
    return float(np.linalg.norm(found)), float(np.linalg.norm(d.oscillation(LeftOut(cells, cells, sides))))


def missed_at_start(u0, expected):
    return discretised(u0=u0).sampling.missed_at_start(), expected


START = 2 * math.sqrt(2) * (EDGE / 2) ** 4
"""u_0 = (x_1⁵/5, 0): ε_11 = x_1⁴ less a cubic is at most (EDGE/2)⁴, and ‖A‖ = 2."""
MISSED = {
    # Twice as much may be missed as a half of it: x_1⁴ less a cubic is at most (EDGE/2)⁴ on a cell, and t at most 1/2.
    "f_0 in space": lambda: missed((EDGE / 2) ** 4 * math.sqrt(2 * N * N * CELL), (0, t * x1**4)),
    # Four parts of an edge of half width EDGE/8, the same remainder on each.
    "f_2 in space": lambda: missed((EDGE / 8) ** 4, f2={1: (t * x2**4, 0)}),
    # A step in one of the four parts of one edge: half its height there, 0 on the other three.
    "f_2 on one part of an edge": lambda: missed(
        2 * 0.5 * math.sqrt(EDGE / 4), f2={1: (pos(x2 - Rational(1, 16), 0), 0)}, a=0.0
    ),
    # t⁴ less a cubic through four times is at most CUBIC_FACTOR (k/2)⁴.
    "f_0 in time": lambda: missed(CUBIC_FACTOR * 0.125**4, (0, t**4)),
    "f_2 in time": lambda: missed(CUBIC_FACTOR * 0.125**4, f2={1: (t**4, 0)}),
    "f_0 in space, in cells": lambda: missed_in_cells((0, x1**4), inside=(EDGE / 2) ** 4),
    "f_0 in time, in cells": lambda: missed_in_cells((0, t**3), inside=PARABOLA_FACTOR * 0.125**3),
    "f_2 in space, in cells": lambda: missed_in_cells(f2={1: (x2**4, 0)}, on_edges=(EDGE / 8) ** 4),
    "f_2 in time, in cells": lambda: missed_in_cells(f2={1: (t**3, 0)}, on_edges=PARABOLA_FACTOR * 0.125**3),
    "u_0": lambda: missed_at_start((x1**5 / 5, 0), START),
    "shear of u_0": lambda: missed_at_start((0, x1**5 / 5), START / math.sqrt(2)),
}


# ---- the terms of one piece


def terms_of(d, piece=None):
    """The terms of one piece, or of ũ = 0 on [0, 1/2]."""
    zero = np.zeros(len(d.displacements.free))
    (found,) = Majorant(d).terms([piece or Parabola(0.0, 0.5, zero, zero, zero)])
    return found


def bending():
    """f_0 = t³: a quarter into [0, 1/2] it is (1/2)³ · 3/64 off its parabola; ‖(1, 0)‖ in the dual of V is √(1/6)."""
    found = terms_of(discretised((t**3, 0)))
    return found.step().mean.rest - found.missed.everywhere, 3 / 64 / 8 * math.sqrt(1 / 6)


def largest_bending():
    """The largest value of |θ(θ − 1/2)(θ − 1)| is √3/36; the bound may be a thousandth above it, and not below."""
    found = terms_of(discretised((t**3, 0)))
    value = found.step().largest.rest - found.missed.everywhere
    least = math.sqrt(3) / 36 / 8 * math.sqrt(1 / 6)
    return (least if least <= value <= 1.001 * least else value), least


def both(step, term):
    """The mean of a term over a step, and its largest value, each as a sum over cells."""
    return [float(np.sum(getattr(size, term))) for size in (step.mean, step.largest)]


def rest():
    """f_0 = t² x_1⁴ has no bending: the only term that belongs to no cell is what samples miss."""
    d = discretised((0, t**2 * x1**4))
    return both(terms_of(d).step(), "rest"), 2 * [d.sampling.missed(d.oscillation, 0.0, 0.5).everywhere]


def residual():
    """ũ = t (x_1, 0) without load: ρ = −(2 + 2t) in σ_11, and the square of it over A = 2; t is at most 1/2."""
    d = discretised()
    v = stretch(d)
    return both(terms_of(d, Parabola(0.0, 0.5, 0 * v, v / 4, v / 2)).step(), "residual"), [19 / 6, 9 / 2]


def oscillation():
    """f_0 = x_1⁴ at all times: the mean square of η_T is 41/30 of it, and the largest value (5/4)² of it."""
    d = discretised((0, x1**4))
    cells = d.oscillation(d.snapshot(0.1).left_out) + d.sampling.missed(d.oscillation, 0.0, 0.5).cells
    return both(terms_of(d).step(), "oscillation"), np.array([41 / 30, 1.5625]) * (cells @ cells)


def contact():
    """ũ = (1 + 2t) (0, x_1 (2 − x_1)) opens Γ3, f_0 presses the body on it: ∫ σ̃_ν ũ_ν by Gauss's rule."""
    d = discretised((0, -20 * (1 + t)))
    v = quadratic(d, lambda x, y: x + y - x * y, 1)
    a, m, b = (d.snapshot(time).loads for time in (0.0, 0.25, 0.5))
    loads = a, 2.0 * m + (-0.5) * (a + b), b
    factors = 1.0, 1.5, 2.0
    nearest = [
        d.nearest_stress(load, d.viscous(2 * v) + d.elastic(u), u)
        for load, u in zip(loads, [factor * v for factor in factors], strict=True)
    ]
    (edges,) = (edges for _, edges in d.stresses.on(CONTACT))
    s, w = gauss(6)
    shapes = bernstein(3, np.array([1 - s, s]))
    ends = d.mesh.p[0, d.mesh.facets[:, edges]]
    x = ends[0, :, None] + np.outer(ends[1] - ends[0], s)
    works = [np.sum(-d.equilibrium.pressure(stress) @ shapes * -x * (2 - x) * w) * EDGE for stress in nearest]
    products = np.outer(works, factors)
    step = terms_of(d, Parabola(0.0, 0.5, v, 1.5 * v, 2 * v)).step()
    return both(step, "contact"), [np.vdot(QUADRATIC, products), products.max()]


def curvature():
    """β k |ε̇| 2θ(1 − θ) has the mean β k |ε̇|/3 and is β k |ε̇|/2 at most; |ε̇| is larger at the end of this piece."""
    beta = 4.0
    k = 0.5
    law = KelvinVoigt(isotropic(1, 0), Yield(beta, FrobeniusBall(1e-3)), "yields at once")
    d = discretised(law=law)
    v = stretch(d) + stretch(d, 1)
    expected = beta * 2 * (1.5 - 1.1) / np.array([3, 2]) * math.sqrt((1 + 1 / 2) / 2)
    return both(terms_of(d, Parabola(0.0, k, v, 1.1 * v, 1.5 * v)).step(), "rest"), expected


def stepped(expected, residual=0.0, oscillation=0.0, contact=0.0, rest=0.0):
    """One step of length 1/2 from y = 0 without elasticity, of one term alone."""
    size = Sizes(np.full((1, 4), residual**2 / 4), np.full(4, oscillation**2 / 4), contact, rest)
    return grow(0.0, np.zeros(1), Step(0.5, size, size))[0], expected


STEP = {
    "step by contact": lambda: stepped(math.sqrt(2), contact=2.0),  # (2 k c)^½
    "bending": bending,
    "largest bending": largest_bending,
    **{term.__name__: term for term in (rest, residual, oscillation, contact, curvature)},
    **{
        f"step by {term}": lambda term=term: stepped(1.0, **{term: 2.0}) for term in ("residual", "oscillation", "rest")
    },
}


# ---- the start


def start(u0, expected, sampled=0.0):
    """The bound at the start, minus some times what samples see of u_0 − ũ(0)."""
    d = discretised(u0=u0)
    found = enclose(d, compute(d, MIDPOINT, 2), SmoothedInTime())
    return found.intervals[0].at_a - sampled * math.sqrt(float(found.initial.sum())), expected


STARTS = {
    # u_0 = (x_1²/2, 0) less its interpolant, of slope x_1 − the mean over a column: 2 ∫ (…)² = 2 EDGE²/12.
    "start": lambda: start((x1**2 / 2, 0), math.sqrt(2 * EDGE**2 / 12)),
    # What samples of u_0 miss is added to what they see.
    "start that samples miss": lambda: start((x1**5 / 5, 0), START, sampled=1.0),
}
TERMS = MISSED | STEP | STARTS


@pytest.mark.parametrize("name", TERMS)
def test_a_term_has_the_value_that_is_computed_by_hand(name):
    found, expected = TERMS[name]()
    assert np.min(expected) > 0
    assert found == pytest.approx(expected)


@pytest.mark.parametrize("multiples", [(0.1, 0.2, 0.1), (9.0, 0.2, 0.1), (0.1, 9.0, 0.1), (0.1, 0.2, 9.0)], ids=str)
def test_g_leaves_its_parabola_unless_all_of_the_piece_stays_in_k(multiples):
    d = discretised(law=KelvinVoigt(isotropic(1, 0), Yield(3.0, FrobeniusBall(0.5)), "(3.3)"))
    step = terms_of(d, Parabola(0.0, 1.0, *np.multiply.outer(multiples, stretch(d)))).step()
    assert (step.mean.rest > 0) == (step.largest.rest > 0) == (max(multiples) > 0.5)


def constant(k, residual, contact=0.0, rest=0.0):
    """A step in which nothing changes, of a residual (directions,) on one cell."""
    sizes = Sizes(residual[:, None] ** 2, np.zeros(1), contact, rest)
    return Step(k, sizes, sizes)


def random_step(rng):
    """Moduli over six decades, an error, a residual that is constant in a step, and what the step adds."""
    g = 10 ** rng.uniform(-3, 3, 3)
    r = rng.normal(size=3)
    e = rng.normal(size=3)
    e *= 10 ** rng.uniform(-2, 1)
    k = 10 ** rng.uniform(-3, 0)
    contact = float(rng.choice([0.0, 10 ** rng.uniform(-3, 0)]))
    return g, r, e, constant(k, r, contact / k)


def worst(g, r, e, step):
    """|e| over a step of e' = r − g e + c e/|e|², for which the inequality of the bound is an equality."""

    def rate(_, x):
        return r - g * x + step.mean.contact * x / max(float(x @ x), 1e-30)

    solved = solve_ivp(rate, (0, step.k), e, method="LSODA", rtol=1e-9, atol=1e-12)
    return np.linalg.norm(solved.y, axis=0)


@given(RANDOM)
def test_a_step_bounds_the_error_at_its_end_and_within(rng):
    g, r, e, step = random_step(rng)
    sizes = worst(g, r, e, step)
    at_b, inside = grow(float(np.linalg.norm(e)), g, step)
    assert sizes[-1] <= at_b * (1 + 1e-6)
    assert sizes.max() <= inside * (1 + 1e-6)
    assert at_b <= inside * (1 + 1e-12)


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
)
def test_elasticity_takes_up_a_residual_in_a_stiff_direction(y, moduli_, residual, least, most):
    at_b, _ = grow(y, np.array(moduli_, dtype=float), constant(K, np.array(residual, dtype=float)))
    assert least <= at_b <= most


@pytest.mark.parametrize("stiffness", [1e2, 1e4, 1e6])
def test_what_a_long_step_of_stiff_elasticity_leaves_is_the_error_at_rest(stiffness):
    """|r|/g from the residual, √(c/g) from contact, and what is no part of a cell over g: not the integrals."""
    g = np.full(3, stiffness)
    r = np.array([0.3, -1.0, 0.5])
    assert grow(1.0, g, constant(1.0, r))[0] == pytest.approx(np.linalg.norm(r) / stiffness)
    assert grow(1.0, g, constant(1.0, 0 * r, contact=2.0))[0] == pytest.approx(np.sqrt(2.0 / stiffness))
    assert grow(1.0, g, constant(1.0, 0 * r, rest=2.0))[0] == pytest.approx(2.0 / stiffness)


def test_negative_moduli_let_the_error_grow():
    still = constant(0.5, np.zeros(3))
    assert grow(1.0, np.array([-2.0, 1.0, 1.0]), still) == pytest.approx((np.exp(1.0), np.exp(1.0)))
    assert kernel(0.0, 0.25) == 0.25
    assert kernel(1e-9, 0.25) == pytest.approx(0.25)


def test_the_square_of_a_parabola_is_bounded_by_the_absolute_values_of_lagrange_polynomials(rng):
    """By Gauss's rule on both halves, in which no polynomial changes its sign."""
    norms = rng.random(3)
    x, w = gauss(3)
    x = np.concatenate([x, 1 + x]) / 2
    sizes = norms @ abs(np.array([(1 - x) * (1 - 2 * x), 4 * x * (1 - x), x * (2 * x - 1)]))
    assert mean_square(norms) == pytest.approx(np.tile(w, 2) @ sizes**2 / 2)
    assert largest_square(norms) >= sizes.max() ** 2


@pytest.mark.parametrize(
    "law",
    [
        ISOTROPIC,
        KelvinVoigt(isotropic(1, 1e4), Linear(np.diag([1.0, 2.0, 3.0])), "anisotropic"),
        YIELDS,
        KelvinVoigt(isotropic(1, 10), Combined(np.zeros(3), isotropic(1, 0), Yield(0.1, FrobeniusBall(1))), "combined"),
        *(named(name).solution.law for name in ("anisotropic", "softening", "double-well")),
    ],
)
def test_moduli_bound_the_work_of_differences_from_below(law, rng):
    found = moduli(law)
    one, other = rng.normal(size=(2, 3, 200))
    parts = found.directions.T @ law.A.matrix @ (one - other)
    work = np.einsum("In,In->n", law.G(one) - law.G(other), one - other)
    assert (work >= found.values @ parts**2 - 1e-9 * abs(work)).all()
    assert np.einsum("in->n", parts**2) == pytest.approx(np.einsum("In,In->n", law.A(one - other), one - other))
    if isinstance(law.G, Linear):
        assert work == pytest.approx(found.values @ parts**2)


def test_moduli_of_a_material_that_varies_take_the_worst_of_both_factors(rng):
    """Stiff directions by the least G over the largest A, those that soften by the largest G over the least A."""
    A = isotropic(1, 0.5, factor=Factor(1 + x1, 1.0, 2.0))
    law = KelvinVoigt(A, Indefinite(isotropic_matrix(0.5, -1.5), Factor(4 - x1, 3.0, 4.0)), "varies")
    found = moduli(law)
    x = np.linspace(0, 1, 9)[None]
    for strain in rng.normal(size=(50, 3, 1)):
        parts = found.directions.T @ A.matrix @ strain
        local = np.sum(law.G.at(x)(np.broadcast_to(strain, (3, 9))) * strain, axis=0)
        assert (local >= A.factor(x) * (found.values @ parts**2) - 1e-12).all()
    assert found.values.min() == pytest.approx(-2 / 3 * 4)


def test_the_norm_of_residuals_is_that_of_viscosity_where_nothing_is_stiff():
    law = KelvinVoigt(isotropic(1, 0.5), isotropic(1e-9, 1e-9), "soft")
    assert moduli(law).compliance(3.0) == pytest.approx(3 * np.linalg.inv(law.A.matrix))
