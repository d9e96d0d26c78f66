"""The stress element and the constants of the loads, which certificates state and the checker verifies.

**The reference element** is the composite element of degree 3 on the reference triangle, with exact coefficients. The
unknowns are the 90 coefficients of a stress σ̂ and three coefficients of a rigid motion q̂. The equations say that
tractions are continuous inside and prescribed on the boundary, and that Div σ̂ − q̂ = −f̂. They are solved for all
prescribed data at once, by row reduction over the rational numbers.

**The constants of the loads** are C_Ω and C_Γ with ∫ g·v ≤ C_Ω ‖g‖ ‖v‖_V and ∫_{Γ2} g·v ≤ C_Γ ‖g‖ ‖v‖_V. A tensor field
Φ proves them as follows. For a totally symmetric Φ, continuous and linear on cells, and v = 0 on Γ1,

    ∫ (div Φ)(v, v) + 2 (Φv)·ε(v) = ∫_{Γ2 ∪ Γ3} Φ(ν, v, v),

since (Φv)·∇v = (Φv)·ε(v). With −2 (Φv)·ε(v) ≤ Aε(v)·ε(v) + A⁻¹(Φv)·(Φv) it follows that

    ‖v‖_V² ≥ ∫ div Φ(v, v) − A⁻¹(Φv)·(Φv) − ∫_{Γ2 ∪ Γ3} Φ(ν, v, v) ≥ μ ‖v‖² + κ ‖v‖²_{L²(Γ2)}

if the integrands are large enough. It suffices to check 2 × 2 matrices at vertices, because the quadratic term is
convex on a cell. Korn's inequality is not needed. The largest κ, with a fixed ratio μ/κ, is the solution of a
semidefinite programme. Its conditions are written with a Schur complement:

    ( div Φ − μ 1   Φᵀ )
    ( Φ             A  )  ⪰ 0     at every vertex of every cell.
"""

from collections.abc import Iterator
from fractions import Fraction
from functools import cache
from itertools import product
from typing import Any

import clarabel
import numpy as np
import scipy.sparse as sps
from sympy import QQ
from sympy.polys.matrices import DomainMatrix

from manufactured.tensors import Array
from study.bound.problem import BoundError
from study.certify import checker
from study.certify.checker import CENTRE, CORNERS, CUBIC, SQUARE, Poly, X, Y

GIVEN, INNER = 36, 9
"""Numbers of inputs of the reference element: 36 prescribed tractions and forces, and 9 free coefficients."""
RIGID = ((checker.ONE, Poly()), (Poly(), checker.ONE), (Y * -1, X))
BITS = 28
"""Number of binary digits of the tensor field Φ: it is rounded to multiples of 2^−BITS."""
MARGIN = 1e-6
"""Margin in every semidefinite condition, because neither the solver nor the rounding of Φ is exact."""
WITH_FORCE, WITHOUT_FORCE = Fraction(1), Fraction(1, 100)
"""The ratio μ/κ of the two constants that are maximised together, for problems with and without a body force f_0.

Without f_0, the constant C_Ω is needed for rounding errors only, so μ can be small.
"""
SLACKS = (1e-4, 1e-3, 1e-2, 0.1)
"""Fractions by which κ is reduced until the rounded field Φ proves it; they are tried in turn."""
ENTRIES = ((0, 0), (0, 1), (1, 1))
"""Positions of the entries of a symmetric 2 × 2 matrix.

The k-th entry of Φv contains the components k and k + 1 of the tensor field Φ.
"""


# ---- the reference element: the stress for each prescribed traction and force


def _coefficients(tractions: list[Poly], divergences: list[Poly]) -> list[Fraction]:
    """Return the coefficients of 12 cubic polynomials on edges and of 6 polynomials of degree 2 on subtriangles."""
    on_edges = [p.get((n, 0, 0), Fraction(0)) for p in tractions for n in range(4)]
    return on_edges + [p.get(key, Fraction(0)) for p in divergences for key in SQUARE]


