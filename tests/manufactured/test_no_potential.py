"""An elasticity without a potential, and the exact solution with it."""

from __future__ import annotations

import numpy as np
import pytest
from on_floor import on_floor

from manufactured import prove
from manufactured.law import KelvinVoigt, LawError, NonSymmetric, isotropic
from manufactured.no_potential import NAME, SKEW, law_without_potential, no_potential
from manufactured.symbols import pos, s, t
from study.fem.naming import resolve
from study.solve.energy_balance import density

RNG = np.random.default_rng(7)
COUPLED = np.array([[2.0, 0, 0], [0, 2, 1], [0, 0, 2]])
"""σ_22 depends on ε_12, and σ_12 not on ε_22."""


def test_the_case_proves_itself_and_is_found_by_its_name() -> None:
    assert all(finding.passes for finding in prove(no_potential().solution, NAME))
    assert resolve(NAME).order == 1


def test_constants_are_the_largest_and_the_smallest_quotients() -> None:
    G = law_without_potential().G
    strain = RNG.standard_normal((3, 4000))
    quotients = np.sum(G(strain) * strain, axis=0) / np.sum(strain**2, axis=0)
    stretches = np.linalg.norm(G(strain), axis=0) / np.linalg.norm(strain, axis=0)
    assert G.monotonicity <= quotients.min() <= G.monotonicity + 0.05
    assert G.lipschitz * 0.99 <= stretches.max() <= G.lipschitz
    assert not np.allclose(G.matrix, G.matrix.T)


def test_the_skew_part_works_on_no_strain() -> None:
    strain = RNG.standard_normal((3, 50))
    assert np.sum(NonSymmetric(SKEW)(strain) * strain, axis=0) == pytest.approx(np.zeros(50), abs=1e-12)


@pytest.mark.parametrize("matrix", [COUPLED, COUPLED.T], ids=["sn to nn", "nn to sn"])
def test_a_law_that_couples_nn_with_sn_needs_a_prescribed_strain(matrix: np.ndarray) -> None:
    law = KelvinVoigt(isotropic(1, 0), NonSymmetric(matrix), "coupled")
    with pytest.raises(LawError, match="prescribe the strain"):
        on_floor(law, t * pos(s - 0.5, 4), t * pos(0.5 - s, 2), 0.5 - s)


def test_no_energy_is_stored_without_a_potential() -> None:
    with pytest.raises(LawError, match="has no stored energy"):
        density(law_without_potential().G, np.zeros((3, 1)), np.zeros((3, 1)))
