"""The two tables of the README that come from the data: headline rows of the ledger, and where each statement lives."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path

import pandas as pd

from study.ledger.datafiles import DataError, by_claim, caught, count_verdicts, raised
from study.ledger.files import write_text
from study.ledger.rounding import above, below, up
from study.ledger.verdict import REPORTED
from study.present.article.source import FullRun


def headline(data: FullRun) -> str:
    """What is claimed, predicted and seen, rounded outwards, and the verdict, in Markdown; DataError if rows lack."""
    rows = (_prop_5_4, _prop_5_3, _same_mesh, _own_space, _bound, _regularity, _defects, _seeds)
    return _markdown(["claim", "predicted", "observed", "verdict"], [row(data) for row in rows])


def _prop_5_4(data: FullRun) -> list[str]:
    fitted = data.rows("Prop. 5.4", "order-fitted")
    return [
        f"Proposition 5.4: the error ‖u − u^h‖ in L^∞(0,T;V) is O(h), in {fitted['case'].nunique()} cases",
        "order 1",
        # The ends of a fit are those of its interval, in which its value is judged.
        f"fitted orders {_outwards(fitted['observed'].min(), fitted['observed'].max())}, level by level "
        + _range(data.rows("Prop. 5.4", "order")),
        _verdict(data, "Prop. 5.4"),
    ]


def _prop_5_3(data: FullRun) -> list[str]:
    seen = data.rows("Prop. 5.3", "order")
    expected = data.cases.loc[seen["case"], "expected_order"]
    limit = above(100 * data.rows("Prop. 5.3", "limit")["high"].max(), 0)
    return [
        f"Proposition 5.3: convergence, however rough, in {seen['case'].nunique()} cases",
        f"error → 0; orders {expected.min():.3g} … {expected.max():.3g} by regularity",
        f"a positive limit is at most {limit} % of the errors on the two finest meshes; orders {_range(seen)}",
        _verdict(data, "Prop. 5.3"),
    ]


def _same_mesh(data: FullRun) -> list[str]:
    allowed, seen = (up(data.equivalence[name].max(), 2) for name in ("stress_bound", "stress_gap"))
    return [
        "Theorem 4.2: displacement and stress formulation have one solution (same mesh, two solvers)",
        f"equal up to what the solver leaves open, at most {allowed} by its duality gap",
        f"stresses differ by at most {seen}",
        _verdict(data, "Thm 4.2"),
    ]


def _own_space(data: FullRun) -> list[str]:
    label = "Thm 4.2, own space"
    seen = data.rows(label, "order-stress")
    seen = seen[seen["case"].map(data.cases["proved_order"]) == 1]
    return [
        f"Theorem 4.2, with stresses that know no displacement: they converge to σ, in {seen['case'].nunique()} cases",
        "at least 3/2, by regularity, at most 2",
        f"orders {_range(seen)}",
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
    missing = seen[seen["case"].map((orders["expected_order"] == 1) & (orders["proved_order"] < 1))]
    proved = orders.loc[missing["case"], "proved_order"]
    return [
        "beyond the paper: is the smoothness (5.36) that the proof of order 1 assumes needed?",
        f"the proof gives {proved.min():.3g} … {proved.max():.3g} without it",
        f"orders {_range(missing)}",
        REPORTED,
    ]


def _defects(data: FullRun) -> list[str]:
    found, injected = caught(data.controls)
    verdict = "holds" if found == injected else "fails"
    claim = "deliberate defects, injected one at a time"
    return [claim, "each is caught by a row", f"{found} of {injected}", verdict]


def _seeds(data: FullRun) -> list[str]:
    found = raised(data.seeds)
    return [
        f"other random meshes: what is claimed on shaken meshes, on those of {found.seeds} seeds",
        "every row holds on all of them",
        f"{found.alarms} alarms in {found.verdicts} verdicts of {found.rows} rows",
        "fails" if found.alarms else "holds",
    ]


def _verdict(data: FullRun, label: str, among: set[str] | None = None) -> str:
    """How many rows of a statement have each verdict, of all cases or of some."""
    mine = data.claims[data.claims["label"] == label]
    counts = count_verdicts(mine if among is None else mine[mine["case"].isin(among)])
    return ", ".join(f"{name} ({count} rows)" for name, count in counts.items() if count and name != REPORTED)


def _range(rows: pd.DataFrame) -> str:
    """From the least to the largest value, rounded outwards."""
    return _outwards(rows["low"].min(), rows["high"].max())


def _outwards(low: float, high: float) -> str:
    return f"{below(low, 2)} … {above(high, 2)}"


def refresh(readme: Path, directory: Path) -> bool:
    """Put both tables of ``directory`` into a text between ``<!-- NAME -->`` and ``<!-- end -->``; whether it changed.

    Raises:
        DataError: the data or the marks are missing.
    """
    text, data = readme.read_text(encoding="utf-8"), FullRun.read(directory)
    if data is None:
        raise DataError(f"{directory} is not that of a full run: `make full`, `make controls` and `make seeds` make it")
    before = text
    for name, table in (("headline", headline(data)), ("statements", statements(data))):
        start, end = f"<!-- {name} -->\n", "<!-- end -->"
        head, found, rest = text.partition(start)
        _, closed, tail = rest.partition(end)
        if not (found and closed):
            raise DataError(f"{readme} lacks {start.strip()} … {end}, between which its {name} table belongs")
        text = f"{head}{start}{table}{end}{tail}"
    write_text(readme, text)
    return text != before


def statements(data: FullRun) -> str:
    """Every statement with its verdicts, the file of the code that judges it and its data, in Markdown."""
    lines = []
    for label, claim, rows in by_claim(data.claims):
        counts = ", ".join(f"{count} {name}" for name, count in count_verdicts(rows).items() if count)
        where = data.provenance["statements"].get(label, {"code": [], "data": ["provenance.json"]})
        code = ", ".join(f"[`{path}`]({path})" for path in where["code"])
        lines.append([label, claim, counts, code, ", ".join(f"`{name}`" for name in where["data"])])
    return _markdown(["statement", "says", "verdicts", "code", "data"], lines)


def _markdown(header: list[str], rows: Iterable[list[str]]) -> str:
    lines = [header, ["---"] * len(header), *rows]
    return "".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |\n" for line in lines)


def main() -> None:
    """``python -m study.present.readme README.md results``."""
    readme, directory = map(Path, sys.argv[1:])
    print(f"{readme}: {'changed' if refresh(readme, directory) else 'up to date'}")


if __name__ == "__main__":
    main()
