"""The tables and badges of README and documentation that come from the data.

python -m study.present.pages results README.md docs/explanation/results.md …
"""

from __future__ import annotations

import json
import math
import re
import sys
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from xml.sax.saxutils import escape

import pandas as pd

from study.ledger.chance import PROMISE
from study.ledger.codes import MADE, Codes
from study.ledger.datafiles import DataError, alarm_summary, by_claim, count_caught, count_verdicts
from study.ledger.files import write_text
from study.ledger.numbered import NO_ROW, NOT_TESTED, NUMBERED, named
from study.ledger.text import above, below, up
from study.ledger.verdict import FAILS, HOLDS, REPORTED, UNDECIDED
from study.ledger.window import STEEPER
from study.present.article import two_digits_up
from study.present.drawing import in_style
from study.present.full_run import FullRun
from study.present.marks import END, markdown, put
from study.present.notation import counted, typeset
from study.present.palette import BLUE, DARK, GREEN, ORANGE, VERMILLION
from study.present.picture import with_every_shape
from study.present.show import write_gif
from study.present.windows import Change, added, changes

FILM, FILM_DPI = "hexagon", 75
"""The case on the first screen of the README, and dots per inch of its film."""
ORDERS, CONVERGENCE = ("order", "order-extrapolated", "order-finest"), ("falling", "limit", "order", "order-graded")
"""Keys of the rows that test a proposition itself; the other rows check the discrete solution."""


def main() -> None:
    """Writes tables, badges and the film of the first screen: ``python -m study.present.pages RESULTS PAGE …``."""
    directory, *pages = map(Path, sys.argv[1:])
    data = FullRun.read(directory)
    if data is None:
        raise DataError(f"{directory} is not that of a full run: `make full`, `make controls` and `make seeds` make it")
    film, picture = directory / "figures" / f"{FILM}.gif", directory / "data" / "pictures" / f"{FILM}.json"
    with in_style():
        write_gif(film, with_every_shape(json.loads(picture.read_text(encoding="utf-8"))), lambda: None, FILM_DPI)
    write_badges(directory / "badges", data, Path("pyproject.toml"))
    for page in pages:
        print(f"{page}: {'changed' if refresh(page, data) else 'up to date'}")


def refresh(page: Path, data: FullRun) -> bool:
    """Writes the tables of a page again; returns whether the page changed.

    Raises:
        DataError: the page has no marks.
    """
    before = page.read_text(encoding="utf-8")
    text = refreshed(page, data)
    write_text(page, text)
    return text != before


def refreshed(page: Path, data: FullRun) -> str:
    """Returns the text of a page with its tables, between ``<!-- NAME -->`` and ``<!-- end -->``, from the data.

    Raises:
        DataError: the page has no marks.
    """
    text = page.read_text(encoding="utf-8")
    for table in (headline, results, statements, formulas, cases, codes, marches, windows, new_windows):
        if f"<!-- {table.__name__} -->" in text:
            text = put(text, table.__name__, table(data))
    if END not in text:
        raise DataError(f"{page} has no <!-- NAME --> … {END} with NAME headline, results, statements, cases, codes, …")
    return text


# Results: claim, prediction, observation, verdict


def headline(data: FullRun) -> str:
    """Returns claims, observations and links to the code behind them, in Markdown; DataError if rows are missing."""
    told = {
        "statements/prop_5_4.py": _prop_5_4,
        "statements/prop_5_3.py": _prop_5_3,
        "statements/thm_4_2_own_space.py": _own_space,
        "statements/enclosure.py": _bound,
        "controls/alarms.py": _seeds,
    }
    lines = []
    for path, row in told.items():
        claim, _, seen, verdict = row(data)
        lines.append([claim, seen, f"[{verdict}](study/{path})"])
    return markdown(["claim", "observed", "how"], lines)


def results(data: FullRun) -> str:
    """Returns claims, predictions, observations rounded outwards, and verdicts, in Markdown; DataError as above."""
    beyond = _regularity, _work, _rollers, _time
    rows = (_prop_5_4, _prop_5_3, _same_mesh, _own_space, _bound, *beyond, _defects, _seeds)
    lines = [[_literal(cell) for cell in row(data)] for row in rows]
    return markdown(["claim", "predicted", "observed", "verdict"], lines)


