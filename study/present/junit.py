"""Verdicts as JUnit XML, which continuous integration systems display."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from xml.etree import ElementTree

from study.ledger.files import write_text
from study.ledger.verdict import FAILS, HOLDS, Verdict


def write_junit(path: Path, verdicts: list[Verdict]) -> None:
    """One test case per verdict; fails is a failure, undecided and reported are skipped."""
    count = Counter(verdict.verdict for verdict in verdicts)
    skipped = len(verdicts) - count[HOLDS] - count[FAILS]
    totals = {"tests": str(len(verdicts)), "failures": str(count[FAILS]), "skipped": str(skipped)}
    suite = ElementTree.Element("testsuite", {"name": "ledger", **totals})
    for verdict in verdicts:
        names = {"classname": f"{verdict.label}.{verdict.case}", "name": verdict.quantity}
        case = ElementTree.SubElement(suite, "testcase", names)
        message = (
            f"expected {verdict.expected}, observed {verdict.observed:.6g} in [{verdict.low:.6g}, {verdict.high:.6g}]"
        )
        if verdict.verdict == FAILS:
            ElementTree.SubElement(case, "failure", message=message)
        elif verdict.verdict != HOLDS:
            ElementTree.SubElement(case, "skipped", message=message)
    ElementTree.indent(suite)
    write_text(path, ElementTree.tostring(suite, encoding="unicode", xml_declaration=True) + "\n")
