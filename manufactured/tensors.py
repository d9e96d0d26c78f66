"""Symmetric second-order tensors as Mandel vectors.

A tensor τ ∈ S^d is stored by its coordinates in the orthonormal basis

    E_ii = e_i ⊗ e_i,      E_ij = (e_i ⊗ e_j + e_j ⊗ e_i)/√2   (i < j),

so that σ·τ = σ_ij τ_ij is the Euclidean product of the vectors, a fourth-order tensor with the
usual symmetries is a symmetric D × D matrix with the same eigenvalues, and a rotation of axes is
an orthogonal D × D matrix.

Shapes used throughout the project (everything is dimensionless):

    Points   (d, ...)   coordinates
    Vectors  (d, ...)   displacements, tractions, forces
    Tensors  (D, ...)   Mandel vectors, D = d(d+1)/2; d = 2: (11, 22, √2·12),
                        d = 3: (11, 22, 33, √2·23, √2·13, √2·12)

Source: J. Mandel, Généralisation de la théorie de plasticité de W. T. Koiter, Int. J. Solids
Struct. 1 (1965) 273–295.
"""

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

# Arrays may be real or complex, because derivatives are checked by the complex step.
Array = NDArray[Any]
Points = NDArray[Any]
Vectors = NDArray[Any]
Tensors = NDArray[Any]
Time = Array | complex
"""The type of one time, or of several times (n,). Times may be complex for derivatives by the complex step."""

Hyperplane = tuple[tuple[float, ...], float]
"""A line (2D) or plane (3D) {x : direction·x = offset}, as the pair (direction, offset)."""


def size(dim: int) -> int:
    """Return the number D = d(d+1)/2 of components of a symmetric d × d tensor."""
    return dim * (dim + 1) // 2


def mapped(C: Array, x: Array) -> Array:
    """Return the product C x of a matrix (m, n) or row (n,) with many vectors x (n, ...).

    For small C it is faster than NumPy's ``tensordot``.
    """
    return (C @ x.reshape(len(x), -1)).reshape(*C.shape[:-1], *x.shape[1:])


def with_time_axis(values: Array, time: Time) -> Array:
    """Return an array with a last axis of length 1 added, if ``time`` consists of several times."""
    return values[..., None] if np.ndim(time) else values


@lru_cache
def pairs(dim: int) -> tuple[tuple[int, int], ...]:
    """Return the index pairs (i, j), i ≤ j, in the order of the Mandel components of a symmetric tensor."""
    above = [(i, j) for i in range(dim) for j in range(i + 1, dim)]
    return (*((i, i) for i in range(dim)), *reversed(above))


@lru_cache
def basis(dim: int) -> Array:
    """Return the orthonormal basis E_I of the symmetric tensors that Mandel vectors use, as matrices, (D, d, d)."""
    matrices = np.zeros((size(dim), dim, dim))
    for row, (i, j) in enumerate(pairs(dim)):
        matrices[row, i, j] = matrices[row, j, i] = 1.0 if i == j else np.sqrt(0.5)
    matrices.setflags(write=False)
    return matrices


def mandel(full: Array) -> Tensors:
    """Return the Mandel vector of the symmetric part of matrices: (d, d, ...) → (D, ...)."""
    return np.tensordot(basis(full.shape[0]), full, axes=([1, 2], [0, 1]))


def full(tensors: Tensors) -> Array:
    """Return the symmetric matrices of Mandel vectors: (D, ...) → (d, d, ...)."""
    dim = int((np.sqrt(8 * tensors.shape[0] + 1) - 1) / 2)
    return np.tensordot(basis(dim), tensors, axes=([0], [0]))


def dyad(a: Vectors, b: Vectors) -> Tensors:
    """Return the Mandel vector of the symmetric product (a ⊗ b + b ⊗ a)/2 of two vectors: (d,), (d,) → (D,)."""
    return mandel(np.multiply.outer(a, b))


def identity(dim: int) -> Tensors:
    """Return the Mandel vector of the unit tensor, (D,); identity·τ = tr τ."""
    return mandel(np.eye(dim))


def rotation(frame: Array) -> Array:
    """Return the matrix that rotates Mandel vectors, τ ↦ F τ Fᵀ, (D, D); it is orthogonal.

    Args:
        frame: the matrix F with orthonormal columns, (d, d).
    """
    matrices = basis(frame.shape[0])
    turned = np.einsum("Iij,ik,Jkl,jl->IJ", matrices, frame, matrices, frame)
    # A rotation that only exchanges axes is made exact, so that callers can recognise the identity.
    whole = np.rint(turned)
    return np.where(abs(turned - whole) < 1e-15, whole, turned)


def traction(tensors: Tensors, normal: Array) -> Vectors:
    """Return the tractions τν of tensors for one normal: (D, ...), (d,) → (d, ...)."""
    return np.tensordot(basis(normal.shape[0]) @ normal, tensors, axes=([0], [0]))
