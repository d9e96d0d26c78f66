"""Relations between columns and files that hold for every measurement. If one is violated, a file was changed.

Nothing is solved to test them. Examples: the column h is the mesh size of the mesh family and level; an observed order
follows from the errors; three norms satisfy the triangle inequality; a bound is the largest of its values over time.
Each function yields a message for each cell that violates one relation. The second part of this file has the relations
for the results of contact codes by other people.
"""

from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from typing import Any

import numpy as np
import pandas as pd

from study.fem.mesh import size_of
from study.fem.naming import family_named
from study.ledger.codes import FOLDER, MARCHES, MESH, NOT_EXPRESSED, Codes
from study.ledger.datafiles import CsvFile, in_series, line, since_before
from study.run.plan import shape
from study.run.provenance import Expectation
from study.statements.enclosure import BOUNDS, ENCLOSURES, KEY, TIMES, resolve_problem
from study.statements.prop_5_4 import RATES
from study.statements.shared.meshes import is_uniform

Tables = Mapping[CsvFile, pd.DataFrame]
DIGITS = 1e-10
"""Relative tolerance for columns that are written with twelve digits."""
SAMPLED_RTOL = 2e-5
"""Relative tolerance for values over time, which have six digits; rounding changes a quotient of three of them by
1.5e-5."""
MIN_SAMPLED_MAX = 0.9
"""The largest error at TIMES equidistant times must be at least this fraction of the largest error at all times."""
ORIGIN = 1e-9
"""A time up to this fraction of the final time T counts as 0."""
CODE_RTOL = 2e-3
"""Relative tolerance in the files of other codes, most of whose columns are written with three digits."""
CODE_ORDER_ROOM = 0.02
"""Tolerance for an observed order between mesh sizes h and h/2 if the errors are written with three digits."""

Relation = Callable[[Tables, Expectation], Iterator[str]]
CodeRelation = Callable[[Codes, str], Iterator[str]]


def breaches(file: str, table: pd.DataFrame, column: str, holds: Any, expected: Iterable[str]) -> Iterator[str]:
    """Yield a message for each cell of a column that violates a relation: its place, its value and the expected value.

    Parameters:
        file, table: name of the file, and its content or some of its rows.
        column: the column.
        holds: for each row whether the relation holds, (rows,).
        expected: the expected value in words, for all rows or for each row.
    """
    for row in np.flatnonzero(~np.asarray(holds, dtype=bool)):
        words = expected if isinstance(expected, str) else [*expected][row]
        where = f"{file}, line {line(int(table.index[row]))}, column {column}"
        yield f"{where}: found {table[column].iloc[row]}, expected {words}"


def equal(file: str, table: pd.DataFrame, column: str, expected: Any) -> Iterator[str]:
    """Yield the cells of a column that differ from their expected values.

    Parameters:
        file, table, column: name of the file, its content or some of its rows, and the column.
        expected: the expected values, (rows,); NaN if the cell must be empty.
    """
    wanted = np.asarray(expected, dtype=float)
    holds = np.isclose(table[column].to_numpy(dtype=float), wanted, rtol=DIGITS, atol=DIGITS, equal_nan=True)
    yield from breaches(file, table, column, holds, [*map("{:.12g}".format, wanted)])


def propositions(tables: Tables, expectation: Expectation) -> Iterator[str]:
    """Check that each row of ``rates.csv`` names the proposition whose assumptions its case satisfies."""
    rates = tables[RATES]
    named = {line["case"]: str(line["statements"]).partition(", ")[0] for line in expectation.lines}
    expected = rates["case"].map(named).fillna("")
    yield from breaches(RATES.name, rates, "claim", rates["claim"] == expected, expected)


def planned_steps(tables: Tables, expectation: Expectation) -> Iterator[str]:
    """Check the numbers of time steps, the dimension, and the times of the largest errors in ``rates.csv``.

    The numbers of time steps must follow from the plan. Times must be ends or midpoints of time steps, at which errors
    are evaluated.
    """
    known = tables[RATES][tables[RATES]["case"].isin([*expectation.cases])]
    cases = [expectation.cases[name] for name in known["case"]]
    T, steps = np.array([case.solution.body.T for case in cases]), known["steps"].to_numpy()
    expected: dict[str, Any] = {}
    if expectation.plan:
        scope = expectation.plan.scope
        expected["steps"] = [scope.steps(case, n) for case, n in zip(cases, known["level"], strict=True)]
    expected |= {"k": T / steps, "dim": [case.solution.body.dim for case in cases]}
    for column in ("at", "interpolation_at", "discrete_at"):
        # Errors are evaluated at the ends and midpoints of time steps, so these times are multiples of half a step.
        nodes = (known[column].to_numpy() * 2 * steps / T).round().clip(0, 2 * steps)
        expected[column] = nodes * T / (2 * steps)
    for column, values in expected.items():
        yield from equal(RATES.name, known, column, values)


