"""Every term of the bound is needed: for each a problem in which it is all that bounds the error.

u_h = ũ = 0, or σ̃ obeys the law wherever that is looked at: without the term y is round-off, and the error is not.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from sympy import exp

from manufactured import FrobeniusBall, KelvinVoigt, Kind, Yield, isotropic, t, unit_square
from manufactured.body import Body, Part, polygon
from manufactured.data import Data
from manufactured.factor import x1, x2
from manufactured.tensors import Array, Points
from study.bound.discretisation import Discretisation
from study.bound.enclosing import enclose
from study.bound.load_constants import load_constants
from study.bound.majorant import Interval, Majorant
from study.bound.trajectory import Parabola, SmoothedInTime, compute, prolongation
from study.fem.mesh import OneDiagonal
from study.solve.tableau import MIDPOINT
from study.stresses.composite import alfeld_split

NOTHING = 1e-9
"""What all other terms may be together, relative to the error."""
CLOSE = 0.97
"""The part of the true error that a trajectory on a finer mesh in short steps has at least."""
LAW = KelvinVoigt(isotropic(1, 0), isotropic(1, 0), "without contraction")
INTEGRALS = {"residual", "contact", "oscillation", "bending", "unseen"}


@dataclass(frozen=True)
class Alone:
    """A problem whose error one term bounds: what is on record of y, and the error, at the end and at its largest."""

    intervals: tuple[Interval, ...]
    at_end: float
    largest: float

    def total(self, name: str) -> float:
        return sum(float(getattr(one, name)) for one in self.intervals)


def starting_at_rest(body: Body, force: Callable[[Points], Callable[[float], Array]]) -> Data:
    """Data that are known at points and times only, f_0 alone."""
    none = (lambda part, x: lambda time: 0 * x), np.zeros_like, lambda x: np.zeros((3, *x.shape[1:]))
    return Data(body, LAW, force, *none)


def at_rest(data: Data, steps: int) -> Alone:
    """u_h = ũ = 0, whose error is u itself."""
    coarse = Discretisation(data, OneDiagonal()(data.body, 2))
    found = enclose(coarse, compute(coarse, MIDPOINT, steps), SmoothedInTime())
    fine = Discretisation(data, OneDiagonal()(data.body, 8))
    nodes = compute(fine, MIDPOINT, 64)
    J = prolongation(nodes.space, fine)
    sizes = [fine.norm(J @ node) for node in nodes.nodes]
    return Alone(found.intervals, CLOSE * sizes[-1], CLOSE * max(sizes))


def oscillating() -> Alone:
    """f_0 on every third the product of the differences of barycentric coordinates.

    It changes its sign when two of them are swapped, and so is orthogonal to all polynomials of degree 2.
    """
    body = unit_square()
    mesh, corners = alfeld_split(OneDiagonal()(body, 2))
    finder, edges = mesh.element_finder(), np.moveaxis(corners[:, 1:] - corners[:, :1], 2, 0)

    def force(x: Points) -> Callable[[float], Array]:
        flat = x.reshape(2, -1)
        cells = finder(*flat)
        b, c = np.linalg.solve(edges[cells], (flat - corners[:, 0, cells]).T[:, :, None])[..., 0].T
        a = 1 - b - c
        value = (1000 * (a - b) * (b - c) * (c - a)).reshape(x.shape[1:])
        return lambda time: np.array([0 * value, value])

    return at_rest(starting_at_rest(body, force), 2)


def between_samples() -> Alone:
    """f_0 vanishes at both ends and in the middle of every piece of ũ, where a parabola in time is taken through it."""
    steps = 4

    def in_time(time: float) -> float:
        half_a_step = min(time, 1 - time) < 1 / (2 * steps)
        return float(np.sin((4 if half_a_step else 2) * np.pi * time * steps))

    def force(x: Points) -> Callable[[float], Array]:
        return lambda time: np.array([0 * x[0], np.full(x.shape[1:], 10 * in_time(time))])

    return at_rest(starting_at_rest(unit_square(), force), steps)


def along_the_foundation(law: KelvinVoigt, traction: Callable[[float], float]) -> tuple[Discretisation, Array]:
    """The unit square held at its left side and pulled at its right one, and (x_1, 0), which slides along Γ3."""
    kinds = [Kind.CONTACT, Kind.LOADED, Kind.LOADED, Kind.CLAMPED]
    body = polygon([(0, 0), (1, 0), (1, 1), (0, 1)], kinds)

    def surface(part: Part, x: Points) -> Callable[[float], Array]:
        return lambda time: np.array([np.full(x.shape[1:], traction(time) * (part == body.parts[1])), 0 * x[0]])

    none = np.zeros_like, lambda x: np.zeros((3, *x.shape[1:]))
    data = Data(body, law, lambda x: lambda time: 0 * x, surface, *none)
    discretisation = Discretisation(data, OneDiagonal()(body, 2))
    mesh = discretisation.mesh
    first = np.array([*mesh.p[0], *mesh.p[0, mesh.facets].mean(axis=0)])
    return discretisation, np.array([first, 0 * first]).T.ravel()[discretisation.displacements.free]


def curved() -> Alone:
    """ũ = (t x_1, 0) in one piece. σ̃ is linear in time and obeys the law (3.3) at both ends, which has a kink between.

    The solution is (e x_1, 0) with A_11 ė + G(e)_11 = A_11 + t G(1)_11.
    """
    law = KelvinVoigt(isotropic(1, 0), Yield(3.0, FrobeniusBall(0.5)), "(3.3)")
    viscous = law.A.matrix[0, 0]

    def elastic(e: float) -> float:
        return float(law.G(np.array([[e], [0.0], [0.0]]))[0, 0])

    discretisation, v = along_the_foundation(law, lambda time: viscous + time * elastic(1.0))
    found = [interval for _, interval in Majorant(discretisation)([Parabola(0.0, 1.0, 0 * v, v / 2, v)], 0.0)]
    solved = solve_ivp(lambda time, e: [1 + (time * elastic(1.0) - elastic(e[0])) / viscous], (0, 1), [0.0], rtol=1e-8)
    off = abs(solved.y[0] - solved.t) * discretisation.norm(v)
    return Alone(tuple(found), float(off[-1]), float(off.max()))


PROBLEMS = {"oscillation": oscillating, "bending": between_samples, "residual": curved}
"""By what is on record: the curvature of Gε(ũ) in time is part of the residual."""


@pytest.mark.parametrize("name", PROBLEMS)
def test_a_term_bounds_an_error_that_no_other_one_sees(name: str) -> None:
    found = PROBLEMS[name]()
    assert found.at_end > 0.01
    others = sum(found.total(other) for other in INTEGRALS - {name})
    assert others <= NOTHING * found.at_end
    assert found.intervals[-1].at_b >= found.at_end
    assert max(one.inside for one in found.intervals) >= found.largest


@pytest.mark.parametrize("size", [0.01, 1.0, 10.0], ids=["within K", "partly beyond", "beyond"])
def test_between_knots_g_leaves_its_parabola_by_no_more_than_the_curvature_and_within_k_by_nothing(size: float) -> None:
    law = KelvinVoigt(isotropic(1, 0), Yield(3.0, FrobeniusBall(0.5)), "(3.3)")
    majorant = Majorant(along_the_foundation(law, lambda time: 0.0)[0])
    equilibration, rng = majorant.equilibration, np.random.default_rng(7)
    coefficients = size * rng.standard_normal((3, len(majorant.discretisation.displacements.free)))
    piece = Parabola(0.0, 1.0, *coefficients)
    left, right = (SimpleNamespace(elastic=equilibration.elastic(u)) for u in (piece.start, piece.end))
    control, curvature = majorant._elastic(piece, left, right)
    nodes, weights = np.polynomial.legendre.leggauss(20)
    missed = 0.0
    for x, weight in zip((1 + nodes) / 2, weights / 2, strict=True):
        parabola = (1 - x) ** 2 * left.elastic + 2 * x * (1 - x) * control + x**2 * right.elastic
        off = equilibration.elastic(piece.at(x)) - parabola
        missed += weight * np.sqrt(equilibration.products([equilibration.parts(off)]).sum())
    assert missed <= curvature
    assert (curvature > 0) == (missed > 0) == (size > 0.1)


def test_what_samples_miss_is_what_the_ranges_of_derivatives_give() -> None:
    """f_0 = t x_1⁴ on cells of the width 1/2: x_1⁴ less a cubic is at most 4⁻⁴, twice, in the norm C_Ω ‖·‖ at t = b."""
    data = Data.formulas(unit_square(), LAW, f0=(0, t * x1**4))
    discretisation = Discretisation(data, OneDiagonal()(data.body, 2))
    missed = discretisation.sampling.missed(discretisation.oscillation, 0.25, 0.5)
    assert missed.everywhere == pytest.approx(load_constants(data.body, LAW.A).volume * 2 * 0.5 / 4**4)
    assert missed.cells.min() > 0


def test_what_samples_miss_is_added_in_every_piece() -> None:
    """Elasticity takes no share of what is no part of a cell, and damps it no more than all else."""
    spike = -100 * t * exp(-((x1 - 0.37) ** 2 + (x2 - 0.41) ** 2) * 1e4)
    data = Data.formulas(unit_square(), LAW, f0=(0, spike))
    coarse = Discretisation(data, OneDiagonal()(data.body, 3))
    m = coarse.moduli.values.min()
    for one in enclose(coarse, compute(coarse, MIDPOINT, 3), SmoothedInTime()).intervals:
        assert one.unseen > 0.1 * one.at_b
        damped = np.exp(-m * (one.b - one.a))
        assert one.at_b >= damped * (one.at_a + one.unseen + one.bending)
        assert one.inside >= one.at_a + damped * (one.unseen + one.bending)
