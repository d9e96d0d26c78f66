"""Matrices of bilinear forms on the P1 space V^h, and extreme values of Rayleigh quotients of two forms."""

import numpy as np
import scipy.sparse as sps
from scipy.sparse.linalg import eigsh
from skfem import Basis
from skfem.models.poisson import mass as scalar_mass

from manufactured.law import KelvinVoigt
from manufactured.tensors import size
from study.fem.space import Space
from study.solve.evolution import SemiDiscrete
from study.statements.shared.base import SEED

SMALLEST, LARGEST = 1e-9, 1e-4
"""Relative tolerances for the smallest and for the largest eigenvalue.

The largest eigenvalues lie in clusters, so their eigenvectors converge slowly. A loose tolerance suffices for them,
because the error of a Rayleigh quotient is about the square of the error of the eigenvector."""
LANCZOS = 40
"""Number of Lanczos vectors with which the largest eigenvalue is computed."""


def unloaded(space: Space, law: KelvinVoigt) -> SemiDiscrete:
    """Return the semi-discrete problem (Problem 5.1) with zero load and zero initial displacement.

    Only the matrices of this problem are used.
    """
    return SemiDiscrete.of(space, law, lambda times: np.zeros((space.dofs, times.size)), np.zeros(space.dofs))


def strain_product(space: Space) -> sps.csc_array:
    """Return the matrix of the L² product of strains (ε(u), ε(v))_Q on the P1 space V^h, (dofs, dofs)."""
    return space.form(np.eye(size(space.dim)))


def mass(space: Space) -> sps.csc_array:
    """Return the mass matrix, that is, the matrix of the L² product (u, v)_H on V^h, (dofs, dofs)."""
    scalar = scalar_mass.assemble(Basis(space.mesh, space.mesh.elem()))
    vector = sps.csr_array(sps.kron(scalar, np.eye(space.dim)))
    return sps.csc_array(vector[space.free][:, space.free])


def h1_product(space: Space) -> sps.csc_array:
    """Return the matrix of the inner product (2.11), (u, v)_{H_1} = (u, v)_H + (ε(u), ε(v))_Q, on V^h, (dofs, dofs)."""
    return sps.csc_array(mass(space) + strain_product(space))


def smallest(form: sps.csc_array, product: sps.csc_array) -> float:
    """Return the smallest Rayleigh quotient a(v, v)/b(v, v) of two forms over v ∈ V^h.

    Args:
        form: the matrix of a, positive definite.
        product: the matrix of b, positive definite.
    """
    start = np.random.default_rng(SEED).standard_normal(form.shape[0])
    return float(eigsh(form, 1, product, sigma=0.0, v0=start, tol=SMALLEST, return_eigenvectors=False)[0])


def largest(form: sps.csc_array, product: sps.csc_array) -> float:
    """Return the largest Rayleigh quotient a(v, v)/b(v, v) of two forms over v ∈ V^h.

    Lanczos' method is used without a shift, because a shift at a supposed bound would hide eigenvalues far beyond it.

    Args:
        form: the matrix of a.
        product: the matrix of b, positive definite.
    """
    start = np.random.default_rng(SEED).standard_normal(form.shape[0])
    vectors = min(LANCZOS, len(start))
    return float(eigsh(form, 1, product, which="LA", v0=start, tol=LARGEST, ncv=vectors, return_eigenvectors=False)[0])
