"""The tables of the README and of the documentation that come from the data.

python -m study.present.pages results README.md docs/explanation/results.md …
"""

from __future__ import annotations

import json
import math
import re
import sys
from pathlib import Path

import pandas as pd

from study.ledger.chance import PROMISE
from study.ledger.codes import MADE, Codes
from study.ledger.datafiles import DataError, by_claim, caught, count_verdicts, raised
from study.ledger.files import write_text
from study.ledger.rounding import above, below, up
from study.ledger.verdict import REPORTED
from study.ledger.window import STEEPER
from study.present.article.source import FullRun
from study.present.badges import write_badges
from study.present.figures.drawing import in_style
from study.present.formulas import lines as of_formulas
from study.present.marks import END, markdown, put
from study.present.picture.picture import with_every_shape
from study.present.report.svg_chart import typeset
from study.present.show.animation import write_gif
from study.present.windows import Change, added, changes


def headline(data: FullRun) -> str:
    """What is claimed and seen, and the code that says how, in Markdown; DataError if rows lack."""
    told = {
        "statements/prop_5_4/": _prop_5_4,
        "statements/prop_5_3.py": _prop_5_3,
        "statements/thm_4_2/": _own_space,
        "statements/enclosure/": _bound,
        "controls/alarms.py": _seeds,
    }
    rows = [(path, row(data)) for path, row in told.items()]
    return markdown(
        ["claim", "observed", "how"],
        [[claim, seen, f"[{verdict}](study/{path})"] for path, (claim, _, seen, verdict) in rows],
    )


def results(data: FullRun) -> str:
    """What is claimed, predicted and seen, rounded outwards, and the verdict, in Markdown; DataError if rows lack."""
    beyond = _regularity, _work, _rollers, _time
    rows = (_prop_5_4, _prop_5_3, _same_mesh, _own_space, _bound, *beyond, _defects, _seeds)
    lines = [[_literal(cell) for cell in row(data)] for row in rows]
    return markdown(["claim", "predicted", "observed", "verdict"], lines)


def _prop_5_4(data: FullRun) -> list[str]:
    fitted = data.rows("Prop. 5.4", "order-fitted")
    return [
        f"Proposition 5.4: errors consistent with O(h) on these meshes, in {fitted['case'].nunique()} cases",
        "order 1",
        # The ends of a fit are those of its interval, in which its value is judged.
        f"fitted orders {_outwards(fitted['observed'].min(), fitted['observed'].max())}, level by level "
        + _range(data.rows("Prop. 5.4", "order")),
        _weighed(data, "Prop. 5.4", ORDERS),
    ]


def _prop_5_3(data: FullRun) -> list[str]:
    seen = data.rows("Prop. 5.3", "order")
    expected = data.cases.loc[seen["case"], "expected_order"]
    limit, steeper = (above(100 * data.rows("Prop. 5.3", key)["high"].max(), 0) for key in ("limit", "limit-steeper"))
    return [
        f"Proposition 5.3: errors consistent with convergence to solutions that are not smooth, in "
        f"{seen['case'].nunique()} cases",
        f"error → 0; orders {expected.min():.3g} … {expected.max():.3g} by regularity",
        f"a positive limit is at most {limit} % of the errors on the two finest meshes if the order is the predicted "
        f"one, {steeper} % if it is larger by {STEEPER:g}; orders {_range(seen)}",
        _weighed(data, "Prop. 5.3", CONVERGENCE),
    ]


def _same_mesh(data: FullRun) -> list[str]:
    # Powers of ten, rounded up when they were measured: rounding up once more would give 1.1e-05 for 1e-5.
    allowed, seen = (f"{data.equivalence[name].max():g}" for name in ("stress_bound", "stress_gap"))
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
    rest = f"; {_range(others)} in {others['case'].nunique()} that is less regular" if len(others) else ""
    return [
        f"Theorem 4.2, by stresses that know no displacement: they converge to σ, in {seen['case'].nunique()} cases",
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
        f"orders {_range(missing)} in {len(missing)} cases that miss one of them",
        REPORTED,
    ]


def _work(data: FullRun) -> list[str]:
    label = "beyond: work of contact"
    seen = data.rows(label, "order")
    return [
        "beyond the paper: contact at every scale, with a trace that has no bound: the root of the work of contact",
        "order 1, on grids, where it can be seen",
        f"orders {_range(seen)} in {seen['case'].nunique()} cases",
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
        "proved: the error in time is at most k (‖u̇^h(0+)‖/√2 + 3 Var f) on every mesh",
        f"error / bound at most {share}; orders in k {_range(data.rows(label, 'order'))}",
        _verdict(data, label),
    ]


def _defects(data: FullRun) -> list[str]:
    found, injected = caught(data.controls)
    verdict = "holds" if found == injected else "fails"
    claim = "deliberate defects, injected one at a time"
    return [claim, "each is caught by a row", f"{found} of {injected}", verdict]


def _seeds(data: FullRun) -> list[str]:
    found = raised(data.seeds)
    return [
        f"false alarms by chance: all {found.rows} rows that are claimed on random meshes, on those of {found.seeds} "
        "seeds drawn afresh",
        f"at most {PROMISE:.0%} of seeds turn the ledger red",
        f"on {found.red} of them a row failed: {found.low:.1%} … {found.high:.1%} of all seeds, at 95%; "
        f"{_tails(found.by_tail)}; a row that costs little failed on {found.light_red} of {found.light_seeds}",
        found.verdict,
    ]


def _tails(rate: float) -> str:
    """What the tails of all rows together let one expect, if they are known."""
    return "too few for the tails of all rows" if math.isnan(rate) else f"by the tails of all rows at most {rate:.2%}"


