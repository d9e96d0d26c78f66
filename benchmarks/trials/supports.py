"""Random static problems with rollers, prescribed displacements and holes, at least two of the three in each.

The reference is the displacement of another program, scikit-fem with quadratic triangles, on a mesh that is refined
three times. It is the best displacement on this mesh, so its distance from u_h is at most the error, and hardly less.

    python -m benchmarks.trials.supports FILE.csv
"""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import sympy as sp
from skfem import Basis, ElementTriP2, ElementVector, FacetBasis, LinearForm, Mesh, condense, solve
from skfem.helpers import dot
from skfem.models.elasticity import linear_elasticity

from benchmarks.trials.record import made
from manufactured import Body, Data, Kind, isotropic, polygon, static
from manufactured.factor import x1, x2
from study.bound.bounded import bounded_solution
from study.bound.trajectory import Refined
from study.fem.mesh import Unstructured
from study.solve.tableau import MIDPOINT

COUNT, LEVEL, FINER = 200, 3, 3
MU, LAM = 1.0, 1.5
SLACK = 1e-6
"""Relative slack for the quadrature of the reference and for rounding."""
FEATURES = ("rp", "rh", "ph", "rph")
"""What problems have in turn: rollers, prescribed displacements and holes, by their first letters."""


def random_body(rng: np.random.Generator, features: str) -> Body:
    """Return a random quadrilateral with supports, and perhaps with a hole of five corners."""
    wide, tall = rng.uniform(0.8, 2.5, 2)
    corners = [(0, 0), (wide, 0), (wide + rng.uniform(-0.3, 0.3), tall), (0, tall)]
    left = Kind.ROLLER if "r" in features else Kind.CLAMPED
    below, above = rng.choice([Kind.ROLLER, Kind.CLAMPED]), rng.choice([Kind.ROLLER, Kind.LOADED])
    kinds = [below, Kind.LOADED, above if "r" in features else Kind.LOADED, left]
    if "h" not in features:
        return polygon(corners, kinds)
    clockwise = -(rng.uniform(0, 0.6, 5) + np.arange(5)) * 2 * np.pi / 5
    middle = rng.uniform(0.4, 0.55, 2) * (wide, tall)
    reach = rng.uniform(0.15, 0.25) * min(wide, tall)
    around = middle + reach * np.array([np.cos(clockwise), np.sin(clockwise)]).T
    return polygon(corners, kinds, holes=[(around, [Kind.LOADED] * 5)])


def random_problem(seed: int) -> Data:
    """Return a random problem with the features whose turn it is."""
    rng = np.random.default_rng([67, seed])
    features = FEATURES[seed % len(FEATURES)]
    body = random_body(rng, features)
    a = rng.normal(size=10).round(3)
    wave = sp.sin(3 * x1 + a[0] * x2) if rng.random() < 0.3 else 0
    motion = a[1] * x1 + a[2] * x2, a[3] + a[4] * x1
    force = a[5] + wave, a[6] * x1
    traction = a[7] + a[8] * x1 * x2, a[9] + wave
    loaded = [i for i, part in enumerate(body.parts) if part.kind is Kind.LOADED]
    held = set(range(len(body.parts))) - set(loaded) if "p" in features else ()
    return static(body, isotropic(MU, LAM), force, dict.fromkeys(loaded, traction), dict.fromkeys(held, motion))


def reference(data: Data, mesh: Mesh, nodal: np.ndarray) -> tuple[float, float]:
    """Return the distance of a P1 displacement from the displacement of scikit-fem, and the norm of the latter."""
    for _ in range(FINER):
        # A refined mesh has the old vertices, then the midpoints of the edges.
        nodal, mesh = np.vstack([nodal, nodal[mesh.facets].mean(axis=0)]), mesh.refined()
    element = ElementVector(ElementTriP2())
    basis = Basis(mesh, element, intorder=6)
    K = linear_elasticity(LAM, MU).assemble(basis)
    load = LinearForm(lambda v, w: dot(data.body_force(np.asarray(w.x))(0.0), v)).assemble(basis)
    u = np.zeros(basis.N)
    held = np.zeros(basis.N, dtype=bool)
    for part in data.body.parts:
        facets = mesh.facets_satisfying(partial(part.contains, tolerance=1e-8), boundaries_only=True)
        if part.kind is Kind.LOADED:
            traction = LinearForm(lambda v, w, part=part: dot(data.surface_load(part, np.asarray(w.x))(0.0), v))
            load += traction.assemble(FacetBasis(mesh, element, facets=facets, intorder=6))
            continue
        for component in range(2):
            if part.kind is Kind.CLAMPED or abs(part.normal[component]) > 0.5:
                dofs = basis.get_dofs(facets).all([f"u^{component + 1}"])
                u[dofs], held[dofs] = part.prescribed(basis.doflocs[:, dofs])[component], True
    u = solve(*condense(K, load, x=u, D=np.flatnonzero(held)))
    difference = u.copy()
    difference[basis.nodal_dofs] -= nodal.T
    difference[basis.facet_dofs] -= nodal[mesh.facets].mean(axis=0).T
    return float(np.sqrt(difference @ K @ difference)), float(np.sqrt(u @ K @ u))


def row(seed: int) -> dict[str, Any]:
    """Return one trial: the intervals of the error and of the norm, the reference, and whether they agree."""
    data = random_problem(seed)
    found = bounded_solution(data, None, Unstructured(seed=seed), LEVEL, MIDPOINT, 1, Refined(1, 1))
    error, norm = reference(data, found.computed.mesh, found.computed.at(0.0).reshape(-1, 2))
    pairs = (error, found.error), (norm, found.norm)
    inside = all(low * (1 - SLACK) <= known <= high * (1 + SLACK) for known, (low, high) in pairs)
    return {
        "has": FEATURES[seed % len(FEATURES)],
        "error": error,
        "error_high": found.error[1],
        "norm": norm,
        "kind": found.enclosure.evidence.kind,
        "inside": inside,
    }


if __name__ == "__main__":
    print(made(Path(sys.argv[1]), range(COUNT), row)["inside"].value_counts())
