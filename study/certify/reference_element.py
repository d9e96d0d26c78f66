"""The composite element of degree 3 on the reference triangle with exact coefficients, as certificates state it.

Unknown are 90 Bernstein coefficients of a stress and the three of a rigid motion q̂; equations are continuous tractions
inside, given ones outside and Div σ̂ − q̂ = −f̂. Row reduction over the rationals solves them for every input at once.
"""

from __future__ import annotations

import math
from fractions import Fraction
from functools import cache
from itertools import product
from typing import Any

from sympy import QQ
from sympy.polys.matrices import DomainMatrix

from study.certify import checker
from study.certify.checker import CENTRE, CORNERS, CUBIC, SQUARE, Poly, X, Y
from study.stresses.bernstein import indices

GIVEN, INNER = 36, 9
"""The number of inputs that say tractions and forces, and of those that stay free."""
RIGID = ((checker.ONE, Poly()), (Poly(), checker.ONE), (Y * -1, X))
Field = list[list[Poly]]
"""Three components on three thirds."""


def bernstein(third: int) -> list[Poly]:
    """The cubic Bernstein polynomials of a third in X and Y, in the order of ``indices``."""
    (p, q), (r, s), (m, n) = CORNERS[(third + 1) % 3], CORNERS[(third + 2) % 3], CENTRE
    rows = checker.inverse([[p, r, m], [q, s, n], [Fraction(1)] * 3])
    factors = [X * a + Y * b + checker.ONE * c for a, b, c in rows]
    return [
        math.prod([factor for factor, e in zip(factors, alpha, strict=True) for _ in range(e)], start=checker.ONE)
        * math.factorial(3)
        * Fraction(1, math.prod(map(math.factorial, alpha)))
        for alpha in indices(3)
    ]


def _fields() -> list[Field]:
    """The fields of which one Bernstein coefficient is 1."""
    return [
        [[p if (i, c) == place else Poly() for c in range(3)] for i in range(3)]
        for place in product(range(3), repeat=2)
        for p in bernstein(place[0])
    ]


def _conditions(field: Field) -> list[Fraction]:
    """Tractions outside, jumps inside and divergences, all by their coefficients."""
    outside, jumps, divergences = [], [], []
    stress = [[[p.get(key, Fraction(0)) for key in CUBIC] for p in third] for third in field]
    for i, (x, y, z) in enumerate(field):
        outside += checker.tractions(stress[i], CORNERS[(i + 1) % 3], CORNERS[(i + 2) % 3])
        one, other = (checker.tractions(stress[(i + n) % 3], CORNERS[i], CENTRE) for n in (1, 2))
        jumps += [p - q for p, q in zip(one, other, strict=True)]
        divergences += [x.slope(0) + z.slope(1), z.slope(0) + y.slope(1)]
    on_edges = [p.get((n, 0, 0), Fraction(0)) for p in outside + jumps for n in range(4)]
    return on_edges + _at(divergences)


def _at(divergences: list[Poly]) -> list[Fraction]:
    return [p.get(key, Fraction(0)) for p in divergences for key in SQUARE]


def _right_sides() -> list[list[Fraction]]:
    """What the conditions are for the inputs, in their order."""
    found = []
    for i, p, d in product(range(3), checker.bernstein(3, X), (0, 1)):
        column = [Fraction(0)] * 84
        start = 8 * i + 4 * d
        column[start : start + 4] = [p.get((n, 0, 0), Fraction(0)) for n in range(4)]
        found.append(column)
    for key, d in product(SQUARE, (0, 1)):
        force = [Poly({key: Fraction(-1)}) if c == d else Poly() for c in (0, 1)]
        found.append([Fraction(0)] * 48 + _at(force * 3))
    return found


@cache
def columns() -> dict[str, Any]:
    """What a certificate says: integers over one denominator, for each of 45 inputs the monomials of a stress."""
    fields = _fields()
    motions = [[Fraction(0)] * 48 + _at([p * -1 for p in motion] * 3) for motion in RIGID]
    every = [*map(_conditions, fields), *motions, *_right_sides()]
    rows = [[QQ(x.numerator, x.denominator) for x in row] for row in zip(*every, strict=True)]
    reduced, pivots = DomainMatrix(rows, (len(rows), len(every)), QQ).rref()
    solved, unknowns = reduced.to_list(), len(fields) + len(motions)
    free = [n for n in range(len(fields)) if n not in pivots]
    if len(free) != INNER or max(pivots) >= unknowns:
        raise ArithmeticError("the reference element has another dimension than it has to have")
    found = []
    for column in [*range(unknowns, unknowns + GIVEN), *free]:
        sign = 1 if column >= unknowns else -1
        weights = {pivot: sign * row[column] for pivot, row in zip(pivots, solved, strict=False) if pivot < len(fields)}
        found.append(_monomials(fields, weights | ({column: QQ(1)} if sign < 0 else {})))
    over = math.lcm(*(x.denominator for column in found for x in column))
    return {"over": over, "columns": [[int(x * over) for x in column] for column in found]}


def _monomials(fields: list[Field], weights: dict[int, Any]) -> list[Fraction]:
    """A combination of fields by three components of ten monomials on three thirds."""
    total = [[Poly() for _ in range(3)] for _ in range(3)]
    for n, weight in weights.items():
        factor = Fraction(int(weight.numerator), int(weight.denominator))
        total = [[p + q * factor for p, q in zip(r, s, strict=True)] for r, s in zip(total, fields[n], strict=True)]
    return [total[i][c].get(key, Fraction(0)) for c, i, key in product(range(3), range(3), CUBIC)]
