"""Tables, texts and badges of the README and of the documentation, made from the data of a full run.

Usage: python -m study.present.pages results README.md docs/explanation/results.md …
"""

from __future__ import annotations

import math
import re
import sys
import tomllib
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import astuple, dataclass, replace
from itertools import groupby
from pathlib import Path
from xml.sax.saxutils import escape

import pandas as pd

from study.ledger.chance import PROMISE, seeds_needed
from study.ledger.codes import MADE, Codes
from study.ledger.datafiles import DataError, alarm_summary, by_claim, count_caught, count_kinds, count_verdicts
from study.ledger.files import write_text
from study.ledger.numbered import NO_ROW, NOT_TESTED, NUMBERED, named
from study.ledger.text import above, below, up
from study.ledger.verdict import (
    CAN_FAIL,
    FAILS,
    HOLDS,
    IDENTITY,
    MISSED,
    ONE_SIDED,
    ORDER,
    REPORTED,
    SIZE,
    THEOREM,
    UNCLAIMED,
    UNDECIDED,
    agreement,
    is_of_the_paper,
    kind,
)
from study.ledger.window import STEEPER
from study.present.article import two_digits_up
from study.present.drawing import caption_text, in_style
from study.present.figures import drawings
from study.present.full_run import FullRun
from study.present.missed import missed_rows
from study.present.notation import counted, typeset
from study.present.palette import BLUE, DARK, GREEN, ORANGE, VERMILLION
from study.present.picture import picture_path, read_record, with_every_shape
from study.present.show import write_gif
from study.present.tables import texts
from study.present.windows import FIRST, NOT_NOTHING, RELEASED, Change, added, changes

TABLES, FIGURES, PAGES = "study tables --out {}", "study figures --out {}", "make pages"
"""The commands that write tables and inputs of the papers, figures with captions, and the README with its badges."""
FILM, FILM_DPI, FILM_COLOURS = "hexagon", 66, 32
"""The case that the animation at the top of the README shows, its dots per inch, and the number of its colours."""
ORDERS, CONVERGENCE = ("order", "order-extrapolated", "order-finest"), ("falling", "limit", "order", "order-graded")
"""Keys of the checks that test the order of Proposition 5.4 and the convergence of Proposition 5.3 directly."""
MISPRINTS = "slips"
"""The label of the checks that list misprints."""
CLAIMED = (FAILS, UNDECIDED, HOLDS)
"""Verdicts on claims, from worst to best."""
PLURAL = {HOLDS: "hold", FAILS: "fail"}
END = "<!-- end -->"


def main() -> None:
    """Write tables, badges and the animation: ``python -m study.present.pages RESULTS PAGE …``."""
    directory, *pages = map(Path, sys.argv[1:])
    data = FullRun.read(directory)
    if data is None:
        raise DataError(f"{directory} has no full run: `make full`, `make controls` and `make seeds` make it")
    picture = with_every_shape(read_record(picture_path(directory, FILM)))
    # Every second time is enough, and keeps the file below 120 kB.
    picture = replace(picture, shapes=picture.shapes[::2])
    with in_style():
        write_gif(directory / "figures" / f"{FILM}.gif", picture, lambda: None, FILM_DPI, FILM_COLOURS)
    write_badges(directory / "badges", data, Path("pyproject.toml"))
    for page in pages:
        print(f"{page}: {'changed' if refresh(page, data) else 'up to date'}")


def refresh(page: Path, data: FullRun) -> bool:
    """Write the tables of a page again; return whether the page changed.

    Raises:
        DataError: the page has no marks.
    """
    before = page.read_text(encoding="utf-8")
    text = refreshed(page, data)
    write_text(page, text)
    return text != before


