"""The results of a run as text for a terminal, and its verdicts as JUnit XML."""

import math
import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.etree import ElementTree

import pandas as pd
from tabulate import tabulate

from convergence_orders.printing import printable
from study.ledger.datafiles import SERIES, by_claim, count_kinds, count_verdicts, expected_orders, read_rates
from study.ledger.files import write_text
from study.ledger.text import above, below, cell, is_narrow, significant, width
from study.ledger.verdict import (
    BECAUSE,
    FAILS,
    HOLDS,
    MISSED,
    REPORTED,
    UNDECIDED,
    VERDICTS,
    Verdict,
)
from study.present.notation import read_page
from study.present.templates import ENVIRONMENT

SENTENCES: dict[str, str] = read_page("texts")["printed"]
"""Name of a printed sentence ↦ its template."""
FEW_CASES = 3
"""If a run has at most this number of cases, its reported numbers without a claim are printed, too."""


def rates_text(directory: Path) -> str:
    """Return the table of errors that ``study run`` prints, with a row for each case and mesh family of ``rates.csv``.

    A row has the finest level n and its error, the order of the discrete error between the two finest levels, the
    largest share of the time discretisation on all levels in per cent, the predicted order of the error, and the
    observed orders from level to level. The first orders are left out if the terminal is not wide enough.
    """
    rates = read_rates(directory)
    predicted = expected_orders(directory, rates)
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
        lines += [claim, _aligned(head, rows, widths, numbers=slice(2, 7)), ""]
    return "\n".join(lines)


def orders_text(directory: Path) -> str:
    """Return a text on the differences between the observed and the predicted orders of the error in all cases.

    The differences are those of ``order_differences``. Without observed orders the text is empty.
    """
    # Imported here, because Matplotlib takes half a second, and most commands draw nothing.
    from study.present.charts import order_differences

    rates = read_rates(directory)
    differences = order_differences(rates, expected_orders(directory, rates))["difference"]
    if differences.empty:
        return ""
    low, high = below(differences.min(), 2), above(differences.max(), 2)
    return f"observed orders of the error over two refinements differ from the predicted ones by {low} to {high}"


def ledger_text(claims: pd.DataFrame, orders: str = "") -> str:
    """Return the ledger as ``study run`` prints it: statements with their verdicts, failed checks, and a summary.

    There is a row for each statement with the number of cases and the number of checks with each verdict. Then all
    checks that do not hold are listed. Reported numbers, about which nothing is claimed, are listed only if there are
    at most ``FEW_CASES`` cases.

    Parameters:
        claims: the content of ``claims.csv``.
        orders: the text of ``orders_text``, which is added to the conclusion.
    """
    rows = [
        [label, claim, judged["case"].nunique(), *(number or "" for number in count_verdicts(judged).values())]
        for label, claim, judged in by_claim(claims)
    ]
    words = (11, 17) if is_narrow() else (22, 36)
    lines = [_aligned(("statement", "", "cases", *VERDICTS), rows, (*words, 5, 5, 8, 6, 9, 5), numbers=slice(2, 8)), ""]
    few = claims["case"].nunique() <= FEW_CASES
    for verdict in (*([REPORTED] if few else []), MISSED, UNDECIDED, FAILS):
        for _, row in claims[claims["verdict"] == verdict].iterrows():
            expected, _, why = row["expected"].partition(BECAUSE)
            observed = observed_text(row["observed"], row["low"], row["high"])
            where = row["label"], row["case"]
            text = printed("check", row=row, where=where, expected=expected, why=why, observed=observed)
            lines += _wrapped(text, indent="    ")
    count, kinds = count_verdicts(claims), count_kinds(claims)
    lines += _wrapped(printed("counts", total=len(claims), count=count))
    lines += _wrapped(printed("kinds", kinds=kinds)) if count[HOLDS] else []
    lines += _wrapped(printed("conclusion", count=count, orders=orders))
    return "\n".join(lines) + "\n"


def printed(name: str, **values: object) -> str:
    """Return the sentence that a template of ``page/texts.toml``, [printed], makes from values."""
    return ENVIRONMENT.from_string(SENTENCES[name]).render(values)


def _wrapped(text: str, indent: str = "") -> list[str]:
    return textwrap.wrap(text, width(), subsequent_indent=indent, break_on_hyphens=False)


def write_junit(path: Path, verdicts: list[Verdict]) -> None:
    """Write verdicts into a JUnit XML file, as one test case each.

    The verdict *fails* is a failure; the verdicts *undecided*, *missed* and *reported* are skipped tests.
    """
    suite = ElementTree.Element("testsuite", name="ledger", tests=str(len(verdicts)))
    for verdict in verdicts:
        name = f"{verdict.label}.{verdict.case}"
        case = ElementTree.SubElement(suite, "testcase", classname=name, name=verdict.quantity)
        if verdict.verdict != HOLDS:
            observed = observed_text(verdict.observed, verdict.low, verdict.high)
            message = f"expected {verdict.expected}, observed {observed}"
            ElementTree.SubElement(case, "failure" if verdict.verdict == FAILS else "skipped", message=message)
    for total, tag in (("failures", "failure"), ("skipped", "skipped")):
        suite.set(total, str(len(suite.findall(f"*/{tag}"))))
    ElementTree.indent(suite)
    write_text(path, printable(ElementTree.tostring(suite, encoding="unicode", xml_declaration=True) + "\n"))


def observed_text(observed: float, low: float, high: float) -> str:
    """Return an observed value with its range as text; if one end is infinite, the other end as a bound."""
    if math.isnan(observed):
        return "no number"
    if math.isinf(low) and math.isinf(high):
        return cell(observed)
    if math.isinf(low):
        return f"at most {cell(high)}"
    return f"at least {cell(low)}" if math.isinf(high) else f"{cell(observed)} in [{cell(low)}, {cell(high)}]"


def _rates_row(series: pd.DataFrame, predicted: Mapping[str, float], schemes: bool, shown: int) -> list[object]:
    """Return the cells of a row of ``rates_text``.

    Parameters:
        series: the rows of ``rates.csv`` of one case and mesh family, from coarse to fine.
        predicted: case ↦ predicted order.
        schemes: whether the time scheme is named.
        shown: the largest number of orders.
    """
    finest = series.iloc[-1]
    orders = [f"{order:.2f}" for order in series["order"].dropna()]
    return [
        finest["case"],
        f"{finest['family']}, {finest['scheme']}" if schemes else finest["family"],
        finest["level"],
        significant(finest["error"]),
        "" if pd.isna(finest["discrete_order"]) else f"{finest['discrete_order']:.2f}",
        f"{100 * series['time_share'].max():.2f}",
        f"{predicted[finest['case']]:.3g}",
        " ".join(["…"] * (len(orders) > shown) + orders[-shown:]),
    ]


def _aligned(head: Sequence[str], rows: Sequence[Sequence[object]], widths: Sequence[int], numbers: slice) -> str:
    """Return a table as text.

    Parameters:
        head: the headings.
        rows: the cells.
        widths: the widths at which the cells of each column are folded.
        numbers: the columns that are aligned to the right.
    """
    sides = ["left"] * len(head)
    sides[numbers] = ["right"] * len(sides[numbers])
    return tabulate([head, *rows], tablefmt="plain", disable_numparse=True, maxcolwidths=[*widths], colalign=sides)
