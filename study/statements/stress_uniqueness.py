"""Theorem 4.3: Problem 3.2 has one solution, on stresses that know no displacement."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from manufactured.tensors import Tensors
from study.fem.mesh import size as mesh_size
from study.ledger.measures import largest
from study.solve.signorini import Signorini
from study.statements.shared.base import ListedNumbers, Setting, grid, with_h
from study.statements.thm_4_2.stress_errors import StressExperiment
from study.statements.wellposed import EXACTLY, INTERIOR, InteriorPoint, LeastSquares, RandomStarts

CASES = ("advance-recede", "corner", "anisotropic")
STEPS = 12
RIVALS: Mapping[str, type[Signorini]] = {
    "random starts": RandomStarts,
    "least squares": LeastSquares,  # type: ignore[dict-item]
    "interior point": InteriorPoint,  # type: ignore[dict-item]
}


class OneStress(ListedNumbers):
    """max_n ‖σ_n − τ_n‖_Q / max_n ‖σ_n‖_Q for stresses that solve Problem 3.2 on its own space in different ways.

    Every step minimises a strictly convex energy over the admissible stresses, so that one set of multipliers of
    equilibrium and one stress belong to the past: what starts the search, or another method, may change nothing.
    """

    label = "Thm 4.3"
    claim = "Problem 3.2 has one solution: different starts and solvers give one stress"
    rules = (
        largest("random-starts", "stresses from random active sets", EXACTLY, "random starts"),
        largest("least-squares", "stresses by Lawson and Hanson's method on the dual", EXACTLY, "least squares"),
        largest("interior-point", "stresses by an interior point method on all unknowns", INTERIOR, "interior point"),
    )

    def places(self, full: bool) -> list[Setting]:
        return grid(CASES, ("unstructured",), (4, 8)) if full else grid(CASES[:1], ("shaken",), (4,))

    def measure(self, setting: Setting) -> dict[str, float]:
        experiment = StressExperiment.at(setting, STEPS)
        own = stresses(experiment)
        size = max(size_of(experiment, values) for values in own)
        found = {}
        for name, solver in RIVALS.items():
            pairs = zip(own, stresses(replace(experiment, solver=solver)), strict=True)
            found[name] = max(size_of(experiment, a - b) for a, b in pairs) / size
        return with_h(mesh_size(experiment.space.mesh), found)


def stresses(experiment: StressExperiment) -> list[Tensors]:
    """σ at the points of the space in every step."""
    return [state.stress.values for state in experiment.march(experiment.steps)]


def size_of(experiment: StressExperiment, stress: Tensors) -> float:
    """‖σ‖_Q."""
    return float(np.sqrt(np.einsum("Icq,Icq,cq->", stress, stress, experiment.space.weights)))
