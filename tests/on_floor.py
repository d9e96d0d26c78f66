"""Exact solutions on the unit square with contact on its bottom."""

import sympy as sp

from manufactured import ContactFace, ExactSolution, Kind, unit_square


def on_floor(law, gap, pressure, level=1, T=1.0, **options):
    """The solution for a linear law; the options are those of ``ContactFace.linear``."""
    body = unit_square(T)
    (floor,) = body.of(Kind.CONTACT)
    face = ContactFace.linear(floor, law, T, sp.sympify(gap), sp.sympify(pressure), sp.sympify(level), **options)
    return ExactSolution(body, law, (face,))
