"""Bound the errors of contact codes on a problem whose solution nobody knows, and the orders of these errors.

    python examples/bounds/judge_codes.py [--only ADAPTER ...]

The problem is ``ramp``: no corner of the body is singular, so the order of a correct code is about 1. Every code
marches by the midpoint rule with n equal steps on the same mesh. The better displacement and its bound are computed
once for each mesh. Needs the codes that `make codes` needs. Writes results/codes/bounds.csv, and the table and the
figure of docs/explanation/bounds.md. To begin again, remove build/bounds-of-codes.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from skfem import Mesh

from manufactured.data import Data
from manufactured.modes import at_each
from manufactured.problems import ramp
from study.bound import bounded, fields
from study.bound.bounded import BoundedSolution
from study.bound.discretisation import Discretisation
from study.bound.enclosing import enclose
from study.bound.given import given
from study.bound.trajectory import Refined, prolongation
from study.cli.export import march, write_task
from study.fem.naming import family_named
from study.fem.space import Space
from study.ledger.files import write_text
from study.ledger.text import interval, up
from study.present.pages import markdown, put
from study.solve.evolution import SemiDiscrete
from study.solve.tableau import MIDPOINT

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "examples" / "codes"))
from run_codes import ADAPTERS  # noqa: E402

BUILD, TABLE = ROOT / "build" / "bounds-of-codes", ROOT / "results" / "codes" / "bounds.csv"
PAGE, FIGURE = ROOT / "docs" / "explanation" / "bounds.md", ROOT / "docs" / "explanation" / "codes.png"
NAMES = "this_study", "scikit_fem", "kratos_mortar", "ngsolve_penalty", "getfem_contact", "calculix"
FAMILY = "one-diagonal"
BETTER = {8: Refined(2, 4), 16: Refined(2, 4), 32: Refined(1, 2)}
"""Level ↦ ũ, on the mesh of n = 32 or 64 and always with 64 time steps."""
KEY = ["code", "method"]
COLUMNS = [*KEY, "version", "level", "h", "steps", "lowest", "highest", "percent_low", "percent_high"]
COLUMNS += ["order_low", "order_high", "kind", "default_high"]
DEFAULT = 16
"""Level on which errors are also bounded with the default settings of ``study bound``."""


def task(name: str, data: Data, mesh: Mesh, level: int) -> Any:
    """Return the march through a problem on a mesh in the form that ``study.cli.export.march`` exports.

    The export has a place for exact values, to judge answers by. Nobody knows them here, and zeros take their place.
    """
    discretisation = Discretisation(data, mesh)
    space = Space(discretisation.mesh, data.body)
    J = prolongation(space, discretisation)
    cells = space.mesh.t.shape[1]
    start = space.interpolate(data.start(space.mesh.p))
    problem = SemiDiscrete.of(space, data.law, lambda times: J.T @ at_each(times, discretisation.load), start)
    unknown = SimpleNamespace(means=np.zeros((3, cells)), oscillation=0.0, interpolant=0 * start)
    return SimpleNamespace(
        case=SimpleNamespace(name=name),
        family=SimpleNamespace(name="mesh"),
        level=level,
        space=space,
        solution=SimpleNamespace(law=data.law, has_initial_gap=False),
        v_norm=SimpleNamespace(sample=lambda time: unknown),
        march=lambda steps: (problem, MIDPOINT.march(problem, steps)),
        pressures=lambda time: [np.zeros(len(vertices)) for _, vertices in space.contact],
        resultants=lambda time: np.zeros(len(space.contact)),
    )


def export(marched: Any, steps: int, directory: Path) -> None:
    """Write a march into DIRECTORY/tasks, unless a file for its level is there."""
    tasks = directory / "tasks"
    tasks.mkdir(parents=True, exist_ok=True)
    if not list(tasks.glob(f"*-{marched.level}.json.xz")):
        write_task(tasks, march(marched, steps))


def run_codes(names: list[str], directory: Path) -> None:
    """Run the codes that are installed on DIRECTORY/tasks, into DIRECTORY/fields; say how to get the others."""
    (directory / "fields").mkdir(parents=True, exist_ok=True)
    for adapter in ADAPTERS:
        if adapter.name not in names:
            continue
        if adapter.missing():
            print(f"{adapter.name} is not installed: {adapter.get}")
            continue
        program = Path(__file__).with_name("march.py")
        command = [adapter.python, program, adapter.name, directory / "tasks", directory / "fields"]
        subprocess.run(list(map(str, command)), check=True)


def bound(level: int, paths: list[Path], better: Refined) -> list[dict[str, Any]]:
    """Return a row with the interval of the largest error for each displacement on the mesh of a level."""
    data = ramp()
    rows = []
    for path in paths:
        u_h = given(data, **vars(fields.read(path)))
        enclosure = enclose(Discretisation(data, u_h.mesh), u_h, better)
        with np.load(path) as arrays:
            code, version, method = arrays["name"].tolist()
        row = bounded.record(level, BoundedSolution(u_h, None, enclosure))["row"]
        rows.append({"code": code, "version": version, "method": method} | row)
    return rows


def default_bounds(paths: list[Path]) -> pd.DataFrame:
    """Return the upper bounds of the errors with the default settings, a row for each displacement on one mesh."""
    rows = pd.DataFrame(bound(DEFAULT, paths, Refined()))
    return rows.rename(columns={"highest": "default_high"})[["code", "method", "level", "default_high"]]


def bounds_of(level: int) -> Path:
    """Return the file that keeps the bounds on a mesh, so that a run that was stopped goes on."""
    return BUILD / f"bounds-{level}.csv"


def table(rows: pd.DataFrame, default: pd.DataFrame) -> pd.DataFrame:
    """Return bounds.csv: a row for each code, method and mesh, with the orders since the coarsest and the last mesh.

    The column ``default_high`` is from ``default_bounds``.
    """
    parts = [bounded.levels(part.to_dict("records")) for _, part in rows.groupby(KEY, sort=False)]
    return pd.concat(parts).merge(default, how="left", on=[*KEY, "level"])[COLUMNS].round(9)


def summary(found: pd.DataFrame) -> str:
    """Return the table of the page: intervals of the error in per cent on each mesh, and of the order."""
    levels = sorted(found["level"].unique())
    lines = []
    for (code, method), part in found.groupby(KEY, sort=False):
        shares = {row.level: interval(row.percent_low, row.percent_high, 3) for row in part.itertuples()}
        last = part.iloc[-1]
        order = interval(last["order_low"], last["order_high"], 3)
        middle = part[part["level"] == DEFAULT].iloc[0]
        ratio = up(middle["default_high"] / middle["lowest"], 3)
        lines.append([f"{code} {last['version']}", method, *(shares.get(n, "") for n in levels), order, ratio])
    heads = [*(f"$n = {n}$" for n in levels), f"order since $n = {levels[0]}$", f"bound / error, $n = {DEFAULT}$"]
    return markdown(["code", "method", *heads], lines)


def draw(found: pd.DataFrame, path: Path) -> None:
    """Draw the intervals of the order, one line for each method."""
    last = found.groupby(KEY, sort=False).last().reset_index()
    figure = Figure(figsize=(6.4, 0.6 + 0.3 * len(last)), layout="constrained")
    axes = figure.subplots()
    axes.axvline(1, color="0.6", lw=0.8)
    proved = last["order_high"] < 1
    for row, color in zip(last.iloc[::-1].itertuples(), np.where(proved, "tab:red", "tab:blue")[::-1], strict=True):
        axes.plot([row.order_low, row.order_high], [f"{row.code}, {row.method}"] * 2, color=color, lw=4)
    figure.supxlabel("guaranteed interval of the order of the error in V", fontsize="medium")
    figure.savefig(path, dpi=150)


def main() -> None:
    """Run the codes, bound what they gave and write table, page and figure."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", metavar="ADAPTER", default=list(NAMES))
    options = parser.parse_args()
    data = ramp()
    family = family_named(FAMILY)
    for level in BETTER:
        export(task("ramp", data, family(data.body, level), level), level, BUILD)
    run_codes(options.only, BUILD)
    for level in BETTER:
        if not bounds_of(level).exists():
            files = [path for name in options.only for path in sorted((BUILD / "fields").glob(f"{name}-{level}-*.npz"))]
            pd.DataFrame(bound(level, files, BETTER[level])).to_csv(bounds_of(level), index=False)
            print(f"n = {level}: {len(files)} displacements bounded", flush=True)
    default = BUILD / "default.csv"
    if not default.exists():
        files = [path for name in options.only for path in sorted((BUILD / "fields").glob(f"{name}-{DEFAULT}-*.npz"))]
        default_bounds(files).to_csv(default, index=False)
    rows = pd.concat([pd.read_csv(bounds_of(level), dtype={"version": str}) for level in BETTER])
    found = table(rows, pd.read_csv(default))
    write_text(TABLE, found.to_csv(index=False))
    write_text(PAGE, put(PAGE.read_text(encoding="utf-8"), "bounds-of-codes", summary(found)))
    draw(found, FIGURE)


if __name__ == "__main__":
    main()
