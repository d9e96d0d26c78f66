"""Where a search for cyclic garbage would find none, though it takes a fifth of the time."""

from __future__ import annotations

import gc
import importlib
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType


@contextmanager
def uncollected() -> Iterator[None]:
    """No search for cyclic garbage inside the context; it is made up for at the next chance afterwards."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


def imported(name: str) -> ModuleType:
    """A module; the many small objects that it is made of, and those of what it imports, are never searched."""
    new = name not in sys.modules
    with uncollected():
        module = importlib.import_module(name)
        if new:
            gc.freeze()
    return module
