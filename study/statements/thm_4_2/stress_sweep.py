"""Where Problem 3.2 is solved on a stress space of its own, and what a row of ``stresses.csv`` takes."""

from __future__ import annotations

from typing import Any

from study.fem.naming import family_named, resolve
from study.ledger.datafiles import CsvFile
from study.solve.steps import stress_steps
from study.statements.shared import estimates
from study.statements.shared.base import Setting, Statement, grid
from study.statements.thm_4_2.stress_errors import COLUMNS, measure_stresses

FRONTS = "full-contact", "fixed-front-on-vertex", "fixed-front-off-vertex", "advance-recede", "travelling-patch"
LAWS = "anisotropic", "heterogeneous", "layered", "softening"
BODIES = "rotated", "corner", "hexagon"
CASES = (*FRONTS, "merging-patches", "load-w11", *LAWS, *BODIES, "natural-front", "re-entrant")
"""Plane cases with linear laws, f_0 ∈ L² and stresses that are continuous in time: where the face lands with a
velocity, BDF2 is wrong for a step whatever k is. Without contact there is no pressure to compare; at the junction of Γ1
and Γ3 it is not in L²(Γ3). Left out is rough-trace, too: at its front, r^{5/4} where the contact problem itself makes
r^{3/2}, errors depend on the place of the front in a cell, and multipliers fall with orders of 0.6 to 2.5 from level to
level up to n = 64."""
FAMILIES = "one-diagonal", "shaken"
FAMILIES_OF = {
    "hexagon": ("unstructured",),
    "re-entrant": ("unstructured", "graded"),
    "natural-front": ("one-diagonal",),
    "merging-patches": ("one-diagonal", "unstructured"),
    "layered": ("one-diagonal", "unstructured"),
}
"""Mesh families other than these. The error of the pressure at a natural front that rests is that of one cell: where
the front lies in it may not be left to chance, or orders scatter by 1 from seed to seed. Patches that merge and layers
are three or four cells wide on the coarsest meshes, where orders of random ones scatter most."""
QUICK = ("advance-recede", "layered", "corner", "natural-front")
FINEST = ("re-entrant",)
"""Cases that are measured on the finest level, too."""
STRESSES = CsvFile("stresses.csv", ("case", "family", "level"), COLUMNS)


class Stresses(Statement):
    """Problem 3.2 on composite equilibrated stresses against the exact solution and against Problem 5.1."""

    file = STRESSES
    # Two levels of random meshes give orders that one in twenty misses its window. On eight edges terms of higher order
    # are not small: the pressure of *corner* has the orders 2.26, 2.06, 1.90 from n = 8, 12, 16 to twice as many.
    quick = grid(QUICK, ("one-diagonal",), (12, 24))
    full = tuple(
        Setting(case, family, level)
        for case in CASES
        for family in FAMILIES_OF.get(case, FAMILIES)
        for level in (8, 16, 32, *((64,) if case in FINEST else ()))
    )

    def measure(self, setting: Setting) -> dict[str, Any]:
        case, family = resolve(setting.case), family_named(setting.family)
        return measure_stresses(case, family, setting.level, self.steps(setting))

    def cost(self, setting: Setting) -> float:
        return 65.0 * setting.level**2 * self.steps(setting)

    def memory(self, setting: Setting) -> float:
        return estimates.stress(setting.level)

    def steps(self, setting: Setting) -> int:
        """Of the size of h, shorter where more happens in time."""
        case = resolve(setting.case)
        return stress_steps(case.solution.body.T, setting.level, case.pace)