def _of_stress(component: int, third: int, monomial: int) -> list[Fraction]:
    """Return the contributions to all equations of a stress of which one coefficient is 1 and all others are 0.

    The equations are for tractions on the boundary, jumps of tractions inside, and divergences on the subtriangles.
    """
    one, stress = (third, component, monomial), []
    for i in range(3):
        stress.append([[Fraction((i, c, m) == one) for m in range(10)] for c in range(3)])
    outside, jumps, divergences = [], [], []
    for i in range(3):
        outside += checker.tractions(stress[i], CORNERS[(i + 1) % 3], CORNERS[(i + 2) % 3])
        left, right = (checker.tractions(stress[(i + n) % 3], CORNERS[i], CENTRE) for n in (1, 2))
        jumps += [p - q for p, q in zip(left, right, strict=True)]
        x, y, z = (checker.combination(checker.PLAIN, values) for values in stress[i])
        divergences += [x.slope(0) + z.slope(1), z.slope(0) + y.slope(1)]
    return _coefficients(outside + jumps, divergences)


@cache
def reference_element() -> tuple[dict[str, Any], Array]:
    """Return the reference element as a certificate states it, and which coefficients of its stresses are free.

    The element has 45 degrees of freedom: 36 prescribed tractions and forces, and 9 free coefficients. For each of
    them, ``columns`` contains the 90 coefficients of the stress for which it is 1 and all others are 0, as numerators
    of the common denominator ``over``. Coefficients are numbered by component (3), subtriangle (3) and monomial (10).
    """
    # Monomials of high degree are eliminated first: the columns are then ten times smaller, and low degrees stay free.
    unknowns = sorted(product(range(3), range(3), range(10)), key=lambda place: -sum(CUBIC[place[2]]))
    none = [Poly()]
    every = [_of_stress(*place) for place in unknowns]
    every += [_coefficients(none * 12, [p * -1 for p in motion] * 3) for motion in RIGID]
    for side, p, d in product(range(3), checker.bernstein(3, X), (0, 1)):
        every.append(_coefficients([p * -(n == 2 * side + d) for n in range(12)], none * 6))
    for key, d in product(SQUARE, (0, 1)):
        every.append(_coefficients(none * 12, [Poly({key: Fraction(1)}) if c == d else Poly() for c in (0, 1)] * 3))
    rows = [[QQ(x.numerator, x.denominator) for x in row] for row in zip(*every, strict=True)]
    solutions = DomainMatrix(rows, (len(rows), len(every)), QQ).nullspace(divide_last=True).to_list()
    # In each solution, the last coefficient that is not 0 is the degree of freedom, which is 1.
    freedoms = [max(n for n, x in enumerate(row) if x) for row in solutions]
    if freedoms[INNER:] != [*range(len(every) - GIVEN, len(every))]:
        raise ArithmeticError(f"the reference element has {len(freedoms) - GIVEN} free coefficients, expected {INNER}")
    order = np.lexsort(np.transpose(unknowns)[::-1])
    found = [[Fraction(int(row[n].numerator), int(row[n].denominator)) for n in order] for row in solutions]
    numerators, over = checker.common(found[INNER:] + found[:INNER])
    return {"over": over, "columns": numerators}, np.array(unknowns)[freedoms[:INNER]]


# ---- the constants of the loads, from a semidefinite programme


def constants(mesh: dict[str, Any], problem: checker.Problem) -> dict[str, Any]:
    """Return the constants of the loads as a certificate states them: a mesh, the field Φ at its vertices, μ and κ.

    Args:
        mesh: a mesh as a certificate states it.
        problem: the problem.

    Raises:
        BoundError: no tensor field was found that proves a constant.
    """
    exact = checker.Mesh.of(mesh, problem)
    inside = WITH_FORCE if any(problem.force) else WITHOUT_FORCE
    field, largest = _solve(exact, problem, float(inside))
    rounded = [[int(c) for c in row] for row in np.round(field * 2**BITS)]
    for slack in SLACKS:
        kappa = Fraction(largest * (1 - slack)).limit_denominator(10**6)
        found = {"mesh": mesh, "bits": BITS, "field": rounded, "volume": str(kappa * inside), "surface": str(kappa)}
        try:
            checker.load_constants(found, problem)
        except checker.RefusedError:
            continue
        return found
    raise BoundError(
        "no constant of the loads could be proved for this body: the checker refused every rounded field Φ; the mesh "
        "of the body may have very flat cells, so avoid small angles and very short sides"
    )


