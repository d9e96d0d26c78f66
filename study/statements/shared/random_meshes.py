"""Meshes that are random, and statistics of them that hang on chance as little as they can.

On a random mesh the error of one level is a random number. Were it e_n = C h^p (1 + δ_n), an order from two levels
would scatter by (δ_n² + δ_2n²)^½/log 2, which on 8 × 8 cells with a front is a twentieth, however right the theory is.
Two cures that lose nothing:

* *the leading term for h.* The error of Proposition 5.4 is that of interpolation but for a share that the ledger
  judges, and its leading term (Σ_T c_T h_T² ‖D²u‖²_T)^½ is known from the cells of this very mesh and second
  derivatives of u alone, with no solve and no error. Orders in it, in place of the mean size of cells, do not see which
  cells happen to be large where u bends: in a pilot they scattered by less than half as much in most cases, down to a
  hundredth. That the term itself is of order h is a row of its own.
* *weights.* A sum over N cells that do not know of each other has the relative variance 1/N, up to a factor. The order
  in h that Gauss and Markov find best is then the least squares one with the number of cells as weights
  (``ledger.measures.weighted``). In the pilot logarithms of errors of stresses scattered by 0.05, 0.015, 0.006 for
  n = 8, 16, 32: nearly all of the scatter of an order was that of the coarsest mesh.
"""

from __future__ import annotations

from study.fem.mesh import Shaken
from study.ledger.criterion import Groups

CELLS, ALONG = 2, 1
"""A plane mesh has h⁻² cells, and h⁻¹ along a line."""
LEADING = "predicted_interpolation"
"""The column of the leading term of ‖u − Π^h u‖_V."""


def is_random(family: str) -> bool:
    """Whether meshes of a family are shaken, with whatever seed."""
    return family.partition("-")[0] == Shaken().name


def apart(groups: Groups) -> tuple[Groups, Groups]:
    """The groups of random meshes and those of all others."""
    chance = {name: table for name, table in groups.items() if is_random(name)}
    return chance, {name: table for name, table in groups.items() if name not in chance}


def in_leading_term(groups: Groups) -> Groups:
    """Groups in which h is the leading term of interpolation on random meshes."""
    return {name: table.assign(h=table[LEADING]) if is_random(name) else table for name, table in groups.items()}
