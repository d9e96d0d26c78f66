"""Heterogeneous laws on V^h: the means of their factors on the cells.

Strains of V^h are constant on cells, so the mean of α gives (α C ε(u), ε(v))_Q exactly.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sps

from manufactured.factor import UNIFORM, Factor
from manufactured.law import Elasticity, KelvinVoigt, PointLaw
from manufactured.tensors import Array
from study.fem.quadrature import Line, cell_rules
from study.fem.space import Space

DEGREE = 6
"""Degree of the quadrature rule for the mean of a factor; cells are cut where the factor jumps."""


def means(space: Space, factor: Factor) -> Array:
    """Return the mean of the factor α on every cell, (cells,)."""
    if factor is UNIFORM:
        return np.ones(len(space.volumes))
    found = np.empty(len(space.volumes))
    steps = tuple(Line(direction, offset) for direction, offset in factor.steps)
    for rule in cell_rules(space.mesh, DEGREE, steps):
        found[rule.cells] = np.sum(factor(rule.points) * rule.weights, axis=1) / space.volumes[rule.cells]
    return found


def form(space: Space, tensor: Elasticity) -> sps.csc_array:
    """Return the matrix of (α C ε(u), ε(v))_Q on V^h, where C is the constant reference tensor, (n_dofs, n_dofs)."""
    return space.form(tensor.reference, means(space, tensor.factor))


def on_cells(space: Space, law: KelvinVoigt) -> PointLaw:
    """Return the law between strains and stresses that are constant on cells, (D, cells) each."""
    return law.scaled(means(space, law.A.factor), means(space, law.G.factor))
