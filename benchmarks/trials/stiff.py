"""How wide bounds are for stiff and for nearly incompressible materials.

The unit square, clamped on top, A = (μ, λ) = (1, ½) and G = s (1, ℓ); then A = (1, ℓ) as well. The zone of contact
grows from the left.
*Guaranteed effectivity*: the upper bound over a lower bound of the same error, which a finer ũ gives.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pandas as pd

from benchmarks.trials.record import made
from manufactured import Data, KelvinVoigt, Kind, isotropic, polygon, t
from manufactured.factor import x1, x2
from study.bound.bounded import bounded_solution
from study.bound.trajectory import Refined
from study.fem.mesh import Unstructured
from study.ledger.text import up
from study.present.pages import markdown
from study.solve.tableau import MIDPOINT

LEVEL = 8
USUAL, FINER = Refined(1, 4), Refined(2, 8)
SCALES = (1e-4, 1e-2, 1.0, 1e2, 1e4)


def trials() -> list[str]:
    """G = s (1, ℓ) for all s and ℓ, A = (1, ½); then A = (1, ℓ) with G = (1, ½) and with G = A."""
    found = [f"G {s:g} {ratio:g}" for s in SCALES for ratio in SCALES]
    return found + [f"{which} 1 {ratio:g}" for which in ("A", "both") for ratio in SCALES]


def law(trial: str) -> KelvinVoigt:
    """A and G of a trial."""
    which, scale, ratio = trial.split()
    stiff, usual = isotropic(float(scale), float(scale) * float(ratio)), isotropic(1, 0.5)
    A, G = {"G": (usual, stiff), "A": (stiff, usual), "both": (stiff, stiff)}[which]
    return KelvinVoigt(A, G, trial)


def problem(trial: str) -> Data:
    body = polygon([(0, 0), (1, 0), (1, 1), (0, 1)], [Kind.CONTACT, Kind.LOADED, Kind.CLAMPED, Kind.LOADED])
    return Data.formulas(body, law(trial), f0=(0, 12 * t * (x1 - t)), f2={1: (-2 * t * x2, 0)})


def bounds(trial: str, refined: Refined) -> tuple[float, float, float]:
    """The ends of the enclosure of max_t ‖u − u_h‖_V, and the bound from u_h alone."""
    found = bounded_solution(problem(trial), None, Unstructured(), LEVEL, MIDPOINT, LEVEL, refined)
    return found.enclosure.lowest, found.enclosure.highest, found.plain.highest


def row(trial: str) -> dict[str, Any]:
    """One trial."""
    low, high, plain = bounds(trial, USUAL)
    least, most, _ = bounds(trial, FINER)
    return {name: float(f"{x:.4g}") for name, x in zip(COLUMNS, (least, most, low, high, plain), strict=True)}


COLUMNS = ("finer_low", "finer_high", "low", "high", "plain")


def table(out: Path) -> pd.DataFrame:
    """``effectivity.csv``."""
    return made(out / "effectivity.csv", trials(), row)


def wide(found: pd.DataFrame) -> pd.DataFrame:
    """Guaranteed effectivities: ``enclosure`` and ``plain``."""
    low = found["finer_low"]
    return pd.DataFrame({"trial": found["trial"], "enclosure": found["high"] / low, "plain": found["plain"] / low})


def summary(found: pd.DataFrame) -> str:
    """The largest effectivities over the ratios λ/μ, in Markdown."""
    rows = wide(found)
    which = rows["trial"].str.split().str
    kinds = {f"$G = {_tex(s)}\\,(1, \\ell)$": (which[0] == "G") & (which[1] == f"{s:g}") for s in SCALES}
    kinds |= {
        "$A = (1, \\ell)$, $G = (1, \\tfrac12)$": which[0] == "A",
        "$A = G = (1, \\ell)$": which[0] == "both",
    }
    lines = []
    for name, mine in kinds.items():
        lines.append([name, *(up(rows.loc[mine, column].max(), 3) for column in ("enclosure", "plain"))])
    return markdown(["material", "enclosure", "from $u_h$ alone"], lines)


def _tex(scale: float) -> str:
    return f"10^{{{round(math.log10(scale))}}}" if scale != 1 else "1"
