"""The cases that take the most time are left to the slow tests."""

import pytest

BEYOND_THE_CATALOGUE = ("trains", "breathing-trains", "natural-motion", "roller-8", "standing-8")
DEAR = (
    "cube-two-faces",
    "cube-bowl",
    "cube-disc",
    "hexagon",
    "merging-patches",
    "corner",
    "parabolic-gap",
    "travelling-patch",
    "trains",
    "breathing-trains",
    "roller-8",
    "standing-8",
)


def slow_unless(quick, *values, **options):
    """Parameters of a test, which is slow unless a condition holds."""
    return pytest.param(*values, marks=() if quick else pytest.mark.slow, **options)


def slow(*values):
    return slow_unless(False, *values)


def by_cost(names):
    """Parameters of a test; `make study` and the slow tests prove and measure the costly cases as well."""
    return [slow_unless(name not in DEAR, name) for name in names]