def _solve(mesh: checker.Mesh, problem: checker.Problem, inside: float) -> tuple[Array, float]:
    """Solve the semidefinite programme for the tensor field Φ with the largest κ.

    Args:
        mesh: the mesh on which Φ is linear.
        problem: the problem.
        inside: the ratio μ/κ.

    Returns:
        The four independent components of Φ at the vertices, (vertices, 4), and κ.
    """
    blocks = [*_inside(mesh, problem, inside), *_on_boundary(mesh)]
    unknowns = 4 * len(mesh.points) + 1
    # Clarabel expects the upper triangle of a matrix by columns, with off-diagonal entries multiplied by √2.
    rows, right = [], []
    for linear, constant in blocks:
        j, i = np.tril_indices(len(constant))
        scale = np.where(i == j, 1.0, np.sqrt(2))
        rows.append(sps.csr_matrix(-scale[:, None] * linear[i, j]))
        right.append(scale * constant[i, j])
    cones = [clarabel.PSDTriangleConeT(len(constant)) for _, constant in blocks]
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    objective = np.zeros(unknowns)
    objective[-1] = -1.0
    matrix, nothing = sps.csc_matrix(sps.vstack(rows)), sps.csc_matrix((unknowns, unknowns))
    solver = clarabel.DefaultSolver(nothing, objective, matrix, np.concatenate(right), cones, settings)
    x = np.array(solver.solve().x)
    return x[:-1].reshape(-1, 4), float(x[-1])


def _inside(mesh: checker.Mesh, problem: checker.Problem, inside: float) -> Iterator[tuple[Array, Array]]:
    """Yield the conditions of the programme at the vertices of the cells, as linear functions of the unknowns.

    The unknowns are the values of Φ, then κ. Each condition is the matrix with the Schur complement in the docstring of
    the module. It is a pair of coefficients, (5, 5, unknowns), and constants, (5, 5).
    """
    constant = -MARGIN * np.eye(5)
    constant[2:, 2:] = [[float(c) for c in row] for row in problem.A]
    for cell in mesh.cells:
        divergence = np.zeros((5, 5, 4 * len(mesh.points) + 1))
        a, b, c, d = (x * mesh.h / cell.det for x in cell.F)
        for w, slope in zip(cell.v, ((c - d, b - a), (d, -b), (-c, a)), strict=True):
            for k, entry in enumerate(ENTRIES):
                divergence[entry][[4 * w + k, 4 * w + k + 1]] += slope
        divergence[[0, 1], [0, 1], -1] -= inside
        for v in cell.v:
            block = divergence.copy()
            for stress, columns in enumerate(((0, 1), (2, 3), (1, 2))):
                block[[0, 1], 2 + stress, [4 * v + column for column in columns]] += 1
            yield block, constant


def _on_boundary(mesh: checker.Mesh) -> Iterator[tuple[Array, Array]]:
    """Yield the conditions of the programme at the ends of edges outside Γ1, in the same form as ``_inside``.

    The matrix is −Φ(ν), and on loaded edges −Φ(ν) − κ 1.
    """
    for edge, side in mesh.boundary.items():
        normal = np.array([float(c) for c in side.normal])
        normal /= np.linalg.norm(normal)
        for v in edge if side.kind != "clamped" else ():
            block = np.zeros((2, 2, 4 * len(mesh.points) + 1))
            for k, entry in enumerate(ENTRIES):
                block[entry][[4 * v + k, 4 * v + k + 1]] -= normal
            if side.load:
                block[[0, 1], [0, 1], -1] -= 1
            yield block, -MARGIN * np.eye(2)
