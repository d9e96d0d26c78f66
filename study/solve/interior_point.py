"""Settings of the interior-point method of P. Goulart, Y. Chen, Clarabel: an interior-point solver for conic programs
with quadratic objectives, arXiv:2405.12762 (2024).
"""

from __future__ import annotations

from typing import NamedTuple

import clarabel

REFINEMENT = 1e-16
"""Residual of the linear systems inside: out of reach, so that they are refined as far as it helps."""
SOLVED = (clarabel.SolverStatus.Solved, clarabel.SolverStatus.AlmostSolved)


class Accuracy(NamedTuple):
    """When a programme counts as solved: duality gap, absolute or relative, and relative residuals of feasibility."""

    gap: float
    feasibility: float


def settings(aim: Accuracy, enough: Accuracy) -> clarabel.DefaultSettings:
    """What the solver aims at, and what is enough where rounding stops it short of that."""
    found = clarabel.DefaultSettings()
    found.verbose = False
    # Presolve and chordal decomposition would forbid new data for the next step.
    found.presolve_enable = False
    found.chordal_decomposition_enable = False
    found.tol_gap_abs = found.tol_gap_rel = aim.gap
    found.tol_feas = aim.feasibility
    found.reduced_tol_gap_abs = found.reduced_tol_gap_rel = enough.gap
    found.reduced_tol_feas = enough.feasibility
    found.iterative_refinement_abstol = found.iterative_refinement_reltol = REFINEMENT
    return found
