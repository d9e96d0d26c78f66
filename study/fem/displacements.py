"""Displacements on a mesh that vanish on Γ1, and those of them that are admissible on Γ3.

A function is the vector of its free coefficients (dofs,): d for every scalar basis function that vanishes on Γ1. Its
strains are stored at some points of every cell, at which products of two are integrated exactly, so that one sparse
matrix E of Mandel strains carries the whole discretisation: with the weights w of the points

    ε(v) = E v,   (C ε(u), ε(v))_Q = uᵀ Eᵀ diag(w C) E v,   (σ, ε(v))_Q = Eᵀ(w σ)·v.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property

import numpy as np
import scipy.sparse as sps

from manufactured.body import Kind, Part
from manufactured.tensors import Array, Tensors
from study.fem.mesh import MeshedBody


class Displacements(MeshedBody, ABC):
    """What displacements of degree 1 (``Space``) and of degree 2 (``Quadratic``) have in common."""

    @property
    @abstractmethod
    def count(self) -> int:
        """The number of scalar basis functions."""

    @property
    @abstractmethod
    def numbers(self) -> Array:
        """The basis functions of the cells, (k, cells)."""

    @abstractmethod
    def numbers_on(self, part: Part) -> Array:
        """The basis functions that do not vanish on a closed part, (n,)."""

    @property
    @abstractmethod
    def weights(self) -> Array:
        """w, (cells,) or (cells, points)."""

    @property
    @abstractmethod
    def E(self) -> sps.csr_array:
        """Strains of the basis functions, (cells · points · D, dofs)."""

    @property
    def dim(self) -> int:
        return int(self.mesh.dim())

    @cached_property
    def free(self) -> Array:
        """Positions of the free coefficients in the vector of all, d for each basis function."""
        fixed = np.zeros(self.count, dtype=bool)
        for part in self.body.of(Kind.CLAMPED):
            fixed[self.numbers_on(part)] = True
        return np.flatnonzero(np.repeat(~fixed, self.dim))

    @property
    def dofs(self) -> int:
        return len(self.free)

    def coefficients(self, v: Array) -> Array:
        """All coefficients of a function, zero on Γ1: (dofs,) → (count, d)."""
        full = np.zeros(self.dim * self.count)
        full[self.free] = v
        return full.reshape(-1, self.dim)

    def strain(self, v: Array) -> Tensors:
        """ε(v), (D, cells) or (D, cells, points)."""
        return np.moveaxis((self.E @ v).reshape(*self.weights.shape, -1), -1, 0)

    def functional(self, stress: Tensors) -> Array:
        """(σ, ε(·))_Q for the means of a stress on the cells, or its values at the points, → (dofs,)."""
        return self.E.T @ np.moveaxis(self.weights * stress, 0, -1).ravel()

    def form(self, C: Array, factor: Array | float = 1.0) -> sps.csc_array:
        """The matrix of (α C ε(u), ε(v))_Q for a tensor C, Mandel (D, D), and α as in ``weights``."""
        weighted = sps.kron(sps.diags_array((self.weights * factor).ravel()), C, format="csr")
        matrix = sps.csc_array(self.E.T @ (weighted @ self.E))
        return sps.csc_array((matrix + matrix.T) / 2)

    @cached_property
    def contact(self) -> list[tuple[Part, Array]]:
        """Each piece Γ3,i with its basis functions off Γ1, in the order of the rows of ``N``.

        A function on two pieces of the same normal belongs to the first: one constraint is one row.
        """
        fixed = np.setdiff1d(np.arange(self.count), self.free[:: self.dim] // self.dim)
        found: list[tuple[Part, Array]] = []
        for part in self.body.of(Kind.CONTACT):
            same = [numbers for other, numbers in found if np.allclose(other.normal, part.normal)]
            found.append((part, np.setdiff1d(self.numbers_on(part), np.concatenate([fixed, *same]))))
        return found

    @cached_property
    def N(self) -> sps.csr_array:
        """v ↦ ν·c for the coefficients on Γ3, (m, dofs): admissible are the v with N v ≤ 0.

        One row per piece and function: a function on two pieces has both constraints.
        """
        normals = np.concatenate([np.tile(part.normal, (len(numbers), 1)) for part, numbers in self.contact])
        numbers = np.concatenate([numbers for _, numbers in self.contact])
        return sps.csr_array(self._rows(normals[:, None], numbers[:, None])[:, self.free])

    def _matrix(self, values: Array) -> sps.csr_array:
        """The matrix on the free coefficients with the same number of rows in every cell, (cells, rows, k, d)."""
        full = self._rows(values, self.numbers.T[:, None])
        full.eliminate_zeros()
        return sps.csr_array(full[:, self.free])

    def _rows(self, values: Array, numbers: Array) -> sps.csr_array:
        """The matrix on all coefficients, with rows of the values (..., k, d) at those of k functions (..., k)."""
        columns = np.broadcast_to(self.dim * numbers[..., None] + np.arange(self.dim), values.shape)
        width = values.shape[-2] * values.shape[-1]
        starts = np.arange(0, values.size + 1, width)
        return sps.csr_array((values.ravel(), columns.ravel(), starts), shape=(len(starts) - 1, self.dim * self.count))
