"""Notebooks show bodies, exact solutions and cases as HTML."""

from xml.etree import ElementTree

import pytest

from manufactured import Kind, named
from manufactured.catalogue import NAMES


@pytest.mark.parametrize("name", NAMES)
def test_a_case_is_shown_with_its_prediction_and_every_piece_of_the_contact_face(name: str) -> None:
    """A parser of XML, as it refuses elements that are not closed in the right order."""
    case = named(name)
    shown = "".join(ElementTree.fromstring(f"<html>{case._repr_html_()}</html>").itertext())
    for text in (case.name, case.reason, f"{case.order:g}", case.solution.law.name):
        assert text in shown
    assert shown.count("gap w") == len(case.solution.faces)
    body = case.solution.body
    if body.dim == 2:
        assert case._repr_html_().count("<line") == len(body.parts) + len(body.interfaces)
    else:
        assert f"Γ3, contact: {len(body.of(Kind.CONTACT))} flat parts" in shown
