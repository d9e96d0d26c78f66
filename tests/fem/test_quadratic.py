"""Displacements of degree 2: the cone, strains, forms and moments, and how P1 is embedded."""

from functools import lru_cache

import numpy as np
import pytest
from bodies import CLAMPED, CONTACT, LOADED, SQUARE
from hypothesis import given
from hypothesis import strategies as st

from manufactured import named, polygon, unit_square
from manufactured.cases.materials import anisotropic_law
from manufactured.problems import problems
from manufactured.tensors import mandel
from study.fem.mesh import CrissCross, OneDiagonal, Shaken, Unstructured
from study.fem.quadrature import simplex_rule
from study.fem.space import Quadratic
from study.stresses.stress_space import bernstein

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
def test_the_constraints_are_the_bernstein_coefficients_of_the_normal_trace(body):
    """They follow from the trace at the ends and the midpoints of edges. If they are ≤ 0, so is the trace."""
    space = quadratic(body)
    v = np.random.default_rng(0).normal(size=space.dofs)
    trace = on_contact(space, v, np.array([0.0, 0.5, 1.0]))
    rows = np.concatenate([trace[:, 0], 2 * trace[:, 1] - (trace[:, 0] + trace[:, 2]) / 2, trace[:, 2]])
    free = rows[abs(rows) > 1e-14]  # coefficients are zero where Γ3 meets Γ1
    assert set(np.round(space.N @ v, 9)) == set(np.round(free, 9))


# ---- values and strains


class Polynomial:
    """A random polynomial of degree 2 with values in the plane: u = c + B x + (H x)·x."""

    def __init__(self, rng):
        self.c, self.B, self.H = (rng.normal(size=shape) for shape in ((2, 1), (2, 2), (2, 2, 2)))

    def __call__(self, x):
        x_ = x.reshape(2, -1)
        values = self.c + self.B @ x_ + np.einsum("ijk,jn,kn->in", self.H, x_, x_)
        return values.reshape(x.shape)

    def gradient(self, x):
        return self.B.reshape(2, 2, *(1,) * (x.ndim - 1)) + np.tensordot(self.H + self.H.swapaxes(1, 2), x, axes=1)


class Unclamped(Quadratic):
    """Fixed nowhere, so that every polynomial belongs to it."""

    @property
    def free(self):  # type: ignore[override]
        return np.arange(2 * self.count)


@pytest.mark.parametrize("body", BODIES)
@given(st.integers(0, 10**6))
def test_quadratic_polynomials_have_their_values_and_strains_at_every_point(body, seed):
    rng, plain = np.random.default_rng(seed), quadratic(body)
    space = Unclamped(plain.mesh, plain.body)
    u = Polynomial(rng)
    # The coefficient of an edge follows from the values at its ends and its midpoint.
    ends = space.mesh.p[:, space.mesh.facets]
    on_edges = 2 * u(ends.mean(axis=1)) - u(ends).mean(axis=1)
    v = np.hstack([u(space.mesh.p), on_edges]).T.ravel()
    barycentric = rng.dirichlet(np.ones(3), 5).T
    x = np.einsum("dvc,vq->dcq", space.mesh.p[:, space.mesh.t], barycentric)
    values = np.einsum("aq,acd->dcq", space.shapes(barycentric), space.coefficients(v)[space.numbers])
    assert np.allclose(values, u(x), atol=1e-11)
    expected = mandel(u.gradient(x))
    assert np.allclose((space.strains(barycentric) @ v).reshape(expected.shape), expected, atol=1e-10)
    # The form is the integral of the products of strains.
    rule, weights = simplex_rule(2, 2)
    e = mandel(u.gradient(np.einsum("dvc,vq->dcq", space.mesh.p[:, space.mesh.t], rule)))
    A = anisotropic_law().A.matrix
    energy = np.einsum("IJ,Jcq,Icq,q,c->", A, e, e, weights, space.volumes)
    assert v @ space.form(A) @ v == pytest.approx(energy, rel=1e-10)
    assert v @ space.functional(np.einsum("IJ,Jcq->Icq", A, space.strain(v))) == pytest.approx(energy, rel=1e-10)
    some = rng.permutation(space.cells)[:3]
    assert np.allclose(space.strain_at(v, some, x[:, some]), expected[:, some], atol=1e-10)
