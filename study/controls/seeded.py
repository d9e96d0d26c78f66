"""The measurements that are made for one seed: all checks of the study on random meshes with this seed.

The meshes are shaken meshes, whose vertices are moved at random.
"""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace

from manufactured.case import Case
from study.fem.mesh import MeshFamily, Shaken
from study.fem.naming import family_named
from study.ledger.verdict import Verdict
from study.run.plan import PLANE_LEVELS, Job, Plan, full, quick
from study.statements import STATEMENTS
from study.statements.enclosure import Bounds
from study.statements.error_estimate import InterpolationOnContact
from study.statements.other_solvers import OtherCodes
from study.statements.pictures import Pictures
from study.statements.shared.base import Setting, Statement
from study.statements.shared.meshes import is_random
from study.statements.shared.scope import Levels, Scope
from study.statements.thm_4_2 import OwnSpace

NOT_SEEDED = Pictures | Bounds | OtherCodes | InterpolationOnContact
"""Statements that are not measured on random meshes. Pictures claim nothing, error bounds are proved for every mesh,
and other codes were run on the meshes of one seed. (5.24) is not claimed there, because orders of a trace depend on few
edges of random length."""


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


def seeded(seed: int) -> Plan:
    """Return the plan of measurements for one seed: the quick study, but for all cases and on random meshes.

    Three more things differ from the quick study. Plane cases have the levels 8, 16 and 32, on which the windows were
    set, or those of the full study if their solutions are not smooth. Cases in 3D have the levels 9, 12 and 15, because
    random meshes with n = 6 are too coarse for contact zones in the form of a disc. The statements ``NOT_SEEDED`` are
    left out.

    Args:
        seed: the seed of the random vertices.
    """
    levels = replace(quick(), plane=PLANE_LEVELS, rough=full().rough, solid=Levels((9, 12, 15)))
    base = replace(levels, cases=full().cases, command="study seeds")
    scope = SeededScope(**vars(base), seed=seed)
    jobs = [
        Job(statement, setting)
        for statement in STATEMENTS
        if not isinstance(statement, NOT_SEEDED)
        for setting in (statement.planned(scope) if statement.of_every_case else on_shaken(statement, scope))
    ]
    return Plan(scope, tuple(jobs))


def on_shaken(statement: Statement, scope: SeededScope) -> list[Setting]:
    """Return the settings (case, mesh family, level) in which a statement is measured on random meshes with one seed.

    They are the settings of the quick study on such meshes. If the quick study has none, they are the settings of the
    full study on such meshes, up to the finest level of the quick study. The stress formulation on its own stress space
    (``OwnSpace``) has all settings of the full study.
    """
    everywhere = [setting for setting in statement.planned(replace(scope, name="full")) if is_random(setting.family)]
    if not isinstance(statement, OwnSpace):
        quickly = statement.planned(scope)
        finest = max((setting.level for setting in quickly), default=0)
        shaken = [setting for setting in quickly if is_random(setting.family)]
        everywhere = shaken or [setting for setting in everywhere if setting.level <= finest]
    return [replace(setting, family=scope.family) for setting in everywhere]


def rules(plan: Plan, verdicts: Sequence[Verdict]) -> str:
    """Return a hash of the rules of judgement: quantities, tolerance windows, cases and levels of all checks.

    It is the same for every seed, so runs with different seeds and one hash were judged by the same rules. The hash
    sees a quantity only by its text: whoever changes how a quantity is computed must change the text, too.

    Args:
        plan: the plan of one seed.
        verdicts: the verdicts of this run.
    """
    checks = []
    for verdict in verdicts:
        quantity = verdict.quantity.removesuffix(f", {verdict.family} meshes")
        checks.append((verdict.label, verdict.key, verdict.case, quantity, verdict.window_low, verdict.window_high))
    settings = [f"{job.statement.label} {replace(job.setting, family='')}" for job in plan.jobs]
    return "r" + hashlib.sha256(repr([sorted(checks), sorted(settings)]).encode()).hexdigest()[:9]
