"""One contact solve: minimise ½ vᵀSv − bᵀv over K^h = {v : Nv ≤ g}, by multigrid: memory and time are linear in n.

Coordinates. At a vertex with rows n_1, …, n_r of N its d unknowns are replaced by the values of these rows and of an
orthonormal basis of the rest, all scaled so that the matrix A of the quadratic form has a diagonal of ones. Then K^h
is {w : w_i ≤ g_i for the bounded i}, whatever the normals are, with the initial gap g, 0 in the paper, scaled like
the rows.

As in ``signorini``, a primal–dual active set tells which unknowns are held at their bound. A correction, with f for b,

1. solves A z ≈ f − A w for z on the unknowns that are not held, z = 0 on the others, by conjugate gradients;
2. finds the unknowns that are held although nothing presses, (f − A(w + z))_i ≤ 0, and those that are not held although
   they pass their bound, w_i + z_i > 0;
3. projects w + z on K^h, lets go of the former and holds the latter.

Active sets may go in circles. When that is suspected z is made exact and the set changes by one unknown at a time, the
last of those found, which ends after finitely many corrections (J. J. Júdice, F. M. Pires, A block principal pivoting
algorithm for large-scale strictly monotone linear complementarity problems, Comput. Oper. Res. 21 (1994) 587–596).

The preconditioner is a V-cycle of smoothed aggregation, with the rigid motions as near kernel (P. Vaněk, J. Mandel,
M. Brezina, Algebraic multigrid by smoothed aggregation for second and fourth order elliptic problems, Computing 56
(1996) 179–196), by pyamg. It is made once: what is held is cut out of the finest matrix and out of what the coarse
levels return. Coarse matrices for every set would halve the iterations, but take the time that this saves.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations

import numpy as np
import scipy.sparse as sps
from numpy.typing import NDArray
from pyamg import MultilevelSolver, smoothed_aggregation_solver
from pyamg.util.utils import get_block_diag
from scipy.sparse.linalg import LinearOperator, cg

from manufactured.tensors import Array, Points

REDUCTION = 0.02
"""Residual after a correction over the one before: no more, since other unknowns may have to be held."""
CORRECTIONS, ITERATIONS = 200, 300
"""Corrections in a solve and iterations of conjugate gradients in a correction before either is given up."""
PATIENCE = 5
"""Corrections, none of which finds fewer unknowns to change than ever before, until sets are said to go in circles."""
SMOOTHER = ("chebyshev", {"degree": 2, "lower_bound": 1 / 20})
"""1 − λ p(λ) is Chebyshev's polynomial for the spectrum above λ_max/20; more products with the matrix do not pay."""
COARSEST = 100
"""Aggregates that are not aggregated any further: the inverse is dense there."""
INDEPENDENT = 1e-8
"""Sine of the angle between normals at a vertex below which they are refused as linearly dependent."""


class MultigridError(RuntimeError):
    """The iteration did not reach its tolerance."""


