"""Bodies without contact, or in full contact: elasticity and viscoelasticity with known solutions.

The solution is a polynomial w with w = 0 on the clamped side; the loads follow from it. In the static case its
stress lies in the space of stresses of degree 3. The theorem of Prager and Synge says

    ‖σ̃ − Gε(u_h)‖² = ‖σ − Gε(u_h)‖² + ‖σ̃ − σ‖²

in the norm of G⁻¹, so that the smallest left side belongs to σ̃ = σ: the upper bound has to equal the error. With full
contact the right side has the work of contact as well, which is 0 for σ̃ = σ.
"""

import math

import numpy as np
import pytest
import sympy as sp
from bodies import CLAMPED, CONTACT, LAW, LOADED, SQUARE
from loads import loads, strain, stress
from on_meshes import bounded_on, discretised_on

from manufactured import BodyError, ExactSolution, plane_stress, polygon, static
from manufactured.factor import x1, x2
from study.bound.bounded import series
from study.bound.enclosing import squared_distances
from study.bound.given import bound_displacement
from study.fem.mesh import Shaken

SLANTED = [(0.2, -0.1), (1.3, 0.2), (1, 1), (0, 1)]
FREE = ((1 - x2) * (x1 * x2 + x1), (1 - x2) * (x1**2 - 2 * x2))
"""A displacement that is cubic and 0 on the side x2 = 1."""
PRESSED = ((1 - x2**2) * x1**2 / 10, -x2 * (1 - x2) * (1 + x1))
"""A displacement with w_2 = 0, no shear and a compression at x2 = 0."""
PROBLEMS = {
    "upright": (SQUARE, LOADED, FREE),
    "slanted": (SLANTED, LOADED, FREE),
    "pressed": (SQUARE, CONTACT, PRESSED),
}


def body(shape):
    """Return a quadrilateral that is clamped on top and touches nothing, or the foundation below."""
    corners, bottom, _ = PROBLEMS[shape]
    return polygon(corners, [bottom, LOADED, CLAMPED, LOADED])


def strain_at(w, factor=1.0):
    """Return the function from points (2, ...) to ε(w), (3, ...)."""
    function = sp.lambdify((x1, x2), strain(w), "numpy")
    return lambda x: factor * np.array([np.broadcast_to(one, x.shape[1:]) for one in function(*x)], dtype=float)


def elastic(shape):
    G = plane_stress(E=2.0, nu=0.3)
    return static(body(shape), G, *loads(stress(G, PROBLEMS[shape][2]), body(shape)))


def check_static(data, w, found, least):
    """Assert that the error is the upper bound from u_h alone, and above the lower bound, which has a least part."""
    coarse = discretised_on(data, 2, Shaken())
    error = math.sqrt(squared_distances(coarse, strain_at(w), found.computed.on(coarse)(0.0), ()).sum())
    assert found.plain.highest == pytest.approx(error, rel=1e-8)
    assert least * error <= found.enclosure.lowest <= error <= found.enclosure.highest
    assert found.enclosure.evidence.kind == "guaranteed"
    size = math.sqrt(squared_distances(coarse, strain_at(w), np.zeros(coarse.displacements.dofs), ()).sum())
    assert found.norm[0] * (1 - 1e-9) <= size <= found.norm[1] * (1 + 1e-9)
    (row,) = series(2, found).itertuples()
    assert row.percent_high == pytest.approx(100 * row.upper / found.norm[0], rel=1e-5)
    assert row.percent_low == pytest.approx(100 * row.lower / found.norm[1], rel=1e-5)


@pytest.mark.parametrize("shape", PROBLEMS)
def test_the_upper_bound_of_a_static_displacement_equals_its_error(shape):
    data = elastic(shape)
    found = bounded_on(data, 2, Shaken())
    check_static(data, PROBLEMS[shape][2], found, 0.3)
    assert found.remarks == ()


@pytest.mark.parametrize("shape", ["slanted", "pressed"])
@pytest.mark.parametrize("factor", [1.0, 0.9, -1.0])
def test_any_displacement_of_a_static_body_is_enclosed(factor, shape):
    """The nodal values of w on linear triangles, and wrong ones: too small by a tenth, and of the wrong sign."""
    data = elastic(shape)
    w = PROBLEMS[shape][2]
    mesh = Shaken()(data.body, 2)
    nodal = factor * np.array([sp.lambdify((x1, x2), one, "numpy")(*mesh.p) for one in w]).T
    check_static(data, w, bound_displacement(data, mesh.p.T, mesh.t.T, None, nodal, refine=0), 0.0)


def test_an_exact_solution_of_the_contact_problem_needs_a_contact_side():
    with pytest.raises(BodyError, match="no part Γ3"):
        ExactSolution(body("upright"), LAW, ())
