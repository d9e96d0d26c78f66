"""Entrywise comparison of arrays; ``pytest.approx`` does the same much more slowly, entry by entry."""

import numpy as np
from numpy.typing import NDArray


def near(found: NDArray[np.float64], expected: NDArray[np.float64], rel: float, abs: float) -> bool:
    """Whether |found − expected| ≤ max(rel |expected|, abs) in every entry of arrays of the same shape."""
    tolerance = np.maximum(rel * np.abs(expected), abs)
    return found.shape == expected.shape and bool((np.abs(found - expected) <= tolerance).all())
