"""Sparse Cholesky factorisation of a symmetric positive definite matrix, by SciPy's SuperLU."""

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sps
from numpy.typing import NDArray
from scipy.sparse.linalg import SuperLU, splu

from manufactured.tensors import Array, Points

Integers = NDArray[np.int64]

LEAF = 32
"""Nested dissection does not divide sets of at most this number of points."""

MOST_ENTRIES = (2**31 - 1) // 30
"""Largest number of entries of a matrix that SuperLU can factorise.

SuperLU reserves space for 30 times as many entries as the matrix has, and counts them in 32 bits.
"""


class Cholesky:
    """The Cholesky factorisation S = Pᵀ L Lᵀ P of a sparse matrix; a call with b returns S⁻¹ b.

    The permutation P is an order of elimination that keeps L sparse and eliminates given unknowns last. The trailing
    block of L is then the Cholesky factor of the Schur complement of S on these unknowns.

    How SuperLU is used: without pivoting it computes S = L₁ U with U = D L₁ᵀ, so that L = L₁ D^{1/2}. It has no
    function for a solve with L₁ alone. But if L itself is factorised, its factors are trivial, and solves with L and
    with Lᵀ are the forward and the backward substitution.

    Args:
        S: a symmetric positive definite matrix, (n, n).
        last: the unknowns that are eliminated last, (c,).
        x: the p points to which the unknowns belong, n/p consecutive unknowns each, (d, p). The points give an order of
            elimination by nested dissection. Without them a minimum degree order is used, for which S is factorised
            twice; this is meant for small matrices.

    Attributes:
        order: the unknowns in the order of elimination, (n,).
        trailing: the block of L on the unknowns ``last``, in the order ``order[-c:]``, (c, c).

    Raises:
        LinAlgError: S is not positive definite.
        MemoryError: S or L is too large for SuperLU, however much memory there is.
    """

    def __init__(self, S: sps.csc_array, last: Sequence[int] | Integers = (), x: Points | None = None) -> None:
        # SuperLU's minimum degree order needs no points.
        order = np.argsort(superlu(S, "MMD_AT_PLUS_A").perm_c) if x is None else nested_dissection(S, x)
        at_end = np.isin(order, last)
        self.order = np.concatenate([order[~at_end], order[at_end]])
        factors = superlu(S[self.order][:, self.order])
        pivots = factors.U.diagonal()
        if not ((pivots > 0).all() and np.array_equal(factors.perm_r, np.arange(len(order)))):
            raise np.linalg.LinAlgError("the matrix is not positive definite, so it has no Cholesky factor")
        L = sps.csc_array(factors.L @ sps.diags_array(np.sqrt(pivots)))
        # The factors L₁ and U take most of the memory, so they are freed before the next matrix is made.
        del factors
        count = len(order) - len(last)
        self.trailing = L[count:, count:].toarray()
        self._triangular = superlu(L)

    def __call__(self, b: Array) -> Array:
        """Return S⁻¹ b for a right-hand side b, (n,), or for m of them, (m, n)."""
        return self.backward(self.forward(b))

    def forward(self, b: Array) -> Array:
        """Return y = L⁻¹ P b, the forward substitution for b, (n,) or (m, n)."""
        return np.asarray(self._triangular.solve(b[..., self.order].T).T)

    def backward(self, y: Array) -> Array:
        """Return Pᵀ L⁻ᵀ y, the backward substitution for y, (n,) or (m, n)."""
        u = np.empty_like(y)
        u[..., self.order] = self._triangular.solve(y.T, "T").T
        return u


def superlu(matrix: sps.csc_array, permc_spec: str = "NATURAL") -> SuperLU:
    """Factorise a matrix with a symmetric pattern by SuperLU, without pivoting.

    Args:
        matrix: the matrix.
        permc_spec: SuperLU's option for the order of the columns.

    Raises:
        LinAlgError: the matrix is not positive definite.
        MemoryError: the matrix is too large for SuperLU, however much memory there is.
    """
    if matrix.nnz > MOST_ENTRIES:
        raise MemoryError(
            f"SciPy's SuperLU can factorise matrices with at most {MOST_ENTRIES} entries, and this one has {matrix.nnz}"
            ": take coarser levels or meshes, or fewer refinements, for example --refine 0"
        )
    # The option ``relax`` must keep its default in SciPy: with 40, SciPy 1.17 writes beyond its arrays.
    try:
        options = {"SymmetricMode": True}
        return splu(sps.csc_matrix(matrix), permc_spec=permc_spec, diag_pivot_thresh=0.0, options=options)
    except RuntimeError as error:
        raise np.linalg.LinAlgError(f"the matrix is not positive definite: {error}") from error


def nested_dissection(S: sps.csc_array, x: Points) -> Integers:
    """Return an order of the unknowns that keeps the factors sparse, by geometric nested dissection, (n,).

    The set of points is divided into two halves at the median of its longest coordinate axis. The points of one half
    that are coupled to the other half are called a separator. The smaller of the two separators is eliminated after
    both halves. The halves are divided in the same way (A. George, Nested dissection of a regular finite element mesh,
    SIAM J. Numer. Anal. 10 (1973) 345–363).

    In the program each point gets a key with one ternary digit for each division: 0 in the lower half, 1 in the upper
    half, 2 in the separator, which is not divided again. Points with equal keys form a part, and sorting the keys gives
    the order.

    Args:
        S: a matrix with a symmetric pattern, (n, n).
        x: the p points to which the unknowns belong, n/p consecutive unknowns each, (d, p).
    """
    count = x.shape[1]
    several = S.shape[0] // count
    first, second = (unknowns // several for unknowns in S.tocoo().coords)
    key = np.zeros(count, dtype=np.int64)
    divisible = np.arange(count)
    for _ in range(max(int(np.ceil(np.log2(count / LEAF))), 0)):
        # Couplings between different parts are no longer needed.
        coupled = key[first] == key[second]
        first = first[coupled]
        second = second[coupled]
        # The points of a part become consecutive; ``part`` is the number of the part of each point.
        divisible = divisible[np.argsort(key[divisible], kind="stable")]
        is_first = np.diff(key[divisible], prepend=-1) != 0
        starts = np.flatnonzero(is_first)
        part = np.cumsum(is_first) - 1
        points = x[:, divisible]
        extents = np.maximum.reduceat(points, starts, axis=1) - np.minimum.reduceat(points, starts, axis=1)
        longest = extents.argmax(axis=0)
        y = x[longest[part], divisible]
        middles = (starts + np.append(starts[1:], len(y))) // 2
        medians = y[np.lexsort((y, part))][middles]
        half = np.zeros(count, dtype=np.int64)
        half[divisible] = y >= medians[part]
        # The separator is on the side with fewer points that are coupled to the other side.
        cut = half[first] < half[second]
        sides = np.zeros((2, count), dtype=bool)
        sides[0, first[cut]] = True
        sides[1, second[cut]] = True
        smaller = np.add.reduceat(sides[:, divisible], starts, axis=1, dtype=np.int64).argmin(axis=0)
        separates = sides[smaller[part], divisible]
        digits = half
        digits[divisible[separates]] = 2
        key = 3 * key + digits
        divisible = divisible[~separates]
    return np.argsort(np.repeat(key, several), kind="stable")
