"""Tables, texts and badges of the README and of the documentation, made from the data of a full run.

Usage: python -m study.present.pages results README.md docs/explanation/results.md …
"""

from __future__ import annotations

import math
import re
import sys
import tomllib
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from xml.sax.saxutils import escape

import pandas as pd

from study.fem.mesh import FAMILIES
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

BY_TABLES, BY_FIGURES, BY_PAGES = "study tables --out {}", "study figures --out {}", "make pages"
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
    for name, svg in badges(data, Path("pyproject.toml")).items():
        write_text(directory / "badges" / name, svg)
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
    for name, table in TABLES.items():
        if f"<!-- {name} -->" in text:
            text = put(text, name, table(data))
    if END not in text:
        raise DataError(
            f"{page} has no place for a table: a line <!-- NAME -->, then a line {END}, where NAME is the name of a "
            "table: headline, results, statements, cases, codes or another entry of study.present.pages.TABLES"
        )
    return text


def expected_texts(directory: Path) -> dict[Path, tuple[str, str]]:
    """Return the expected texts of all files that follow from the data of a run, and the commands that write the files.

    These files are tables, LaTeX files for the papers and captions of figures; for a full run also the badges and the
    README of the repository to which the run belongs. Files that do not exist are left out.

    Raises:
        DataError: a data file is missing or damaged.
    """
    found = {path: (text, BY_TABLES) for path, text in texts(directory).items()}
    for drawing in drawings(directory):
        found[directory / "figures" / f"{drawing.name}.txt"] = caption_text(drawing), BY_FIGURES
    data, root = FullRun.read(directory), directory.resolve().parent
    if data and (root / "pyproject.toml").is_file():
        for name, badge in badges(data, root / "pyproject.toml").items():
            found[directory / "badges" / name] = badge, BY_PAGES
        if (root / "README.md").is_file():
            found[root / "README.md"] = refreshed(root / "README.md", data), BY_PAGES
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


Result = list[str]
"""A line of the tables of results: claim, prediction, observation, verdict."""


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
        "Result": f"{holding}. For smooth solutions ({_cases(smooth)}) the observed order, "
        f"extrapolated to h → 0, is {_range(smooth)}; the paper predicts 1. For solutions that are not smooth "
        f"({_cases(rough)}) the paper predicts convergence without an order; their "
        f"regularity predicts orders from {predicted.min():.3g} to {predicted.max():.3g}, and the observed orders "
        f"differ from them by at most {off}. Besides these checks, this study predicted {met.sum()} numbers about "
        f"which the paper claims nothing: {met['met']} predictions were met, {met['undecided']} are undecided, "
        f"{met['wrong']} were wrong. "
        "([Results][results])",
        "Wrong in print": f"{(data.claims['label'] == MISPRINTS).sum()} places, among them one false remark: nodal "
        "interpolants of a continuous initial displacement need not converge to it in the energy norm. In our reading, "
        "no theorem depends on these places. ([Misprints][misprints])",
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
    (smooth, rough, _, own_space), (bound, *_) = _paper_results(data), _beyond_results(data)
    files = {"prop_5_4": smooth, "prop_5_3": rough, "thm_4_2_own_space": own_space, "enclosure": bound}
    lines = [
        [_literal(claim), _literal(observed), verdict, f"[code](study/statements/{file}.py)"]
        for file, (claim, _, observed, verdict) in files.items()
    ]
    return markdown(["claim", "observed", "verdict", "source"], lines)


def results(data: FullRun) -> str:
    """Return the tables of results in Markdown: claims, predictions, observations rounded outwards, and verdicts."""
    rows = *_paper_results(data), *_beyond_results(data), *_program_results(data)
    return markdown(["claim", "predicted", "observed", "verdict"], [list(map(_literal, row)) for row in rows])


