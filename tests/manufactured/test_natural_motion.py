"""The natural front that advances: an exact solution with data as (3.4) wants them and a pressure ~ r^{−1/2}."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sympy import Rational

from manufactured import named
from manufactured.natural_motion import PLACE, natural_motion
from manufactured.profile import cutoff
from manufactured.proved import proved_order
from manufactured.self_proof import examine
from manufactured.singular import TravellingField
from manufactured.symbols import t

CASE = natural_motion()
(FACE,) = CASE.solution.faces
RECEDING = natural_motion(Rational(7, 10) - 2 * t / 5)


def test_the_natural_front_that_advances_is_an_exact_solution_and_one_that_recedes_pulls() -> None:
    assert [finding for finding in examine(CASE.solution) if not finding.passes] == []
    (finding,) = (finding for finding in examine(RECEDING.solution) if not finding.passes)
    assert "σ_ν ≤ 0" in finding.condition


def test_a_field_that_does_not_move_is_that_of_the_natural_front() -> None:
    resting, natural = natural_motion(Rational(2, 5)).solution, named("natural-front").solution
    x = np.array([[0.1, 0.41, 0.8], [0.2, 0.01, 0.6]])
    scale = (1 / 4 + 0.5) / (1 / 4 + 2 * 0.5)
    np.testing.assert_allclose(resting.at(x).displacement(0.5), scale * natural.at(x).displacement(0.5), rtol=1e-12)


@pytest.mark.parametrize("power", [4, 6, 8])
def test_gap_and_pressure_have_the_exponents_of_the_label_at_the_front(power: int) -> None:
    c, r = float(PLACE.subs(t, 0.5)), 10.0**-power
    for sign, value, exponent in ((1, "gap", 1.5), (-1, "pressure", -0.5)):
        near, nearer = (getattr(CASE.solution.on(FACE, [[c + sign * d]]), value)(0.5)[0] for d in (r, r / 10))
        assert np.log10(near / nearer) == pytest.approx(exponent, abs=1e-3)


def test_forces_and_their_rates_are_square_integrable_at_the_front() -> None:
    """f_0 ~ r^{1/2} and its rate ~ r^{−1/2}: (3.4) as it is printed, while the stress is ~ r^{−1/2} itself."""
    c, angle = float(PLACE.subs(t, 0.5)), 0.7
    sizes = []
    for r in (1e-3, 1e-5):
        fields = CASE.solution.at([[c + r * np.cos(angle)], [r * np.sin(angle)]])
        rate = fields.body_force(0.5 + 1e-30j).imag / 1e-30
        sizes.append([np.linalg.norm(value) for value in (fields.body_force(0.5), rate, fields.stress(0.5))])
    assert np.log10(np.divide(*sizes)) / 2 == pytest.approx([0.5, -0.5, -0.5], abs=0.03)


def test_only_convergence_is_claimed_by_the_source_and_one_half_is_proved() -> None:
    found = CASE.regularity
    assert (found.smoothness, found.rate_smoothness, found.trace) == (1.5, 0.5, 2)
    assert CASE.proposition == "Prop. 5.3"
    assert proved_order(CASE) == 0.5
    assert str(found) == "r^1.5 on Γ3, moving"


def test_a_field_with_a_cut_off_of_the_distance_does_not_travel() -> None:
    field = FACE.field
    assert isinstance(field, TravellingField)
    with pytest.raises(ValueError, match="give `depth`, not `radial`"):
        TravellingField(replace(field.steady, depth=None, radial=cutoff().b), PLACE)
