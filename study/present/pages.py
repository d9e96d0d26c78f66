"""Tables, texts and badges of the README and of the documentation, made from the data of a full run.

Usage: python -m study.present.pages results README.md docs/explanation/results.md …
"""

import re
import sys
import tomllib
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from pandas import DataFrame

from manufactured.colours import BLUE, DARK, GREEN, ORANGE, VERMILLION
from study.fem.mesh import FAMILIES
from study.ledger.codes import MADE, Codes
from study.ledger.controls import missed as missed_faults
from study.ledger.datafiles import DataError, by_claim, count_verdicts
from study.ledger.files import Json, write_text
from study.ledger.schema import SCHEMA
from study.ledger.schema import markdown as described
from study.ledger.text import cell
from study.ledger.verdict import (
    FAILS,
    HOLDS,
    MISSED,
    NO_ROW,
    NOT_TESTED,
    REPORTED,
    UNDECIDED,
    CheckKind,
)
from study.present.article import contact_codes, slips, texts
from study.present.drawing import caption_text, in_style
from study.present.figures import drawings
from study.present.picture import read_picture
from study.present.show import write_gif
from study.present.templates import ENVIRONMENT, MISPRINTS, FullRun, context, read_page, render, typeset

BY_TABLES = "study tables --out {}"
BY_FIGURES = "study figures --out {}"
BY_PAGES = "make pages"
"""The commands that write tables and inputs of the papers, figures with captions, and the README with its badges."""
README_FILM = "hexagon"
README_DPI = 66
README_COLOURS = 32
"""The case that the animation at the top of the README shows, its dots per inch, and the number of its colours."""
TEXTS = read_page("results")
"""Texts about the results, which are templates."""
CLAIMED = (FAILS, UNDECIDED, HOLDS)
"""Verdicts on claims, from worst to best."""
END = "<!-- end -->"
REPOSITORY = Path(__file__).parents[2]


def main() -> None:
    """Write tables, badges and the animation: ``python -m study.present.pages RESULTS PAGE …``."""
    directory, *pages = map(Path, sys.argv[1:])
    data = FullRun.read(directory)
    if data is None:
        raise DataError(f"{directory} has no full run: `make full`, `study faults` and `make seeds` make it")
    # Every second time is enough, and keeps the file below 120 kB.
    picture = read_picture(directory, README_FILM).at_every(2)
    with in_style():
        write_gif(directory / "figures" / f"{README_FILM}.gif", picture, lambda: None, README_DPI, README_COLOURS)
    for name, svg in badges(data, Path("pyproject.toml")).items():
        write_text(directory / "badges" / name, svg)
    for page in pages:
        print(f"{page}: {'changed' if refresh(page, data) else 'up to date'}")


def refresh(page: Path, data: FullRun) -> bool:
    """Write a page with the text of ``refreshed``, whose tables are made again; return whether the page changed.

    Raises:
        DataError: the page has no marks between which a table could be written.
    """
    before = page.read_text(encoding="utf-8")
    text = refreshed(page, data)
    write_text(page, text)
    return text != before


def refreshed(page: Path, data: FullRun) -> str:
    """Return the text of a page with its tables, between ``<!-- NAME -->`` and ``<!-- end -->``, made from the data.

    Raises:
        DataError: the page has no mark ``<!-- end -->``.
    """
    text = page.read_text(encoding="utf-8")
    for name, table in TABLES.items():
        if f"<!-- {name} -->" in text:
            text = put(text, name, table(data))
    if END not in text:
        raise DataError(
            f"{page} has no place for a table: a line <!-- NAME -->, then a line {END}, where NAME is the name of a "
            "table: short, results, statements, codes or another entry of study.present.pages.TABLES"
        )
    return text


def expected_texts(directory: Path) -> dict[Path, tuple[str, str]]:
    """Return the expected texts of all files that follow from the data of a run, and the commands that write the files.

    These files are tables, LaTeX files for the papers and captions of figures; for a full run also the badges and the
    README of the repository to which the run belongs. Files that do not exist are left out.

    Raises:
        DataError: a data file is missing or damaged.
    """
    expected = {path: (text, BY_TABLES) for path, text in texts(directory).items()}
    for drawing in drawings(directory):
        expected[directory / "figures" / f"{drawing.name}.txt"] = caption_text(drawing), BY_FIGURES
    data = FullRun.read(directory)
    root = directory.resolve().parent
    if data and (root / "pyproject.toml").is_file():
        for name, badge in badges(data, root / "pyproject.toml").items():
            expected[directory / "badges" / name] = badge, BY_PAGES
        readme = root / "README.md"
        if readme.is_file():
            expected[readme] = refreshed(readme, data), BY_PAGES
    return {path: (text, made_by.format(directory)) for path, (text, made_by) in expected.items() if path.is_file()}


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


