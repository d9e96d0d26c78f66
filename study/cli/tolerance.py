"""The options ``--tolerance`` and ``--absolute``."""

from __future__ import annotations

import argparse
import math

from study.ledger.compare import Tolerance
from study.ledger.errors import UsageError


def tolerance_from(options: argparse.Namespace) -> Tolerance:
    """The tolerance that was asked for; UsageError if one of its numbers is negative or not finite."""
    for name in ("tolerance", "absolute"):
        if not 0 <= getattr(options, name) < math.inf:
            raise UsageError(f"--{name} must be a number, 0 or more, got {getattr(options, name):g}")
    return Tolerance(options.tolerance, options.absolute)
