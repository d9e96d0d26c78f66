"""The constants that bound what P f leaves out: their invariance, and that they are upper bounds close to the truth.

The truth is approached from below: on a triangle refined four times, the largest ∫ g·v/(‖g‖ ‖ε(v)‖_A) over continuous
quadratic g ⟂ P_q(T)² and v. Every such quotient is one that the constant has to bound.
"""

import numpy as np
import pytest
import scipy.sparse as sps
from hypothesis import strategies as st
from scipy.linalg import eigh, null_space
from scipy.sparse.linalg import splu
from skfem import MeshTri

from manufactured.cases.laws import anisotropic, not_proportional
from manufactured.tensors import Array
from study.fem.mesh import on_segment
from study.fem.quadratic import Quadratic
from study.fem.quadrature import simplex_rule
from study.solve.multigrid import rigid_motions
from study.stresses.composite import CORNERS, SIDES
from study.stresses.oscillation import cell_constants, side_constants

TRIANGLES = {
    "right isosceles": np.eye(2),
    "equilateral": np.array([[1.0, 0.5], [0.0, np.sqrt(3) / 2]]),
    "obtuse": np.array([[1.0, -0.6], [0.0, 0.7]]),
    "flat": np.array([[1.0, 0.3], [0.0, 0.3]]),
}
TENSORS = {"identity": np.eye(3), "isotropic": not_proportional().A.matrix, "anisotropic": anisotropic().A.matrix}
CELLS, SIDES_TOO = 1.3, 1.6
"""How many times too large the constants may be at most; halving a side costs √2 where halving a cell costs √(4/3)."""


def cell(F: Array, C: Array, q: int) -> float:
    return float(cell_constants(np.reshape(F, (1, 2, 2)), np.linalg.inv(C), q)[0])


def sides(F: Array, C: Array) -> list[float]:
    return [float(side_constants(np.reshape(F, (1, 2, 2)), np.linalg.inv(C), side)[0]) for side in range(3)]


shapes = st.sampled_from(list(TRIANGLES.values()))


# ---- bounds from below


class FixedNowhere(Quadratic):
    @property
    def free(self) -> Array:  # type: ignore[override]
        return np.arange(2 * self.count)


def whole_triangle(F: Array, times: int) -> FixedNowhere:
    return FixedNowhere(MeshTri(F @ CORNERS, np.array([[0], [1], [2]])).refined(times), None)


def largest(space: FixedNowhere, C: Array, load: Array, mass: Array) -> float:
    """Return sup ∫ g·v/(‖g‖ ‖ε(v)‖_A) for columns ∫ g_i·v of the loads g_i and their products ∫ g_i·g_j."""
    # g ⟂ rigid motions, so any regularisation that acts only on those gives the same energy.
    rigid = rigid_motions(space.nodes)
    K = sps.block_array([[space.form(C), sps.csc_array(rigid)], [sps.csc_array(rigid.T), None]], format="csc")
    v = splu(K).solve(np.vstack([load, np.zeros((3, load.shape[1]))]))[: len(load)]
    return float(np.sqrt(eigh(load.T @ v, mass, eigvals_only=True)[-1]))


def on_cell(F: Array, C: Array, q: int, times: int) -> float:
    """The largest quotient for a load ⟂ P_q(T)² in the triangle."""
    space = whole_triangle(F, times)
    barycentric, weights = simplex_rule(2, 2 + max(2, q))
    shapes = np.zeros((space.cells, len(weights), space.count))
    shapes[np.arange(space.cells)[:, None], :, space.numbers.T] = space.shapes(barycentric)
    at = np.kron(shapes.reshape(-1, space.count), np.eye(2))
    w = np.repeat(np.multiply.outer(space.volumes, weights).ravel(), 2)
    mass = (at.T * w) @ at
    x = np.linalg.solve(F, np.einsum("dvc,vq->dcq", space.mesh.p[:, space.mesh.t], barycentric).reshape(2, -1))
    monomials = [x[0] ** i * x[1] ** j for i in range(q + 1) for j in range(q + 1 - i)]
    orthogonal = np.array([np.kron(p, unit) for p in monomials for unit in np.eye(2)])
    loads = null_space((orthogonal * w) @ at)
    return largest(space, C, mass @ loads, loads.T @ mass @ loads)


def on_side(F: Array, C: Array, side: int, times: int) -> float:
    """The largest quotient for a piecewise quadratic load ⟂ P1(e)² on one side."""
    space = whole_triangle(F, times)
    mesh = space.mesh
    ends = F @ CORNERS[:, SIDES[side]]
    boundary = mesh.boundary_facets()
    edges = boundary[on_segment(mesh.p, ends)[mesh.facets[:, boundary]].all(axis=0)]
    assert len(edges) == 2**times
    # ∫_0^1 B_i B_j of degree 2 times the length of an edge; all edges have the same length.
    local = np.array([[6, 3, 1], [3, 4, 3], [1, 3, 6]]) / 30 * np.linalg.norm(ends[:, 1] - ends[:, 0]) / len(edges)
    mass = np.zeros((space.count, space.count))
    for numbers in space.on_edges(edges).T:
        mass[np.ix_(numbers, numbers)] += local
    used = np.unique(space.on_edges(edges))
    # Coefficients of 1 and of the coordinate along the side, both linear.
    linear = np.array([np.ones(len(used)), (ends[:, 1] - ends[:, 0]) @ space.nodes[:, used]])
    loads = np.kron(null_space(linear @ mass[np.ix_(used, used)]), np.eye(2))
    full = np.zeros((2 * space.count, loads.shape[1]))
    full[(2 * used[:, None] + np.arange(2)).ravel()] = loads
    moments = np.kron(mass, np.eye(2)) @ full
    return largest(space, C, moments, full.T @ moments)


EVERY = [
    pytest.param(shape, tensor, marks=() if (i + j) % 3 == 0 else pytest.mark.slow)
    for i, shape in enumerate(TRIANGLES)
    for j, tensor in enumerate(TENSORS)
]
"""Every triangle with one tensor; the nightly job takes every tensor."""


@pytest.mark.parametrize("q", [1, 2, 3])
@pytest.mark.parametrize(("shape", "tensor"), EVERY)
def test_the_constant_of_a_cell_bounds_what_loads_can_do_and_not_by_much(shape: str, tensor: str, q: int) -> None:
    F, C = TRIANGLES[shape], TENSORS[tensor]
    found, least = cell(F, C, q), on_cell(F, C, q, 3)
    assert least <= found <= CELLS * least


@pytest.mark.parametrize("side", range(3))
@pytest.mark.parametrize(("shape", "tensor"), EVERY)
def test_the_constant_of_a_side_bounds_what_loads_can_do_and_not_by_much(shape: str, tensor: str, side: int) -> None:
    F, C = TRIANGLES[shape], TENSORS[tensor]
    found, least = sides(F, C)[side], on_side(F, C, side, 4)
    assert least <= found <= SIDES_TOO * least
