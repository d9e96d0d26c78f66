"""A multigrid solver for one contact problem: minimise ½ vᵀSv − bᵀv over K^h = {v : N v ≤ g}.

Memory and time are proportional to the number n of unknowns.

**Coordinates.** At a contact vertex, the d displacement components are replaced by the values of the r rows of N at
this vertex and by d − r components along an orthonormal basis of the orthogonal complement. All new unknowns w are
scaled so that the matrix A of the quadratic form has ones on its diagonal. The constraints are then bounds of single
unknowns, w_i ≤ g_i, whatever the normals are. The initial gap g, 0 in the paper, is scaled like the rows of N.

**Active set method.** As in ``signorini``, the active set contains the unknowns that are held at their bound. With f
for b in the new coordinates, one iteration, called a correction,

1. solves A z ≈ f − A w approximately by conjugate gradients, with z = 0 on the held unknowns;
2. finds the held unknowns without contact pressure, (f − A(w + z))_i ≤ 0, and the other unknowns that would exceed
   their bound, w_i + z_i > g_i;
3. projects w + z on K^h, releases the unknowns of the first kind and holds those of the second kind.

Active sets may repeat in a cycle. If this is suspected, z is computed accurately and only one unknown changes in each
correction, the last one found. This ends after finitely many corrections (J. J. Júdice, F. M. Pires, A block principal
pivoting algorithm for large-scale strictly monotone linear complementarity problems, Comput. Oper. Res. 21 (1994)
587–596).

**Preconditioner.** The conjugate gradients are preconditioned by a V-cycle of smoothed aggregation by pyamg, with the
rigid motions as near kernel (P. Vaněk, J. Mandel, M. Brezina, Algebraic multigrid by smoothed aggregation for second
and fourth order elliptic problems, Computing 56 (1996) 179–196). The coarse levels are constructed once. Held unknowns
are removed from the finest matrix and from the corrections that the coarse levels return. New coarse matrices for every
active set would halve the number of iterations, but their construction would take the time that they save.

``contact_solver`` chooses the contact solver for a space, the direct one or this one.
"""

import math
from collections.abc import Callable
from functools import partial
from itertools import combinations

import numpy as np
import scipy.sparse as sps
from numpy.typing import NDArray
from pyamg import MultilevelSolver, smoothed_aggregation_solver
from pyamg.util.utils import get_block_diag
from scipy.sparse.linalg import LinearOperator, cg

from manufactured.tensors import Array, Points
from study.fem.space import Displacements
from study.solve.signorini import ContactSolution, ContactSolver, Signorini

REDUCTION = 0.02
"""Factor by which one correction (some conjugate gradient iterations) reduces the residual of the multigrid solver.

More accuracy would be wasted while the active set changes.
"""
CORRECTIONS, GRADIENT_ITERATIONS = 200, 300
"""Largest numbers of corrections in a solve by multigrid, and of conjugate gradient iterations in a correction."""
PATIENCE = 5
"""Number of corrections without progress after which active sets are supposed to repeat in a cycle.

Progress means that the number of unknowns that must enter or leave the active set has reached a new minimum.
"""
SMOOTHER = ("chebyshev", {"degree": 2, "lower_bound": 1 / 20})
"""The smoother of the multigrid method: Chebyshev polynomials of degree 2 for eigenvalues above λ_max/20.

Higher degrees cost more time than they save.
"""
COARSEST = 100
"""Largest number of aggregates on the coarsest multigrid level, whose matrix is inverted as a dense matrix."""
INDEPENDENT = 1e-8
"""Two contact normals at a vertex are refused as linearly dependent if the sine of their angle is below this number."""


class MultigridError(RuntimeError):
    """Raised if the multigrid solver did not reach its tolerance."""