def sentences(data: FullRun) -> Callable[[str], str]:
    """Return a function that takes the text of a template and fills in the numbers of a full run.

    Templates use the names of ``context``; ``verdicts_in_words`` and ``misprints``; the predicted and observed orders
    of Proposition 5.3 (``predicted``, ``difference``, ``steps``); and the observed orders of the stresses of Theorem
    4.2 on their own space, for the cases of Proposition 5.4 (``own_smooth``) and for the others (``own_others``).
    """
    of_rough = data.checks("Prop. 5.3", "order")
    own = data.checks("Thm 4.2, own space", "order-stress")
    predicted = of_rough.case.map(data.cases.expected_order)
    is_smooth = own.case.isin(data.rates.loc[data.rates.claim == "Prop. 5.4", "case"])
    values = dict(
        context(data),
        verdicts_in_words=verdicts_in_words,
        misprints=slips(data),
        predicted=predicted,
        difference=(of_rough.observed - predicted).abs().max(),
        steps=data.rates.loc[data.rates.claim == "Prop. 5.3", "order"].dropna(),
        own_smooth=own[is_smooth],
        own_others=own[~is_smooth],
    )
    return lambda template: ENVIRONMENT.from_string(template).render(values)


def short(data: FullRun) -> str:
    """Return the main results of the study in a few lines, in Markdown.

    They have the links [problem], [faults], [results], [misprints] and [bounds]; each page with these lines must define
    the targets.
    """
    fill = sentences(data)
    return "".join(f"- **{lead}.** {_literal(fill(text))}\n" for lead, text in TEXTS["short"].items())


def results(data: FullRun) -> str:
    """Return the table of results in Markdown: claims, predictions, observations rounded outwards, and verdicts."""
    fill = sentences(data)
    lines = []
    for line in TEXTS["lines"].values():
        verdict = fill(line["verdict"]) if "verdict" in line else _verdict(data.claims, line)
        lines.append([fill(line["claim"]), fill(line["predicted"]), fill(line["observed"]), verdict])
    return _table(["claim", "predicted", "observed", "verdict"], lines)


def _verdict(claims: DataFrame, line: Json) -> str:
    """Return the worst verdict on a statement, and how many of its checks have each verdict.

    Then follows how many of them can only fail if the program is wrong.

    Parameters:
        claims: all checks.
        line: the line of the table, with the ``label`` of the statement; possibly ``keys``, those of the checks that
            test the statement directly, and ``noun``, what these checks are called. With keys, the numbers for all
            further checks follow; without, all checks are counted together.
    """
    rows = tests = claims[claims.label == line["label"]]
    further = ""
    if "keys" in line:
        is_test = rows.key.isin(line["keys"])
        tests = rows[is_test]
        further = verdicts_in_words(rows[~is_test], "further checks of the same computations")
    count = count_verdicts(tests)
    return ENVIRONMENT.from_string(TEXTS["verdict"]).render(
        worst=next((verdict for verdict in CLAIMED if count[verdict]), REPORTED),
        tested=verdicts_in_words(tests, line.get("noun", "checks")),
        total=sum(count[verdict] for verdict in CLAIMED),
        safe=((tests.verdict == HOLDS) & (tests.kind == CheckKind.IDENTITY)).sum(),
        further=further,
    )


def verdicts_in_words(rows: DataFrame, noun: str) -> str:
    """Return "all 44 checks hold" or the number of checks for each verdict, then the number of missed predictions.

    ``noun`` is what the checks are called, in the plural.
    """
    count = count_verdicts(rows)
    total = sum(count[verdict] for verdict in CLAIMED)
    return ENVIRONMENT.from_string(TEXTS["counts"]).render(count=count, total=total, noun=noun)


def misprints(data: FullRun) -> str:
    """Return the misprints in the paper, in Markdown: place, printed text, corrected text."""
    return _table(["place", "printed", "read"], slips(data))


def missed(data: FullRun) -> str:
    """Return the predictions of this study that were wrong, and what was learned from them, in Markdown.

    Raises:
        DataError: ``page/results.toml`` has no lesson for a wrong prediction.
    """
    lines = []
    for row in data.claims[data.claims.verdict == MISSED].itertuples():
        lessons = TEXTS["learned"].get(row.label, {})
        lesson = next((lesson for key, lesson in lessons.items() if key in row.key), None)
        if lesson is None:
            raise DataError(
                f"the prediction of {row.label}, {row.key} for {row.case} was missed: say in "
                "study/present/page/results.toml, [learned], what was learned"
            )
        predicted = row.expected.removeprefix("predicted ").partition(" (wrong)")[0]
        lines.append([row.label, row.case, row.quantity, predicted, cell(row.observed), lesson])
    return _table(["statement", "case", "quantity", "predicted", "observed", "what was learned"], lines)


