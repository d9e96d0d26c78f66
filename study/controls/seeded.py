"""The plan of a seed: all checks of the study on shaken meshes, measured on the random meshes with this seed.

In a shaken mesh, the vertices are moved at random. Some measurements take most of the time: stresses on a separate
space, rough solutions (which need the levels of the full study), errors computed by the second solver, and cases in 3D.
They are measured on every ``EVERY``-th seed only. So checks differ in the number of seeds by which they were judged.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

from manufactured.case import Case
from study.fem.mesh import MeshFamily, Shaken
from study.fem.naming import family_named
from study.run.plan import Job, Plan, full, quick
from study.statements import STATEMENTS
from study.statements.enclosure import Bounds
from study.statements.initial_gap import InitialGap
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
"""The parts of the plan: all measurements, or only the cheap ones."""
EVERY = 5
"""All measurements are made on every fifth seed, so that cheap and costly ones take about the same time together."""
NOT_CLAIMED = {"(5.24)": "orders of a trace depend on few edges of random length"}
"""Label of a statement about which nothing is claimed on shaken meshes ↦ the reason."""
TRACES = ("no-contact", "advance-recede")
"""Cases whose traces on the contact boundary are interpolated."""


def claimed(label: str) -> bool:
    """Return whether the checks with this label are claimed to hold on shaken meshes."""
    return label not in NOT_CLAIMED


@dataclass(frozen=True)
class SeededScope(Scope):
    """The scope of the quick study with shaken meshes only.

    Attributes:
        seed: the seed of the meshes; the mesh family is called shaken-SEED.
    """

    seed: int = 0

    @property
    def family(self) -> str:
        """The name of the mesh family."""
        return f"{Shaken().name}-{self.seed}"

    def families_of(self, case: Case) -> list[MeshFamily]:
        """Return the shaken mesh family if it can mesh the body, otherwise an empty list."""
        family = family_named(self.family)
        return [family] if family.serves(case.solution.body) else []


def seeded(seed: int, part: str = WHOLE) -> Plan:
    """Return the plan of a seed: the quick study on its meshes, with the levels of the full study for rough cases.

    The plan has no pictures, no error bounds (which are proved for every mesh), no errors of other codes (which were
    run on the meshes of one seed), and no cases that only the full study measures (``SLOW``).

    Parameters:
        seed: the seed.
        part: WHOLE for all measurements, LIGHT for the cheap ones.
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
    """Return whether a job is so costly that it is run only on the seeds with all measurements."""
    solid = isinstance(job.statement, FirstOrder | InitialGap) and job.setting.dim == 3
    return solid or isinstance(job.statement, OwnSpace | Convergence | InterpolationOnContact | Recomputed)


def on_shaken(statement: Statement, scope: SeededScope) -> list[Setting]:
    """Return the settings of a statement on the shaken meshes of a seed.

    Settings of the quick study with shaken meshes are used. If there are none, those of the full study on the levels of
    the quick study are used. Problem 3.2 with a separate stress space has all settings of the full study. The traces of
    (5.24) are measured, although nothing is claimed about them on shaken meshes.
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
