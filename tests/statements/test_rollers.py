"""Rollers: the problem condensed to Γ3, and the verdicts with the changes that must turn them."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from manufactured.multiscale import ROLLERS, rollers
from study.fem.naming import resolve
from study.ledger.files import UsageError
from study.ledger.verdict import FAILS, HOLDS, REPORTED
from study.solve.evolution import SemiDiscrete, path
from study.solve.tableau import MIDPOINT
from study.statements import work_of_contact as own
from study.statements.shared.base import Setting
from study.statements.shared.meshes import space_of
from study.statements.work_of_contact import Resolved


def test_every_level_has_its_rollers_by_name_and_other_names_mean_none():
    assert [resolve(f"{kind}-8").name for kind in ROLLERS] == [case.name for case in rollers(8)]
    for name in ("standing-4", "rolling-12", "roller"):
        with pytest.raises(UsageError, match=f"unknown case '{name}'"):
            resolve(name)


def trajectories(family, level):
    solution = rollers(level)[0].solution
    space = space_of(Setting(f"{own.ROLLER}-{level}", family, level))
    return own.Trajectories.of(own.OnContact(Resolved(solution, space)), round(own.PER_H * level * space.body.T))


@pytest.fixture(scope="module")
def coarse():
    return trajectories("shaken", 8)


def test_the_problem_on_contact_is_problem_5_1_with_all_unknowns_eliminated_off_it(coarse):
    """The load of a step is that of the midpoint rule with P_hu̇ and P_hu from both ends."""
    on = coarse.on
    k = coarse.k
    steps = coarse.steps
    N = on.at.space.N

    def during(values):
        return lambda times: values[np.rint(times / k - 0.5).astype(int)].T

    exact = np.array([on.projected(n * k) for n in range(steps + 1)])
    moved = (np.diff(exact, axis=0) / k + (exact[1:] + exact[:-1]) / 2) @ on.M
    problem = SemiDiscrete.of(on.at.space, on.at.solution.law, during(moved + coarse.forces @ N), on.start)
    states = path(problem, MIDPOINT, steps)
    linear = path(replace(problem, N=N[:0], load=during(moved)), MIDPOINT, steps)
    assert coarse.displacement(steps) == pytest.approx(states[-1], abs=1e-10)
    assert coarse.contact == pytest.approx(states @ N.T, abs=1e-10)
    assert coarse.linear == pytest.approx(linear @ N.T, abs=1e-10)


def test_both_sides_of_the_bound_are_ordered_and_contact_costs_nothing_as_a_traction(coarse):
    found = own.sides(coarse)
    assert 0 < found["E_h"] <= found["error"] < found["right side"]
    assert found["M_h"] > found["J_h"] > 0
    assert replace(coarse, contact=coarse.linear).excess().max() == 0 < coarse.excess().max() - 0.01


def predicted(kind, family, n):
    """The excess as it was predicted, with a scatter over shaken meshes that falls like n^{−1/2}."""
    if kind == own.STANDING or family in own.PLAIN_FAMILIES:
        return 0.1 / n
    by_chance = 1 + (own.SEEDS.index(family) - 3.5) * 0.2 / n**0.5 if family in own.SEEDS else 1.0
    return by_chance * 0.1 / n**0.5


def data(excess=predicted, right=2.0, changed=1.001, step=2.0):
    found = []
    for setting in own.Rollers().places(full=True):
        family = setting.family
        n = setting.level
        numbers = dict.fromkeys(("error", "E_h", "excess at T", "M_h beside"), 1 / n) | {"right side": right / n}
        numbers["excess"] = excess(setting.case.removesuffix(f"-{n}"), family, n)
        if n == own.HALVED and family not in own.SEEDS[1:]:
            numbers["excess, k/2"] = changed * numbers["excess"]
        if family == own.PLAIN_FAMILIES[0]:
            numbers["|q|²"] = step * np.log(n)
        found += [{**vars(setting), "h": 1 / n, "quantity": name, "value": value} for name, value in numbers.items()]
    return pd.DataFrame(found)


def verdicts(rows):
    """(case, key) ↦ verdict."""
    return {(verdict.case, verdict.key): verdict.verdict for verdict in own.Rollers().judge(rows)}


def test_the_predicted_behaviour_holds_in_every_row():
    assert set(verdicts(data()).values()) == {HOLDS, REPORTED}


@pytest.mark.parametrize(
    ("wrong", "places"),
    [
        ({"right": 0.9}, {(kind, "bound") for kind in ROLLERS}),
        ({"changed": 1.03}, {(own.ROLLER, "time")}),
        ({"step": 2.6}, {(own.ROLLER, "step")}),
        (
            {"excess": lambda kind, family, n: 0.1 / n},
            {(own.ROLLER, "order-shaken"), *((kind, "order-alternating") for kind in ROLLERS[:3])},
        ),
        (
            {"excess": lambda kind, family, n: 0.1 / n**0.5},
            {(own.ROLLER, "order-equal"), (own.STANDING, "order-standing")},
        ),
    ],
)
def test_every_row_about_rollers_can_fail(wrong, places):
    found = verdicts(data(**wrong))
    assert {place for place, verdict in found.items() if verdict == FAILS} == places
