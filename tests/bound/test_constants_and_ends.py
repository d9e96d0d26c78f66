"""The constants of the bound against suprema on fine meshes, and how the parts of an enclosure are put together."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse.linalg import eigsh
from skfem import Basis, BilinearForm, ElementTriP2, ElementVector, FacetBasis, LinearForm, MeshTri
from skfem.helpers import ddot, dot, sym_grad
from sympy import exp

from manufactured import Data, FrobeniusBall, KelvinVoigt, Kind, Yield, isotropic, polygon
from manufactured.factor import x1, x2
from manufactured.symbols import t
from study.bound import enclosing, majorant
from study.bound.discretisation import Discretisation
from study.bound.enclosing import Enclosure, enclose
from study.bound.growth import Added
from study.bound.load_constants import load_constants
from study.bound.majorant import Majorant
from study.bound.sampling import Evidence
from study.bound.trajectory import DiscreteSolution, Parabola, SmoothedInTime, compute, prolongation
from study.fem.mesh import OneDiagonal
from study.solve.tableau import MIDPOINT
from study.stresses.composite import CORNERS, SIDES
from study.stresses.oscillation import cell_constants, side_constants

LAW = KelvinVoigt(isotropic(1, 0), isotropic(1, 0), "without contraction")
BODY = polygon([(0, 0), (1, 0), (1, 1), (0, 1)], [Kind.CONTACT, Kind.LOADED, Kind.LOADED, Kind.CLAMPED])
COMPLIANCE = np.linalg.inv(LAW.A.matrix)
P2 = ElementVector(ElementTriP2())


@BilinearForm
def energy(u, v, w):
    return 2 * ddot(sym_grad(u), sym_grad(v))


@BilinearForm
def mass(u, v, w):
    return dot(u, v)


# ---- constants


@pytest.fixture(scope="module")
def on_the_square() -> tuple[float, float]:
    """sup ‖v‖_H/‖v‖_V and sup ‖v‖_{L²(Γ2)}/‖v‖_V for v of degree 2 on a mesh of 12 × 12 squares."""
    mesh = MeshTri.init_tensor(*2 * [np.linspace(0, 1, 13)])
    basis = Basis(mesh, P2)
    free = basis.complement_dofs(basis.get_dofs(lambda x: x[0] < 1e-9))
    loaded = FacetBasis(mesh, P2, facets=mesh.facets_satisfying(lambda x: x.max(axis=0) > 1 - 1e-9))
    every = energy.assemble(basis), mass.assemble(basis), mass.assemble(loaded)
    form, inside, outside = (each.tocsc()[free][:, free] for each in every)
    volume = eigsh(form, 1, inside, sigma=0, return_eigenvectors=False)[0]
    surface = eigsh(outside, 1, form, which="LA", return_eigenvectors=False)[0]
    return 1 / math.sqrt(volume), math.sqrt(surface)


def test_the_load_constants_are_above_the_suprema_on_a_fine_mesh_by_less_than_a_twelfth(on_the_square) -> None:
    """So that a constant scaled by 0.9 lies below."""
    found = load_constants(BODY, LAW.A)
    for constant, supremum in zip((found.volume, found.surface), on_the_square, strict=True):
        assert 1 <= constant / supremum < 13 / 12


def on_the_triangle(integrals: Basis, monomials: list[LinearForm]) -> float:
    """sup of ‖v − P v‖/‖ε(v)‖_A over v of degree 2 on a refined reference triangle, P the projection onto monomials."""
    basis = Basis(integrals.mesh, P2)
    w, Q = np.linalg.eigh(energy.assemble(basis).toarray())
    strained = (Q / np.sqrt(np.maximum(w, 1e-12)))[:, w > 1e-9]
    tests = np.array([form.assemble(integrals) for form in monomials])
    gram = np.array([[form_product(integrals, p, q) for q in monomials] for p in monomials])
    rest = mass.assemble(integrals).toarray() - tests.T @ np.linalg.solve(gram, tests)
    return math.sqrt(np.linalg.eigvalsh(strained.T @ rest @ strained)[-1])


def monomial(i: int, j: int, d: int) -> LinearForm:
    form = LinearForm(lambda v, w: w.x[0] ** i * w.x[1] ** j * v[d])
    form.powers = (i, j, d)
    return form


def form_product(basis: Basis, p: LinearForm, q: LinearForm) -> float:
    """∫ of the product of two monomials by the rule of a basis."""
    (i, j, d), (k, l, e) = p.powers, q.powers
    x = np.asarray(basis.global_coordinates())
    return float(np.sum(x[0] ** (i + k) * x[1] ** (j + l) * basis.dx)) if d == e else 0.0


REFERENCE = MeshTri.init_refdom().refined(3)


@pytest.mark.parametrize(("degree", "ratio"), [(1, 1.12), (2, 1.15)])
def test_the_constant_of_a_cell_is_above_the_supremum_by_what_its_derivation_loses(degree: int, ratio: float) -> None:
    """The bound C² ≤ 4λ/3 is above the supremum by an eighth or a seventh, on the reference triangle cut into 64."""
    monomials = [monomial(i, j, d) for i in range(degree + 1) for j in range(degree + 1 - i) for d in (0, 1)]
    supremum = on_the_triangle(Basis(REFERENCE, P2, intorder=6), monomials)
    (constant,) = cell_constants(np.eye(2)[None], COMPLIANCE, degree)
    assert constant / supremum == pytest.approx(ratio, abs=0.02)


@pytest.mark.parametrize("side", range(3))
def test_the_constant_of_a_side_is_above_the_supremum_by_what_its_derivation_loses(side: int) -> None:
    """The bound C² ≤ 2 λ is above the supremum by a third, on the reference triangle cut into 64."""
    a, b = (CORNERS[:, place] for place in SIDES[side])
    normal = np.array([(b - a)[1], -(b - a)[0]])
    facets = REFERENCE.facets_satisfying(lambda x: abs(normal @ (x - a[:, None])) < 1e-9)
    # Along a side of the reference triangle one of both coordinates is a function of the other.
    along = (1, 0) if a[0] != b[0] else (0, 1)
    monomials = [monomial(*(n * c for c in along), d) for n in (0, 1) for d in (0, 1)]
    supremum = on_the_triangle(FacetBasis(REFERENCE, P2, facets=facets, intorder=6), monomials)
    (constant,) = side_constants(np.eye(2)[None], COMPLIANCE, side)
    assert constant / supremum == pytest.approx(1.32, abs=0.02)


# ---- a nonlinear law


def test_the_term_of_a_nonlinear_law_is_a_third_of_the_largest_change_and_half_of_it_at_most() -> None:
    """β k |ε̇| 2θ(1 − θ) has the mean β k |ε̇|/3 and is β k |ε̇|/2 at most; |ε̇| is larger at the end of this piece."""
    beta, k = 4.0, 0.5
    law = KelvinVoigt(isotropic(1, 0), Yield(beta, FrobeniusBall(1e-3)), "yields at once")
    d = Discretisation(Data.formulas(BODY, law, (0, 0), {}, (0, 0)), OneDiagonal()(BODY, 2))
    first = np.array([*d.mesh.p[0], *d.mesh.p[0, d.mesh.facets].mean(axis=0)])
    v = np.array([first, 0 * first]).T.ravel()[d.displacements.free]
    found: list[Added] = []
    before = majorant.grown
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(majorant, "grown", lambda y, g, added: found.append(added) or before(y, g, added))
        list(Majorant(d)([Parabola(0.0, k, v, 1.1 * v, 1.5 * v)], 0.0))
    rate = 2 * (1.5 - 1.1) / k
    assert found[0].mean.rest == pytest.approx(beta * k * rate / 3 / math.sqrt(2), rel=1e-9)
    assert found[0].largest.rest == pytest.approx(beta * k * rate / 2 / math.sqrt(2), rel=1e-9)


def test_what_samples_miss_counts_at_every_time_of_a_step() -> None:
    """f_0 = t² x_1⁴ is a parabola in time: nothing but what samples miss is no part of a cell."""
    d = Discretisation(Data.formulas(BODY, LAW, (0, t**2 * x1**4), {}, (0, 0)), OneDiagonal()(BODY, 2))
    found: list[Added] = []
    before = majorant.grown
    zero = np.zeros(len(d.displacements.free))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(majorant, "grown", lambda y, g, added: found.append(added) or before(y, g, added))
        list(Majorant(d)([Parabola(0.0, 0.5, zero, zero, zero)], 0.0))
    missed = d.sampling.missed(d.oscillation, 0.0, 0.5).everywhere
    assert found[0].largest.rest == pytest.approx(missed, rel=1e-9) == found[0].mean.rest


# ---- the ends


def enclosure(**changes) -> Enclosure:
    """Three times with distances d and bounds y."""
    plain = Enclosure(
        0.5,
        np.array([0.25, 0.5, 1.0]),
        np.array([2.0, 1.0, 0.25]),
        np.array([0.5, 2.0, 0.25]),
        np.full(3, math.nan),
        (),
        1.0,
        np.zeros(1),
        np.array([2.75, 3.5, 1.0]),
        Evidence(()),
    )
    return replace(plain, **changes)


def test_both_ends_of_an_enclosure_differ_from_the_distance_by_the_bound() -> None:
    found = enclosure()
    assert found.lower.tolist() == [1.5, 0.0, 0.0]
    assert found.upper.tolist() == [2.5, 3.0, 0.5]
    assert (found.lowest, found.highest) == (1.5, 3.5)
    assert enclosure(start=4.0).highest == 4.0


def test_between_knots_the_bound_inside_an_interval_and_the_distance_both_count(monkeypatch) -> None:
    d = Discretisation(Data.formulas(BODY, LAW, (0, t), {}, (0, 0)), OneDiagonal()(BODY, 2))
    monkeypatch.setattr(enclosing, "_largest_distance", lambda *arguments: 7.0)
    found = enclose(d, compute(d, MIDPOINT, 2), SmoothedInTime())
    assert found.between == pytest.approx([one.inside + 7 for one in found.intervals], rel=1e-14)


def test_the_distance_between_knots_is_the_largest_of_a_curve_that_is_zero_at_both() -> None:
    """ũ = 2θ(1 − θ) v and u_h = 0: ‖v‖/2 in the middle, where ũ is largest."""
    d = Discretisation(Data.formulas(BODY, LAW, (0, 0), {}, (0, 0)), OneDiagonal()(BODY, 2))
    computed = compute(d, MIDPOINT, 2)
    v = np.random.default_rng(0).standard_normal(len(d.displacements.free))
    J = prolongation(computed.space, d)
    piece = Parabola(0.0, 0.25, 0 * v, v, 0 * v)
    assert enclosing._largest_distance(d, piece, computed, J) == pytest.approx(d.norm(v) / 2, rel=1e-12)


def test_the_distance_between_knots_counts_where_the_curve_is_largest_between_the_times_that_are_looked_at() -> None:
    """ũ = (2θ − 3θ²/2) v and u_h = 0: 2/3 ‖v‖ at θ = 2/3, 5/8 ‖v‖ in the middle and 1/2 ‖v‖ at the end."""
    d = Discretisation(Data.formulas(BODY, LAW, (0, 0), {}, (0, 0)), OneDiagonal()(BODY, 2))
    computed = compute(d, MIDPOINT, 2)
    v = np.random.default_rng(0).standard_normal(len(d.displacements.free))
    piece = Parabola(0.0, 0.25, 0 * v, v, v / 2)
    found = enclosing._largest_distance(d, piece, computed, prolongation(computed.space, d))
    assert 2 / 3 * d.norm(v) <= found <= 3 / 4 * d.norm(v) * (1 + 1e-12)


# ---- data that samples hardly see, from the data to the interval


def true_error(coarse: Discretisation, computed: DiscreteSolution) -> float:
    """The largest error of u_h at its nodes, against the displacement on a mesh and with steps eight times finer."""
    fine = Discretisation(coarse.data, coarse.mesh.refined(3))
    reference = compute(fine, MIDPOINT, 8 * computed.steps)
    J, K = prolongation(reference.space, fine), prolongation(computed.space, fine)
    return max(fine.norm(J @ u - K @ v) for u, v in zip(reference.nodes[::8], computed.nodes, strict=True))


PEAK = exp(-4000 * ((x2 - 0.53) ** 2))
"""A peak with a width of a fiftieth, which the coarse mesh hardly sees."""


@pytest.mark.parametrize(
    "problem",
    [
        {"f2": {1: (40 * t * PEAK, 0)}},
        {"f0": (0, 40 * t * exp(-2000 * ((x1 - 0.53) ** 2 + (x2 - 0.53) ** 2)))},
        {"f0": (40 * exp(-4000 * (t - 0.56) ** 2), 0)},
        {"f2": {1: (40 * exp(-4000 * (t - 0.56) ** 2), 0)}},
        {"u0": (x1 * exp(-2000 * ((x1 - 0.53) ** 2 + (x2 - 0.53) ** 2)) / 8, 0)},
    ],
    ids=["f_2 in space", "f_0 in space", "f_0 in time", "f_2 in time", "u_0"],
)
def test_a_narrow_peak_that_a_coarse_mesh_hardly_sees_does_not_escape_the_bound(problem) -> None:
    data = Data.formulas(BODY, LAW, **{"f0": (0, 0), "f2": {}, "u0": (0, 0)} | problem)
    d = Discretisation(data, OneDiagonal()(BODY, 2))
    computed = compute(d, MIDPOINT, 4)
    found = enclose(d, computed, SmoothedInTime())
    assert found.evidence.kind == "guaranteed"
    assert found.lowest <= true_error(d, computed) <= found.highest
