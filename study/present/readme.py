"""The two tables of the README that come from the data: headline rows of the ledger, and where each statement lives."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from study.ledger.datafiles import SEEDS, DataError, caught, raised, read_claims, read_csv
from study.ledger.files import write_text
from study.ledger.rounding import above, below, up
from study.ledger.verdict import REPORTED, VERDICTS


@dataclass(frozen=True)
class Headlines:
    """The data behind the rows.

    ``expected`` is the order that is predicted for a case, ``proved`` the one that the proof of Prop. 5.4 gives.
    """

    directory: Path
    claims: pd.DataFrame
    expected: pd.Series
    proved: pd.Series

    @classmethod
    def read(cls, directory: Path) -> Headlines:
        """The data of a full run with controls and seeds; DataError if a file is missing."""
        cases = read_csv(directory, "cases.csv", ["case", "expected_order", "proved_order"]).set_index("case")
        orders = cases[["expected_order", "proved_order"]].astype(float)
        return cls(directory, read_claims(directory), orders["expected_order"], orders["proved_order"])

    def lines(self) -> list[list[str]]:
        """All rows; DataError if the ledger lacks those of one."""
        proved = [self.prop_5_4(), self.prop_5_3(), self.same_mesh(), self.own_space()]
        return [*proved, self.bound(), self.regularity(), self.defects(), self.seeds()]

    def prop_5_4(self) -> list[str]:
        fitted = self._rows("Prop. 5.4", "order-fitted")
        return [
            f"Proposition 5.4: the error ‖u − u^h‖ in L^∞(0,T;V) is O(h), in {fitted['case'].nunique()} cases",
            "order 1",
            # The ends of a fit are those of its interval, in which its value is judged.
            f"fitted orders {_outwards(fitted['observed'].min(), fitted['observed'].max())}, level by level "
            + _range(self._rows("Prop. 5.4", "order")),
            self._verdict("Prop. 5.4"),
        ]

    def prop_5_3(self) -> list[str]:
        seen = self._rows("Prop. 5.3", "order")
        expected = self.expected[seen["case"].unique()]
        limit = above(100 * self._rows("Prop. 5.3", "limit")["high"].max(), 0)
        return [
            f"Proposition 5.3: convergence, however rough, in {seen['case'].nunique()} cases",
            f"error → 0; orders {expected.min():.3g} … {expected.max():.3g} by regularity",
            f"a positive limit is at most {limit} % of the errors on the two finest meshes; orders {_range(seen)}",
            self._verdict("Prop. 5.3"),
        ]

    def same_mesh(self) -> list[str]:
        gaps = read_csv(self.directory, "equivalence.csv", ["stress_gap", "stress_bound"])
        return [
            "Theorem 4.2: displacement and stress formulation have one solution (same mesh, two solvers)",
            f"equal up to what the solver leaves open, at most {up(gaps['stress_bound'].max(), 2)} by its duality gap",
            f"stresses differ by at most {up(gaps['stress_gap'].max(), 2)}",
            self._verdict("Thm 4.2"),
        ]

    def own_space(self) -> list[str]:
        label = "Thm 4.2, own space"
        seen = self._rows(label, "order-stress")
        seen = seen[seen["case"].map(self.proved) == 1]
        cases = seen["case"].nunique()
        return [
            f"Theorem 4.2, with stresses that know no displacement: they converge to σ, in {cases} cases",
            "at least 3/2, by regularity, at most 2",
            f"orders {_range(seen)}",
            self._verdict(label, set(seen["case"])),
        ]

    def bound(self) -> list[str]:
        largest = above(self._rows("bound", "above")["high"].max(), 3)
        return [
            "beyond the paper: a computable bound of the error, without the exact solution",
            "error / bound ≤ 1",
            f"error / bound at most {largest}",
            self._verdict("bound"),
        ]

    def regularity(self) -> list[str]:
        seen = self._rows("(5.36)", "order")
        missing = seen[[self.expected[case] == 1 > self.proved[case] for case in seen["case"]]]
        proved = self.proved[missing["case"]]
        return [
            "beyond the paper: is the smoothness (5.36) that the proof of order 1 assumes needed?",
            f"the proof gives {proved.min():.3g} … {proved.max():.3g} without it",
            f"orders {_range(missing)}",
            REPORTED,
        ]

    def defects(self) -> list[str]:
        found, injected = caught(read_csv(self.directory, "controls.csv", ["defect", "caught"]).fillna(""))
        verdict = "holds" if found == injected else "fails"
        claim = "deliberate defects, injected one at a time"
        return [claim, "each is caught by a row", f"{found} of {injected}", verdict]

    def seeds(self) -> list[str]:
        found = raised(read_csv(self.directory, "seeds.csv", SEEDS))
        return [
            f"other random meshes: what is claimed on shaken meshes, on those of {found.seeds} seeds",
            "every row holds on all of them",
            f"{found.alarms} alarms in {found.verdicts} verdicts of {found.rows} rows",
            "fails" if found.alarms else "holds",
        ]

    def _rows(self, label: str, key: str) -> pd.DataFrame:
        of = self.claims[(self.claims["label"] == label) & (self.claims["key"] == key)]
        if of.empty:
            raise DataError(f"claims.csv has no row {label}, {key}: make it with `study run --full`")
        return of

    def _verdict(self, label: str, among: set[str] | None = None) -> str:
        """How many rows of a statement have each verdict, of all cases or of some."""
        mine = self.claims[self.claims["label"] == label]
        verdicts = mine.loc[mine["case"].isin(among or set(mine["case"])), "verdict"]
        counts = {name: int((verdicts == name).sum()) for name in VERDICTS if name != REPORTED}
        return ", ".join(f"{name} ({count} rows)" for name, count in counts.items() if count)


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
    """What is claimed, predicted and seen, rounded outwards, and the verdict, in Markdown; DataError if data lack."""
    return _markdown(["claim", "predicted", "observed", "verdict"], Headlines.read(directory).lines())


def statements(directory: Path) -> str:
    """Every statement with its verdicts, the file of the code that judges it and its data, in Markdown."""
    claims = read_claims(directory)
    made = json.loads((directory / "data" / "provenance.json").read_text(encoding="utf-8"))
    lines = []
    for label, rows in claims.groupby("label", sort=False):
        counts = [f"{n} {name}" for name in VERDICTS if (n := int((rows["verdict"] == name).sum()))]
        where = made["statements"].get(str(label), {"code": [], "data": "provenance.json"})
        code = ", ".join(f"[`{path}`]({path})" for path in where["code"])
        lines.append([str(label), str(rows["statement"].iloc[0]), ", ".join(counts), code, f"`{where['data']}`"])
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
