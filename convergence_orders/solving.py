"""Collects errors while a program solves on finer and finer meshes; prints and judges their orders."""

import math
import time
from collections.abc import Callable, Mapping
from typing import Any

from .judging import Results, check_orders
from .orders import FAILS, HOLDS, UNDECIDED, OrderError


class ConvergenceTable:
    """A table of errors that grows by one row for each mesh.

    Attributes:
        columns: name of a column ↦ numbers, one for each mesh.
        dim: dimension of the meshes, if their sizes are numbers of cells or unknowns.
    """

    def __init__(self, dim: int | None = None) -> None:
        self.columns: dict[str, list[float]] = {}
        self.dim = dim

    def add(self, **row: float) -> None:
        """Add the sizes and errors on one mesh, for example ``add(h=0.5, dofs=9, L2=0.1)``.

        Raises:
            OrderError: the columns are not those of the rows before.
        """
        if self.columns and row.keys() != self.columns.keys():
            raise OrderError(f"a row with {', '.join(row)}, expected {', '.join(self.columns)}")
        for name, value in row.items():
            self.columns.setdefault(name, []).append(float(value))

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()), []))

    def check(self, expected: Mapping[str, float] | float | None = None, **options: Any) -> Results:
        """Compute and judge the observed orders of all columns; the options are those of ``check_orders``.

        Raises:
            OrderError: no column is a mesh size or a time step.
        """
        return check_orders(None, self.columns, expected, dim=self.dim, **options)

    def assert_order(self, at_least: Mapping[str, float] | None = None, tolerance: float = 0.15,
                     floor: float = 0.0, max_error: Mapping[str, float] | None = None, columns: str = "",
                     **expected: float) -> Results:  # fmt: skip
        """Assert, in a test, that columns have the expected orders, for example ``assert_order(L2=2, H1=1)``.

        Observed orders are computed from mesh to mesh. The last three of them must be as expected; two suffice if the
        order extrapolated to h → 0 is as expected, too.

        Parameters:
            at_least: name of a column ↦ the smallest accepted order. All higher orders are accepted, too. Give it
                instead of ``expected``, not in addition, for a column. The tolerance is not subtracted.
            tolerance: the observed orders may be lower or higher than the expected order by this number.
            floor: errors on fine meshes may stagnate at values up to this number, for example because of another error.
                Then only coarser meshes are judged. By default, stagnation fails, unless its cause is round-off.
            max_error: name of a column ↦ the largest accepted error on the finest mesh.
            columns: the names of the columns of errors, separated by commas; by default they are recognised.
            expected: the expected order of each column, as a keyword.

        Returns:
            Name of a column ↦ observed orders and verdict, for all columns of errors.

        Raises:
            AssertionError: a column is not as expected, or there are too few meshes to decide; the message has the
                table.
            OrderError: nothing is expected, or a name is no column.
        """
        results = self.check(
            expected or None, at_least=at_least, tolerance=tolerance, floor=floor, max_error=max_error, columns=columns
        )
        judged = [result for result in results.values() if result.expectation.judges]
        if not judged:
            raise OrderError("assert_order got no order, expected one: assert_order(L2=2) or at_least={'L2': 1.8}")
        wrong = [f"{result.name}: {result.conclusion}" for result in judged if result.verdict != HOLDS]
        assert not wrong, "\n".join([*wrong, str(self)])
        return results

    def cells(self) -> list[list[str]]:
        """Return the names and the cells of the table, with a column of observed orders beside each column of errors.

        There are no orders without mesh sizes, or if the coarsest mesh does not come first.
        """
        try:
            results = self.check()
        except OrderError:
            # A table without mesh sizes is printed without orders.
            results = {}
        columns = []
        for name, values in self.columns.items():
            result = results.get(name)
            # Orders belong to the rows if the coarsest mesh comes first.
            if result and result.errors == tuple(values):
                columns.append([name, *(f"{error:.3e}" for error in values)])
                columns.append(["order", "-", *(f"{order:.2f}" for order in result.orders)])
            else:
                columns.append([name, *(f"{value:.6g}" for value in values)])
        return [list(row) for row in zip(*columns, strict=True)]

    def __str__(self) -> str:
        rows = self.cells()
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        return "\n".join("  ".join(map(str.rjust, row, widths)) for row in rows)

    def to_markdown(self) -> str:
        """Return the table in Markdown, with the observed orders beside the errors, as in ``cells``."""
        header, *rows = self.cells()
        return "".join(f"| {' | '.join(row)} |\n" for row in [header, ["---:"] * len(header), *rows])

    def to_csv(self) -> str:
        """Return the table as comma-separated values, without rounding and without orders."""
        rows = [self.columns, *zip(*self.columns.values(), strict=True)]
        return "".join(",".join(map(str, row)) + "\n" for row in rows)

    def to_latex(self) -> str:
        """Return the table as a LaTeX tabular, with the observed orders beside the errors, as in ``cells``."""
        header, *rows = (" & ".join(row).replace("_", r"\_") + " \\\\\n" for row in self.cells())
        begin = rf"\begin{{tabular}}{{*{{{header.count('&') + 1}}}{{r}}}}"
        return f"{begin}\n\\hline\n{header}\\hline\n{''.join(rows)}\\hline\n\\end{{tabular}}\n"


def refine_until_settled(
    solve: Callable[[int], Mapping[str, float]], table: ConvergenceTable | None = None, most: int = 8,
    seconds: float = math.inf, **wishes: Any,
) -> Results:  # fmt: skip
    """Solve on finer and finer meshes until all verdicts are settled or the limit of meshes or time is reached.

    A verdict is settled if it is not *undecided*; *fails* is settled on four meshes or more.

    Parameters:
        solve: function of the level 0, 1, 2, … that returns a row, such as ``{"h": 0.5, "L2": 0.1}``.
        table: the table to which the rows are added.
        most, seconds: largest number of meshes, and the time after which no further mesh is begun.
        wishes: what is expected, as in ``check_orders``.

    Returns:
        Name of a column ↦ observed orders and verdict.
    """
    table = ConvergenceTable() if table is None else table
    results: Results = {}
    start = time.monotonic()
    for level in range(most):
        table.add(**solve(level))
        if level > 0:
            results = table.check(**wishes)
        verdicts = {result.verdict for result in results.values()}
        settled = level > 1 and UNDECIDED not in verdicts and (level > 2 or FAILS not in verdicts)
        if settled or time.monotonic() - start > seconds:
            break
    return results