class Multigrid:
    """The multigrid solver of contact problems: minimise ½ uᵀSu − bᵀu subject to N u ≤ g, for fixed matrices S and N.

    A call with b returns the displacement u and the contact forces λ. They satisfy N u ≤ g, λ ≥ 0 and λ·(N u − g) = 0
    up to rounding, and S u + Nᵀλ = b up to the tolerance. Each solve starts from the last solution and active set.

    Args:
        S: a symmetric positive definite matrix, with the d unknowns of each vertex in sequence, (n, n).
        N: the constraint matrix, (m, n). All entries of a row belong to one vertex, and the rows of a vertex are
            linearly independent.
        x: the vertices to which the unknowns belong, (d, n/d).
        tolerance: the largest accepted relative residual ‖S u + Nᵀλ − b‖/‖b‖.
        gap: the initial gap g ≥ 0, (m,) or a number.

    Raises:
        ValueError: x does not match the unknowns of S, or N does not have the required form.
    """

    def __init__(
        self, S: sps.csc_array, N: sps.csr_array, x: Points, tolerance: float, gap: Array | float = 0.0
    ) -> None:
        if x.size != S.shape[0]:
            raise ValueError(
                f"S has {S.shape[0]} unknowns, but {x.shape[1]} vertices in dimension {len(x)} have {x.size}: "
                "give exactly the vertices that are free to move"
            )
        self.tolerance = tolerance
        blocks, self.bounded = local_bases(N, len(x))
        inverse = np.linalg.inv(blocks)
        S = sps.bsr_array(S, blocksize=(len(x), len(x)))
        diagonal = get_block_diag(S, len(x), inv_flag=False)
        scale = np.sqrt(np.einsum("vai,vab,vbi->vi", inverse, diagonal, inverse))
        # The matrices convert scaled unknowns w to displacements u and back: u = basis w and w = coordinates u.
        self.basis = block_diagonal(inverse / scale[:, None, :])
        self.coordinates = block_diagonal(blocks * scale[:, :, None])
        self.forces = scale.ravel()[self.bounded]
        self.highest = self.forces * gap
        self.A = sps.bsr_array(self.basis.T @ S @ self.basis)
        self.finest, self.coarse = levels(self.A, self.coordinates @ rigid_motions(x))
        self.w = np.zeros(S.shape[0])
        self.hold(np.zeros(N.shape[0], dtype=bool))

    def __call__(self, b: Array) -> ContactSolution:
        """Solve the contact problem for a load b: return u ∈ K^h, (n,), and the nodal contact forces λ ≥ 0, (m,).

        Raises:
            MultigridError: the tolerance was not reached.
        """
        f = self.basis.T @ b
        aim = self.tolerance * float(np.linalg.norm(b))
        w = self.w if b.any() else np.zeros_like(b)
        wrong = np.zeros_like(self.held)
        fewest = len(self.held) + 1
        patience = PATIENCE
        for _ in range(CORRECTIONS):
            r = f - self.A @ w
            forces = np.maximum(r, 0) * (self.free == 0)
            defect = float(np.linalg.norm(self.coordinates.T @ (r - forces)))
            if defect <= aim:
                self.w = w
                return self.basis @ w, self.forces * forces[self.bounded]
            if wrong.any():
                count = wrong.sum()
                patience = PATIENCE if count < fewest else patience - 1
                fewest = min(count, fewest)
                if patience <= 0:
                    wrong[: np.flatnonzero(wrong)[-1]] = False
                self.hold(self.held ^ wrong)
            reduction = REDUCTION if patience > 0 else 0.0
            w, wrong = self._corrected(w, r, max(reduction, aim / defect / 2))
        raise MultigridError(
            f"the contact solver has a relative residual of {defect / aim * self.tolerance:.2g} after {CORRECTIONS} "
            f"corrections, more than the tolerance {self.tolerance:g}: rounding may allow no less, so take a larger one"
        )

    def hold(self, held: NDArray[np.bool_]) -> None:
        """Set the active set, and cut the held unknowns out of the matrix.

        Args:
            held: for each row of the constraint matrix, whether the constraint is active, so that its unknown is held
                at its bound, (m,).
        """
        self.held = held
        self.free = np.ones(self.A.shape[0])
        self.free[self.bounded[held]] = 0
        # The rows and columns of the held unknowns are set to zero, block by block.
        A = self.A
        free = self.free.reshape(-1, A.blocksize[0])
        row = np.repeat(np.arange(len(free)), np.diff(A.indptr))
        data = A.data * free[row, :, None] * free[A.indices, None, :]
        self.cut = sps.bsr_array((data, A.indices, A.indptr), shape=A.shape)

    def _corrected(self, w: Array, r: Array, reduction: float) -> tuple[Array, NDArray[np.bool_]]:
        """Return the iterate after one correction, (n,), and for each row of N whether to hold its unknown, (m,).

        Args:
            w: the present iterate, (n,).
            r: the residual f − A w of this iterate, (n,).
            reduction: the factor by which conjugate gradients reduce the residual.
        """
        preconditioner = LinearOperator(self.A.shape, matvec=self.cycle, dtype=float)
        z, _ = cg(self.cut, self.free * r, rtol=reduction, maxiter=GRADIENT_ITERATIONS, M=preconditioner)
        w = w + z
        values = w[self.bounded]
        w[self.bounded] = np.minimum(values, self.highest)
        forces = (r - self.A @ z)[self.bounded]
        return w, np.where(self.held, forces <= 0, values > self.highest)

    def cycle(self, r: Array) -> Array:
        """Apply the preconditioner, a symmetric V-cycle, to a residual that is 0 on the unknowns held at their bounds.

        Args:
            r: the residual, (n,).
        """
        if self.coarse is None:
            return r
        x = np.zeros_like(r)
        self.finest.presmoother(self.cut, x, r)
        residual = self.finest.R @ (r - self.cut @ x)
        x += self.free * (self.finest.P @ self.coarse(residual))
        self.finest.postsmoother(self.cut, x, r)
        return x


