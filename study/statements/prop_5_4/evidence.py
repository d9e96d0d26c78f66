"""What every error of a rate table has to show: its size is right, it is that of u^h, nothing else matters to it.

Nothing may be exactly nothing but what is so by construction, u^h on Γ1: two numbers of steps, two quadratures or two
ways to a norm differ by rounding at least, and a time share of 0 is that of a trajectory beside itself.
"""

from __future__ import annotations

import numpy as np
import pandas as pd

from study.ledger.criterion import Criterion, Measured
from study.ledger.measures import exactly, greatest, largest
from study.ledger.window import Window, above_nothing, around, at_most
from study.solve.solver_choice import ROUNDING, SHARE, residual

RESIDUAL = above_nothing(1.0, f"{ROUNDING:g} of a factorisation, {SHARE:g} h² of multigrid")
SIZE = around(1, 0.1, "Pythagoras")
PARALLELOGRAM = above_nothing(1e-3, "exact but for rounding and two quadratures of A's factor")


def over(key: str, quantity: str, window: Window, above: str, below: str) -> Criterion:
    """A column over another one on the finest level."""

    def measure(group: pd.DataFrame) -> Measured:
        return exactly(group[above].iloc[-1] / group[below].iloc[-1])

    return Criterion(key, quantity, window, measure, (above, below))


def _size(group: pd.DataFrame) -> Measured:
    """(‖u − u^h‖² + ‖Π^h u − u^h‖²)^{1/2} / ‖u − Π^h u‖ on the finest level."""
    last = group.iloc[-1]
    return exactly(np.hypot(last["error"], last["discrete_error"]) / last["interpolation_error"])


def _residuals(group: pd.DataFrame) -> Measured:
    """Residuals of the contact solves over what the solver of that size is asked for."""
    allowed = [residual(dim, dofs) for dim, dofs in zip(group["dim"], group["dofs"], strict=True)]
    return greatest(group["residual"].to_numpy() / np.array(allowed))


ALLOWED = "residual of the contact solves / allowed"
SIZES = Criterion("size", "size of the error", SIZE, _size, ("error", "discrete_error", "interpolation_error"))
EVIDENCE = (
    largest("parallelogram", "parallelogram law of u − u^h and u − Π^h u", PARALLELOGRAM, "parallelogram"),
    largest("time-share", "time share", above_nothing(0.02, "of the error"), "time_share"),
    Criterion("residual", ALLOWED, RESIDUAL, _residuals, ("dim", "dofs", "residual")),
    largest("clamped", "u^h = 0 on Γ1", at_most(1e-10), "clamped"),
    largest("quadrature", "change under finer quadrature", above_nothing(0.02, "of the error"), "quadrature_change"),
)
