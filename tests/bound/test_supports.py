"""Rollers, prescribed displacements and holes: exact solutions, another program, and what is refused."""

from __future__ import annotations

import math

import pytest

from benchmarks.trials.supports import row
from manufactured import BodyError, Kind, plane_stress, polygon, static
from manufactured.factor import x1, x2
from manufactured.symbols import FormulaError
from study.bound.bounded import bounded_solution
from study.bound.trajectory import Refined
from study.fem.mesh import Unstructured
from study.solve.tableau import MIDPOINT

CLAMPED, CONTACT, FREE, ROLLER = Kind.CLAMPED, Kind.CONTACT, Kind.LOADED, Kind.ROLLER
OUTLINE = [(0, 0), (2, 0), (2, 1), (0, 1)]
HOLE = [(0.7, 0.3), (0.8, 0.7), (1.2, 0.6), (1.1, 0.3)]
G = plane_stress(E=2.0, nu=0.25)


@pytest.mark.parametrize("pulled", [True, False], ids=["prescribed", "loaded"])
def test_a_uniform_stress_around_a_hole_is_exact_up_to_rounding(pulled: bool) -> None:
    """σ_11 = 0.02 and no other stress: u = (0.01 x1, −0.0025 x2); the hole is loaded by σν."""
    right = ROLLER if pulled else FREE
    body = polygon(OUTLINE, [ROLLER, right, FREE, ROLLER], holes=[(HOLE, [FREE] * 4)])
    tractions = {
        i: (0.02 * part.normal[0], 0) for i, part in enumerate(body.parts) if i > 3 or (i, pulled) == (1, False)
    }
    data = static(body, G, f2=tractions, u={1: (0.02, 7)} if pulled else None)
    found = bounded_solution(data, None, Unstructured(), 5, MIDPOINT, 1, Refined(1, 1))
    energy = math.sqrt(0.02 * 0.01 * body.measure)
    assert found.enclosure.evidence.kind == "guaranteed"
    assert found.error[1] <= 1e-10 * energy
    assert found.norm == pytest.approx((energy, energy), rel=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_another_program_computes_an_error_and_a_norm_inside_the_intervals(seed: int) -> None:
    assert row(seed)["inside"]


@pytest.mark.parametrize(
    "kinds", [[FREE, FREE, FREE, ROLLER], [FREE, ROLLER, FREE, ROLLER], [ROLLER, FREE, FREE, FREE]]
)
def test_rollers_in_one_direction_do_not_hold_a_body(kinds) -> None:
    with pytest.raises(BodyError, match="no side of the body is CLAMPED"):
        polygon(OUTLINE, kinds)


def test_slanted_rollers_and_holes_in_the_wrong_direction_are_refused() -> None:
    with pytest.raises(BodyError, match=r"the ROLLER side from \[2.0, 0.0\] .* not parallel to an axis"):
        polygon([(0, 0), (2, 0), (1.8, 1), (0, 1)], [CLAMPED, ROLLER, FREE, FREE])
    with pytest.raises(BodyError, match="is listed counter-clockwise"):
        polygon(OUTLINE, [CLAMPED, FREE, FREE, FREE], holes=[(HOLE[::-1], [FREE] * 4)])


@pytest.mark.parametrize(
    ("u", "message"),
    [
        ({0: (x1**2, 0)}, r"u on part 0 is x1\*\*2, and only linear"),
        ({1: (0, 0)}, r"the CLAMPED and ROLLER parts of the plane are \[0, 3\]"),
        ({0: (0.1, 0)}, r"differ by 0.1 at their common corner \[0.0, 0.0\]"),
        ({3: (0, x2)}, r"differ by 1 at their common corner \[0.0, 1.0\]"),
    ],
)
def test_displacements_that_cannot_be_prescribed_are_refused(u, message: str) -> None:
    body = polygon(OUTLINE, [CLAMPED, FREE, CONTACT, CLAMPED])
    with pytest.raises(FormulaError, match=message):
        static(body, G, u=u)
