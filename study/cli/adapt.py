"""``study bound --adapt``: refine mesh and time steps until the bound is at most a tolerance; resumes after Ctrl-C."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from manufactured.static import Static
from study.bound import adaptive, bounded
from study.bound.adaptive import Adapted, Stage
from study.bound.discretisation import check_force
from study.bound.trajectory import Refined
from study.cli.common import listed
from study.cli.options import FAILED, OK
from study.fem.naming import choose, family_named, resolve_data
from study.ledger.files import write_text
from study.ledger.text import folded, up
from study.present.figures import AdaptedMesh, adapted_mesh, draw_one
from study.run.executor import GIB, available
from study.run.fingerprint import of_problem
from study.run.store import Store
from study.solve.steps import MOST
from study.solve.tableau import SCHEMES
from study.statements.shared import estimates


def do_adapt(options: argparse.Namespace) -> int:
    """Compute, bound and refine, and write each mesh; 0 if the tolerance is reached, 1 if a limit is reached first."""
    name, data, case = resolve_data(options.problem)
    scheme, family = choose("scheme", options.scheme, SCHEMES), family_named(options.family)
    level = min(options.levels)
    check_force(case)
    tolerance = adaptive.tolerance_from(options.adapt)
    adaptive.check_cells(options.cells)
    bounded.check_bound(data, family, [level], options.steps, Refined(0, 1))
    mesh = family(data.body, level)
    stage = Stage(mesh.p, mesh.t, bounded.steps_on(data, level, options.steps))
    store = Store(options.out / name, written=(".",))
    kept: list[dict[str, Any]] = []
    with store.locked():
        while True:
            number = len(kept)
            # The tolerance is not part of the key: it only decides when to stop.
            made_by = of_problem(data, case, (family, level, options.steps, scheme, isinstance(data, Static), number))
            kept.append(_stage(store, number, made_by, partial(adaptive.adapted, data, case, stage, scheme)))
            rows = adaptive.table([one["row"] for one in kept])
            table = write_text(store.directory / "adaptive.csv", rows.to_csv(index=False))
            print(f"mesh {number}: {stage.cells} cells, bound {up(rows['bound'].iloc[-1], adaptive.SHOWN)}", flush=True)
            with np.load(adaptive.stage_file(store.directory, number)) as arrays:
                following = adaptive.next_stage(stage, arrays["shares"], float(arrays["in_time"]))
                edges, closed = adaptive.contact_edges(data, stage.mesh, arrays["u"][-1])
            reached = tolerance.reached(rows.iloc[-1])
            stopped = "" if reached else _limit(following, options.cells)
            if reached or stopped:
                break
            stage = following
        shown = AdaptedMesh(stage.p, stage.t, edges, closed, rows, _uniform(store.directory))
        written = [table, *(adaptive.stage_file(store.directory, number) for number in range(len(kept)))]
        written += draw_one(store.directory, adapted_mesh(name, shown))
    print(folded(f"written: {listed(written)}"))
    sentences = [*kept[-1]["sentences"], *bounded.contact_sentences(data.body)]
    print("\n" + "\n".join(adaptive.text(name, rows, tolerance, stopped, sentences, bounded.norm_of(data))) + "\n")
    return OK if reached and all(one["inside"] for one in kept if case) else FAILED


def _stage(store: Store, number: int, made_by: str, compute: Callable[[], Adapted]) -> dict[str, Any]:
    """Return the record of a mesh, from disk or computed."""
    key = f"adapted-{number}"
    kept = store.load(key, made_by) if adaptive.stage_file(store.directory, number).is_file() else None
    if kept is not None:
        return kept
    found = compute()
    adaptive.write_stage(store.directory, number, found)
    record = adaptive.record(number, found)
    store.save(key, made_by, record)
    return record


def _limit(stage: Stage, cells: int) -> str:
    """Return why the next mesh is not computed; "" if it is."""
    if stage.cells > cells:
        return f"the next mesh has {stage.cells} cells, and {cells} are allowed: raise --cells or the tolerance"
    if stage.steps > MOST:
        return f"{stage.steps} time steps would follow, and {MOST} are taken at most: raise the tolerance"
    need, room = estimates.adapted(stage.cells), available()
    if need > room:
        return (
            f"the next mesh has {stage.cells} cells, which need about {need / GIB:.1f} GiB of memory, {room / GIB:.1f} "
            "GiB are available: raise the tolerance, or take a machine with more"
        )
    return ""


def _uniform(directory: Path) -> pd.DataFrame:
    """Return ``levels.csv`` of ``study bound`` for the same problem; empty if there is none."""
    file = directory / "levels.csv"
    return pd.read_csv(file) if file.is_file() else pd.DataFrame()
