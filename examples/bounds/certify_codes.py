"""Prove bounds of the errors of contact codes: their displacements in certificates that a small program checks.

    python examples/bounds/certify_codes.py [--only ADAPTER ...] [--levels N ...]

A certificate has a displacement ũ, stresses and constants, from which the checker bounds the error of ũ in integers.
This part does not depend on the computed displacement u_h. So the displacement of any code can stand in the place of
u_h, if it is P1 on the mesh of the certificate, has equal time steps, and is exactly 0 on Γ1. The problem is ``wedge``
of examples/certificates. Needs the codes that `make codes` needs; displacements in build/certificates-of-codes/fields
are used again. Writes results/codes/certified.csv and one certificate for each code, method and mesh
in build/certificates-of-codes.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from judge_codes import NAMES, ROOT, export, run_codes, task

from manufactured.data import Data
from study.bound import fields
from study.bound.discretisation import Discretisation
from study.bound.enclosing import Enclosure, enclose
from study.bound.given import given
from study.bound.problem import BoundError
from study.bound.trajectory import Refined
from study.certify import checker
from study.certify.certified import make_certificate, write
from study.certify.statement import in_doubles
from study.fem.mesh import Unstructured
from study.ledger.files import write_text
from study.ledger.text import interval
from study.solve.tableau import MIDPOINT

sys.path.insert(0, str(ROOT / "examples" / "certificates"))
from problems import wedge

BUILD, TABLE = ROOT / "build" / "certificates-of-codes", ROOT / "results" / "codes" / "certified.csv"
LEVELS, BETTER = (4, 8), Refined(1, 1)
"""The levels, which are also the numbers of time steps, and how ũ is computed."""
MOVED = 1e-9
"""Distance up to which vertices in a file count as those of the certificate, whose coordinates are fractions."""
SHOWN = 4


def certificate(data: Data, level: int) -> dict[str, Any]:
    """Return the certificate of the displacement of this study, from disk or computed."""
    path = BUILD / f"certificate-{level}.json.gz"
    if not path.exists():
        write(path, make_certificate(data, Unstructured(), level, MIDPOINT, level, BETTER))
    found: dict[str, Any] = checker.load(path)
    return found


def in_place(proof: dict[str, Any], path: Path) -> dict[str, Any]:
    """Return a certificate whose computed displacement is the one in a file.

    Raises:
        BoundError: the file has another mesh, or other times than equal steps.
    """
    field = fields.read(path)
    mesh = in_doubles(checker.Mesh.of(proof["mesh"], checker.Problem(proof["problem"])))
    if field.points.shape != mesh.p.T.shape or abs(field.points - mesh.p.T).max() > MOVED:
        raise BoundError(f"{path} has other vertices than the mesh of the certificate")
    if not np.array_equal(*(np.sort(np.sort(cells), axis=0) for cells in (field.triangles, mesh.t.T))):
        raise BoundError(f"{path} has other triangles than the mesh of the certificate")
    if field.times is None or abs(np.diff(field.times, n=2)).max() > MOVED:
        raise BoundError(f"{path} has unequal time steps, and certificates need equal ones")
    # The checker itself refuses a displacement that is not exactly 0 on Γ1.
    return proof | {"computed": field.u.reshape(len(field.u), -1).tolist()}


def in_doubles_bounded(data: Data, proof: dict[str, Any], paths: list[Path]) -> list[Enclosure]:
    """Return the bounds of ``study bound`` for the files, with ũ on the same mesh and with the same steps."""
    computed = [given(data, **vars(fields.read(path)), steps=len(proof["computed"]) - 1) for path in paths]
    coarse = Discretisation(data, computed[0].mesh)
    return [enclose(coarse, u_h, BETTER) for u_h in computed]


def rows_of(data: Data, level: int, names: list[str]) -> list[dict[str, Any]]:
    """Return a row for each displacement on the mesh of a level, after writing and checking its certificate."""
    proof = certificate(data, level)
    mesh = in_doubles(checker.Mesh.of(proof["mesh"], checker.Problem(proof["problem"])))
    export(task("wedge-mesh", data, mesh, level), level, BUILD)
    run_codes(names, BUILD)
    paths = [path for name in names for path in sorted((BUILD / "fields").glob(f"{name}-{level}-*.npz"))]
    rows = []
    for path, bounded in zip(paths, in_doubles_bounded(data, proof, paths), strict=True):
        found = in_place(proof, path)
        write(BUILD / f"certificate-{path.stem}.json.gz", found)
        proved = checker.verified(found)
        with np.load(path) as arrays:
            code, version, method = arrays["name"].tolist()
        ends = (float(checker.decimal(end, above)) for end, above in ((proved.low, False), (proved.high, True)))
        numbers = dict(zip(("proved_low", "proved_high"), ends, strict=True))
        numbers |= {"lowest": round(bounded.lowest, 9), "highest": round(bounded.highest, 9)}
        mesh_of = {"level": level, "h": bounded.h, "cells": proved.cells}
        rows.append({"code": code, "version": version, "method": method} | mesh_of | numbers)
        print(f"{path.stem}: {interval(*list(numbers.values())[:2], SHOWN)}", flush=True)
    return rows


def main() -> None:
    """Run the codes, check the certificates of their displacements, and write the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", metavar="ADAPTER", default=list(NAMES))
    parser.add_argument("--levels", nargs="+", type=int, metavar="N", default=list(LEVELS))
    options = parser.parse_args()
    BUILD.mkdir(parents=True, exist_ok=True)
    found = pd.DataFrame([row for level in options.levels for row in rows_of(wedge(), level, options.only)])
    write_text(TABLE, found.to_csv(index=False))


if __name__ == "__main__":
    main()
