"""The cases that take the most time are left to the slow tests."""

import pytest

BEYOND_THE_CATALOGUE = ("trains", "breathing-trains", "natural-motion", "roller-8", "standing-8")
DEAR = (
    *("cube-two-faces", "cube-bowl", "cube-disc", "hexagon", "merging-patches", "corner"),
    *("parabolic-gap", "travelling-patch", "trains", "breathing-trains", "roller-8", "standing-8"),
)


def by_cost(names):
    """Parameters of a test; `make study` and the slow tests prove and measure the costly cases as well."""
    return [pytest.param(name, marks=pytest.mark.slow if name in DEAR else ()) for name in names]
