"""Finds the smallest defects that make a check fail: the command ``study sensitivity``.

One datum of the contact problem, such as the load or a modulus, is changed by a relative amount δ. Bisection on a
logarithmic scale finds the smallest δ at which a check fails.

Only the checks of ``study.statements.recomputed`` are used. They compare the displacements that the study computes with
the displacements that a second solver computes. The distance of the two is proportional to δ. Errors, in contrast,
change in proportion to δ², so observed orders hardly show a small defect. Other checks may notice still smaller
defects. A coarse mesh suffices.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor, as_completed
from dataclasses import replace
from functools import cache

import numpy as np
import pandas as pd
from tabulate import tabulate
from threadpoolctl import threadpool_limits

from study.controls.baselines import experiment
from study.controls.small_defects import DEFECTS, START, SmallDefect
from study.fem.naming import resolve
from study.ledger.datafiles import Row
from study.ledger.verdict import FAILS
from study.statements.recomputed import TRAJECTORIES, Recomputed, gaps
from study.statements.recomputed_solver import PlainProblem
from study.statements.shared.base import Setting, grid
from study.statements.shared.experiment import Experiment

LEAST, MOST = 1e-12, 1.0
"""The range of relative sizes in which the smallest noticed defect is searched."""
CLOSE = 1.05
"""The search ends when the smallest noticed size is at most this multiple of the largest size that is not noticed."""
CASES = "full-contact", "advance-recede"
FAMILIES = "one-diagonal", "criss-cross", "shaken", "unstructured"
LEVEL = 8
"""The coarsest level on which the study compares its displacements with those of the second solver."""
PLACES = grid(CASES, FAMILIES, (LEVEL,))
COLUMNS = ["defect", "case", "family", "level", "amount", "seen_by"]


class Place:
    """The solver of the study and a second, independent solver for one case on one mesh.

    Attributes:
        setting: case, mesh family and level.
        setup: the experiment: the contact problem of the study, its time scheme and time steps.
        plain: the contact problem of the second solver.
        course: displacements over time by the second solver, with the load that it computes itself.
        alike: displacements over time by the second solver, with the load of the study.
    """

    def __init__(self, setting: Setting) -> None:
        setup = experiment(resolve(setting.case), setting.family, setting.level)
        # The loads are cached, because all defects need the same loads.
        load = cache(setup.problem.load)
        self.setting, self.setup = setting, replace(setup, problem=replace(setup.problem, load=load))
        self.plain = PlainProblem(setup.solution, setup.space.mesh)
        self.course, self.alike = self.plain.trajectories(2 * setup.steps, self.plain.load, load)

    def failing(self, setup: Experiment) -> list[str]:
        """Return the keys of the checks that fail if the study solves the given experiment, which may have a defect."""
        right = setup.problem.load is self.setup.problem.load
        alike = self.alike if right else self.plain.trajectories(2 * setup.steps, setup.problem.load)[0]
        row = {**vars(self.setting), "h": setup.space.h, **gaps(setup, self.plain, self.course, alike)}
        table = {self.setting.family: pd.DataFrame([row])}
        verdicts = [rule.verdict(Recomputed(), self.setting.case, table) for rule in TRAJECTORIES]
        return [verdict.key for verdict in verdicts if verdict.verdict == FAILS]

    def smallest(self, defect: SmallDefect) -> tuple[float, str]:
        """Find the smallest relative size of a defect at which a check fails, up to the factor ``CLOSE``.

        Returns:
            The size, and the key of the check; infinity and an empty text if no check fails.
        """
        holds, fails = LEAST, MOST
        if not (seen := self.failing(defect(self.setup, fails))):
            return float("inf"), ""
        while fails > CLOSE * holds:
            amount = float(np.sqrt(holds * fails))
            if found := self.failing(defect(self.setup, amount)):
                fails, seen = amount, found
            else:
                holds = amount
        return fails, seen[0]


def lines(setting: Setting) -> list[Row]:
    """Return the rows of ``sensitivity.csv`` for one case and mesh, one for each defect.

    A defect that multiplies the initial displacement is left out if the initial displacement is zero.
    """
    with threadpool_limits(1):
        place = Place(setting)
        chosen = [name for name in DEFECTS if name != START or place.setup.problem.u0.any()]
        found = [(name, *place.smallest(DEFECTS[name])) for name in chosen]
    return [{**vars(setting), "defect": name, "amount": amount, "seen_by": row} for name, amount, row in found]


def run_sensitivity(executor: Executor, notify: Callable[[], object]) -> pd.DataFrame:
    """Find the smallest noticed defects on all meshes, and return them as the table ``sensitivity.csv``.

    Parameters:
        executor: runs one call for each case and mesh.
        notify: called when a call is finished.
    """
    waiting = [executor.submit(lines, setting) for setting in PLACES]
    for _ in as_completed(waiting):
        notify()
    return pd.DataFrame([row for future in waiting for row in future.result()], columns=COLUMNS)


def sensitivity_text(table: pd.DataFrame) -> str:
    """Return the smallest noticed defects in per cent as a printed table.

    The table has a row for each case and defect, and a column for each mesh family.
    """
    wide = table.assign(percent=[f"{100 * amount:.2g}" for amount in table["amount"]])
    wide = wide.pivot(index=["case", "defect"], columns="family", values="percent")
    order = list(dict.fromkeys(zip(table["case"], table["defect"], strict=True)))
    lines = [[*key, *wide.loc[key, list(FAMILIES)]] for key in order]
    # The headings are passed as a row, because tabulate would widen columns with headings to more than 80 characters.
    head = ["case", "defect, in %", *FAMILIES]
    return tabulate([head, *lines], tablefmt="plain", disable_numparse=True, maxcolwidths=[None, 14])
