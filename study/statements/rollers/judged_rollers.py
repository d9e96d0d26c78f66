"""What is claimed of rollers, and what is reported."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pandas as pd

from study.ledger.criterion import Criterion, Groups, Measured, Observation, Rule, by_case
from study.ledger.measures import ENOUGH, among, greatest, order
from study.ledger.verdict import Verdict
from study.ledger.window import Window, around, at_most
from study.statements.rollers.measured_rollers import (
    ALTERNATING,
    PLAIN,
    ROLLER,
    SEEDS,
    STANDING,
    UNSTRUCTURED,
    MeasuredRollers,
)

ORDER = "order of ‖u^h − u^h_lin‖_V"
EQUAL = Window(0.75, 1.1, "1 less a logarithm: all vertices of Γ3 have equal neighbourhoods")
HALF = around(0.5, 0.15, "neighbours keep different displacements; 1 if all kept the same")
ONE_MESH = around(0.5, 0.3, "one random mesh for every level")
ONE = around(1, 0.25, "the trail is left at few vertices")
SIMILAR = around(1, 0.1, "the same picture at every ℓ = 2h")
SCATTER = around(0.5, 0.35, "as of a sum over n vertices")
STEP = around(2 * math.log(2), 0.15, "2 log 2 of a step of the height 1; other powers of ℓ vanish or explode")
BEST = Window(0.75, 1.1, "1 less a logarithm, as |u|_{H²} grows like |log ℓ|^{1/2}")


def bound(group: pd.DataFrame) -> Measured:
    """Error over the right side of the theorem."""
    return greatest((group["error"] / group["right side"]).to_numpy())


def share(group: pd.DataFrame) -> Measured:
    """Excess over error."""
    return greatest((group["excess"] / group["error"]).to_numpy())


def halving(group: pd.DataFrame) -> Measured | None:
    """What half the time step changes of the excess, where it was taken; none without."""
    both = group.dropna()
    return greatest(abs(both["excess, k/2"] / both["excess"] - 1).to_numpy()) if len(both) else None


def increments(group: pd.DataFrame) -> Measured:
    """What halving ℓ adds to |q|²; the last is shown."""
    found = np.diff(group["|q|²"].to_numpy())
    return among(found[-1], found)


def excess(key: str, where: str, window: Window) -> Criterion:
    """The order of the excess over all levels."""
    return order(key, f"{ORDER}, {where}", window, "excess")


BOUND = Criterion("bound", "error / right side of the theorem", at_most(1.0, "proved"), bound, ("error", "right side"))
TIME = Criterion(
    "time",
    "change of the excess with k/2",
    at_most(0.02, "of the excess, so that it is not one of the steps"),
    halving,
    ("excess", "excess, k/2"),
)
GROWTH = Criterion("step", "growth of |q|²_{1/2,Γ3} with every halving of ℓ", STEP, increments, ("|q|²",), ENOUGH)
OF_MEAN = excess("order-shaken", "mean over shaken meshes", HALF)
OF_SCATTER = Observation(
    order("scatter", "order of the relative standard deviation over them", SCATTER, "scatter"),
    "eight meshes know a standard deviation to a quarter",
)
OF_UNSTRUCTURED = Observation(
    excess("order-unstructured", "unstructured meshes", ONE_MESH),
    "sweeps that even a mesh out leave the part of order 1 in sight, and one mesh hangs on chance",
)
OF_SHARE = Observation(
    Criterion("share", "excess / error, largest", Window(), share, ("excess", "error")),
    "what contact costs in V has no bound of its own",
)
OF_ONE_MESH = Observation(
    excess("order-standing-shaken", "the same on single shaken meshes", ONE),
    "the trail at few vertices hangs on their few neighbourhoods",
)
AT_END = Observation(
    order("order-end", f"{ORDER} at T, one or two diagonals", EQUAL, "excess at T"),
    "it was looked at when orders of the largest one had been seen to rise beyond 1: with one diagonal that is one of "
    "the start, on all meshes but the finest",
)
BESIDE = Observation(
    order("nodal-beside", "order of nodal errors beside the patch, one or two diagonals", SIMILAR, "M_h beside"),
    "it was looked at when orders of M_h had been seen to rise beyond 1: with one diagonal that is one at an end of Γ3",
)
OF_BEST = Observation(
    order("best", "order of E_h = ‖u − P_hu‖_V, that of the linear problem", BEST, "E_h"),
    "a logarithm bends it",
)


class Rollers(MeasuredRollers):
    """The theorem's bound, and the order of the excess on every family of meshes."""

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        kinds = rows.assign(case=rows["case"].str.rpartition("-")[0])
        return [
            rule.verdict(self, kind, chosen) for kind, groups in by_case(kinds) for rule, chosen in judged(kind, groups)
        ]


def judged(kind: str, groups: Groups) -> Iterator[tuple[Rule, Groups]]:
    """What is judged of a kind of roller, and on which meshes."""
    yield BOUND, groups
    if kind == STANDING:
        still = {name: table for name, table in groups.items() if name not in SEEDS}
        yield excess("order-standing", "patches that stay where they are", ONE), still
        yield OF_ONE_MESH, among_families(groups, SEEDS[0])
        return
    yield excess("order-alternating", "alternating diagonals", HALF), among_families(groups, ALTERNATING)
    if kind != ROLLER:
        return
    shaken = {SEEDS[0]: over_seeds(groups)}
    yield excess("order-equal", "one or two diagonals", EQUAL), among_families(groups, *PLAIN)
    yield AT_END, among_families(groups, *PLAIN)
    yield BESIDE, among_families(groups, *PLAIN)
    yield OF_MEAN, shaken
    yield OF_UNSTRUCTURED, among_families(groups, UNSTRUCTURED)
    yield OF_SCATTER, shaken
    yield OF_BEST, groups
    yield OF_SHARE, groups
    yield TIME, {name: table for name, table in groups.items() if "excess, k/2" in table}
    yield GROWTH, among_families(groups, PLAIN[0])


def among_families(groups: Groups, *names: str) -> Groups:
    """Those of some families; an empty table for one that is missing, so that nothing is decided without it."""
    return {name: groups.get(name, pd.DataFrame()) for name in names}


def over_seeds(groups: Groups) -> pd.DataFrame:
    """Mean and relative standard deviation of the excess over the shaken meshes of each level; one is missing: none."""
    if not set(SEEDS) <= set(groups):
        return pd.DataFrame()
    levels = pd.concat([groups[name] for name in SEEDS]).groupby("level")
    mean, spread = levels["excess"].mean(), levels["excess"].std()
    table = pd.DataFrame({"h": levels["h"].mean(), "excess": mean, "scatter": spread / mean}).reset_index()
    return table.sort_values("h", ascending=False)
