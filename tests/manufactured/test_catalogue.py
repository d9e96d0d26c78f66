"""Every exact solution has a file with its formulas and the order that they predict, and is shown in notebooks."""

from importlib import import_module
from pkgutil import iter_modules

from case_docstrings import missing_parts

from manufactured import cases, catalogue, named
from manufactured.catalogue import NAMES, module_of


def documentation(name):
    return str(import_module(module_of(name)).__doc__)


def test_every_module_that_makes_a_case_is_in_the_catalogue_under_the_name_of_the_case():
    modules = [import_module(f"{cases.__name__}.{info.name}") for info in iter_modules(cases.__path__)]
    assert {module.__name__ for module in modules if hasattr(module, "case")} == set(map(module_of, NAMES))
    assert [named(name).name for name in NAMES] == [*NAMES]


def test_the_module_of_a_case_states_its_formulas_and_then_the_order_that_they_predict():
    found = {case.name: missing_parts(documentation(case.name), case) for case in catalogue()}
    assert {name: missing for name, missing in found.items() if missing} == {}


def test_four_moving_cases_satisfy_3_4_literally_and_most_cases_slip():
    """(3.4) needs α > 9/2 and m > 5/2."""
    labels = {case.name: case.regularity for case in catalogue() if case.proposition == "Prop. 5.4"}
    literal = {name for name, label in labels.items() if label.moving and label.gap > 4.5 and label.pressure > 2.5}
    assert literal == {"softening", "travelling-patch", "corner", "cube-disc"}
    slipping = [case.name for case in catalogue() if any(any(getattr(f, "slip", ())) for f in case.solution.faces)]
    assert len(slipping) > len(NAMES) / 2
