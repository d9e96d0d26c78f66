"""What numbers depend on beside the code of the study: the machine's kind and the versions of the libraries.

Not in it is which kernels a BLAS takes for a processor: the last digits may differ between processors.
"""

from __future__ import annotations

import platform
from functools import cache
from importlib.metadata import version

PACKAGES = ("numpy", "scipy", "numba", "scikit-fem", "pyamg", "clarabel", "sympy")
"""Distributions that compute."""


@cache
def versions() -> dict[str, str]:
    """Of these packages and of Python, and the architecture."""
    return {"python": platform.python_version(), "machine": platform.machine(), **packages()}


def packages() -> dict[str, str]:
    """Their versions."""
    return {package: version(package) for package in PACKAGES}