def refreshed(page: Path, data: FullRun) -> str:
    """Return the text of a page with its tables, between ``<!-- NAME -->`` and ``<!-- end -->``, made from the data.

    Raises:
        DataError: the page has no marks.
    """
    text = page.read_text(encoding="utf-8")
    for table in (
        short,
        answer,
        headline,
        results,
        misprints,
        missed,
        statements,
        formulas,
        cases,
        codes,
        marches,
        windows,
        released_windows,
        new_windows,
    ):
        if f"<!-- {table.__name__} -->" in text:
            text = put(text, table.__name__, table(data))
    if END not in text:
        raise DataError(
            f"{page} has no place for a table: a line <!-- NAME -->, then a line {END}, where NAME is the name of a "
            "table: headline, results, statements, cases, codes or another function of study.present.pages"
        )
    return text


def expected_texts(directory: Path) -> dict[Path, tuple[str, str]]:
    """Return the expected texts of all files that follow from the data of a run, and the commands that write the files.

    These files are tables, LaTeX files for the papers and captions of figures; for a full run also the badges and the
    README of the repository to which the run belongs. Files that do not exist are left out.

    Raises:
        DataError: a data file is missing or damaged.
    """
    found = {path: (text, TABLES) for path, text in texts(directory).items()}
    for drawing in drawings(directory):
        found[directory / "figures" / f"{drawing.name}.txt"] = caption_text(drawing), FIGURES
    data, root = FullRun.read(directory), directory.resolve().parent
    if data and (root / "pyproject.toml").is_file():
        for name, badge in badges(data, root / "pyproject.toml").items():
            found[directory / "badges" / name] = badge.svg(), PAGES
        if (root / "README.md").is_file():
            found[root / "README.md"] = refreshed(root / "README.md", data), PAGES
    return {path: (text, made_by.format(directory)) for path, (text, made_by) in found.items() if path.is_file()}


def put(text: str, name: str, table: str) -> str:
    """Return the text of a page in which a table, or a few words, replace what is between two marks.

    Parameters:
        text: the text of the page; if it lacks one of the marks, it is returned unchanged.
        name: the name in the first mark ``<!-- NAME -->``; the second mark is ``END``.
        table: the table, which then begins on a new line, or the words, which stay in their sentence.
    """
    head, mark, rest = text.partition(f"<!-- {name} -->")
    _, end, tail = rest.partition(END)
    start = "\n" if "\n" in table else ""
    return f"{head}{mark}{start}{table}{end}{tail}" if mark and end else text


