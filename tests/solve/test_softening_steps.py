"""Steps where G softens: as short as one solution needs, and refused before time is spent if they are longer."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from manufactured import named
from manufactured.body import unit_square
from manufactured.law import Indefinite, KelvinVoigt, isotropic, isotropic_matrix
from study.cli.main import main
from study.fem.mesh import OneDiagonal
from study.fem.space import Space
from study.run.plan import quick
from study.solve.evolution import SemiDiscrete
from study.solve.steps import StepsError
from study.solve.tableau import BACKWARD_EULER, BDF2, MIDPOINT, SCHEMES
from study.statements.shared.base import Setting
from study.statements.thm_4_2 import problems
from study.statements.thm_4_2_own_space import StressExperiment

BODY = unit_square()
SPACE = Space(OneDiagonal()(BODY, 4), BODY)
EVEN = KelvinVoigt(isotropic(1, 0), Indefinite(isotropic_matrix(-2, 0)), "G = −2A")


def unloaded(law: KelvinVoigt) -> SemiDiscrete:
    return SemiDiscrete.of(SPACE, law, lambda t: np.zeros(SPACE.dofs), np.zeros(SPACE.dofs))


def least(problem: SemiDiscrete, scheme, k: float) -> float:
    """The least eigenvalue of (w/k) M + θ G."""
    S = scheme.newest / k * problem.M + scheme.theta * problem.reference
    return float(np.linalg.eigvalsh(S.toarray())[0])


@pytest.mark.parametrize("scheme", [BACKWARD_EULER, MIDPOINT], ids=lambda scheme: scheme.name)
def test_where_g_is_a_multiple_of_a_no_longer_step_would_do(scheme) -> None:
    problem, longest = unloaded(EVEN), scheme.longest(EVEN.growth)
    assert longest == pytest.approx(scheme.newest / scheme.theta / 2)
    assert least(problem, scheme, 0.999 * longest) > 0 > least(problem, scheme, 1.001 * longest)


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: scheme.name)
def test_every_step_serves_a_monotone_law_and_steps_below_m_a_over_l_g_serve_every_law(scheme) -> None:
    assert scheme.longest(named("yield-on-a-part").solution.law.growth) == math.inf
    for name in ("softening", "double-well"):
        law = named(name).solution.law
        scheme.require_unique(0.999 * law.A.ellipticity / law.G.lipschitz, law.growth)
    # The first step of BDF2 is a step of backward Euler, which must be shorter than the other ones.
    assert BDF2.longest(2.0) == BACKWARD_EULER.longest(2.0) == 0.5 < BDF2.newest / 2.0


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: scheme.name)
def test_longer_steps_are_refused_before_anything_is_factorised(monkeypatch, scheme) -> None:
    def never(S, N):
        raise AssertionError("a matrix was factorised")

    problem = replace(unloaded(EVEN), T=10 * scheme.longest(EVEN.growth), solver=never)
    with pytest.raises(StepsError, match=r"need not have one solution: G is not monotone.*rate 2; take k < "):
        list(scheme.march(problem, 10))
    with pytest.raises(AssertionError, match="factorised"):
        list(scheme.march(problem, 11))


def test_longer_steps_of_the_stress_problems_are_refused_too() -> None:
    solution = named("softening").solution
    _, stresses = problems(solution, OneDiagonal(), 4)
    with pytest.raises(StepsError, match="one solution"):
        list(stresses.march(1))
    experiment = StressExperiment.at(Setting("softening", "one-diagonal", 4), 2)
    with pytest.raises(StepsError, match="one solution"):
        list(replace(experiment, steps=1).march())


def test_the_command_says_so_before_it_measures(tmp_path, capsys) -> None:
    asked = ["run", "--case", "softening", "--scheme", "backward-euler", "--step", "1", "--out", str(tmp_path)]
    assert main([*asked, "--levels", "4", "8", "16"]) == 2
    assert "softening: steps of backward-euler of size k = 1 need not have one solution" in capsys.readouterr().err
    assert not list(tmp_path.rglob("*.csv"))


def test_the_steps_of_the_study_are_short_enough() -> None:
    quick().check()
