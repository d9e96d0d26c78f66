"""The numbered formulas and statements of the paper that belong to a check.

The label of a check names the formulas and statements that the check tests, for example "(3.9)–(3.11), (4.14), (4.15)"
or "Thm 4.1, 5.2". No other place has this information.
"""

import re

NO_ROW, NOT_TESTED = "no row", "not tested"
"""Labels of rows that give the reason why a formula or statement of the paper has no check that can fail."""

_FORMULA = re.compile(r"\((\d)\.(\d+)\)(?:–\((\d)\.(\d+)\))?")
_STATEMENT = re.compile(r"(Thm|Prop\.|Problem) (\d\.\d(?:, \d\.\d)*)")


def named(text: str) -> set[str]:
    """Return the formulas and statements that the label of a check names, as a set of texts.

    Raises:
        ValueError: a range of formulas begins and ends in different sections.

    >>> sorted(named("Thm 4.1, 5.2, (5.2)–(5.4)"))
    ['(5.2)', '(5.3)', '(5.4)', 'Thm 4.1', 'Thm 5.2']
    """
    found = {f"{kind} {number}" for kind, numbers in _STATEMENT.findall(text) for number in numbers.split(", ")}
    for section, first, last_section, last in _FORMULA.findall(text):
        end = int(last) if last else int(first)
        if last_section not in ("", section):
            raise ValueError(f"{text!r} has a range over two sections, expected one section: write a range for each")
        found |= {f"({section}.{n})" for n in range(int(first), end + 1)}
    return found
