"""How fast two solutions diverge where G softens: rates from eigenvalues, and the bound of Theorem 2.2."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from on_meshes import space_on

from manufactured import named
from manufactured.body import unit_square
from manufactured.law import KelvinVoigt, isotropic
from study.fem.mesh import Shaken
from study.solve.tableau import MIDPOINT
from study.statements import wellposed as divergence
from study.statements.shared.base import Experiment, Setting

BODY = unit_square()
SPACE = space_on(BODY, 4, Shaken())
LAWS = [named(name).solution.law for name in ("softening", "double-well")]


@pytest.mark.parametrize("law", LAWS)
def test_a_law_is_scaled_to_any_omega_and_multiples_of_other_laws_are_not_known(law):
    strain = np.array([[0.3], [-2.0], [1.0]])
    assert_allclose(divergence.scaled(law, 10.0).G(strain), 10.0 / law.kappa * law.G(strain))
    with pytest.raises(TypeError, match="no multiple of Yield"):
        divergence.scaled(named("yield-on-a-part").solution.law, 2.0)


@pytest.mark.parametrize("law", LAWS)
def test_the_softest_mode_stays_in_contact_and_grows_no_faster_than_proved(law):
    c, v, force = divergence.softest_mode(SPACE, law)
    assert 0 < c <= law.growth * (1 + 1e-12)
    assert abs(SPACE.N @ v).max() <= 1e-12 * abs(v).max()
    assert force.any()


def test_the_softest_rate_is_omega_where_g_is_a_multiple_of_a_and_a_monotone_law_has_no_growth():
    assert divergence.softest_mode(SPACE, divergence.even_law(2, 3.0))[0] == pytest.approx(3.0)
    assert divergence.softest_mode(SPACE, KelvinVoigt(isotropic(1, 0.5), isotropic(1, 1), "monotone"))[0] < 0


def test_a_law_that_is_softer_than_it_says_diverges_faster_than_its_bound():
    """The steps are for ω = 1.1, the bound for ω = 1."""

    class Modest(KelvinVoigt):
        @property
        def growth(self):
            return 1.0

    law = divergence.even_law(2, 1.1)
    setup = Experiment.at(Setting("softening", "one-diagonal", 2), MIDPOINT, 1)
    assert divergence.over_bound(setup, law, 1.0) == pytest.approx(1, abs=1e-9)
    steps = divergence.steps_for(law, 1.0)
    expected = ((1 - 1 / steps) / (1 - 1.1 / steps)) ** steps
    assert divergence.over_bound(setup, Modest(law.A, law.G, "modest"), 1.0) == pytest.approx(expected, rel=1e-9)
    assert expected > 1.1


@pytest.mark.parametrize(
    "law", [divergence.even_law(2, 10.0), LAWS[0]], ids=["without a contact force", "with a contact force"]
)
def test_the_measured_rate_is_the_rate_of_the_midpoint_rule(law):
    """For G = −ωA no force is needed to keep the softest mode on the foundation."""
    c = divergence.softest_mode(SPACE, law)[0]
    z = c / divergence.steps_for(law, 1.0)
    assert 0 < z <= 1 / divergence.SHORT + 1e-12
    assert divergence.growth_rate(SPACE, law, 1.0) == pytest.approx(math.log((1 + z / 2) / (1 - z / 2)) / z, rel=1e-9)
