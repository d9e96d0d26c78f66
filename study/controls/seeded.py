"""The measurements that are made for one seed: all checks of the study on random meshes with this seed.

The meshes are shaken meshes, whose vertices are moved at random. Some measurements take most of the time: the stress
formulation on its own stress space, solutions that are not smooth (which need more levels), errors computed by a second
solver, and cases in 3D. They are made only for every ``EVERY``-th seed. So some checks were judged on fewer seeds than
others.
"""

from dataclasses import dataclass, replace

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
"""Names of the two parts of the measurements for a seed: all of them, or only the cheap ones."""
EVERY = 5
"""Costly measurements are made on every fifth seed only, so that they take about as long as the cheap ones in total."""
NOT_CLAIMED = {"(5.24)": "orders of a trace depend on few edges of random length"}
"""Label of a statement that is not claimed to hold on meshes with random vertices ↦ the reason."""
TRACES = ("no-contact", "advance-recede")
"""Cases whose displacements on the contact boundary are interpolated."""


def claimed(label: str) -> bool:
    """Return whether the study claims that the checks with this label hold on meshes with random vertices."""
    return label not in NOT_CLAIMED


@dataclass(frozen=True)
class SeededScope(Scope):
    """The scope of the quick study with meshes whose vertices are random.

    Attributes:
        seed: the seed of the random vertices. The mesh family is called shaken-SEED.
    """

    seed: int = 0

    @property
    def family(self) -> str:
        """The name of the mesh family, which contains the seed."""
        return f"{Shaken().name}-{self.seed}"

    def families_of(self, case: Case) -> list[MeshFamily]:
        """Return the family of random meshes if it can mesh the body of the case, otherwise an empty list."""
        family = family_named(self.family)
        return [family] if family.serves(case.solution.body) else []


def seeded(seed: int, part: str = WHOLE) -> Plan:
    """Return the plan of measurements for one seed: the quick study on random meshes with this seed.

    Cases whose solutions are not smooth are measured on the levels of the full study. The plan leaves out pictures,
    error bounds (which are proved for every mesh), errors of other codes (which were run on the meshes of one seed),
    and the cases in ``SLOW``, which only the full study measures.

    Parameters:
        seed: the seed.
        part: WHOLE for all measurements, LIGHT for the cheap ones.
    """
    base = replace(quick(), rough=full().rough, command="study seeds")
    scope = SeededScope(**vars(base), seed=seed)
    jobs = [
        Job(statement, setting)
        for statement in STATEMENTS
        if not isinstance(statement, Pictures | Bounds | OtherCodes)
        for setting in (statement.planned(scope) if statement.of_every_case else on_shaken(statement, scope))
    ]
    return Plan(scope, tuple(job for job in jobs if part == WHOLE or not costly(job)))


def costly(job: Job) -> bool:
    """Return whether a job is so costly that it is run only for every ``EVERY``-th seed."""
    solid = isinstance(job.statement, FirstOrder | InitialGap) and job.setting.dim == 3
    return solid or isinstance(job.statement, OwnSpace | Convergence | InterpolationOnContact | Recomputed)


def on_shaken(statement: Statement, scope: SeededScope) -> list[Setting]:
    """Return the settings (case, mesh family, level) in which a statement is measured on random meshes with one seed.

    They are the settings of the quick study on such meshes. If the quick study has none, they are the settings of the
    full study on such meshes, up to the finest level of the quick study. The stress formulation on its own stress space
    (``OwnSpace``) has all settings of the full study. The interpolation of displacements on the contact boundary is
    measured, too, although nothing is claimed about it on random meshes.
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