def levels(A: sps.bsr_array, modes: Array) -> tuple[MultilevelSolver.Level, Callable[[Array], Array] | None]:
    """Construct the levels of the multigrid method by smoothed aggregation.

    Args:
        A: a symmetric positive definite matrix with ones on the diagonal, in blocks for the vertices, (n, n).
        modes: vectors v for which A v is almost 0 (the near kernel), such as rigid motions, as columns, (n, count).

    Returns:
        The finest level, and a function that applies a V-cycle on the other levels, or None if there are none.
    """
    state = np.random.get_state()
    # The seed is fixed because pyamg estimates λ_max with NumPy's global random generator. So the levels are
    # reproducible.
    np.random.seed(0)
    smoothers = {"presmoother": SMOOTHER, "postsmoother": SMOOTHER}
    made = smoothed_aggregation_solver(A, modes, max_coarse=COARSEST, improve_candidates=None, **smoothers).levels
    np.random.set_state(state)
    coarse = MultilevelSolver(made[1:], coarse_solver="pinv").aspreconditioner().matvec if made[1:] else None
    return made[0], coarse


def rigid_motions(x: Points) -> Array:
    """Return the displacements at points of all translations and infinitesimal rotations, as columns.

    The shape is (d, vertices) → (d·vertices, d(d + 1)/2).
    """
    d, count = x.shape
    motions = [np.tile(unit[:, None], count) for unit in np.eye(d)]
    centred = x - x.mean(axis=1, keepdims=True)
    for i, j in combinations(range(d), 2):
        rotation = np.zeros((d, count))
        rotation[i] = -centred[j]
        rotation[j] = centred[i]
        motions.append(rotation)
    return np.array([motion.T.ravel() for motion in motions]).T