def _paper_results(data: FullRun) -> list[Result]:
    """Return the results for Propositions 5.4 and 5.3, and for Theorem 4.2 without and with a space for stresses."""
    smooth, rough = data.rows("Prop. 5.4", "order-extrapolated"), data.rows("Prop. 5.3", "order")
    expected = data.cases.loc[rough["case"], "expected_order"]
    limits = data.rows("Prop. 5.3", "limit")
    limit, steeper = (above(100 * rows["high"].max(), 0) for rows in (limits, data.rows("Prop. 5.3", "limit-steeper")))
    steps = data.rates.loc[data.rates["claim"] == "Prop. 5.3", "order"].dropna()
    allowed, seen = (f"{two_digits_up(data.equivalence[name].max()):.2g}" for name in ("stress_bound", "stress_gap"))
    label = "Thm 4.2, own space"
    measured = data.rows(label, "order-stress")
    meets = measured["case"].isin(data.rates.loc[data.rates["claim"] == "Prop. 5.4", "case"])
    others = measured[~meets]
    each = "; ".join(f"{case}: {_range(rows)}" for case, rows in others.groupby("case", sort=False))
    return [
        [
            "Proposition 5.4: for smooth solutions the error falls with order 1, O(h)",
            "order 1",
            f"{_cases(smooth)}: observed orders {_range(smooth)} extrapolated to h → 0, "
            f"{_range(data.rows('Prop. 5.4', 'order'))} between consecutive meshes (on irregular meshes in the leading "
            "term of the error instead of h)",
            _verdict(data, "Prop. 5.4", ORDERS, "checks of the order"),
        ],
        [
            "Proposition 5.3: the error also tends to 0 if the solution is not smooth",
            f"error → 0; by regularity with orders {expected.min():.3g} to {expected.max():.3g}",
            f"{_cases(rough)}: observed orders {_range(rough)} over two refinements; they differ from the predicted "
            f"orders by at most {_largest_difference(data)}. Extrapolated to h → 0, the errors are "
            f"{below(100 * limits['low'].min(), 0)} % to {limit} % of the errors on the two finest meshes; at most "
            f"{100 * limits['window_high'].max():g} % is required. Not judged: orders over single refinements are "
            f"{below(steps.min(), 2)} to {above(steps.max(), 2)}; errors extrapolated with an order that is larger by "
            f"{STEEPER:g} are at most {steeper} %",
            _verdict(data, "Prop. 5.3", CONVERGENCE, "checks of convergence"),
        ],
        [
            "Theorem 4.2, displacements and stresses on the same mesh: two solvers find the same stress",
            f"equal up to the tolerance of the stress solver: at most {allowed}, by its duality gap",
            f"the stresses differ by at most {seen}",
            _verdict(data, "Thm 4.2"),
        ],
        [
            "Theorem 4.2: the stress formulation, solved without displacements, gives the stress of the displacement "
            "formulation",
            "order 3/2 to 2 for smooth solutions, less for others",
            f"{_cases(measured[meets], 'smooth case')}: the error of the stress has observed orders "
            f"{_range(measured[meets])}, predicted 3/2 to 2; {_cases(others, 'other case')}: {each}",
            _verdict(data, label),
        ],
    ]


def _largest_difference(data: FullRun) -> str:
    """Return the largest difference between observed and predicted order in Proposition 5.3, rounded up."""
    seen = data.rows("Prop. 5.3", "order")
    predicted = data.cases.loc[seen["case"], "expected_order"].to_numpy()
    return above(float((seen["observed"] - predicted).abs().max()), 2)


def _beyond_results(data: FullRun) -> list[Result]:
    """Return the results beyond the paper: bounds, regularity, contact terms, and the error of time discretisation."""
    bounds, known = data.rows("bound", "above"), data.bounds[data.bounds["trajectory"] == "bound"]
    trace = data.rows("(5.36)", "order")
    missing = trace[trace["case"].map(data.cases["expected_order"]) == 1]
    proved = data.cases.loc[missing["case"], "proved_order"]
    work, rollers, time = "beyond: work of contact", "beyond: rollers", "beyond: O(h + k)"
    equal, alternating, shaken = (
        _range(data.rows(rollers, f"order-{family}", "roller")) for family in ("equal", "alternating", "shaken")
    )
    return [
        [
            "Beyond the paper: an upper bound of the error, computed without the exact solution",
            "error / bound ≤ 1",
            f"{counted(len(bounds), 'case')}: error / bound at most {above(bounds['high'].max(), 3)}. In the second "
            f"half of the time, half of the {len(known)} computed bounds are at most "
            f"{above(known['upper'].median(), 2)} times the error, all at most {above(known['upper'].max(), 1)} times",
            _verdict(data, "bound"),
        ],
        [
            "Beyond the paper: does order 1 need the smoothness (5.36) that the paper assumes?",
            "The assumption on the trace of u is not needed (proved in the plane). Without the assumption on u̇ the "
            f"order ½ is proved for every u with second derivatives, and at least {proved.min():.3g} for these cases",
            f"{counted(len(missing), 'case')} that violate one of the two assumptions: observed orders "
            f"{_range(missing)}",
            f"{REPORTED}: the question is open",
        ],
        [
            "Beyond the paper: the contact term of the error estimate, if contact patches have all sizes down to h",
            "order 1 on one-diagonal meshes",
            f"{_cases(data.rows(work, 'order'))}: observed orders {_range(data.rows(work, 'order'))}",
            _verdict(data, work),
        ],
        [
            "Beyond the paper: the error that contact adds if a narrow contact patch rolls along the floor",
            "order ½ or more (proved); 1 if all vertices on Γ3 have equal neighbourhoods, ½ if not",
            f"observed orders {equal} on one-diagonal and criss-cross meshes, {alternating} with alternating "
            f"diagonals, {shaken} for the mean over random meshes",
            _verdict(data, rollers),
        ],
        [
            "Beyond the paper: backward Euler has the error O(h + k), without a condition between h and the time step "
            "k",
            "proved: the error in time is at most k (‖u̇^h(0+)‖/√2 + 2 Var f) on every mesh",
            f"error / bound at most {above(data.rows(time, 'data')['high'].max(), 2)}; observed orders in k "
            f"{_range(data.rows(time, 'order'))}",
            _verdict(data, time),
        ],
    ]


