"""Where the contact force is measured: every case of Prop. 5.4 that touches, on all its mesh families."""

from __future__ import annotations

from typing import Any

from study.fem.naming import resolve
from study.ledger.datafiles import CsvFile
from study.ledger.measures import ENOUGH
from study.solve.steps import stress_steps
from study.solve.tableau import MIDPOINT
from study.statements.contact_force.measure import COLUMNS, measure_contact
from study.statements.prop_5_4.experiment import Experiment
from study.statements.shared import estimates
from study.statements.shared.base import EVOLVING, Setting, Statement
from study.statements.shared.scope import Scope

CONTACT = CsvFile("contact.csv", ("case", "family", "level"), COLUMNS)
UNTOUCHED = "no-contact"
"""The case without any pressure."""


class PressureSweep(Statement):
    """The midpoint rule with k ~ h, on the three finest levels that the study has on all families of a case."""

    file = CONTACT

    def settings(self, scope: Scope) -> list[Setting]:
        """Cases of Prop. 5.4 that touch, on the three finest levels that the study has on all of their families."""
        cases = [case for case in scope.resolved() if case.proposition == "Prop. 5.4" and case.name != UNTOUCHED]
        return [
            Setting(case.name, family.name, level)
            for case in cases
            if scope.full or case.name in EVOLVING
            for family in scope.families_of(case)
            for level in scope.levels_of(case).all[-ENOUGH:]
        ]

    def measure(self, setting: Setting) -> dict[str, Any]:
        setup = Experiment.at(setting, MIDPOINT, self.steps(setting))
        return {"case": setting.case, "family": setting.family, "level": setting.level, **measure_contact(setup)}

    def cost(self, setting: Setting) -> float:
        cells = setting.level**setting.dim * estimates.cells(setting.family)
        return float(cells * self.steps(setting)) * (5 if setting.dim == 2 else 120)

    def memory(self, setting: Setting) -> float:
        return estimates.displacement(setting.dim, setting.level, setting.family)

    def steps(self, setting: Setting) -> int:
        """An even number, k ~ h."""
        case = resolve(setting.case)
        return stress_steps(case.solution.body.T, setting.level, case.pace)
