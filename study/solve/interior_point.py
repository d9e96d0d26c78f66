"""Settings of the interior-point solver Clarabel.

Source: P. Goulart, Y. Chen, Clarabel: an interior-point solver for conic programs with quadratic objectives,
arXiv:2405.12762 (2024).
"""

from __future__ import annotations

from typing import NamedTuple

import clarabel

REFINEMENT = 1e-16
"""Unreachable tolerance of linear systems in the solver, so that they are refined as far as rounding permits."""
SOLVED = (clarabel.SolverStatus.Solved, clarabel.SolverStatus.AlmostSolved)


class Accuracy(NamedTuple):
    """Tolerances of a programme: the duality gap, absolute or relative, and the relative residuals of feasibility."""

    gap: float
    feasibility: float


def settings(aim: Accuracy, enough: Accuracy) -> clarabel.DefaultSettings:
    """Return settings with a tolerance to aim at, and one that is accepted if rounding stops the solver before it."""
    found = clarabel.DefaultSettings()
    found.verbose = False
    # Presolve and chordal decomposition would not permit new data for the next step.
    found.presolve_enable = False
    found.chordal_decomposition_enable = False
    found.tol_gap_abs = found.tol_gap_rel = aim.gap
    found.tol_feas = aim.feasibility
    found.reduced_tol_gap_abs = found.reduced_tol_gap_rel = enough.gap
    found.reduced_tol_feas = enough.feasibility
    found.iterative_refinement_abstol = found.iterative_refinement_reltol = REFINEMENT
    return found
