"""Notebooks show bodies, exact solutions and cases as HTML."""

from html.parser import HTMLParser

import pytest

from manufactured import Kind, named
from manufactured.catalogue import NAMES

VOID = {"line"}


class Nesting(HTMLParser):
    """Checks that every element is closed in the right order."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.text = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        assert tag in VOID

    def handle_data(self, data: str) -> None:
        self.text += data


@pytest.mark.parametrize("name", NAMES)
def test_a_case_is_shown_with_its_prediction_and_every_piece_of_the_contact_face(name: str) -> None:
    case, html = named(name), Nesting()
    html.feed(case._repr_html_())
    assert html.open == []
    for text in (case.name, case.reason, f"{case.order:g}", case.solution.law.name):
        assert text in html.text
    assert html.text.count("gap w") == len(case.solution.faces)
    body = case.solution.body
    if body.dim == 2:
        assert case._repr_html_().count("<line") == len(body.parts) + len(body.interfaces)
    else:
        assert f"Γ3, contact: {len(body.of(Kind.CONTACT))} flat parts" in html.text
