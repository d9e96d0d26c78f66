"""Check certificates of error bounds: a stand-alone program that needs only Python and this file.

    python checker.py certificate-4.json.gz certificate-8.json.gz

A certificate states a problem, a mesh and a computed displacement u_h on the mesh. It also contains witnesses: another
displacement ũ, stresses σ̃, and a tensor field Φ. From these this program computes an interval that contains ‖u(t) −
u_h(t)‖_V, with integers, fractions and square roots that are rounded outward. The file does not state it. The paper
``paper/certificate.tex``, whose notation is used here, states what is proved and why this program proves it.

Each property that a certificate must have is checked below. If one does not hold, ``RefusedError`` is raised. Exit
codes: 0 if every file proves its interval, 1 if a file is refused, 2 if there is no file to check.
"""

from __future__ import annotations

import json
import math
import os
import re
import sys
import zlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction as Q
from functools import cache, reduce
from itertools import accumulate, combinations, pairwise, product
from operator import mul
from pathlib import Path
from textwrap import fill
from typing import Any

FORMAT = "signorini-certificate 2"
GRID = 100
"""Square roots and sums are rounded outward to multiples of 2^−GRID."""
ELEVATED, HALVINGS = 40, 4
"""Accuracy of two tests of polynomials.

``ELEVATED`` is the degree to which a polynomial is raised to determine its sign. ``HALVINGS`` is how often an edge is
halved on which a traction has a kink.
"""

# Limits of a certificate: a file that exceeds one of them is refused before any work. "In use" are the numbers of a
# certificate of level 16 with 64 steps.
DIGITS = 100  # most decimal digits of an integer, a numerator or a denominator; in use: 30
BITS = 512  # most binary digits after the point in the witnesses ũ, σ̃ and Φ; in use: 41
DEGREE = 10  # largest total degree of a load term p · g_+^q; in use: 7. Run time grows like degree⁶
TERMS = 300  # most monomials of a polynomial, most terms of a load; in use: 6. Degree 10 needs 286 monomials
VERTICES = 100  # most vertices of the polygon; in use: 6. The limit is low because every pair of sides is compared
REFINEMENTS = 8  # most refinements from the mesh of u_h to the mesh of ũ; in use: 2
LISTS = 1 << 20  # most lists in a file; in use: 10 000. In memory an empty list takes 20 times its two characters
PACKED, UNPACKED = 1 << 28, 1 << 30  # most packed bytes, most characters of the text; in use: 35 and 80 million
PACKING, SMALL = (
    20,
    1 << 24,
)  # most characters of text per packed byte, for texts longer than SMALL; in use: 2.3. A zip bomb has 1000

Vector = tuple[Q, Q]
Matrix = list[list[Q]]


class RefusedError(ValueError):
    """Raised if a certificate is wrong or incomplete, so that it proves nothing."""


def require(condition: bool, message: str) -> None:
    """Raise RefusedError with a message unless a condition holds."""
    if not condition:
        raise RefusedError(message)


# The format of a certificate file, and the test of a file against it.


def shown(value: Any) -> str:
    """Return a value as short ASCII text without control characters, so that a file cannot forge terminal output."""
    if isinstance(value, list | dict):
        return "a list" if isinstance(value, list) else "an object"
    text = ascii(value[:60] if isinstance(value, str) else value)
    return text if len(text) <= 60 else f"{text[:60]}..."


@dataclass(frozen=True)
class Many:
    """The format of a list of values that all have the format ``form``.

    Attributes:
        form: the format of the values.
        least, most: the smallest and the largest permitted length.
    """

    form: Any
    least: int = 0
    most: float = math.inf


FRACTION = re.compile(f"-?(0|[1-9][0-9]{{0,{DIGITS - 1}}})(/[1-9][0-9]{{0,{DIGITS - 1}}})?")
INTEGER, POSITIVE = range(1 - 10**DIGITS, 10**DIGITS), range(1, 10**DIGITS)
EXPONENT, UNIT = range(DEGREE + 1), range(1, BITS + 1)
IN_SPACE, IN_TIME = (Many((FRACTION, *[EXPONENT] * n), 0, TERMS) for n in (2, 3))
FORMULA = Many((IN_TIME, IN_TIME, EXPONENT), 0, TERMS)
TENSOR = ((FRACTION, FRACTION, FRACTION),) * 3
PROBLEM = {
    "vertices": Many((FRACTION, FRACTION), 3, VERTICES),
    "kinds": Many({"clamped", "loaded", "contact"}, 3, VERTICES),
    "T": FRACTION,
    "A": TENSOR,
    "G": TENSOR,
    "force": (FORMULA, FORMULA),
    "loads": {"": (FORMULA, FORMULA)},
    "start": (IN_SPACE, IN_SPACE),
}
MESH = {
    "denominator": POSITIVE,
    "points": Many(Many(INTEGER, 2, 2), 3),
    "cells": Many(Many(INTEGER, 3, 3), 1),
    "sides": Many(Many(INTEGER, 2), 3, VERTICES),
}
CERTIFICATE = {
    "format": {FORMAT},
    "level": range(10**6),  # the author's name of the mesh, for readers; the checker does not use it
    "problem": PROBLEM,
    "constants": {
        "mesh": MESH,
        "bits": UNIT,
        "field": Many(Many(INTEGER, 4, 4)),
        "volume": FRACTION,
        "surface": FRACTION,
    },
    "m": FRACTION,
    "mesh": MESH,
    "refinements": range(REFINEMENTS + 1),
    "computed": Many(Many(float), 2),
    "element": {"over": POSITIVE, "columns": Many(Many(INTEGER, 90, 90), 45, 45)},
    "displacement": {"bits": UNIT, "nodes": Many(Many(INTEGER), 2)},
    "stress": {"bits": UNIT, "coarse": range(BITS + 1), "tractions": Many(Many(INTEGER)), "inner": Many(Many(INTEGER))},
}
"""The format of a certificate file, which ``conform`` tests."""


def conform(value: Any, form: Any, name: str) -> None:
    """Refuse a value of a file that does not have the given format.

    Args:
        value: the value.
        form: the format. A dict stands for an object with exactly these keys (or with any keys, if its only key is "");
            ``Many`` for a list; a tuple for a list of values with one format each; a range for an integer; a set for
            one of several texts; ``FRACTION`` for the text of a fraction; ``float`` for a finite number that has a
            point or an exponent.
        name: the name of the value, for messages.
    """
    given = f"{name} is {shown(value)}, but must be"
    match form:
        case dict():
            require(type(value) is dict, f"{given} an object")
            forms = form if "" not in form else dict.fromkeys(value, form[""])
            for key in [*value, *forms]:
                require(key in forms, f"{name} has the unknown key {shown(key)}")
                require(key in value, f"{name} lacks the key {shown(key)}")
            for key in forms:
                conform(value[key], forms[key], f"{name}[{shown(key)}]")
        case tuple():
            require(type(value) is list and len(value) == len(form), f"{given} a list of {len(form)} values")
            for i, (one, of_one) in enumerate(zip(value, form, strict=True)):
                conform(one, of_one, f"{name}[{i}]")
        case Many(of_one, least, most):
            require(type(value) is list, f"{given} a list")
            require(least <= len(value) <= most, f"{name} has {len(value)} values, but must have {least} to {most}")
            kind, end = (float, math.inf) if of_one is float else (int, 10**DIGITS)
            if of_one in (INTEGER, float) and all(type(x) is kind and -end < x < end for x in value):
                return  # Lists of numbers are tested as a whole, because testing each value would be slow.
            for i, one in enumerate(value):
                conform(one, of_one, f"{name}[{i}]")
        case range():
            short = f"an integer from {form[0]} to {form[-1]}"
            long = f"{'a positive' if form[0] > 0 else 'an'} integer of at most {DIGITS} digits"
            require(type(value) is int and value in form, f"{given} {short if form[-1] < 10**9 else long}")
        case set():
            require(type(value) is str and value in form, f"{given} {' or '.join(sorted(form))}")
        case re.Pattern():
            fits = type(value) is str and form.fullmatch(value) is not None
            require(fits, f'{given} a fraction such as "-3/4", of at most {DIGITS} digits')
        case _:
            require(type(value) is float and math.isfinite(value), f"{given} a finite number with a point")


# Exact numbers, and square roots, logarithms and exponentials that are rounded outward.