def orders(tables: Tables, expectation: Expectation) -> Iterator[str]:
    """Check that the observed orders in ``rates.csv`` follow from the errors and mesh sizes."""
    rates = tables[RATES]
    yield from equal(RATES.name, rates, "order", in_series(rates, "error"))


def shares(tables: Tables, expectation: Expectation) -> Iterator[str]:
    """Check that two columns of ``rates.csv`` give the same error of the time discretisation.

    The column ``time_share`` has this error divided by the error, ``discrete_time_share`` this error divided by the
    discrete error.
    """
    rates = tables[RATES]
    expected = rates["time_share"] * rates["error"] / rates["discrete_error"]
    yield from equal(RATES.name, rates, "discrete_time_share", expected)


def triangles(tables: Tables, expectation: Expectation) -> Iterator[str]:
    """Check that the three errors in ``rates.csv`` satisfy the triangle inequality.

    They are the error, the interpolation error, and the discrete error between both solutions. Also, the error at the
    initial time must be at most the largest error.
    """
    rates, sides = tables[RATES], ["error", "interpolation_error", "discrete_error"]
    bounds = {side: rates[[other for other in sides if other != side]].sum(axis=1) for side in sides}
    for column, bound in {**bounds, "initial_error": rates["error"]}.items():
        what = "the largest error" if column == "initial_error" else "the sum of the two other errors"
        holds = ~(rates[column] > bound + DIGITS * abs(bound))
        yield from breaches(RATES.name, rates, column, holds, bound.map(f"at most {{:.12g}}, {what}".format))
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
"""File ↦ columns that are computed from many rounded numbers. Such a number is never exactly 0."""


def positive(tables: Tables, expectation: Expectation) -> Iterator[str]:
    """Check that measured columns are positive. A value of exactly 0 means that nothing was measured."""
    for file, table in tables.items():
        for column in MEASURED.get(file.name, ()):
            yield from breaches(file.name, table, column, table[column] > 0, "a positive number, as it is measured")


def sizes(tables: Tables, expectation: Expectation) -> Iterator[str]:
    """Check that the column h in all files is the size of the mesh with this family and level."""

    known: dict[Hashable, float] = {}

    def size(case: str, family: str, n: int) -> float:
        found = expectation.cases.get(case)
        body = found.solution.body if found else resolve_problem(case).data.body
        # Each mesh is made once for all bodies of the same shape.
        key = shape(body), family, n
        if key not in known:
            known[key] = size_of(family_named(family), body, n)
        return known[key]

    for file, table in tables.items():
        if "h" in table:
            there = table[~table["case"].isin(expectation.gone)]
            yield from equal(file.name, there, "h", [size(*place) for place in there[MESH].to_numpy()])


def families(tables: Tables, expectation: Expectation) -> Iterator[str]:
    """Check that errors on different mesh families differ; equal errors would be a copy.

    Graded meshes are skipped: a coarse one may equal the uniform mesh.
    """
    rates = tables[RATES]
    place, uniform = [rates[name] for name in ("case", "scheme", "level")], rates["family"].map(is_uniform).astype(bool)
    for column in ("error", "discrete_error"):
        same = pd.concat([*place, rates[column].map("{:.9e}".format)], axis=1)[uniform].duplicated(keep=False)
        holds = ~same.reindex(rates.index, fill_value=False)
        yield from breaches(RATES.name, rates, column, holds, "another number than on the meshes of another family")


def predicted_bounds(tables: Tables, expectation: Expectation) -> Iterator[str]:
    """Check the columns of ``bounds.csv`` and ``enclosures.csv`` that are known before a bound is computed.

    The expected order must be that of the problem. Errors must be empty exactly if the exact solution is unknown.
    """
    bounds = tables[BOUNDS]
    problems = [resolve_problem(case) for case in bounds["case"]]
    yield from equal(BOUNDS.name, bounds, "expected_order", [problem.order for problem in problems])
    unknown = pd.Series([problem.case is None for problem in problems], dtype=bool)
    for file, table, empty in (
        (BOUNDS, bounds, unknown),
        (ENCLOSURES, tables[ENCLOSURES], tables[ENCLOSURES]["case"].isin(bounds["case"][unknown])),
    ):
        for column in {"error", "above", "below", "upper", "lower"} & set(table):
            wanted = empty.map({True: "nothing, as the solution is unknown", False: "a number"})
            yield from breaches(file.name, table, column, table[column].isna() == empty, wanted)


