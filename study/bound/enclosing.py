"""The bounds of ‖u(t) − u_h(t)‖_V for one computed displacement, knot by knot of ũ."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import chain, pairwise

import numpy as np
import scipy.sparse as sps

from manufactured.tensors import Array
from study.bound.discrete_solution import DiscreteSolution
from study.bound.discretisation import Discretisation
from study.bound.embedding import prolongation
from study.bound.majorant import Majorant
from study.bound.spline import Parabola, spline
from study.bound.trajectory import Trajectory
from study.bound.two_sided import Enclosure
from study.fem.quadrature import Line, cell_rules

INITIAL_DEGREE = 6
"""Degree of the rule for ‖u_0 − ũ(0)‖_V."""


def enclose(
    coarse: Discretisation,
    computed: DiscreteSolution,
    trajectory: Trajectory,
    error: Callable[[float, Array], float] | None = None,
    progress: Callable[[float], object] = lambda time: None,
) -> Enclosure:
    """The bounds for one computed displacement.

    Args:
        coarse: the discretisation on the mesh of u_h.
        computed: u_h.
        trajectory: ũ.
        error: (t, u_h(t)) ↦ ‖u(t) − u_h(t)‖_V, where the exact solution is known.
        progress: told every time that is done.

    Raises:
        BoundError: the nodes of ũ are not equally spaced in time, or its mesh is no refinement of that of u_h.
    """
    fine = trajectory.discretisation(coarse)
    J = prolongation(computed.space, fine)
    pieces = spline(trajectory.nodes(fine, computed))
    first = next(pieces)
    start = _initial_error(fine, first.start)
    intervals, knots = [], []
    for piece, interval in Majorant(fine)(chain([first], pieces), start):
        u = computed.at(piece.b)
        true = error(piece.b, u) if error else math.nan
        between = interval.inside + _largest_distance(fine, piece, computed, J)
        knots.append((piece.b, fine.norm(piece.end - J @ u), interval.at_b, true, between))
        intervals.append(interval)
        progress(piece.b)
    times, distance, bound, errors, between_knots = np.array(knots).T.copy()
    at_0 = start + fine.norm(first.start - J @ computed.nodes[0])
    return Enclosure(computed.space.h, times, distance, bound, errors, tuple(intervals), at_0, between_knots)


def _largest_distance(
    discretisation: Discretisation, piece: Parabola, computed: DiscreteSolution, J: sps.csr_array
) -> float:
    """A bound of ‖ũ(t) − u_h(t)‖_V on a piece: the largest of the Bernstein coefficients in time.

    A node of u_h can only lie in the middle of a piece, where the parabola is cut.
    """
    middle = piece.at((piece.a + piece.b) / 2)
    ends = [piece.start, middle, piece.end]
    controls = [(piece.start + piece.control) / 2, (piece.control + piece.end) / 2]
    times = [piece.a, (piece.a + piece.b) / 2, piece.b]
    values = [J @ computed.at(time) for time in times]
    differences = [v - w for v, w in zip(ends, values, strict=True)]
    differences += [c - (v + w) / 2 for c, (v, w) in zip(controls, pairwise(values), strict=True)]
    return max(discretisation.norm(d) for d in differences)


def _initial_error(discretisation: Discretisation, start: Array) -> float:
    """‖u_0 − ũ(0)‖_V by quadrature that respects where u_0 is rough."""
    data, V = discretisation.data, discretisation.displacements
    total = 0.0
    lines = [Line(direction, offset) for direction, offset in data.lines]
    for rule in cell_rules(discretisation.mesh, INITIAL_DEGREE, lines, data.points):
        difference = data.initial(rule.points) - V.strain_at(start, rule.cells, rule.points)
        stress = data.law.A.at(rule.points)(difference)
        total += float(np.einsum("Inq,Inq,nq->", stress, difference, rule.weights))
    return math.sqrt(total)