def up(x: Q) -> Q:
    """Round a fraction up to a multiple of 2^−GRID."""
    return Q(-(-(x.numerator << GRID) // x.denominator), 1 << GRID)


def down(x: Q) -> Q:
    """Round a fraction down to a multiple of 2^−GRID."""
    return -up(-x)


def root(x: Q, above: bool = True) -> Q:
    """Return an upper bound of √x, or a lower bound if ``above`` is false.

    It is a multiple of 2^−GRID that differs from √x by at most 2^−GRID.
    """
    require(x >= 0, "a square is negative")
    floor = math.isqrt((x.numerator << 2 * GRID) // x.denominator)
    return Q(floor + above, 1 << GRID)


def logarithm(x: Q) -> tuple[Q, Q]:
    """Return the ends of an interval that contains log x, x > 0.

    They are computed as log(x/2^n) + n log 2, such that x/2^n is close to 1.
    """
    n = x.numerator.bit_length() - x.denominator.bit_length()
    low, high = logarithm_near_1(x / Q(2) ** n)
    two = logarithm_near_1(Q(2))
    return low + n * two[n < 0], high + n * two[n > 0]


def logarithm_near_1(x: Q) -> tuple[Q, Q]:
    """Return the ends of an interval that contains log x, 1/2 ≤ x ≤ 2.

    The series of log x = 2 artanh z is used; its terms after the 20th are at most 2 |z|^41/41 times a geometric series
    in z².
    """
    z = (x - 1) / (x + 1)  # between −1/3 and 1/3, so that the series converges fast
    partial = sum((2 * z ** (2 * i + 1) / (2 * i + 1) for i in range(20)), Q(0))
    tail = 2 * abs(z) ** 41 / (41 * (1 - z**2))
    return down(partial - tail), up(partial + tail)


def decay(x: Q) -> Q:
    """Return an upper bound of e^{−x}, x ≥ 0.

    It is the reciprocal of a partial sum of the series of e^x, whose terms are positive.
    """
    return up(1 / sum((x**j / math.factorial(j) for j in range(60)), Q(0)))


def mean_decay(x: Q) -> Q:
    """Return an upper bound of ∫_0^1 e^{−xs} ds = (1 − e^{−x})/x, x ≥ 0.

    The terms of the series of this function alternate in sign and, if x < 24, decrease from the 24th on. So a partial
    sum that ends with a positive term is an upper bound. 1/x and 1 are upper bounds, too.
    """
    series = sum(((-x) ** j / math.factorial(j + 1) for j in range(25)), Q(0))
    return up(min(series, 1 / x) if 0 < x < 24 else 1 / max(x, Q(1)))


def common(rows: Iterable[Iterable[Q]]) -> tuple[list[list[int]], int]:
    """Write rows of fractions with a common denominator; return the rows of numerators and the denominator."""
    kept = [list(row) for row in rows]
    denominator = math.lcm(*(x.denominator for row in kept for x in row))
    return [[x.numerator * (denominator // x.denominator) for x in row] for row in kept], denominator


def dot(a: Iterable[Any], b: Iterable[Any]) -> Any:
    return sum(map(mul, a, b))


def applied(rows: Iterable[Sequence[Any]], column: Sequence[Any]) -> list[Any]:
    """Return the product of a matrix and a vector.

    Args:
        rows: the rows of the matrix.
        column: the vector.
    """
    return [dot(row, column) for row in rows]


def mixed(weights: Sequence[int], rows: Iterable[Sequence[int]]) -> list[int]:
    """Return the linear combination Σ_i weights_i rows_i of rows of integers."""
    return [dot(weights, column) for column in zip(*rows, strict=True)]


def congruent(B: Any, M: Any) -> list[list[Any]]:
    """Return the matrix product B M Bᵀ for a symmetric M; matrices are given by their rows."""
    half = [applied(B, row) for row in M]
    return [[dot(row, column) for column in zip(*half, strict=True)] for row in B]


def pairs(flat: Sequence[Any]) -> list[tuple[Any, Any]]:
    return list(zip(flat[::2], flat[1::2], strict=True))


def cross(a: Sequence[Any], b: Sequence[Any]) -> Any:
    return a[0] * b[1] - a[1] * b[0]


def minus(a: Sequence[Q], b: Sequence[Q]) -> Vector:
    return a[0] - b[0], a[1] - b[1]


def combined(a: Matrix, b: Matrix, factor: Q) -> Matrix:
    return [[x + factor * y for x, y in zip(r, s, strict=True)] for r, s in zip(a, b, strict=True)]


def cofactor(matrix: Matrix, i: int, j: int) -> Q:
    rest = [[*row[:j], *row[j + 1 :]] for n, row in enumerate(matrix) if n != i]
    return (-1) ** (i + j) * determinant(rest)


def determinant(matrix: Matrix) -> Q:
    return sum((x * cofactor(matrix, 0, j) for j, x in enumerate(matrix[0])), Q(0)) if matrix else Q(1)


def inverse(matrix: Matrix) -> Matrix:
    size, whole = range(len(matrix)), determinant(matrix)
    return [[cofactor(matrix, j, i) / whole for j in size] for i in size]


def semidefinite(matrix: Matrix) -> bool:
    """Return whether a matrix is symmetric and positive semidefinite.

    It is tested whether any principal minor is negative. Leading minors are not sufficient: the leading minors of [[0,
    0], [0, −1]] are 0.
    """
    size = range(len(matrix))
    chosen = (c for n in size for c in combinations(size, n + 1))
    minors = (determinant([[matrix[i][j] for j in c] for i in c]) for c in chosen)
    return matrix == [list(row) for row in zip(*matrix, strict=True)] and all(minor >= 0 for minor in minors)


# Polynomials with rational coefficients.


class Poly(dict[tuple[int, int, int], Q]):
    """A polynomial in X, Y and S: a dict from exponents to rational coefficients, none of which is 0.

    In the data of a problem X, Y and S stand for x1, x2 and t. On a cell X and Y are the coordinates of the reference
    triangle, X, Y ≥ 0 and X + Y ≤ 1; on an edge X is the position, from 0 to 1 or from −1 to 1. S is then the time
    within an interval, from −1 to 1 (``clock``).
    """

    @classmethod
    def of(cls, terms: Iterable[tuple[tuple[int, ...], Q]]) -> Poly:
        found: dict[Any, Q] = {}
        for key, x in terms:
            found[key] = found.get(key, Q(0)) + x
        return cls({key: x for key, x in found.items() if x})

    def __add__(self, other: Poly) -> Poly:
        return total((self, other))

    def __sub__(self, other: Poly) -> Poly:
        return self + other * -1

    def __mul__(self, other: Poly | Q | int) -> Poly:
        if not isinstance(other, Poly):
            return Poly.of((key, x * other) for key, x in self.items())
        pairs = product(self.items(), other.items())
        return Poly.of(((i + l, j + m, k + n), x * y) for ((i, j, k), x), ((l, m, n), y) in pairs)

    def __call__(self, *images: Poly) -> Poly:
        """Substitute polynomials for X, Y and S, or only for the first of these variables."""
        every = (*images, *(X, Y, S)[len(images) :])
        powers = ((x, [p for p, e in zip(every, key, strict=True) for _ in range(e)]) for key, x in self.items())
        return total(reduce(mul, factors, ONE * x) for x, factors in powers)

    def slope(self, i: int) -> Poly:
        """Return the derivative with respect to X (i = 0) or Y (i = 1)."""
        return Poly.of(((key[0] - (i == 0), key[1] - (i == 1), key[2]), x * key[i]) for key, x in self.items())

    def size(self) -> Q:
        """Return an upper bound of the absolute value of the polynomial for |X|, |Y|, |S| ≤ 1."""
        return sum(map(abs, self.values()), Q(0))


def total(polynomials: Iterable[Poly]) -> Poly:
    return Poly.of(item for p in polynomials for item in p.items())


def constant(x: Q) -> Poly:
    return ONE * x


ONE, X, Y, S = (Poly({key: Q(1)}) for key in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)))
UNIT_X, UNIT_S = (ONE + X) * Q(1, 2), (ONE + S) * Q(1, 2)
"""The variables (1 + X)/2 and (1 + S)/2, which run from 0 to 1 if X and S run from −1 to 1."""
CUBIC, SQUARE = ([(i, j, 0) for i in range(n) for j in range(n - i)] for n in (4, 3))
"""Exponents of the monomials in X and Y: of all with a degree of at most 3, and of all with a degree of at most 2."""
PLAIN = [Poly({key: Q(1)}) for key in CUBIC]
LINEAR = ((0, 0, 0), (1, 0, 0), (0, 1, 0))
CORNERS, CENTRE = [(Q(0), Q(0)), (Q(1), Q(0)), (Q(0), Q(1))], (Q(1, 3), Q(1, 3))
SHARES = ((6, 3, 1), (3, 4, 3), (1, 3, 6))
"""The integrals ∫_0^1 B_a B_b of the Bernstein polynomials of degree 2, multiplied by 30."""


def bernstein(degree: int, x: Poly) -> list[Poly]:
    """Return the Bernstein polynomials of the given degree in a variable x."""
    factors = [[x] * i + [ONE - x] * (degree - i) for i in range(degree + 1)]
    return [reduce(mul, some) * math.comb(degree, i) for i, some in enumerate(factors)]


def mean(p: Poly) -> Q:
    """Return the mean of a polynomial in X and S over the square |X|, |S| ≤ 1."""
    return sum((x / (i + 1) / (k + 1) for (i, _, k), x in p.items() if i % 2 == k % 2 == 0), Q(0))


def on_triangle(p: Poly) -> Q:
    """Integrate a polynomial over the triangle X, Y ≥ 0, X + Y ≤ 1, after taking its mean over |S| ≤ 1."""
    f = math.factorial
    return sum((x * f(i) * f(j) / f(i + j + 2) / (k + 1) for (i, j, k), x in p.items() if k % 2 == 0), Q(0))


def between(a: Sequence[Q], b: Sequence[Q]) -> list[Poly]:
    """Return the coordinates of the point a + X (b − a) of a segment, as polynomials in X."""
    return [constant(p) + X * (q - p) for p, q in zip(a, b, strict=True)]


@dataclass(frozen=True)
class Term:
    """A term p · g_+^q of a load: a polynomial p times a truncated power of a polynomial g; for q = 0 it is p."""

    p: Poly
    g: Poly
    q: int

    def __call__(self, *images: Poly) -> Term:
        return Term(self.p(*images), self.g(*images), self.q)

    def degree(self) -> int:
        """Return the degree of the polynomial p · g^q."""
        of_p, of_g = (max(map(sum, some), default=0) for some in (self.p, self.g))
        return of_p + self.q * of_g

    def plain(self) -> Poly | None:
        """Return a polynomial that equals the term for all |X|, |S| ≤ 1, or None if g may change its sign there."""
        middle, size = 2 * self.g.get((0, 0, 0), Q(0)), self.g.size()
        if self.q and size <= -middle:
            return Poly()
        return None if self.q and size > middle else reduce(mul, [self.g] * self.q, self.p)

    def size(self) -> Q:
        """Return an upper bound of the absolute value of the term for |X|, |Y|, |S| ≤ 1."""
        middle = self.g.get((0, 0, 0), Q(0))
        return self.p.size() * (self.g.size() - abs(middle) + middle) ** self.q


def polynomial(data: Any) -> Poly:
    """Read a polynomial from a certificate.

    Args:
        data: a list of terms [coefficient, exponent of x1, exponent of x2] or [coefficient, exponent of x1, exponent of
            x2, exponent of t]. A coefficient is a whole number or a text such as "3/4".
    """
    return Poly.of(((*key, 0)[:3], Q(x)) for x, *key in data)


def formula(data: Any) -> list[Term]:
    """Read the terms p · g_+^q of a load from a certificate, where they are lists [p, g, q]."""
    terms = [Term(polynomial(p), polynomial(g), q) for p, g, q in data]
    require(all(one.degree() <= DEGREE for one in terms), f"a load has a degree above {DEGREE}")
    return terms


def never_positive(p: Poly) -> bool:
    """Return whether a polynomial in X is shown to be ≤ 0 for 0 ≤ X ≤ 1 by its Bernstein coefficients.

    The degree n = ELEVATED is used. The coefficients of (1 + z)^n p(1/(1 + z)) are the Bernstein coefficients up to
    positive factors. False means "not shown", because a coefficient may be positive although p ≤ 0.
    """
    n = ELEVATED
    return all(sum(x * math.comb(n - i, k) for (i, _, _), x in p.items()) <= 0 for k in range(n + 1))


# The problem that a certificate states.


@dataclass(frozen=True)
class Side:
    """A side of the polygon: its ends, its boundary condition, and the two components of the traction f_2 on it.

    If f_2 = 0, ``load`` is empty.
    """

    start: Vector
    end: Vector
    kind: str
    load: list[list[Term]]

    @property
    def along(self) -> Vector:
        return minus(self.end, self.start)

    @property
    def normal(self) -> Vector:
        """The outward normal of the side; its length is the length of the side."""
        return self.along[1], -self.along[0]

    def is_apart(self, other: Side) -> bool:
        """Return whether this side and another side do not touch.

        Two closed segments do not touch if and only if a line separates them, and then a line parallel or orthogonal to
        one of them does. Only such lines are tested.
        """
        for axis in (self.normal, other.normal, self.along):
            (a, b), (c, d) = (sorted((dot(axis, side.start), dot(axis, side.end))) for side in (self, other))
            if b < c or d < a:
                return True
        return False


class Problem:
    """The contact problem that a certificate states: body, law, loads, initial displacement and final time.

    Tensors are in Voigt's components, stresses (11, 22, 12) and strains (11, 22, 2·12). The viscosity A and the
    elasticity G are 3 × 3 matrices.

    Args:
        data: the object "problem" of the certificate, whose format has been tested.

    Raises:
        RefusedError: a required property of the body, the law, the loads or u_0 does not hold, or cannot be shown.
    """

    def __init__(self, data: Any) -> None:
        corners, loads = [(Q(x), Q(y)) for x, y in data["vertices"]], data["loads"]
        ends, names = [*corners[1:], *corners[:1]], list(map(str, range(len(corners))))
        given = [[formula(f) for f in loads.get(name, [])] for name in names]
        require(set(loads) <= set(names), "f_2 is given on a side that does not exist")
        require(len(data["kinds"]) == len(corners), "the polygon must have one kind for every side")
        self.sides = [Side(*one) for one in zip(corners, ends, data["kinds"], given, strict=True)]
        self.T, self.start = Q(data["T"]), [polynomial(p) for p in data["start"]]
        require(all(sum(key) <= DEGREE for p in self.start for key in p), f"u_0 has a degree above {DEGREE}")
        self.A, self.G = ([[Q(x) for x in row] for row in data[name]] for name in "AG")
        force = [formula(f) for f in data["force"]]
        require(not any(term.q for f in force for term in f), "f_0 with kinks is not served")
        self.force = [total(term.p for term in f) for f in force]
        self._check_polygon()
        self._check_law()
        for part, side in enumerate(self.sides):
            require(not side.load or side.kind == "loaded", f"f_2 is given on part {part}, which is not of Γ2")
            self._check_start(side)

    @property
    def twice_area(self) -> Q:
        """Twice the area of the body."""
        return sum((cross(side.start, side.end) for side in self.sides), Q(0))

    def _check_law(self) -> None:
        require(self.T > 0, "T is not positive")
        elliptic = semidefinite(self.A) and determinant(self.A) > 0
        require(elliptic, "A is not symmetric and positive definite")
        require(semidefinite(self.G), "G is not symmetric and positive semidefinite")

    def _check_polygon(self) -> None:
        """Refuse a body that is not a simple polygon with counter-clockwise vertices and a clamped side.

        Only sides that are not neighbours are compared. This suffices: if a side folds back on its neighbour or has no
        length, it touches the side after its neighbour.
        """
        sides = self.sides
        require(any(side.kind == "clamped" for side in sides), "no part is clamped")
        require(self.twice_area > 0, "the polygon is not counter-clockwise")
        for i, one in enumerate(sides):
            for other in sides[i + 2 : len(sides) - (i == 0)]:
                require(one.is_apart(other), f"two sides of the polygon meet, one is side {i}")

    def _check_start(self, side: Side) -> None:
        """Refuse an initial displacement that is not 0 on a clamped side, or may penetrate the foundation."""
        u = [p(*between(side.start, side.end)) for p in self.start]
        require(side.kind != "clamped" or not any(u), "u_0 does not vanish on Γ1")
        if side.kind == "contact":
            normal = u[0] * side.normal[0] + u[1] * side.normal[1]
            require(never_positive(normal), "u_0ν ≤ 0 on Γ3 cannot be shown")


# Meshes of the polygon.


@dataclass(frozen=True)
class Cell:
    """A triangle of a mesh.

    Attributes:
        v: the numbers of its three vertices.
        nodes: the numbers of its six nodes: the vertices, then the midpoints of the sides.
        F: the matrix (a b; c d) of integers, by rows. Its columns are h times the vectors from the first vertex to the
            second and to the third, with the common denominator h of all coordinates (``Mesh``), not the mesh size. So
            x = x_1 + F X/h maps the reference triangle to the cell.
        det: the determinant of F.
    """

    v: list[int]
    nodes: list[int]
    F: tuple[int, int, int, int]
    det: int


class Mesh:
    """A conforming mesh of triangles. Vertices are pairs of integers, to be divided by the integer h.

    Nodes are the vertices, then the midpoints of the edges. ``boundary`` maps each edge on the boundary of the body,
    traversed counter-clockwise, to the side of the polygon on which it lies.

    Args:
        h: the common denominator of the coordinates.
        points: the numerators of both coordinates of every vertex.
        cells: the numbers of the three vertices of every cell, counter-clockwise.
        lines: each side of the polygon with the numbers of the vertices on it, in their order along the side.
    """

    def __init__(
        self, h: int, points: list[list[int]], cells: list[list[int]], lines: list[tuple[Side, list[int]]]
    ) -> None:
        self.h, self.points, self.lines = h, points, lines
        self.edges = sorted({(min(e), max(e)) for v in cells for e in combinations(v, 2)})
        self.node = {edge: len(points) + n for n, edge in enumerate(self.edges)}
        self.boundary = {edge: side for side, line in lines for edge in pairwise(line)}
        self.cells = [self._cell(v) for v in cells]
        self.nodes = len(points) + len(self.edges)

    @classmethod
    def of(cls, data: Any, problem: Problem) -> Mesh:
        """Return the mesh of a certificate; refuse it unless its cells cover each point of the body exactly once.

        All cells must be counter-clockwise. Edges that are traversed only once must follow each other along the sides
        of the polygon. Then the sum of the winding numbers of the cells, which are their indicator functions, equals
        the winding number of the boundary of the body, which is 1 inside.

        Args:
            data: a mesh in the certificate (``MESH``).
            problem: the problem, which has the polygon.
        """
        h, points, cells, lines = (data[name] for name in ("denominator", "points", "cells", "sides"))
        require(all(0 <= v < len(points) for some in cells + lines for v in some), "a vertex does not exist")
        require(len(lines) == len(problem.sides), "a mesh must have one line of vertices for every side of the polygon")
        mesh = cls(h, points, cells, list(zip(problem.sides, lines, strict=True)))
        require(all(cell.det > 0 for cell in mesh.cells), "a cell is not counter-clockwise")
        directed = [edge for a, b, c in cells for edge in ((a, b), (b, c), (c, a))]
        require(len(set(directed)) == len(directed), "two cells lie on the same side of an edge")
        once = set(directed) - {(b, a) for a, b in directed}
        for part, (side, line) in enumerate(mesh.lines):
            places = [mesh.place(v) for v in line]
            steps = [minus(q, p) for p, q in pairwise(places)]
            fits = all(cross(side.along, step) == 0 < dot(side.along, step) for step in steps)
            fits = fits and (places[:1], places[-1:]) == ([side.start], [side.end])
            require(fits and once >= set(pairwise(line)), f"the mesh does not fit side {part} of the polygon")
        require(len(mesh.boundary) == len(once), "the mesh has a boundary inside or outside the polygon")
        return mesh

    def place(self, vertex: int) -> Vector:
        x, y = self.points[vertex]
        return Q(x, self.h), Q(y, self.h)

    def along(self, edge: tuple[int, int]) -> tuple[int, int]:
        """Return h times the vector from the first to the second vertex of an edge, as a pair of integers."""
        (x, y), (a, b) = (self.points[v] for v in edge)
        return a - x, b - y

    def _cell(self, v: list[int]) -> Cell:
        (a, c), (b, d) = self.along((v[0], v[1])), self.along((v[0], v[2]))
        opposite = [self.nodes_of(e)[1] for e in ((v[1], v[2]), (v[2], v[0]), (v[0], v[1]))]
        return Cell(v, [*v, *opposite], (a, b, c, d), a * d - b * c)

    def middles(self, values: list[int], size: int) -> list[int]:
        """Return twice the values of a piecewise linear function at all nodes: vertices, then midpoints of edges.

        The factor 2 keeps the values at midpoints integers.

        Args:
            values: values at the vertices, ``size`` numbers at each.
        """
        sums = (values[size * a + i] + values[size * b + i] for a, b in self.edges for i in range(size))
        return [*(2 * x for x in values), *sums]

    def refined(self) -> Mesh:
        """Return the mesh in which every cell is divided into four; the nodes of this mesh become vertices."""
        flat = self.middles([x for point in self.points for x in point], 2)
        cells = []
        for cell in self.cells:
            a, b, c, d, e, f = cell.nodes
            cells += [[a, f, e], [f, b, d], [e, d, c], [d, e, f]]
        halved = [[v for e in pairwise(line) for v in self.nodes_of(e)[:2]] + line[-1:] for _, line in self.lines]
        lines = [(side, new) for (side, _), new in zip(self.lines, halved, strict=True)]
        return Mesh(2 * self.h, [list(point) for point in pairs(flat)], cells, lines)

    def nodes_of(self, edge: tuple[int, int]) -> tuple[int, int, int]:
        """Return the numbers of the nodes of an edge: its first vertex, its midpoint and its last vertex."""
        return edge[0], self.node[min(edge), max(edge)], edge[1]

    def images(self, cell: Cell) -> list[Poly]:
        """Return the coordinates x1 and x2 of a point of a cell, as polynomials on the reference triangle."""
        (a, b, c, d), (x, y) = cell.F, self.place(cell.v[0])
        return [constant(x) + X * Q(a, self.h) + Y * Q(b, self.h), constant(y) + X * Q(c, self.h) + Y * Q(d, self.h)]


# Constants that bound the work of loads on the body.


def load_constants(data: Any, problem: Problem) -> tuple[Q, Q]:
    """Return the constants of the loads: C_Ω with ∫ g·v ≤ C_Ω ‖g‖ ‖v‖_V and C_Γ with ∫_{Γ2} g·v ≤ C_Γ ‖g‖ ‖v‖_V.

    These inequalities are proved by a tensor field Φ in the certificate, which is totally symmetric, continuous, and
    linear on the cells of a separate mesh. At every vertex of a cell div Φ(v, v) − A⁻¹(Φv)·(Φv) ≥ μ |v|² must hold for
    all vectors v. On edges outside Γ1, −Φ(ν, v, v) must be at least 0, and at least κ |v|² if the edge is loaded. Then
    C_Ω = μ^{−1/2} and C_Γ = κ^{−1/2}.

    Args:
        data: the object "constants" of the certificate, with the mesh, Φ, μ and κ.
        problem: the problem, which has the viscosity A.
    """
    mesh, mu, kappa, field = Mesh.of(data["mesh"], problem), Q(data["volume"]), Q(data["surface"]), data["field"]
    require(mu > 0 and kappa > 0, "a constant of the body is not positive")
    require(len(field) == len(mesh.points), "the tensor field must have one value for every vertex")
    unit, compliance = Q(1, 1 << data["bits"]), inverse(problem.A)
    for cell in mesh.cells:
        (a, b, c, d), scale = cell.F, unit * mesh.h / cell.det
        first, second, third = (field[v] for v in cell.v)
        dX, dY = ([q - p for p, q in zip(first, other, strict=True)] for other in (second, third))
        divergence = [scale * (d * dX[k] - c * dY[k] + a * dY[k + 1] - b * dX[k + 1]) for k in range(3)]
        for v in cell.v:
            p, q, r, s = (x * unit for x in field[v])
            square = congruent([[p, r, q], [q, s, r]], compliance)  # rows: the stresses Φe_1 and Φe_2
            left = [[divergence[i + j] - square[i][j] - mu * (i == j) for j in (0, 1)] for i in (0, 1)]
            require(semidefinite(left), "the tensor field does not prove the constant of forces in Ω")
    for edge, side in mesh.boundary.items():
        least = kappa * root(dot(side.normal, side.normal)) if side.load else Q(0)
        for v in edge if side.kind != "clamped" else ():
            across = [dot(side.normal, field[v][k : k + 2]) * unit for k in range(3)]
            left = [[-across[i + j] - least * (i == j) for j in (0, 1)] for i in (0, 1)]
            require(semidefinite(left), "the tensor field does not prove the constant of loads on Γ2")
    return root(1 / mu), root(1 / kappa)


# The reference element of the stresses.


class Element:
    """Composite stresses of degree 3 on the reference triangle, as a linear function of 45 degrees of freedom.

    The centre divides the triangle into three subtriangles. The degrees of freedom are, in this order: the tractions on
    the three sides (24 numbers: 4 Bernstein coefficients with 2 components on each side), the coefficients of a force
    f̂ of degree 2 (12 numbers: 6 monomials with 2 components), and 9 free numbers. Each of the three components of the
    stress σ̂ is a cubic polynomial with 10 coefficients on every subtriangle. This class checks that the tractions of
    σ̂ are continuous inside and have the prescribed values on the boundary, and that Div σ̂ + f̂ is the same polynomial
    of degree 1 on all subtriangles.

    Args:
        over: the common denominator of the columns.
        columns: for each degree of freedom the 90 coefficients, times ``over``, of the stress σ̂ for which this degree
            of freedom is 1 and all others are 0.
    """

    def __init__(self, over: int, columns: Sequence[Sequence[int]]) -> None:
        self.over = over
        q = [self._divergence(number, column) for number, column in enumerate(columns)]
        self.rows = [[column[i] for column in columns] for i in range(90)]
        self.unbalanced = [[column[i] for column in q] for i in range(6)]
        self.gram, self.unit = self._products()

    @classmethod
    def of(cls, data: Any) -> Element:
        """Return the reference element that a certificate states; equal elements are checked once."""
        return checked(data["over"], tuple(map(tuple, data["columns"])))

    def _divergence(self, number: int, column: Sequence[int]) -> list[int]:
        """Check the stress of one degree of freedom; refuse the element if its traction or divergence is wrong.

        Args:
            number: the number of the degree of freedom, from 0 to 44.
            column: the 90 coefficients of the stress of this degree of freedom, times ``over``.

        Returns:
            Both components of Div σ̂ + f̂, a polynomial of degree 1, as coefficients of the monomials ``LINEAR``.
        """
        side, place, d = number // 8, number // 2 % 4, number % 2
        stress = [[column[30 * c + 10 * i :][:10] for c in range(3)] for i in range(3)]
        given, force = bernstein(3, X)[place] * self.over, [Poly(), Poly()]
        if 24 <= number < 36:
            force[d] = Poly({SQUARE[number // 2 - 12]: Q(self.over)})
        divergences = []
        for i in range(3):
            first, second = CORNERS[(i + 1) % 3], CORNERS[(i + 2) % 3]
            wanted = [given if (i, c) == (side, d) else Poly() for c in (0, 1)]
            right = tractions(stress[i], first, second) == wanted
            require(right, "tractions of the reference element differ from its inputs")
            met = [tractions(stress[(i + n) % 3], CORNERS[i], CENTRE) for n in (1, 2)]
            require(met[0] == met[1], "tractions inside the reference element jump")
            x, y, z = (combination(PLAIN, values) for values in stress[i])
            divergences.append([x.slope(0) + z.slope(1) + force[0], z.slope(0) + y.slope(1) + force[1]])
        one = divergences[0]
        linear = all(sum(key) <= 1 for p in one for key in p)
        require(linear and divergences == [one] * 3, "the reference element does not balance")
        return [int(p.get(key, 0)) for p in one for key in LINEAR]

    def _products(self) -> tuple[list[list[int]], int]:
        """Return the integrals of products of two cubic monomials over each subtriangle, as integers and a denominator.

        The integers have the shape (30, 10). Row axis: subtriangle (3) and first monomial (10). Column axis: second
        monomial.
        """
        found = []
        for i in range(3):
            (p, q), (r, s) = CORNERS[(i + 1) % 3], CORNERS[(i + 2) % 3]
            third = [constant(o) + X * (e - o) + Y * (m - o) for o, e, m in zip((p, q), (r, s), CENTRE, strict=True)]
            shapes = [p(*third) for p in PLAIN]
            found += [[on_triangle(one * other) / 3 for one in shapes] for other in shapes]
        return common(found)

    def dual(self, field: list[int]) -> list[int]:
        """Return the integrals of a stress component times each of the 10 cubic monomials over each subtriangle.

        They are multiplied by the common denominator ``unit`` of the integrals of two monomials, so that integer
        coefficients give integers. The scalar product with the coefficients of another component is then ``unit`` times
        the integral of the product of both.

        Args:
            field: the 30 coefficients of the component, 10 on each subtriangle, for the monomials ``CUBIC``.

        Returns:
            The 30 numbers, in the order of ``field``.
        """
        return [dot(row, field[n - n % 10 : n - n % 10 + 10]) for n, row in enumerate(self.gram)]


@cache
def checked(over: int, columns: tuple[tuple[int, ...], ...]) -> Element:
    """Return ``Element(over, columns)``, whose constructor refuses wrong columns; results are cached."""
    return Element(over, columns)


def combination(polynomials: Iterable[Poly], factors: Iterable[Any]) -> Poly:
    return total(p * x for p, x in zip(polynomials, factors, strict=True) if x)


@cache
def on_segment(a: Vector, b: Vector) -> list[Poly]:
    """Return the ten monomials of degree at most 3, at the points a + X (b − a), as polynomials in X."""
    return [p(*between(a, b)) for p in PLAIN]


def tractions(stress: Sequence[Sequence[Any]], a: Vector, b: Vector) -> list[Poly]:
    """Return the traction σN of a stress on the segment from a to b, as two polynomials in X.

    N is the normal to the right of the segment, with the length of the segment.

    Args:
        stress: the components 11, 22, 12 of the stress, each as the ten coefficients of a cubic polynomial in x1, x2.
        a, b: the ends of the segment.
    """
    (n, m), (x, y, z) = (b[1] - a[1], a[0] - b[0]), (combination(on_segment(a, b), values) for values in stress)
    return [x * n + z * m, z * n + y * m]


# Stresses, and the loads that they balance.


class Loads:
    """The approximate loads f̃ that the stresses of a certificate balance, and bounds of their difference from f.

    In time f̃_0 is the parabola through the body force f_0 at the ends and in the middle of a time interval. On a cell,
    only the terms of degree at most 2 in the coordinates of the reference triangle are used. Twice the area of the cell
    times f̃_0 is rounded to multiples of 1/unit.

    Args:
        problem: the problem, which has the loads.
        mesh: the mesh of the stresses.
        bits: the number of binary digits of the unit, unit = 2^bits.
    """

    def __init__(self, problem: Problem, mesh: Mesh, bits: int) -> None:
        self.problem, self.mesh, self.unit = problem, mesh, 1 << bits
        self.cells = [(cell, mesh.images(cell)) for cell in mesh.cells] if any(problem.force) else []
        squares = {e: Q(dot(mesh.along(e), mesh.along(e)), mesh.h**2) for e, side in mesh.boundary.items() if side.load}
        self.lengths = {e: root(square, above=False) for e, square in squares.items()}

    def controls(self, a: Q, b: Q) -> list[list[Poly]]:
        """Return the Bernstein coefficients of the parabola in time through f_0 at a, (a + b)/2 and b.

        Each coefficient has two components, polynomials in x1 and x2.
        """
        first, middle, last = ([p(X, Y, constant(t)) for p in self.problem.force] for t in (a, (a + b) / 2, b))
        ends = [p + q for p, q in zip(first, last, strict=True)]
        return [first, [m * 2 - p * Q(1, 2) for m, p in zip(middle, ends, strict=True)], last]

    def on_cells(self, control: list[Poly]) -> list[list[int]]:
        """Return the approximate body force f̃_0 on every cell, times twice its area and unit = 2^bits, as integers.

        Args:
            control: a Bernstein coefficient of f_0 in time, from ``controls``.

        Returns:
            For each cell twelve integers: for each of the six monomials ``SQUARE`` in the coordinates of the reference
            triangle, the coefficients of both components. If f_0 = 0, the result is empty.
        """
        found = []
        for cell, images in self.cells:
            local = [p(*images) for p in control]
            scale = Q(cell.det * self.unit, self.mesh.h**2)
            found.append([round(p.get(key, 0) * scale) for key in SQUARE for p in local])
        return found

    def missed_inside(self, a: Q, b: Q) -> Q:
        """Return an upper bound of the root mean square of ‖f_0 − f̃_0‖ over a ≤ t ≤ b.

        The difference f_0 − f̃_0 is the part of the body force that the approximate loads do not represent.
        """
        # Rounding changes each of the six coefficients by at most 1/2, so a component changes by at most 3, and both
        # together by 18^{1/2}. These are changes of twice the area of the cell times the force.
        rounded = root(sum((up(Q(9 * self.mesh.h**2, cell.det)) for cell, _ in self.cells), Q(0))) / self.unit
        if all(i + j <= 2 >= k for f in self.problem.force for i, j, k in f):
            return rounded
        square = Q(0)
        for (cell, images), d in product(self.cells, (0, 1)):
            parabola = total(f[d](*images) * p for f, p in zip(self.controls(a, b), bernstein(2, UNIT_S), strict=True))
            kept = Poly({key: x for key, x in parabola.items() if key[0] + key[1] <= 2})
            rest = self.problem.force[d](*images, clock(a, b)) - kept
            square += up(on_triangle(rest * rest) * Q(cell.det, self.mesh.h**2))
        return root(square) + rounded

    def missed_outside(self, a: Q, b: Q, given: Sequence[Tractions]) -> Q:
        """Return an upper bound of the root mean square of ‖f_2 − σ̃ν‖_{L²(Γ2)} over a ≤ t ≤ b.

        The difference f_2 − σ̃ν is the part of the prescribed traction that the stress does not balance.

        Args:
            a, b: the ends of the time interval.
            given: for each of the three Bernstein coefficients in time, the tractions of the stress σ̃ on the edges,
                as ``Stresses.tractions`` returns them: unit · h σ̃N. N is the normal with the length of the edge, h the
                common denominator of the coordinates, and unit = 2^bits.
        """
        found, shapes = Q(0), [p * q for p, q in product(bernstein(2, UNIT_S), bernstein(3, UNIT_X))]
        for (edge, length), d in product(self.lengths.items(), (0, 1)):
            coefficients = [pair[d] for control in given for pair in control[edge]]
            stress = combination(shapes, coefficients) * Q(-1, self.unit * self.mesh.h)
            line = [p(UNIT_X) for p in between(*map(self.mesh.place, edge))]
            load = [term(*line, clock(a, b)) for term in self.mesh.boundary[edge].load[d]]
            slack = sum((term.size() for term in load), Q(0)) / (1 << GRID)  # as the length is rounded down
            longer = [Term(term.p * length, term.g, term.q) for term in load]
            mean_square = missed([*longer, Term(stress, Poly(), 0)], HALVINGS)
            found += up((root(mean_square) + slack) ** 2 / length)
        return root(found)


def clock(a: Q, b: Q) -> Poly:
    """Return the time as a linear polynomial in S, which is a at S = −1 and b at S = 1."""
    return ONE * ((a + b) / 2) + S * ((b - a) / 2)


def missed(terms: list[Term], halvings: int) -> Q:
    """Return an upper bound of the mean square of a sum of terms over the square |X|, |S| ≤ 1.

    The sum is the part of a load that a stress does not balance. A term p · g_+^q has a kink if g may change its sign
    in the square. If no term has a kink, the result is the exact mean square. Otherwise the square is divided into
    four, up to ``halvings`` times, and the remaining terms with a kink are bounded by their size.

    Args:
        terms: the terms, functions of the position X on an edge and the time S, both scaled to [−1, 1].
        halvings: the largest number of divisions.
    """
    plain = [term.plain() for term in terms]
    smooth = total(p for p in plain if p is not None)
    kinked = [term for term, p in zip(terms, plain, strict=True) if p is None]
    if not kinked:
        return mean(smooth * smooth)
    if not halvings:
        return up(sum((term.size() for term in kinked), smooth.size()) ** 2)
    half = [[ONE * Q(s, 2) + p * Q(1, 2) for s in (-1, 1)] for p in (X, S)]
    every = [Term(smooth, Poly(), 0), *kinked]
    return up(sum((missed([term(x, Y, s) for term in every], halvings - 1) for x, s in product(*half)), Q(0)) / 4)


MODES = ((1, 1, 1, 1), (-3, -1, 1, 3), (1, -1, -1, 1), (-1, 3, -3, 1))
"""Four cubic polynomials on an edge, by their Bernstein coefficients, in which tractions are stored.

They are orthogonal. Only the first two contribute to the force and the moment on the edge.
"""
Tractions = dict[tuple[int, int], list[tuple[int, int]]]
"""The tractions on edges: for each edge, given by two vertices, four Bernstein coefficients with two components."""
Field = list[list[int]]
"""A stress on the reference triangle for each cell: three components with 30 coefficients each, in one list."""


class Stresses:
    """The stresses σ̃ of a certificate on one mesh, which are stored as integers in units of 2^{−bits}.

    Args:
        mesh: the mesh of the stresses.
        data: the object "stress" of the certificate, with the units.
        element: the reference element.
    """

    def __init__(self, mesh: Mesh, data: Any, element: Element) -> None:
        self.mesh, self.element = mesh, element
        self.bits, self.coarse = data["bits"], data["coarse"]
        self.unit = mesh.h * element.over << self.bits
        sides = mesh.boundary
        self.contact = [e for e, side in sides.items() if side.kind == "contact"]
        self.loaded = [e for e, side in sides.items() if side.load]
        inside = [e for e in mesh.edges if e not in sides and e[::-1] not in sides]
        self.free = inside + [e for e, side in sides.items() if side.kind == "clamped"]
        self.nothing = {e: [(0, 0)] * 4 for e in sides}

    def tractions(self, numbers: list[int]) -> tuple[Tractions, list[list[int]]]:
        """Read the tractions of a stress at one time, and refuse a stress that pulls on the contact boundary.

        N is the normal to the right of an edge, with the length of the edge. All numbers are in units of 2^{−bits}.

        Args:
            numbers: the integers of all edges, from the certificate, in this order. Four for each edge of Γ3: the
                Bernstein coefficients of σ̃_ν, with the traction σ̃N = σ̃_ν N. Eight for each edge with a load f_2: the
                Bernstein coefficients of σ̃N, both components of each. Eight for each inner or clamped edge: for each
                of the four ``MODES`` its factor in both components of σ̃N. The last four of these, the factors of the
                last two modes, are in units of 2^{coarse − bits}. Edges that are free of load have no numbers.

        Returns:
            The Bernstein coefficients of h σ̃N on all edges, as integers in units of 2^{−bits}, with the common
            denominator h of the coordinates; and those of σ̃_ν on Γ3, four for each edge.
        """
        contact, loaded, free = 4 * len(self.contact), 8 * len(self.loaded), 8 * len(self.free)
        require(len(numbers) == contact + loaded + free, "tractions have another size")
        found, h = dict(self.nothing), self.mesh.h
        normal = [numbers[i : i + 4] for i in range(0, contact, 4)]
        for e, tau in zip(self.contact, normal, strict=True):
            require(max(tau) <= 0, "σ̃_ν > 0 on Γ3: the stress is not admissible")
            x, y = self.mesh.along(e)
            found[e] = [(y * c, -x * c) for c in tau]
        for i, e in enumerate(self.loaded):
            start = contact + 8 * i
            found[e] = pairs([h * x for x in numbers[start : start + 8]])
        for i, e in enumerate(self.free):
            start = contact + loaded + 8 * i
            eight = [h * x << self.coarse * (n > 3) for n, x in enumerate(numbers[start : start + 8])]
            found[e] = [(dot(mode, eight[::2]), dot(mode, eight[1::2])) for mode in zip(*MODES, strict=True)]
        return found, normal

    def field(self, edges: Tractions, numbers: list[int], force: list[list[int]]) -> tuple[Field, Q]:
        """Compute the stress σ̃ on every cell from its tractions, its nine inner numbers and the body force.

        The inner numbers are the nine free numbers among the degrees of freedom of ``Element``.

        Args:
            edges: the tractions on all edges, as ``tractions`` returns them.
            numbers: the inner numbers of all cells, nine for each cell, from the certificate.
            force: the twelve numbers of the body force of each cell, as ``Loads.on_cells`` returns them; empty if there
                is no body force.

        Returns:
            First, for each cell the 90 coefficients of a stress σ̂ on the reference triangle, as integers, with
            σ̃ = F σ̂ Fᵀ h/(unit (det F)²). Here F is the matrix of the cell (``Cell``), h the common denominator of the
            coordinates, and unit = h · over · 2^bits with the denominator ``over`` of the element. Second, an upper
            bound of the norm ‖Div σ̃ + f̃_0‖ of the unbalanced force.
        """
        require(len(numbers) == 9 * len(self.mesh.cells), "the inner numbers have another size")
        found, square = [], 0
        for n, cell in enumerate(self.mesh.cells):
            a, b, c, d = cell.F
            inner = [self.mesh.h * x << self.coarse for x in numbers[9 * n : 9 * n + 9]]
            inputs = self._pulled(cell, edges, force[n] if force else [0] * 12) + inner
            found.append(applied(self.element.rows, inputs))
            q = applied(self.element.unbalanced, inputs)
            twice = sum(linear_square(mixed(row, (q[:3], q[3:]))) for row in ((a, b), (c, d)))
            square += (twice << GRID) // (24 * cell.det**3)
        return found, root(Q(square + len(found), 1 << GRID) * Q(self.mesh.h, self.unit) ** 2)

    def _pulled(self, cell: Cell, edges: Tractions, force: list[int]) -> list[int]:
        """Return the tractions and forces of a cell, transformed to the reference triangle."""
        (a, b, c, d), (i, j, k), given = cell.F, cell.v, []
        for e in ((j, k), (k, i), (i, j)):
            given += edges[e] if e in edges else [(-x, -y) for x, y in reversed(edges[e[::-1]])]
        given += pairs([self.mesh.h * x for x in force])
        return [x for p, q in given for x in (d * p - b * q, a * q - c * p)]


def linear_square(p: Sequence[int]) -> int:
    """Return 24 times the integral of (p_0 + p_1 X + p_2 Y)² over the reference triangle, which is an integer."""
    ends = p[0], p[0] + p[1], p[0] + p[2]
    return dot(ends, ends) + sum(ends) ** 2


# The error bound, computed from the witnesses.


def strains(cell: Cell, v: Sequence[int]) -> list[list[int]]:
    """Return the strain of a quadratic displacement at the three vertices of a cell, multiplied by (det F)/(2h).

    h is the common denominator of the coordinates (``Mesh``), not the mesh size. With this factor integers v give
    integers.

    Args:
        cell: the cell.
        v: the Bernstein coefficients of the displacement at all nodes, two components each.

    Returns:
        For each vertex of the cell the components 11, 22 and 2·12.
    """
    a, b, c, d = cell.F
    n, found = cell.nodes, []
    for o, e, m in ((n[0], n[5], n[4]), (n[5], n[1], n[3]), (n[4], n[3], n[2])):  # three nodes around each vertex
        p, q = v[2 * e] - v[2 * o], v[2 * m] - v[2 * o]
        r, s = v[2 * e + 1] - v[2 * o + 1], v[2 * m + 1] - v[2 * o + 1]
        found.append([d * p - c * q, a * s - b * r, a * q - b * p + d * r - c * s])
    return found


def law_on(cell: Cell, laws: list[list[int]], u: Sequence[int], step: Sequence[int]) -> list[list[int]]:
    """Return the stress τ = A ε(v) + G ε(u) on a cell, transformed to the reference triangle: F⁻¹ τ F⁻ᵀ (det F)³/h.

    Here F is the matrix of the cell, and h the common denominator of the coordinates (``Mesh``). With this factor
    integers give integers.

    Args:
        cell: the cell.
        laws: the rows of A, then of G, as integers. For the residual of the law they are scaled differently, because v
            is a velocity times the length of a time interval.
        u: the displacement u, by integer Bernstein coefficients at all nodes, two components each.
        step: the displacement v, in the same form.

    Returns:
        For each of the components 11, 22 and 12 the coefficients of the monomials ``LINEAR``.
    """
    a, b, c, d = cell.F
    rates = zip(strains(cell, step), strains(cell, u), strict=True)
    stresses = [mixed((2, 2), (applied(laws[:3], rate), applied(laws[3:], e))) for rate, e in rates]
    p, q, r = (applied(voigt(d, -b, -c, a), stress) for stress in stresses)
    return [[x, y - x, z - x] for x, y, z in zip(p, q, r, strict=True)]


def less(field: list[int], linear: list[list[int]]) -> list[int]:
    """Return a stress on the reference triangle minus a polynomial of degree 1.

    Args:
        field: the stress, three components with 30 coefficients each, 10 on each subtriangle.
        linear: for each component the coefficients of the polynomial, which is the same on all subtriangles.
    """
    found = list(field)
    for start, (i, three) in product((0, 10, 20), enumerate(linear)):
        for key, x in zip(LINEAR, three, strict=True):
            found[30 * i + start + CUBIC.index(key)] -= x
    return found


class Growth:
    """Computes how the bound y of the error ‖u − ũ‖_V grows over a time interval.

    A call has the arguments y, k, M, contact and loads: the bound y at the start, the length k of the time interval,
    the integral M = ∫∫ ρ ρᵀ over the body and the interval of the residual ρ = σ̃ − Aε(ũ̇) − Gε(ũ) of the law, the work
    of contact c = ∫∫ σ̃_ν ũ_ν, and the integral l of the dual norm of the unbalanced loads. It returns two bounds. The
    bound at the end of the interval is the least value, for θ = 0 or m and some β > 0, of

        (e^{−2θk} y² + 2c + ½ tr(BHBM))^{1/2} + (β² tr(BABM) ∫_0^k e^{−2θs} ds)^{1/2} + l,

    where H = G − θA and B = (H + βA)⁻¹. The bound at all times of the interval has y² in place of e^{−2θk} y². Both are
    rounded up.

    Args:
        problem: the problem, which has the tensors A and G.
        m: a number m ≥ 0 such that G − mA is positive semidefinite; the rate at which the elasticity damps the error.

    Raises:
        RefusedError: m is negative, or G − mA is not positive semidefinite.
    """

    def __init__(self, problem: Problem, m: Q) -> None:
        require(m >= 0, "m is negative")
        require(semidefinite(combined(problem.G, problem.A, -m)), "G − mA is not positive semidefinite")
        self.A, self.G, self.m = problem.A, problem.G, m

    def __call__(self, y: Q, k: Q, M: Matrix, contact: Q, loads: Q) -> tuple[Q, Q]:
        found = [bounds for theta in {Q(0), self.m} for bounds in self._bounds(theta, y, k, M, contact, loads)]
        return min(at_b for at_b, _ in found), min(inside for _, inside in found)

    def _bounds(self, theta: Q, y: Q, k: Q, M: Matrix, contact: Q, loads: Q) -> Iterable[tuple[Q, Q]]:
        """Yield pairs of bounds for one rate of decay θ and several values of a parameter β > 0.

        The matrices are H = G − θA and W = H(H + βA)⁻¹. Every β > 0 gives a valid bound. The first β gives W close to
        0. Each further β is computed from the bound before it.
        """
        H, faded, mean = combined(self.G, self.A, -theta), decay(2 * theta * k), up(k * mean_decay(2 * theta * k))
        for beta in (Q(1 << GRID), 1 / k / (1 << 20)):
            for _ in range(4):
                inverted = inverse(combined(H, self.A, beta))
                of_H, of_A = (traced(congruent(inverted, one), M) for one in (H, self.A))
                taken, left = 2 * contact + of_H / 2, beta**2 * of_A
                first, second = root(up(faded * y * y + taken)), root(up(mean * left)) + loads
                yield first + second, root(up(y * y + taken)) + second
                beta = Q(round(root(up(left / k)) / (2 * first) * (1 << 40)) + 1, 1 << 40)


def traced(a: Matrix, b: Matrix) -> Q:
    """Return the trace Σ a_ij b_ij of the product of two symmetric matrices."""
    return sum(map(dot, a, b), Q(0))


@dataclass(frozen=True)
class Piece:
    """The displacement ũ between two knots a < b, a parabola in time.

    Attributes:
        a, b: the knots.
        values: the three Bernstein coefficients in time, times four, each as a list of coefficients in space, x and y
            in turn.
    """

    a: Q
    b: Q
    values: list[list[int]]

    @property
    def steps(self) -> list[list[int]]:
        """The three Bernstein coefficients in time of (b − a) ũ̇, the velocity times the length of the interval.

        They are multiplied by four, as ``values``.
        """
        return [mixed(weights, self.values) for weights in ((-2, 2, 0), (-1, 0, 1), (0, -2, 2))]


def pieces(nodes: list[list[int]], T: Q) -> Iterable[Piece]:
    """Yield the pieces of ũ, a quadratic spline in time that rounds the corners of a polygon in time.

    The polygon is linear between the times 0, k, …, T. Around each time jk between 0 and T, ũ is the parabola on [jk −
    k/2, jk + k/2] that touches the polygon at both ends. On [0, k/2] and on [T − k/2, T], ũ is the polygon itself.

    Args:
        nodes: the values of the polygon at the times 0, k, …, T: one list of integers (coefficients in space) for each.
        T: the final time.

    Yields:
        The pieces between the times 0, k/2, 3k/2, …, T − k/2, T. Their values are four times the Bernstein coefficients
        of ũ in time; this factor makes them integers.
    """
    k = T / (len(nodes) - 1)
    knots = [Q(0), *(k * Q(2 * j + 1, 2) for j in range(len(nodes) - 1)), T]
    middles = [mixed((2, 2), pair) for pair in pairwise(nodes)]
    places = [mixed((4,), nodes[:1]), *middles, mixed((4,), nodes[-1:])]
    controls = [mixed((3, 1), nodes[:2]), *(mixed((4,), [v]) for v in nodes[1:-1]), mixed((1, 3), nodes[-2:])]
    for (a, b), (start, end), control in zip(pairwise(knots), pairwise(places), controls, strict=True):
        yield Piece(a, b, [start, control, end])


class Computed:
    """The computed displacement u_h, piecewise linear in space and time, whose error is bounded.

    The certificate gives its values as doubles. They are stored as integers over a power of 2, at the nodes of the mesh
    of the more accurate displacement ũ of the certificate, so that ũ − u_h can be computed.

    Args:
        data: the values at the vertices, x and y in turn, for each of equally spaced times from 0 to the final time T.
        mesh: the mesh of u_h.
        refinements: how often this mesh is refined for ũ.
        problem: the problem, which has the final time.
    """

    def __init__(self, data: Any, mesh: Mesh, refinements: int, problem: Problem) -> None:
        require(all(len(u) == 2 * len(mesh.points) for u in data), "u_h has another size")
        rows, denominator = common([[Q(x) for x in u] for u in data])
        self.T, self.bits = problem.T, denominator.bit_length() + refinements
        clamped = [v for edge, side in mesh.boundary.items() for v in edge if side.kind == "clamped"]
        require(not any(u[2 * v] or u[2 * v + 1] for u in rows for v in clamped), "u_h does not vanish on Γ1")
        for _ in range(refinements):
            rows, mesh = [mesh.middles(u, 2) for u in rows], mesh.refined()
        self.values = [mesh.middles(u, 2) for u in rows]

    def at(self, time: Q) -> tuple[list[int], int]:
        """Return u_h at a time: integers v and a denominator, so that u_h is v/(denominator · 2^bits).

        There is a v for x and for y at every node of the mesh of ũ, the more accurate displacement. This mesh is the
        mesh of u_h or a refinement of it. The attribute ``bits`` is the same for all times.
        """
        place = time / self.T * (len(self.values) - 1)
        low = min(int(place), len(self.values) - 2)
        b = (place - low).numerator
        return mixed((place.denominator - b, b), self.values[low : low + 2]), place.denominator


@dataclass(frozen=True)
class Enclosure:
    """The interval that a certificate proves.

    Attributes:
        cells: the number of cells of the mesh of u_h.
        h: the mesh size √(2|Ω|/cells).
        low, high: the bounds of the largest error max ‖u − u_h‖_V.
        last: an upper bound of ‖u(T) − ũ(T)‖_V at the final time T, where ũ is the more accurate displacement of the
            certificate.
    """

    cells: int
    h: Q
    low: Q
    high: Q
    last: Q


class Certificate:
    """A certificate: a problem, a mesh, a computed displacement u_h and the witnesses, from which bounds follow.

    The witnesses are a more accurate displacement ũ, a stress σ̃ that nearly balances the loads, and a tensor field Φ
    that proves the constants of the loads (``load_constants``).

    Args:
        data: the content of the certificate file, as ``load`` returns it.

    Raises:
        RefusedError: the format is wrong, or a required property does not hold.
    """

    def __init__(self, data: Any) -> None:
        conform(data, CERTIFICATE, "certificate")
        problem = self.problem = Problem(data["problem"])
        coarse = mesh = Mesh.of(data["mesh"], problem)
        self.nodes, self.bits = summed(data["displacement"]["nodes"]), data["displacement"]["bits"]
        # A mesh has more nodes than cells. So a number of refinements that does not fit to ũ is refused before a huge
        # mesh is made.
        require(len(mesh.cells) << 2 * data["refinements"] <= len(self.nodes[0]), "ũ has another size")
        for _ in range(data["refinements"]):
            mesh = mesh.refined()
        self.cells, self.mesh = len(coarse.cells), mesh
        self.computed = Computed(data["computed"], coarse, data["refinements"], problem)
        self.laws, self.over = common([*problem.A, *problem.G])
        self._check_membership()
        self.growth, self.element = Growth(problem, Q(data["m"])), Element.of(data["element"])
        self.stresses = Stresses(mesh, data["stress"], self.element)
        numbers = [summed(data["stress"][name]) for name in ("tractions", "inner")]
        sizes = {len(rows) for rows in numbers}
        require(sizes == {2 * len(self.nodes) + 1}, "there must be one stress for every coefficient in time")
        self.numbers = list(zip(*numbers, strict=True))
        self.volume, self.surface = load_constants(data["constants"], problem)

    def _check_membership(self) -> None:
        """Refuse a displacement ũ that may violate a constraint.

        All Bernstein coefficients must be 0 on Γ1, and their normal components must not be positive on Γ3.
        """
        size = 2 * self.mesh.nodes
        require(all(len(v) == size for v in self.nodes), "ũ has another size")
        for edge, side in self.mesh.boundary.items():
            places = [v[2 * n : 2 * n + 2] for v in self.nodes for n in self.mesh.nodes_of(edge)]
            require(side.kind != "clamped" or not any(map(any, places)), "ũ does not vanish on Γ1")
            apart = side.kind != "contact" or all(dot(place, side.normal) <= 0 for place in places)
            require(apart, "ũ_ν > 0 on Γ3: ũ is not in K")

    def check(self) -> Enclosure:
        """Return the interval that is proved to contain the largest error max ‖u − u_h‖_V over time.

        A bound y of ‖u − ũ‖_V grows from one time interval to the next (``Growth``). With it, the distance ‖ũ − u_h‖_V
        gives both ends of the interval, ‖ũ − u_h‖_V ± y.

        Raises:
            RefusedError: the stress is not admissible, or another required property does not hold.
        """
        y, loads = up(self._start()), Loads(self.problem, self.mesh, self.stresses.bits)
        low, high = Q(0), y + root(self._distance(mixed((4,), self.nodes[:1]), 2, Q(0))[1])
        known: list[Any] = []
        for j, piece in enumerate(pieces(self.nodes, self.problem.T)):
            controls = list(zip(self.numbers[2 * j : 2 * j + 3], loads.controls(piece.a, piece.b), strict=True))
            known = known[-1:] + [self._stress(*one, loads) for one in controls[len(known[-1:]) :]]
            edges, normals, fields, unbalanced = zip(*known, strict=True)
            k, inside = piece.b - piece.a, loads.missed_inside(piece.a, piece.b) + sum(unbalanced) / 3
            lost = self.volume * inside + self.surface * loads.missed_outside(piece.a, piece.b, edges)
            y, largest = self.growth(y, k, self._residual(piece, fields), self._contact(piece, normals), up(k * lost))
            distances = list(self._distances(piece))
            low = max(low, root(distances[-1][0], above=False) - y)
            high = max(high, largest + root(max(above for _, above in distances)))
        require(high < 10**DIGITS, "the bound of the error is too large to be printed")
        return Enclosure(self.cells, root(self.problem.twice_area / self.cells), low, high, y)

    def _stress(self, numbers: tuple[list[int], list[int]], control: list[Poly], loads: Loads) -> tuple[Any, ...]:
        """Compute one Bernstein coefficient in time of the stress σ̃, from its numbers in the certificate.

        Returns:
            The tractions h σ̃N, the normal stress σ̃_ν on Γ3, the stress on the cells, and a bound of ‖Div σ̃ + f̃_0‖.
        """
        edges, normal = self.stresses.tractions(numbers[0])
        return edges, normal, *self.stresses.field(edges, numbers[1], loads.on_cells(control))

    def _residual(self, piece: Piece, fields: Sequence[Field]) -> Matrix:
        """Return an upper bound of the 3 × 3 matrix ∫∫ ρ ρᵀ of the residual ρ = σ̃ − Aε(ũ̇) − Gε(ũ) on a time interval.

        The bound minus the matrix is positive semidefinite. On a cell ρ = F R Fᵀ h/(unit (det F)³), where the
        components of R are polynomials on the reference triangle. The entries of each cell are rounded down by less
        than 1. The 3 × 3 matrix of these rounding errors is at most 3 times the identity, which is added.
        """
        k, total = piece.b - piece.a, [[0] * 3 for _ in range(3)]
        below = (k.numerator * self.over) << self.bits + 2
        unit = math.lcm(self.stresses.unit, below)
        factors = [k.denominator] * 3 + [k.numerator] * 3
        laws = [[x * n * (unit // below) for x in row] for row, n in zip(self.laws, factors, strict=True)]
        every = list(zip(fields, piece.values, piece.steps, strict=True))
        for n, cell in enumerate(self.mesh.cells):
            of_stress = cell.det * (unit // self.stresses.unit)
            R = [less(mixed((of_stress,), field[n : n + 1]), law_on(cell, laws, *of_u)) for field, *of_u in every]
            for i, row in enumerate(congruent(voigt(*cell.F), self._products(R))):
                total[i] = [x + (y << GRID) // cell.det**5 for x, y in zip(total[i], row, strict=True)]
        lacking, scale = 3 * len(self.mesh.cells), k / (30 * self.element.unit * unit**2 << GRID)
        return [[(x + lacking * (i == j)) * scale for j, x in enumerate(row)] for i, row in enumerate(total)]

    def _products(self, R: list[list[int]]) -> list[list[int]]:
        """Return the mean in time of ∫ R Rᵀ over the reference triangle, times 30 and times ``unit`` of the element.

        Args:
            R: the transformed residual, for each of the three Bernstein coefficients in time.
        """
        found = [[0] * 3 for _ in range(3)]
        for own, shares in zip(R, SHARES, strict=True):
            both = mixed(shares, R)
            duals = [self.element.dual(both[j : j + 30]) for j in (0, 30, 60)]
            for i, j in product(range(3), repeat=2):
                found[i][j] += dot(own[30 * i : 30 * i + 30], duals[j])
        return found

    def _contact(self, piece: Piece, normals: Sequence[list[list[int]]]) -> Q:
        """Return the work of contact ∫∫_{Γ3} σ̃_ν ũ_ν on a time interval."""
        total = 0
        for i, edge in enumerate(self.stresses.contact):
            x, y = self.mesh.along(edge)
            for s, r in product(range(3), repeat=2):
                u = [(piece.values[r][2 * n], piece.values[r][2 * n + 1]) for n in self.mesh.nodes_of(edge)]
                # The integral ∫ B_p B_q of Bernstein polynomials of degrees 3 and 2 is C(3, p) C(2, q)/C(5, p + q)/6,
                # an integer over 60.
                total += SHARES[s][r] * sum(
                    tau * (y * v - x * w) * (math.comb(3, p) * math.comb(2, q) * 10 // math.comb(5, p + q))
                    for (p, tau), (q, (v, w)) in product(enumerate(normals[s][i]), enumerate(u))
                )
        found = (piece.b - piece.a) * Q(total, 30 * 60 * self.mesh.h << self.stresses.bits + self.bits + 2)
        require(found >= 0, "the work of contact is negative")
        return found

    def _distance(self, v: Sequence[int], more: int, time: Q) -> tuple[Q, Q]:
        """Return a lower and an upper bound of the squared distance ‖v − u_h(time)‖²_V of a displacement v from u_h.

        Args:
            v: the integers v for which the displacement has the Bernstein coefficients v/2^{bits + more}.
            more: the number of binary digits of v in addition to the digits of ũ.
            time: the time.
        """
        u, over = self.computed.at(time)
        bits = max(self.bits + more, self.computed.bits)
        mine, theirs = over << bits - self.bits - more, 1 << bits - self.computed.bits
        w, total = mixed((mine, -theirs), (v, u)), 0
        for cell in self.mesh.cells:
            e = strains(cell, w)
            every = [*e, mixed((1, 1, 1), e)]
            total += (sum(dot(one, applied(self.laws[:3], one)) for one in every) << GRID) // cell.det
        scale = Q(1, 6 * self.over * over**2 << 2 * bits + GRID)
        return total * scale, (total + len(self.mesh.cells)) * scale

    def _distances(self, piece: Piece) -> Iterable[tuple[Q, Q]]:
        """Yield bounds of ‖ũ − u_h‖²_V at five control points of a time interval, the last of which is its end.

        The interval is halved, so that u_h is linear in time on each half. There ũ − u_h is a parabola, and its squared
        norm is at most the largest value at a control point, because the square is convex. If u_h has a node
        elsewhere than in the middle, the certificate is refused.
        """
        quarter = (piece.b - piece.a) / 4
        for t in (piece.a, piece.a + 2 * quarter):
            first, last = ((len(self.computed.values) - 1) * x / self.problem.T for x in (t, t + 2 * quarter))
            require(last <= math.floor(first) + 1, "u_h has a node inside half a piece")
        for n, weights in enumerate(((4, 0, 0), (2, 2, 0), (1, 2, 1), (0, 2, 2), (0, 0, 4))):
            yield self._distance(mixed(weights, piece.values), 4, piece.a + n * quarter)

    def _start(self) -> Q:
        """Return an upper bound of the initial error ‖u_0 − ũ(0)‖_V."""
        total, mesh, (u, v) = Q(0), self.mesh, self.problem.start
        exact = [u.slope(0), v.slope(1), u.slope(1) + v.slope(0)]
        for cell in mesh.cells:
            p, q, r = strains(cell, self.nodes[0])
            unit, rest = Q(2 * mesh.h, cell.det << self.bits), []
            for e, x, y, z in zip(exact, p, q, r, strict=True):
                rest.append(e(*mesh.images(cell)) - (ONE * x + X * (y - x) + Y * (z - x)) * unit)
            products = [[on_triangle(e * f) for f in rest] for e in rest]
            total += up(traced(self.problem.A, products) * Q(cell.det, mesh.h**2))
        return root(total)


def voigt(a: int, b: int, c: int, d: int) -> list[list[int]]:
    """Return the matrix of σ ↦ F σ Fᵀ in Voigt's components (11, 22, 12) of stresses.

    Args:
        a, b, c, d: the entries of the matrix F, row by row.
    """
    return [[a * a, b * b, 2 * a * b], [c * c, d * d, 2 * c * d], [a * c, b * d, a * d + b * c]]


def summed(rows: list[list[int]]) -> list[list[int]]:
    """Return the rows of integers whose second differences in time are given, as they are stored in the certificate."""
    require(all(len(row) == len(rows[0]) for row in rows), "rows in time must have equal lengths")
    columns = [accumulate(accumulate(column)) for column in zip(*rows, strict=True)]
    return [list(row) for row in zip(*columns, strict=True)]


def order(coarse: Enclosure, fine: Enclosure) -> tuple[Q, Q] | None:
    """Return an interval that contains the order of convergence log(E/E')/log(h/h') of the errors E, E' on two meshes.

    If an error may be 0, or the fine mesh is not finer, the result is None.

    Args:
        coarse, fine: the proved intervals with the errors E and E' on the meshes of size h and h'.
    """
    if coarse.low <= 0 or fine.low <= 0 or fine.cells <= coarse.cells:
        return None
    sizes = logarithm(Q(fine.cells, coarse.cells))  # an interval that contains 2 log(h/h') > 0
    low, high = logarithm(coarse.low / fine.high)[0], logarithm(coarse.high / fine.low)[1]
    return 2 * low / sizes[low >= 0], 2 * high / sizes[high < 0]


def decimal(x: Q, above: bool, digits: int = 8) -> str:
    """Write a fraction as a decimal number, rounded up or down.

    Args:
        x: the fraction.
        above: whether it is rounded up.
        digits: the number of decimals.
    """
    whole = math.ceil(x * 10**digits) if above else math.floor(x * 10**digits)
    return f"{'-' if whole < 0 else ''}{abs(whole) // 10**digits}.{abs(whole) % 10**digits:0{digits}d}"


def verified(data: Any) -> Enclosure:
    """Return the interval that a certificate proves; raise RefusedError if it proves nothing.

    Args:
        data: the content of the certificate file, as ``load`` returns it.
    """
    try:
        return Certificate(data).check()
    except RefusedError:
        raise
    except Exception as error:
        # An unexpected exception means that the file was not fully checked, so nothing is proved.
        raise RefusedError(f"the check ended with {type(error).__name__}") from error


def load(path: Path) -> Any:
    """Return the content of a certificate file.

    Raises:
        RefusedError: the file is not a gzip file with JSON in ASCII, or exceeds a limit.
        OSError: the file cannot be read.
    """
    size = path.stat().st_size
    require(size <= PACKED, f"the file has more than {PACKED} bytes")
    with path.open("rb") as file:
        packed = file.read(size)
    limit, unpacking = min(UNPACKED, max(SMALL, PACKING * len(packed))), zlib.decompressobj(wbits=31)
    try:
        text = unpacking.decompress(packed, limit).decode("ascii")
        require(not unpacking.unconsumed_tail, f"the file unpacks to more than {limit} bytes")
        require(unpacking.eof, "the file ends too early")
        require(not unpacking.unused_data, "the file has data after its certificate")
        require(text.count("[") <= LISTS and text.count("{") <= LISTS, f"the file has more than {LISTS} lists")
        return json.loads(text, object_pairs_hook=distinct, parse_constant=distinct)
    except RefusedError:
        raise
    except (ValueError, zlib.error) as error:
        raise RefusedError(f"the file is not a gzip file with JSON in ASCII: {shown(str(error))}") from error
    except RecursionError as error:
        raise RefusedError("the file nests lists too deeply") from error


def distinct(pairs: Any) -> dict[str, Any]:
    """Return an object of a JSON file as a dict; refuse repeated keys and the constants NaN and Infinity."""
    require(not isinstance(pairs, str), f"a number is {shown(pairs)}")
    found = dict(pairs)
    require(len(found) == len(pairs), "an object has a key twice")
    return found


def report(proved: Sequence[Enclosure]) -> None:
    """Print, for each pair of meshes, an interval that contains the order of convergence, or why it is unknown."""
    for coarse, fine in combinations(sorted(proved, key=lambda found: found.cells), 2):
        span, meshes = order(coarse, fine), f"from {coarse.cells} to {fine.cells} cells"
        if span:
            print(f"order {meshes} in [{decimal(span[0], False, 4)}, {decimal(span[1], True, 4)}]")
        else:
            reason = "h is the same" if coarse.cells == fine.cells else "an error may be 0"
            print(f"no order {meshes}: {reason}")


def main(paths: Sequence[str]) -> int:
    """Check certificate files of one problem and print what they prove.

    Args:
        paths: the paths of the files.

    Returns:
        The exit code: 0 if every file proves its interval, 1 if a file is refused, 2 if there is no file to check or a
        file cannot be read.
    """
    proved: list[Enclosure] = []
    stated: Any = None
    names = [path if path.isascii() and path.isprintable() else ascii(path) for path in paths]
    absent = [name for name, path in zip(names, paths, strict=True) if not os.path.isfile(path)]
    if absent or not paths:
        reasons = [f"{name} is not a file" for name in absent] or ["no file was given"]
        print(*reasons, "usage: python checker.py CERTIFICATE.json.gz ...", sep="\n", file=sys.stderr)
        return 2
    for name, path in zip(names, paths, strict=True):
        try:
            data = load(Path(path))
            found = verified(data)
            require(not proved or stated == data["problem"], "its problem differs from the problem of the first file")
        except OSError as error:
            print(f"{name} cannot be read: {error.strerror}", file=sys.stderr)
            return 2
        except (RefusedError, MemoryError) as refusal:
            print(f"{name}: REFUSED: {refusal if str(refusal) else 'it needs more memory than is available'}")
            return 1
        stated = data["problem"]
        proved.append(found)
        mesh = f"{found.cells} cells, h = {decimal(found.h, False, 4)}"
        interval = f"[{decimal(found.low, False)}, {decimal(found.high, True)}]"
        print(f"{name}:\n    {mesh}: max ‖u − u_h‖_V in {interval}")
    report(proved)
    print("the problem:")
    for name, value in stated.items():
        print(fill(f"    {name}: {json.dumps(value)}", 80, subsequent_indent=8 * " ", break_long_words=False))
    return 0


if __name__ == "__main__":
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]  # for terminals that cannot show ‖
    try:
        code = main(sys.argv[1:])
        sys.stdout.flush()
    except (KeyboardInterrupt, BrokenPipeError) as error:  # They say nothing about the certificates.
        os._exit(130 if isinstance(error, KeyboardInterrupt) else 141)
    sys.exit(code)
