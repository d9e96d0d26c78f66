"""Measures how strongly a user's own case tests contact: which checks notice two deliberate defects of contact.

If the contact pressure is small, or the contact zone is only a few cells wide, a wrong contact algorithm hardly changes
the error, and all checks hold in spite of it. So the measurements of the run are repeated with each defect on one mesh
family. A check notices a defect if it holds without the defect and does not hold with it.

Only checks that compare with the exact solution count. Some checks only test the program: the residual of the contact
problems, and the penetration of the foundation between vertices. They fail with these defects for every case.
"""

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from study.controls.faults import FAULTS, Fault
from study.fem.naming import is_own, resolve
from study.ledger.datafiles import Row, write_csv
from study.ledger.verdict import HOLDS
from study.run.fingerprint import code_hash
from study.run.judgement import stored_tables
from study.run.plan import Job, Plan
from study.run.store import Store
from study.statements.contact_force import EXACT, ContactForce, touches
from study.statements.own_cases import judge_own, least_levels
from study.statements.prop_5_4 import EVIDENCE, RATES, Rates
from study.statements.shared.scope import regular

CHOSEN = {"every second vertex of Γ3 free": 1.0, "contact forces scaled": 0.1}
"""Name of a fault ↦ its size."""
DEFECTS: dict[str, Fault] = {fault.name: fault for fault in FAULTS if fault.name in CHOSEN}
"""The faults by their names."""
OF_THE_PROGRAM = {check.key for check in (*EVIDENCE, *EXACT)}
"""Keys of checks that test the program only, because they do not compare with the exact solution."""
CODE = "study/controls/contact_test.py", "study/controls/faults.py"


@dataclass(frozen=True)
class DefectiveJob(Job):
    """A measurement that is made with a wrong contact solver.

    Attributes:
        defect: name of the defect in ``DEFECTS``.
    """

    defect: str = ""

    @property
    def key(self) -> str:
        """The name of the file in which the result of this measurement is stored, without the ending of the name."""
        return f"contact-test__{self.defect.replace(' ', '-')}__{super().key}"

    def fingerprint(self) -> str:
        """Return the cache key of the result; it also depends on the code that makes the defects."""
        return hashlib.sha256(f"{super().fingerprint()} {code_hash(CODE)}".encode()).hexdigest()[:16]

    def run(self) -> Mapping[str, Any]:
        """Measure with the wrong contact solver; return the measured numbers by their names."""
        faulty = DEFECTS[self.defect].change(self.statement.setup(self.setting), CHOSEN[self.defect])
        return self.statement.measure(faulty)


def defective(jobs: Sequence[Job], defect: str) -> list[DefectiveJob]:
    """Return the same measurements, to be made with the named defect."""
    return [DefectiveJob(job.statement, job.setting, defect) for job in jobs]


def rows_of(jobs: Sequence[Job], store: Store) -> Iterator[Row]:
    """Yield the rows of ``contact-test.csv`` for one case, a row for each defect.

    Parameters:
        jobs: the measurements of the case that were repeated with each defect, as ``contact_tests`` returns them.
        store: has the results of all measurements.
    """
    sound, setting = holding(jobs, store), jobs[0].setting
    levels = sorted({job.setting.level for job in jobs})
    for defect in DEFECTS:
        noticed = sorted(sound - holding(defective(jobs, defect), store))
        yield {
            "case": resolve(setting.case).name,
            "family": setting.family,
            "levels": " ".join(map(str, levels)),
            "defect": defect,
            "what": defect,
            "holding": len(sound),
            "noticed": len(noticed),
            "noticed_by": "; ".join(noticed),
        }


def holding(jobs: Sequence[Job], store: Store) -> set[str]:
    """Judge the stored results of jobs on one case; return the checks that hold and compare with the exact solution.

    A check is named "LABEL, KEY", after the label of its statement and its key.
    """
    tables = stored_tables(jobs, store)
    statements = dict.fromkeys(job.statement for job in jobs)
    judged = [verdict for statement in statements for verdict in statement.judge(tables[statement.file])]
    of_case = [v for v in judge_own(judged, tables[RATES]) if v.key not in OF_THE_PROGRAM]
    return {f"{verdict.label}, {verdict.key}" for verdict in of_case if verdict.verdict == HOLDS}


def contact_tests(plan: Plan) -> list[list[Job]]:
    """Return one list of measurements for each user's case in a plan, if contact occurs in its exact solution.

    These measurements show how well the case detects contact errors; they are repeated with each defect. They are the
    measurements of the case on the finest levels of one mesh family that is not random. The number of levels is the
    smallest that suffices for a verdict on an observed order.
    """
    tests = []
    for reference in plan.scope.cases:
        case = resolve(reference)
        if is_own(reference) and touches(case.solution):
            place = (reference, regular(case).name)
            finest = plan.scope.levels_of(case).all[-least_levels(case.proposition) :]
            of_contact = [job for job in plan.jobs if isinstance(job.statement, Rates | ContactForce)]
            settings = [(job, job.setting) for job in of_contact]
            tests.append([job for job, at in settings if (at.case, at.family) == place and at.level in finest])
    return tests


def write_contact_test(tests: Sequence[Sequence[Job]], store: Store) -> list[Path]:
    """Write ``contact-test.csv`` from stored results; return its path in a list, which is empty without tests."""
    if not tests:
        return []
    return [
        write_csv(
            store.data / "contact-test.csv", pd.DataFrame([row for jobs in tests for row in rows_of(jobs, store)])
        )
    ]