class Multigrid:
    """The contact solve with a fixed S and N; starts from its last solution and active set.

    N u ≤ g, λ ≥ 0 and λ·(N u − g) = 0 hold to rounding, S u + Nᵀλ = b up to the tolerance.

    Args:
        S: symmetric positive definite, d unknowns for each vertex, one vertex after the other, (n, n).
        N: every row has its entries at one vertex; the rows of a vertex are linearly independent, (m, n).
        x: the vertices, (d, n/d), for the rigid motions.
        tolerance: bound for ‖S u + Nᵀλ − b‖/‖b‖.
        gap: the initial gap g ≥ 0, (m,) or a number.

    Raises:
        ValueError: x does not have the unknowns of S, or N is not of the form above.
    """

    def __init__(
        self, S: sps.csc_array, N: sps.csr_array, x: Points, tolerance: float, gap: Array | float = 0.0
    ) -> None:
        if x.size != S.shape[0]:
            raise ValueError(
                f"S has {S.shape[0]} unknowns, but {x.shape[1]} vertices in dimension {len(x)} have {x.size}: "
                "give the vertices that are free to move"
            )
        self.tolerance = tolerance
        blocks, self.bounded = local_bases(N, len(x))
        inverse = np.linalg.inv(blocks)
        S = sps.bsr_array(S, blocksize=(len(x), len(x)))
        diagonal = get_block_diag(S, len(x), inv_flag=False)
        scale = np.sqrt(np.einsum("vai,vab,vbi->vi", inverse, diagonal, inverse))
        # u = basis w and w = coordinates u.
        self.basis = block_diagonal(inverse / scale[:, None, :])
        self.coordinates = block_diagonal(blocks * scale[:, :, None])
        self.forces = scale.ravel()[self.bounded]
        self.highest = self.forces * gap
        self.A = sps.bsr_array(self.basis.T @ S @ self.basis)
        self.finest, self.coarse = levels(self.A, self.coordinates @ rigid_motions(x))
        self.w = np.zeros(S.shape[0])
        self.hold(np.zeros(N.shape[0], dtype=bool))

    def __call__(self, b: Array) -> tuple[Array, Array]:
        """u ∈ K^h and the multipliers λ ≥ 0 (nodal contact forces), (n,) and (m,).

        Raises:
            MultigridError: the tolerance was not reached.
        """
        f, aim = self.basis.T @ b, self.tolerance * float(np.linalg.norm(b))
        w = self.w if b.any() else np.zeros_like(b)
        wrong, fewest, patience = np.zeros_like(self.held), len(self.held) + 1, PATIENCE
        for _ in range(CORRECTIONS):
            r = f - self.A @ w
            forces = np.maximum(r, 0) * (self.free == 0)
            defect = float(np.linalg.norm(self.coordinates.T @ (r - forces)))
            if defect <= aim:
                self.w = w
                return self.basis @ w, self.forces * forces[self.bounded]
            if wrong.any():
                fewest, patience = (wrong.sum(), PATIENCE) if wrong.sum() < fewest else (fewest, patience - 1)
                if patience <= 0:
                    wrong[: np.flatnonzero(wrong)[-1]] = False
                self.hold(self.held ^ wrong)
            w, wrong = self._corrected(w, r, max(REDUCTION if patience > 0 else 0, aim / defect / 2))
        raise MultigridError(
            f"a contact solve has a relative residual of {defect / aim * self.tolerance:.2g} after {CORRECTIONS} "
            f"corrections, {self.tolerance:g} was asked for: rounding may allow no less, so ask for less"
        )

    def hold(self, held: NDArray[np.bool_]) -> None:
        """Solve for the other unknowns alone from now on; one flag for each row of N, (m,)."""
        self.held, self.free = held, np.ones(self.A.shape[0])
        self.free[self.bounded[held]] = 0
        self.cut = without(self.A, self.free)

    def _corrected(self, w: Array, r: Array, reduction: float) -> tuple[Array, NDArray[np.bool_]]:
        """w after a correction, and which unknowns are held or not held by mistake, (n,) and (m,)."""
        preconditioner = LinearOperator(self.A.shape, matvec=self.cycle, dtype=float)
        z, _ = cg(self.cut, self.free * r, rtol=reduction, maxiter=ITERATIONS, M=preconditioner)
        w = w + z
        values = w[self.bounded]
        w[self.bounded] = np.minimum(values, self.highest)
        return w, np.where(self.held, (r - self.A @ z)[self.bounded] <= 0, values > self.highest)

    def cycle(self, r: Array) -> Array:
        """A symmetric V-cycle r ↦ B r, B ≈ A⁻¹ on the unknowns that are not held, for an r that vanishes elsewhere."""
        if self.coarse is None:
            return r
        x = np.zeros_like(r)
        self.finest.presmoother(self.cut, x, r)
        x += self.free * (self.finest.P @ self.coarse(self.finest.R @ (r - self.cut @ x)))
        self.finest.postsmoother(self.cut, x, r)
        return x


def levels(A: sps.bsr_array, modes: Array) -> tuple[MultilevelSolver.Level, Callable[[Array], Array] | None]:
    """The finest level of smoothed aggregation, and a V-cycle on the others; None without others.

    Args:
        A: symmetric positive definite, in blocks of the unknowns of a vertex, with a diagonal of ones, (n, n).
        modes: near kernel, (n, count).
    """
    state = np.random.get_state()
    # pyamg estimates λ_max with numpy's global generator: the same matrix is to have the same levels every time.
    np.random.seed(0)
    smoothers = {"presmoother": SMOOTHER, "postsmoother": SMOOTHER}
    made = smoothed_aggregation_solver(A, modes, max_coarse=COARSEST, improve_candidates=None, **smoothers).levels
    np.random.set_state(state)
    coarse = MultilevelSolver(made[1:], coarse_solver="pinv").aspreconditioner().matvec if made[1:] else None
    return made[0], coarse


def without(A: sps.bsr_array, free: Array) -> sps.bsr_array:
    """A with zeros in the rows and columns where ``free``, of zeros and ones, is zero."""
    free = free.reshape(-1, A.blocksize[0])
    row = np.repeat(np.arange(len(free)), np.diff(A.indptr))
    met = free.min(axis=1) == 0
    touched = np.flatnonzero(met[row] | met[A.indices])
    data = A.data.copy()
    data[touched] *= free[row[touched], :, None] * free[A.indices[touched], None, :]
    return sps.bsr_array((data, A.indices, A.indptr), shape=A.shape)


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


def local_bases(N: sps.csr_array, d: int) -> tuple[Array, NDArray[np.int64]]:
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


def block_diagonal(blocks: Array) -> sps.bsr_array:
    """(n/d, d, d) → (n, n)."""
    count = len(blocks)
    return sps.bsr_array((blocks, np.arange(count), np.arange(count + 1)))
