"""Random static problems with rollers, prescribed displacements and holes, two of the three at least.

The reference is another program: scikit-fem with quadratic triangles on a mesh that is refined three times. Its
displacement is the best one on this mesh, so that its distance from u_h is at most the error, and hardly less.

    python -m benchmarks.trials.supports FILE.csv [COUNT]
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import sympy as sp
from skfem import Basis, ElementTriP2, ElementVector, Mesh, condense, solve
from skfem.assembly import BilinearForm, FacetBasis, LinearForm
from skfem.helpers import ddot, dot, eye, sym_grad, trace

from benchmarks.trials.record import made
from manufactured import Data, Kind, isotropic, polygon, static
from manufactured.body import Part
from manufactured.factor import x1, x2
from manufactured.tensors import Array
from study.bound.bounded import BoundedSolution, bounded_solution
from study.bound.trajectory import Refined
from study.fem.mesh import Unstructured
from study.solve.tableau import MIDPOINT

COUNT, LEVEL, FINER = 200, 2, 3
MU, LAM = 1.0, 1.5
SLACK = 1e-6
"""Relative slack for the quadrature of the reference and for rounding."""


def random_problem(seed: int) -> tuple[Data, tuple[bool, bool, bool]]:
    """Return a random problem, and whether it has rollers, prescribed displacements and holes."""
    rng = np.random.default_rng([67, seed])
    features = [(True, True, False), (True, False, True), (False, True, True), (True, True, True)][seed % 4]
    rollers, moved, hollow = features
    wide, tall = rng.uniform(0.8, 2.5, 2)
    slant = rng.uniform(-0.3, 0.3)
    corners = [(0, 0), (wide, 0), (wide + slant, tall), (0, tall)]
    kinds = [Kind.ROLLER, Kind.LOADED, Kind.LOADED, Kind.ROLLER] if rollers else [Kind.CLAMPED, *[Kind.LOADED] * 3]
    if rollers and rng.random() < 0.5:
        kinds[3 * int(rng.integers(2))] = Kind.CLAMPED
    if moved and rng.random() < 0.5:
        kinds[2] = Kind.ROLLER if rng.random() < 0.5 else Kind.CLAMPED
    holes = []
    if hollow:
        x, y = rng.uniform(0.4, 0.55) * wide, rng.uniform(0.4, 0.55) * tall
        angles = -(rng.uniform(0, 0.6, 5) + np.arange(5)) * 2 * np.pi / 5
        reach = rng.uniform(0.15, 0.25) * min(wide, tall)
        points = [(x + reach * np.cos(a), y + reach * np.sin(a)) for a in angles]
        holes = [(points, [Kind.LOADED] * 5)]
    body = polygon(corners, kinds, holes=holes)
    loads = [i for i, part in enumerate(body.parts) if part.kind is Kind.LOADED and rng.random() < 0.5]
    a = np.round(rng.normal(size=20), 3)
    wave = a[6] * sp.sin(float(a[7]) * x1 + x2) if rng.random() < 0.2 else 0
    f0 = (a[0] + a[1] * x2 + wave, a[2] * x1)
    f2 = {i: (a[3] + a[4] * x1 * x2, a[5]) for i in loads}
    return static(body, isotropic(MU, LAM), f0, f2, prescribed(body, a, moved)), features


def prescribed(body: Any, a: Array, moved: bool) -> dict[int, tuple[sp.Expr, sp.Expr]]:
    """Return one linear motion on the roller or clamped sides that meet, and perhaps another one on the upper side."""
    if not moved:
        return {}
    motion = a[8] + a[9] * x1 + a[10] * x2, a[11] + a[12] * x1 + a[13] * x2
    held = [i for i, part in enumerate(body.parts) if part.kind in (Kind.CLAMPED, Kind.ROLLER)]
    return dict.fromkeys(held, motion)


@BilinearForm
def stiffness(u, v, w):
    strain = sym_grad(u)
    return ddot(2 * MU * strain + LAM * eye(trace(strain), 2), sym_grad(v))


def reference(data: Data, found: BoundedSolution) -> tuple[float, float]:
    """Return the distance of u_h from the displacement of scikit-fem, and the norm of the latter."""
    mesh, nodal = found.computed.own_mesh, found.computed.nodal(0.0).reshape(-1, 2)
    for _ in range(FINER):
        # A refined mesh has the old vertices, then the midpoints of the edges.
        nodal, mesh = np.vstack([nodal, nodal[mesh.facets].mean(axis=0)]), mesh.refined()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=6)
    force = LinearForm(lambda v, w: dot(data.body_force(np.asarray(w.x))(0.0), v))
    load = force.assemble(basis)
    fixed, values = [], np.zeros(basis.N)
    for part in data.body.parts:
        facets = boundary(mesh, part)
        if part.kind is Kind.LOADED:
            traction = LinearForm(lambda v, w, part=part: dot(data.surface_load(part, np.asarray(w.x))(0.0), v))
            load += traction.assemble(FacetBasis(mesh, ElementVector(ElementTriP2()), facets=facets, intorder=6))
            continue
        for component in range(2):
            if part.kind is Kind.CLAMPED or abs(part.normal[component]) > 0.5:
                dofs = basis.get_dofs(facets).all([f"u^{component + 1}"])
                values[dofs] = part.prescribed(basis.doflocs[:, dofs])[component]
                fixed.append(dofs)
    K = stiffness.assemble(basis)
    u = solve(*condense(K, load, x=values, D=np.unique(np.concatenate(fixed))))
    difference = u.copy()
    difference[basis.nodal_dofs] -= nodal.T
    difference[basis.facet_dofs] -= nodal[mesh.facets].mean(axis=0).T
    return float(np.sqrt(difference @ K @ difference)), float(np.sqrt(u @ K @ u))


def boundary(mesh: Mesh, part: Part) -> Array:
    """Return the boundary facets of a mesh on a side."""
    return mesh.facets_satisfying(lambda x: part.contains(np.asarray(x), 1e-8), boundaries_only=True)


def row(seed: int) -> dict[str, Any]:
    """Return one trial: what the problem has, the interval and the reference, and whether they agree."""
    data, features = random_problem(seed)
    found = bounded_solution(data, None, Unstructured(seed=seed), LEVEL, MIDPOINT, 1, Refined(1, 1))
    error, norm = reference(data, found)
    (low, high), (least, most) = found.error, found.norm
    inside = low * (1 - SLACK) <= error <= high * (1 + SLACK) and least * (1 - SLACK) <= norm <= most * (1 + SLACK)
    names = "".join(letter for letter, present in zip("rph", features, strict=True) if present)
    numbers = dict(low=low, error=error, high=high, least=least, norm=norm, most=most)
    shown = {name: float(f"{value:.6g}") for name, value in numbers.items()}
    return {"has": names, **shown, "kind": found.enclosure.evidence.kind, "inside": inside}


if __name__ == "__main__":
    trials = made(Path(sys.argv[1]), range(int(sys.argv[2]) if len(sys.argv) > 2 else COUNT), row)
    print(trials["inside"].value_counts(), (trials["high"] / trials["error"]).describe())
