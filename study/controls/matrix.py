"""The matrix fault × case × check: which checks notice a deliberate fault, and in which cases.

For each fault (``study.controls.faults``), size and case three things are measured:

* S = max_t ‖u^h − u^h_δ‖_V on the finest level, the distance of the right from the faulty discrete solution. If the
  faulty problem is well posed, the errors of the faulty program stagnate at about S. So the fault is *invisible* to
  orders in a case where S is 0, and it is noticed on a level as soon as S exceeds a known part of the error.
* The checks of the order and of the size of the error that fail (Propositions 5.3 and 5.4, initial gap).
* The other checks that fail: contact forces, the comparison with Problem 3.2 (Theorem 4.2), and the evidence that the
  computation is accurate.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from study.controls.faults import FAULTS, Fault
from study.fem.naming import is_own, resolve
from study.ledger.files import UsageError
from study.ledger.verdict import FAILS, CheckKind, Verdict
from study.run.plan import COVER, PLANE_LEVELS, quick
from study.solve.evolution import furthest
from study.statements.contact_force import ContactForce, touches
from study.statements.prop_5_4 import (
    Convergence,
    FirstOrder,
    InitialGap,
    Rates,
    RateSetting,
    SizeOfInterpolation,
    measure,
)
from study.statements.shared.base import Experiment, Numbers, Setting, Statement
from study.statements.shared.scope import regular
from study.statements.thm_4_2 import SameMesh

OF_RATES: dict[str, tuple[Statement, ...]] = {
    statement.proposition: (statement, SizeOfInterpolation())
    for statement in (FirstOrder(), Convergence(), InitialGap())
}
"""Label of a proposition ↦ the statements that are judged by its rows in ``rates.csv``."""
BY_ORDER_OR_SIZE = (CheckKind.CLAIM, CheckKind.CONSEQUENCE)
"""The kinds of the checks of errors that count as noticing a fault; the others show that a computation is accurate."""


@dataclass(frozen=True)
class Measured:
    """A statement that is measured on a case without a fault, on the meshes of one family.

    Attributes:
        statement: the statement.
        settings: the settings, coarse to fine.
    """

    statement: Statement
    settings: tuple[Any, ...]

    @cached_property
    def setups(self) -> list[Experiment]:
        """The experiments of the settings."""
        return [self.statement.setup(setting) for setting in self.settings]

    @cached_property
    def right(self) -> list[Mapping[str, Any]]:
        """The measured numbers without a fault."""
        return [self.statement.measure(setup) for setup in self.setups]

    def failing(self, fault: Fault | None = None, size: float = 0.0) -> list[Verdict]:
        """Return the checks that fail with a fault of a size; by default, those that fail without a fault.

        The list is empty if the fault cannot occur in one of the settings.
        """
        measured = []
        for setup, right in zip(self.setups, self.right, strict=True):
            faulty = fault.change(setup, size) if fault else setup
            if faulty is None:
                return []
            measured.append({**right, **self._again(faulty)} if fault else right)
        return [verdict for verdict in self._judged(measured) if verdict.verdict == FAILS]

    @cached_property
    def missed(self) -> set[str]:
        """The keys of the checks that fail without a fault: a user's case may miss predictions of this study."""
        return {verdict.key for verdict in self.failing()}

    def _again(self, faulty: Experiment) -> Mapping[str, Any]:
        """Return the numbers that a fault can change."""
        if not isinstance(self.statement, Rates):
            return self.statement.measure(faulty)
        measurement = measure(faulty)
        return {**measurement.errors(), "residual": measurement.residual, "clamped": measurement.clamped()}

    def _judged(self, measured: Sequence[Mapping[str, Any]]) -> list[Verdict]:
        case = resolve(self.settings[0].case)
        pairs = zip(self.settings, measured, strict=True)
        rows = [row for setting, numbers in pairs for _, row in self.statement.records(setting, numbers)]
        table = pd.DataFrame(rows).assign(expected_order=case.order)
        judges = OF_RATES[case.proposition] if isinstance(self.statement, Rates) else (self.statement,)
        return [verdict for judge in judges for verdict in judge.judge(table)]


