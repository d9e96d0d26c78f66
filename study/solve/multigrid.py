"""One contact solve: minimise ½ vᵀSv − bᵀv over K^h = {v : Nv ≤ 0}, by multigrid: memory and time are linear in n.

Coordinates. At a vertex with rows n_1, …, n_r of N its d unknowns are replaced by the values of these rows and of an
orthonormal basis of the rest, all scaled so that the matrix A of the quadratic form has a diagonal of ones. Then K^h
is {w : w_i ≤ 0 for the bounded i}, whatever the normals are.

One iteration (C. Gräser, U. Sack, O. Sander, Truncated nonsmooth Newton multigrid methods for convex minimization
problems, in Domain Decomposition Methods in Science and Engineering XVIII (2009) 129–136), with f for b:

1. a projected step of Jacobi's method, w ← P_K(w + R (f − A w)), decides which unknowns are held at their bound;
2. conjugate gradients, preconditioned by a V-cycle without the unknowns that are held, correct all others;
3. w moves towards the projection of the corrected w on K^h, or to where the way there leaves K^h, by the energy.

No step raises the energy and the first one alone would converge, so the iteration does, from any start and for any N;
once the right unknowns are held it is a linear solve.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
import scipy.sparse as sps
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator, cg

from manufactured.tensors import Array, Points
from study.solve.cholesky.dissection import Integers
from study.solve.hierarchy import Hierarchy

REDUCTION = 0.02
"""Residual after a correction over the one before: no more, since other unknowns may have to be held."""
CORRECTIONS, ITERATIONS = 100, 300
"""Corrections in a solve and iterations of conjugate gradients in a correction before either is given up."""
INDEPENDENT = 1e-8
"""Sine of the angle between normals at a vertex below which they are refused as the same one."""


class MultigridError(RuntimeError):
    """The iteration did not reach its tolerance."""


class Multigrid:
    """The contact solve with a fixed S and N; starts from its last solution.

    N u ≤ 0, λ ≥ 0 and λ·N u = 0 hold to rounding, S u + Nᵀλ = b up to the tolerance.

    Args:
        S: symmetric positive definite, d unknowns for each vertex, one vertex after the other, (n, n).
        N: every row has its entries at one vertex; the rows of a vertex are linearly independent, (m, n).
        x: the vertices, (d, n/d), for the rigid motions.
        tolerance: bound for ‖S u + Nᵀλ − b‖/‖b‖.

    Raises:
        ValueError: x does not have the unknowns of S, or N is not of the form above.
    """

    def __init__(self, S: sps.csc_array, N: sps.csr_array, x: Points, tolerance: float) -> None:
        if x.size != S.shape[0]:
            raise ValueError(
                f"S has {S.shape[0]} unknowns, but {x.shape[1]} vertices in dimension {len(x)} have {x.size}: "
                "give the vertices that are free to move"
            )
        self.tolerance = tolerance
        blocks, self.bounded = local_bases(N, len(x))
        inverse = np.linalg.inv(blocks)
        S = sps.bsr_array(S, blocksize=(len(x), len(x)))
        scale = np.sqrt(np.einsum("vai,vab,vbi->vi", inverse, _diagonal_blocks(S), inverse))
        # u = basis w and w = coordinates u.
        self.basis = _block_diagonal(inverse / scale[:, None, :])
        self.coordinates = _block_diagonal(blocks * scale[:, :, None])
        self.forces = scale.ravel()[self.bounded]
        A = sps.bsr_array(self.basis.T @ S @ self.basis)
        self.hierarchy = Hierarchy(A, self.coordinates @ rigid_motions(x))
        self.w = np.zeros(S.shape[0])
        self.held = self._at_bound(self.w)
        self.cycle = self.hierarchy.without(self.held)

    def __call__(self, b: Array) -> tuple[Array, Array]:
        """u ∈ K^h and the multipliers λ ≥ 0 (nodal contact forces), (n,) and (m,).

        Raises:
            MultigridError: the tolerance was not reached.
        """
        if not b.any():
            self.w = np.zeros_like(self.w)
            return self.basis @ self.w, np.zeros_like(self.forces)
        A, f, w = self.hierarchy.A, self.basis.T @ b, self.w
        aim = self.tolerance * float(np.linalg.norm(b))
        for _ in range(CORRECTIONS):
            r = f - A @ w
            forces = np.where(self._at_bound(w), np.maximum(r, 0), 0)
            defect = float(np.linalg.norm(self.coordinates.T @ (r - forces)))
            if defect <= aim:
                self.w = w
                return self.basis @ w, self.forces * forces[self.bounded]
            w = self._projected(w + self.hierarchy.jacobi * r)
            r = f - A @ w
            w = self._moved(w, r, self._correction(w, r, max(REDUCTION, aim / defect / 2)))
        raise MultigridError(
            f"a contact solve has a relative residual of {defect / aim * self.tolerance:.2g} after {CORRECTIONS} "
            f"corrections, {self.tolerance:g} was asked for: rounding may allow no less, so ask for less"
        )

    def _correction(self, w: Array, r: Array, reduction: float) -> Array:
        """z ≈ A⁻¹ r on the unknowns that are not held, 0 on the others."""
        held = self._at_bound(w)
        if (held != self.held).any():
            self.held, self.cycle = held, self.hierarchy.without(held)
        preconditioner = LinearOperator(self.cycle.A.shape, matvec=self.cycle, dtype=float)
        z, _ = cg(self.cycle.A, np.where(held, 0, r), rtol=reduction, maxiter=ITERATIONS, M=preconditioner)
        return np.where(held, 0, z)

    def _moved(self, w: Array, r: Array, z: Array) -> Array:
        """w moved towards the projection of w + z, or along z up to the first bound, whichever gains more energy.

        The former brings many unknowns to their bounds at a time; the latter always gains, unless z = 0.
        """
        step = self._projected(w + z) - w
        if not step.any():
            return w
        slope, curvature = float(r @ step), float(step @ (self.hierarchy.A @ step))
        length = min(max(slope / curvature, 0.0), 1.0)
        rising = self.bounded[z[self.bounded] > 0]
        lengths = -w[rising] / z[rising]
        first = min(float(lengths.min(initial=1.0)), 1.0)
        # Conjugate gradients from 0 leave z·Az = r·z.
        if (first - first**2 / 2) * float(r @ z) <= length * slope - length**2 / 2 * curvature:
            return self._projected(w + length * step)
        w = self._projected(w + first * z)
        w[rising[lengths <= first]] = 0
        return w

    def _projected(self, w: Array) -> Array:
        w = w.copy()
        w[self.bounded] = np.minimum(w[self.bounded], 0)
        return w

    def _at_bound(self, w: Array) -> NDArray[np.bool_]:
        bound = np.zeros(len(w), dtype=bool)
        bound[self.bounded] = w[self.bounded] == 0
        return bound


def rigid_motions(x: Points) -> Array:
    """Translations and infinitesimal rotations at points x, (d, vertices) → (d·vertices, d(d + 1)/2)."""
    d, count = x.shape
    motions = [np.tile(unit[:, None], count) for unit in np.eye(d)]
    centred = x - x.mean(axis=1, keepdims=True)
    for i, j in combinations(range(d), 2):
        rotation = np.zeros((d, count))
        rotation[i], rotation[j] = -centred[j], centred[i]
        motions.append(rotation)
    return np.array([motion.T.ravel() for motion in motions]).T


def local_bases(N: sps.csr_array, d: int) -> tuple[Array, Integers]:
    """For each vertex a regular matrix that begins with its rows of N, and which unknown a row of N becomes.

    Returns:
        (n/d, d, d) and (m,): row i of N is row ``unknown[i] % d`` of the matrix of vertex ``unknown[i] // d``.

    Raises:
        ValueError: a row has entries at several vertices or none, or the rows of a vertex are not linearly independent.
    """
    N = sps.csr_array(N)
    vertices = np.full(N.shape[0], -1)
    for i, (start, end) in enumerate(zip(N.indptr[:-1], N.indptr[1:], strict=True)):
        at = np.unique(N.indices[start:end][N.data[start:end] != 0] // d)
        if len(at) != 1:
            raise ValueError(
                f"row {i} of N has entries at {len(at)} vertices: give one normal at one vertex in each row"
            )
        vertices[i] = at[0]
    blocks = np.tile(np.eye(d), (N.shape[1] // d, 1, 1))
    unknowns = np.empty(N.shape[0], dtype=np.int64)
    for vertex in np.unique(vertices):
        rows = np.flatnonzero(vertices == vertex)
        normals = N[rows][:, d * vertex : d * (vertex + 1)].toarray()
        blocks[vertex] = _completed(normals)
        unknowns[rows] = d * vertex + np.arange(len(rows))
    return blocks, unknowns


def _completed(normals: Array) -> Array:
    """The rows with an orthonormal basis of what is orthogonal to them, (r, d) → (d, d)."""
    count = len(normals)
    units = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    _, sizes, orthonormal = np.linalg.svd(units)
    if count > normals.shape[1] or sizes.min() < INDEPENDENT:
        raise ValueError(f"the normals {units.tolist()} at a vertex are linearly dependent: keep one row for each")
    return np.vstack([normals, orthonormal[count:]])


def _diagonal_blocks(S: sps.bsr_array) -> Array:
    """(n/d, d, d)."""
    row = np.repeat(np.arange(len(S.indptr) - 1), np.diff(S.indptr))
    found = np.zeros((len(S.indptr) - 1, *S.blocksize))
    found[row[row == S.indices]] = S.data[row == S.indices]
    return found


def _block_diagonal(blocks: Array) -> sps.bsr_array:
    count = len(blocks)
    return sps.bsr_array((blocks, np.arange(count), np.arange(count + 1)))
