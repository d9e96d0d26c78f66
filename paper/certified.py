"""A problem over the rational numbers with a known solution: its certified interval next to the true error.

``study certify paper/certified.py:known --family one-diagonal --levels 4 --steps 8 --refine 1 --shorter 2`` makes the
certificate ``certified-4.json.gz``. ``python paper/certified.py FILE`` checks the certificate and writes LaTeX macros.

The body is the unit square, in contact along its whole lower side: w = 0, q = −t (1 + 4s(1 − s)), φ(y) = 1 − y² in the
lifting, so that p = (a + g t)(1 + 4s(1 − s)) > 0 with a = 5/2, g = 7. The displacement is linear in time.
"""

from __future__ import annotations

import sys
from fractions import Fraction
from pathlib import Path

import numpy as np
from sympy import Expr, Matrix, Rational, diff, expand, eye, lambdify

from manufactured import Data, KelvinVoigt, Kind, isotropic, polygon, t, x1, x2
from study.certify import checker
from study.ledger.text import above, below

CERTIFICATE = Path(__file__).with_name("certified-4.json.gz")
LAME = {"A": (1, Rational(1, 2)), "G": (2, 3)}
"""(μ, λ) of A and G."""
DISPLACEMENT = Matrix([0, -x2 * (1 - x2**2) * t * (1 + 4 * x1 * (1 - x1))])
POINTS = 6
"""Gauss points in each direction: exact up to degree 10, and squares of strains have the degree 8."""


def strain(u: Matrix) -> Matrix:
    gradient = Matrix(2, 2, lambda i, j: diff(u[i], (x1, x2)[j]))
    return (gradient + gradient.T) / 2


def stress(u: Matrix) -> Matrix:
    parts = zip(LAME.values(), (strain(u.diff(t)), strain(u)), strict=True)
    return sum((2 * mu * e + lam * e.trace() * eye(2) for (mu, lam), e in parts), Matrix.zeros(2, 2))


def known() -> Data:
    """Return the data of the problem."""
    kinds = [Kind.CONTACT, Kind.LOADED, Kind.CLAMPED, Kind.LOADED]
    body, law = polygon([(0, 0), (1, 0), (1, 1), (0, 1)], kinds), KelvinVoigt(*map(_tensor, "AG"), "linear")
    sigma = stress(DISPLACEMENT)
    f0 = [expand(-diff(sigma[i, 0], x1) - diff(sigma[i, 1], x2)) for i in range(2)]
    side: list[Expr] = [expand(sigma[i, 0]) for i in range(2)]
    return Data.formulas(body, law, f0=f0, f2={1: side, 3: [-f for f in side]})


def _tensor(name: str) -> object:
    return isotropic(*map(float, LAME[name]))


def true_error(certificate: dict[str, object]) -> float:
    """Return max ‖u − u_h‖_V. Both functions are linear in time between the times of u_h, so it is attained there."""
    mesh = certificate["mesh"]
    points = np.array(mesh["points"], float) / mesh["denominator"]
    cells = np.array(mesh["cells"])
    corners = points[cells]
    jacobian = np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=-1)
    size = np.linalg.det(jacobian)
    gradients = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]]) @ np.linalg.inv(jacobian)
    nodes, weights = np.polynomial.legendre.leggauss(POINTS)
    nodes, weights = (nodes + 1) / 2, weights / 2
    a, b = np.meshgrid(nodes, nodes)
    local, weight = np.stack([a, b * (1 - a)]).reshape(2, -1), (np.outer(weights, weights) * (1 - a)).ravel()
    x = corners[:, 0, :, None] + jacobian @ local
    exact = lambdify((x1, x2, t), list(strain(DISPLACEMENT)))
    errors, values = [], np.array(certificate["computed"], float)
    for time, u in zip(np.linspace(0, 1, len(values)), values, strict=True):
        gradient = np.einsum("cki,ckj->cij", u.reshape(-1, 2)[cells], gradients)
        computed = (gradient + gradient.transpose(0, 2, 1)) / 2
        wanted = [np.broadcast_to(e, x[:, 0].shape) for e in exact(x[:, 0], x[:, 1], time)]
        e = np.stack(wanted).reshape(2, 2, *x[:, 0].shape) - computed.transpose(1, 2, 0)[..., None]
        mu, lam = map(float, LAME["A"])
        density = 2 * mu * (e**2).sum((0, 1)) + lam * (e[0, 0] + e[1, 1]) ** 2
        errors.append(np.sqrt((density @ weight) @ size))
    return float(max(errors))


def interval_and_error() -> tuple[Fraction, Fraction, float, int]:
    """Return the certified interval, the true error and the number of cells."""
    certificate = checker.load(CERTIFICATE)
    found = checker.verified(certificate)
    return found.low, found.high, true_error(certificate), found.cells


if __name__ == "__main__":
    low, high, error, cells = interval_and_error()
    macros = {"Low": below(float(low), 4), "High": above(float(high), 4), "Error": f"{error:.4f}", "Cells": cells}
    path = Path(sys.argv[1])
    path.parent.mkdir(parents=True, exist_ok=True)
    lines = [rf"\newcommand{{\certified{name}}}{{{value}}}" for name, value in macros.items()]
    path.write_text("\n".join([*lines, ""]), encoding="utf-8")
