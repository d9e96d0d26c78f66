"""The data of ``advance_recede`` on a unit square that is rotated by the angle 2/5 and translated.

The gap w, the contact pressure p, the slip z and the contact zone {ψ ≥ 0} with the front c are

    w = 20 (s − c)_+^4,   p = 20 (c − s)_+²,   z = 4t sin(3s + 1/2),   ψ = c − s,   c(t) = 1/4 + 2t(1 − t)

with s along the rotated bottom. Viscosity and elasticity are equal, A = G: τ ↦ 2τ + (tr τ)/2 I.

Predicted order 1: the problem does not depend on the axes. As for ``advance_recede``, the exponents of gap and pressure
at the front, α = 4 > 7/2 and m = 2 > 3/2, give (5.36), so that Prop. 5.4 applies.

On structured meshes every error must equal the error of ``advance_recede`` up to round-off.
"""

from dataclasses import replace

import numpy as np

from manufactured.body import polygon, unit_square
from manufactured.case import Case
from manufactured.cases import advance_recede

ANGLE = 0.4
SHIFT = (3.0, -1.0)


def case() -> Case:
    turn = np.array([[np.cos(ANGLE), -np.sin(ANGLE)], [np.sin(ANGLE), np.cos(ANGLE)]])
    square = unit_square()
    corners = turn @ square.vertices + np.array(SHIFT)[:, None]
    body = polygon([(x, y) for x, y in corners.T], [part.kind for part in square.parts])
    plain = advance_recede.case()
    return replace(
        plain,
        name="rotated",
        summary="advance-recede on a turned square",
        solution=advance_recede.on(body),
        reason="nothing depends on the axes: the errors of advance-recede",
        twin=plain.name,
    )
