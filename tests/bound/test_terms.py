"""Each term of the bound, in a problem in which it is all that counts.

Every term is computed a second time by hand, and both values must agree: a term that is left out, scaled by 0.9, or a
minimum for a mean has another value. For terms that bound an error which no other term sees, the error is computed.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from sympy import Rational

from manufactured import (
    Data,
    FrobeniusBall,
    Indefinite,
    KelvinVoigt,
    Kind,
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
from manufactured.tensors import Array
from study.bound.discretisation import Discretisation
from study.bound.enclosing import enclose
from study.bound.growth import Sizes, Step, grow, kernel
from study.bound.problem import load_constants, moduli
from study.bound.remainders import CUBIC, PARABOLA
from study.bound.terms import Majorant, Terms
from study.bound.trajectory import Parabola, SmoothedInTime, compute
from study.fem.mesh import OneDiagonal
from study.solve.tableau import MIDPOINT
from study.stresses.loads import LeftOut

LAW = KelvinVoigt(isotropic(1, 0), isotropic(1, 0), "without contraction")
BODY = polygon([(0, 0), (1, 0), (1, 1), (0, 1)], [Kind.CONTACT, Kind.LOADED, Kind.LOADED, Kind.CLAMPED])
"""Held at the left side."""
N = 2
EDGE, CELL = 1 / N, 1 / (2 * N * N)
"""Length of an edge and area of a cell."""
Values = tuple[float, float]
"""What the program computes, and the value by hand."""


def discretised(f0=(0, 0), f2=None, u0=(0, 0)) -> Discretisation:
    return Discretisation(Data.formulas(BODY, LAW, f0, f2 or {}, u0), OneDiagonal()(BODY, N))


def quadratic(d: Discretisation, polar: Callable[[Array, Array], Array], component: int = 0) -> Array:
    """A displacement of degree 2 in one component, by its polar form in x_1, (dofs,)."""
    x = d.mesh.p[0]
    values = polar(*np.hstack([[x, x], x[d.mesh.facets]]))
    return np.outer(values, np.eye(2)[component]).ravel()[d.displacements.free]


# ---- what samples miss


def missed(expected: float, f0=(0, 0), f2=None, a: float = 0.25, b: float = 0.5) -> Values:
    """In the dual of V: C_Ω or C_Γ times a norm."""
    d = discretised(f0, f2)
    constants = load_constants(BODY, LAW.A)
    constant = constants.surface if f2 else constants.volume
    return d.sampling.missed(d.oscillation, a, b).everywhere, constant * expected


def missed_in_cells(f0=(0, 0), f2=None, inside: float = 0.0, on_edges: float = 0.0) -> Values:
    """What is added to η_T, for the same remainder in all cells, or on all edges of the right side."""
    d = discretised(f0, f2)
    (edges,) = (edges for part, edges in d.stresses.on(Kind.LOADED) if part is BODY.parts[1])
    cells, sides = np.full(d.stresses.cells, inside * math.sqrt(CELL)), np.zeros(len(d.stresses.lengths))
    sides[edges] = on_edges * math.sqrt(EDGE)
    found = d.sampling.missed(d.oscillation, 0.25, 0.5).cells
    return float(np.linalg.norm(found)), float(np.linalg.norm(d.oscillation(LeftOut(cells, cells, sides))))


def missed_at_start(u0, expected: float) -> Values:
    return discretised(u0=u0).sampling.missed_at_start(), expected


START = 2 * math.sqrt(2) * (EDGE / 2) ** 4
"""u_0 = (x_1⁵/5, 0): ε_11 = x_1⁴ less a cubic is at most (EDGE/2)⁴, and ‖A‖ = 2."""
MISSED: dict[str, Callable[[], Values]] = {
    # x_1⁴ less a cubic is at most (EDGE/2)⁴ on a cell; the largest t is 1/2.
    "f_0 in space": lambda: missed(2 * 0.5 * (EDGE / 2) ** 4 * math.sqrt(2 * N * N * CELL), (0, t * x1**4)),
    # Four parts of an edge of half width EDGE/8, the same remainder on each.
    "f_2 in space": lambda: missed(2 * 0.5 * (EDGE / 8) ** 4, f2={1: (t * x2**4, 0)}),
    # A step in one of the four parts of one edge: half its height there, 0 on the other three.
    "f_2 on one part of an edge": lambda: missed(
        2 * 0.5 * math.sqrt(EDGE / 4), f2={1: (pos(x2 - Rational(1, 16), 0), 0)}, a=0.0
    ),
    # t⁴ less a cubic through four times is at most CUBIC (k/2)⁴.
    "f_0 in time": lambda: missed(CUBIC * 0.125**4, (0, t**4)),
    "f_2 in time": lambda: missed(CUBIC * 0.125**4, f2={1: (t**4, 0)}),
    "f_0 in space, in cells": lambda: missed_in_cells((0, x1**4), inside=(EDGE / 2) ** 4),
    "f_0 in time, in cells": lambda: missed_in_cells((0, t**3), inside=PARABOLA * 0.125**3),
    "f_2 in space, in cells": lambda: missed_in_cells(f2={1: (x2**4, 0)}, on_edges=(EDGE / 8) ** 4),
    "f_2 in time, in cells": lambda: missed_in_cells(f2={1: (t**3, 0)}, on_edges=PARABOLA * 0.125**3),
    "u_0": lambda: missed_at_start((x1**5 / 5, 0), START),
    "shear of u_0": lambda: missed_at_start((0, x1**5 / 5), START / math.sqrt(2)),
}


# ---- the terms of one piece


def terms_of(d: Discretisation, piece: Parabola | None = None) -> Terms:
    """The terms of one piece, or of ũ = 0 on [0, 1/2]."""
    zero = np.zeros(len(d.displacements.free))
    (found,) = Majorant(d).terms([piece or Parabola(0.0, 0.5, zero, zero, zero)])
    return found


def bending() -> Values:
    """f_0 = t³: a quarter into [0, 1/2] it is (1/2)³ · 3/64 off its parabola; ‖(1, 0)‖ in the dual of V is √(1/6)."""
    found = terms_of(discretised((t**3, 0)))
    return found.step().mean.rest - found.missed.everywhere, 3 / 64 / 8 * math.sqrt(1 / 6)


def largest_bending() -> Values:
    """The largest value of |θ(θ − 1/2)(θ − 1)| is √3/36; the bound may be a thousandth above it, and not below."""
    found = terms_of(discretised((t**3, 0)))
    value, least = found.step().largest.rest - found.missed.everywhere, math.sqrt(3) / 36 / 8 * math.sqrt(1 / 6)
    return (least if least <= value <= 1.001 * least else value), least


def rest(which: str) -> Values:
    """f_0 = t² x_1⁴ has no bending: the only term that belongs to no cell is what samples miss."""
    d = discretised((0, t**2 * x1**4))
    value = getattr(terms_of(d).step(), which).rest
    return value, d.sampling.missed(d.oscillation, 0.0, 0.5).everywhere


def oscillation(which: str) -> Values:
    """f_0 = x_1⁴ at all times: the mean square of η_T is 41/30 of it, and the largest value (5/4)² of it."""
    d = discretised((0, x1**4))
    cells = d.oscillation(d.snapshot(0.1).left_out) + d.sampling.missed(d.oscillation, 0.0, 0.5).cells
    value = float(getattr(terms_of(d).step(), which).oscillation.sum())
    return value, {"mean": 41 / 30, "largest": 1.5625}[which] * float(cells @ cells)


def curvature(which: str) -> Values:
    """β k |ε̇| 2θ(1 − θ) has the mean β k |ε̇|/3 and is β k |ε̇|/2 at most; |ε̇| is larger at the end of this piece."""
    beta, k = 4.0, 0.5
    law = KelvinVoigt(isotropic(1, 0), Yield(beta, FrobeniusBall(1e-3)), "yields at once")
    d = Discretisation(Data.formulas(BODY, law, (0, 0), {}, (0, 0)), OneDiagonal()(BODY, N))
    v = quadratic(d, lambda x, y: (x + y) / 2)
    rest = getattr(terms_of(d, Parabola(0.0, k, v, 1.1 * v, 1.5 * v)).step(), which).rest
    return rest, beta * 2 * (1.5 - 1.1) / {"mean": 3, "largest": 2}[which] / math.sqrt(2)


STEP: dict[str, Callable[[], Values]] = {
    "bending": bending,
    "largest bending": largest_bending,
    **{
        f"{term.__name__}, {which}": lambda term=term, which=which: term(which)
        for term in (rest, oscillation, curvature)
        for which in ("mean", "largest")
    },
}


# ---- the start


def start(u0, expected: float, sampled: float = 0.0) -> Values:
    """The bound at the start, minus some times what samples see of u_0 − ũ(0)."""
    d = discretised(u0=u0)
    found = enclose(d, compute(d, MIDPOINT, 2), SmoothedInTime())
    return found.intervals[0].at_a - sampled * math.sqrt(float(found.initial.sum())), expected


STARTS: dict[str, Callable[[], Values]] = {
    # u_0 = (x_1²/2, 0) less its interpolant, of slope x_1 − the mean over a column: 2 ∫ (…)² = 2 EDGE²/12.
    "start": lambda: start((x1**2 / 2, 0), math.sqrt(2 * EDGE**2 / 12)),
    # What samples of u_0 miss is added to what they see.
    "start that samples miss": lambda: start((x1**5 / 5, 0), START, sampled=1.0),
}
TERMS = MISSED | STEP | STARTS


@pytest.mark.parametrize("name", TERMS)
def test_a_term_has_the_value_that_is_computed_by_hand(name: str) -> None:
    found, expected = TERMS[name]()
    assert expected > 0
    assert found == pytest.approx(expected, rel=1e-6)


# ---- a problem in which σ̃ obeys the law at all times that are sampled: y is one term


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
