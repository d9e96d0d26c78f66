"""No false alarms: verdicts hold for other constants of a case (``test_seeds``: for other random meshes).

The changes are no faults, so no verdict may change.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pandas as pd
import pytest
from costly_cases import slow
from sympy import Rational

import manufactured as m
from manufactured import KelvinVoigt, named
from manufactured.catalogue import NAMES
from study.fem.mesh import Graded
from study.ledger.verdict import HOLDS, REPORTED
from study.run.fingerprint import by_value
from study.run.plan import quick
from study.solve.steps import rate_steps
from study.solve.tableau import MIDPOINT
from study.statements.prop_5_4 import Convergence, FirstOrder, SizeOfInterpolation, measure
from study.statements.shared.base import Experiment
from study.statements.shared.scope import serving

TIED = {
    "yield-and-release",
    "yield-on-a-part",
    "natural-front",
    "rough-trace",
    "rough-1.75",
    "re-entrant",
    "junction",
    "double-well",
}
"""Cases whose formulas are tied to the law or to smooth factors."""
CASES = [name for name in NAMES if name not in {*TIED, "closing-gap", "parabolic-gap", "cube-bowl"}]
"""Without an initial gap, which the paper does not have."""


class Constants(NamedTuple):
    """Factors by which the free constants of a case are multiplied."""

    gap: float = 1.0
    pressure: float = 1.0  # also a given strain at t = 0
    slip: float = 1.0
    A: float = 1.0
    G: float = 1.0


FIFTH = 3 / 16
"""The relative change of every constant. In sixteenths, sums of products are exact, which g/a = const in a
heterogeneous body needs."""


def changed(case, by):
    """The case with other constants and the same predictions."""
    if case.name == "lift-and-land":  # p jumps by a ẇ at the landing
        by = by._replace(pressure=by.gap * by.A)
    law = KelvinVoigt(other(case.solution.law.A, by.A), other(case.solution.law.G, by.G), case.solution.law.name)
    body = case.solution.body
    faces = (face for face in case.solution.faces if isinstance(face, m.ContactFace))
    return replace(
        case, solution=m.ExactSolution(body, law, tuple(other_face(face, law, body.T, by) for face in faces))
    )


def other(operator, scale):
    """A multiple of a linear operator."""
    return type(operator)(scale * operator.matrix, operator.factor)


def other_face(face, law, T, by):
    gap = Rational(by.gap)
    pressure = Rational(by.pressure)
    strain = face.strain
    slip = tuple(Rational(by.slip) * z for z in face.slip)
    if isinstance(strain, m.Prescribed):
        ((end, formula),) = strain.phases
        return replace(face, gap=gap * face.gap, strain=m.Prescribed(((end, pressure * formula),)), slip=slip)
    start = getattr(strain, "initial", None)
    initial = None if start is None else pressure * start
    data = face.part, law, T, gap * face.gap, pressure * strain.pressure, face.level
    return m.ContactFace.linear(*data, initial, face.profile, face.rough, slip=slip)


def alarms(case):
    """What does not hold at the levels of the quick study, with its value.

    Meshes are those of the first family that meshes the body, and graded ones where corners need them.
    """
    first, *others = serving(case)
    rows = []
    for family in (first, *(family for family in others if isinstance(family, Graded))):
        for n in quick().levels_of(case).all:
            steps = rate_steps(case.solution.body.T, n, case.pace)
            setup = Experiment.of(case.solution, family, n, MIDPOINT, steps)
            rows.append({"case": case.name, "family": family.name, "level": n, **measure(setup).row()})
    table = pd.DataFrame(rows).assign(claim=case.proposition, expected_order=case.order)
    statements = FirstOrder(), SizeOfInterpolation(), Convergence()
    verdicts = [verdict for statement in statements for verdict in statement.judge(table)]
    assert case.proposition in {verdict.label for verdict in verdicts}
    return {verdict.quantity: verdict.observed for verdict in verdicts if verdict.verdict not in (HOLDS, REPORTED)}


@pytest.mark.parametrize("name", CASES)
def test_unchanged_constants_leave_a_case_as_it_is(name):
    """Nothing is lost when a case is made again from its parts."""
    assert by_value(changed(named(name), Constants()).solution) == by_value(named(name).solution)


SLOW = [("anisotropic", 0, 1), *((name, 1, side) for name in CASES for side in (1, -1))]


@pytest.mark.parametrize(("name", "seed", "side"), [("full-contact", 0, 1), *(slow(*one) for one in SLOW)])
def test_no_alarm_for_constants_a_fifth_larger_or_smaller(name, seed, side):
    """All at once; both sides together have every constant larger and smaller."""
    signs = np.random.default_rng(seed).choice([-1, 1], len(Constants._fields))
    case = changed(named(name), Constants(*(1 + side * FIFTH * signs).tolist()))
    m.prove(case.solution, name)
    assert alarms(case) == {}
