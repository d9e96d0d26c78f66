"""Every exact solution has a file with its formulas and the order that they predict, and is shown in notebooks."""

from importlib import import_module
from pkgutil import iter_modules
from xml.etree import ElementTree

from case_docstrings import missing_parts

from manufactured import Kind, cases, catalogue, named
from manufactured.catalogue import NAMES, module_of


def documentation(name: str) -> str:
    return str(import_module(module_of(name)).__doc__)


def test_every_module_that_makes_a_case_is_in_the_catalogue_under_the_name_of_the_case() -> None:
    modules = [import_module(f"{cases.__name__}.{info.name}") for info in iter_modules(cases.__path__)]
    assert {module.__name__ for module in modules if hasattr(module, "case")} == set(map(module_of, NAMES))
    assert [named(name).name for name in NAMES] == [*NAMES]


def test_the_module_of_a_case_states_its_formulas_and_then_the_order_that_they_predict() -> None:
    found = {case.name: missing_parts(documentation(case.name), case) for case in catalogue()}
    assert {name: missing for name, missing in found.items() if missing} == {}


def test_a_case_is_shown_with_its_prediction_and_every_piece_of_the_contact_face() -> None:
    """A parser of XML refuses elements that are not closed in the right order."""
    for case in catalogue():
        shown = "".join(ElementTree.fromstring(f"<html>{case._repr_html_()}</html>").itertext())
        for text in (case.name, case.reason, f"{case.order:g}", case.solution.law.name):
            assert text in shown, case.name
        assert shown.count("gap w") == len(case.solution.faces), case.name
        body = case.solution.body
        if body.dim == 2:
            assert case._repr_html_().count("<line") == len(body.parts) + len(body.interfaces), case.name
        else:
            assert f"Γ3, contact: {len(body.of(Kind.CONTACT))} flat parts" in shown, case.name
