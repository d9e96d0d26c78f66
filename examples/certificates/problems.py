"""Three problems whose solutions nobody knows, with bounds that are theorems: ``study certify problems.py:square``.

* square: clamped on top, pushed down and pulled up by a force that changes its sign, so that the zone of contact grows
  from the left.
* wedge: clamped in a wall, on a slanted foundation, under a load that rolls along its top, with moving kinks.
* bracket: an L-shaped body with a re-entrant corner, an anisotropic material and a start at which it does not rest.
"""

from __future__ import annotations

import numpy as np
from sympy import Rational

from manufactured import Data, KelvinVoigt, Kind, Linear, isotropic, polygon, pos, t, x1, x2

CONTACT, LOADED, CLAMPED = Kind.CONTACT, Kind.LOADED, Kind.CLAMPED
LAW = KelvinVoigt(isotropic(1, 0.5), isotropic(2, 3), "linear")


def square() -> Data:
    body = polygon([(0, 0), (1, 0), (1, 1), (0, 1)], [CONTACT, LOADED, CLAMPED, LOADED])
    return Data.formulas(body, LAW, f0=(0, 12 * t * (x1 - t)), f2={1: (-2 * t * x2, 0)})


def wedge() -> Data:
    body = polygon([(0, 0), (2, -0.5), (2, 1), (0, 1)], [CONTACT, LOADED, LOADED, CLAMPED])
    push = 4 * t * pos(1 - (x1 - Rational(3, 4) - t / 2) ** 2, 3)
    return Data.formulas(body, LAW, f0=(0, 0), f2={2: (0, -push)})


def bracket() -> Data:
    corners = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
    body = polygon(corners, [CONTACT, LOADED, LOADED, LOADED, CLAMPED, LOADED])
    # In Mandel's components, the axes of the material are those of the body.
    law = KelvinVoigt(Linear(np.array([[3, 1, 0], [1, 2, 0], [0, 0, 1.5]])), isotropic(2, 3), "anisotropic")
    push = 16 * t * (x1 - 1) * (2 - x1)
    return Data.formulas(body, law, f0=(0, 0), f2={2: (0, -push)}, u0=(0, (2 - x2) ** 2 * (1 + x1) / 100))