def extremes(tables: Tables, expectation: Expectation) -> Iterator[str]:
    """Check that each number in ``bounds.csv`` is the largest of the values over time in ``enclosures.csv``."""
    bounds, times = tables[BOUNDS], tables[ENCLOSURES]
    upper, room = times["distance"] + times["bound"], SAMPLED_RTOL * (times["distance"] + times["bound"])
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
        room = more + SAMPLED_RTOL * seen[column].abs()
        high = np.inf if column == "highest" else seen[column] + room
        high = pd.Series(high, seen.index).where(
            count < TIMES, seen[column] / MIN_SAMPLED_MAX if column == "error" else np.inf
        )
        holds = bounds[column].isna() | ((bounds[column] >= seen[column] - room) & (bounds[column] <= high))
        wanted = seen[column].map("{:.6g}, the largest over its times in enclosures.csv".format)
        yield from breaches(BOUNDS.name, bounds, column, holds, wanted)
    ends = bounds["error"].isna() | (bounds["lowest"] <= bounds["highest"])
    yield from breaches(BOUNDS.name, bounds, "lowest", ends, bounds["highest"].map("at most {:.12g}, highest".format))


RELATIONS: tuple[Relation, ...] = (
    propositions, positive, sizes, planned_steps, orders, shares, triangles, families, predicted_bounds, extremes,
)  # fmt: skip


def same_best(codes: Codes, folder: str) -> Iterator[str]:
    """Check that the error of the discrete solution on a mesh is the same in the rows of all codes.

    The discrete solution is the finite-element solution with exact contact constraints, which this study computes.
    """
    errors = codes.errors
    for column in ("h", "best", "best_pressure"):
        first = errors.groupby(MESH)[column].transform("median")
        holds = abs(errors[column] - first) <= 2 * CODE_RTOL * first
        wanted = first.map("{:.4g}, as in the rows of most other codes".format)
        yield from breaches(f"{folder}/errors.csv", errors, column, holds, wanted)


def code_triangle(codes: Codes, folder: str) -> Iterator[str]:
    """Check the triangle inequality between three solutions.

    They are the solution of another code, the discrete solution with exact contact constraints, and the exact solution.
    """
    errors = codes.errors
    room = CODE_RTOL * (errors["best"] + errors["distance"])
    holds = abs(errors["error"] - errors["best"]) <= errors["distance"] + room
    wanted = errors["best"].map("{:.4g} up to the distance from the solution in K^h".format)
    yield from breaches(f"{folder}/errors.csv", errors, "error", holds, wanted)


CODE_ORDERS = {"order_in_v": "error", "order_of_distance": "distance", "order_of_pressure": "pressure"}


def code_orders(codes: Codes, folder: str) -> Iterator[str]:
    """Check that the observed orders in ``classes.csv`` follow from the errors on the two finest meshes."""
    finest: dict[object, dict[str, float]] = {}
    for number, rows in codes.errors.sort_values("level").groupby("series", sort=False):
        h, *errors = (rows[name].to_numpy()[-2:] for name in ("h", *CODE_ORDERS.values()))
        last = [float(since_before(h, error)[-1]) for error in errors]
        finest[number] = dict(zip(CODE_ORDERS.values(), last, strict=True))
    classes = codes.classes
    for column, of in CODE_ORDERS.items():
        expected = np.array([finest.get(number, {}).get(of, np.nan) for number in classes["series"]])
        holds = ~(abs(classes[column] - expected) > CODE_ORDER_ROOM)
        yield from breaches(f"{folder}/classes.csv", classes, column, holds, [*map("{:.4g}".format, expected)])


def every_series(codes: Codes, folder: str) -> Iterator[str]:
    """Check that ``classes.csv`` and ``errors.csv`` have the same series.

    A series is a code with fixed parameters on the meshes of one case and mesh family. Each series has a class, and it
    has errors unless the code cannot express the problem.
    """
    there, left_out = codes.classes["series"].isin(codes.errors["series"]), codes.classes["class"] == NOT_EXPRESSED
    wanted = there.map({True: "a class, as there are errors", False: f"{NOT_EXPRESSED}, as there are no errors"})
    yield from breaches(f"{folder}/classes.csv", codes.classes, "class", there != left_out, wanted)
    there = codes.errors["code"].notna()
    yield from breaches(f"{folder}/errors.csv", codes.errors, "series", there, "a series of classes.csv")


CODE_RELATIONS: tuple[CodeRelation, ...] = (same_best, code_triangle, code_orders, every_series)
FOLDERS = FOLDER, MARCHES
