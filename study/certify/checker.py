"""Check certificates of error bounds: a program of its own, which needs nothing but Python and this file.

    python checker.py certificate-4.json.gz certificate-8.json.gz

A certificate states a problem, a mesh and a computed displacement u_h on it, and it has witnesses: another displacement
ũ, stresses σ̃, a tensor field Φ. From these the bounds of ‖u(t) − u_h(t)‖_V are computed here, with integers and
fractions and roots that are rounded outward; nothing in the file says what they are. What is proved, and that these
lines do it, is in ``paper/certificate.tex``; letters are those of that text.

What a certificate has to fulfil is required below, line by line; whatever fails ends in ``RefusedError``.
"""

from __future__ import annotations

import gzip
import json
import math
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction as Q
from functools import cached_property, lru_cache, reduce
from itertools import pairwise, product
from operator import add, mul
from pathlib import Path
from textwrap import fill
from typing import Any

FORMAT = "signorini-certificate 1"
GRID = 100
"""Roots and sums are rounded outward to multiples of 2^−GRID."""
FINE = 66
"""Lengths of edges are taken up to 2^−FINE."""
Vector = tuple[Q, Q]
Matrix = list[list[Q]]
Poly = dict[Any, Q]
"""Tuples of exponents ↦ coefficients."""


class RefusedError(ValueError):
    """The certificate proves nothing."""


def require(condition: bool, message: str) -> None:
    """Refuse unless a condition holds."""
    if not condition:
        raise RefusedError(message)


# Numbers


