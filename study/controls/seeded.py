"""The plan of a seed: everything that the study judges on shaken meshes, measured on the shaken meshes of this seed.

Some measurements take most of the time: stresses on their own space, rough solutions (which need the levels of the full
study), errors computed by the second solver, and cases in space. They are measured on one of ``EVERY`` seeds, the rest
on every seed. Each row has the number of seeds by which it was judged.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

from manufactured.case import Case
from study.fem.mesh import MeshFamily, Shaken
from study.fem.naming import family_named
from study.run.plan import Job, Plan, full, quick
from study.statements import STATEMENTS
from study.statements.enclosure import Bounds
from study.statements.interpolation import InterpolationOnContact
from study.statements.other_codes import OtherCodes
from study.statements.pictures import Pictures
from study.statements.prop_5_3 import Convergence
from study.statements.prop_5_4 import FirstOrder
from study.statements.recomputed import Recomputed
from study.statements.shared.base import Setting, Statement, grid
from study.statements.shared.meshes import is_random
from study.statements.shared.scope import Scope
from study.statements.thm_4_2_own_space import OwnSpace

WHOLE, LIGHT = "whole", "light"
"""The parts of the plan: all measurements, and the cheap ones."""
EVERY = 5
"""All rows are measured on one seed in so many: then both parts take about the same time."""
NOT_CLAIMED = {"(5.24)": "orders of a trace hang on few edges of random length"}
"""Labels of statements that the ledger does not claim on shaken meshes, with the reason."""
TRACES = ("no-contact", "advance-recede")
"""Cases whose traces are interpolated."""


def claimed(label: str) -> bool:
    """Return whether the ledger claims the rows of a statement on shaken meshes."""
    return label not in NOT_CLAIMED


@dataclass(frozen=True)
class SeededScope(Scope):
    """The quick study, on shaken meshes only.

    Attributes:
        seed: the seed of the meshes, whose family is called shaken-SEED.
    """

    seed: int = 0

    @property
    def family(self) -> str:
        """The name of the mesh family."""
        return f"{Shaken().name}-{self.seed}"

    def families_of(self, case: Case) -> list[MeshFamily]:
        """Return the shaken meshes if the body can have them."""
        family = family_named(self.family)
        return [family] if family.serves(case.solution.body) else []


def seeded(seed: int, part: str = WHOLE) -> Plan:
    """Return the plan of the quick study with a seed; rough cases have the levels of the full study.

    Left out are pictures, bounds (proved for every mesh, and tested with random ones), and errors of other codes, which
    ran on the meshes of one seed.
    """
    base = replace(quick(), rough=full().rough, command="study seeds")
    scope = SeededScope(**{field.name: getattr(base, field.name) for field in fields(base)}, seed=seed)
    jobs = [
        Job(statement, setting)
        for statement in STATEMENTS
        if not isinstance(statement, Pictures | Bounds | OtherCodes)
        for setting in (statement.planned(scope) if statement.of_every_case else on_shaken(statement, scope))
    ]
    return Plan(scope, tuple(job for job in jobs if part == WHOLE or not costly(job)))


def costly(job: Job) -> bool:
    """Return whether a job belongs only to the seeds on which all rows are measured."""
    solid = isinstance(job.statement, FirstOrder) and job.setting.dim == 3
    return solid or isinstance(job.statement, OwnSpace | Convergence | InterpolationOnContact | Recomputed)


def on_shaken(statement: Statement, scope: SeededScope) -> list[Setting]:
    """Return the settings of the quick study on shaken meshes, or of the full study on the levels of the quick one.

    The traces of (5.24) are measured although nothing is claimed about them on shaken meshes.
    """
    if isinstance(statement, InterpolationOnContact):
        return grid(TRACES, (scope.family,), (16, 32, 64))
    everywhere = [setting for setting in statement.planned(replace(scope, name="full")) if is_random(setting.family)]
    if not isinstance(statement, OwnSpace):
        quickly = statement.planned(scope)
        finest = max((setting.level for setting in quickly), default=0)
        shaken = [setting for setting in quickly if is_random(setting.family)]
        everywhere = shaken or [setting for setting in everywhere if setting.level <= finest]
    return [replace(setting, family=scope.family) for setting in everywhere]
