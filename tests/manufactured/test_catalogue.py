"""Every exact solution has a function with its formulas and the order that they predict, and is shown in notebooks."""

from importlib import import_module
from inspect import getdoc

from case_docstrings import missing_parts

from manufactured import Case, catalogue, named
from manufactured.catalogue import MODULES, NAMES, NATURAL_MOTION, NO_POTENTIAL, function_of

DEFINED = {
    name: value
    for module in {*MODULES.values()}
    for name, value in vars(import_module(f"manufactured.cases.{module}")).items()
    if getattr(value, "__module__", "").startswith("manufactured.cases.")
}
"""What the modules of cases define."""


def test_every_function_that_makes_a_case_is_in_the_catalogue_under_the_name_of_the_case():
    """Cases have no classes of their own, because results depend on the values of cases and not on their modules."""
    assert not any(isinstance(value, type) for value in DEFINED.values())
    made = {name for name, value in DEFINED.items() if value.__annotations__.get("return") is Case}
    assert made == {*map(function_of, (*NAMES, NATURAL_MOTION, NO_POTENTIAL))}
    assert [named(name).name for name in NAMES] == [*NAMES]


def test_the_docstring_of_a_case_states_its_formulas_and_then_the_order_that_they_predict():
    found = {case.name: missing_parts(getdoc(DEFINED[function_of(case.name)]), case) for case in catalogue()}
    assert {name: missing for name, missing in found.items() if missing} == {}
