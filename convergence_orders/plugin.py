"""pytest plugin: the fixture ``convergence_orders`` judges errors, and the terminal summary lists the observed orders.

The plugin imports only the standard library and pytest. NumPy is imported when a test uses the fixture.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from .judging import Results
    from .orders import OrderResult
    from .solving import ConvergenceTable

PREFIX = "convergence of "
"""Beginning of the names of the properties of a test report that contain the conclusions of checks."""


class OrderChecks:
    """The fixture ``convergence_orders``: it judges errors and records their orders as JUnit properties."""

    def __init__(self, properties: list[tuple[str, object]]) -> None:
        # pytest's fixture ``record_property`` is not used, because it warns in projects with the default JUnit format.
        self.properties = properties

    def __call__(self, name: str, h: Any, errors: Any, **options: Any) -> OrderResult:
        """Return the observed orders of errors; the options are those of ``observed_orders``.

        If an order is expected and the errors do not have it, the test fails. Without an expected order, it fails if
        errors grow, stagnate, tend to another limit than 0, or are not finite.
        """
        __tracebackhide__ = True
        from .orders import observed_orders

        try:
            result = observed_orders(h, errors, name=name, **options)
        except (TypeError, ValueError) as error:
            raise pytest.fail.Exception(f"{name}: {error}", pytrace=False) from None
        self._record(result)
        return result

    def table(self, table: ConvergenceTable, title: str = "", /, columns: str = "", **expected: Any) -> Results:
        """Return the observed orders of the columns of a table, for example ``table(errors, "P1", L2=2, H1=1)``.

        The test fails as for a single column of errors (``__call__``).

        Parameters:
            table: the sizes and errors.
            title: what is written before the names of the columns.
            columns: names of the columns of errors, separated by commas; by default they are recognised.
            expected: name of a column ↦ expected order.
        """
        __tracebackhide__ = True
        results = table.check(expected or None, columns=columns)
        for result in results.values():
            self._record(result, title)
        return results

    def _record(self, result: OrderResult, title: str = "") -> None:
        __tracebackhide__ = True
        name = f"{title} {result.name}".strip()
        self.properties += [(f"{PREFIX}{name}", result.conclusion), (f"order of {name}", f"{result.order:.4g}")]
        if result.expectation.judges:
            wrong = result.verdict != "holds"
        else:
            wrong = result.kind in ("grows", "stagnates", "orders falling", "not finite")
        if wrong:
            pytest.fail(f"{name}: {result.conclusion}", pytrace=False)


@pytest.fixture
def convergence_orders(request: pytest.FixtureRequest) -> OrderChecks:
    """Return a function ``check(name, h, errors, expected=None, at_least=None, tolerance=0.15)`` that judges errors.

    The test fails if the errors do not have the expected order. The arguments are the name of the errors, the mesh
    sizes, the errors, and what is expected, as in ``observed_orders``. The attribute ``table`` of the function judges
    the columns of a ``ConvergenceTable`` (``OrderChecks.table``).
    """
    return OrderChecks(request.node.user_properties)


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """Print the conclusions of all checks of orders.

    They are taken from the test reports, so that checks in other processes of pytest-xdist are included.
    """
    reports = [report for reports in terminalreporter.stats.values() for report in reports]
    # The last report of a test, which is on its teardown, has the properties of its setup and its call, too.
    last = [report for report in reports if getattr(report, "when", "") == "teardown"]
    properties = [entry for report in last for entry in report.user_properties]
    lines = [f"{key.removeprefix(PREFIX)}: {value}" for key, value in properties if key.startswith(PREFIX)]
    if lines:
        terminalreporter.section("observed orders")
        for line in lines:
            terminalreporter.write_line(line)
