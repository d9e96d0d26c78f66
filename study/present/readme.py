"""The two tables of the README that come from the data: headline rows of the ledger, and where each statement lives."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

import pandas as pd

from study.ledger.datafiles import SEEDS, VERDICTS, DataError, caught, raised, read_claims, read_csv
from study.ledger.files import write_text
from study.ledger.rounding import above, below, up
from study.present.report.sources import sources

MEASURED = {
    "data": "provenance.json",
    "Prop. 5.4": "rates.csv",
    "Prop. 5.3": "rates.csv",
    "axes": "rates.csv",
    "(5.36)": "rates.csv",
    "Thm 4.2": "equivalence.csv",
    "Thm 4.2, own space": "stresses.csv",
    "bound": "bounds.csv",
    "enclosure": "enclosures.csv",
    "slips": "claims.csv",
    "not tested": "claims.csv",
}
"""The data file of a statement; the others are in statements.csv."""


def refresh(readme: Path, directory: Path) -> bool:
    """Put both tables of ``directory`` into a text between ``<!-- NAME -->`` and ``<!-- end -->``; whether it changed.

    Raises:
        DataError: the data or the marks are missing.
    """
    text = before = readme.read_text(encoding="utf-8")
    for name, table in (("headline", headline(directory)), ("statements", statements(directory))):
        start, end = f"<!-- {name} -->\n", "<!-- end -->"
        head, found, rest = text.partition(start)
        _, closed, tail = rest.partition(end)
        if not (found and closed):
            raise DataError(f"{readme} lacks {start.strip()} … {end}, between which its {name} table belongs")
        text = f"{head}{start}{table}{end}{tail}"
    write_text(readme, text)
    return text != before


def headline(directory: Path) -> str:
    """What is claimed, what was predicted and seen, and the verdict, in Markdown.

    Numbers that were seen are rounded outwards, so that no row says more than the data.

    Raises:
        DataError: a file is missing, or ``claims.csv`` lacks the rows of a line.
    """
    return _markdown(["claim", "predicted", "observed", "verdict"], _headlines(directory))


def _headlines(directory: Path) -> Iterator[list[str]]:
    claims = read_claims(directory)
    cases = read_csv(directory, "cases.csv", ["case", "expected_order", "proved_order"]).set_index("case")

    def rows(label: str, quantity: str) -> pd.DataFrame:
        of = claims[(claims["label"] == label) & claims["quantity"].str.startswith(quantity)]
        if of.empty:
            raise DataError(f"claims.csv has no row {label}, {quantity!r}: make it with `study run --full`")
        return of

    def verdict(label: str, among: set[str] | None = None) -> str:
        chosen = (claims["label"] == label) & (True if among is None else claims["case"].isin(among))
        mine = claims.loc[chosen, "verdict"]
        counts = {name: int((mine == name).sum()) for name in VERDICTS}
        return ", ".join(f"{name} ({count} rows)" for name, count in counts.items() if count and name != "reported")

    fitted = rows("Prop. 5.4", "order of the error, fitted")
    yield [
        f"Proposition 5.4: the error ‖u − u^h‖ in L^∞(0,T;V) is O(h), in {fitted['case'].nunique()} cases",
        "order 1",
        # The ends of a fit are those of its interval, in which its value is judged.
        f"fitted orders {_outwards(fitted['observed'].min(), fitted['observed'].max())}, level by level "
        + _range(rows("Prop. 5.4", "order of the error, level")),
        verdict("Prop. 5.4"),
    ]
    rough = rows("Prop. 5.3", "order seen")
    plain = rough[~rough["quantity"].str.contains("graded")]
    expected = cases.loc[plain["case"].unique(), "expected_order"].astype(float)
    limit = rows("Prop. 5.3", "limit e∞")["high"].max()
    yield [
        f"Proposition 5.3: convergence, however rough, in {plain['case'].nunique()} cases",
        f"error → 0; orders {expected.min():.3g} … {expected.max():.3g} by regularity",
        f"a positive limit is at most {above(100 * limit, 0)} % of the errors on the two finest meshes; "
        f"orders {_range(plain)}",
        verdict("Prop. 5.3"),
    ]
    strains = read_csv(directory, "equivalence.csv", ["stress_gap", "stress_bound"])
    yield [
        "Theorem 4.2: displacement and stress formulation have one solution (same mesh, two solvers)",
        f"equal up to what the solver leaves open, at most {up(strains['stress_bound'].max(), 2)} by its duality gap",
        f"stresses differ by at most {up(strains['stress_gap'].max(), 2)}",
        verdict("Thm 4.2"),
    ]
    own = rows("Thm 4.2, own space", "order of ‖σ − σ^h‖_Q")
    own = own[own["case"].map(cases["proved_order"].astype(float)) == 1]
    yield [
        f"Theorem 4.2, with stresses that know no displacement: they converge to σ, in {own['case'].nunique()} cases",
        "at least 3/2, by regularity, at most 2",
        f"orders {_range(own)}",
        verdict("Thm 4.2, own space", set(own["case"])),
    ]
    enclosed = rows("bound", "largest error / upper bound")
    yield [
        "beyond the paper: a computable bound of the error, without the exact solution",
        "error / bound ≤ 1",
        f"error / bound at most {above(enclosed['high'].max(), 3)}",
        verdict("bound"),
    ]
    needed = rows("(5.36)", "order seen")
    proved = cases["proved_order"].astype(float)
    missing = needed[[cases["expected_order"].astype(float)[case] == 1 > proved[case] for case in needed["case"]]]
    yield [
        "beyond the paper: is the smoothness (5.36) that the proof of order 1 assumes needed?",
        f"the proof gives {proved[missing['case']].min():.3g} … {proved[missing['case']].max():.3g} without it",
        f"orders {_range(missing)}",
        "reported",
    ]
    controls = read_csv(directory, "controls.csv", ["defect", "caught"]).fillna("")
    found, injected = caught(controls)
    yield [
        "deliberate defects, injected one at a time",
        "each is caught by a row",
        f"{found} of {injected}",
        "holds" if found == injected else "fails",
    ]
    seeds = raised(read_csv(directory, "seeds.csv", SEEDS))
    yield [
        f"other random meshes: what is claimed on shaken meshes, on those of {seeds.seeds} seeds",
        "every row holds on all of them",
        f"{seeds.alarms} alarms in {seeds.verdicts} verdicts of {seeds.rows} rows",
        "fails" if seeds.alarms else "holds",
    ]


def _range(rows: pd.DataFrame) -> str:
    """From the least to the largest value, rounded outwards."""
    return _outwards(rows["low"].min(), rows["high"].max())


def _outwards(low: float, high: float) -> str:
    return f"{below(low, 2)} … {above(high, 2)}"


def statements(directory: Path) -> str:
    """Every statement with its verdicts, the file of the code that judges it and its data, in Markdown."""
    claims, judges = read_claims(directory), sources()
    lines = []
    for label, rows in claims.groupby("label", sort=False):
        counts = [f"{n} {name}" for name in VERDICTS if (n := int((rows["verdict"] == name).sum()))]
        code = ", ".join(f"`{path}`" for path in judges.get(str(label), []))
        data = MEASURED.get(str(label), "statements.csv")
        lines.append([str(label), str(rows["statement"].iloc[0]), ", ".join(counts), code, f"`{data}`"])
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
