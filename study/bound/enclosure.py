"""‖u(t) − u_h(t)‖_V enclosed from both sides, by a better trajectory ũ and its bound y:

    d(t) − y(t) ≤ ‖u(t) − u_h(t)‖_V ≤ d(t) + y(t),     d = ‖ũ − u_h‖_V.
"""

from __future__ import annotations