def local_bases(N: sps.csr_array, d: int) -> tuple[Array, NDArray[np.int64]]:
    """Return new displacement coordinates at every vertex in which each contact constraint is a bound of one unknown.

    N is the constraint matrix, and d the dimension. The matrix of a vertex, which gives the new coordinates, consists
    of its rows of N, followed by an orthonormal basis of their orthogonal complement.

    Returns:
        The matrices of the vertices, (n/d, d, d), and the new unknown of each row of N, (m,). Row i of N is row
        ``unknown[i] % d`` of the matrix of the vertex ``unknown[i] // d``.

    Raises:
        ValueError: a row of N has entries at several vertices or at none, or the rows of a vertex are linearly
            dependent.
    """
    rows, columns = N.nonzero()
    rows, vertices = np.unique([rows, columns // d], axis=1)
    counts = np.bincount(rows, minlength=N.shape[0])
    if (counts != 1).any():
        row = int((counts != 1).argmax())
        raise ValueError(
            f"row {row} of N has entries at {counts[row]} vertices, expected 1: give one normal at one vertex in each "
            "row"
        )
    blocks = np.tile(np.eye(d), (N.shape[1] // d, 1, 1))
    unknowns = np.empty(N.shape[0], dtype=np.int64)
    for vertex in np.unique(vertices):
        rows = np.flatnonzero(vertices == vertex)
        normals = N[rows][:, d * vertex : d * (vertex + 1)].toarray()
        units = normals / np.linalg.norm(normals, axis=1, keepdims=True)
        _, sizes, orthonormal = np.linalg.svd(units)
        if len(rows) > d or sizes.min() < INDEPENDENT:
            raise ValueError(
                f"the rows {units.tolist()} of N at one vertex are linearly dependent: keep linearly independent ones"
            )
        blocks[vertex] = np.vstack([normals, orthonormal[len(rows) :]])
        unknowns[rows] = d * vertex + np.arange(len(rows))
    return blocks, unknowns


def block_diagonal(blocks: Array) -> sps.bsr_array:
    """Return the block diagonal matrix of given blocks, (n/d, d, d) → (n, n)."""
    count = len(blocks)
    return sps.bsr_array((blocks, np.arange(count), np.arange(count + 1)))


FACTORED = {2: math.inf, 3: 15_000}
"""Largest number n of unknowns for which the direct solver is used, by the dimension of the body.

In 2D its Cholesky factor has O(n log n) entries, and multigrid takes ten times as long. In 3D the factor has O(n^{4/3})
entries and takes O(n²) operations.
"""
DIRECT_RESIDUAL = 1e-10
"""Largest relative residual that the direct solver may leave."""
SHARE = 0.01
"""Permitted error of the multigrid solver, as a fraction of the discretisation error (see ``residual``)."""


def contact_solver(space: Displacements) -> Callable[..., ContactSolver]:
    """Return a function that makes contact solvers for a space: direct ones, or multigrid for large problems in 3D.

    The function is called with a matrix S, the constraint matrix N and optionally the initial gap, ``gap=g``. The
    solver that it makes minimises ½ vᵀSv − bᵀv subject to N v ≤ g.
    """
    if space.dofs <= FACTORED[space.dim]:
        return partial(Signorini, x=space.free_points)
    return partial(Multigrid, x=space.free_points, tolerance=multigrid_tolerance(space.dim, space.dofs))


def multigrid_tolerance(dim: int, dofs: int) -> float:
    """Return the relative residual at which the multigrid solver stops: half of what ``residual`` permits for it.

    Args:
        dim: the dimension of the body.
        dofs: the number of unknowns.
    """
    return SHARE / 2 * (dim / dofs) ** (2 / dim)


def residual(dim: int, dofs: int) -> float:
    """Return the largest permitted relative residual ‖S u + Nᵀλ − b‖/‖b‖ of the contact solver for S u + Nᵀλ = b.

    For the direct solver this is ``DIRECT_RESIDUAL``. For multigrid it is ϑ h² with ϑ = ``SHARE`` and the mesh size h =
    (d/dofs)^{1/d}, where d is the dimension ``dim``. The reason is that a relative residual ρ gives a relative error of
    at most cond(S)^{1/2} ρ in the norm of S, and cond(S)^{1/2} grows like 1/h. The solver's error is then at most about
    ϑ h, while the discretisation error is of order h. The constants are measured by tests.

    Args:
        dim: the dimension of the body.
        dofs: the number n of unknowns, which decides between the direct solver and multigrid (``FACTORED``).
    """
    return DIRECT_RESIDUAL if dofs <= FACTORED[dim] else 2 * multigrid_tolerance(dim, dofs)
