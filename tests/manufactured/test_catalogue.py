"""Every exact solution has a function with its formulas and the order that they predict, and is shown in notebooks."""

from case_docstrings import missing_parts
from places import ROOT

from manufactured import catalogue, named
from manufactured.catalogue import MODULES, NAMES, NATURAL_MOTION, NO_POTENTIAL, function_of
from study.cli.cases import docstrings

DOCSTRINGS = {name: text for module in MODULES.values() for name, text in docstrings(module).items()}
"""The docstrings of all functions in the modules of cases."""


def test_every_function_that_predicts_an_order_is_in_the_catalogue_under_the_name_of_the_case():
    predicting = {name for name, text in DOCSTRINGS.items() if "\nPredicted order" in text}
    assert predicting == {*map(function_of, (*NAMES, NATURAL_MOTION, NO_POTENTIAL))}
    assert [named(name).name for name in NAMES] == [*NAMES]


def test_modules_of_cases_define_no_class_because_results_depend_on_the_values_of_cases_only():
    for module in MODULES.values():
        assert "\nclass " not in (ROOT / "manufactured" / "cases" / f"{module}.py").read_text()


def test_the_docstring_of_a_case_states_its_formulas_and_then_the_order_that_they_predict():
    found = {case.name: missing_parts(DOCSTRINGS[function_of(case.name)], case) for case in catalogue()}
    assert {name: missing for name, missing in found.items() if missing} == {}


def test_four_moving_cases_satisfy_3_4_literally_and_most_cases_slip():
    """(3.4) needs α > 9/2 and m > 5/2."""
    labels = {case.name: case.regularity for case in catalogue() if case.proposition == "Prop. 5.4"}
    literal = {name for name, label in labels.items() if label.moving and label.gap > 4.5 and label.pressure > 2.5}
    assert literal == {"softening", "travelling-patch", "corner", "cube-disc"}
    slipping = [case.name for case in catalogue() if any(any(getattr(f, "slip", ())) for f in case.solution.faces)]
    assert len(slipping) > len(NAMES) / 2
