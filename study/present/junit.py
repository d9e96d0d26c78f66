"""Verdicts as JUnit XML, which continuous integration systems display."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

from study.ledger.files import write_text
from study.ledger.verdict import FAILS, HOLDS, Verdict


def write_junit(path: Path, verdicts: list[Verdict]) -> None:
    """One test case per verdict; fails is a failure, undecided and reported are skipped."""
    count = {v: sum(verdict.verdict == v for verdict in verdicts) for v in (HOLDS, FAILS)}
    suite = ElementTree.Element(
        "testsuite",
        name="ledger",
        tests=str(len(verdicts)),
        failures=str(count[FAILS]),
        skipped=str(len(verdicts) - count[HOLDS] - count[FAILS]),
    )
    for verdict in verdicts:
        case = ElementTree.SubElement(
            suite, "testcase", classname=f"{verdict.label}.{verdict.case}", name=verdict.quantity
        )
        message = (
            f"expected {verdict.expected}, observed {verdict.observed:.6g} in [{verdict.low:.6g}, {verdict.high:.6g}]"
        )
        if verdict.verdict == FAILS:
            ElementTree.SubElement(case, "failure", message=message)
        elif verdict.verdict != HOLDS:
            ElementTree.SubElement(case, "skipped", message=message)
    ElementTree.indent(suite)
    write_text(path, ElementTree.tostring(suite, encoding="unicode", xml_declaration=True) + "\n")
