"""Rollers: the problem condensed to Γ3, and the verdicts with the changes that must turn them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from manufactured.multiscale import ROLLERS, rollers
from study.fem.naming import family_named, resolve
from study.fem.space import Space
from study.ledger.files import UsageError
from study.ledger.orders import orders
from study.ledger.verdict import FAILS, HOLDS, REPORTED, UNDECIDED
from study.solve.evolution import SemiDiscrete
from study.solve.paths import path
from study.solve.tableau import MIDPOINT
from study.statements.contact_work import Resolved
from study.statements.rollers import (
    ALTERNATING,
    EQUAL,
    HALF,
    HALVED,
    PER_H,
    PLAIN,
    PUSHING,
    ROLLER,
    SEEDS,
    STANDING,
    STEEP,
    OnContact,
    Rollers,
    Trajectories,
    nodal_error_near_patch,
    sides,
)


def test_every_level_has_its_rollers_by_name_and_other_names_mean_none() -> None:
    assert [resolve(f"{kind}-12").name for kind in ROLLERS] == [case.name for case in rollers(12)]
    for name in ("standing-4", "rolling-12", "roller"):
        with pytest.raises(UsageError, match=f"unknown case '{name}'"):
            resolve(name)


def trajectories(family: str, level: int, steps: int | None = None) -> Trajectories:
    """Of a roller."""
    solution = rollers(level)[0].solution
    space = Space(family_named(family)(solution.body, level), solution.body)
    return Trajectories.of(OnContact(Resolved(solution, space)), steps or round(PER_H * level * space.body.T))


@pytest.fixture(scope="module")
def coarse() -> Trajectories:
    return trajectories("shaken", 8)


def test_the_problem_on_contact_is_problem_5_1_with_all_unknowns_eliminated_off_it(coarse: Trajectories) -> None:
    """The load of a step is that of the midpoint rule with P_hu̇ and P_hu from both ends."""
    on, k = coarse.on, coarse.k
    space, law = on.at.space, on.at.solution.law
    exact = [on.projected(n * k) for n in range(coarse.steps + 1)]

    def load(time: float) -> np.ndarray:
        n = round(time / k - 0.5)
        moved = (exact[n + 1] - exact[n]) / k + (exact[n + 1] + exact[n]) / 2
        return on.M @ moved + space.N.T @ coarse.forces[n]

    problem = SemiDiscrete.of(space, law, load, on.start)
    states = path(problem, MIDPOINT, coarse.steps)
    free = replace(problem, N=space.N[:0], load=lambda t: load(t) - space.N.T @ coarse.forces[round(t / k - 0.5)])
    linear = path(free, MIDPOINT, coarse.steps)
    for n in (1, coarse.steps // 2, coarse.steps):
        assert coarse.displacement(n) == pytest.approx(states[n], abs=1e-10)
        assert coarse.contact[n] == pytest.approx(space.N @ states[n], abs=1e-10)
        assert coarse.linear[n] == pytest.approx(space.N @ linear[n], abs=1e-10)
    away = states - linear
    assert coarse.excess().max() == pytest.approx(np.sqrt(np.sum(away * (on.M @ away.T).T, axis=1).max()))


def test_forces_add_up_to_the_pressure_on_the_whole_face(coarse: Trajectories) -> None:
    """∫ p = 3 ∫_0^1 e^{−ℓz} H'(z) dz while the roller is on the face, a little less than 3."""
    total = coarse.forces.sum(axis=1)
    assert total[coarse.steps // 2] == pytest.approx(total[coarse.steps // 2 + 5], rel=1e-3)
    assert 2.5 < total[coarse.steps // 2] < 3


def test_errors_near_a_patch_are_taken_at_the_vertices_near_it_in_the_second_half(coarse: Trajectories) -> None:
    at, second = coarse.on.at, range(coarse.steps // 2, coarse.steps + 1)
    (_, vertices), (face,) = at.space.contact[0], at.solution.faces
    s = face.part.coordinates(at.space.mesh.p[:, vertices])[0][0]
    off = {n: abs(coarse.projected[n] + coarse.on.gap(n * coarse.k)) for n in second}
    everywhere = nodal_error_near_patch(coarse, np.ptp(s))
    assert everywhere == pytest.approx(max(off[n].max() for n in second))
    assert 0 < nodal_error_near_patch(coarse, 0.05) < everywhere


def test_contact_costs_nothing_where_the_pressure_is_a_traction(coarse: Trajectories) -> None:
    assert replace(coarse, contact=coarse.linear).excess().max() == 0
    assert coarse.excess().max() > 0.01


def test_both_sides_of_the_bound_are_ordered(coarse: Trajectories) -> None:
    found = sides(coarse)
    assert 0 < found["E_h"] <= found["error"] < found["right side"]
    assert found["M_h"] > found["J_h"] > 0


def test_the_error_is_orthogonal_to_the_distance_from_the_projection(coarse: Trajectories) -> None:
    on, at, n = coarse.on, coarse.on.at, coarse.steps // 2
    sample, best, found = at.v_norm.sample(n * coarse.k), on.projected(n * coarse.k), coarse.displacement(n)
    error, least = (at.v_norm.distance(sample, at.inclusion @ v) for v in (found, best))
    away = found - best
    assert error**2 == pytest.approx(least**2 + away @ (on.M @ away))


@pytest.mark.slow
def test_orders_of_the_excess_tell_equal_neighbourhoods_from_alternating_ones() -> None:
    """Each lies in its own window and outside the other."""
    h = 1 / np.array([8, 16, 32])
    found = {
        family: orders(h, np.array([trajectories(family, round(1 / x)).excess().max() for x in h])).mean()
        for family in (PLAIN[0], ALTERNATING)
    }
    assert EQUAL.contains(found[PLAIN[0]])
    assert not HALF.contains(found[PLAIN[0]])
    assert HALF.contains(found[ALTERNATING])
    assert not EQUAL.contains(found[ALTERNATING])


Number = Callable[[str, str, int], float]
"""(kind, family, n) ↦ a value."""


def predicted(kind: str, family: str, n: int) -> float:
    """The excess as it was predicted, with a scatter over shaken meshes that falls like n^{−1/2}."""
    if kind == STANDING or family in PLAIN:
        return 0.1 / n
    by_chance = 1 + (SEEDS.index(family) - 3.5) * 0.2 / n**0.5 if family in SEEDS else 1.0
    return by_chance * 0.1 / n**0.5


def data(excess: Number = predicted, right: float = 2.0, changed: float = 1.001, step: float = 2.0) -> pd.DataFrame:
    """Rows with an error of 1/n."""
    found = []
    for setting in Rollers().places(full=True):
        family, n = setting.family, setting.level
        kind = setting.case.removesuffix(f"-{n}")
        numbers = {"excess": excess(kind, family, n), "error": 1 / n, "right side": right / n, "E_h": 1 / n}
        numbers |= {"excess at T": 1 / n, "M_h beside": 1 / n}
        if n == HALVED and family not in SEEDS[1:]:
            numbers["excess, k/2"] = changed * numbers["excess"]
        if family == PLAIN[0]:
            numbers["|q|²"] = step * np.log(n)
        common = {"case": setting.case, "family": family, "level": n, "h": 1 / n}
        found += [{**common, "quantity": name, "value": value} for name, value in numbers.items()]
    return pd.DataFrame(found)


def verdicts(rows: pd.DataFrame) -> dict[tuple[str, str], str]:
    """(case, key) ↦ verdict."""
    return {(verdict.case, verdict.key): verdict.verdict for verdict in Rollers().judge(rows)}


def test_the_predicted_behaviour_holds_in_every_row() -> None:
    found = verdicts(data())
    reported = {(ROLLER, "scatter"), (ROLLER, "best"), (ROLLER, "share"), (ROLLER, "order-unstructured")}
    reported |= {(STANDING, "order-standing-shaken"), (ROLLER, "order-end"), (ROLLER, "nodal-beside")}
    assert {key for key, verdict in found.items() if verdict == REPORTED} == reported
    assert set(found.values()) == {HOLDS, REPORTED}
    assert len(found) == 19


@pytest.mark.parametrize(
    ("wrong", "places"),
    [
        ({"right": 0.9}, {(kind, "bound") for kind in (ROLLER, PUSHING, STEEP, STANDING)}),
        ({"changed": 1.03}, {(ROLLER, "time")}),
        ({"step": 2.6}, {(ROLLER, "step")}),
        (
            {"excess": lambda kind, family, n: 0.1 / n},
            {(ROLLER, "order-alternating"), (ROLLER, "order-shaken")}
            | {(PUSHING, "order-alternating"), (STEEP, "order-alternating")},
        ),
        ({"excess": lambda kind, family, n: 0.1 / n**0.5}, {(ROLLER, "order-equal"), (STANDING, "order-standing")}),
    ],
    ids=["bound", "time", "step", "first order everywhere", "half the order everywhere"],
)
def test_every_row_about_rollers_can_fail(wrong: dict[str, Number | float], places: set[tuple[str, str]]) -> None:
    found = verdicts(data(**wrong))  # type: ignore[arg-type]
    assert {place for place, verdict in found.items() if verdict == FAILS} == places


@pytest.mark.parametrize(
    ("family", "keys"),
    [(PLAIN[1], {"order-equal"}), (ALTERNATING, {"order-alternating"}), (SEEDS[3], {"order-shaken"})],
)
def test_nothing_is_decided_without_a_family_of_meshes(family: str, keys: set[str]) -> None:
    rows = data()
    found = verdicts(rows[(rows["family"] != family) | ~rows["case"].str.startswith(ROLLER)])
    assert {key for (case, key), verdict in found.items() if case == ROLLER and verdict == UNDECIDED} == keys


def test_two_levels_show_no_order() -> None:
    rows = data()
    found = verdicts(rows[rows["level"] <= HALVED])
    assert found[ROLLER, "order-equal"] == found[ROLLER, "order-shaken"] == found[ROLLER, "step"] == UNDECIDED
