"""``study bound --displacement``: encloses the errors of displacements that other programs have computed."""

import argparse
import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from manufactured.case import Case
from manufactured.data import Data
from study.bound import bounded, fields
from study.bound.given import bounded_displacement, given
from study.bound.trajectory import Computed, Refined
from study.cli.common import with_progress
from study.cli.problem import MeshInTime
from study.ledger.files import Json
from study.run.executor import require_bound
from study.run.fingerprint import of_problem


@dataclass(frozen=True)
class Displacement:
    """A displacement on one mesh whose error is to be enclosed.

    Attributes:
        key, cache_key: name and cache key of the result.
        compute: function that computes the displacement, unless it is given, and encloses its error.
        files: files that ``compute`` writes.
        shown: function that returns mesh and displacements for the picture, as ``study.cli.problem`` takes them.
        file_name, remark: name of the file with the given displacement, and a line about its content; empty if the
            displacement is computed.
    """

    key: str
    cache_key: str
    compute: Callable[[], Json]
    files: tuple[Path, ...]
    shown: Callable[[], MeshInTime]
    file_name: str = ""
    remark: str = ""


def displacements_in_files(
    options: argparse.Namespace, name: str, data: Data, case: Case | None, refined: Refined
) -> tuple[Path, list[Displacement]]:
    """Return the result directory, and the displacements in the files of --displacement, from coarse to fine meshes.

    Parameters:
        options: the options of the command.
        name, data, case: name and data of the problem, and the case with its exact solution, or None.
        refined: how the mesh and the time steps are refined for the bound.
    """
    bounded.check_problem(data, options.steps, refined)
    read = [(path, _read(data, path, options, refined)) for path in options.displacement]
    # The meshes are sorted, because observed orders are computed between consecutive meshes.
    read.sort(key=lambda pair: -pair[1].h)

    def displacement(number: int, path: Path, u_h: Computed) -> Displacement:
        def compute() -> Json:
            found = with_progress(str(path), u_h.T, partial(bounded_displacement, data, u_h, refined, case))
            return bounded.record(u_h.level, found)

        arrays = (u_h.mesh.p, u_h.mesh.t, u_h.times, u_h.nodes)
        content = hashlib.sha256(b"".join(array.tobytes() for array in arrays)).hexdigest()
        cache_key = of_problem(data, case, (content, u_h.steps, u_h.remarks, refined))
        remark = f"{path}: degree {u_h.degree}, {u_h.mesh.t.shape[1]} triangles, h = {u_h.h:.4g}"

        def shown() -> MeshInTime:
            return (u_h.mesh.p, u_h.mesh.t), (u_h.times, u_h.at_vertices)

        return Displacement(f"displacement-{number}", cache_key, compute, (), shown, path.name, remark)

    directory = options.out / "-".join([name, *dict.fromkeys(path.stem for path, _ in read)])
    return directory, [displacement(number, *pair) for number, pair in enumerate(read)]


def _read(data: Data, path: Path, options: argparse.Namespace, refined: Refined) -> Computed:
    """Read a displacement file, check the displacement, and return it.

    Raises:
        UsageError: there is too little memory to bound the error on this mesh, or the mesh has too many triangles.
    """
    field = fields.read(path, options.field, options.step)
    cells = len(field.triangles)
    what = f"{path} with {cells} triangles and --refine {refined.refinements}"
    require_bound(what, cells, refined.refinements)
    return given(data, **vars(field), steps=options.steps, nearest=options.nearest)
