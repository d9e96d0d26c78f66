"""A motion balances its power at every step, its stress the loads; its energy is that of the law."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest

from manufactured.law import DeviatoricBall, FrobeniusBall, Yield, isotropic
from manufactured.tensors import identity, mandel, size
from study.fem.error_norm import ErrorNorm
from study.fem.mesh import FAMILIES, Unstructured
from study.fem.naming import resolve
from study.solve.energy_balance import density
from study.solve.motion import Motion, von_mises

CASES = ("advance-recede", "yield-and-release", "heterogeneous", "cube-disc")
RNG = np.random.default_rng(2002)


@lru_cache
def moved(case: str, steps: int = 8) -> Motion:
    """A case on a coarse mesh."""
    solution = resolve(case).solution
    family = Unstructured() if solution.body.dim == 2 else FAMILIES[0]
    return Motion.of(solution, family, 6 if solution.body.dim == 2 else 3, steps)


@pytest.mark.parametrize("case", CASES)
def test_forces_are_in_equilibrium_and_the_power_of_the_load_is_stored_dissipated_or_spent_on_contact(case) -> None:
    """(4.14) with v = δu in place of u, to round-off or the tolerance of the fixed point."""
    motion = moved(case)
    space, load = motion.space, ErrorNorm(motion.solution, motion.space).load
    largest = max(abs(frame.power.load) for frame in motion.frames[1:])
    for frame in motion.frames[1:]:
        power, force = frame.power, load(frame.time)
        assert abs(power.elastic + power.viscous + power.contact - power.load) <= 1e-10 * largest
        assert power.viscous > 0
        defect = space.functional(frame.stress) + space.N.T @ frame.multipliers - force
        assert np.linalg.norm(defect) <= 1e-10 * np.linalg.norm(force)


@pytest.mark.parametrize("case", [CASES[0], *(pytest.param(case, marks=pytest.mark.slow) for case in CASES[1:3])])
def test_the_defect_of_the_balance_of_energy_falls_with_the_square_of_the_step(case: str) -> None:
    defects = [abs(moved(case, steps).balance()["defect"]).max() for steps in (32, 64)]
    assert 3 < defects[0] / defects[1] < 5


@pytest.mark.parametrize("law", [isotropic(1, 2), Yield(3.0, FrobeniusBall(0.4)), Yield(3.0, DeviatoricBall(0.4))])
def test_the_stress_is_the_derivative_of_the_energy_density(law: object) -> None:
    strain, direction, t = RNG.normal(size=(3, 40)), RNG.normal(size=(3, 40)), 1e-6

    def energy(e: np.ndarray) -> np.ndarray:
        return density(law, e, law(e))  # type: ignore[arg-type, operator]

    slope = (energy(strain + t * direction) - energy(strain - t * direction)) / (2 * t)
    np.testing.assert_allclose(slope, np.sum(law(strain) * direction, axis=0), atol=1e-6)  # type: ignore[operator]


def test_von_mises_is_the_stress_of_a_pull_ignores_pressure_and_is_least_in_the_plane() -> None:
    """In the plane it is the smallest value for any stress across the plane."""
    pull = np.zeros((3, 3))
    pull[1, 1] = -7.0
    assert von_mises(mandel(pull)) == pytest.approx(7.0)
    for dim in (2, 3):
        stress = RNG.normal(size=(size(dim), 5))
        under_pressure = stress - 4 * identity(dim)[:, None]
        np.testing.assert_allclose(von_mises(under_pressure), von_mises(stress), rtol=1e-12)
    plane = RNG.normal(size=(2, 2))
    solid = np.zeros((3, 3, 2001))
    solid[:2, :2] = (plane + plane.T)[:, :, None] / 2
    solid[2, 2] = np.linspace(-5, 5, 2001)
    assert float(von_mises(mandel(plane))) == pytest.approx(von_mises(mandel(solid)).min(), abs=1e-4)
