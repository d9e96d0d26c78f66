"""The continuous problem: material laws, bodies, and exact solutions with prescribed contact zones.

All quantities are dimensionless. This package does not use meshes, so any discretisation can use it. An exact solution
is built from a gap and a pressure. They are formulas of the coordinate ``s`` along a contact face (``s1`` and ``s2`` in
3D) and the time ``t``; ``pos(x, a)`` is the truncated power x_+^a. Materials and loads are formulas of the coordinates
``x1``, ``x2``, ``x3`` of a point. ``HERMITE``, ``QUARTIC`` and ``PARABOLA`` are cut-off polynomials for ``cutoff`` and
``slab``. With them the displacement that belongs to a contact face decreases to zero inside the body.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from manufactured.catalogue import catalogue as catalogue
from manufactured.catalogue import named as named

if TYPE_CHECKING:
    from manufactured.public import *  # noqa: F403


def __getattr__(name: str) -> Any:
    """Return the public object with the given name, and import all public objects on the first call.

    They are not imported earlier because loading SymPy takes half a second.
    """
    public = import_module("manufactured.public")
    globals().update({known: getattr(public, known) for known in ("__all__", *public.__all__)})
    if name not in globals():
        raise AttributeError(f"module 'manufactured' has no attribute {name!r}")
    return globals()[name]


def __dir__() -> list[str]:
    return [*globals(), *import_module("manufactured.public").__all__]
