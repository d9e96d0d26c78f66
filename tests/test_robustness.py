"""No false alarms: the verdicts of Prop. 5.4 hold for other meshes of a family and for other constants of a case.

The opposite of ``test_controls``: what changes here is not wrong, so no row of the ledger may notice.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields, replace

import numpy as np
import pandas as pd
import pytest
from sympy import Rational, sympify

from manufactured import Case, ContactFace, ExactSolution, KelvinVoigt, Linear, Memory, catalogue, isotropic, prove, t
from study.claims import prop_5_4
from study.fem.mesh import OneDiagonal, Shaken
from study.solve.evolution import Midpoint
from study.sweep import measure_case, steps_for
from study.verdict import HOLDS

LEVELS = (8, 16, 32)
CASES = {case.name: case for case in catalogue()}
NAMES = (
    "full-contact",
    "no-contact",
    "fixed-front-on-vertex",
    "fixed-front-off-vertex",
    "advance-recede",
    "merging-patches",
    "travelling-patch",
)
"""Cases with linear isotropic laws, whose pressure may be scaled: the strain follows from it."""
COARSE, FINE = (8, 16, 32), (16, 32, 64)
SHAKEN = {
    **dict.fromkeys(
        ("fixed-front-off-vertex", "advance-recede", "yield-on-a-part", "lift-and-land", "load-w11"), COARSE
    ),
    **dict.fromkeys(("anisotropic", "heterogeneous", "corner", "travelling-patch"), COARSE),
    **dict.fromkeys(("layered", "merging-patches"), FINE),
}
"""Cases and levels. Patches and the lower layer are a few cells wide at n = 8: over seeds the first order there
scatters by some 0.04, so that one mesh in twenty would leave 1 ± 0.15; from n = 16 it does not."""


def alarms(case: Case, family, levels=LEVELS) -> list[str]:
    """The rows of the ledger that do not hold."""
    rows = [asdict(measure_case(case, family, n, Midpoint(), steps_for(case, n))) for n in levels]
    verdicts = prop_5_4(case.name, pd.DataFrame(rows), case.order)
    return [f"{v.quantity}: {v.observed:.4g} in [{v.low:.4g}, {v.high:.4g}]" for v in verdicts if v.verdict != HOLDS]


@dataclass(frozen=True)
class Constants:
    """Factors by which the free constants of a case are multiplied.

    Attributes:
        gap, pressure: the amplitudes; the strain at t = 0, where it was given, goes with the pressure.
        A, G: the whole tensors.
        coupling_A, coupling_G: Lamé's λ alone.
        speed: of the contact zone, t → speed · t in all formulas; at most 1, so that times stay in [0, T].
    """

    gap: float = 1.0
    pressure: float = 1.0
    A: float = 1.0
    G: float = 1.0
    coupling_A: float = 1.0
    coupling_G: float = 1.0
    speed: float = 1.0

    def __str__(self) -> str:
        changes = {field.name: getattr(self, field.name) for field in fields(self)}
        return ", ".join(f"{name} × {factor:g}" for name, factor in changes.items() if factor != 1) or "unchanged"


CONSTANTS = [field.name for field in fields(Constants)]
ALONE = [
    Constants(**{name: factor}) for name in CONSTANTS for factor in ((0.8, 0.9) if name == "speed" else (0.8, 1.2))
]


def joint(seed: int) -> Constants:
    """All constants at once, each by up to 20 %."""
    factors = dict(zip(CONSTANTS, np.random.default_rng(seed).uniform(0.8, 1.2, len(CONSTANTS)).round(3), strict=True))
    return Constants(**(factors | {"speed": min(1.0, factors["speed"])}))


def scaled(tensor: Linear, scale: float, coupling: float) -> Linear:
    """2μ τ + λ (tr τ) I with μ and λ multiplied."""
    mu, lam = tensor.matrix[-1, -1] / 2, tensor.matrix[0, 1]
    assert np.array_equal(tensor.matrix, isotropic(mu, lam).matrix)
    return isotropic(scale * mu, scale * coupling * lam)


def changed(case: Case, by: Constants) -> Case:
    """The case with other constants; what is predicted for it stays."""
    old = case.solution
    assert isinstance(old.law.G, Linear)
    A, G = scaled(old.law.A, by.A, by.coupling_A), scaled(old.law.G, by.G, by.coupling_G)
    law = KelvinVoigt(A, G, str(by))
    gap, pressure, speed = (Rational(str(factor)) for factor in (by.gap, by.pressure, by.speed))
    faces = []
    for face in old.faces:
        assert isinstance(face.strain, Memory)
        w, p, level = (sympify(f).subs(t, speed * t) for f in (face.gap, face.strain.pressure, face.level))
        start = None if face.strain.initial is None else pressure * face.strain.initial
        strain = ContactFace.linear(face.part, law, old.body.T, gap * w, pressure * p, level, start).strain
        faces.append(replace(face, gap=gap * w, strain=strain, level=level))
    return replace(case, solution=ExactSolution(old.body, law, tuple(faces)))


def error(case: Case) -> float:
    return measure_case(case, OneDiagonal(), 4, Midpoint(), 4).error


@pytest.mark.parametrize("name", NAMES)
def test_unchanged_constants_leave_a_case_as_it_is(name: str) -> None:
    assert error(changed(CASES[name], Constants())) == pytest.approx(error(CASES[name]), rel=1e-9)


def test_every_constant_changes_what_is_measured() -> None:
    """Or it would prove nothing that the verdicts stay."""
    errors = {error(changed(CASES["fixed-front-off-vertex"], by)) for by in (Constants(), *ALONE)}
    assert len(errors) == 1 + len(ALONE)


@pytest.mark.parametrize("seed", range(2))
def test_no_alarm_on_two_shaken_meshes(seed: int) -> None:
    assert alarms(CASES["advance-recede"], Shaken(seed=seed)) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", SHAKEN)
@pytest.mark.parametrize("seed", range(20))
def test_no_alarm_on_twenty_shaken_meshes(name: str, seed: int) -> None:
    assert alarms(CASES[name], Shaken(seed=seed), SHAKEN[name]) == []


@pytest.mark.parametrize("name", NAMES[-2:])
def test_no_alarm_for_other_constants(name: str) -> None:
    case = changed(CASES[name], joint(0))
    prove(case.solution, name)
    assert alarms(case, OneDiagonal()) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("by", [*ALONE, *map(joint, range(1, 5))], ids=str)
def test_no_alarm_for_constants_up_to_a_fifth_larger_or_smaller(name: str, by: Constants) -> None:
    case = changed(CASES[name], by)
    prove(case.solution, name)
    assert alarms(case, OneDiagonal()) == []
