"""Intervals of ‖u‖² contain values from textbooks and handbooks; the page on bounds shows them."""

import math

import pytest
from bodies import CLAMPED, ROLLER
from bodies import LOADED as FREE
from on_meshes import bounded_on
from places import ROOT
from scipy.integrate import quad

from manufactured import plane_strain, plane_stress, polygon, static
from study.fem.naming import family_named
from study.ledger.text import interval

pytestmark = pytest.mark.slow
PAGE = (ROOT / "docs" / "explanation" / "bounds.md").read_text(encoding="utf-8")
LENGTHS = 0.3, 0.6


def energy(data, level):
    """Return the interval of ‖u‖²."""
    found = bounded_on(data, level, family_named("graded" if data.body.refine else "unstructured"))
    assert found.enclosure.evidence.kind == "guaranteed"
    low, high = found.norm
    return low**2, high**2


def cracked(tip, *kinds):
    """Return a quarter of a strip of the width 2 that is pulled at its ends; on x2 = 0 the kind changes at the tip."""
    outline = [(0, 0), (tip, 0), (1, 0), (1, 3), (0, 3)]
    return static(
        polygon(outline, [*kinds, FREE, FREE, ROLLER], refine=[(tip, 0)]), plane_stress(1, 0.3), f2={3: (0, 1)}
    )


def central(a):
    return (1 - 0.025 * a**2 + 0.06 * a**4) * math.sqrt(1 / math.cos(math.pi * a / 2))


def two_edges(a):
    ligament = math.pi * a / 2
    return (1 + 0.122 * math.cos(ligament) ** 4) * math.sqrt(math.tan(ligament) / ligament)


def test_the_membrane_of_cook():
    outline = [(0, 0), (48, 44), (48, 60), (0, 44)]
    cook = static(polygon(outline, [FREE, FREE, FREE, CLAMPED]), plane_stress(1, 1 / 3), f2={1: (0, 1 / 16)})
    low, high = energy(cook, 16)
    # The mean deflection of the loaded side is ‖u‖²; its middle deflects by 23.96.
    assert low == pytest.approx(23.96, rel=5e-3)
    assert interval(low, high, 5) in PAGE


def test_a_layer_of_soil_under_its_weight():
    body = polygon([(0, 0), (2, 0), (2, 3), (0, 3)], [ROLLER, ROLLER, FREE, ROLLER])
    low, high = energy(static(body, plane_strain(1, 0.25), f0=(0, -1)), 4)
    # σ_22 = x2 − 3 and the constrained modulus 1.2: ∫ σ_22²/1.2 = 15.
    assert low <= 15 <= high
    assert high - low < 1e-8


@pytest.mark.parametrize("factor", [central, two_edges])
def test_the_energy_that_is_released_by_cracks(factor):
    if factor is central:
        short, long = (energy(cracked(a, FREE, ROLLER), 16) for a in LENGTHS)
    else:
        short, long = (energy(cracked(1 - a, ROLLER, FREE), 16) for a in LENGTHS)
    published = quad(lambda a: math.pi * a * factor(a) ** 2, *LENGTHS)[0]
    low = long[0] - short[1]
    high = long[1] - short[0]
    assert low <= published <= high
    assert f"{published:.4f} | {interval(low, high, 4)}" in PAGE
