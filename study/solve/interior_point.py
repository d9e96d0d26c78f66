"""Settings of the interior-point solver Clarabel.

Source: P. Goulart, Y. Chen, Clarabel: an interior-point solver for conic programs with quadratic objectives,
arXiv:2405.12762 (2024).
"""

from typing import NamedTuple

import clarabel

REFINEMENT = 1e-16
"""Tolerance of the linear systems in the solver.

It cannot be reached, so the systems are refined until rounding prevents further progress.
"""
SOLVED = (clarabel.SolverStatus.Solved, clarabel.SolverStatus.AlmostSolved)


class Accuracy(NamedTuple):
    """Tolerances of the solver.

    Attributes:
        gap: the tolerance for the duality gap, absolute or relative.
        feasibility: the tolerance for the residuals of the constraints.
    """

    gap: float
    feasibility: float


def settings(aim: Accuracy, enough: Accuracy) -> clarabel.DefaultSettings:
    """Return the settings with which the solver stops at a given accuracy.

    Args:
        aim: the accuracy at which the solver stops.
        enough: the accuracy that is accepted if rounding stops the solver before ``aim``.
    """
    found = clarabel.DefaultSettings()
    found.verbose = False
    # Presolve and chordal decomposition are switched off, because the solver could not take new data for the next time
    # step.
    found.presolve_enable = False
    found.chordal_decomposition_enable = False
    found.tol_gap_abs = found.tol_gap_rel = aim.gap
    found.tol_feas = aim.feasibility
    found.reduced_tol_gap_abs = found.reduced_tol_gap_rel = enough.gap
    found.reduced_tol_feas = enough.feasibility
    found.iterative_refinement_abstol = found.iterative_refinement_reltol = REFINEMENT
    return found
