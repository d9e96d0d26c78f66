"""Laws of materials: constants, also of an elasticity that is not monotone or has no potential, and their cases."""

from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from on_floor import on_floor

from manufactured import prove
from manufactured.cases.materials import law_without_potential
from manufactured.factor import Factor, x1
from manufactured.law import (
    Combined,
    DeviatoricBall,
    FrobeniusBall,
    Indefinite,
    KelvinVoigt,
    LawError,
    Linear,
    NonSymmetric,
    Yield,
    isotropic,
    isotropic_matrix,
)
from manufactured.static import plane_strain, plane_stress
from manufactured.symbols import pos, s, t
from manufactured.tensors import dyad
from study.fem.naming import resolve

SOFT = Indefinite(isotropic_matrix(0.5, -1.5))
FACTOR = Factor(2 + x1, 2.0, 3.0)
VARYING = Indefinite(SOFT.matrix, FACTOR)
NOT_SYMMETRIC = np.array([[2.0, 1, 0], [0, 2, 0], [0, 0, 1]])
COUPLED = np.array([[2.0, 0, 0], [0, 2, 1], [0, 0, 2]])
"""σ_22 depends on ε_12, and σ_12 not on ε_22."""
S = np.array([1.0, -0.5, 0.3])
COMBINED = Combined(S, Indefinite(isotropic_matrix(-1, 0.25)), Yield(6.0, FrobeniusBall(2.0)))
SHEARED = Combined(S, Indefinite(isotropic_matrix(-1, 0.25)), Yield(6.0, DeviatoricBall(2.0)))
YIELDING = [Yield(3.0, ball(2.0)) for ball in (FrobeniusBall, DeviatoricBall)]
strains = st.lists(st.floats(-20, 20), min_size=3, max_size=3).map(np.array)


def test_the_constants_of_an_elliptic_operator_are_its_extreme_eigenvalues():
    A = isotropic(1.0, 0.5)
    assert (A.ellipticity, A.lipschitz) == pytest.approx((2.0, 3.0))
    assert A.normal_modulus(np.array([0.0, -1.0])) == pytest.approx(2.5)


@pytest.mark.parametrize(
    ("G", "monotonicity", "lipschitz"),
    [
        (SOFT, -2.0, 2.0),
        (VARYING, -6.0, 6.0),
        (Indefinite(isotropic_matrix(1, 0), FACTOR), 4.0, 6.0),
        # Of a matrix that is not symmetric the least eigenvalue of its symmetric part, and its largest singular value.
        (NonSymmetric(COUPLED), 1.5, (1 + 17**0.5) / 2),
    ],
)
def test_the_constants_of_a_linear_operator_are_its_extreme_eigenvalues(G, monotonicity, lipschitz):
    assert (G.monotonicity, G.lipschitz) == pytest.approx((monotonicity, lipschitz))


@pytest.mark.parametrize(
    ("law", "along", "across"), [(plane_stress, 1 / 2, -0.3 / 2), (plane_strain, 0.91 / 2, -0.3 * 1.3 / 2)]
)
def test_a_pull_stretches_a_plate_and_narrows_it(law, along, across):
    """Under σ_11 = 1 strains are 1/E and −ν/E, in plane strain (1 − ν²)/E and −ν(1 + ν)/E; σ_12 = E/(1 + ν) ε_12."""
    matrix = law(2.0, 0.3).matrix
    assert np.linalg.solve(matrix, [1.0, 0.0, 0.0]) == pytest.approx([along, across, 0.0])
    assert matrix[2, 2] == pytest.approx(2 / 1.3)


@pytest.mark.parametrize("G", [SOFT, COMBINED, SHEARED, *YIELDING, law_without_potential().G])
@given(a=strains, b=strains)
def test_no_pair_of_strains_violates_the_stated_constants(G, a, b):
    change = G(a) - G(b)
    apart = a - b
    assert np.linalg.norm(change) <= G.lipschitz * np.linalg.norm(apart) * (1 + 1e-12) + 1e-12
    assert change @ apart >= G.monotonicity * (apart @ apart) * (1 + 1e-12) - 1e-12


