"""Constants of bodies and cells against suprema on fine meshes, and how an enclosure is made of distance and bound."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse.linalg import eigsh
from skfem import Basis, BilinearForm, ElementTriP2, ElementVector, FacetBasis, MeshTri
from skfem.helpers import dot
from skfem.models.elasticity import linear_elasticity
from test_terms import BODY, LAW, discretised

from manufactured import Kind, unit_square
from manufactured.problems import problems
from manufactured.symbols import t
from study.bound import enclosing, problem
from study.bound.enclosing import Enclosure, enclose, relative
from study.bound.problem import load_constants
from study.bound.remainders import Evidence
from study.bound.trajectory import Parabola, SmoothedInTime, compute
from study.fem.mesh import Unstructured
from study.solve.tableau import MIDPOINT
from study.stresses.oscillation import cell_constants, loaded_sides

P2 = ElementVector(ElementTriP2())


energy = linear_elasticity(Lambda=0, Mu=1)


@BilinearForm
def mass(u, v, w):
    return dot(u, v)


# ---- constants


def suprema(body, mesh):
    """sup ‖v‖_H/‖v‖_V and sup ‖v‖_{L²(Γ2)}/‖v‖_V for v of degree 2 on a mesh."""

    def on(kind):
        return mesh.facets_satisfying(lambda x: np.any([p.contains(x, 1e-9) for p in body.of(kind)], axis=0), True)

    basis = Basis(mesh, P2)
    free = basis.complement_dofs(basis.get_dofs(on(Kind.CLAMPED)))
    every = energy.assemble(basis), mass.assemble(basis), mass.assemble(FacetBasis(mesh, P2, facets=on(Kind.LOADED)))
    form, inside, outside = (each.tocsc()[free][:, free] for each in every)
    volume, surface = (eigsh(each, 1, form, which="LA", return_eigenvectors=False)[0] for each in (inside, outside))
    return math.sqrt(volume), math.sqrt(surface)


@pytest.mark.parametrize(
    ("body", "most"),
    [(BODY, 13 / 12), (unit_square(), 1.5), *((problem.data.body, 1.5) for problem in problems())],
)
def test_load_constants_are_above_the_suprema_on_a_fine_mesh_and_close(body, most):
    """On the square held at its left side by less than a twelfth, so that a constant scaled by 0.9 lies below."""
    found = load_constants(body, LAW.A)
    mesh = MeshTri.init_tensor(*2 * [np.linspace(0, 1, 13)]) if body is BODY else Unstructured()(body, 6)
    for constant, supremum in zip((found.volume, found.surface), suprema(body, mesh), strict=True):
        assert 1 <= constant / supremum < most


def test_load_constants_contain_what_projections_of_loads_leave_out(monkeypatch):
    """C² is a sum: with twice the constant c of the rest of a load, C² grows by 3c². No supremum is close enough.

    On sides the constants differ, and the largest one counts.
    """

    def constants_of():
        found = load_constants.__wrapped__(BODY, LAW.A)
        return np.array([found.volume, found.surface]) ** 2

    before = constants_of()
    largest = []

    def doubled(*args):
        largest.append(cell_constants(*args[:2], 1).max())  # the rest of loads that are linear on every cell
        return 2 * cell_constants(*args)

    def doubled_sides(*args):
        sides = list(loaded_sides(*args))
        largest.append(np.concatenate([constants for *_, constants in sides]).max())
        return [(*rest, constants * np.linspace(0, 2, len(constants))) for *rest, constants in sides]

    monkeypatch.setattr(problem, "cell_constants", doubled)
    monkeypatch.setattr(problem, "loaded_sides", doubled_sides)
    assert constants_of() - before == pytest.approx(3 * np.array(largest) ** 2)
    assert (3 * np.array(largest) ** 2 > 1e-3 * before).all()


# ---- the ends


def test_both_ends_of_an_enclosure_differ_from_the_distance_by_the_bound():
    """Three times with distances d and bounds y."""
    times = np.array([0.25, 0.5, 1.0])
    distance = np.array([2.0, 1.0, 0.25])
    bound = np.array([0.5, 2.0, 0.25])
    rest = np.full(3, math.nan), (), 1.0, np.zeros(1), np.array([2.75, 3.5, 1.0]), Evidence(()), (4.0, 5.0)
    found = Enclosure(0.5, times, distance, bound, *rest, np.eye(2))
    assert relative((1.5, 3.5), (4.0, 5.0)) == (1.5 / 5, 3.5 / 4)
    assert relative((1.5, 3.5), (0.0, 5.0)) == (1.5 / 5, math.inf)
    assert relative((0.0, 3.5), (0.0, 0.0)) == (0.0, math.inf)
    assert found.lower.tolist() == [1.5, 0.0, 0.0]
    assert found.upper.tolist() == [2.5, 3.0, 0.5]
    assert found.lowest == 1.5
    assert found.highest == 3.5
    assert replace(found, start=4.0).highest == 4.0


def test_between_knots_the_bound_inside_an_interval_and_the_distance_both_count(monkeypatch):
    d = discretised((0, t))
    monkeypatch.setattr(enclosing, "largest_distance", lambda *arguments: 7.0)
    found = enclose(d, compute(d, MIDPOINT, 2), SmoothedInTime())
    assert found.between == pytest.approx([one.inside + 7 for one in found.intervals], rel=1e-14)


def on_a_square():
    """A discretisation, and a random displacement of the norm 1."""
    d = discretised()
    v = np.random.default_rng(0).standard_normal(len(d.displacements.free))
    return d, v / d.norm(v)


@pytest.mark.parametrize(
    ("control", "end", "least", "most"),
    [
        # 2θ(1 − θ) v is zero at both ends and largest in the middle.
        (1.0, 0.0, 1 / 2, 1 / 2),
        # (2θ − 3θ²/2) v has 2/3 at θ = 2/3, 5/8 in the middle and 1/2 at the end.
        (1.0, 0.5, 2 / 3, 3 / 4),
    ],
    ids=["in the middle", "between the times that are sampled"],
)
def test_the_distance_between_knots_is_the_largest_of_a_parabola(control, end, least, most):
    """u_h = 0, and ũ from 0 by the given multiples of v."""
    d, v = on_a_square()
    piece = Parabola(0.0, 0.25, 0 * v, control * v, end * v)
    found = enclosing.largest_distance(d, piece, np.array([0.0, 1.0]), lambda time: 0 * v)
    assert least * (1 - 1e-12) <= found <= most * (1 + 1e-12)


def test_the_distance_is_cut_at_every_time_of_u_h():
    """u_h is 0 except for a narrow peak within the piece, of which ends and middle of the piece see nothing."""
    d, v = on_a_square()
    piece = Parabola(0.0, 0.25, 0 * v, 0 * v, 0 * v)
    times = np.array([0.0, 0.05, 0.07, 0.09, 1.0])
    found = enclosing.largest_distance(d, piece, times, lambda time: np.interp(time, times, [0, 0, 3, 0, 0]) * v)
    assert found == pytest.approx(3, rel=1e-12)
