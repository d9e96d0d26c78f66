"""What is measured of the work of contact, and where."""

from __future__ import annotations

import math
from collections.abc import Sequence

from study.fem.naming import resolve
from study.solve.steps import rate_steps
from study.statements.contact_work.resolved import Resolved, distances
from study.statements.contact_work.total_work import TotalWork, by_chance, vertices_on
from study.statements.shared.base import ListedNumbers, Setting, grid, with_h
from study.statements.shared.places import space_of
from study.statements.shared.scope import Scope


class MeasuredWork(ListedNumbers):
    """The root of the work of contact beside the error and the excess over the linear problem."""

    label = "beyond: work of contact"
    effort = 5
    claim = "‖R(·; Π^h u − u)‖^{1/2} = O(h) with contact at every scale, u_ν not bounded in H²(Γ3)"
    # On coarse meshes there is nothing to be seen, and fine ones take time: left to the full study.
    full = (
        *grid(("trains", "breathing-trains"), ("one-diagonal", "shaken"), (16, 32, 64, 128)),
        *grid(("trains",), ("unstructured",), (16, 32, 64, 128)),
    )

    def settings(self, scope: Scope) -> Sequence[Setting]:
        """Those of a study of the whole catalogue, to which the cases with trains do not belong."""
        return self.places(scope.full) if scope.whole else []

    def measure(self, setting: Setting) -> dict[str, float]:
        case, space = resolve(setting.case), space_of(setting)
        solution = case.solution
        found = distances(Resolved.of(solution, space), rate_steps(space.body.T, setting.level, case.pace))
        total, vertices = TotalWork(solution), vertices_on(space)
        found["work"] = math.sqrt(total(vertices))
        if setting.family == "one-diagonal":
            found |= by_chance(total, vertices)
        return with_h(space.h, found)