def _prop_5_4(data: FullRun) -> list[str]:
    extrapolated = data.rows("Prop. 5.4", "order-extrapolated")
    return [
        f"Proposition 5.4: errors consistent with O(h) on these meshes, in "
        f"{counted(extrapolated['case'].nunique(), 'case')}",
        "order 1",
        f"orders extrapolated to h → 0 {_range(extrapolated)}, level by level "
        + _range(data.rows("Prop. 5.4", "order")),
        _weighed(data, "Prop. 5.4", ORDERS),
    ]


def _prop_5_3(data: FullRun) -> list[str]:
    seen = data.rows("Prop. 5.3", "order")
    expected = data.cases.loc[seen["case"], "expected_order"]
    limit, steeper = (above(100 * data.rows("Prop. 5.3", key)["high"].max(), 0) for key in ("limit", "limit-steeper"))
    return [
        f"Proposition 5.3: errors consistent with convergence to solutions that are not smooth, in "
        f"{counted(seen['case'].nunique(), 'case')}",
        f"error → 0; orders {expected.min():.3g} … {expected.max():.3g} by regularity",
        f"a positive limit is at most {limit} % of the errors on the two finest meshes if the order is the predicted "
        f"one, {steeper} % if it is larger by {STEEPER:g}; orders {_range(seen)}",
        _weighed(data, "Prop. 5.3", CONVERGENCE),
    ]


def _same_mesh(data: FullRun) -> list[str]:
    allowed, seen = (f"{two_digits_up(data.equivalence[name].max()):.2g}" for name in ("stress_bound", "stress_gap"))
    return [
        "Theorem 4.2: displacements and stresses solve the same problem (same mesh, two solvers)",
        f"equal up to what the solver leaves open, at most {allowed} by its duality gap",
        f"stresses differ by at most {seen}",
        _verdict(data, "Thm 4.2"),
    ]


def _own_space(data: FullRun) -> list[str]:
    label = "Thm 4.2, own space"
    found = data.rows(label, "order-stress")
    regular = found["case"].map(data.cases["proved_order"]) == 1
    seen, others = found[regular], found[~regular]
    number = counted(seen["case"].nunique(), "case")
    rest = f"; {_range(others)} in {others['case'].nunique()} that is less regular" if len(others) else ""
    return [
        f"Theorem 4.2, by stresses that know no displacement: they converge to σ, in {number}",
        "at least 3/2, by regularity, at most 2",
        f"orders {_range(seen)}{rest}",
        _verdict(data, label, set(seen["case"])),
    ]


def _bound(data: FullRun) -> list[str]:
    return [
        "beyond the paper: a computable bound of the error, without the exact solution",
        "error / bound ≤ 1",
        f"error / bound at most {above(data.rows('bound', 'above')['high'].max(), 3)}",
        _verdict(data, "bound"),
    ]


def _regularity(data: FullRun) -> list[str]:
    seen, orders = data.rows("(5.36)", "order"), data.cases
    missing = seen[seen["case"].map(orders["expected_order"]) == 1]
    proved = orders.loc[missing["case"], "proved_order"]
    return [
        "beyond the paper: is the smoothness (5.36) that the proof of order 1 assumes needed?",
        f"that of the trace is not: proved in the plane; without that of u̇ order {proved.min():.3g} is proved",
        f"orders {_range(missing)} in {counted(len(missing), 'case')} that miss one of them",
        REPORTED,
    ]


def _work(data: FullRun) -> list[str]:
    label = "beyond: work of contact"
    seen = data.rows(label, "order")
    return [
        "beyond the paper: contact at every scale, with a trace that has no bound: the root of the work of contact",
        "order 1, on grids, where it can be seen",
        f"orders {_range(seen)} in {counted(seen['case'].nunique(), 'case')}",
        _verdict(data, label),
    ]


def _rollers(data: FullRun) -> list[str]:
    label = "beyond: rollers"
    equal, alternating, shaken = (
        _range(data.rows(label, f"order-{family}", "roller")) for family in ("equal", "alternating", "shaken")
    )
    return [
        "beyond the paper: without a smooth velocity, what contact costs where a narrow patch rolls along the floor",
        "proved: order ½ or more, less a logarithm; 1 where all vertices have equal neighbourhoods, ½ where not",
        f"orders {equal} with one or two diagonals, {alternating} with alternating ones, {shaken} of the mean over "
        "shaken meshes",
        _verdict(data, label),
    ]