@pytest.mark.parametrize("G", YIELDING)
@given(a=strains)
def test_the_law_3_3_is_monotone_and_zero_exactly_on_the_convex_set(G, a):
    assert G.monotonicity == 0
    projected = np.linalg.norm(G.convex.projector @ a)
    assert np.any(G(a) != 0) == (projected > G.convex.radius) or projected == pytest.approx(G.convex.radius)


def energy(G, strain):
    """The stored energy W(ε) = S·ε + ½ Cε·ε + β/2 dist²(ε, K)."""
    resisting = G.yielding(strain)
    return G.prestress @ strain + strain @ G.linear(strain) / 2 + resisting @ resisting / (2 * G.yielding.beta)


@pytest.mark.parametrize("G", [COMBINED, SHEARED], ids=["ball", "cylinder"])
@given(a=strains, direction=strains)
def test_an_operator_is_the_derivative_of_its_energy_and_has_its_own_derivative(G, a, direction):
    if abs(np.linalg.norm(G.yielding.convex.projector @ a) - G.yielding.convex.radius) < 1e-3:
        return
    step = 1e-30j * direction
    assert np.imag(energy(G, a + step)) / 1e-30 == pytest.approx(G(a) @ direction, rel=1e-9, abs=1e-9)
    assert np.imag(G(a + step)) / 1e-30 == pytest.approx(G.derivative(a, direction), rel=1e-9, abs=1e-9)


def on_coupled(matrix):
    law = KelvinVoigt(isotropic(1, 0), NonSymmetric(matrix), "coupled")
    return on_floor(law, t * pos(s - 0.5, 4), t * pos(0.5 - s, 2), 0.5 - s)


@pytest.mark.parametrize("G", [COMBINED, SHEARED, *YIELDING])
@given(q=st.floats(0.01, 30))
def test_the_normal_response_is_the_nn_component_under_compression(G, q):
    n = np.array([0.6, -0.8])
    rest, g, b, edge = (0.0, 0.0, *G.normal_response(n))[-4:]
    assert G(-q * dyad(n, n)) @ dyad(n, n) == pytest.approx(rest - g * q - b * max(q - edge, 0))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: KelvinVoigt(SOFT, isotropic(1, 1), ""), r"\(3\.1\) needs m_A > 0.*only G may soften"),
        (lambda: isotropic(1, -1.5), "not elliptic: its smallest eigenvalue is -1.*use ``Indefinite``"),
        *((partial(kind, NOT_SYMMETRIC), "not symmetric") for kind in (Linear, Indefinite)),
        *((partial(kind, np.eye(4)), "3×3") for kind in (Linear, NonSymmetric)),
        (lambda: Yield(-1.0, FrobeniusBall(1)), "β > 0"),
        (lambda: Yield(1.0, SimpleNamespace(dim=2, radius=0.0, projector=np.eye(3))), "radius r > 0"),
        (lambda: KelvinVoigt(isotropic(1, 1, 3), isotropic(1, 1, 2), ""), "dimension 3"),
        (lambda: Combined(np.zeros(6), SOFT, Yield(1.0, FrobeniusBall(1.0))), r"S has the shape \(6,\)"),
        (lambda: Combined(np.zeros(3), SOFT, Yield(1.0, FrobeniusBall(1.0, 3))), "operators of the same dimension"),
        (lambda: Combined(S, VARYING, Yield(1.0, FrobeniusBall(1.0))), "varies in space"),
        *((partial(on_coupled, matrix), "prescribe the strain") for matrix in (COUPLED, COUPLED.T)),
    ],
)
def test_what_is_no_law_or_needs_a_prescribed_strain_is_refused(make, message):
    with pytest.raises(LawError, match=message):
        make()


def test_the_case_without_a_potential_proves_itself_is_found_by_its_name():
    case = resolve("no-potential")
    prove(case.solution, case.name)
    assert case.order == 1
