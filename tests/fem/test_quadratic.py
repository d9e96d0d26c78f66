"""Displacements of degree 2: the cone, strains, forms and moments, and how P1 is embedded."""

from functools import lru_cache

import numpy as np
import pytest
from bodies import CLAMPED, CONTACT, LOADED, SQUARE
from hypothesis import given
from measures import close
from random_examples import RANDOM
from skfem import Basis, ElementTriP2, ElementVector

from manufactured import named, polygon, unit_square
from manufactured.cases.materials import anisotropic_law
from manufactured.problems import problems
from manufactured.tensors import mandel
from study.fem.mesh import CrissCross, OneDiagonal, Shaken, Unstructured
from study.fem.quadrature import bernstein
from study.fem.space import Quadratic

BODIES = {
    "square": (unit_square(), Shaken()),
    "criss-cross": (unit_square(), CrissCross()),
    "corner of Γ3": (polygon(SQUARE, [CONTACT, LOADED, CLAMPED, CONTACT]), OneDiagonal()),
    "hexagon": (named("hexagon").solution.body, Unstructured()),
    "bracket": (next(p.data.body for p in problems() if p.name == "bracket"), Unstructured()),
}
LEVEL = 4


@lru_cache
def quadratic(body):
    found, family = BODIES[body]
    return Quadratic(family(found, LEVEL), found)


def on_contact(space, v, x):
    """v_ν at places x in [0, 1] of every edge of Γ3, (edges, points)."""
    normal = [space.coefficients(v)[space.on_edges(edges)] @ part.normal for part, edges in space.on(CONTACT)]
    return np.concatenate(normal, axis=1).T @ bernstein(2, np.array([1 - x, x]))


# ---- the cone


@pytest.mark.parametrize("body", BODIES)
def test_the_constraints_are_the_bernstein_coefficients_of_the_normal_trace(body, rng):
    """They follow from the trace at the ends and the midpoints of edges. If they are ≤ 0, so is the trace."""
    space = quadratic(body)
    v = rng.normal(size=space.dofs)
    trace = on_contact(space, v, np.array([0.0, 0.5, 1.0]))
    rows = np.concatenate([trace[:, 0], 2 * trace[:, 1] - (trace[:, 0] + trace[:, 2]) / 2, trace[:, 2]])
    free = rows[abs(rows) > 1e-14]  # coefficients are zero where Γ3 meets Γ1
    assert set(np.round(space.N @ v, 9)) == set(np.round(free, 9))


# ---- values and strains


class Unclamped(Quadratic):
    """Fixed nowhere, as the displacements of scikit-fem."""

    @property
    def free(self):  # type: ignore[override]
        return np.arange(2 * self.count)


@pytest.mark.parametrize("body", BODIES)
@given(RANDOM)
def test_displacements_of_degree_2_have_the_values_strains_and_energies_of_scikit_fem(body, rng):
    plain = quadratic(body)
    space = Unclamped(plain.mesh, plain.body)
    basis = Basis(space.mesh, ElementVector(ElementTriP2()))
    nodal = rng.normal(size=basis.N)
    u = basis.interpolate(nodal)
    at_vertices = nodal[basis.nodal_dofs]
    # The coefficient of an edge follows from the values at its ends and its midpoint.
    on_edges = 2 * nodal[basis.facet_dofs] - at_vertices[:, space.mesh.facets].mean(axis=1)
    v = np.hstack([at_vertices, on_edges]).T.ravel()
    barycentric = np.vstack([1 - basis.X.sum(axis=0), basis.X])
    values = np.einsum("aq,acd->dcq", space.shapes(barycentric), space.coefficients(v)[space.numbers])
    assert close(values, np.asarray(u), 1e-12)
    expected = mandel(u.grad)
    assert close((space.strains(barycentric) @ v).reshape(expected.shape), expected, 1e-12)
    some = rng.permutation(space.cells)[:3]
    x = basis.mapping.F(basis.X)
    assert close(space.strain_at(v, some, x[:, some]), expected[:, some], 1e-10)
    # The form is the integral of the products of strains.
    A = anisotropic_law().A.matrix
    energy = np.einsum("IJ,Jcq,Icq,cq->", A, expected, expected, basis.dx)
    assert v @ space.form(A) @ v == pytest.approx(energy, rel=1e-10)
    assert v @ space.functional(np.einsum("IJ,Jcq->Icq", A, space.strain(v))) == pytest.approx(energy, rel=1e-10)