def up(x: Q) -> Q:
    """x rounded up to the grid."""
    return Q(-(-(x.numerator << GRID) // x.denominator), 1 << GRID)


def root(x: Q, above: bool = True) -> Q:
    """√x rounded up, or down."""
    require(x >= 0, f"the square {float(x):.3g} is negative")
    square = x.numerator << 2 * GRID
    down = math.isqrt(square // x.denominator)
    return Q(down + above, 1 << GRID)


def logarithm(x: Q) -> tuple[Q, Q]:
    """The ends of an interval that contains log x, by the series of 2 artanh((x − 1)/(x + 1))."""
    if x > 2:
        (low, high), (two, more) = logarithm(x / 2), logarithm(Q(2))
        return low + two, high + more
    if x < 1:
        low, high = logarithm(1 / x)
        return -high, -low
    z = Q(round((x - 1) / (x + 1) * (1 << FINE)), 1 << FINE)
    slack = Q(4, 1 << FINE)  # of log as a function of z, whose slope is 2/(1 − z²) ≤ 9/4 < 3
    found = sum((2 * z ** (2 * i + 1) / (2 * i + 1) for i in range(24)), Q(0))
    return found - slack, found + slack + z**49


def decay(x: Q) -> Q:
    """An upper bound of e^{−x}, x ≥ 0."""
    return up(1 / sum((x**j / math.factorial(j) for j in range(60)), Q(0)))


def mean_decay(x: Q) -> Q:
    """An upper bound of (1 − e^{−x})/x, x ≥ 0: of ∫_0^1 e^{−xs} ds."""
    if x > 24:
        return up(1 / x)
    # From the 24th on, terms fall in size; the last one taken is positive.
    series = sum(((-x) ** j / math.factorial(j + 1) for j in range(25)), Q(0))
    return up(min(series, 1 / x) if x else series)


def common(rows: Iterable[Iterable[Q]]) -> tuple[list[list[int]], int]:
    """Integers and the denominator that they share."""
    kept = [list(row) for row in rows]
    denominator = math.lcm(*(x.denominator for row in kept for x in row))
    return [[x.numerator * (denominator // x.denominator) for x in row] for row in kept], denominator


def solve(rows: list[dict[int, Q]], unknowns: int) -> tuple[list[dict[int, Q]], list[int]]:
    """Row-reduced equations on the unknowns; columns ≥ ``unknowns`` are right sides. Rows, and their pivots."""
    reduced: list[dict[int, Q]] = []
    pivots: list[int] = []
    for row in rows:
        row = dict(row)
        for pivot, known in zip(pivots, reduced, strict=True):
            _eliminate(row, pivot, known)
        left = [c for c in row if c < unknowns]
        if not left:
            require(not row, "equations of the reference element contradict each other")
            continue
        pivot = min(left)
        row = {c: x / row[pivot] for c, x in row.items()}
        for known in reduced:
            _eliminate(known, pivot, row)
        reduced.append(row)
        pivots.append(pivot)
    return reduced, pivots


def _eliminate(row: dict[int, Q], pivot: int, known: dict[int, Q]) -> None:
    factor = row.get(pivot, Q(0))
    if factor:
        for c, x in known.items():
            row[c] = row.get(c, Q(0)) - factor * x
            if not row[c]:
                del row[c]


# Polynomials


def times(a: Poly, b: Poly) -> Poly:
    found: Poly = {}
    for (i, x), (j, y) in product(a.items(), b.items()):
        key = tuple(map(add, i, j))
        found[key] = found.get(key, Q(0)) + x * y
    return found


def plus(a: Poly, b: Poly, factor: Q = Q(1)) -> Poly:
    found = dict(a)
    for key, x in b.items():
        found[key] = found.get(key, Q(0)) + factor * x
    return {key: x for key, x in found.items() if x}


def compose(p: Poly, images: Sequence[Poly]) -> Poly:
    """p with a polynomial in place of each variable."""
    size = len(next(iter(images[0])))
    powers = [[{(0,) * size: Q(1)}] for _ in images]
    found: Poly = {}
    for key, c in p.items():
        term: Poly = {(0,) * size: c}
        for exponent, image, known in zip(key, images, powers, strict=True):
            while len(known) <= exponent:
                known.append(times(known[-1], image))
            term = times(term, known[exponent])
        found = plus(found, term)
    return found


def affine(size: int, constant: Q, **slopes: Q) -> Poly:
    """constant + Σ slope · variable; variables are v0, v1, …."""
    found = {(0,) * size: constant}
    for name, slope in slopes.items():
        found[tuple(int(f"v{i}" == name) for i in range(size))] = slope
    return found


def value(p: Poly, place: Sequence[Q]) -> Q:
    found = Q(0)
    for key, c in p.items():
        for x, exponent in zip(place, key, strict=True):
            c = c * x**exponent
        found += c
    return found


def size_of(p: Poly, radii: Sequence[Q]) -> Q:
    """A bound of |p| for |v_i| ≤ r_i."""
    return sum((abs(value({key: c}, radii)) for key, c in p.items()), Q(0))


@dataclass(frozen=True)
class Term:
    """p · g_+^q of two polynomials; p alone if q = 0."""

    p: Poly
    g: Poly
    q: int

    def __call__(self, place: Sequence[Q]) -> Q:
        return value(self.p, place) * (max(value(self.g, place), Q(0)) ** self.q if self.q else 1)

    def composed(self, images: Sequence[Poly]) -> Term:
        return Term(compose(self.p, images), compose(self.g, images) if self.q else {}, self.q)

    def plain(self, radii: Sequence[Q]) -> Poly | None:
        """The polynomial that it is for |v_i| ≤ r_i; None where g changes its sign."""
        if not self.q:
            return self.p
        middle = self.g.get((0,) * len(radii), Q(0))
        spread = size_of(self.g, radii) - abs(middle)
        if middle <= -spread:
            return {}
        return reduce(times, [self.g] * self.q, self.p) if middle >= spread else None

    def largest(self, radii: Sequence[Q]) -> Q:
        """A bound of |p g_+^q| for |v_i| ≤ r_i."""
        middle = self.g.get((0,) * len(radii), Q(0))
        positive = max(middle + size_of(self.g, radii) - abs(middle), Q(0)) if self.q else Q(1)
        return size_of(self.p, radii) * positive**self.q


Formula = tuple[Term, ...]
"""A sum of terms in x1, x2, t."""


def at(formula: Formula, place: Sequence[Q]) -> Q:
    return sum((term(place) for term in formula), Q(0))


def polynomial(data: Any, size: int) -> Poly:
    """From [[coefficient, exponent, …], …]."""
    found: Poly = {}
    for coefficient, *key in data:
        require(len(key) == size and all(type(e) is int and e >= 0 for e in key), f"no exponents: {key}")
        found = plus(found, {tuple(key): Q(coefficient)})
    return found


def formula(data: Any) -> Formula:
    """From [[p, g, q], …]."""
    found = tuple(Term(polynomial(p, 3), polynomial(g, 3), q) for p, g, q in data)
    require(all(type(term.q) is int and term.q >= 0 for term in found), "a truncated power needs an exponent ≥ 0")
    return found


# The problem


def cross(a: Sequence[Any], b: Sequence[Any]) -> Any:
    return a[0] * b[1] - a[1] * b[0]


def minus(a: Sequence[Q], b: Sequence[Q]) -> Vector:
    return a[0] - b[0], a[1] - b[1]


def inner(a: Sequence[Any], b: Sequence[Any]) -> Any:
    return a[0] * b[0] + a[1] * b[1]


def definite(matrix: Matrix, strictly: bool) -> bool:
    """Whether a symmetric matrix is positive (semi)definite, by elimination."""
    if not matrix:
        return True
    if any(matrix[i][j] != matrix[j][i] for i, j in product(range(len(matrix)), repeat=2)):
        return False
    pivot, rest = matrix[0][0], matrix[0][1:]
    if pivot < 0 or (pivot == 0 and (strictly or any(rest))):
        return False
    smaller = [row[1:] for row in matrix[1:]]
    if pivot:
        smaller = [
            [x - a * b / pivot for x, b in zip(row, rest, strict=True)] for row, a in zip(smaller, rest, strict=True)
        ]
    return definite(smaller, strictly)


def inverse(matrix: Matrix) -> Matrix:
    size = len(matrix)
    rows = [
        {j: x for j, x in enumerate([*row, *(Q(i == k) for k in range(size))]) if x} for i, row in enumerate(matrix)
    ]
    reduced, pivots = solve(rows, size)
    require(len(pivots) == size, "a matrix is singular")
    by_pivot = dict(zip(pivots, reduced, strict=True))
    return [[by_pivot[i].get(size + j, Q(0)) for j in range(size)] for i in range(size)]


def product_of(a: Matrix, b: Matrix) -> Matrix:
    return [[sum(map(mul, row, column), Q(0)) for column in zip(*b, strict=True)] for row in a]


def combined(a: Matrix, b: Matrix, factor: Q) -> Matrix:
    return [[x + factor * y for x, y in zip(r, s, strict=True)] for r, s in zip(a, b, strict=True)]


def traced(a: Matrix, b: Sequence[Sequence[Any]]) -> Q:
    """Σ a_ij b_ij."""
    return sum((sum(map(mul, r, s), Q(0)) for r, s in zip(a, b, strict=True)), Q(0))


class Problem:
    """Ω, A, G, f_0, f_2, u_0 and T.

    Tensors are in Voigt's components, stresses (11, 22, 12) and strains (11, 22, 2·12); A and G are 3 × 3.
    """

    def __init__(self, data: Any) -> None:
        self.corners = [(Q(x), Q(y)) for x, y in data["vertices"]]
        self.kinds = list(data["kinds"])
        self.T = Q(data["T"])
        self.A, self.G = ([[Q(x) for x in row] for row in data[name]] for name in "AG")
        self.force = tuple(map(formula, data["force"]))
        self.loads = {int(part): tuple(map(formula, load)) for part, load in data["loads"].items()}
        self.start = tuple(polynomial(p, 2) for p in data["start"])
        self._check_body()
        require(self.T > 0, "T is not positive")
        shapes = [len(m) == 3 and all(len(row) == 3 for row in m) for m in (self.A, self.G)]
        require(all(shapes) and len(self.force) == len(self.start) == 2, "A and G are 3 × 3, forces have 2 components")
        require(definite(self.A, strictly=True), "A is not symmetric and positive definite")
        require(definite(self.G, strictly=False), "G is not symmetric and positive semidefinite")
        require(not any(term.q for term in (*self.force[0], *self.force[1])), "f_0 with kinks is not served")
        for part, load in self.loads.items():
            require(self.kinds[part] == "loaded" and len(load) == 2, f"f_2 is given on part {part}, which is not of Γ2")
        self._check_start()

    @property
    def sides(self) -> list[tuple[Vector, Vector]]:
        return list(zip(self.corners, [*self.corners[1:], self.corners[0]], strict=True))

    def _check_body(self) -> None:
        """The polygon is simple and counter-clockwise, and has a Γ1."""
        sides, count = self.sides, len(self.corners)
        require(count == len(self.kinds) >= 3, "a polygon has three sides or more, and each has a kind")
        require({*self.kinds} <= {"clamped", "loaded", "contact"}, f"unknown kinds of parts: {self.kinds}")
        require("clamped" in self.kinds, "no part is clamped")
        require(sum(cross(a, b) for a, b in sides) > 0, "the polygon is not counter-clockwise")
        require(all(a != b for a, b in sides), "a side has no length")
        for i, j in product(range(count), repeat=2):
            (a, b), (c, d) = sides[i], sides[j]
            if j == (i + 1) % count:
                turned = cross(minus(b, a), minus(d, c)) != 0 or inner(minus(b, a), minus(d, c)) > 0
                require(turned, f"sides {i} and {j} fold back")
            elif i < j and i != (j + 1) % count:
                require(not _meet(a, b, c, d), f"sides {i} and {j} of the polygon meet")

    def _check_start(self) -> None:
        """u_0 = 0 on Γ1 and u_0ν ≤ 0 on Γ3."""
        for (a, b), kind in zip(self.sides, self.kinds, strict=True):
            line = [affine(1, a[i], v0=b[i] - a[i]) for i in (0, 1)]
            u = [compose(p, line) for p in self.start]
            if kind == "clamped":
                require(not any(plus(p, {}) for p in u), "u_0 does not vanish on Γ1")
            if kind == "contact":
                normal = plus({}, u[0], b[1] - a[1])
                require(_not_positive(plus(normal, u[1], a[0] - b[0])), "u_0ν ≤ 0 on Γ3 is not seen")


def _meet(a: Vector, b: Vector, c: Vector, d: Vector) -> bool:
    """Whether the closed segments ab and cd have a point in common."""
    turns = [cross(minus(q, p), minus(r, p)) for p, q, r in ((a, b, c), (a, b, d), (c, d, a), (c, d, b))]
    if turns[0] * turns[1] < 0 and turns[2] * turns[3] < 0:
        return True
    ends = ((a, b, c), (a, b, d), (c, d, a), (c, d, b))
    return any(turn == 0 and inner(minus(p, r), minus(q, r)) <= 0 for turn, (p, q, r) in zip(turns, ends, strict=True))


def _not_positive(p: Poly, depth: int = 6) -> bool:
    """Whether p(v) ≤ 0 for 0 ≤ v ≤ 1 can be seen from Bernstein coefficients, on halves if need be."""
    degree = max((key[0] for key in p), default=0)
    coefficients = [
        sum((p.get((j,), Q(0)) * Q(math.comb(i, j), math.comb(degree, j)) for j in range(i + 1)), Q(0))
        for i in range(degree + 1)
    ]
    if all(c <= 0 for c in coefficients):
        return True
    halves = [compose(p, [affine(1, start, v0=Q(1, 2))]) for start in (Q(0), Q(1, 2))]
    return depth > 0 and all(_not_positive(half, depth - 1) for half in halves)


# Meshes


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles; a vertex is a pair of integers over the denominator. ``parts`` has the part of a boundary edge."""

    denominator: int
    points: list[tuple[int, int]]
    cells: list[tuple[int, int, int]]
    parts: dict[tuple[int, int], int]

    @classmethod
    def of(cls, data: Any, problem: Problem) -> Mesh:
        """A mesh whose cells tile Ω.

        Cells are counter-clockwise and an edge that two of them do not run through in opposite directions lies on a
        part, in whose direction these edges follow each other from end to end: so the sum of the indicators of the
        cells, which are winding numbers, is that of ∂Ω.
        """
        denominator, points = data["denominator"], [(x, y) for x, y in data["points"]]
        cells = [(a, b, c) for a, b, c in data["cells"]]
        integers(denominator, *points, *cells)
        require(denominator > 0 and all(0 <= v < len(points) for cell in cells for v in cell), "no mesh")
        mesh = cls(denominator, points, cells, {})
        require(all(mesh.determinant(cell) > 0 for cell in cells), "a cell is not counter-clockwise")
        directed = [edge for a, b, c in cells for edge in ((a, b), (b, c), (c, a))]
        once = set(directed)
        require(len(once) == len(directed), "two cells lie on the same side of an edge")
        mesh._place([edge for edge in directed if edge[::-1] not in once], problem)
        return mesh

    def _place(self, boundary: list[tuple[int, int]], problem: Problem) -> None:
        """Find the part of every edge of the boundary, and refuse gaps."""
        for part, (a, b) in enumerate(problem.sides):
            along = minus(b, a)
            length, mine = inner(along, along), []
            for edge in boundary:
                ends = [minus(self.place(v), a) for v in edge]
                if all(cross(along, end) == 0 for end in ends):
                    first, last = (inner(along, end) / length for end in ends)
                    if 0 <= first < last <= 1:
                        mine.append((first, last, edge))
            mine.sort()
            meeting = [0, *(last for _, last, _ in mine)], [*(first for first, _, _ in mine), 1]
            require(bool(mine) and meeting[0] == meeting[1], f"the mesh does not fit side {part} of the polygon")
            self.parts.update({(min(edge), max(edge)): part for _, _, edge in mine})
        require(len(self.parts) == len(boundary), "the mesh has a boundary inside the polygon, or outside")

    def place(self, vertex: int) -> Vector:
        x, y = self.points[vertex]
        return Q(x, self.denominator), Q(y, self.denominator)

    def determinant(self, cell: Sequence[int]) -> int:
        """det F in units of the lattice, twice the area."""
        (a, b), (c, d) = self.map(cell)
        return a * d - b * c

    def map(self, cell: Sequence[int]) -> tuple[tuple[int, int], tuple[int, int]]:
        """The rows of F, whose columns are the edges from the first vertex."""
        (x, y), (a, b), (c, d) = (self.points[v] for v in cell)
        return (a - x, c - x), (b - y, d - y)

    def along(self, edge: tuple[int, int]) -> tuple[int, int]:
        (x, y), (a, b) = (self.points[v] for v in edge)
        return a - x, b - y

    @cached_property
    def edges(self) -> list[tuple[int, int]]:
        return sorted({(min(e), max(e)) for a, b, c in self.cells for e in ((a, b), (b, c), (c, a))})

    @cached_property
    def numbers(self) -> dict[tuple[int, int], int]:
        return {edge: number for number, edge in enumerate(self.edges)}

    @cached_property
    def sides(self) -> list[tuple[int, int, int]]:
        """The edges opposite the vertices of each cell."""
        pairs = [((b, c), (c, a), (a, b)) for a, b, c in self.cells]
        return [tuple(self.numbers[min(e), max(e)] for e in three) for three in pairs]  # type: ignore[misc]

    @cached_property
    def outward(self) -> dict[int, int]:
        """1 for edges of the boundary that run counter-clockwise from the lower to the higher vertex, else −1."""
        found = {}
        for cell, three in zip(self.cells, self.sides, strict=True):
            for i, edge in enumerate(three):
                if self.edges[edge] in self.parts:
                    found[edge] = 1 if cell[(i + 1) % 3] < cell[(i + 2) % 3] else -1
        return found

    def refined(self) -> Mesh:
        """Every cell in four by the midpoints of its edges, which are numbered after the vertices."""
        points = [(2 * x, 2 * y) for x, y in self.points]
        middle = {}
        for a, b in self.edges:
            middle[a, b] = middle[b, a] = len(points)
            points.append((self.points[a][0] + self.points[b][0], self.points[a][1] + self.points[b][1]))
        cells = []
        for a, b, c in self.cells:
            d, e, f = middle[b, c], middle[c, a], middle[a, b]
            cells += [(a, f, e), (f, b, d), (e, d, c), (d, e, f)]
        parts = {(v, middle[edge]): part for edge, part in self.parts.items() for v in edge}
        return Mesh(2 * self.denominator, points, cells, parts)


def integers(*values: Any) -> None:
    """Refuse numbers, or lists of them, that are no integers."""
    for one in values:
        flat = one if isinstance(one, list | tuple) else (one,)
        require(all(type(x) is int for x in flat), "a number is no integer")


# The reference element

LEGENDRE: list[Poly] = [
    {(0,): Q(1)},
    {(0,): Q(-1), (1,): Q(2)},
    {(0,): Q(1), (1,): Q(-6), (2,): Q(6)},
    {(0,): Q(-1), (1,): Q(12), (2,): Q(-30), (3,): Q(20)},
]
"""Orthogonal on [0, 1]; the l-th is (−1)^l times itself if the interval is turned around."""
CUBICS: list[Poly] = [
    {(j,): Q((-1) ** (j - i) * math.comb(3, i) * math.comb(3 - i, j - i)) for j in range(i, 4)} for i in range(4)
]
"""Bernstein polynomials on [0, 1]."""
BARYCENTRIC = [{(0, 0): Q(1), (1, 0): Q(-1), (0, 1): Q(-1)}, {(1, 0): Q(1)}, {(0, 1): Q(1)}]
CORNERS = [(Q(0), Q(0)), (Q(1), Q(0)), (Q(0), Q(1))]
CENTRE = (Q(1, 3), Q(1, 3))
CUBIC = [(a, b, 3 - a - b) for a in range(3, -1, -1) for b in range(3 - a, -1, -1)]
SQUARE = [(a, b, 2 - a - b) for a in range(2, -1, -1) for b in range(2 - a, -1, -1)]
EDGE_INPUTS, FORCE_INPUTS, INNER_INPUTS = 24, 12, 9
RIGID: list[tuple[Poly, Poly]] = [
    ({(0, 0): Q(1)}, {}),
    ({}, {(0, 0): Q(1)}),
    ({(0, 0): Q(1, 3), (0, 1): Q(-1)}, {(1, 0): Q(1), (0, 0): Q(-1, 3)}),
]
"""Rigid motions, orthogonal on the reference triangle, with the squares of their norms below."""
RIGID_SQUARES = (Q(1, 2), Q(1, 2), Q(1, 18))


def on_triangle(p: Poly) -> Q:
    """∫ p over the triangle with the vertices 0, e_1, e_2."""
    return sum(
        (c * Q(math.factorial(i) * math.factorial(j), math.factorial(i + j + 2)) for (i, j), c in p.items()), Q(0)
    )


def on_interval(p: Poly) -> Q:
    return sum((c / (i + 1) for (i,), c in p.items()), Q(0))


def legendre(values: list[Poly]) -> list[list[Q]]:
    """Rows: the coefficients in ``LEGENDRE`` of some polynomials, (4, polynomials)."""
    return [[on_interval(times(p, basis)) * (2 * degree + 1) for p in values] for degree, basis in enumerate(LEGENDRE)]


def nodal() -> list[Poly]:
    """The polynomials of degree 2 that are 1 at one of three vertices and three midpoints, opposite these."""
    corners = [times(x, plus(plus({}, x, Q(2)), {(0, 0): Q(-1)})) for x in BARYCENTRIC]
    middles = [plus({}, times(BARYCENTRIC[(i + 1) % 3], BARYCENTRIC[(i + 2) % 3]), Q(4)) for i in range(3)]
    return corners + middles


@dataclass(frozen=True, eq=False)
class Element:
    """Composite stresses of degree 3 on the reference triangle, as a linear function of 45 inputs.

    The inputs are tractions on three sides (4 polynomials of Legendre, 2 components each), a force of degree 2 (6
    nodes, 2 components) and 9 inner numbers. The stress is a cubic on every third, with continuous tractions between
    the thirds and those that are given outside, and Div σ̂ + f̂ = q̂, the rigid motion that balances force and tractions.

    Attributes:
        rows: for each component (11, 22, 12) the coefficients in 30 orthogonal polynomials, ten a third, over K.
        squares: of the norms of these polynomials, times ``unit``.
        rigid: the coefficients of q̂ in ``RIGID`` from the first 36 inputs, over K.
    """

    rows: tuple[list[list[int]], ...]
    rigid: list[list[int]]
    K: int
    squares: list[int]
    unit: int


@lru_cache(maxsize=1)
def element() -> Element:
    balance = _balance()
    reduced, pivots = solve(_equations(balance), 90)
    inner_unknowns = [u for u in range(90) if u not in set(pivots)]
    require(len(inner_unknowns) == INNER_INPUTS, "the reference element has another dimension")
    stress: list[dict[int, Q]] = [{} for _ in range(90)]
    for j, unknown in enumerate(inner_unknowns):
        stress[unknown] = {36 + j: Q(1)}
    for pivot, row in zip(pivots, reduced, strict=True):
        for c, x in row.items():
            if c >= 90:
                stress[pivot][c - 90] = stress[pivot].get(c - 90, Q(0)) + x
            elif c != pivot:
                stress[pivot][36 + inner_unknowns.index(c)] = -x
    change, squares = orthogonal()
    found = []
    for component, third, new in product(range(3), range(3), change):
        entries = [Q(0)] * 45
        for old, factor in enumerate(new):
            for j, x in stress[30 * third + 3 * old + component].items():
                entries[j] += factor * x
        found.append(entries)
    every, K = common([*found, *balance])
    (flat,), unit = common([squares])
    return Element((every[:30], every[30:60], every[60:90]), every[90:], K, flat, unit)


def _balance() -> list[list[Q]]:
    """q̂ from the inputs, (3, 36)."""
    found = []
    for motion, square in zip(RIGID, RIGID_SQUARES, strict=True):
        row = []
        for i, p, d in product(range(3), LEGENDRE, (0, 1)):
            a, b = CORNERS[(i + 1) % 3], CORNERS[(i + 2) % 3]
            side = [affine(1, a[j], v0=b[j] - a[j]) for j in (0, 1)]
            row.append(on_interval(times(p, compose(motion[d], side))) / square)
        row += [on_triangle(times(p, motion[d])) / square for p, d in product(nodal(), (0, 1))]
        found.append(row)
    return found


def _equations(balance: list[list[Q]]) -> list[dict[int, Q]]:
    """Continuity inside, tractions outside and the divergence; unknowns first, then the inputs on the right."""
    place: dict[tuple[int, ...], int] = {alpha: 3 * number for number, alpha in enumerate(CUBIC)}
    found: list[dict[int, Q]] = []

    def traction(third: int, alpha: tuple[int, ...], along: Vector, d: int, factor: int = 1) -> dict[int, Q]:
        start, (nx, ny) = 30 * third + place[alpha], (along[1], -along[0])
        parts = {(0, 0): nx, (0, 2): ny, (1, 1): ny, (1, 2): nx}
        return {start + c: factor * n for (row, c), n in parts.items() if row == d and n}

    def without_zeros(row: dict[int, Q]) -> dict[int, Q]:
        return {c: x for c, x in row.items() if x}

    for v, step, d in product(range(3), range(4), (0, 1)):
        along = minus(CENTRE, CORNERS[v])
        left = traction((v + 1) % 3, (0, 3 - step, step), along, d)
        found.append(left | traction((v + 2) % 3, (3 - step, 0, step), along, d, -1))
    control = [_bernstein(p) for p in LEGENDRE]
    for i, step, d in product(range(3), range(4), (0, 1)):
        left = traction(i, (3 - step, step, 0), minus(CORNERS[(i + 2) % 3], CORNERS[(i + 1) % 3]), d)
        found.append(without_zeros(left | {90 + 8 * i + 2 * n + d: control[n][step] for n in range(4)}))
    for third, beta, d in product(range(3), SQUARE, (0, 1)):
        vertices = [CORNERS[(third + 1) % 3], CORNERS[(third + 2) % 3], CENTRE]
        left = {}
        for v, (gx, gy) in enumerate(slopes(vertices)):
            start = 30 * third + place[tuple(b + (i == v) for i, b in enumerate(beta))]
            for c, g in ((0, gx), (2, gy)) if d == 0 else ((2, gx), (1, gy)):
                left[start + c] = left.get(start + c, Q(0)) + 3 * g
        found.append(without_zeros(left | _right(vertices, beta, d, balance)))
    return found


def _right(vertices: list[Vector], beta: tuple[int, ...], d: int, balance: list[list[Q]]) -> dict[int, Q]:
    """A Bernstein coefficient of q̂ − f̂ on a third, by polar forms."""
    p, q = (vertices[v] for v, count in enumerate(beta) for _ in range(count))
    middle = (p[0] + q[0]) / 2, (p[1] + q[1]) / 2
    right = {90 + 24 + 2 * n + d: (value(s, p) + value(s, q)) / 2 - 2 * value(s, middle) for n, s in enumerate(nodal())}
    for motion, row in zip(RIGID, balance, strict=True):
        for j, x in enumerate(row):
            right[90 + j] = right.get(90 + j, Q(0)) + value(motion[d], middle) * x
    return right


def _bernstein(p: Poly) -> list[Q]:
    """Coefficients of degree 3 of a polynomial on [0, 1]."""
    return [
        sum((p.get((j,), Q(0)) * Q(math.comb(i, j), math.comb(3, j)) for j in range(i + 1)), Q(0)) for i in range(4)
    ]


def slopes(vertices: list[Vector]) -> list[Vector]:
    """The gradients of barycentric coordinates."""
    area = cross(minus(vertices[1], vertices[0]), minus(vertices[2], vertices[0]))
    turned = [minus(vertices[(i + 2) % 3], vertices[(i + 1) % 3]) for i in range(3)]
    return [(-y / area, x / area) for x, y in turned]


def orthogonal() -> tuple[list[list[Q]], list[Q]]:
    """Orthogonal polynomials on a third from its Bernstein polynomials, (10, 10), and the squares of their norms.

    The first three are 1, s = λ_a − λ_b and w = 3λ_c − 1; the reference third has a sixth of twice its area 1/2.
    """
    one, a, b = {(0, 0): Q(1)}, {(1, 0): Q(1)}, {(0, 1): Q(1)}
    c = plus(plus(one, a, Q(-1)), b, Q(-1))
    s, w = plus(a, b, Q(-1)), plus(plus({}, c, Q(3)), one, Q(-1))
    basis: list[Poly] = []
    for degree in range(4):
        for j in range(degree + 1):
            p = reduce(times, [s] * (degree - j) + [w] * j, one)
            for known in basis:
                p = plus(p, known, -on_triangle(times(p, known)) / on_triangle(times(known, known)))
            basis.append(p)
    shapes = [
        plus({}, reduce(times, [a] * i + [b] * j + [c] * k, one), Q(6, math.prod(map(math.factorial, (i, j, k)))))
        for i, j, k in CUBIC
    ]
    squares = [on_triangle(times(p, p)) for p in basis]
    change = [
        [on_triangle(times(p, shape)) / square for shape in shapes] for p, square in zip(basis, squares, strict=True)
    ]
    return change, [square / 3 for square in squares] * 3


# Constants of the body


def load_constants(data: Any, problem: Problem) -> tuple[Q, Q]:
    """C_Ω and C_Γ from a totally symmetric tensor field Φ, continuous and linear on the cells of a mesh of its own.

    Required at every vertex of a cell: div Φ(v, v) − A⁻¹(Φv)·(Φv) ≥ μ |v|², and on edges that are not of Γ1
    −Φ(ν, v, v) ≥ 0, on loaded parts ≥ κ |v|². Then C_Ω = μ^{−1/2} and C_Γ = κ^{−1/2}.
    """
    mesh = Mesh.of(data["mesh"], problem)
    mu, kappa, unit = Q(data["volume"]), Q(data["surface"]), 1 << data["bits"]
    require(mu > 0 and kappa > 0 and len(data["field"]) == len(mesh.points), "the tensor field has another size")
    integers(*data["field"])
    field = [[Q(x, unit) for x in four] for four in data["field"]]
    compliance = inverse(problem.A)
    for cell in mesh.cells:
        gradients = slopes([mesh.place(v) for v in cell])
        divergence = [
            sum(field[v][k] * g[0] + field[v][k + 1] * g[1] for v, g in zip(cell, gradients, strict=True))
            for k in range(3)
        ]
        for v in cell:
            a, b, c, d = field[v]
            # Columns are the stresses Φe_1 and Φe_2.
            columns = [[a, b], [c, d], [b, c]]
            square = product_of([list(x) for x in zip(*columns, strict=True)], product_of(compliance, columns))
            left = [[divergence[i + j] - square[i][j] - (mu if i == j else 0) for j in (0, 1)] for i in (0, 1)]
            require(definite(left, strictly=False), "the tensor field does not prove the constant of forces in Ω")
    for edge, part in mesh.parts.items():
        start, end = problem.sides[part]
        normal = minus(end, start)[1], minus(start, end)[0]
        least = kappa * Q(math.isqrt(math.ceil(inner(normal, normal) * (1 << 2 * FINE))) + 1, 1 << FINE)
        for v in edge if problem.kinds[part] != "clamped" else ():
            across = [normal[0] * field[v][k] + normal[1] * field[v][k + 1] for k in range(3)]
            wanted = least if part in problem.loads else Q(0)
            left = [[-across[i + j] - (wanted if i == j else 0) for j in (0, 1)] for i in (0, 1)]
            require(definite(left, strictly=False), "the tensor field does not prove the constant of loads on Γ2")
    return root(1 / mu), root(1 / kappa)


# Loads of the stresses


@dataclass(frozen=True)
class Load:
    """The loads that a stress balances at a knot or for a control point, and how they are rounded."""

    force: list[list[int]]
    traction: dict[int, list[int]]


class Loads:
    """f̃: parabolas in time, through the data at both ends and in the middle of a piece, of polynomials in space.

    f̃_0 is quadratic on every cell and interpolates f_0 at vertices and midpoints; |e| f̃_2 is cubic on every edge and
    interpolates at 0, 1/3, 2/3, 1; values are rounded to multiples of 1/unit (f̃_0: after division by twice the area).
    """

    def __init__(self, problem: Problem, mesh: Mesh, bits: int) -> None:
        self.problem, self.mesh, self.unit = problem, mesh, 1 << bits
        self.lines = {e: self._line(edge) for e, edge in enumerate(mesh.edges) if mesh.parts.get(edge) in problem.loads}
        alongs = {e: mesh.along(mesh.edges[e]) for e in self.lines}
        self.lengths = {e: root(Q(inner(d, d), mesh.denominator**2)) for e, d in alongs.items()}
        places = [mesh.place(v) for v in range(len(mesh.points))]
        middles = [((places[a][0] + places[b][0]) / 2, (places[a][1] + places[b][1]) / 2) for a, b in mesh.edges]
        self.nodes = [*places, *middles] if self.acts else []

    @property
    def acts(self) -> bool:
        """Whether there is an f_0."""
        return any(self.problem.force)

    def _line(self, edge: tuple[int, int]) -> tuple[Formula, ...]:
        """f_2 as formulas of θ − 1/2 and t on an edge, from its lower vertex."""
        p, q = self.mesh.place(edge[0]), self.mesh.place(edge[1])
        images = [affine(2, (p[i] + q[i]) / 2, v0=q[i] - p[i]) for i in (0, 1)] + [affine(2, Q(0), v1=Q(1))]
        return tuple(tuple(term.composed(images) for term in f) for f in self.problem.loads[self.mesh.parts[edge]])

    @lru_cache(maxsize=4)  # noqa: B019
    def exact(self, time: Q) -> tuple[list[Vector], dict[int, list[Vector]]]:
        """f_0 at the nodes and |e| f_2 at the places of the loaded edges."""
        force = [tuple(at(f, (*x, time)) for f in self.problem.force) for x in self.nodes]
        places = [Q(i, 3) - Q(1, 2) for i in range(4)]
        on_edges = {
            e: [tuple(self.lengths[e] * at(f, (x, time)) for f in line) for x in places]
            for e, line in self.lines.items()
        }
        return force, on_edges  # type: ignore[return-value]

    def at_knot(self, time: Q) -> Load:
        return self.rounded(*self.exact(time))

    def control(self, a: Q, b: Q) -> Load:
        """2 f(m) − (f(a) + f(b))/2, the middle Bernstein coefficient."""
        (f, g), *ends = (self.exact(time) for time in ((a + b) / 2, a, b))

        def parabola(m: Vector, p: Vector, q: Vector) -> Vector:
            return 2 * m[0] - (p[0] + q[0]) / 2, 2 * m[1] - (p[1] + q[1]) / 2

        force = [parabola(*three) for three in zip(f, ends[0][0], ends[1][0], strict=True)]
        on_edges = {e: [parabola(*three) for three in zip(g[e], ends[0][1][e], ends[1][1][e], strict=True)] for e in g}
        return self.rounded(force, on_edges)

    def rounded(self, force: list[Vector], on_edges: dict[int, list[Vector]]) -> Load:
        """In integers: twice the area times f̃_0 at six nodes of each cell, and |e| f̃_2."""
        mesh, cells = self.mesh, []
        for cell, sides in zip(mesh.cells, mesh.sides, strict=True) if self.acts else ():
            area = Q(mesh.determinant(cell) * self.unit, mesh.denominator**2)
            nodes = [*cell, *(len(mesh.points) + e for e in sides)]
            cells.append([round(area * x) for n in nodes for x in force[n]])
        return Load(cells, {e: [round(self.unit * x) for v in values for x in v] for e, values in on_edges.items()})

    def missed(self, a: Q, b: Q, volume: Q, surface: Q) -> Q:
        """A bound of the norm of f − f̃ in the dual of V, root of the mean square over a ≤ t ≤ b."""
        return up(volume * self._missed_inside(a, b) + surface * self._missed_on_edges(a, b))

    def _missed_inside(self, a: Q, b: Q) -> Q:
        if not self.acts:
            return Q(0)
        total, mesh = Q(0), self.mesh
        smooth = all(sum(key[:2]) <= 2 >= key[2] for f in self.problem.force for term in f for key in term.p)
        for cell in mesh.cells:
            area, corners = Q(mesh.determinant(cell), mesh.denominator**2), [mesh.place(v) for v in cell]
            square = 2 * Q(1, self.unit) ** 2 / area**2
            if not smooth:
                low, high = ([end(x[i] for x in corners) for i in (0, 1)] for end in (min, max))
                middle = [*((p + q) / 2 for p, q in zip(low, high, strict=True)), (a + b) / 2]
                radii = [*((q - p) / 2 for p, q in zip(low, high, strict=True)), (b - a) / 2]
                square = Q(0)
                for f in self.problem.force:
                    local = [shifted(term.p, middle) for term in f]
                    rest = sum(
                        (size_of({k: c for k, c in p.items() if not sum(k[:2]) <= 2 >= k[2]}, radii) for p in local),
                        Q(0),
                    )
                    square += (LOST * rest + Q(1, self.unit) / area) ** 2
            total += up(square * area / 2)
        return root(total)

    def _missed_on_edges(self, a: Q, b: Q) -> Q:
        total = Q(0)
        for e, line in self.lines.items():
            local = [tuple(_in_time(term, (a + b) / 2) for term in f) for f in line]
            shorter = self.lengths[e] - Q(1, 1 << GRID)
            total += up(sum((self._missed_on(e, f, b - a) for f in local), Q(0)) / shorter)
        return root(total)

    def _missed_on(self, e: int, f: Formula, k: Q) -> Q:
        """The mean over the edge and the piece of a bound of (|e| f − |e| f̃)² in one component."""
        radii, length = (Q(1, 2), k / 2), self.lengths[e]
        # The length is one of √ rounded up, and f̃ is rounded.
        slack = sum((term.largest(radii) for term in f), Q(0)) / (1 << GRID) + Q(1, self.unit)
        longer = tuple(Term(plus({}, term.p, length), term.g, term.q) for term in f)
        if all(not term.q and all(key[0] <= 3 and key[1] <= 2 for key in term.p) for term in f):
            return slack**2
        missed = Term(plus({}, _interpolant(longer, k), Q(-1)), {}, 0)
        return _mean_square((*longer, missed), radii, slack, DEPTH)


LOST = Q(37, 12)
"""1 + Λ, Λ = 5/3 · 5/4 the Lebesgue constants of the nodes in space (5/3 on triangles, less on edges) and in time."""
DEPTH = 4
"""How often a piece of an edge on which a load has a kink is halved."""


def shifted(p: Poly, centre: Sequence[Q]) -> Poly:
    """p as a polynomial of the distances from a point."""
    for i, c in enumerate(centre):
        found: Poly = {}
        for key, x in p.items():
            for j in range(key[i] + 1):
                new = (*key[:i], j, *key[i + 1 :])
                found[new] = found.get(new, Q(0)) + x * math.comb(key[i], j) * c ** (key[i] - j)
        p = found
    return p


def _in_time(term: Term, time: Q) -> Term:
    return Term(shifted(term.p, (Q(0), time)), shifted(term.g, (Q(0), time)), term.q)


def _interpolant(f: Formula, k: Q) -> Poly:
    """Through the values at four places and three times, in (θ − 1/2, t − middle)."""
    places, times_of = [Q(i, 3) - Q(1, 2) for i in range(4)], [-k / 2, Q(0), k / 2]
    found: Poly = {}
    for x, s in product(places, times_of):
        shape: Poly = {(0, 0): at(f, (x, s))}
        for i, own, others in ((0, x, places), (1, s, times_of)):
            for other in others:
                if other != own:
                    factor = {(0, 0): -other / (own - other), (1 - i, i): 1 / (own - other)}
                    shape = times(shape, factor)
        found = plus(found, shape)
    return found


def _mean_square(f: Formula, radii: tuple[Q, Q], slack: Q, depth: int) -> Q:
    """A bound of the mean of (|Σ terms| + slack)² for |v_i| ≤ r_i, halving where a term has a kink."""
    plain = [term.plain(radii) for term in f]
    kinked = [term for term, p in zip(f, plain, strict=True) if p is None]
    if not depth or (not kinked and depth < DEPTH):
        size = size_of(reduce(plus, (p for p in plain if p), {}), radii)
        return up((size + sum((term.largest(radii) for term in kinked), slack)) ** 2)
    half = radii[0] / 2, radii[1] / 2
    parts = []
    for x, s in product((-half[0], half[0]), (-half[1], half[1])):
        moved = tuple(Term(shifted(term.p, (x, s)), shifted(term.g, (x, s)), term.q) for term in f)
        parts.append(_mean_square(moved, half, slack, depth - 1))
    return sum(parts, Q(0)) / 4


# Displacements


class Displacements:
    """Continuous, quadratic on the cells: Bernstein coefficients of vertices, then of edges, two integers each."""

    def __init__(self, mesh: Mesh, A: Matrix) -> None:
        self.mesh = mesh
        self.size = 2 * (len(mesh.points) + len(mesh.edges))
        (self.A, self.over) = common(A)
        self.cells = []
        for cell, sides in zip(mesh.cells, mesh.sides, strict=True):
            turned = [mesh.along((cell[(i + 1) % 3], cell[(i + 2) % 3])) for i in range(3)]
            places = [[2 * n for n in (*cell, *(len(mesh.points) + e for e in sides))]]
            self.cells.append((places[0], turned, mesh.determinant(cell)))

    def strains(self, v: Sequence[int]) -> Iterator[list[tuple[int, int, int]]]:
        """ε(v) at the three vertices of each cell, times det F over twice the denominator of the mesh."""
        for n, ((x0, y0), (x1, y1), (x2, y2)), _ in self.cells:
            # Row i: the coefficients beside vertex i; ∇λ_j is (−y_j, x_j)/det F.
            beside = ((n[0], n[5], n[4]), (n[5], n[1], n[3]), (n[4], n[3], n[2]))
            found = []
            for a, b, c in beside:
                u, w = (v[a], v[b], v[c]), (v[a + 1], v[b + 1], v[c + 1])
                found.append(
                    (
                        -y0 * u[0] - y1 * u[1] - y2 * u[2],
                        x0 * w[0] + x1 * w[1] + x2 * w[2],
                        x0 * u[0] + x1 * u[1] + x2 * u[2] - y0 * w[0] - y1 * w[1] - y2 * w[2],
                    )
                )
            yield found

    def square(self, v: Sequence[int], bits: int) -> tuple[Q, Q]:
        """Bounds of ‖v‖²_V for coefficients v/2^bits."""
        total = 0
        for strains, (_, _, det) in zip(self.strains(v), self.cells, strict=True):
            every = [*strains, tuple(map(sum, zip(*strains, strict=True)))]
            product_sum = sum(
                a * e[i] * e[j] for e in every for i, row in enumerate(self.A) for j, a in enumerate(row) if a
            )
            total += (product_sum << GRID) // det
        scale = 6 * self.over << (2 * bits + GRID)
        return Q(total, scale), Q(total + len(self.cells), scale)

    def refuse_outside(self, v: Sequence[int], problem: Problem) -> None:
        """v = 0 on Γ1 and v_ν ≤ 0 on Γ3, by Bernstein coefficients."""
        count = len(self.mesh.points)
        for edge, part in self.mesh.parts.items():
            start, end = problem.sides[part]
            normal = minus(end, start)[1], minus(start, end)[0]
            for n in (*edge, count + self.mesh.numbers[edge]):
                place = v[2 * n : 2 * n + 2]
                if problem.kinds[part] == "clamped":
                    require(not any(place), "ũ does not vanish on Γ1")
                elif problem.kinds[part] == "contact":
                    require(inner(place, normal) <= 0, "ũ_ν > 0 on Γ3: ũ is not in K")


class Computed:
    """u_h: P1 on a mesh, piecewise linear in time, from doubles, which are integers over a power of 2."""

    def __init__(self, data: Any, coarse: Mesh, refinements: int, problem: Problem) -> None:
        require(len(data) > 1 and all(len(u) == 2 * len(coarse.points) for u in data), "u_h has another size")
        rows, denominator = common([[Q(x) for x in u] for u in data])
        self.bits = denominator.bit_length() - 1
        require(denominator == 1 << self.bits, "u_h is not given by doubles")
        for (a, b), part in coarse.parts.items():
            if problem.kinds[part] == "clamped":
                require(
                    not any(u[2 * v + c] for u in rows for v in (a, b) for c in (0, 1)), "u_h does not vanish on Γ1"
                )
        mesh = coarse
        for _ in range(refinements):
            rows, mesh = [self._with_middles([2 * x for x in u], mesh) for u in rows], mesh.refined()
            self.bits += 1
        self.values = [self._with_middles([2 * x for x in u], mesh) for u in rows]
        self.bits += 1
        self.T = problem.T

    def _with_middles(self, u: list[int], mesh: Mesh) -> list[int]:
        """Twice the values in, and with the means of the ends of edges out."""
        return u + [(u[2 * a + c] + u[2 * b + c]) // 2 for a, b in mesh.edges for c in (0, 1)]

    def at(self, time: Q) -> tuple[list[int], int]:
        """Integers v and a denominator with u_h(time) = v/(denominator · 2^bits)."""
        place = time / self.T * (len(self.values) - 1)
        low = min(int(place), len(self.values) - 2)
        share = place - low
        a, b = share.denominator - share.numerator, share.numerator
        return [a * x + b * y for x, y in zip(self.values[low], self.values[low + 1], strict=True)], share.denominator


# Stresses and the residual of the law

SHARES = ((6, 3, 1), (3, 4, 3), (1, 3, 6))
"""30 ∫_0^1 B_a B_b of the Bernstein polynomials of degree 2."""
Field = list[tuple[list[int], list[int], list[int]]]
"""For each cell and component 30 coefficients."""


class Stresses:
    """σ̃ on one mesh from tractions and inner numbers, in units of 1/(2^bits · scale)."""

    def __init__(self, mesh: Mesh, problem: Problem, data: Any) -> None:
        self.mesh, self.problem = mesh, problem
        self.bits, self.coarse = data["bits"], data["coarse"]
        integers(self.bits, self.coarse)
        require(self.bits > 0 <= self.coarse, "the stresses have no unit")
        self.element = element()
        places = [[Q(j, 3) for j in range(4) if j != i] for i in range(4)]
        lagrange = [
            reduce(times, [{(0,): -x / (Q(i, 3) - x), (1,): 1 / (Q(i, 3) - x)} for x in others])
            for i, others in enumerate(places)
        ]
        rows, self.scale = common([*legendre(CUBICS), *legendre(lagrange)])
        self.from_bernstein, self.from_values = rows[:4], rows[4:]
        self.contact = [e for e, edge in enumerate(mesh.edges) if self._kind(edge) == "contact"]
        self.free = [e for e, edge in enumerate(mesh.edges) if self._kind(edge) in (None, "clamped")]

    def _kind(self, edge: tuple[int, int]) -> str | None:
        return self.problem.kinds[self.mesh.parts[edge]] if edge in self.mesh.parts else None

    @property
    def unit(self) -> int:
        """One over what the integers of a field stand for, before the factor of a cell."""
        return (self.scale * self.element.K * self.mesh.denominator) << self.bits

    def tractions(self, numbers: Sequence[int], load: Load) -> tuple[list[list[int]], list[list[int]]]:
        """σ̃N of all edges by 4 × 2 coefficients of Legendre, N = |e|ν to the right of the edge, and σ̃_ν on Γ3.

        On Γ3 σ̃N = σ̃_ν N with the Bernstein coefficients of σ̃_ν, four numbers an edge; on Γ2 it is the load; on other
        edges there are eight numbers, of which the last four are in coarser units.
        """
        require(len(numbers) == 4 * len(self.contact) + 8 * len(self.free), "tractions have another size")
        integers(numbers)
        found = [[0] * 8 for _ in self.mesh.edges]
        normal, denominator = [], self.mesh.denominator
        for i, e in enumerate(self.contact):
            tau = list(numbers[4 * i : 4 * i + 4])
            require(max(tau) <= 0, "σ̃_ν > 0 on Γ3: the stress is not admissible")
            normal.append(tau)
            x, y = self.mesh.along(self.mesh.edges[e])
            modes = [sum(map(mul, row, tau)) for row in self.from_bernstein]
            found[e] = [c for mode in modes for c in (mode * y, -mode * x)]
        for i, e in enumerate(self.free):
            start = 4 * len(self.contact) + 8 * i
            eight = [*numbers[start : start + 4], *(x << self.coarse for x in numbers[start + 4 : start + 8])]
            found[e] = [x * self.scale * denominator for x in eight]
        for e, values in load.traction.items():
            sign = self.mesh.outward[e] * denominator
            found[e] = [sign * sum(map(mul, row, values[d::2])) for row in self.from_values for d in (0, 1)]
        return found, normal

    def field(self, tractions: list[list[int]], inner_numbers: Sequence[int], load: Load) -> tuple[Field, Q]:
        """F X Fᵀ of all cells and a bound of ‖Div σ̃ + f̃_0‖; σ̃ is this times denominator/(det F)²/unit."""
        require(len(inner_numbers) == INNER_INPUTS * len(self.mesh.cells), "the inner numbers have another size")
        integers(inner_numbers)
        rows, factor, total = self.element.rows, self.scale * self.mesh.denominator, 0
        if not load.force:
            rows = tuple([row[:EDGE_INPUTS] + row[36:] for row in component] for component in rows)
        found: Field = []
        for number, (cell, sides) in enumerate(zip(self.mesh.cells, self.mesh.sides, strict=True)):
            (a, b), (c, d) = self.mesh.map(cell)
            inputs: list[int] = []
            for i, e in enumerate(sides):
                t = tractions[e]
                if cell[(i + 1) % 3] > cell[(i + 2) % 3]:
                    t = [-t[0], -t[1], t[2], t[3], -t[4], -t[5], t[6], t[7]]
                inputs += [x for j in (0, 2, 4, 6) for x in (d * t[j] - b * t[j + 1], a * t[j + 1] - c * t[j])]
            if load.force:
                g = load.force[number]
                inputs += [
                    factor * x for j in range(0, 12, 2) for x in (d * g[j] - b * g[j + 1], a * g[j + 1] - c * g[j])
                ]
            total += self._unbalanced(inputs, (a, b, c, d))
            inputs += [(factor * x) << self.coarse for x in inner_numbers[9 * number : 9 * number + 9]]
            x, y, z = ([sum(map(mul, row, inputs)) for row in component] for component in rows)
            found.append(
                (
                    [a * a * p + b * b * q + 2 * a * b * r for p, q, r in zip(x, y, z, strict=True)],
                    [c * c * p + d * d * q + 2 * c * d * r for p, q, r in zip(x, y, z, strict=True)],
                    [a * c * p + b * d * q + (a * d + b * c) * r for p, q, r in zip(x, y, z, strict=True)],
                )
            )
        return found, root(Q(total, 1 << GRID) * Q(self.mesh.denominator, self.unit) ** 2)

    def _unbalanced(self, inputs: list[int], F: tuple[int, ...]) -> int:
        """∫ |F q̂|²/(det F)³ over the reference triangle, rounded up to the grid."""
        a, b, c, d = F
        p, q, r = (sum(map(mul, row, inputs)) for row in self.element.rigid)
        if not (p or q or r):
            return 0
        uu, vv, uv = 36 * p * p + 2 * r * r, 36 * q * q + 2 * r * r, 36 * p * q + r * r  # 72 ∫ q̂_i q̂_j
        size = (a * a + c * c) * uu + 2 * (a * b + c * d) * uv + (b * b + d * d) * vv
        return (size << GRID) // (72 * (a * d - b * c) ** 3) + 1


class Residual:
    """ρ = σ̃ − Aε(ũ̇) − Gε(ũ) as a field, by its coefficients times (det F)²/denominator and a common unit."""

    def __init__(self, stresses: Stresses, displacements: Displacements, k: Q, bits: int) -> None:
        """k: step between two nodes of ũ; ``bits``: of displacements given here."""
        self.space, self.k = displacements, k
        problem = stresses.problem
        rows, law = common([*problem.A, *problem.G])
        self.A, self.G = rows[:3], rows[3:]
        below, above = stresses.unit, 9 * law * k.numerator << bits  # 18 of the thirds, and 2 of the strains
        self.unit = math.lcm(below, above)
        self.of_stress, self.of_law = self.unit // below, self.unit // above
        self.element = stresses.element

    def field(self, stress: Field, u: Sequence[int], step: Sequence[int]) -> Field:
        """ρ with ε(ũ) from u and ε(ũ̇) from a difference of nodes, divided by k."""
        found: Field = []
        elastic, viscous = self.space.strains(u), self.space.strains(step)
        A = [[a * self.k.denominator * self.of_law for a in row] for row in self.A]
        G = [[g * self.k.numerator * self.of_law for g in row] for row in self.G]
        for components, at_u, at_step, (_, _, det) in zip(stress, elastic, viscous, self.space.cells, strict=True):
            mine = []
            for values, row_A, row_G in zip(components, A, G, strict=True):
                p = [
                    det * (sum(map(mul, row_A, r)) + sum(map(mul, row_G, e)))
                    for r, e in zip(at_step, at_u, strict=True)
                ]
                scaled = [self.of_stress * x for x in values]
                every = sum(p)
                for third in range(3):
                    first, second = p[(third + 1) % 3], p[(third + 2) % 3]
                    scaled[10 * third] -= 2 * (3 * (first + second) + every)
                    scaled[10 * third + 1] -= 9 * (first - second)
                    scaled[10 * third + 2] -= 2 * every - 3 * (first + second)
                mine.append(scaled)
            found.append((mine[0], mine[1], mine[2]))
        return found

    def products(self, one: Field, other: Field) -> list[list[Q]]:
        """∫_Ω ρ_I ρ'_J, each rounded up and down by less than 2^{−GRID}: symmetrised, (3, 3)."""
        total, squares = [[0] * 3 for _ in range(3)], self.element.squares
        for mine, others, (_, _, det) in zip(one, other, self.space.cells, strict=True):
            cube = det**3
            for i, values in enumerate(mine):
                weighted = list(map(mul, squares, values))
                for j in range(3):
                    total[i][j] += (sum(map(mul, weighted, others[j])) << GRID) // cube
        scale = self.element.unit * self.unit**2 << GRID
        return [[Q(total[i][j] + total[j][i], 2 * scale) for j in range(3)] for i in range(3)]

    @property
    def rounding(self) -> Q:
        """What one of the products may lack."""
        return Q(len(self.space.cells), self.element.unit * self.unit**2 << GRID)


# The bound


@dataclass(frozen=True)
class Piece:
    """ũ between two knots a < b by its Bernstein coefficients in time, integers over the same power of 2."""

    a: Q
    b: Q
    values: tuple[list[int], list[int], list[int]]
    steps: tuple[list[int], list[int], list[int]]


def pieces(nodes: list[list[int]], T: Q) -> Iterator[Piece]:
    """The quadratic spline with nodes at equal distances k as control points; its coefficients and k ũ̇, times 4.

    Knots are 0, k/2, 3k/2, …, T. A point of the spline is a convex combination of nodes.
    """
    k = T / (len(nodes) - 1)
    differences = [[4 * (y - x) for x, y in zip(p, q, strict=True)] for p, q in pairwise(nodes)]
    middles = [[2 * (x + y) for x, y in zip(p, q, strict=True)] for p, q in pairwise(nodes)]
    times_of = [Q(0), *(k * Q(2 * j + 1, 2) for j in range(len(nodes) - 1)), T]
    rates = [differences[0], *differences, differences[-1]]
    places = [[4 * x for x in nodes[0]], *middles, [4 * x for x in nodes[-1]]]
    for j, (a, b) in enumerate(pairwise(times_of)):
        straight = j in (0, len(nodes) - 1)
        control = (
            [(x + y) // 2 for x, y in zip(places[j], places[j + 1], strict=True)]
            if straight
            else [4 * x for x in nodes[j]]
        )
        mean = [(x + y) // 2 for x, y in zip(rates[j], rates[j + 1], strict=True)]
        yield Piece(a, b, (places[j], control, places[j + 1]), (rates[j], mean, rates[j + 1]))


@dataclass(frozen=True)
class Added:
    """What a piece adds: its length, M = ∫∫ ρ ρᵀ, ∫ c and ∫ of the dual norm of f − f̃ and of Div σ̃ + f̃_0."""

    k: Q
    M: list[list[Q]]
    contact: Q
    loads: Q


class Growth:
    """Bounds of ‖u − ũ‖_V at the end of a piece and inside from that at its start."""

    def __init__(self, problem: Problem, m: Q) -> None:
        require(m >= 0, "m is negative")
        require(definite(combined(problem.G, problem.A, -m), strictly=False), "G − mA is not positive semidefinite")
        self.A, self.G, self.m = problem.A, problem.G, m
        self.compliance = inverse(problem.A)

    def __call__(self, y: Q, added: Added) -> tuple[Q, Q]:
        found = [bounds for theta in {Q(0), self.m} for bounds in self._bounds(theta, y, added)]
        return min(at_b for at_b, _ in found), min(inside for _, inside in found)

    def _bounds(self, theta: Q, y: Q, added: Added) -> Iterator[tuple[Q, Q]]:
        """With W = H(H + βA)⁻¹ for H = G − θA and some β > 0, which need not be good ones, and W = 0."""
        M, k, x = added.M, added.k, 2 * theta * added.k
        H, square = combined(self.G, self.A, -theta), y * y
        decayed, mean = decay(x), up(k * mean_decay(x))

        def bounds(taken: Q, left: Q) -> tuple[Q, Q, Q]:
            first, second = root(up(decayed * square + taken)), root(up(mean * left)) + added.loads
            beta = Q(round(root(up(left / k)) / (2 * first) * (1 << 40)) + 1, 1 << 40) if first else Q(0)
            return beta, up(first + second), up(root(up(square + taken)) + second)

        start, at_b, inside = bounds(2 * added.contact, traced(self.compliance, M))
        yield at_b, inside
        for beta, rounds in ((start, 3), (1 / k / (1 << 20), 4)):
            for _ in range(rounds):
                if beta:
                    mixed = inverse(combined(H, self.A, beta))
                    of_H, of_A = (product_of(mixed, product_of(one, mixed)) for one in (H, self.A))
                    beta, at_b, inside = bounds(2 * added.contact + traced(of_H, M) / 2, beta**2 * traced(of_A, M))
                    yield at_b, inside


@dataclass(frozen=True)
class Found:
    """What is proved of one certificate; ``cells`` is the number of cells of the mesh of u_h."""

    level: int
    cells: int
    low: Q
    high: Q
    last: Q


class Certificate:
    """A problem, a mesh, u_h and the witnesses."""

    def __init__(self, data: Any) -> None:
        require(data.get("format") == FORMAT, f"not a certificate: the format is not {FORMAT!r}")
        self.level = data["level"]
        integers(self.level)
        problem = self.problem = Problem(data["problem"])
        self.volume, self.surface = load_constants(data["constants"], problem)
        coarse = mesh = Mesh.of(data["mesh"], problem)
        for _ in range(data["refinements"]):
            mesh = mesh.refined()
        self.cells, self.mesh = len(coarse.cells), mesh
        self.computed = Computed(data["computed"], coarse, data["refinements"], problem)
        self.space = Displacements(mesh, problem.A)
        self.bits, self.nodes = data["displacement"]["bits"], data["displacement"]["nodes"]
        integers(self.bits, *self.nodes)
        require(len(self.nodes) > 1 and all(len(v) == self.space.size for v in self.nodes), "ũ has another size")
        for v in self.nodes:
            self.space.refuse_outside(v, problem)
        self.growth = Growth(problem, Q(data["m"]))
        self.stresses = Stresses(mesh, problem, data["stress"])
        self.numbers = list(zip(data["stress"]["tractions"], data["stress"]["inner"], strict=True))
        require(len(self.numbers) == 2 * len(self.nodes) + 1, "there is not one stress for every coefficient in time")

    def check(self) -> Found:
        """Compute the bounds."""
        problem, k = self.problem, self.problem.T / (len(self.nodes) - 1)
        loads = Loads(problem, self.mesh, self.stresses.bits)
        residual = Residual(self.stresses, self.space, k, self.bits + 2)
        y = up(self._start())
        low, high, left = Q(0), y + root(self._distance(self._at_start(), Q(0))[1]), None
        for j, piece in enumerate(pieces(self.nodes, problem.T)):
            every: list[Any] = [] if left is None else [left]
            for i in range(len(every), 3):
                load = loads.control(piece.a, piece.b) if i == 1 else loads.at_knot((piece.a, piece.a, piece.b)[i])
                tractions, normal = self.stresses.tractions(self.numbers[2 * j + i][0], load)
                stress, unbalanced = self.stresses.field(tractions, self.numbers[2 * j + i][1], load)
                every.append((residual.field(stress, piece.values[i], piece.steps[i]), normal, unbalanced))
            left = every[2]
            length = piece.b - piece.a
            missed = loads.missed(piece.a, piece.b, self.volume, self.surface)
            unbalanced = self.volume * sum((one[2] for one in every), Q(0)) / 3
            M = self._mean_products(residual, [one[0] for one in every], length)
            contact = self._contact(piece, [one[1] for one in every])
            y, inside = self.growth(y, Added(length, M, contact, up(length * (missed + unbalanced))))
            largest, (end_low, _) = self._distances(piece)
            low, high = max(low, root(end_low, above=False) - y), max(high, inside + root(largest))
        return Found(self.level, self.cells, low, high, y)

    def _mean_products(self, residual: Residual, every: list[Field], k: Q) -> list[list[Q]]:
        """∫∫ ρ ρᵀ, with the rounding on the diagonal, where it makes every use of M larger."""
        found = [[Q(0)] * 3 for _ in range(3)]
        for a, b in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)):
            share = k * Q(SHARES[a][b], 30) * (1 if a == b else 2)
            found = combined(found, residual.products(every[a], every[b]), share)
        return [
            [up(x) + (4 * k * residual.rounding + Q(4, 1 << GRID)) * (i == j) for j, x in enumerate(row)]
            for i, row in enumerate(found)
        ]

    def _contact(self, piece: Piece, normal: list[list[list[int]]]) -> Q:
        """∫∫_{Γ3} σ̃_ν ũ_ν."""
        total, count, mesh = 0, len(self.mesh.points), self.mesh
        for i, e in enumerate(self.stresses.contact):
            a, b = mesh.edges[e]
            x, y = mesh.along((a, b))
            for s, r in product(range(3), repeat=2):
                u = piece.values[r]
                v = [mesh.outward[e] * (y * u[2 * n] - x * u[2 * n + 1]) for n in (a, count + e, b)]
                # ∫ B_p B_q is C(3, p) C(2, q)/C(5, p + q)/6, which over 60 is an integer.
                mass = sum(
                    w * v[q] * (math.comb(3, p) * math.comb(2, q) * 10 // math.comb(5, p + q))
                    for (p, w), q in product(enumerate(normal[s][i]), range(3))
                )
                total += SHARES[s][r] * mass
        unit = 30 * 60 * mesh.denominator << self.stresses.bits + self.bits + 2
        found = (piece.b - piece.a) * Q(total, unit)
        require(found >= 0, "the work of contact is negative")
        return found

    def _distance(self, v: Sequence[int], time: Q) -> tuple[Q, Q]:
        """Bounds of ‖v − u_h(time)‖²_V for coefficients v/2^{bits + 4}."""
        u, over = self.computed.at(time)
        bits = max(self.bits + 4, self.computed.bits)
        mine, theirs = over << bits - self.bits - 4, 1 << bits - self.computed.bits
        low, high = self.space.square([mine * x - theirs * w for x, w in zip(v, u, strict=True)], bits)
        return low / over**2, high / over**2

    def _at_start(self) -> list[int]:
        return [16 * x for x in self.nodes[0]]

    def _distances(self, piece: Piece) -> tuple[Q, tuple[Q, Q]]:
        """A bound of ‖ũ(t) − u_h(t)‖²_V on a piece, and bounds at its end.

        A node of u_h has to be an end or the middle of the piece; the square is convex along control points of halves.
        """
        middle, count = (piece.a + piece.b) / 2, len(self.computed.values) - 1
        for t in (piece.a, middle):
            first, last = (count * x / self.computed.T for x in (t, t + (piece.b - piece.a) / 2))
            require(math.floor(last) <= first or last == math.floor(first) + 1, "u_h has a node inside half a piece")
        start, control, end = piece.values
        points = [
            [4 * x for x in start],
            [2 * (x + y) for x, y in zip(start, control, strict=True)],
            [x + 2 * y + z for x, y, z in zip(start, control, end, strict=True)],
            [2 * (x + y) for x, y in zip(control, end, strict=True)],
            [4 * x for x in end],
        ]
        times_of = [piece.a, (piece.a + middle) / 2, middle, (middle + piece.b) / 2, piece.b]
        found = [self._distance(v, t) for v, t in zip(points, times_of, strict=True)]
        return max(high for _, high in found), found[-1]

    def _start(self) -> Q:
        """A bound of ‖u_0 − ũ(0)‖_V."""
        if not any(self.problem.start):
            return root(self.space.square(self._at_start(), self.bits + 4)[1])
        strains, total, mesh = list(self.space.strains(self.nodes[0])), Q(0), self.mesh
        u, v = self.problem.start
        exact = [derivative(u, 0), derivative(v, 1), plus(derivative(u, 1), derivative(v, 0))]
        for cell, at_vertices in zip(mesh.cells, strains, strict=True):
            (a, b), (c, d) = mesh.map(cell)
            det, (x, y) = mesh.determinant(cell), mesh.place(cell[0])
            h = mesh.denominator
            images = [{(0, 0): x, (1, 0): Q(a, h), (0, 1): Q(b, h)}, {(0, 0): y, (1, 0): Q(c, h), (0, 1): Q(d, h)}]
            difference = []
            for i, p in enumerate(exact):
                mine = compose(p, images) if p else {}
                for vertex, shape in zip(at_vertices, BARYCENTRIC, strict=True):
                    mine = plus(mine, shape, -Q(2 * h * vertex[i], det << self.bits))
                difference.append(mine)
            energy = sum(
                (
                    self.problem.A[i][j] * on_triangle(times(difference[i], difference[j]))
                    for i, j in product(range(3), repeat=2)
                ),
                Q(0),
            )
            total += up(energy * Q(det, h * h))
        return root(total)


def derivative(p: Poly, i: int) -> Poly:
    return {(*key[:i], key[i] - 1, *key[i + 1 :]): c * key[i] for key, c in p.items() if key[i]}


def order(coarse: Found, fine: Found) -> tuple[Q, Q] | None:
    """The ends of an interval with log(E/E')/log(h/h'), h² = 2|Ω|/cells, where both intervals are positive."""
    if coarse.low <= 0 or fine.low <= 0 or fine.cells <= coarse.cells:
        return None
    sizes = logarithm(Q(fine.cells, coarse.cells))
    low, high = logarithm(coarse.low / fine.high)[0], logarithm(coarse.high / fine.low)[1]
    return 2 * low / sizes[low >= 0], 2 * high / sizes[high < 0]


def decimal(x: Q, above: bool, digits: int = 8) -> str:
    """x rounded outward to some decimals."""
    whole = math.ceil(x * 10**digits) if above else math.floor(x * 10**digits)
    return f"{'-' if whole < 0 else ''}{abs(whole) // 10**digits}.{abs(whole) % 10**digits:0{digits}d}"


def verified(data: Any) -> Found:
    """What a certificate proves; RefusedError if it is none."""
    try:
        return Certificate(data).check()
    except RefusedError:
        raise
    except (KeyError, TypeError, ValueError, IndexError, AttributeError, ArithmeticError) as error:
        raise RefusedError(f"not a certificate: {type(error).__name__}: {error}") from error


def load(path: Path) -> Any:
    """What a file holds; RefusedError if it is no certificate."""
    try:
        return json.loads(gzip.decompress(path.read_bytes()))
    except (ValueError, EOFError, OSError) as error:
        raise RefusedError(f"not a certificate: {error}") from error


def main(paths: Sequence[str]) -> int:
    """Check files and print what they prove; 0 if none is refused."""
    kept: list[Found] = []
    stated: Any = None
    for path in paths:
        try:
            data = load(Path(path))
            found = verified(data)
            require(not kept or stated == data["problem"], "another problem than that of the first")
        except RefusedError as refusal:
            print(f"{path}: REFUSED: {refusal}")
            return 1
        stated = data["problem"]
        kept.append(found)
        interval = f"[{decimal(found.low, False)}, {decimal(found.high, True)}]"
        print(f"{path}:\n    level {found.level}, {found.cells} cells: max ‖u − u_h‖_V in {interval}")
    for fine, coarse in ((fine, coarse) for i, fine in enumerate(kept) for coarse in kept[:i]):
        span = order(coarse, fine)
        if span:
            ends = f"[{decimal(span[0], False, 4)}, {decimal(span[1], True, 4)}]"
            print(f"order from level {coarse.level} to {fine.level} in {ends}")
    print("the problem:")
    for name, value in (stated or {}).items():
        print(fill(f"    {name}: {json.dumps(value)}", 80, subsequent_indent=8 * " ", break_long_words=False))
    return 0 if kept else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
