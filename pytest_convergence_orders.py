"""pytest plugin: the fixture ``convergence_orders`` judges errors, and the terminal summary lists the observed orders.

The plugin imports only the standard library and pytest. NumPy and SciPy are imported when a test uses the fixture.
"""

from __future__ import annotations

import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

MODULE = "_convergence_orders"
"""Name under which ``study.orders`` is imported, because the tested project may have its own package ``study``."""
PREFIX = "convergence of "
"""Beginning of the names of the properties of a test report that contain the conclusions of checks."""


def _orders() -> ModuleType:
    """Return the package ``study.orders`` that was installed together with this plugin; import it if necessary."""
    folder = Path(__file__).parent / "study" / "orders"
    for name in ("study.orders", MODULE):
        # If the tests import ``study.orders`` themselves, results must be instances of the classes that they know.
        if getattr(sys.modules.get(name), "__file__", None) == str(folder / "__init__.py"):
            return sys.modules[name]
    spec = spec_from_file_location(MODULE, folder / "__init__.py", submodule_search_locations=[str(folder)])
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    sys.modules[MODULE] = module
    missing = ""
    try:
        spec.loader.exec_module(module)
    except ImportError as error:
        missing = str(error.name)
        del sys.modules[MODULE]
    if missing:
        advice = "python -m pip install 'signorini-study[orders]'"
        pytest.fail(f"the fixture convergence_orders needs {missing}: {advice}", pytrace=False)
    return module


@pytest.fixture
def convergence_orders(request: pytest.FixtureRequest) -> Any:
    """Return the function ``check(name, h, errors, expected=None, at_least=None, tolerance=0.15)``.

    ``check`` computes the observed orders of the errors on meshes of size h, returns them, and records them as JUnit
    properties. If an order is expected and the errors do not have it, the test fails. Without an expected order, it
    fails if errors grow or are not finite.
    """

    def check(name: str, h: Any, errors: Any, **options: Any) -> Any:
        __tracebackhide__ = True
        orders = _orders()
        try:
            result = orders.observed_orders(h, errors, name=name, **options)
        except (TypeError, ValueError) as error:
            raise pytest.fail.Exception(f"{name}: {error}", pytrace=False) from None
        # pytest's fixture ``record_property`` is not used, because it warns in projects with the default JUnit format.
        properties = request.node.user_properties
        properties += [(f"{PREFIX}{name}", result.conclusion), (f"order of {name}", f"{result.order:.4g}")]
        wrong = result.verdict != "holds" if result.expectation.window else result.kind in ("grows", "not finite")
        if wrong:
            pytest.fail(f"{name}: {result.conclusion}", pytrace=False)
        return result

    return check


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
