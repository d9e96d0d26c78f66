"""The strain of a lifting, term by term: derivatives of w, q and r along the face times functions of the depth.

Where there is an initial gap g, w − g stands for w.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from manufactured.tensors import pairs

COMBINATIONS: dict[str, tuple[tuple[str, int], ...]] = {
    **{name: ((name, 0),) for name in "abcde"},
    **{f"{name}'": ((name, 1),) for name in "bcd"},
    "a'+b": (("a", 1), ("b", 0)),
    "e'+d": (("e", 1), ("d", 0)),
}
"""Combinations of the profile's functions and derivatives that make strains."""


class StrainTerm(NamedTuple):
    """factor · ∂^along (w, q or r) · (function of y) in one component of the local strain.

    Attributes:
        row: of the Mandel vector in the axes (s, n).
        factor: √2 or √½ for components off the diagonal.
        source: 0 for w, 1 for q, 2 + i for r_i.
        along: derivatives along the face.
        profile: a name in ``COMBINATIONS``.
    """

    row: int
    factor: float
    source: int
    along: tuple[int, ...]
    profile: str


@lru_cache
def strain_terms(n: int, deep: bool, shear: int) -> tuple[StrainTerm, ...]:
    """The terms of the strain of a lifting, n coordinates along the face.

    ``deep`` is whether the profile has an e, and so the strain second derivatives of q; ``shear`` the number of r_i.
    """
    zero, first = first_indices(n)
    found = []
    for row, (i, j) in enumerate(pairs(n + 1)):
        if i == j == n:
            found += [StrainTerm(row, 1.0, 0, zero, "b'"), StrainTerm(row, 1.0, 1, zero, "d'")]
        elif j == n:
            half = math.sqrt(0.5)
            found += [StrainTerm(row, half, 0, first[i], "a'+b"), StrainTerm(row, half, 1, first[i], "e'+d")]
            found += [StrainTerm(row, half, 2 + i, zero, "c'")] * (shear > 0)
        else:
            factor = 1.0 if i == j else math.sqrt(2.0)
            found += [StrainTerm(row, factor, 0, plus(first[i], first[j]), "a")]
            found += [StrainTerm(row, factor, 1, plus(first[i], first[j]), "e")] * deep
            if shear:
                found += [StrainTerm(row, factor / 2, 2 + k, first[m], "c") for k, m in ((i, j), (j, i))]
    return tuple(found)


def plus(*indices: tuple[int, ...]) -> tuple[int, ...]:
    """The sum of multi-indices."""
    return tuple(map(sum, zip(*indices, strict=True)))


def first_indices(variables: int) -> tuple[tuple[int, ...], list[tuple[int, ...]]]:
    """The multi-index of the value and those of the first derivatives, coordinate by coordinate."""
    unit = np.eye(variables, dtype=int)
    return (0,) * variables, [tuple(int(i) for i in row) for row in unit]