def _program_results(data: FullRun) -> list[Result]:
    """Return the results about the program: noticed deliberate defects, and false alarms on random meshes."""
    caught, injected = count_caught(data.controls)
    alarms = alarm_summary(data.seeds)
    by_tail = (
        f"a model of the distributions of all checks, which judges nothing, gives at most {100 * alarms.by_tail:.2f} %"
    )
    if math.isnan(alarms.by_tail):
        by_tail = "too few seeds for an estimate from distributions"
    return [
        [
            "Deliberate defects in the program, one at a time: a named check must fail",
            "every defect is noticed",
            f"{caught} of {injected} defects are noticed",
            HOLDS if caught == injected else FAILS,
        ],
        [
            f"False alarms: random meshes alone make one of the {alarms.rows} checks on them fail for at most "
            f"{100 * PROMISE:.0f} % of all seeds",
            f"at most {100 * PROMISE:.0f} %",
            f"{alarms.red} of {alarms.seeds} new seeds; 95 % confidence interval {100 * alarms.low:.1f} % to "
            f"{100 * alarms.high:.1f} %; {by_tail}; for the checks that take little time, {alarms.light_red} of "
            f"{alarms.light_seeds} seeds",
            f"{alarms.verdict} by the count alone; {seeds_needed()} seeds without an alarm are enough",
        ],
    ]


def _verdict(data: FullRun, label: str, keys: Sequence[str] = (), noun: str = "checks") -> str:
    """Return the worst verdict on a statement, and how many of its checks have each verdict.

    Then follows how many of them can only fail if the program is wrong.

    Parameters:
        label: the label of the statement.
        keys: the keys of the checks that test the statement directly; the numbers for all further checks then follow.
            If there are no keys, all checks are counted together.
        noun: what these checks are called.
    """
    rows = data.claims[data.claims["label"] == label]
    tests = rows[rows["key"].isin(keys)] if keys else rows
    count = count_verdicts(tests)
    text = next((f"{one}: {verdicts_in_words(tests, noun)}" for one in CLAIMED if count[one]), REPORTED)
    holding = tests[tests["verdict"] == HOLDS]
    safe = int((~holding.apply(kind, axis=1).isin(CAN_FAIL)).sum()) if len(holding) else 0
    judged = sum(count[verdict] for verdict in CLAIMED)  # Rows without a verdict are not counted in the sentence.
    if safe:
        text += f"; {'they' if safe == judged else f'{safe} of them'} can fail only if the program is wrong"
    further = rows[~rows["key"].isin(keys)]
    return f"{text}; {verdicts_in_words(further, 'further checks of the same computations')}" if keys else text


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
    missed = count[MISSED]
    return f"{text}; {counted(missed, 'prediction')} of this study missed" if missed else text


def _range(rows: pd.DataFrame) -> str:
    """Return the smallest low end and the largest high end of checks as text, rounded outwards."""
    return f"{below(rows['low'].min(), 2)} to {above(rows['high'].max(), 2)}"


def _cases(rows: pd.DataFrame, noun: str = "case") -> str:
    """Return the number of cases in a table, with a noun."""
    return counted(rows["case"].nunique(), noun)


def misprints(data: FullRun) -> str:
    """Return the misprints in the paper, in Markdown: place, printed text, corrected text."""
    rows = data.claims.loc[data.claims["label"] == MISPRINTS, ["case", "quantity", "expected"]].itertuples(index=False)
    lines = [[_literal(str(cell).removeprefix("read: ")) for cell in row] for row in rows]
    return markdown(["place", "printed", "read"], lines)


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


def mesh_families(data: FullRun) -> str:
    """Return the table of mesh families: name, meshes, and the least angle in the plane."""
    rows = [[f"*{family.name}*", family.meshes, f"{family.least_angle:g}°"] for family in FAMILIES]
    return markdown(["mesh family", "meshes", "all angles in the plane are larger than"], rows)


def codes_table(found: Codes | None) -> str:
    """Return a table of other people's contact codes in Markdown, with a line for each code and its parameters.

    A line says how the errors behave on finer meshes (the class, and the number of series of meshes with this class),
    and has the worst values.

    Raises:
        DataError: the results are missing.
    """
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


