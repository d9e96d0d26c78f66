"""The outcome of a run: rates and ledger for a terminal, from the data files, and verdicts as JUnit XML."""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.etree import ElementTree

import pandas as pd
from tabulate import tabulate

from study.ledger.datafiles import SERIES, by_claim, count_kinds, count_verdicts, read_csv, read_rates
from study.ledger.files import write_text
from study.ledger.text import cell, is_narrow, significant, width
from study.ledger.verdict import (
    BECAUSE,
    FAILS,
    HOLDS,
    IDENTITY,
    MISSED,
    REPORTED,
    THEOREM,
    UNDECIDED,
    VERDICTS,
    Verdict,
)
from study.present.notation import counted

CONTACT_TEST = "case", "family", "levels", "defect", "what", "holding", "noticed", "noticed_by"
"""Columns of ``contact-test.csv``."""


def rates_text(directory: Path) -> str:
    """Returns a row per case and mesh family from ``rates.csv``, as wide as the terminal, at most 110 columns.

    It has the finest level n and its error, the order of the discrete error between the two finest levels, the largest
    time share of all levels, and the orders from level to level, the last ones if not all fit.
    """
    rates = read_rates(directory)
    schemes = rates["scheme"].nunique() > 1
    head = ("case", "meshes", "n", "error", "disc. order", "largest time %", "orders level by level")
    words = (13, 13, 16) if is_narrow() else (20, 25, 21) if schemes else (28, 13, 25)
    widths = (*words[:2], 5, 9, 5 if is_narrow() else 11, 7, words[2])
    lines: list[str] = []
    for claim, of_claim in rates.groupby("claim", sort=False):
        rows = [_rates_row(series, schemes, (words[2] + 1) // 5) for _, series in of_claim.groupby(SERIES, sort=False)]
        lines += [str(claim), _aligned(head, rows, widths, numbers=slice(2, 6)), ""]
    return "\n".join(lines)


def ledger_text(claims: pd.DataFrame) -> str:
    """Return a row per statement of the ledger, as wide as ``rates_text``, every row that does not hold, and a summary.

    A statement has the number of its cases, and the numbers of its rows by verdict. The summary counts the rows that
    hold by the kind of their evidence, and ends with a conclusion.
    """
    rows = [
        [label, claim, str(judged["case"].nunique()), *(str(n or "") for n in count_verdicts(judged).values())]
        for label, claim, judged in by_claim(claims)
    ]
    words = (11, 17) if is_narrow() else (22, 36)
    lines = [_aligned(("statement", "", "cases", *VERDICTS), rows, (*words, 5, 5, 8, 6, 9, 5), numbers=slice(2, 8)), ""]
    for verdict in (MISSED, UNDECIDED, FAILS):
        for _, row in claims[claims["verdict"] == verdict].iterrows():
            lines += _finding(row)
    count = count_verdicts(claims)
    counts = (
        f"{counted(len(claims), 'row')}: {count[HOLDS]} hold, {count[FAILS]} fail, {count[UNDECIDED]} undecided, "
        f"{count[MISSED]} missed (our own prediction was wrong), {count[REPORTED]} reported without a claim"
    )
    for text in (counts, *([kinds_text(claims)] if count[HOLDS] else []), conclusion(count)):
        lines += textwrap.wrap(text, width(), break_on_hyphens=False)
    return "\n".join(lines) + "\n"


def kinds_text(claims: pd.DataFrame) -> str:
    """Return a sentence that counts the rows that hold by the kind of their evidence."""
    counts = ", ".join(f"{count} {name}" for name, count in count_kinds(claims).items())
    return f"evidence of the rows that hold: {counts} ({THEOREM} and {IDENTITY} fail only if the code is broken)"


def conclusion(count: Mapping[str, int]) -> str:
    """Return what the verdicts say about the statements, in one sentence."""
    if count[FAILS]:
        return f"Conclusion: {counted(count[FAILS], 'row')} contradicted what a statement claims."
    if not count[HOLDS]:
        return "Conclusion: nothing was decided."
    rest = f"; {counted(count[UNDECIDED], 'row')} could not be decided" if count[UNDECIDED] else ""
    return f"Conclusion: no statement was contradicted, {counted(count[HOLDS], 'row')} confirmed their claims{rest}."


def contact_test_text(directory: Path) -> str:
    """Return how strongly each own case tests contact, from ``contact-test.csv``: what noticed each defect."""
    table = read_csv(directory, "contact-test.csv", CONTACT_TEST)
    lines = [text for _, rows in table.groupby("case", sort=False) for text in _contact_test(rows)]
    return "\n".join(line for text in lines for line in textwrap.wrap(text, width(), subsequent_indent="    ")) + "\n"


def _contact_test(rows: pd.DataFrame) -> list[str]:
    first, missed = rows.iloc[0], rows[rows["noticed"] == 0]
    where = f"{first['case']}, {first['family']} meshes, n = {first['levels']}"
    if missed.empty:
        return [
            f"test of contact: {where}: a solver with a defect would be noticed:",
            *(f"  {row['what']}: by {row['noticed_by']}" for _, row in rows.iterrows()),
        ]
    return [
        f"weak test of contact: {where}: of {first['holding']} rows that hold, none notices "
        f"{' or '.join(missed['what'])}. "
        "Take a larger pressure relative to moduli and gap, a contact zone that is wider in cells, or finer levels."
    ]


def write_junit(path: Path, verdicts: list[Verdict]) -> None:
    """Writes one test case per verdict; fails is a failure; undecided, missed and reported are skipped."""
    count = Counter(verdict.verdict for verdict in verdicts)
    skipped = len(verdicts) - count[HOLDS] - count[FAILS]
    totals = {"tests": str(len(verdicts)), "failures": str(count[FAILS]), "skipped": str(skipped)}
    suite = ElementTree.Element("testsuite", {"name": "ledger", **totals})
    for verdict in verdicts:
        names = {"classname": f"{verdict.label}.{verdict.case}", "name": verdict.quantity}
        case = ElementTree.SubElement(suite, "testcase", names)
        interval = f"[{verdict.low:.6g}, {verdict.high:.6g}]"
        message = f"expected {verdict.expected}, observed {verdict.observed:.6g} in {interval}"
        if verdict.verdict == FAILS:
            ElementTree.SubElement(case, "failure", message=message)
        elif verdict.verdict != HOLDS:
            ElementTree.SubElement(case, "skipped", message=message)
    ElementTree.indent(suite)
    write_text(path, ElementTree.tostring(suite, encoding="unicode", xml_declaration=True) + "\n")


def _rates_row(series: pd.DataFrame, schemes: bool, shown: int) -> list[str]:
    finest = series.iloc[-1]
    orders = [f"{order:.2f}" for order in series["order"].dropna()]
    return [
        str(finest["case"]),
        f"{finest['family']}, {finest['scheme']}" if schemes else str(finest["family"]),
        str(finest["level"]),
        significant(finest["error"]),
        "" if pd.isna(finest["discrete_order"]) else f"{finest['discrete_order']:.2f}",
        f"{100 * series['time_share'].max():.2f}",
        " ".join(["…"] * (len(orders) > shown) + orders[-shown:]),
    ]


def _finding(row: pd.Series) -> list[str]:
    """Returns the lines of a verdict that is not a pass, with its quantity, folded to the width."""
    expected, _, why = str(row["expected"]).partition(BECAUSE)
    observed = f"{cell(row['observed'])} in [{cell(row['low'])}, {cell(row['high'])}]"
    where = f"{row['label']}, {row['case']}" if row["case"] else str(row["label"])
    values = f"expected {expected}, observed {'no number' if pd.isna(row['observed']) else observed}"
    text = f"{row['verdict']}: {where}: {row['quantity']}: {values}{f'; because {why}' if why else ''}"
    return textwrap.wrap(text, width(), subsequent_indent="    ", break_on_hyphens=False)


def _aligned(head: Sequence[str], rows: Sequence[Sequence[str]], widths: Sequence[int], numbers: slice) -> str:
    """Returns columns two spaces apart, with longer cells folded and numbers on the right."""
    sides = ["left"] * len(head)
    sides[numbers] = ["right"] * len(sides[numbers])
    return str(
        tabulate([head, *rows], tablefmt="plain", disable_numparse=True, maxcolwidths=list(widths), colalign=sides)
    )
