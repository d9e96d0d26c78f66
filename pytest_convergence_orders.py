"""pytest plugin: the fixture ``convergence_orders`` judges errors, and the terminal summary shows the orders.

Imports only the standard library and pytest; NumPy and SciPy are needed once the fixture is used.
"""

from __future__ import annotations

import importlib
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

FOUND = pytest.StashKey[list[str]]()


def _orders() -> ModuleType:
    """``study.orders`` of this package; fails in words if the tested project has a package ``study`` of its own."""
    try:
        return importlib.import_module("study.orders")
    except ImportError as error:
        study = importlib.import_module("study") if error.name == "study.orders" else None
        where = getattr(study, "__file__", None) or next(iter(getattr(study, "__path__", ["?"]))) if study else None
        if where and Path(__file__).parent / "study" not in Path(where).parents:
            pytest.fail(
                f"the fixture convergence_orders needs the package study of signorini-study, but {where} comes first"
            )
        pytest.fail(
            f"the fixture convergence_orders needs {error.name}: python -m pip install 'signorini-study[orders]'"
        )


@pytest.fixture
def convergence_orders(request: pytest.FixtureRequest, record_property: Any) -> Any:
    """A function like ``study.orders.assert_order`` with a name in front, whose results the summary lists."""

    def check(name: str, h: Any, errors: Any, **options: Any) -> Any:
        orders = _orders()
        found = orders.observed_orders(h, errors, name=name, **options)
        request.config.stash.setdefault(FOUND, []).append(f"{name}: {found.verdict or 'reported'}: {found.sentence}")
        record_property(f"order of {name}", f"{found.order:.4g}")
        record_property(f"verdict of {name}", found.verdict)
        if options.get("expected") is not None or options.get("at_least") is not None:
            orders.assert_order(h, errors, **options)
        return found

    return check


def pytest_terminal_summary(terminalreporter: Any, config: pytest.Config) -> None:
    """The orders of all tables that tests judged."""
    lines = config.stash.get(FOUND, [])
    if lines:
        terminalreporter.section("observed orders")
        for line in lines:
            terminalreporter.write_line(line)
