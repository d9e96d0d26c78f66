"""The constants that bound what P f leaves out: their invariance, and that they are upper bounds close to the truth.

The truth is approached from below: on a triangle refined four times, the largest ∫ g·v/(‖g‖ ‖ε(v)‖_A) over continuous
piecewise quadratic g ⟂ P_q(T)² and v. Every such quotient is one that the constant has to bound.
"""

from itertools import product

import numpy as np
import pytest
from costly_cases import slow_unless
from scipy.linalg import eigh, null_space, solve
from skfem import Basis, BilinearForm, ElementTriP2, ElementVector, FacetBasis, LinearForm, MeshTri
from skfem.helpers import dot

from manufactured.cases.materials import anisotropic_law
from manufactured.cases.shared import not_proportional
from manufactured.tensors import mandel
from study.fem.mesh import on_segment
from study.solve.multigrid import rigid_motions
from study.stresses.oscillation import cell_constants, side_constants
from study.stresses.stress_space import REFERENCE_CORNERS, SIDES

TRIANGLES = {
    "right isosceles": np.eye(2),
    "equilateral": np.array([[1.0, 0.5], [0.0, np.sqrt(3) / 2]]),
    "obtuse": np.array([[1.0, -0.6], [0.0, 0.7]]),
    "flat": np.array([[1.0, 0.3], [0.0, 0.3]]),
}
TENSORS = {"identity": np.eye(3), "isotropic": not_proportional().A.matrix, "anisotropic": anisotropic_law().A.matrix}
CELLS = 1.3
SIDES_TOO = 1.6
"""How many times too large the constants may be at most; halving a side costs √2 where halving a cell costs √(4/3)."""


@BilinearForm
def mass(g, v, _):
    return dot(g, v)


def largest(F, C, q, side=None):
    """Return sup ∫ g·v/(‖g‖ ‖ε(v)‖_A) over quadratic g ⟂ P_q² on small triangles, or on the small edges of a side."""
    mesh = MeshTri(F @ REFERENCE_CORNERS, np.array([[0], [1], [2]])).refined(3 if side is None else 4)
    element = ElementVector(ElementTriP2())
    whole = loaded = Basis(mesh, element, intorder=5)
    if side is not None:
        on_side = on_segment(mesh.p, F @ REFERENCE_CORNERS[:, SIDES[side]])[mesh.facets].all(axis=0)
        loaded = FacetBasis(mesh, element, facets=np.flatnonzero(on_side), intorder=5)

    @BilinearForm
    def energy(u, v, _):
        return np.einsum("IJ,J...,I...", C, mandel(np.asarray(u.grad)), mandel(np.asarray(v.grad)))

    moments = []
    for i, j, d in product(range(q + 1), range(q + 1), range(2)):
        if i + j <= q:
            moment = LinearForm(lambda v, w, i=i, j=j, d=d: v[d] * w.x[0] ** i * w.x[1] ** j)
            moments.append(moment.assemble(loaded))
    M = mass.assemble(loaded).toarray()
    used = M.diagonal() > 1e-9 * M.max()
    g = null_space(np.array(moments)[:, used], rcond=1e-10)
    # g ⟂ rigid motions, so any regularisation that acts only on those gives the same energy.
    load = M[:, used] @ g
    rigid = rigid_motions(whole.doflocs[:, ::2])
    works = load.T @ solve(energy.assemble(whole) + rigid @ rigid.T, load, assume_a="pos")
    return float(np.sqrt(eigh(works, g.T @ load[used], eigvals_only=True)[-1]))


EVERY = [
    slow_unless((i + j) % 3 == 0, shape, tensor)
    for i, shape in enumerate(TRIANGLES)
    for j, tensor in enumerate(TENSORS)
]
"""Every triangle with one tensor; the nightly job takes every tensor."""


on_every_triangle = pytest.mark.parametrize(("shape", "tensor"), EVERY)


@pytest.mark.parametrize("q", [1, 2, 3])
@on_every_triangle
def test_the_constant_of_a_cell_bounds_what_loads_can_do_and_not_by_much(shape, tensor, q):
    F = TRIANGLES[shape]
    C = TENSORS[tensor]
    (found,) = cell_constants(F[None], np.linalg.inv(C), q)
    least = largest(F, C, q)
    assert least <= found <= CELLS * least


@pytest.mark.parametrize("side", range(3))
@on_every_triangle
def test_the_constant_of_a_side_bounds_what_loads_can_do_and_not_by_much(shape, tensor, side):
    F = TRIANGLES[shape]
    C = TENSORS[tensor]
    (found,) = side_constants(F[None], np.linalg.inv(C), side)
    least = largest(F, C, 1, side)
    assert least <= found <= SIDES_TOO * least
