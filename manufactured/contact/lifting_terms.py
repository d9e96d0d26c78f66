"""The strain of the displacement of a contact face, as a sum of terms.

Each term is a derivative of w, q, r or z along the face times a function of the depth y. If there is an initial gap g,
w − g replaces w.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from manufactured.tensors import pairs

COMBINATIONS: dict[str, tuple[tuple[str, int], ...]] = {
    **{name: ((name, 0),) for name in "abcdef"},
    **{f"{name}'": ((name, 1),) for name in "bcdf"},
    "a'+b": (("a", 1), ("b", 0)),
    "e'+d": (("e", 1), ("d", 0)),
}
"""For each function of y that occurs in strains: its profile functions and the orders of their derivatives."""


class StrainTerm(NamedTuple):
    """One term of a component of the strain in the axes of a contact face.

    The term is the product of a factor, a derivative along the face of the gap w, the normal strain q, the shear
    strain r or the slip z, and a function of y.

    Attributes:
        row: the row of the Mandel vector in the axes (s, n).
        factor: the factor, which contains √2 or √½ for off-diagonal components.
        source: the number of the function that is differentiated: 0 for w, 1 for q, and from 2 on the components of
            the tangential fields r and z.
        along: the multi-index of the derivative along the face.
        profile: the name of the function of y in ``COMBINATIONS``.
    """

    row: int
    factor: float
    source: int
    along: tuple[int, ...]
    profile: str


@lru_cache
def strain_terms(n: int, deep: bool, tangential: tuple[str, ...]) -> tuple[StrainTerm, ...]:
    """Return all terms of the strain of a contact face.

    Args:
        n: the number of coordinates along the face.
        deep: whether the profile has a function e, so that the strain contains second derivatives of q.
        tangential: the profile functions of the tangential fields that are not zero: "c" for r, "f" for z. Each field
            has n components.
    """
    zero, first = first_indices(n)
    fields = [(2 + n * number, profile) for number, profile in enumerate(tangential)]
    found = []
    for row, (i, j) in enumerate(pairs(n + 1)):
        if i == j == n:
            found += [StrainTerm(row, 1.0, 0, zero, "b'"), StrainTerm(row, 1.0, 1, zero, "d'")]
        elif j == n:
            half = math.sqrt(0.5)
            found += [StrainTerm(row, half, 0, first[i], "a'+b"), StrainTerm(row, half, 1, first[i], "e'+d")]
            found += [StrainTerm(row, half, start + i, zero, f"{profile}'") for start, profile in fields]
        else:
            factor = 1.0 if i == j else math.sqrt(2.0)
            found += [StrainTerm(row, factor, 0, plus(first[i], first[j]), "a")]
            found += [StrainTerm(row, factor, 1, plus(first[i], first[j]), "e")] * deep
            for start, profile in fields:
                found += [StrainTerm(row, factor / 2, start + k, first[m], profile) for k, m in ((i, j), (j, i))]
    return tuple(found)


def plus(*indices: tuple[int, ...]) -> tuple[int, ...]:
    """Return the sum of multi-indices."""
    return tuple(map(sum, zip(*indices, strict=True)))


def first_indices(variables: int) -> tuple[tuple[int, ...], list[tuple[int, ...]]]:
    """Return the multi-index of a function itself, (0, …), and the multi-indices of its first derivatives."""
    unit = np.eye(variables, dtype=int)
    return (0,) * variables, [tuple(int(i) for i in row) for row in unit]