def measured_on(name: str) -> list[Measured]:
    """Return the statements whose checks may notice a fault in a case, in the settings of the quick study.

    Plane cases that the quick study does not measure have the levels 8, 16 and 32.

    The first one is about the error. The contact force and Theorem 4.2 follow if they can be measured in the case.
    Theorem 4.2 compares two discrete problems and says nothing about the exact solution, so it is left out for a user's
    case.
    """
    case = resolve(name)
    scope = quick() if name in COVER else replace(quick(), plane=PLANE_LEVELS)
    family = regular(case).name
    levels = scope.levels_of(case).all
    rates, _ = OF_RATES[case.proposition]
    steps = [RateSetting(name, family, n, scope.scheme, scope.steps(case, n)) for n in levels]
    statements = [Measured(rates, tuple(steps))]
    if case.proposition == "Prop. 5.4" and touches(case.solution):
        statements.append(Measured(ContactForce(), tuple(Setting(name, family, n) for n in levels)))
    if not (case.solution.has_initial_gap or is_own(name)):
        coarsest = scope.equivalence[0] if case.solution.body.dim == 2 else scope.solid_equivalence[0]
        statements.append(Measured(SameMesh(), (Setting(name, family, coarsest),)))
    return statements


def measure_case(name: str, faults: Collection[str]) -> list[Numbers]:
    """Return the rows of the matrix fault × case × check for one case, as rows of ``faults.csv``.

    There is one row for each fault and each of its sizes; in 3D only for the first, largest size, to save time. A row
    has the distance of the faulty solution and the checks that notice the fault (``row_of``).

    Args:
        name: the case.
        faults: the names of the faults.

    Raises:
        UsageError: a check of the errors fails without a fault, so that nothing follows from its failing with one.
    """
    case = resolve(name)
    with threadpool_limits(1), np.errstate(all="ignore"):
        rates, *others = measured_on(name)
        wrong = rates.missed.union(*(one.missed for one in others if not is_own(name)))
        if wrong:
            keys = ", ".join(sorted(wrong))
            raise UsageError(f"{name}: without a fault these checks fail: {keys}; `study run --case {name}` shows them")
        rows = []
        for fault in (fault for fault in FAULTS if fault.name in faults):
            for size in fault.sizes if case.solution.body.dim == 2 else fault.sizes[:1]:
                rows.append(row_of(rates, others, fault, size))
    return [row for row in rows if row]


def row_of(rates: Measured, others: Sequence[Measured], fault: Fault, size: float) -> Numbers | None:
    """Return the row of the matrix for one fault, size and case; None if the fault cannot occur in this case.

    Args:
        rates: the measurements of the error in this case, on the meshes from coarse to fine.
        others: the measurements of the other statements in this case.
        fault: the fault.
        size: its size δ.

    Returns:
        The row of ``faults.csv``, by the names of its columns.
    """
    case = resolve(rates.settings[0].case)
    right = rates.setups[-1]
    faulty = fault.change(right, size)
    if faulty is None:
        return None
    row = {
        "equation": fault.equation,
        "fault": fault.name,
        "size": size,
        "single": int(fault.single),
        "case": case.name,
        "dim": case.solution.body.dim,
        "error": rates.right[-1]["error"],
    }
    try:
        row["distance"] = distance_of_solutions(right, faulty)
        failing = rates.failing(fault, size)
        of_others = [one for each in others for one in each.failing(fault, size) if one.key not in each.missed]
    except (ArithmeticError, np.linalg.LinAlgError, RuntimeError) as error:
        return {**row, "distance": math.inf, "by_error": "", "by_others": f"stopped by {type(error).__name__}"}
    by_error = [verdict.key for verdict in failing if verdict.kind in BY_ORDER_OR_SIZE]
    others_failing = [*(verdict for verdict in failing if verdict.kind not in BY_ORDER_OR_SIZE), *of_others]
    if is_own(rates.settings[0].case):
        # The other checks do not compare with the exact solution, and notice most faults in every case.
        others_failing = [verdict for verdict in others_failing if verdict.kind in BY_ORDER_OR_SIZE]
    by_others = [f"{verdict.label} {verdict.key}" for verdict in others_failing]
    return {**row, "by_error": "; ".join(by_error), "by_others": "; ".join(by_others)}


def distance_of_solutions(right: Experiment, faulty: Experiment) -> float:
    """Return max_t ‖u^h − u^h_δ‖_V, the distance of the right from the faulty discrete solution.

    If the faulty space has other unknowns, it is NaN.
    """
    if right.space is not faulty.space:
        return math.nan
    one, other = (np.array([state.u for state in setup.march(setup.steps)]) for setup in (right, faulty))
    return furthest(right.problem, one, other)
