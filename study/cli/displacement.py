"""``study bound --displacement``: encloses the errors of displacements that other programs have computed."""

from __future__ import annotations

import argparse
import hashlib
import math
from functools import partial
from pathlib import Path
from typing import Any

import pandas as pd

from manufactured.case import Case
from manufactured.data import Data
from manufactured.self_proof import prove
from manufactured.static import Static
from study.bound import bounded, fields
from study.bound.discretisation import check_force
from study.bound.given import bounded_displacement, given
from study.bound.trajectory import GivenDisplacement, Refined
from study.cli.common import listed, with_progress
from study.cli.options import FAILED, OK
from study.fem.naming import resolve_data
from study.ledger.files import UsageError
from study.ledger.text import folded
from study.present.drawing import draw_one
from study.present.figures import enclosure
from study.run.executor import GIB, available
from study.run.fingerprint import of_problem
from study.run.store import Store
from study.statements.shared import estimates


def do_displacement(options: argparse.Namespace) -> int:
    """Enclose the error of the displacement in each file, and write the results.

    Returns:
        0 if the exact solution is unknown, or if all errors lie in their enclosures; otherwise 1.
    """
    name, data, case = resolve_data(options.problem)
    refined = Refined(options.refine, options.shorter)
    check_force(case)
    bounded.check_problem(data, options.steps, refined)
    read = [_read(data, path, options, refined) for path in options.displacement]
    if case:
        prove(case.solution, f"case {case.name}")
    # The meshes are sorted from coarse to fine, because observed orders are computed between consecutive meshes.
    read.sort(key=lambda pair: -pair[1].h)
    stems = dict.fromkeys(path.stem for path, _ in read)
    store = Store(options.out / "-".join([name, *stems]), written=(".",))
    with store.locked():
        rows = [_row(store, data, case, number, *pair, refined) for number, pair in enumerate(read)]
        table = bounded.levels([one["row"] for one in rows])
        over_time = pd.concat([pd.DataFrame(one["series"]) for one in rows])
        written = bounded.write(store.directory, table, over_time)
        if not isinstance(data, Static) and table["level"].is_unique:
            written += draw_one(store.directory, enclosure("enclosure", over_time, name))
    print(folded(f"written: {listed(written)}"))
    if isinstance(data, Static):
        print("no figure: the figure shows the bounds over time, and a static problem has no time")
    elif not table["level"].is_unique:
        print("no figure: the figure shows one mesh of each size, and two files have meshes of the same size")
    for path, u_h in read:
        print(folded(f"{path}: degree {u_h.degree}, {u_h.mesh.t.shape[1]} triangles, h = {u_h.h:.4g}"))
    sentences = [*rows[-1]["sentences"], *bounded.contact_sentences(data.body)]
    last = pd.DataFrame(rows[-1]["series"])
    names = [path.name for path, _ in read]
    print(f"\n{bounded.text(name, table, last, sentences, bounded.norm_of(data), names)}\n")
    return OK if case is None or all(one["inside"] for one in rows) else FAILED


def _read(data: Data, path: Path, options: argparse.Namespace, refined: Refined) -> tuple[Path, GivenDisplacement]:
    """Read a displacement file and check the displacement.

    Returns:
        The path and the displacement.

    Raises:
        UsageError: there is too little memory to bound the error on this mesh.
    """
    field = fields.read(path, options.field)
    need, room = (estimates.BASE, available())
    per_cell = (estimates.bound(1, refined.refinements, "unstructured") - estimates.BASE) / 2
    need += per_cell * len(field.triangles)
    if need > room:
        served = max(0, int((room - estimates.BASE) / per_cell))
        raise UsageError(
            f"{path} has {len(field.triangles)} triangles, which with --refine {refined.refinements} need about "
            f"{need / GIB:.1f} GiB of memory; {room / GIB:.1f} GiB are available, enough for {served} triangles: take "
            "a coarser mesh, --refine 0, or a machine with more memory"
        )
    return path, given(data, **vars(field), steps=options.steps, nearest=options.nearest)


def _row(
    store: Store, data: Data, case: Case | None, number: int, path: Path, u_h: GivenDisplacement, refined: Refined
) -> dict[str, Any]:
    """Return the results for a displacement file: read them if they are stored, otherwise compute and store them.

    Parameters:
        store: the result directory.
        data, case: the problem, and the case with its exact solution, or None.
        number: number of the file.
        path, u_h: the file and its displacement.
        refined: how the mesh and the time steps are refined for the bound.
    """
    arrays = (u_h.mesh.p, u_h.mesh.t, u_h.times, u_h.nodes)
    content = hashlib.sha256(b"".join(array.tobytes() for array in arrays)).hexdigest()

    def compute() -> dict[str, Any]:
        found = with_progress(str(path), u_h.T, partial(bounded_displacement, data, u_h, refined, case))
        # The level is the number of cells of this size along a side of a square with the area of the body.
        return bounded.record(max(1, round(math.sqrt(u_h.body.measure) / u_h.h)), found)

    cache_key = of_problem(data, case, (content, u_h.steps, u_h.remarks, refined))
    return store.cached(f"displacement-{number}", cache_key, compute)
