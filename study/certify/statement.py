"""Writes the problem and its meshes in rational numbers, as a certificate states them.

**Numbers.** A double is read as the simplest fraction that rounds to it (0.8 is read as 4/5) if the denominator is at
most ``SIMPLE``, otherwise as its exact value. The certificate proves a bound for the problem with these fractions.

**Meshes.** Vertices are moved to rational points such that the cells cover the polygon exactly. An inner vertex moves
to the nearest point of a lattice of width 2^{−b}, where b depends on the size of the cells. A vertex on a part of the
boundary moves along the part, to a fraction of its length with denominator 2^b.
"""

import math
from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp
from scipy.spatial import cKDTree
from skfem import Mesh

from manufactured.body import Body, Kind
from manufactured.data import Data, Expressions
from manufactured.factor import UNIFORM, x1, x2
from manufactured.law import Indefinite, KelvinVoigt, Linear
from manufactured.symbols import pos, t
from manufactured.tensors import Array, Points
from study.bound.problem import BoundError
from study.certify import checker
from study.fem.mesh import determinants, simplicial_mesh, size
from study.fem.space import nodes_of
from study.ledger.files import Json

SIMPLE = 10**6
"""Largest denominator of a simple fraction that replaces a number in double precision."""
ON_PART = 1e-7
"""A vertex counts as lying on a part of the boundary up to this distance, relative to the mesh size."""
FINENESS = 64
"""The size of cells is at least this many times the width of the lattice to which vertices are moved."""
ROUNDED_TWICE = 4e-16
"""Relative rounding error of a number that is multiplied by √2 twice."""
SERVED = "certificates support polynomials in x1, x2 and t with rational coefficients, times pos(polynomial, q) in f_2"


def rational(x: float, tolerance: float = 0.0) -> Fraction:
    """Return the fraction that a number in double precision stands for.

    It is a fraction with a denominator of at most ``SIMPLE`` if there is one within the tolerance, otherwise the exact
    value of the number.

    Args:
        x: the number.
        tolerance: the largest relative distance of the simple fraction from x. With 0, the fraction must round to x.
    """
    exact = Fraction(x)
    simple = exact.limit_denominator(SIMPLE)
    return simple if abs(float(simple) - x) <= tolerance * abs(x) else exact


def statement(data: Data) -> Json:
    """Return the problem as a certificate states it, as data that JSON can write.

    Raises:
        BoundError: certificates do not support the body, the law or the data; the message gives the reason.
    """
    if data.body.dim != 2 or data.body.interfaces:
        raise BoundError("certificates support plane bodies without interfaces")
    if data.body.of(Kind.ROLLER) or len(data.body.loops) > 1 or data.body.is_moved:
        raise BoundError(
            "certificates support neither ROLLER sides nor holes nor prescribed displacements; use `study bound`, "
            "which does"
        )
    expressions = data.formulas_of
    if not isinstance(expressions, Expressions):
        raise BoundError(
            "certificates support data that are formulas, made by Data.formulas; these are values of an exact solution "
            "or functions of Python, which `study bound` serves"
        )
    force = [_terms("f_0", formula) for formula in expressions.force]
    if any(q for component in force for _, _, q in component):
        raise BoundError("f_0 has a kink, pos(…); certificates support kinks in f_2 only")
    loads = {}
    for number, load in expressions.loads:
        terms = [_terms("f_2", formula) for formula in load]
        if any(terms):
            loads[str(number)] = terms
    return {
        "vertices": [[str(c) for c in corner] for corner in corners(data.body)],
        "kinds": [part.kind.name.lower() for part in data.body.parts],
        "T": str(rational(data.body.T)),
        **_law(data.law),
        "force": force,
        "loads": loads,
        "start": [_polynomial("u_0", formula, (x1, x2)) for formula in expressions.start],
    }


def corners(body: Body) -> list[tuple[Fraction, ...]]:
    """Return the corners of a polygon as fractions, in the order of its parts."""
    return [tuple(map(rational, part.start.tolist())) for part in body.parts]


def _law(law: KelvinVoigt) -> dict[str, list[list[str]]]:
    tensors = {}
    for name, operator in (("A", law.A), ("G", law.G)):
        if not isinstance(operator, Linear) or operator.factor is not UNIFORM:
            raise BoundError(
                f"{name} is not linear and uniform, but certificates need this; use `study bound`, which does not"
            )
        if isinstance(operator, Indefinite):
            raise BoundError(
                f"{name} softens, but certificates need a positive one; use `study bound`, which does not need this"
            )
        tensors[name] = [[str(c) for c in row] for row in voigt(operator.matrix)]
    return tensors


def voigt(matrix: Array) -> list[list[Fraction]]:
    """Convert a fourth-order tensor from Mandel's to Voigt's components, as fractions.

    The result maps strains (11, 22, 2·12) to stresses (11, 22, 12).

    Args:
        matrix: the tensor in Mandel form, (3, 3).
    """
    scale = np.sqrt([1.0, 1.0, 0.5])
    # The factors √2 were rounded twice, so a simple fraction that differs by no more than this error is taken as exact.
    symmetric = (matrix + matrix.T) / 2
    values = scale[:, None] * symmetric * scale
    return [[rational(c, ROUNDED_TWICE) for c in row] for row in values.tolist()]


