"""The loads that belong to a displacement, by SymPy from the equations."""

import sympy as sp

from manufactured import Kind, x1, x2


def strain(w):
    """Return ε(w) in Mandel's order."""
    return [sp.diff(w[0], x1), sp.diff(w[1], x2), (sp.diff(w[0], x2) + sp.diff(w[1], x1)) / sp.sqrt(2)]


def stress(C, w):
    """Return C ε(w) as a matrix."""
    s = sp.Matrix(C.matrix) * sp.Matrix(strain(w))
    return sp.Matrix([[s[0], s[2] / sp.sqrt(2)], [s[2] / sp.sqrt(2), s[1]]])


def loads(sigma, body):
    """Return f_0 = −Div σ and f_2 = σν on the loaded sides."""
    f0 = [-sp.diff(sigma[i, 0], x1) - sp.diff(sigma[i, 1], x2) for i in range(2)]
    parts = enumerate(body.parts)
    return f0, {i: list(sigma * sp.Matrix(part.normal)) for i, part in parts if part.kind is Kind.LOADED}
