"""The outcome of a run: rates and ledger as text for a terminal, and verdicts as JUnit XML."""

from __future__ import annotations

import math
import textwrap
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.etree import ElementTree

import pandas as pd
from tabulate import tabulate

from study.ledger.datafiles import SERIES, by_claim, count_kinds, count_verdicts, read_csv, read_rates
from study.ledger.files import write_text
from study.ledger.text import above, below, cell, is_narrow, significant, width
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
from study.present.charts import order_differences
from study.present.notation import counted

FEW_CASES = 3
"""The largest number of cases whose reported checks are printed."""
CONTACT_TEST = "case", "family", "levels", "defect", "what", "holding", "noticed", "noticed_by"
"""Columns of ``contact-test.csv``."""


def rates_text(directory: Path) -> str:
    """Return one row per case and mesh family from ``rates.csv``, as wide as the terminal, at most 110 columns.

    A row has the finest level n and its error, the order of the discrete error between the two finest levels, the
    largest time share of all levels, the predicted order of the error, and the orders from level to level; only the
    last orders if not all fit.
    """
    rates, predicted = read_rates(directory), predicted_orders(directory)
    schemes = rates["scheme"].nunique() > 1
    predicted_head, words = ("pred.", (11, 12, 14)) if is_narrow() else ("predicted", (22, 13, 25))
    if schemes and not is_narrow():
        words = (20, 21, 21)
    head = ("case", "meshes", "n", "error", "disc. order", "time %", predicted_head, "orders level by level")
    widths = (*words[:2], 5, 9, 5, 5, len(predicted_head), words[2])
    lines: list[str] = []
    for claim, of_claim in rates.groupby("claim", sort=False):
        rows = [
            _rates_row(series, predicted, schemes, (words[2] + 1) // 5)
            for _, series in of_claim.groupby(SERIES, sort=False)
        ]
        lines += [str(claim), _aligned(head, rows, widths, numbers=slice(2, 7)), ""]
    return "\n".join(lines)


def predicted_orders(directory: Path) -> dict[str, float]:
    """Return the predicted order of the error of every case of a directory."""
    cases = read_csv(directory, "cases.csv", ("case", "expected_order"))
    return dict(zip(cases["case"], cases["expected_order"].astype(float), strict=True))


def orders_text(directory: Path) -> str:
    """Return by how much the observed orders of the error differ from the predicted ones; empty without orders.

    Observed orders are those over the last two refinements. Meshes graded towards a singularity are left out, because
    the predicted orders hold for quasi-uniform meshes.
    """
    differences = order_differences(read_rates(directory), predicted_orders(directory))["difference"]
    if differences.empty:
        return ""
    low, high = below(differences.min(), 2), above(differences.max(), 2)
    return f"observed orders of the error differ from the predicted ones by {low} to {high}"


def ledger_text(claims: pd.DataFrame, orders: str = "") -> str:
    """Return one row per statement of the ledger, then every check that does not hold, and a summary.

    A row has the number of cases, and the numbers of checks by verdict. Checks that are only reported are listed for
    few cases, whose user wants to read them. The summary counts the checks that hold by the kind of their evidence, and
    ends with a conclusion, to which ``orders`` of ``orders_text`` is added.
    """
    rows = [
        [label, claim, str(judged["case"].nunique()), *(str(n or "") for n in count_verdicts(judged).values())]
        for label, claim, judged in by_claim(claims)
    ]
    words = (11, 17) if is_narrow() else (22, 36)
    lines = [_aligned(("statement", "", "cases", *VERDICTS), rows, (*words, 5, 5, 8, 6, 9, 5), numbers=slice(2, 8)), ""]
    few = claims["case"].nunique() <= FEW_CASES
    for verdict in (*([REPORTED] if few else []), MISSED, UNDECIDED, FAILS):
        for _, row in claims[claims["verdict"] == verdict].iterrows():
            lines += _finding(row)
    count = count_verdicts(claims)
    counts = (
        f"{counted(len(claims), 'check')}: {count[HOLDS]} hold, {count[FAILS]} fail, {count[UNDECIDED]} undecided, "
        f"{count[MISSED]} missed (our own prediction was wrong), {count[REPORTED]} reported without a claim"
    )
    for text in (counts, *([kinds_text(claims)] if count[HOLDS] else []), conclusion(count, orders)):
        lines += textwrap.wrap(text, width(), break_on_hyphens=False)
    return "\n".join(lines) + "\n"


def kinds_text(claims: pd.DataFrame) -> str:
    """Return a sentence that counts the checks that hold by the kind of their evidence."""
    counts = ", ".join(f"{count} {name}" for name, count in count_kinds(claims).items())
    return f"evidence of the checks that hold: {counts} ({THEOREM} and {IDENTITY} fail only if the code is broken)"


def conclusion(count: Mapping[str, int], orders: str = "") -> str:
    """Return one sentence on whether the statements are confirmed, and on the observed orders."""
    seen = f"; {orders}" if orders else ""
    if count[FAILS]:
        return f"Conclusion: {counted(count[FAILS], 'check')} contradicted a statement{seen}."
    if not count[HOLDS]:
        return "Conclusion: nothing was decided."
    rest = f"; {counted(count[UNDECIDED], 'check')} could not be decided" if count[UNDECIDED] else ""
    confirmed = f"{counted(count[HOLDS], 'check')} confirmed {'its claim' if count[HOLDS] == 1 else 'their claims'}"
    return f"Conclusion: no statement was contradicted, {confirmed}{rest}{seen}."


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
    """Write one test case per verdict: *fails* is a failure; undecided, missed and reported are skipped."""
    count = Counter(verdict.verdict for verdict in verdicts)
    skipped = len(verdicts) - count[HOLDS] - count[FAILS]
    totals = {"tests": str(len(verdicts)), "failures": str(count[FAILS]), "skipped": str(skipped)}
    suite = ElementTree.Element("testsuite", {"name": "ledger", **totals})
    for verdict in verdicts:
        names = {"classname": f"{verdict.label}.{verdict.case}", "name": verdict.quantity}
        case = ElementTree.SubElement(suite, "testcase", names)
        message = f"expected {verdict.expected}, observed {observed_text(verdict.observed, verdict.low, verdict.high)}"
        if verdict.verdict == FAILS:
            ElementTree.SubElement(case, "failure", message=message)
        elif verdict.verdict != HOLDS:
            ElementTree.SubElement(case, "skipped", message=message)
    ElementTree.indent(suite)
    write_text(path, ElementTree.tostring(suite, encoding="unicode", xml_declaration=True) + "\n")


def observed_text(observed: float, low: float, high: float) -> str:
    """Return an observed value with its range, or the one-sided bound that is known of it."""
    if math.isnan(observed) or (math.isinf(low) and math.isinf(high)):
        return "no number" if math.isnan(observed) else cell(observed)
    if low == high == observed:
        return cell(observed)
    if math.isinf(low):
        return f"at most {cell(high)}"
    return f"at least {cell(low)}" if math.isinf(high) else f"{cell(observed)} in [{cell(low)}, {cell(high)}]"


def _rates_row(series: pd.DataFrame, predicted: Mapping[str, float], schemes: bool, shown: int) -> list[str]:
    finest = series.iloc[-1]
    orders = [f"{order:.2f}" for order in series["order"].dropna()]
    return [
        str(finest["case"]),
        f"{finest['family']}, {finest['scheme']}" if schemes else str(finest["family"]),
        str(finest["level"]),
        significant(finest["error"]),
        "" if pd.isna(finest["discrete_order"]) else f"{finest['discrete_order']:.2f}",
        f"{100 * series['time_share'].max():.2f}",
        f"{predicted[str(finest['case'])]:.3g}",
        " ".join(["…"] * (len(orders) > shown) + orders[-shown:]),
    ]


def _finding(row: pd.Series) -> list[str]:
    """Return the lines of a verdict that does not hold, with its quantity, folded to the terminal width."""
    expected, _, why = str(row["expected"]).partition(BECAUSE)
    observed = observed_text(*(float(row[name]) for name in ("observed", "low", "high")))
    where = f"{row['label']}, {row['case']}" if row["case"] else str(row["label"])
    # Of a row without a claim only the number matters here; the ledger has the reason why nothing is claimed.
    values = f"observed {observed}" if row["verdict"] == REPORTED else f"expected {expected}, observed {observed}"
    text = f"{row['verdict']}: {where}: {row['quantity']}: {values}{f'; because {why}' if why else ''}"
    return textwrap.wrap(text, width(), subsequent_indent="    ", break_on_hyphens=False)


def _aligned(head: Sequence[str], rows: Sequence[Sequence[str]], widths: Sequence[int], numbers: slice) -> str:
    """Return columns two spaces apart, with longer cells folded and numbers aligned to the right."""
    sides = ["left"] * len(head)
    sides[numbers] = ["right"] * len(sides[numbers])
    return str(
        tabulate([head, *rows], tablefmt="plain", disable_numparse=True, maxcolwidths=list(widths), colalign=sides)
    )
