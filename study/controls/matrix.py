"""The matrix fault × case × check: in which cases the errors of Propositions 5.3 and 5.4 notice a deliberate fault.

For each fault (``study.controls.faults``) two numbers are measured:

* S = max_t ‖u^h − u^h_δ‖_V on the finest level, the distance of the right from the faulty discrete solution. The errors
  of the faulty program stagnate at about S, so the fault is *invisible* in a case if S is 0, and it is noticed on a
  level as soon as S exceeds a known part of the error.
* the checks of the propositions that fail. A fault is *noticed* in a case if a check of the order or of the size of the
  error fails.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from study.controls.faults import FAULTS, Fault
from study.fem.naming import family_named, resolve
from study.ledger.verdict import FAILS
from study.run.plan import quick
from study.solve.steps import rate_steps
from study.solve.tableau import MIDPOINT
from study.statements.from_rates import SizeOfInterpolation
from study.statements.initial_gap import InitialGap
from study.statements.prop_5_3 import Convergence
from study.statements.prop_5_4 import FirstOrder, measure
from study.statements.shared.experiment import Experiment
from study.statements.shared.scope import regular

OF_RATES = FirstOrder(), Convergence(), SizeOfInterpolation(), InitialGap()
"""The statements that are judged by the errors of displacements."""
EVIDENCE = {"residual", "clamped", "parallelogram", "quadrature", "time-share"}
"""Checks that the computation is accurate. They do not count as noticing a fault of an equation."""
COLUMNS = ["equation", "fault", "size", "case", "distance", "error", "noticed_by", "evidence"]


@dataclass(frozen=True)
class Sweep:
    """One case on the levels of the quick study, measured without a fault.

    Attributes:
        case: name of the case.
        setups: the experiments, coarse to fine; their loads are cached.
        rows: the rows of ``rates.csv`` without a fault.
    """

    case: str
    setups: tuple[Experiment, ...]
    rows: tuple[dict[str, Any], ...]

    @classmethod
    def of(cls, name: str, levels: tuple[int, ...]) -> Sweep:
        case = resolve(name)
        family = regular(case)
        setups = []
        for level in levels:
            steps = rate_steps(case.solution.body.T, level, case.pace)
            setups.append(cached(Experiment.of(case.solution, family_named(family.name), level, MIDPOINT, steps)))
        measured = zip(setups, levels, strict=True)
        rows = tuple(measure(setup).row(case.name, family.name, level) for setup, level in measured)
        return cls(name, tuple(setups), rows)

    def failing(self, rows: list[dict[str, Any]]) -> list[str]:
        """Return the keys of the checks that fail for some rows of ``rates.csv``."""
        case = resolve(self.case)
        table = pd.DataFrame(rows).assign(claim=case.proposition, expected_order=case.order)
        verdicts = [verdict for statement in OF_RATES for verdict in statement.judge(table)]
        return sorted({verdict.key for verdict in verdicts if verdict.verdict == FAILS})

    def noticed(self, fault: Fault, size: float) -> dict[str, Any] | None:
        """Return the row of the matrix for a fault of one size; None if the fault cannot occur in this case."""
        rows = []
        for setup, right in zip(self.setups, self.rows, strict=True):
            faulty = fault.change(setup, size)
            if faulty is None:
                return None
            try:
                with np.errstate(all="ignore"):
                    rows.append({**right, **errors(faulty)})
            except (ArithmeticError, np.linalg.LinAlgError, RuntimeError) as error:
                return self._row(fault, size, math.inf, [type(error).__name__])
        distance = distance_of_solutions(self.setups[-1], faulty)
        return self._row(fault, size, distance, self.failing(rows))

    def _row(self, fault: Fault, size: float, distance: float, failing: list[str]) -> dict[str, Any]:
        noticed = [key for key in failing if key not in EVIDENCE]
        evidence = [key for key in failing if key in EVIDENCE]
        return {
            "equation": fault.equation,
            "fault": fault.name,
            "size": size,
            "case": self.case,
            "distance": distance,
            "error": self.rows[-1]["error"],
            "noticed_by": " ".join(noticed),
            "evidence": " ".join(evidence),
        }


def cached(setup: Experiment) -> Experiment:
    """Return an experiment whose loads and exact values are computed once for each time."""
    v_norm = setup.v_norm
    v_norm.sample = lru_cache(maxsize=None)(v_norm.sample)  # type: ignore[method-assign]
    return replace(setup, problem=replace(setup.problem, load=lru_cache(maxsize=None)(setup.problem.load)))


def errors(setup: Experiment) -> dict[str, float]:
    """Return the columns of ``rates.csv`` that a fault can change."""
    found = measure(setup)
    return {**found.errors(), "residual": found.residual, "clamped": found.clamped()}


def distance_of_solutions(right: Experiment, faulty: Experiment) -> float:
    """Return max_t ‖u^h − u^h_δ‖_V, the distance of the right from the faulty discrete solution.

    If the faulty space has other unknowns, it is NaN.
    """
    if right.space is not faulty.space:
        return math.nan
    largest = 0.0
    for one, other in zip(right.march(right.steps), faulty.march(faulty.steps), strict=True):
        difference = one.u - other.u
        largest = max(largest, float(difference @ (right.problem.M @ difference)))
    return math.sqrt(largest)


def levels_of(name: str) -> tuple[int, ...]:
    """Return the levels of a case in the quick study."""
    return quick().levels_of(resolve(name)).all


def rows_of(name: str, faults: tuple[Fault, ...] = FAULTS) -> Iterator[dict[str, Any]]:
    """Yield the rows of the matrix for one case."""
    with threadpool_limits(1):
        sweep = Sweep.of(name, levels_of(name))
        if failing := sweep.failing(list(sweep.rows)):
            raise ValueError(f"{name}: without a fault the checks {', '.join(failing)} fail")
        for fault in faults:
            for size in fault.sizes:
                row = sweep.noticed(fault, size)
                if row is not None:
                    yield row
