"""How time and memory grow with the mesh: every level in a process of its own, `make bench-growth`.

    python -m benchmarks.growth [--out DIRECTORY] [--largest N]

A process knows the largest memory it ever held, so one level each.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np
import pandas as pd

from benchmarks.level import SOLVERS, STEPS, Place, Watched, compile_formulas, errors
from benchmarks.report import RESULTS, ROOT, single_thread, write
from study.fem.naming import resolve

RIGHTS = 5
"""Right sides on which bare solves are timed."""
EXPONENT, BYTES = 1.1, 3000.0
"""Goals: time of a level like dofs^EXPONENT, BYTES per unknown at a million of them."""
MILLION = 1_000_000
COLUMNS = [
    "n",
    "dofs",
    "factor_seconds",
    "solve_seconds",
    "step_seconds",
    "step_over_solve",
    "level_seconds",
    "peak_bytes",
    "dim",
    "solver",
    "remark",
]


@dataclass(frozen=True)
class Level:
    """One row: a case on one-diagonal meshes with a solver."""

    case: str
    n: int
    solver: str

    def measure(self) -> dict[str, Any]:
        """The row; to be called in a process that has done nothing else."""
        dim = resolve(self.case).solution.body.dim
        watched = Watched(SOLVERS[self.solver], RIGHTS)
        compile_formulas(self.case)
        start = perf_counter()
        setup = Place(self.case, "one-diagonal", self.n).setup(watched)
        errors(setup)
        seconds = perf_counter() - start
        peak = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        bare = watched.solver.bare(watched)
        # Both on the same right sides one after the other, with the same caches.
        solve, step = (median(_seconds(solver, b) for b in watched.rights) for solver in (bare, watched.contact))
        return {
            "n": self.n,
            "dofs": setup.space.dofs,
            "factor_seconds": watched.setup_seconds,
            "solve_seconds": solve,
            "step_seconds": step,
            "step_over_solve": step / solve,
            "level_seconds": seconds,
            "peak_bytes": peak,
            "dim": dim,
            "solver": self.solver,
        }


LEVELS = (
    *(Level("advance-recede", n, "direct") for n in (128, 256, 512)),
    *(Level("advance-recede", n, "multigrid") for n in (128, 256)),
    *(Level("cube-disc", n, "direct") for n in (12, 18, 24, 32)),
    *(Level("cube-disc", n, "multigrid") for n in (12, 24, 32, 48)),
)


def _seconds(solve: Any, b: Any) -> float:
    start = perf_counter()
    solve(b)
    return perf_counter() - start


def exponent(dofs: Any, seconds: Any) -> float:
    """p of the least squares fit of seconds = C dofs^p in logarithms."""
    slope, _ = np.polyfit(np.log(dofs), np.log(seconds), 1)
    return float(slope)


def findings(table: pd.DataFrame) -> list[str]:
    """A sentence for every dimension and solver: the exponent, and the bytes per unknown at the finest level."""
    found = []
    for (dim, solver), rows in table.dropna(subset="dofs").groupby(["dim", "solver"]):
        finest = rows.loc[rows["dofs"].idxmax()]
        sentence = (
            f"{dim}D, {solver}: {finest['peak_bytes'] / finest['dofs']:.0f} bytes per unknown at {finest['dofs']}"
        )
        if finest["dofs"] >= MILLION:
            sentence += f" (goal: {BYTES:.0f})"
        if len(rows) > 1:
            sentence += f"; seconds of a level like dofs^{exponent(rows['dofs'], rows['level_seconds']):.2f}"
            sentence += f" (goal: {EXPONENT})" if dim == 2 else ""
        found.append(f"{sentence}.")
    return found


def row(level: Level) -> dict[str, Any]:
    """The row from a process of its own; with nothing but a remark why, if that failed."""
    command = [sys.executable, "-m", "benchmarks.growth", "--level", json.dumps(asdict(level))]
    done = subprocess.run(command, capture_output=True, text=True, env=single_thread(os.environ), cwd=ROOT)
    if done.returncode:
        last = (done.stderr.strip().splitlines() or [f"signal {-done.returncode}"])[-1]
        dim = resolve(level.case).solution.body.dim
        return {"n": level.n, "dim": dim, "solver": level.solver, "remark": f"not measured: {last}"}
    return json.loads(done.stdout) | {"remark": ""}


def main(arguments: list[str]) -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=RESULTS)
    parser.add_argument("--largest", type=int, default=max(level.n for level in LEVELS), help="largest n")
    parser.add_argument("--level", type=json.loads, help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    if options.level:
        print(json.dumps(Level(**options.level).measure()))
        return
    rows = []
    for level in LEVELS:
        if level.n <= options.largest:
            rows.append(row(level))
            print(rows[-1], flush=True)
    table = pd.DataFrame(rows, columns=COLUMNS).astype({"dofs": "Int64", "peak_bytes": "Int64"})
    note = (
        "A level: mesh, assembly, set-up of the solver (*factor*: factorisation and condensation) and "
        f"{STEPS} midpoint steps with load and error, but not the compilation of the formulas (SymPy to functions), "
        "which comes before; each in a process of its own, whose largest memory is *peak*. *step_over_solve*: contact "
        "step over a solve without constraints by the same factorisation or hierarchy. "
        "Multigrid stops at a share of the discretisation error, as in the study, also where the study factorises. "
        "Cases: advance-recede and cube-disc, one-diagonal meshes."
    )
    write(options.out, "growth", table, "Growth", [note, *findings(table)])
    print((options.out / "growth.md").read_text(encoding="utf-8"))


if __name__ == "__main__":
    main(sys.argv[1:])
