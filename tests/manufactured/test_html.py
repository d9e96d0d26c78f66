"""Notebooks show bodies, exact solutions and cases as HTML."""

from xml.etree import ElementTree

from manufactured import Kind, catalogue


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