def _time(data: FullRun) -> list[str]:
    label = "beyond: O(h + k)"
    share = above(data.rows(label, "data")["high"].max(), 2)
    return [
        "beyond the paper: O(h + k) for backward Euler, no condition between h and k",
        "proved: the error in time is at most k (‖u̇^h(0+)‖/√2 + 2 Var f) on every mesh",
        f"error / bound at most {share}; orders in k {_range(data.rows(label, 'order'))}",
        _verdict(data, label),
    ]


def _defects(data: FullRun) -> list[str]:
    found, injected = count_caught(data.controls)
    verdict = HOLDS if found == injected else FAILS
    claim = "deliberate defects, injected one at a time"
    return [claim, "each is caught by a row", f"{found} of {injected}", verdict]


def _seeds(data: FullRun) -> list[str]:
    found = alarm_summary(data.seeds)
    tails = f"by the tails of all rows at most {found.by_tail:.2%}"
    return [
        f"false alarms by chance: all {found.rows} rows that are claimed on random meshes, on those of {found.seeds} "
        "seeds drawn afresh",
        f"at most {PROMISE:.0%} of seeds turn the ledger red",
        f"on {found.red} of them a row failed: {found.low:.1%} … {found.high:.1%} of all seeds, at 95%; "
        f"{'too few for the tails of all rows' if math.isnan(found.by_tail) else tails}; a row that costs little "
        f"failed on {found.light_red} of {found.light_seeds}",
        found.verdict,
    ]


def _verdict(data: FullRun, label: str, among: set[str] | None = None) -> str:
    """Returns how many rows of a statement have each verdict, of all cases or of some."""
    rows = data.claims[data.claims["label"] == label]
    return _row_counts(rows if among is None else rows[rows["case"].isin(among)])


def _weighed(data: FullRun, label: str, keys: tuple[str, ...]) -> str:
    """Returns how many rows that test a claim have each verdict, and how many other rows."""
    rows = data.claims[data.claims["label"] == label]
    tests = rows["key"].isin(keys)
    return f"{_row_counts(rows[tests])}; beside them, on what was solved, {_row_counts(rows[~tests])}"


def _row_counts(rows: pd.DataFrame) -> str:
    counts = count_verdicts(rows)
    return ", ".join(
        f"{name} ({counted(count, 'row')})" for name, count in counts.items() if count and name != REPORTED
    )


def _range(rows: pd.DataFrame) -> str:
    """Returns the least and the largest value, rounded outwards."""
    return _outwards(rows["low"].min(), rows["high"].max())


def _outwards(low: float, high: float) -> str:
    return f"{below(low, 2)} … {above(high, 2)}"


# Lists: statements, numbered formulas, other codes, changed windows


def statements(data: FullRun) -> str:
    """Returns every statement with its verdicts, the file of the code that judges it and its data, in Markdown."""
    lines = []
    for label, claim, rows in by_claim(data.claims):
        where = data.provenance["statements"].get(label, {"code": [], "data": ["provenance.json"]})
        code = ", ".join(f"[`{path}`](../../{path})" for path in where["code"])
        files = ", ".join(f"`{name}`" for name in where["data"])
        lines.append([_literal(label), _literal(claim), _verdicts(rows), f"{code}: {files}"])
    return markdown(["statement", "says", "verdicts", "code: data"], lines)


def _verdicts(rows: pd.DataFrame) -> str:
    return ", ".join(f"{count} {name}" for name, count in count_verdicts(rows).items() if count)


def formulas(data: FullRun) -> str:
    """Returns every numbered formula and statement of the source with its rows or why it has none, in Markdown."""
    lines = [[numbers, _literal(says), _literal(rows)] for numbers, says, rows in numbered_lines(data.claims)]
    return markdown(["number", "says", "rows, or why there are none"], lines)


