"""Smoothed aggregation: a multigrid preconditioner made from a matrix, for any set of unknowns that are held.

Vertices are aggregated, on each aggregate the near kernel of the matrix (the rigid motions) gives the columns of a
prolongation, and one step of Richardson's iteration smooths them (P. Vaněk, J. Mandel, M. Brezina, Algebraic multigrid
by smoothed aggregation for second and fourth order elliptic problems, Computing 56 (1996) 179–196).

Unknowns that are held are cut out of the finest matrix and of the prolongation to it, and the coarse matrices follow
from both (R. Kornhuber, Monotone multigrid methods for elliptic variational inequalities I, Numer. Math. 69 (1994)
167–184); without the latter the number of iterations would grow as h falls. The aggregates stay as they are, and since
only matrix entries near Γ3 change, the changes of the coarse matrices are found from these alone.

The smoother is Chebyshev's polynomial of the fourth kind, which asks for nothing but λ_max (J. Lottes, Optimal
polynomial smoothers for multigrid V-cycles, Numer. Linear Algebra Appl. 30 (2023) e2518).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.sparse as sps
from numpy.typing import NDArray
from pyamg.aggregation.aggregate import standard_aggregation
from pyamg.aggregation.tentative import fit_candidates
from pyamg.strength import symmetric_strength_of_connection
from scipy.sparse.linalg import LinearOperator, eigsh

from manufactured.tensors import Array

COARSEST = 250
"""Unknowns that are not coarsened any further: their dense inverse costs next to nothing."""
DEGREE = 3
"""Degree of the smoothing polynomial: products with the matrix in one smoothing."""
DAMPING = 4 / 3
"""Prolongations are smoothed by 1 − DAMPING A/λ_max."""
LANCZOS, SAFETY = 10, 1.05
"""Vectors that estimate λ_max, and what lifts the estimate above it. The smoother bears one that is 10 % too low."""
SINGULAR = 1e-12
"""Relative size of eigenvalues that are zero: cuts leave some coarse functions without support."""


class Level(NamedTuple):
    """A matrix A, the diagonal of its Jacobi smoother, the prolongation P from the next coarser level, and Pᵀ.

    Transposing P takes as long as multiplying by it. Where unknowns are held residuals vanish: Pᵀ need not be cut.
    """

    A: sps.bsr_array
    jacobi: Array
    P: sps.bsr_array
    restriction: sps.bsr_array


class Cycle:
    """A symmetric V-cycle r ↦ B r, B ≈ A⁻¹ on the unknowns that are not held, for conjugate gradients.

    Attributes:
        A: the finest matrix, zero in the rows and columns of unknowns that are held.
    """

    def __init__(self, A: sps.bsr_array, levels: list[Level], coarsest: Array) -> None:
        self.A, self._levels = A, levels
        self._inverse = np.linalg.pinv(coarsest, rcond=SINGULAR, hermitian=True)

    def __call__(self, r: Array) -> Array:
        """B r for an r that vanishes where unknowns are held; so does B r, up to rounding."""
        return self._from(0, r)

    def _from(self, depth: int, r: Array) -> Array:
        if depth == len(self._levels):
            return self._inverse @ r
        level = self._levels[depth]
        x = smooth(level, r)
        x += level.P @ self._from(depth + 1, level.restriction @ (r - level.A @ x))
        return x + smooth(level, r - level.A @ x)


def smooth(level: Level, r: Array) -> Array:
    """p(A) r ≈ A⁻¹ r on the upper part of the spectrum."""
    x, step = np.zeros_like(r), np.zeros_like(r)
    for k in range(1, DEGREE + 1):
        step = (2 * k - 3) / (2 * k + 1) * step + (8 * k - 4) / (2 * k + 1) * (level.jacobi * r)
        x += step
        if k < DEGREE:
            r = r - level.A @ step
    return x


def jacobi(A: sps.bsr_array) -> Array:
    """The diagonal of R = D⁻¹/λ, D that of A, with an estimate λ ≥ λ_max(D⁻¹A), (n,); 0 where A vanishes.

    Where unknowns are held nearby, coarse functions are steep and their entries of D large: without D they would
    dictate λ to all others.
    """
    diagonal = A.diagonal()
    support = diagonal > SINGULAR * diagonal.max()
    if not support.any():
        return np.zeros_like(diagonal)
    root = np.sqrt(np.divide(1.0, diagonal, out=np.zeros_like(diagonal), where=support))
    if len(root) <= LANCZOS:
        return root**2 / float(np.linalg.norm(root[:, None] * A.toarray() * root, 2))
    scaled = LinearOperator(A.shape, matvec=lambda v: root * (A @ (root * v)), dtype=float)
    start = np.random.default_rng(0).standard_normal(len(root))
    largest = eigsh(scaled, k=1, which="LA", tol=0.1, ncv=LANCZOS, v0=start, return_eigenvectors=False)
    return root**2 / (SAFETY * float(largest[0]))


class Hierarchy:
    """Coarse levels for a matrix.

    Args:
        A: symmetric positive definite, in blocks of the unknowns of a vertex, (n, n).
        modes: near kernel, (n, count).

    Attributes:
        A: the matrix.
        jacobi: R = A⁻¹ but for the entries off the diagonal, so small that λ_max(R A) ≤ 1, (n,).
    """

    def __init__(self, A: sps.bsr_array, modes: Array) -> None:
        self.A, self.jacobi = A, jacobi(A)
        self._levels: list[Level] = []
        self._coarse: list[sps.bsr_array] = []
        while A.shape[0] > COARSEST:
            smoother = jacobi(A) if self._levels else self.jacobi
            aggregates, _ = standard_aggregation(symmetric_strength_of_connection(A))
            tentative, modes = fit_candidates(aggregates, modes)
            smoothing = sps.bsr_array(sps.diags_array(DAMPING * smoother), blocksize=A.blocksize)
            P = sps.bsr_array(tentative - smoothing @ (A @ tentative))
            self._levels.append(Level(A, smoother, P, sps.bsr_array(P.T)))
            A = self._levels[-1].restriction @ (A @ P)
            self._coarse.append(A)

    def without(self, held: NDArray[np.bool_]) -> Cycle:
        """The V-cycle for the matrix without the rows and columns of the unknowns that are held, (n,)."""
        finest, change = _cut(self.A, held)
        A = finest
        levels: list[Level] = []
        for level, coarse in zip(self._levels, self._coarse, strict=True):
            # Eigenvalues of a submatrix interlace, those of coarse matrices need not.
            cut = {"jacobi": jacobi(A)} if levels else {"P": _without_rows(level.P, held)}
            levels.append(level._replace(A=A, **cut))
            change = level.restriction @ (change @ level.P)
            A = coarse - sps.bsr_array(change, blocksize=coarse.blocksize)
        return Cycle(finest, levels, A.toarray())


def _cut(A: sps.bsr_array, held: NDArray[np.bool_]) -> tuple[sps.bsr_array, sps.bsr_array]:
    """A with zeros in the rows and columns that are held, and A minus that, which has few entries."""
    free = 1.0 - held.reshape(-1, A.blocksize[0])
    row = np.repeat(np.arange(len(free)), np.diff(A.indptr))
    met = free.min(axis=1) == 0
    touched = np.flatnonzero(met[row] | met[A.indices])
    data = A.data.copy()
    data[touched] *= free[row[touched], :, None] * free[A.indices[touched], None, :]
    starts = np.searchsorted(touched, A.indptr).astype(A.indptr.dtype)
    change = sps.bsr_array((A.data[touched] - data[touched], A.indices[touched], starts), shape=A.shape)
    return sps.bsr_array((data, A.indices, A.indptr), shape=A.shape), change


def _without_rows(P: sps.bsr_array, held: NDArray[np.bool_]) -> sps.bsr_array:
    free = 1.0 - held.reshape(-1, P.blocksize[0])
    row = np.repeat(np.arange(len(free)), np.diff(P.indptr))
    return sps.bsr_array((P.data * free[row, :, None], P.indices, P.indptr), shape=P.shape)
