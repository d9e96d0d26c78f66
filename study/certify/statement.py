"""Data of a problem in rational numbers, as a certificate states them.

A double stands for the simplest fraction that rounds to it, 0.8 for 4/5, if its denominator is at most ``SIMPLE``, and
for itself otherwise. What the certificate proves is about the problem that it states.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp

from manufactured.body import Body, Kind
from manufactured.data import Data, Expressions
from manufactured.factor import UNIFORM, x1, x2
from manufactured.law import Indefinite, KelvinVoigt, Linear
from manufactured.symbols import pos, t
from manufactured.tensors import Array
from study.bound.problem import BoundError

SIMPLE = 10**6
"""The largest denominator of a fraction that a double is read as."""
NAMES = {Kind.CLAMPED: "clamped", Kind.LOADED: "loaded", Kind.CONTACT: "contact"}
SERVED = "certificates serve polynomials in x1, x2 and t with rational coefficients, times pos(polynomial, q) in f_2"


def rational(x: float) -> Fraction:
    """The fraction that a double stands for."""
    simple = Fraction(x).limit_denominator(SIMPLE)
    return simple if float(simple) == x else Fraction(x)


def statement(data: Data) -> dict[str, Any]:
    """What a certificate says of the problem.

    Raises:
        BoundError: body, law or data are not served, and why.
    """
    if data.body.dim != 2 or data.body.interfaces:
        raise BoundError("certificates serve plane bodies without interfaces")
    expressions = data.formulas_of
    if not isinstance(expressions, Expressions):
        raise BoundError(
            "certificates serve data that are formulas, made by Data.formulas; these are values of an exact solution "
            "or functions of Python, which `study bound` serves"
        )
    force = [_terms("f_0", formula) for formula in expressions.force]
    if any(q for component in force for _, _, q in component):
        raise BoundError("f_0 has a kink, pos(…); certificates serve kinks in f_2 only")
    loads = {number: [_terms("f_2", formula) for formula in load] for number, load in expressions.loads}
    return {
        "vertices": [[str(c) for c in corner] for corner in corners(data.body)],
        "kinds": [NAMES[part.kind] for part in data.body.parts],
        "T": str(rational(data.body.T)),
        **_law(data.law),
        "force": force,
        "loads": {str(number): load for number, load in loads.items() if any(load)},
        "start": [_polynomial("u_0", formula, (x1, x2)) for formula in expressions.start],
    }


def corners(body: Body) -> list[tuple[Fraction, Fraction]]:
    """The corners of a polygon."""
    return [(rational(float(part.start[0])), rational(float(part.start[1]))) for part in body.parts]


def _law(law: KelvinVoigt) -> dict[str, list[list[str]]]:
    found = {}
    for name, operator in (("A", law.A), ("G", law.G)):
        if not isinstance(operator, Linear) or operator.factor is not UNIFORM:
            raise BoundError(f"{name} is not linear and uniform; certificates serve no other law, `study bound` does")
        if isinstance(operator, Indefinite):
            raise BoundError(f"{name} need not be positive; certificates serve positive ones only, `study bound` any")
        found[name] = [[str(c) for c in row] for row in voigt(operator.matrix)]
    return found


def voigt(matrix: Array) -> list[list[Fraction]]:
    """A tensor in Voigt's components, stresses (11, 22, 12) from strains (11, 22, 2·12), from Mandel's."""
    scale = np.sqrt([1.0, 1.0, 0.5])
    # The root of 2 is rounded twice: a simple fraction that is as close is meant.
    values = scale[:, None] * ((matrix + matrix.T) / 2) * scale
    found = [[_near(float(c)) for c in row] for row in values]
    return [[found[min(i, j)][max(i, j)] for j in range(3)] for i in range(3)]


def _near(x: float) -> Fraction:
    simple = Fraction(x).limit_denominator(SIMPLE)
    return simple if abs(float(simple) - x) <= 4e-16 * abs(x) else Fraction(x)


def _terms(name: str, formula: sp.Expr) -> list[list[Any]]:
    """[[p, g, q], …] for the sum of p · pos(g, q); q = 0 and g = [] without pos."""
    grouped: dict[tuple[sp.Expr, int], sp.Expr] = {}
    for summand in sp.Add.make_args(sp.expand(sp.nsimplify(formula, rational=True))):
        factor, truncated = _split(name, summand)
        grouped[truncated] = grouped.get(truncated, sp.Integer(0)) + factor
    return [
        [_polynomial(name, factor, (x1, x2, t)), _polynomial(name, g, (x1, x2, t)) if q else [], q]
        for (g, q), factor in grouped.items()
        if factor != 0
    ]


def _split(name: str, summand: sp.Expr) -> tuple[sp.Expr, tuple[sp.Expr, int]]:
    """A summand as p · g_+^q: p and (g, q)."""
    plain, truncated = sp.Integer(1), list(_truncated(summand))
    for factor in sp.Mul.make_args(summand):
        if not factor.has(pos):
            plain *= factor
    if not truncated:
        return plain, (sp.Integer(0), 0)
    if len(truncated) > 1 or not truncated[0][1].is_Integer or truncated[0][1] < 1:
        raise BoundError(f"{name} has the summand {summand}; {SERVED}, q = 1, 2, …")
    g, q = truncated[0]
    return plain, (sp.expand(g), int(q))


def _truncated(summand: sp.Expr) -> Iterator[tuple[sp.Expr, sp.Expr]]:
    """The factors g_+^q."""
    for factor in sp.Mul.make_args(summand):
        if factor.has(pos):
            base, power = factor.as_base_exp()
            yield (base.args[0], base.args[1] * power) if isinstance(base, pos) else (base, sp.Rational(1, 2))


def _polynomial(name: str, formula: sp.Expr, symbols: tuple[sp.Symbol, ...]) -> list[list[Any]]:
    """[[coefficient, exponents …], …]."""
    try:
        p = sp.Poly(sp.nsimplify(formula, rational=True), *symbols, domain="QQ")
    except sp.PolynomialError as error:
        raise BoundError(f"{name} has {formula}; {SERVED}") from error
    except (sp.CoercionFailed, ValueError) as error:
        raise BoundError(f"{name} has {formula}, whose coefficients are not rational; {SERVED}") from error
    return [[str(Fraction(int(c.p), int(c.q))), *key] for key, c in p.terms() if c != 0]
