"""Every exact solution has a function with its formulas and the order that they predict, and is shown in notebooks."""

from importlib import import_module
from inspect import getdoc, getmembers, isclass, isfunction, signature

from case_docstrings import missing_parts

from manufactured import Case, catalogue, named
from manufactured.catalogue import MODULES, NAMES, OTHER_NAMES, function_of

CASES = {name: import_module(f"manufactured.cases.{name}") for name in dict.fromkeys(MODULES.values())}
"""The modules with cases."""


def own(module, kind):
    """Returns the names of the functions or classes that a module defines."""
    return [name for name, found in getmembers(module, kind) if found.__module__ == module.__name__]


def test_every_function_that_makes_a_case_is_in_the_catalogue_under_the_name_of_the_case():
    made = {
        (function, name)
        for name, module in CASES.items()
        for function in own(module, isfunction)
        if signature(getattr(module, function)).return_annotation is Case
    }
    others = {entry for entry in made if entry[0] in map(function_of, OTHER_NAMES)}
    assert made - others == {(function_of(name), module) for name, module in MODULES.items()}
    assert [named(name).name for name in NAMES] == [*NAMES]


def test_the_modules_of_cases_define_no_class_because_results_depend_on_the_values_of_cases_only():
    assert {name: own(module, isclass) for name, module in CASES.items()} == {name: [] for name in CASES}


def test_the_docstring_of_a_case_states_its_formulas_and_then_the_order_that_they_predict():
    found = {
        case.name: missing_parts(getdoc(getattr(CASES[MODULES[case.name]], function_of(case.name))), case)
        for case in catalogue()
    }
    assert {name: missing for name, missing in found.items() if missing} == {}