def _verdict(data: FullRun, label: str, among: set[str] | None = None) -> str:
    """How many rows of a statement have each verdict, of all cases or of some."""
    mine = data.claims[data.claims["label"] == label]
    return _counted(mine if among is None else mine[mine["case"].isin(among)])


ORDERS, CONVERGENCE = ("order", "order-fitted", "order-finest"), ("falling", "limit", "order", "order-graded")
"""Keys of the rows that bear on what a proposition claims; the others show that they are about what was solved."""


def _weighed(data: FullRun, label: str, keys: tuple[str, ...]) -> str:
    """How many rows that bear on a claim have each verdict, and how many beside them."""
    mine = data.claims[data.claims["label"] == label]
    bears = mine["key"].isin(keys)
    about, beside = (_counted(rows) for rows in (mine[bears], mine[~bears]))
    return f"{about}; beside them, on what was solved, {beside}"


def _counted(rows: pd.DataFrame) -> str:
    counts = count_verdicts(rows)
    return ", ".join(f"{name} ({count} rows)" for name, count in counts.items() if count and name != REPORTED)


def _range(rows: pd.DataFrame) -> str:
    """From the least to the largest value, rounded outwards."""
    return _outwards(rows["low"].min(), rows["high"].max())


def _outwards(low: float, high: float) -> str:
    return f"{below(low, 2)} … {above(high, 2)}"


def refresh(page: Path, data: FullRun) -> bool:
    """Writes the tables of a page again (``refreshed``); returns whether the page changed.

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
    tables = headline, results, statements, formulas, cases, codes, marches, windows, new_windows
    for table in tables:
        if f"<!-- {table.__name__} -->" in text:
            text = put(text, table.__name__, table(data))
    if END not in text:
        raise DataError(f"{page} has no <!-- NAME --> … {END} with NAME headline, results, statements, cases, codes, …")
    return text


FILM, SMALL = "hexagon", 75
"""The case on the first screen, and dots per inch of its film."""


def statements(data: FullRun) -> str:
    """Every statement with its verdicts, the file of the code that judges it and its data, in Markdown."""
    lines = []
    for label, claim, rows in by_claim(data.claims):
        counts = ", ".join(f"{count} {name}" for name, count in count_verdicts(rows).items() if count)
        where = data.provenance["statements"].get(label, {"code": [], "data": ["provenance.json"]})
        code = ", ".join(
            f"[`{path}`](../../{path}{'__init__.py' if path.endswith('/') else ''})" for path in where["code"]
        )
        found = ", ".join(f"`{name}`" for name in where["data"])
        lines.append([_literal(label), _literal(claim), counts, f"{code}: {found}"])
    return markdown(["statement", "says", "verdicts", "code: data"], lines)


def formulas(data: FullRun) -> str:
    """Every numbered formula and statement of the source with its rows, or why it has none, in Markdown."""
    found = [[numbers, _literal(says), _literal(made)] for numbers, says, made in of_formulas(data.claims)]
    return markdown(["number", "says", "rows, or why there are none"], found)


def cases(data: FullRun) -> str:
    """How many cases there are, to stand in a sentence."""
    return str(len(data.cases))


def codes(data: FullRun) -> str:
    """Other people's contact codes with their parameters: classes and the worst of each, in Markdown."""
    return _judged(data.codes)


def marches(data: FullRun) -> str:
    """The same of those that went through time by the midpoint rule."""
    return _judged(data.marches)


def _judged(found: Codes | None) -> str:
    if found is None:
        raise DataError(f"results of other codes are missing: make them with `{MADE}`")
    header = ["code", "parameters", "class (series of meshes)", "order in V", "distance / error"]
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
    return markdown([*header, _literal("pressure / that of K^h"), "scales"], lines)


def windows(data: FullRun) -> str:
    """The windows that are not what they were, in Markdown; DataError if one changed for no reason that is stated."""
    found = changes(_earlier(data), data.claims)
    alike: dict[tuple[str, str, str], list[Change]] = {}
    for change in found:
        alike.setdefault((change.before, change.today, change.why), []).append(change)
    return markdown(
        ["rows", "then", "today", "why"],
        [
            [", ".join(map(_rows, group)), *map(_literal, (before, today, why))]
            for (before, today, why), group in alike.items()
        ],
    )


def new_windows(data: FullRun) -> str:
    """Rows that are claimed today and were not known then, in Markdown."""
    lines = [[_rows(one), _literal(one.today), _literal(one.why)] for one in added(_earlier(data), data.claims)]
    return markdown(["rows", "window", "why"], lines)


def _rows(change: Change) -> str:
    return f"{_literal(change.label)} *{change.key}* ({change.rows})"


def _earlier(data: FullRun) -> pd.DataFrame:
    if data.earlier is None:
        raise DataError("results/history/windows.csv is missing: it is part of the repository")
    return data.earlier


def _literal(text: str) -> str:
    """A text with its scripts raised and lowered, and nothing in it that is taken for emphasis."""
    return re.sub(r"([*_])", r"\\\1", typeset(text))


def main() -> None:
    """``python -m study.present.pages RESULTS PAGE …``: the tables; badges and film of the first screen."""
    directory, *pages = map(Path, sys.argv[1:])
    data = FullRun.read(directory)
    if data is None:
        raise DataError(f"{directory} is not that of a full run: `make full`, `make controls` and `make seeds` make it")
    film, picture = directory / "figures" / f"{FILM}.gif", directory / "data" / "pictures" / f"{FILM}.json"
    with in_style():
        write_gif(film, with_every_shape(json.loads(picture.read_text(encoding="utf-8"))), lambda: None, SMALL)
    write_badges(directory / "badges", data, Path("pyproject.toml"))
    for page in pages:
        print(f"{page}: {'changed' if refresh(page, data) else 'up to date'}")


if __name__ == "__main__":
    main()
