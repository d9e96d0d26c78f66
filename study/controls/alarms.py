"""The verdicts on other random meshes: none may hang on the one seed that the study shakes its meshes with.

For every seed, all that the quick study judges is measured on meshes shaken with that seed, of every case that such
meshes serve, and judged as the ledger is. A row of the ledger that does not hold raises an alarm. What the ledger does
not claim on shaken meshes, because it alarms too often there, is measured and counted as well.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path

import pandas as pd
from tabulate import tabulate

from manufactured.case import Case
from study.fem.mesh import MeshFamily, Shaken
from study.fem.naming import family_named
from study.ledger.datafiles import write_csv
from study.ledger.verdict import HOLDS, REPORTED, Verdict
from study.run.job import Job
from study.run.plan import Plan, full, quick
from study.statements import STATEMENTS
from study.statements.enclosure.courses import Bounds
from study.statements.interpolation import InterpolationOnContact
from study.statements.pictures import Pictures
from study.statements.shared.base import Setting, Statement, grid
from study.statements.shared.scope import Scope
from study.statements.thm_4_2.own_space import OwnSpace

SEEDS = 20
NOT_CLAIMED = {
    ("(5.24)", ""): "orders of a trace hang on few edges of random length",
    ("Thm 4.2, own space", "natural-front"): "the pressure's error is that of the one cell in which the front rests",
    ("Thm 4.2, own space", "rough-trace"): "the same, and an order of the multipliers that is not understood",
}
"""Label and case, or every case, of what the ledger does not claim on shaken meshes, and why."""
TRACES = ("no-contact", "advance-recede")
"""Cases whose traces are interpolated."""


@dataclass(frozen=True)
class SeededScope(Scope):
    """The quick study on shaken meshes alone.

    Attributes:
        seed: of the meshes, which are called shaken-SEED.
    """

    seed: int = 0

    @property
    def family(self) -> str:
        """The name of the meshes."""
        return f"{Shaken().name}-{self.seed}"

    def families_of(self, case: Case) -> list[MeshFamily]:
        """The shaken meshes, where they serve."""
        family = family_named(self.family)
        return [family] if family.serves(case.solution.body) else []


def seeded(seed: int) -> Plan:
    """The quick study with a seed, but for rough cases, which need the levels of the full one on random meshes.

    No pictures, and no bounds: these are proved for every mesh, and tested with random ones.
    """
    base = replace(quick(), rough=full().rough, command="study seeds")
    scope = SeededScope(**{field.name: getattr(base, field.name) for field in fields(base)}, seed=seed)
    jobs = [
        Job(statement, setting)
        for statement in STATEMENTS
        if not isinstance(statement, Pictures | Bounds)
        for setting in (statement.settings(scope) if statement.of_every_case else on_shaken(statement, scope))
    ]
    return Plan(scope, tuple(jobs))


def on_shaken(statement: Statement, scope: SeededScope) -> list[Setting]:
    """The settings of the quick study on shaken meshes; where it has none those of the full one, up to its levels.

    Where nothing is claimed on shaken meshes it is measured nevertheless: the traces of (5.24), and stresses on their
    own space at all levels of the full study, of every case that it has on shaken meshes or does not claim there.
    """
    if isinstance(statement, InterpolationOnContact):
        return grid(TRACES, (scope.family,), (16, 32, 64))
    everywhere = [setting for setting in statement.settings(replace(scope, name="full")) if is_shaken(setting)]
    if isinstance(statement, OwnSpace):
        unclaimed = [case for label, case in NOT_CLAIMED if label == statement.label]
        levels = sorted({setting.level for setting in everywhere})
        everywhere += grid(unclaimed, (scope.family,), levels)
    else:
        quickly = statement.settings(scope)
        finest = max((setting.level for setting in quickly), default=0)
        shaken = [setting for setting in quickly if is_shaken(setting)]
        everywhere = shaken or [setting for setting in everywhere if setting.level <= finest]
    return [replace(setting, family=scope.family) for setting in everywhere]


def is_shaken(setting: Setting) -> bool:
    """Whether a setting has the shaken meshes of the study."""
    return setting.family == Shaken().name


def tally(found: Mapping[int, Sequence[Verdict]]) -> pd.DataFrame:
    """One line for each row of the ledger that is judged: on how many seeds it was and on how many it did not hold.

    Columns label, key, case, quantity, expected, seeds, alarms, lowest and highest observed value, claimed.
    """
    rows = pd.DataFrame(
        {
            "label": verdict.label,
            "key": verdict.key,
            "case": verdict.case,
            # One row is wanted for all seeds: their meshes have names of their own.
            "quantity": verdict.quantity.removesuffix(f", {verdict.family} meshes"),
            "expected": verdict.expected,
            "observed": verdict.observed,
            "alarm": verdict.verdict != HOLDS,
        }
        for verdicts in found.values()
        for verdict in verdicts
        if verdict.verdict != REPORTED
    )
    groups = rows.groupby(["label", "key", "case", "quantity", "expected"], sort=False)
    table = groups.agg(
        seeds=("alarm", "size"), alarms=("alarm", "sum"), lowest=("observed", "min"), highest=("observed", "max")
    ).reset_index()
    claims = ["no" if _not_claimed(row.label, row.case) else "yes" for row in table.itertuples()]
    return table.assign(claimed=claims)


def _not_claimed(label: str, case: str) -> bool:
    return (label, case) in NOT_CLAIMED or (label, "") in NOT_CLAIMED


def text(table: pd.DataFrame) -> str:
    """What was judged, and every alarm."""
    claimed = table[table["claimed"] == "yes"]
    lines = [
        (label, part["case"].nunique(), len(part), int(part["seeds"].sum()), int(part["alarms"].sum()))
        for label, part in claimed.groupby("label", sort=False)
    ]
    alarms = [
        (row.label, row.case, row.quantity, f"{row.alarms} of {row.seeds}", row.claimed)
        for row in table[table["alarms"] > 0].itertuples()
    ]
    return "\n".join(
        [
            tabulate(lines, ["statement", "cases", "rows", "judged", "alarms"], "simple"),
            "",
            tabulate(
                alarms, ["alarm", "case", "quantity", "seeds", "claimed"], "simple", maxcolwidths=[18, 18, 48, 9, 7]
            ),
            "",
            f"{len(claimed)} claimed rows, {claimed['seeds'].sum()} verdicts: {claimed['alarms'].sum()} alarms",
        ]
    )


def write_seeds(directory: Path, table: pd.DataFrame) -> Path:
    """``data/seeds.csv``."""
    path = directory / "data" / "seeds.csv"
    write_csv(path, table)
    return path
