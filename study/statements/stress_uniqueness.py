"""Theorem 4.3: Problem 3.2 has one solution, on stresses that know no displacement."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from manufactured.tensors import Tensors
from study.fem.mesh import size as mesh_size
from study.fem.naming import family_named, resolve
from study.ledger.verdict import Verdict
from study.solve.signorini import Signorini
from study.statements.base import Setting
from study.statements.tally import grid, judge, largest, with_h
from study.statements.thm_4_2.own_space import StressSetup
from study.statements.wellposed import EXACTLY, INTERIOR, InteriorPoint, LeastSquares, RandomStarts

CASES = ("advance-recede", "corner", "anisotropic")
STEPS = 12
RIVALS: Mapping[str, type[Signorini]] = {
    "random starts": RandomStarts,
    "least squares": LeastSquares,  # type: ignore[dict-item]
    "interior point": InteriorPoint,  # type: ignore[dict-item]
}
LINES = (
    largest("stresses from random active sets", EXACTLY, "random starts"),
    largest("stresses by Lawson and Hanson's method on the dual", EXACTLY, "least squares"),
    largest("stresses by an interior point method on the whole programme", INTERIOR, "interior point"),
)


@dataclass(frozen=True)
class OneStress:
    """max_n ‖σ_n − τ_n‖_Q / max_n ‖σ_n‖_Q for stresses that solve Problem 3.2 on its own space in different ways.

    Every step minimises a strictly convex energy over the admissible stresses, so that one set of multipliers of
    equilibrium and one stress belong to the past: what starts the search, or another method, may change nothing.
    """

    label: str = "Thm 4.3"
    claim: str = "Problem 3.2 has one solution: different starts and solvers give one stress"

    def settings(self, full: bool) -> list[Setting]:
        return grid(CASES, ("unstructured",), (4, 8)) if full else grid(CASES[:1], ("shaken",), (4,))

    def measure(self, setting: Setting) -> dict[str, float]:
        solution, family = resolve(setting.case).solution, family_named(setting.family)
        setup = StressSetup.of(solution, family, setting.level, STEPS)
        own = stresses(setup)
        size = max(size_of(setup, values) for values in own)
        found = {}
        for name, solver in RIVALS.items():
            pairs = zip(own, stresses(replace(setup, solver=solver)), strict=True)
            found[name] = max(size_of(setup, a - b) for a, b in pairs) / size
        return with_h(mesh_size(setup.space.mesh), found)

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        return judge(self, rows, LINES)


def stresses(setup: StressSetup) -> list[Tensors]:
    """σ at the points of the space in every step."""
    return [state.stress.values for state in setup.march(setup.steps)]


def size_of(setup: StressSetup, stress: Tensors) -> float:
    """‖σ‖_Q."""
    return float(np.sqrt(np.einsum("Icq,Icq,cq->", stress, stress, setup.space.weights)))
