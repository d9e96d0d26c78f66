"""Labels say which numbered formulas and statements of the source they are about."""

from __future__ import annotations

import pytest

from study.ledger.numbered import NUMBERED, named


def test_there_are_a_hundred_and_six_formulas_and_eleven_statements() -> None:
    assert len(set(NUMBERED)) == len(NUMBERED) == 18 + 15 + 30 + 43 + 11
    assert NUMBERED[0], NUMBERED[-1] == ("(2.1)", "Prop. 5.4")


@pytest.mark.parametrize(
    ("text", "numbers"),
    [
        ("(3.9)–(3.11), (4.14), (4.15)", {"(3.9)", "(3.10)", "(3.11)", "(4.14)", "(4.15)"}),
        ("Thm 4.1, 5.2", {"Thm 4.1", "Thm 5.2"}),
        ("Thm 4.2, own space", {"Thm 4.2"}),
        ("Problem 5.1, (5.2), (5.3)", {"Problem 5.1", "(5.2)", "(5.3)"}),
        ("beyond: O(h + k)", set()),
        ("Π^h", set()),
    ],
)
def test_ranges_and_lists_of_numbers_are_understood(text: str, numbers: set[str]) -> None:
    assert named(text) == numbers


def test_a_range_ends_in_its_section() -> None:
    with pytest.raises(ValueError, match="write a range for each"):
        named("(4.28)–(5.3)")