def _terms(name: str, formula: sp.Expr) -> list[list[Any]]:
    """Write a formula as a sum of terms p · pos(g, q), for the certificate.

    Args:
        name: the name of the quantity, for messages.
        formula: the formula.

    Returns:
        A list of terms [p, g, q]; a term without ``pos`` has g = [] and q = 0.
    """
    grouped: dict[tuple[sp.Expr, int], sp.Expr] = {}
    summands = sp.Add.make_args(sp.expand(sp.nsimplify(formula, rational=True)))
    for summand in summands:
        factor, truncated = _split(name, summand)
        grouped[truncated] = grouped.get(truncated, 0) + factor
    terms: list[list[Any]] = []
    for (g, q), factor in grouped.items():
        p = _polynomial(name, factor, (x1, x2, t))
        if p:
            terms.append([p, _polynomial(name, g, (x1, x2, t)), q])
    return terms


def _split(name: str, summand: sp.Expr) -> tuple[sp.Expr, tuple[sp.Expr, int]]:
    """Split a summand p · pos(g, q) of a formula into p and the pair (g, q); ``name`` is for messages."""
    if not summand.has(pos):
        return summand, (sp.Integer(0), 0)
    factor, truncated = summand.as_independent(pos, as_Add=False)
    base, power = truncated.as_base_exp()
    g, exponent = base.args if isinstance(base, pos) else (base, sp.nan)
    q = exponent * power
    if not q.is_Integer or q < 1:
        raise BoundError(f"{name} has the summand {summand}; {SERVED}, q = 1, 2, …")
    return factor, (sp.expand(g), int(q))


def _polynomial(name: str, formula: sp.Expr, symbols: tuple[sp.Symbol, ...]) -> list[list[Any]]:
    """Write a polynomial as a list of terms [coefficient, exponent, …]; ``name`` is its name in messages."""
    try:
        p = sp.Poly(sp.nsimplify(formula, rational=True), *symbols, domain="QQ")
    except sp.PolynomialError as error:
        raise BoundError(f"{name} has {formula}; {SERVED}") from error
    except (sp.CoercionFailed, ValueError) as error:
        raise BoundError(f"{name} has {formula}, whose coefficients are not rational; {SERVED}") from error
    return [[str(c), *key] for key, c in p.terms() if c]


def rational_mesh(mesh: Mesh, body: Body) -> Json:
    """Return a mesh as a certificate states it, with rational vertices.

    Args:
        mesh: a mesh of scikit-fem.
        body: the polygon on which the mesh was made.

    Returns:
        ``points`` has the numerators of the coordinates over the common ``denominator``, ``cells`` the vertices of each
        cell counter-clockwise, and ``sides`` the vertices on every part of the boundary, in their order along it.
    """
    h = size(mesh)
    unit = 2 ** math.ceil(math.log2(FINENESS / h))
    starts = corners(body)
    ends = [*starts[1:], starts[0]]
    points = []
    for point in mesh.p.T.tolist():
        points.append(tuple(Fraction(round(c * unit), unit) for c in point))
    chains = []
    for part, start, end in zip(body.parts, starts, ends, strict=True):
        shares = {}
        for v in np.flatnonzero(part.contains(mesh.p, ON_PART * h)).tolist():
            position = float(np.dot(mesh.p[:, v] - part.start, part.tangent)) / part.measure
            share = rational(position)
            if share.denominator > unit:
                share = Fraction(round(position * unit), unit)
            points[v] = tuple(a + share * (b - a) for a, b in zip(start, end, strict=True))
            shares[v] = share
        chain = sorted(shares, key=shares.__getitem__)
        chains.append(chain)
    denominator = math.lcm(*(c.denominator for point in points for c in point))
    cells = mesh.t.copy()
    clockwise = determinants(mesh.p, cells) < 0
    cells[1:, clockwise] = cells[:0:-1, clockwise]
    return {
        "denominator": denominator,
        "points": [[int(c * denominator) for c in point] for point in points],
        "cells": cells.T.tolist(),
        "sides": chains,
    }


def in_doubles(mesh: checker.Mesh) -> Mesh:
    """Convert a mesh of the checker, which has rational vertices, to a scikit-fem mesh in double precision."""
    points = np.array([[c / mesh.h for c in point] for point in mesh.points])
    cells = np.array([cell.v for cell in mesh.cells])
    return simplicial_mesh(points.T, cells.T)


class Twins:
    """One mesh in two programs: translates numbers of nodes and cells from the checker to scikit-fem.

    Args:
        skfem: the mesh in scikit-fem.
        exact: the same mesh in the checker, with rational vertices.

    Attributes:
        nodes: for each vertex and then each edge of the checker, the number of this node in scikit-fem, where vertices
            are also numbered before edges.
        cells: for each cell of the checker, its number in scikit-fem.
        corners: for each corner of a cell of the checker, its position 0, 1 or 2 in the cell of scikit-fem, (cells, 3).
    """

    def __init__(self, skfem: Mesh, exact: checker.Mesh) -> None:
        self.exact = exact
        points = np.array(exact.points, dtype=float) / exact.h
        midpoints = points[np.array(exact.edges)].mean(axis=1)
        triangles = np.array([cell.v for cell in exact.cells])
        centres = points[triangles].mean(axis=1)
        self.nodes = nearest(nodes_of(skfem), np.vstack([points, midpoints]))
        self.cells = nearest(skfem.p[:, skfem.t].mean(axis=1), centres)
        vertices = self.nodes[triangles]
        same = skfem.t.T[self.cells][:, None, :] == vertices[:, :, None]
        self.corners: Array = same.argmax(axis=2)


def nearest(places: Points, points: Array) -> Array:
    """Return for each of n points, (n, 2), the number of the nearest of given places, (2, m) → (n,)."""
    _, numbers = cKDTree(places.T).query(points)
    return np.asarray(numbers)