def markdown(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    lines = [header, ["---"] * len(header), *rows]
    return "".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |\n" for line in lines)


# Answer and results: claim, prediction, observation, verdict


@dataclass(frozen=True)
class Result:
    """One line of the tables of results: a claim, its prediction, the observation, and the verdict."""

    claim: str
    predicted: str
    observed: str
    verdict: str


def answer(data: FullRun) -> str:
    """Return the claims of the paper, the tests and their result in a few sentences, in Markdown.

    The page that shows the sentences defines the targets of the links [problem], [ledger], [results], [misprints] and
    [bounds].
    """
    smooth, rough = data.rows("Prop. 5.4", "order-extrapolated"), data.rows("Prop. 5.3", "order")
    predicted = data.cases.loc[rough["case"], "expected_order"]
    unclaimed = data.claims[data.claims["verdict"].isin(UNCLAIMED)]
    met = unclaimed[unclaimed["expected"].str.startswith("predicted ")].apply(agreement, axis=1).value_counts()
    holding = verdicts_in_words(data.claims, "checks").partition("; ")[0].capitalize()
    claimed = data.claims[data.claims["verdict"].isin(CLAIMED)]
    of_paper = claimed[claimed["label"].map(is_of_the_paper)]
    counts = count_kinds(of_paper)
    tests = f"{counts[ORDER]} observed orders, {counts[SIZE]} sizes and {counts[ONE_SIDED]} one-sided bounds"
    off = _largest_difference(data)
    said = {
        "Claimed": "A viscoelastic body (Kelvin–Voigt law, small strains) is pressed onto a rigid foundation without "
        "friction; the contact zone is unknown and moves. M. Barboteu, W. Han and M. Sofonea proved in 2002 that this "
        "problem has exactly one solution, that it has two equivalent formulations, for displacements and for "
        "stresses, and that linear finite elements in space converge in the energy norm, uniformly in time, with order "
        "1 in the mesh size h if the solution is smooth. Their paper has no computations. ([Problem][problem])",
        "Tested": "Every statement of the paper that a computation can test, on "
        f"{counted(len(data.cases), 'exact solution')} with known contact zones. A check compares a measured number "
        f"with a tolerance window. {counts[ORDER] + counts[SIZE] + counts[ONE_SIDED]} checks can contradict the paper: "
        f"{tests}. {counts[THEOREM] + counts[IDENTITY]} checks are relations of the paper that fail only if the "
        f"program is wrong. The other {len(claimed) - len(of_paper)} checks are about theorems of this study, contact "
        "forces, and the program. ([All checks][ledger], [windows that were changed after a measurement][windows])",
        "Result": f"{holding}. For smooth solutions ({counted(smooth['case'].nunique(), 'case')}) the observed order, "
        f"extrapolated to h → 0, is {_range(smooth)}; the paper predicts 1. For solutions that are not smooth "
        f"({counted(rough['case'].nunique(), 'case')}) the paper predicts convergence without an order; their "
        f"regularity predicts orders from {predicted.min():.3g} to {predicted.max():.3g}, and the observed orders "
        f"differ from them by at most {off}. Besides these checks, this study predicted {met.sum()} numbers about "
        f"which the paper claims nothing: {met['met']} predictions were met, {met['undecided']} are undecided, "
        f"{met['wrong']} were wrong. "
        "([Results][results])",
        "Wrong in print": f"{len(misprint_rows(data))} places, among them one false remark: nodal interpolants of a "
        "continuous initial displacement need not converge to it in the energy norm. In our reading, no theorem "
        "depends on these places. ([Misprints][misprints])",
        "New": "In the plane, order 1 holds without the assumption of the paper on the normal displacement on the "
        "contact boundary (proved). With backward Euler and smooth solutions the error is at most C (h + k) in the "
        "energy norm, for mesh size h and every time step k below a limit that the material sets (proved). The error "
        "of a computed displacement can be enclosed without the exact solution. "
        "([Problem][problem], [error bounds][bounds])",
    }
    return "".join(f"- **{lead}.** {_literal(text)}\n" for lead, text in said.items())


def short(data: FullRun) -> str:
    """Return the main result in one sentence, in Markdown."""
    failing = count_verdicts(data.claims[data.claims["label"].map(is_of_the_paper)])[FAILS]
    contradict = f"{failing} of its checks contradict" if failing else "none of its checks contradicts"
    orders = _range(data.rows("Prop. 5.4", "order-extrapolated"))
    return (
        f"In short: this study computes what the paper proves, and {contradict} the paper. The order of convergence, "
        f"proved to be 1 for smooth solutions, was observed as {orders}.\n"
    )


def headline(data: FullRun) -> str:
    """Return the main results with links to the code behind them, in Markdown; DataError if checks are missing."""
    told = {
        "statements/prop_5_4.py": _prop_5_4,
        "statements/prop_5_3.py": _prop_5_3,
        "statements/thm_4_2_own_space.py": _own_space,
        "statements/enclosure.py": _bound,
    }
    lines = [
        [_literal(line.claim), _literal(line.observed), line.verdict, f"[code](study/{path})"]
        for path, line in ((path, result(data)) for path, result in told.items())
    ]
    return markdown(["claim", "observed", "verdict", "source"], lines)


def results(data: FullRun) -> str:
    """Return the tables of results in Markdown: claims, predictions, observations rounded outwards, and verdicts."""
    beyond = _regularity, _work, _rollers, _time
    rows = (_prop_5_4, _prop_5_3, _same_mesh, _own_space, _bound, *beyond, _defects, _seeds)
    lines = [[_literal(cell) for cell in astuple(row(data))] for row in rows]
    return markdown(["claim", "predicted", "observed", "verdict"], lines)


def _prop_5_4(data: FullRun) -> Result:
    extrapolated = data.rows("Prop. 5.4", "order-extrapolated")
    return Result(
        "Proposition 5.4: for smooth solutions the error falls with order 1, O(h)",
        "order 1",
        f"{counted(extrapolated['case'].nunique(), 'case')}: observed orders {_range(extrapolated)} extrapolated to "
        f"h → 0, {_range(data.rows('Prop. 5.4', 'order'))} between consecutive meshes (on irregular meshes in the "
        "leading term of the error instead of h)",
        _two_groups(data, "Prop. 5.4", ORDERS, "checks of the order"),
    )


def _prop_5_3(data: FullRun) -> Result:
    seen = data.rows("Prop. 5.3", "order")
    expected = data.cases.loc[seen["case"], "expected_order"]
    limit, steeper = (above(100 * data.rows("Prop. 5.3", key)["high"].max(), 0) for key in ("limit", "limit-steeper"))
    extrapolated = data.rows("Prop. 5.3", "limit")
    negative, allowed = below(100 * extrapolated["low"].min(), 0), 100 * extrapolated["window_high"].max()
    steps = data.rates.loc[data.rates["claim"] == "Prop. 5.3", "order"].dropna()
    return Result(
        "Proposition 5.3: the error also tends to 0 if the solution is not smooth",
        f"error → 0; by regularity with orders {expected.min():.3g} to {expected.max():.3g}",
        f"{counted(seen['case'].nunique(), 'case')}: observed orders {_range(seen)} over two refinements; they differ "
        f"from the predicted orders by at most {_largest_difference(data)}. Extrapolated to h → 0, the errors are "
        f"{negative} % to {limit} % of the errors on the two finest meshes; at most {allowed:g} % is required. "
        f"Not judged: orders over single refinements are {below(steps.min(), 2)} to {above(steps.max(), 2)}; errors "
        f"extrapolated with an order that is larger by {STEEPER:g} are at most {steeper} %",
        _two_groups(data, "Prop. 5.3", CONVERGENCE, "checks of convergence"),
    )


def _largest_difference(data: FullRun) -> str:
    """Return the largest difference between observed and predicted order in Proposition 5.3, rounded up."""
    seen = data.rows("Prop. 5.3", "order")
    predicted = data.cases.loc[seen["case"], "expected_order"].to_numpy()
    return above(float((seen["observed"] - predicted).abs().max()), 2)


def _same_mesh(data: FullRun) -> Result:
    allowed, seen = (f"{two_digits_up(data.equivalence[name].max()):.2g}" for name in ("stress_bound", "stress_gap"))
    return Result(
        "Theorem 4.2, displacements and stresses on the same mesh: two solvers find the same stress",
        f"equal up to the tolerance of the stress solver: at most {allowed}, by its duality gap",
        f"the stresses differ by at most {seen}",
        _verdict(data, "Thm 4.2"),
    )


def _own_space(data: FullRun) -> Result:
    label = "Thm 4.2, own space"
    measured = data.rows(label, "order-stress")
    meets = measured["case"].isin(data.rates.loc[data.rates["claim"] == "Prop. 5.4", "case"])
    smooth, others = measured[meets], measured[~meets]
    each = "; ".join(f"{case}: {_range(rows)}" for case, rows in others.groupby("case", sort=False))
    return Result(
        "Theorem 4.2: the stress formulation, solved without displacements, gives the stress of the displacement "
        "formulation",
        "order 3/2 to 2 for smooth solutions, less for others",
        f"{counted(smooth['case'].nunique(), 'smooth case')}: the error of the stress has observed orders "
        f"{_range(smooth)}, predicted 3/2 to 2; {counted(others['case'].nunique(), 'other case')}: {each}",
        _verdict(data, label),
    )


def _bound(data: FullRun) -> Result:
    shares, known = data.rows("bound", "above"), data.bounds[data.bounds["trajectory"] == "bound"]
    return Result(
        "Beyond the paper: an upper bound of the error, computed without the exact solution",
        "error / bound ≤ 1",
        f"{counted(len(shares), 'case')}: error / bound at most {above(shares['high'].max(), 3)}. In the second "
        f"half of the time, half of the {len(known)} computed bounds are at most {above(known['upper'].median(), 2)} "
        f"times the error, all at most {above(known['upper'].max(), 1)} times",
        _verdict(data, "bound"),
    )


def _regularity(data: FullRun) -> Result:
    seen, orders = data.rows("(5.36)", "order"), data.cases
    missing = seen[seen["case"].map(orders["expected_order"]) == 1]
    proved = orders.loc[missing["case"], "proved_order"]
    return Result(
        "Beyond the paper: does order 1 need the smoothness (5.36) that the paper assumes?",
        "The assumption on the trace of u is not needed (proved in the plane). Without the assumption on u̇ the order "
        f"½ is proved for every u with second derivatives, and at least {proved.min():.3g} for these cases",
        f"{counted(len(missing), 'case')} that violate one of the two assumptions: observed orders {_range(missing)}",
        f"{REPORTED}: the question is open",
    )


def _work(data: FullRun) -> Result:
    label = "beyond: work of contact"
    seen = data.rows(label, "order")
    return Result(
        "Beyond the paper: the contact term of the error estimate, if contact patches have all sizes down to h",
        "order 1 on one-diagonal meshes",
        f"{counted(seen['case'].nunique(), 'case')}: observed orders {_range(seen)}",
        _verdict(data, label),
    )


def _rollers(data: FullRun) -> Result:
    label = "beyond: rollers"
    equal, alternating, shaken = (
        _range(data.rows(label, f"order-{family}", "roller")) for family in ("equal", "alternating", "shaken")
    )
    return Result(
        "Beyond the paper: the error that contact adds if a narrow contact patch rolls along the floor",
        "order ½ or more (proved); 1 if all vertices on Γ3 have equal neighbourhoods, ½ if not",
        f"observed orders {equal} on one-diagonal and criss-cross meshes, {alternating} with alternating diagonals, "
        f"{shaken} for the mean over random meshes",
        _verdict(data, label),
    )


def _time(data: FullRun) -> Result:
    label = "beyond: O(h + k)"
    share = above(data.rows(label, "data")["high"].max(), 2)
    return Result(
        "Beyond the paper: backward Euler has the error O(h + k), without a condition between h and the time step k",
        "proved: the error in time is at most k (‖u̇^h(0+)‖/√2 + 2 Var f) on every mesh",
        f"error / bound at most {share}; observed orders in k {_range(data.rows(label, 'order'))}",
        _verdict(data, label),
    )


def _defects(data: FullRun) -> Result:
    caught, injected = count_caught(data.controls)
    return Result(
        "Deliberate defects in the program, one at a time: a named check must fail",
        "every defect is noticed",
        f"{caught} of {injected} defects are noticed",
        HOLDS if caught == injected else FAILS,
    )


def _seeds(data: FullRun) -> Result:
    alarms = alarm_summary(data.seeds)
    by_tail = (
        f"a model of the distributions of all checks, which judges nothing, gives at most {100 * alarms.by_tail:.2f} %"
    )
    if math.isnan(alarms.by_tail):
        by_tail = "too few seeds for an estimate from distributions"
    return Result(
        f"False alarms: random meshes alone make one of the {alarms.rows} checks on them fail for at most "
        f"{100 * PROMISE:.0f} % of all seeds",
        f"at most {100 * PROMISE:.0f} %",
        f"{alarms.red} of {alarms.seeds} new seeds; 95 % confidence interval {100 * alarms.low:.1f} % to "
        f"{100 * alarms.high:.1f} %; {by_tail}; for the checks that take little "
        f"time, {alarms.light_red} of {alarms.light_seeds} seeds",
        f"{alarms.verdict} by the count alone; {seeds_needed()} seeds without an alarm are enough",
    )


def _verdict(data: FullRun, label: str, among: set[str] | None = None) -> str:
    """Return the verdict on a statement and the number of its checks."""
    rows = data.claims[data.claims["label"] == label]
    return _judged(rows if among is None else rows[rows["case"].isin(among)], "checks")


def _two_groups(data: FullRun, label: str, keys: tuple[str, ...], noun: str) -> str:
    """Return the verdict on a proposition, then the numbers of verdicts on further checks of the same computations.

    Parameters:
        label: the label of the proposition.
        keys: the keys of the checks that test the proposition directly.
        noun: what these checks are called.
    """
    rows = data.claims[data.claims["label"] == label]
    tests = rows["key"].isin(keys)
    return f"{_judged(rows[tests], noun)}; {verdicts_in_words(rows[~tests], 'further checks of the same computations')}"


def _judged(rows: pd.DataFrame, noun: str) -> str:
    """Return the worst verdict among checks, the numbers of checks with each verdict, and how many prove only that the
    program is right."""
    count = count_verdicts(rows)
    worst = [verdict for verdict in CLAIMED if count[verdict]]
    if not worst:
        return REPORTED
    holding = rows[rows["verdict"] == HOLDS].apply(kind, axis=1) if count[HOLDS] else pd.Series(dtype=str)
    safe = int((~holding.isin(CAN_FAIL)).sum())
    them = "they" if safe == len(rows) else f"{safe} of them"
    rest = f"; {them} can fail only if the program is wrong" if safe else ""
    return f"{worst[0]}: {verdicts_in_words(rows, noun)}{rest}"


def verdicts_in_words(rows: pd.DataFrame, noun: str) -> str:
    """Return "all 44 checks hold" or the number of checks for each verdict, then the number of missed predictions.

    ``noun`` is what the checks are called, in the plural.
    """
    count = count_verdicts(rows)
    total = sum(count[verdict] for verdict in CLAIMED)
    text = f"all {total} {noun} hold"
    if count[HOLDS] < total:
        each = ", ".join(f"{count[verdict]} {PLURAL.get(verdict, verdict)}" for verdict in CLAIMED if count[verdict])
        text = f"of {total} {noun} {each}"
    missed = count.get(MISSED, 0)
    return f"{text}; {counted(missed, 'prediction')} of this study missed" if missed else text


def _range(rows: pd.DataFrame) -> str:
    """Return the smallest low end and the largest high end of checks as text, rounded outwards."""
    return f"{below(rows['low'].min(), 2)} to {above(rows['high'].max(), 2)}"


def misprints(data: FullRun) -> str:
    """Return the misprints in the paper, in Markdown: place, printed text, corrected text."""
    rows = misprint_rows(data)[["case", "quantity", "expected"]].itertuples(index=False)
    lines = [[_literal(str(cell).removeprefix("read: ")) for cell in row] for row in rows]
    return markdown(["place", "printed", "read"], lines)


def misprint_rows(data: FullRun) -> pd.DataFrame:
    """Return the rows of the ledger that list misprints."""
    return data.claims[data.claims["label"] == MISPRINTS]


def missed(data: FullRun) -> str:
    """Return the predictions of this study that were wrong, and what was learned from them, in Markdown."""
    lines = [[_literal(str(text)) for text in line] for line in missed_rows(data.claims)]
    return markdown(["statement", "case", "quantity", "predicted", "observed", "what was learned"], lines)


# Lists: statements, numbered formulas, other codes, changed windows.


def statements(data: FullRun) -> str:
    """Return all statements with their verdicts, the code files that judge them and their data files, in Markdown."""
    lines = []
    for label, claim, rows in by_claim(data.claims):
        where = data.provenance["statements"].get(label, {"code": [], "data": ["provenance.json"]})
        code = ", ".join(f"[`{path}`](../../{path})" for path in where["code"])
        files = ", ".join(f"`{name}`" for name in where["data"])
        lines.append([_literal(label), _literal(claim), _verdicts(rows), f"{code}: {files}"])
    return markdown(["statement", "says", "verdicts", "code: data"], lines)


def _verdicts(rows: pd.DataFrame) -> str:
    """Return the number of checks with each verdict, as in "3 holds, 1 undecided"."""
    return ", ".join(f"{count} {name}" for name, count in count_verdicts(rows).items() if count)


def formulas(data: FullRun) -> str:
    """Return all numbered formulas and statements of the paper, each with its checks or the reason why it has none."""
    lines = [[numbers, _literal(says), _literal(rows)] for numbers, says, rows in numbered_lines(data.claims)]
    return markdown(["number", "says", "rows, or why there are none"], lines)


def numbered_lines(claims: pd.DataFrame) -> Iterator[tuple[str, str, str]]:
    """Yield each number of the paper with its content, and with its checks or the reason why it has none.

    The order is the order of the paper. Consecutive numbers with equal content and equal checks are joined.

    Raises:
        DataError: a number has no checks and no reason.
    """
    found = numbered_entries(claims)
    if lacking := [number for number in NUMBERED if not found[number]]:
        raise DataError(f"claims.csv has neither rows nor a reason for {', '.join(lacking)}: judge again, or say why")
    for entries, group in groupby(NUMBERED, found.__getitem__):
        numbers = list(group)
        says, rows = ("; ".join(dict.fromkeys(parts)) for parts in zip(*entries, strict=True))
        yield numbers[0] if len(numbers) == 1 else f"{numbers[0]}–{numbers[-1]}", says, rows


def numbered_entries(claims: pd.DataFrame) -> dict[str, list[tuple[str, str]]]:
    """Return number of the paper ↦ content and checks of each statement that names the number.

    For a number without a check, the reason why it has none takes the place of the checks.
    """
    found: dict[str, list[tuple[str, str]]] = {number: [] for number in NUMBERED}
    without = claims["label"].isin((NO_ROW, NOT_TESTED))
    entries = [
        (named(label), claim, f"{label}: {_verdicts(rows)}")
        for label, claim, rows in by_claim(claims[~without & (claims["label"] != MISPRINTS)])
    ]
    for row in claims[without].to_dict("records"):
        entries.append((named(str(row["case"])), str(row["quantity"]), str(row["expected"])))
    for numbers, says, rows in entries:
        for number in numbers & found.keys():
            found[number].append((says, rows))
    return found


def cases(data: FullRun) -> str:
    """Return the number of cases as text, for a sentence."""
    return str(len(data.cases))


def codes(data: FullRun) -> str:
    """Return a table of other people's contact codes in Markdown, with a line for each code and its parameters.

    A line says how the errors behave on finer meshes (the class, and the number of series of meshes with this class),
    and has the worst values.
    """
    return _codes_table(data.codes)


def marches(data: FullRun) -> str:
    """Return the table of ``codes`` for the runs in which other people's codes solve in time by the midpoint rule."""
    return _codes_table(data.marches)


def _codes_table(found: Codes | None) -> str:
    if found is None:
        raise DataError(f"results of other codes are missing: make them with `{MADE}`")
    lines = [
        [
            f"{row['code']} {row['version']}",
            str(row["variant"]),
            str(row["classes"]),
            f"{below(row['order_low'], 2)} … {above(row['order_high'], 2)}",
            up(row["share"], 2),
            up(row["excess"], 3),
            up(row["invariance"], 2),
        ]
        for row in found.rows().to_dict("records")
    ]
    header = ["code", "parameters", "class (series of meshes)", "order in V", "distance / error"]
    return markdown([*header, "pressure error ratio", "effect of scaling"], lines)


def windows(data: FullRun) -> str:
    """Return the tolerance windows that changed since the first round of measurements, in Markdown.

    Raises:
        DataError: a change has no reason.
    """
    return _changes_table(changes(_record(data.earlier, FIRST), data.claims))


def released_windows(data: FullRun) -> str:
    """Return the tolerance windows that changed since the last release, in Markdown.

    Raises:
        DataError: a change has no reason.
    """
    return _changes_table(changes(_record(data.released, RELEASED), data.claims))


def _changes_table(found: Sequence[Change]) -> str:
    alike: dict[tuple[str, str, str], list[str]] = {}
    for change in found:
        ends = ("lower end 0", "lower end 1e-20") if change.why == NOT_NOTHING else (change.before, change.today)
        alike.setdefault((*ends, change.why), []).append(_changed(change))
    lines = [["; ".join(rows), *map(_literal, texts)] for texts, rows in alike.items()]
    return (
        markdown(["rows", "earlier window", "window today", "reason"], lines) if lines else "No window has changed.\n"
    )


def new_windows(data: FullRun) -> str:
    """Return the tolerance windows of checks that did not exist in the first round of measurements, in Markdown."""
    lines = [
        [_changed(one), _literal(one.today), _literal(one.why)]
        for one in added(_record(data.earlier, FIRST), data.claims)
    ]
    return markdown(["rows", "window", "reason for the window"], lines)


def _changed(change: Change) -> str:
    return f"{_literal(change.label)} *{change.key}* ({change.rows})"


def _record(then: pd.DataFrame | None, name: str) -> pd.DataFrame:
    if then is None:
        raise DataError(f"results/history/{name} is missing: it is part of the repository")
    return then


def _literal(text: str) -> str:
    """Return a plain text as Markdown, with superscripts and subscripts in HTML and with ``*`` and ``_`` escaped."""
    return re.sub(r"([*_])", r"\\\1", typeset(text))


# Badges


@dataclass(frozen=True)
class Badge:
    """A badge, which is a small picture at the top of the README: a name, a text, and the colour behind the text."""

    name: str
    says: str
    colour: str

    def svg(self) -> str:
        """Return the badge as SVG; the width follows from the number of letters."""
        margin, height = 6, 20
        left, right = (round(6.4 * len(text)) + 2 * margin for text in (self.name, self.says))
        name, says = escape(self.name), escape(self.says)
        return f"""\
<svg xmlns="http://www.w3.org/2000/svg" width="{left + right}" height="{height}" role="img">
<title>{name}: {says}</title>
<rect width="{left + right}" height="{height}" rx="3" fill="{DARK}"/>
<path d="M{left} 0h{right - 3}a3 3 0 0 1 3 3v{height - 6}a3 3 0 0 1 -3 3h-{right - 3}z" fill="{self.colour}"/>
<g fill="#fff" text-anchor="middle" font-family="DejaVu Sans,Verdana,sans-serif" font-size="11">
<text x="{left / 2:g}" y="14" textLength="{left - 2 * margin}">{name}</text>
<text x="{left + right / 2:g}" y="14" textLength="{right - 2 * margin}">{says}</text>
</g>
</svg>
"""


def badges(data: FullRun, project: Path) -> dict[str, Badge]:
    """Return the badges by their file names: the verdicts, the noticed defects, the Python version and the licence.

    ``project`` is the path of ``pyproject.toml``.
    """
    stated = tomllib.loads(project.read_text(encoding="utf-8"))["project"]
    count, (found, injected) = count_verdicts(data.claims), count_caught(data.controls)
    ledger = VERMILLION if count[FAILS] else ORANGE if count[UNDECIDED] else GREEN
    rows = f"{count[HOLDS]} rows hold, {count[UNDECIDED]} undecided, {count[FAILS]} fail"
    defects = GREEN if found == injected else VERMILLION
    return {
        "ledger.svg": Badge("ledger", rows, ledger),
        "defects.svg": Badge("injected defects", f"{found} of {injected} caught", defects),
        "python.svg": Badge("Python", str(stated["requires-python"]).replace(">=", "≥ "), BLUE),
        "licence.svg": Badge("licence", str(stated["license"]), BLUE),
    }


def write_badges(directory: Path, data: FullRun, project: Path) -> list[Path]:
    """Write all badges into a directory; return their files."""
    return [write_text(directory / name, badge.svg()) for name, badge in badges(data, project).items()]


if __name__ == "__main__":
    main()
