"""Random static problems with rollers, prescribed displacements and holes, two of the three at least.

The reference is another program: scikit-fem with quadratic triangles on a mesh that is refined three times. Its
displacement is the best one on this mesh, so that its distance from u_h is at most the error, and hardly less.

    python -m benchmarks.trials.supports FILE.csv
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import sympy as sp
from skfem import Basis, ElementTriP2, ElementVector, FacetBasis, LinearForm, condense, solve
from skfem.helpers import dot
from skfem.models.elasticity import linear_elasticity

from benchmarks.trials.record import made
from manufactured import Data, Kind, isotropic, polygon, static
from manufactured.factor import x1, x2
from study.bound.bounded import BoundedSolution, bounded_solution
from study.bound.trajectory import Refined
from study.fem.mesh import Unstructured
from study.solve.tableau import MIDPOINT

COUNT, LEVEL, FINER = 200, 2, 3
MU, LAM = 1.0, 1.5
SLACK = 1e-6
"""Relative slack for the quadrature of the reference and for rounding."""
FEATURES = ("rp", "rh", "ph", "rph")
"""What problems have in turn: rollers, prescribed displacements and holes, by their first letters."""


def random_problem(seed: int) -> Data:
    """Return a random problem with the features whose turn it is."""
    rng, features = np.random.default_rng([67, seed]), FEATURES[seed % 4]
    wide, tall = rng.uniform(0.8, 2.5, 2)
    upper = wide + rng.uniform(-0.3, 0.3)
    corners = [(0, 0), (wide, 0), (upper, tall), (0, tall)]
    kinds, holes = [Kind.CLAMPED, Kind.LOADED, Kind.LOADED, Kind.LOADED], []
    if "r" in features:
        kinds[0] = kinds[3] = Kind.ROLLER
        if rng.random() < 0.5:
            kinds[3 * int(rng.integers(2))] = Kind.CLAMPED
    if "p" in features and rng.random() < 0.5:
        kinds[2] = Kind.ROLLER if rng.random() < 0.5 else Kind.CLAMPED
    if "h" in features:
        middle = rng.uniform(0.4, 0.55, 2) * (wide, tall)
        angles = -(rng.uniform(0, 0.6, 5) + np.arange(5)) * 2 * np.pi / 5
        reach = rng.uniform(0.15, 0.25) * min(wide, tall)
        around = np.array([np.cos(angles), np.sin(angles)]).T
        holes = [(middle + reach * around, [Kind.LOADED] * 5)]
    body = polygon(corners, kinds, holes=holes)
    loaded = [i for i, part in enumerate(body.parts) if part.kind is Kind.LOADED and rng.random() < 0.5]
    a = rng.normal(size=20).round(3)
    wave = a[6] * sp.sin(float(a[7]) * x1 + x2) if rng.random() < 0.2 else 0
    f0 = a[0] + a[1] * x2 + wave, a[2] * x1
    f2 = dict.fromkeys(loaded, (a[3] + a[4] * x1 * x2, a[5]))
    if "p" not in features:
        return static(body, isotropic(MU, LAM), f0, f2)
    motion = a[8] + a[9] * x1 + a[10] * x2, a[11] + a[12] * x1 + a[13] * x2
    held = [i for i, part in enumerate(body.parts) if part.kind is not Kind.LOADED]
    return static(body, isotropic(MU, LAM), f0, f2, dict.fromkeys(held, motion))


def reference(data: Data, found: BoundedSolution) -> tuple[float, float]:
    """Return the distance of u_h from the displacement of scikit-fem, and the norm of the latter."""
    mesh, nodal = found.computed.own_mesh, found.computed.nodal(0.0).reshape(-1, 2)
    for _ in range(FINER):
        # A refined mesh has the old vertices, then the midpoints of the edges.
        nodal, mesh = np.vstack([nodal, nodal[mesh.facets].mean(axis=0)]), mesh.refined()
    element = ElementVector(ElementTriP2())
    basis = Basis(mesh, element, intorder=6)
    load = LinearForm(lambda v, w: dot(data.body_force(np.asarray(w.x))(0.0), v)).assemble(basis)
    u, fixed = np.zeros(basis.N), []
    for part in data.body.parts:
        facets = mesh.facets_satisfying(lambda x, part=part: part.contains(np.asarray(x), 1e-8), boundaries_only=True)
        if part.kind is Kind.LOADED:
            traction = LinearForm(lambda v, w, part=part: dot(data.surface_load(part, np.asarray(w.x))(0.0), v))
            load += traction.assemble(FacetBasis(mesh, element, facets=facets, intorder=6))
            continue
        for component in range(2):
            if part.kind is Kind.CLAMPED or abs(part.normal[component]) > 0.5:
                dofs = basis.get_dofs(facets).all([f"u^{component + 1}"])
                u[dofs] = part.prescribed(basis.doflocs[:, dofs])[component]
                fixed.append(dofs)
    K = linear_elasticity(LAM, MU).assemble(basis)
    held = np.unique(np.concatenate(fixed))
    u = solve(*condense(K, load, x=u, D=held))
    difference = u.copy()
    difference[basis.nodal_dofs] -= nodal.T
    difference[basis.facet_dofs] -= nodal[mesh.facets].mean(axis=0).T
    return float(np.sqrt(difference @ K @ difference)), float(np.sqrt(u @ K @ u))


def row(seed: int) -> dict[str, Any]:
    """Return one trial: the intervals of the error and of the norm, the reference, and whether they agree."""
    data = random_problem(seed)
    found = bounded_solution(data, None, Unstructured(seed=seed), LEVEL, MIDPOINT, 1, Refined(1, 1))
    numbers, inside = {"has": FEATURES[seed % 4]}, True
    for name, known, (low, high) in zip(
        ("error", "norm"), reference(data, found), (found.error, found.norm), strict=True
    ):
        numbers |= {name: known, f"{name}_low": low, f"{name}_high": high}
        inside &= low * (1 - SLACK) <= known <= high * (1 + SLACK)
    return numbers | {"kind": found.enclosure.evidence.kind, "inside": inside}


if __name__ == "__main__":
    print(made(Path(sys.argv[1]), range(COUNT), row)["inside"].value_counts())
