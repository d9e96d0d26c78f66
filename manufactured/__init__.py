"""The continuous problem: laws, bodies and exact solutions with prescribed contact zones.

Everything is dimensionless. Nothing here knows a mesh, so any discretisation can use it. A case is
built from a gap and a pressure, formulas of the coordinate ``s`` along a face (``s1`` and ``s2`` in
3D) and the time ``t``; ``pos(x, a)`` is the truncated power x_+^a. Materials and loads are formulas of
the coordinates ``x1``, ``x2``, ``x3`` of a point. ``HERMITE``, ``QUARTIC`` and ``PARABOLA`` are
polynomials that cut a lifting off inside the body, for ``cutoff`` and ``slab``.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from manufactured.catalogue import catalogue as catalogue
from manufactured.catalogue import named as named

if TYPE_CHECKING:
    from manufactured.public import *  # noqa: F403


def __getattr__(name: str) -> Any:
    """The names of ``manufactured.public``, imported when one is first asked for: SymPy takes half a second."""
    public = import_module("manufactured.public")
    globals().update({known: getattr(public, known) for known in ("__all__", *public.__all__)})
    if name not in globals():
        raise AttributeError(f"module 'manufactured' has no attribute {name!r}")
    return globals()[name]


def __dir__() -> list[str]:
    return [*globals(), *import_module("manufactured.public").__all__]