# Lists: statements, numbered formulas, other codes.


def statements(data: FullRun) -> str:
    """Return all claims in Markdown: verdicts, cases, the command that measures them, tables, figures and data."""
    lines = []
    shown = TEXTS["shown"]
    for label, claim, rows in by_claim(data.claims[~data.claims.label.isin((MISPRINTS, NOT_TESTED, NO_ROW))]):
        where = data.provenance["statements"][label]
        code = next((path for path in where["code"] if (REPOSITORY / path).is_file()), "study/run/provenance.py")
        cases = rows.case.unique()
        more = f" and {len(cases) - 1} more" if len(cases) > 1 else ""
        command = TEXTS["commands"].get(label, "make study").format(cases[0])
        places = [shown[name] for name in (label, *where["data"]) if name in shown] or [shown["ledger"]]
        files = ", ".join(f"`{name}`" for name in where["data"])
        lines.append(
            [
                f"[{_literal(label)}](../../{code}): {_literal(claim)}",
                _verdicts(rows),
                f"{cases[0]}{more}",
                f"`{command}`",
                f"{'; '.join(places)}; {files}",
            ]
        )
    return markdown(["claim, with its code", "checks", "cases", "command", "tables and figures; data"], lines)


def _verdicts(rows: DataFrame) -> str:
    """Return the number of checks with each verdict, as in "3 holds, 1 undecided"."""
    return ", ".join(f"{count} {name}" for name, count in count_verdicts(rows).items() if count)


def mesh_families(data: FullRun) -> str:
    """Return the table of mesh families: name, meshes, and the least angle in the plane."""
    rows = [[f"*{family.name}*", family.meshes, f"{family.least_angle:g}°"] for family in FAMILIES]
    return markdown(["mesh family", "meshes", "all angles in the plane are larger than"], rows)


def codes_table(results: Codes | None) -> str:
    """Return a table of other people's contact codes in Markdown, with a line for each code and its parameters.

    A line says how the errors behave on finer meshes (the class, and the number of series of meshes with this class),
    and has the worst values.

    Raises:
        DataError: the results are missing.
    """
    if results is None:
        raise DataError(f"results of other codes are missing: make them with `{MADE}`")
    header = ["code", "parameters", "class (series of meshes)", "order in V", "distance / error"]
    return markdown([*header, "pressure error ratio", "effect of scaling"], contact_codes(results))


def _table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown, whose cells are plain texts."""
    return markdown(header, [[_literal(text) for text in row] for row in rows])


def _literal(text: str) -> str:
    """Return a plain text as Markdown, with superscripts and subscripts in HTML and with ``*`` and ``_`` escaped."""
    return re.sub(r"([*_])", r"\\\1", typeset(text))


# Badges


def badges(data: FullRun, project: Path) -> dict[str, str]:
    """Return file name ↦ SVG text of the badges: the verdicts, the noticed faults, the Python version and the licence.

    A badge is a small picture at the top of the README with a name and a text on a colour. Its width follows from the
    number of letters.

    Parameters:
        data: the contents of the data files.
        project: the path of ``pyproject.toml``, which states the Python version and the licence.
    """
    stated = tomllib.loads(project.read_text(encoding="utf-8"))["project"]
    count = count_verdicts(data.claims)
    injected = data.faults.fault.nunique()
    noticed = injected - len(missed_faults(data.faults))
    ledger = VERMILLION if count[FAILS] else ORANGE if count[UNDECIDED] else GREEN
    rows = f"{count[HOLDS]} rows hold, {count[UNDECIDED]} undecided, {count[FAILS]} fail"
    defects = GREEN if noticed == injected else VERMILLION
    shown = {
        "ledger.svg": ("ledger", rows, ledger),
        "defects.svg": ("deliberate faults", f"{noticed} of {injected} noticed", defects),
        "python.svg": ("Python", stated["requires-python"].replace(">=", "≥ "), BLUE),
        "licence.svg": ("licence", stated["license"], BLUE),
    }
    return {
        file: render("badge.svg", name=name, says=says, colour=colour, dark=DARK) + "\n"
        for file, (name, says, colour) in shown.items()
    }


def columns(data: FullRun) -> str:
    """Return the columns of all data files in Markdown."""
    return "\n".join(line for name in SCHEMA for line in described(name))


# The names of these functions are the names of places on pages.
NAMED = short, results, misprints, missed, statements, mesh_families, columns
TABLES: dict[str, Callable[[FullRun], str]] = {table.__name__: table for table in NAMED} | {
    "codes": lambda data: codes_table(data.codes),
    "marches": lambda data: codes_table(data.marches),
}
"""Name of a place on a page ↦ the function that returns its table or text. ``marches`` are the runs in which other
people's codes solve in time by the midpoint rule."""

if __name__ == "__main__":
    main()