def changed_windows(data: FullRun, name: str) -> str:
    """Return the tolerance windows that changed since an earlier time, in Markdown.

    Parameters:
        name: the file with the earlier windows: FIRST (round of measurements) or RELEASED (the last release).

    Raises:
        DataError: a change has no reason.
    """
    alike: dict[tuple[str, str, str], list[str]] = {}
    for change in changes(_earlier_windows(data, name), data.claims):
        ends = ("lower end 0", "lower end 1e-20") if change.why == NOT_NOTHING else (change.before, change.today)
        alike.setdefault((*ends, change.why), []).append(_changed(change))
    lines = [["; ".join(rows), *map(_literal, texts)] for texts, rows in alike.items()]
    header = ["rows", "earlier window", "window today", "reason"]
    return markdown(header, lines) if lines else "No window has changed.\n"


def new_windows(data: FullRun) -> str:
    """Return the tolerance windows of checks that did not exist in the first round of measurements, in Markdown."""
    new = added(_earlier_windows(data, FIRST), data.claims)
    lines = [[_changed(one), _literal(one.today), _literal(one.why)] for one in new]
    return markdown(["rows", "window", "reason for the window"], lines)


def _changed(change: Change) -> str:
    return f"{_literal(change.label)} *{change.key}* ({change.rows})"


def _earlier_windows(data: FullRun, name: str) -> pd.DataFrame:
    then = {FIRST: data.earlier, RELEASED: data.released}[name]
    if then is None:
        raise DataError(f"results/history/{name} is missing: it is part of the repository")
    return then


def _literal(text: str) -> str:
    """Return a plain text as Markdown, with superscripts and subscripts in HTML and with ``*`` and ``_`` escaped."""
    return re.sub(r"([*_])", r"\\\1", typeset(text))


# Badges


def badge(name: str, says: str, colour: str) -> str:
    """Return a badge as SVG, a small picture at the top of the README: a name, and a text on a colour.

    The width follows from the number of letters.
    """
    margin, height = 6, 20
    left, right = (round(6.4 * len(text)) + 2 * margin for text in (name, says))
    name, says = escape(name), escape(says)
    return f"""\
<svg xmlns="http://www.w3.org/2000/svg" width="{left + right}" height="{height}" role="img">
<title>{name}: {says}</title>
<rect width="{left + right}" height="{height}" rx="3" fill="{DARK}"/>
<path d="M{left} 0h{right - 3}a3 3 0 0 1 3 3v{height - 6}a3 3 0 0 1 -3 3h-{right - 3}z" fill="{colour}"/>
<g fill="#fff" text-anchor="middle" font-family="DejaVu Sans,Verdana,sans-serif" font-size="11">
<text x="{left / 2:g}" y="14" textLength="{left - 2 * margin}">{name}</text>
<text x="{left + right / 2:g}" y="14" textLength="{right - 2 * margin}">{says}</text>
</g>
</svg>
"""


def badges(data: FullRun, project: Path) -> dict[str, str]:
    """Return the badges by their file names: the verdicts, the noticed defects, the Python version and the licence.

    ``project`` is the path of ``pyproject.toml``.
    """
    stated = tomllib.loads(project.read_text(encoding="utf-8"))["project"]
    count, (found, injected) = count_verdicts(data.claims), count_caught(data.controls)
    ledger = VERMILLION if count[FAILS] else ORANGE if count[UNDECIDED] else GREEN
    rows = f"{count[HOLDS]} rows hold, {count[UNDECIDED]} undecided, {count[FAILS]} fail"
    defects = GREEN if found == injected else VERMILLION
    return {
        "ledger.svg": badge("ledger", rows, ledger),
        "defects.svg": badge("injected defects", f"{found} of {injected} caught", defects),
        "python.svg": badge("Python", str(stated["requires-python"]).replace(">=", "≥ "), BLUE),
        "licence.svg": badge("licence", str(stated["license"]), BLUE),
    }


TABLES: dict[str, Callable[[FullRun], str]] = {
    "short": short,
    "answer": answer,
    "headline": headline,
    "results": results,
    "misprints": misprints,
    "missed": missed,
    "statements": statements,
    "formulas": formulas,
    "cases": lambda data: str(len(data.cases)),
    "mesh_families": mesh_families,
    "codes": lambda data: codes_table(data.codes),
    "marches": lambda data: codes_table(data.marches),
    "windows": lambda data: changed_windows(data, FIRST),
    "released_windows": lambda data: changed_windows(data, RELEASED),
    "new_windows": new_windows,
}
"""Name of a place on a page ↦ the function that returns its table or text. ``marches`` are the runs in which other
people's codes solve in time by the midpoint rule."""

if __name__ == "__main__":
    main()
