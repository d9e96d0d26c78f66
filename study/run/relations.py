"""Relations between columns and files of a run that hold whatever was measured: what breaks one was edited or damaged.

None of them is a statement about the source, and none needs a solution: a mesh size is that of the mesh, an order
follows from errors, three norms satisfy the triangle inequality, bounds are the extremes of their course in time.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from manufactured.case import Case
from study.fem.cell_count import size_of
from study.fem.naming import family_named
from study.ledger.datafiles import CsvFile, in_series, line
from study.run.foreseen import Foreseen
from study.statements.enclosure import BOUNDS, ENCLOSURES, KEY, TIMES, posed
from study.statements.from_rates import GRADED
from study.statements.prop_5_4 import RATES

Tables = Mapping[CsvFile, pd.DataFrame]
Numbers = NDArray[np.float64]
DIGITS = 1e-10
"""Relative room for what twelve digits of several columns leave open."""
KEPT = 2e-5
"""The same for courses in time, of which six digits are kept: 5e-6 for each of the three numbers in a quotient."""
MET = 0.9
"""Part of a largest error that TIMES evenly spread times meet at least, where more were computed."""
ORIGIN = 1e-9
"""Part of T below which a time is 0."""


@dataclass(frozen=True)
class Breach:
    """A number that breaks a relation, with the file, line and column where it stands."""

    file: str
    row: int
    column: str
    stands: object
    expected: str

    def __str__(self) -> str:
        where = f"{self.file}, line {line(self.row)}, column {self.column}"
        return f"{where}: stands {self.stands}, expected {self.expected}"


Relation = Callable[[Tables, Foreseen], Iterator[Breach]]


def breaches(file: str, table: pd.DataFrame, column: str, kept: pd.Series, expected: pd.Series) -> Iterator[Breach]:
    """The rows of a table in which a relation is not kept, and what it expects there."""
    for row in np.flatnonzero(~kept.to_numpy(dtype=bool)):
        yield Breach(file, int(row), column, table[column].iloc[row], str(expected.iloc[row]))


def equal(file: str, table: pd.DataFrame, column: str, expected: pd.Series, room: float = DIGITS) -> Iterator[Breach]:
    """A column has the expected values up to rounding; what is expected to be empty is."""
    stands, wanted = table[column].to_numpy(dtype=float), expected.to_numpy(dtype=float)
    kept = pd.Series(np.isclose(stands, wanted, rtol=room, atol=room, equal_nan=True))
    yield from breaches(file, table, column, kept, expected.map("{:.12g}".format))


def at_most(file: str, table: pd.DataFrame, column: str, bound: pd.Series, what: str) -> Iterator[Breach]:
    """A column is nowhere above a bound; rows without one are left out."""
    kept = ~(table[column] > bound + DIGITS * abs(bound))
    yield from breaches(file, table, column, kept, bound.map(f"at most {{:.12g}}, {what}".format))


def propositions(tables: Tables, foreseen: Foreseen) -> Iterator[Breach]:
    """The proposition in ``rates.csv`` is the one whose hypotheses the case satisfies."""
    rates = tables[RATES]
    expected = rates["case"].map(foreseen.proposition)
    yield from breaches(RATES.name, rates, "claim", rates["claim"] == expected, expected)


def planned_steps(tables: Tables, foreseen: Foreseen) -> Iterator[Breach]:
    """Steps, their size and the dimension are those of the plan."""
    rates = tables[RATES]
    cases = rates["case"].map(foreseen.cases)
    known = rates[cases.notna()].reset_index()
    found: list[Case] = cases.dropna().tolist()
    T = pd.Series([case.solution.body.T for case in found], dtype=float)
    if foreseen.plan:
        scope = foreseen.plan.scope
        steps = [scope.steps(case, n) for case, n in zip(found, known["level"], strict=True)]
        yield from _at(known, equal(RATES.name, known, "steps", pd.Series(steps, dtype=float)))
    yield from _at(known, equal(RATES.name, known, "k", T / known["steps"]))
    dim = pd.Series([case.solution.body.dim for case in found], dtype=float)
    yield from _at(known, equal(RATES.name, known, "dim", dim))
    for column in ("at", "interpolation_at", "discrete_at"):
        nodes = known[column] * 2 * known["steps"] / T
        yield from _at(known, equal(RATES.name, known, column, nodes.round().clip(0, 2 * known["steps"]) * T
                                    / (2 * known["steps"])))  # fmt: skip


def orders(tables: Tables, foreseen: Foreseen) -> Iterator[Breach]:
    """The order in ``rates.csv`` follows from its errors and mesh sizes."""
    rates = tables[RATES]
    yield from equal(RATES.name, rates, "order", in_series(rates, "error"))


def shares(tables: Tables, foreseen: Foreseen) -> Iterator[Breach]:
    """Both time shares are parts of one difference."""
    rates = tables[RATES]
    expected = rates["time_share"] * rates["error"] / rates["discrete_error"]
    yield from equal(RATES.name, rates, "discrete_time_share", expected)


def triangles(tables: Tables, foreseen: Foreseen) -> Iterator[Breach]:
    """‖u − u^h‖, ‖u − Π^h u‖ and ‖Π^h u − u^h‖ are sides of a triangle, and the error at t = 0 is one of those."""
    rates, sides = tables[RATES], ["error", "interpolation_error", "discrete_error"]
    for side in sides:
        others = rates[[other for other in sides if other != side]].sum(axis=1)
        yield from at_most(RATES.name, rates, side, others, "the sum of the two other errors")
    yield from at_most(RATES.name, rates, "initial_error", rates["error"], "the largest error")
    at_0 = rates["at"] <= ORIGIN * rates["k"] * rates["steps"]
    starts = rates.assign(initial_error=rates["initial_error"].where(at_0, rates["error"]))
    yield from equal(RATES.name, starts, "initial_error", rates["error"])


MEASURED = {
    RATES.name: ("error", "interpolation_error", "discrete_error", "predicted_interpolation", "time_share",
                 "discrete_time_share", "residual", "quadrature_change", "parallelogram"),
    "stresses.csv": ("stress", "stress_sup", "best", "strain", "pressure", "displacement", "primal_stress",
                     "primal_displacement", "admissibility", "time_share"),
    BOUNDS.name: ("highest", "residual"),
}  # fmt: skip
"""Columns of what is computed in floating point from many numbers, and is never exactly 0."""


def something(tables: Tables, foreseen: Foreseen) -> Iterator[Breach]:
    """What was measured is positive: a check that reports exactly nothing has not looked."""
    for file, table in tables.items():
        for column in MEASURED.get(file.name, ()):
            wanted = pd.Series("a positive number, as it is measured", table.index)
            yield from breaches(file.name, table, column, table[column] > 0, wanted)


def sizes(tables: Tables, foreseen: Foreseen) -> Iterator[Breach]:
    """h is that of the mesh of a family and level (``size_of``)."""
    known: dict[tuple[object, str, int], float] = {}
    for file, table in tables.items():
        if "h" in table:
            expected = [_size(known, foreseen, *place) for place in table[["case", "family", "level"]].to_numpy()]
            wanted = pd.Series(expected, dtype=float)
            yield from equal(file.name, table, "h", wanted.where(wanted.notna(), table["h"]))


def _size(known: dict[tuple[object, str, int], float], foreseen: Foreseen, case: str, family: str, n: int) -> float:
    """h, made once for all cases on one body; not a number where the case cannot be looked up."""
    if case in foreseen.gone:
        return float("nan")
    body = foreseen.cases[case].solution.body if case in foreseen.cases else posed(case).data.body
    shape = tuple((part.kind, *part.corners.ravel()) for part in (*body.parts, *body.interfaces))
    key = (shape, family, n)
    if key not in known:
        known[key] = size_of(family_named(family), body, n)
    return known[key]


def families(tables: Tables, foreseen: Foreseen) -> Iterator[Breach]:
    """Errors on meshes of two families differ; a coarse graded mesh may be one without a finer part."""
    rates = tables[RATES]
    place, uniform = [rates[name] for name in ("case", "scheme", "level")], rates["family"] != GRADED
    for column in ("error", "discrete_error"):
        same = pd.concat([*place, rates[column].map("{:.9e}".format)], axis=1)[uniform].duplicated(keep=False)
        kept = ~same.reindex(rates.index, fill_value=False)
        wanted = pd.Series("another number than on the meshes of another family", rates.index)
        yield from breaches(RATES.name, rates, column, kept, wanted)


def predicted_bounds(tables: Tables, foreseen: Foreseen) -> Iterator[Breach]:
    """The predicted order in ``bounds.csv`` is that of the problem, and its errors are known or not together."""
    bounds = tables[BOUNDS]
    problems = [posed(case) for case in bounds["case"]]
    orders = pd.Series([problem.order for problem in problems], dtype=float)
    yield from equal(BOUNDS.name, bounds, "expected_order", orders)
    unknown = pd.Series([problem.case is None for problem in problems], dtype=bool)
    for file, table, empty in (
        (BOUNDS, bounds, unknown),
        (ENCLOSURES, tables[ENCLOSURES], tables[ENCLOSURES]["case"].isin(bounds["case"][unknown])),
    ):
        for column in {"error", "above", "below", "upper", "lower"} & set(table):
            wanted = empty.map({True: "nothing, as the solution is unknown", False: "a number"})
            yield from breaches(file.name, table, column, table[column].isna() == empty, wanted)


def courses(tables: Tables, foreseen: Foreseen) -> Iterator[Breach]:
    """Every row of ``bounds.csv`` is the extreme of its course in ``enclosures.csv``."""
    bounds, times = tables[BOUNDS], tables[ENCLOSURES]
    upper, room = times["distance"] + times["bound"], KEPT * (times["distance"] + times["bound"])
    lower = (times["distance"] - times["bound"]).clip(lower=0)
    of_time = pd.DataFrame({
        "error": times["error"], "lowest": lower, "highest": upper, "room": room,
        "above": times["error"] / upper, "below": lower / times["error"], "slack": room / times["error"],
    })  # fmt: skip
    grouped = of_time.groupby([times[name] for name in KEY], sort=False)
    index = pd.MultiIndex.from_frame(bounds[[*KEY]])
    seen, count = grouped.max().reindex(index).reset_index(drop=True), grouped.size().reindex(index).to_numpy()
    rooms = {"error": 0.0, "lowest": seen["room"], "highest": 0.0, "above": 0.0, "below": seen["slack"].fillna(0.0)}
    for column, more in rooms.items():
        room = more + KEPT * seen[column].abs()
        high = np.inf if column == "highest" else seen[column] + room
        high = pd.Series(high, seen.index).where(count < TIMES, seen[column] / MET if column == "error" else np.inf)
        kept = bounds[column].isna() | ((bounds[column] >= seen[column] - room) & (bounds[column] <= high))
        wanted = seen[column].map("{:.6g}, the largest over its times in enclosures.csv".format)
        yield from breaches(BOUNDS.name, bounds, column, kept, wanted)
    ends = bounds["error"].isna() | (bounds["lowest"] <= bounds["highest"])
    yield from breaches(BOUNDS.name, bounds, "lowest", ends, bounds["highest"].map("at most {:.12g}, highest".format))


def _at(known: pd.DataFrame, found: Iterator[Breach]) -> Iterator[Breach]:
    """Breaches in chosen rows, with their places among all rows."""
    for breach in found:
        row = int(known["index"].iloc[breach.row])
        yield Breach(breach.file, row, breach.column, breach.stands, breach.expected)


RELATIONS: tuple[Relation, ...] = (
    propositions, something, sizes, planned_steps, orders, shares, triangles, families, predicted_bounds, courses,
)  # fmt: skip