def numbered_lines(claims: pd.DataFrame) -> Iterator[tuple[str, str, str]]:
    """Yields numbers, what they say, and rows or reason, in the order of the source; equal neighbours share a line.

    Raises:
        DataError: a number has neither rows nor a reason.
    """
    found = numbered_entries(claims)
    if lacking := [number for number in NUMBERED if not found[number]]:
        raise DataError(f"claims.csv has neither rows nor a reason for {', '.join(lacking)}: judge again, or say why")
    for entries, group in groupby(NUMBERED, found.__getitem__):
        numbers = list(group)
        says, rows = ("; ".join(dict.fromkeys(parts)) for parts in zip(*entries, strict=True))
        yield numbers[0] if len(numbers) == 1 else f"{numbers[0]}–{numbers[-1]}", says, rows


def numbered_entries(claims: pd.DataFrame) -> dict[str, list[tuple[str, str]]]:
    """Returns number ↦ (what it says, its rows or the reason) of each statement of the ledger that names the number."""
    found: dict[str, list[tuple[str, str]]] = {number: [] for number in NUMBERED}
    without = claims["label"].isin((NO_ROW, NOT_TESTED))
    entries = [
        (named(label), claim, f"{label}: {_verdicts(rows)}")
        for label, claim, rows in by_claim(claims[~without & (claims["label"] != "slips")])
    ]
    for row in claims[without].to_dict("records"):
        entries.append((named(str(row["case"])), str(row["quantity"]), str(row["expected"])))
    for numbers, says, rows in entries:
        for number in numbers & found.keys():
            found[number].append((says, rows))
    return found


def cases(data: FullRun) -> str:
    """Returns the number of cases, for a sentence."""
    return str(len(data.cases))


def codes(data: FullRun) -> str:
    """Returns other people's contact codes with their parameters: classes and the worst of each, in Markdown."""
    return _codes_table(data.codes)


def marches(data: FullRun) -> str:
    """Returns the same table for codes that went through time by the midpoint rule."""
    return _codes_table(data.marches)


def _codes_table(found: Codes | None) -> str:
    if found is None:
        raise DataError(f"results of other codes are missing: make them with `{MADE}`")
    lines = [
        [
            f"{row['code']} {row['version']}",
            str(row["variant"]),
            str(row["classes"]),
            _outwards(row["order_low"], row["order_high"]),
            up(row["share"], 2),
            up(row["excess"], 3),
            up(row["invariance"], 2),
        ]
        for row in found.rows().to_dict("records")
    ]
    header = ["code", "parameters", "class (series of meshes)", "order in V", "distance / error"]
    return markdown([*header, _literal("pressure / that of K^h"), "scales"], lines)


def windows(data: FullRun) -> str:
    """Returns the windows that changed, in Markdown; DataError if a window changed without a stated reason."""
    alike: dict[tuple[str, str, str], list[str]] = {}
    for change in changes(_earlier(data), data.claims):
        alike.setdefault((change.before, change.today, change.why), []).append(_changed(change))
    lines = [[", ".join(rows), *map(_literal, texts)] for texts, rows in alike.items()]
    return markdown(["rows", "then", "today", "why"], lines)


def new_windows(data: FullRun) -> str:
    """Returns rows that are claimed today and were not known then, in Markdown."""
    lines = [[_changed(one), _literal(one.today), _literal(one.why)] for one in added(_earlier(data), data.claims)]
    return markdown(["rows", "window", "why"], lines)


def _changed(change: Change) -> str:
    return f"{_literal(change.label)} *{change.key}* ({change.rows})"


def _earlier(data: FullRun) -> pd.DataFrame:
    if data.earlier is None:
        raise DataError("results/history/windows.csv is missing: it is part of the repository")
    return data.earlier


def _literal(text: str) -> str:
    """Returns a text with its scripts raised and lowered, and nothing in it that Markdown takes for emphasis."""
    return re.sub(r"([*_])", r"\\\1", typeset(text))


# Badges


@dataclass(frozen=True)
class Badge:
    """A small picture above the README: a name, what is said of it, and the colour behind the text."""

    name: str
    says: str
    colour: str

    def svg(self) -> str:
        """Returns the badge as a picture; letters are fitted into the width that they have on average."""
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
    """Returns file name ↦ badge: verdicts of the ledger, caught defects, and what ``pyproject.toml`` states."""
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
    """Writes all badges into a directory; returns their files."""
    return [write_text(directory / name, badge.svg()) for name, badge in badges(data, project).items()]


if __name__ == "__main__":
    main()
