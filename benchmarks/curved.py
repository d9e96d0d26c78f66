"""An experiment on curved contact boundaries: exact solution on a quarter ring, meshes with straight sides.

A quarter ring, 1/2 ≤ r ≤ 1, is clamped on its outer arc and touches a round shaft with its inner arc Γ3. The exact
displacement of the static problem is, in polar coordinates with y = r − 1/2,

    u_r = (w + y q) φ,   u_θ = (g + y k) φ,   φ(y) = (1 − 2y)²(1 + 4y),
    k = 2 (g − w'),   q = −(p + 2λ(w + g'))/(2μ + λ),

so that σ_rθ = 0 and σ_rr = −p on Γ3. It touches where the gap w is 0, and slides along the shaft by g.

Predicted orders in the energy norm, before the first run: the polygon is O(h²) from the arc.

* Normals of the shaft at the vertices: order 1, as in a polygon. Π^h u satisfies the constraints, and a field that
  does enters the shaft by O(h²).
* Averages of the normals of both edges at a vertex: order 1 on uniform meshes, where they are the same by symmetry. If
  the edges have the lengths a and b, the average is off by the angle (b − a)/2 to first order in h (the radius is 1/2),
  so that u_ν at the vertices is wrong by g (b − a)/2 ~ h, independently from vertex to vertex. Such a boundary value
  costs h · h^{−1/2} in H^{1/2}(Γ3): the distance of the two solutions has order 1/2 on shaken meshes.

In the first run g was 0.1 cos θ, and this distance was too small to show in the error. Now g is cos θ, and the distance
is a column of its own.

Usage: .venv/bin/python -m benchmarks.curved. Writes results/benchmarks/curved.csv.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import scipy.sparse as sps
from numpy.typing import NDArray
from skfem import (
    Basis,
    BilinearForm,
    ElementTriP1,
    ElementVector,
    FacetBasis,
    Functional,
    LinearForm,
    MeshTri,
)
from skfem.helpers import ddot, dot, eye, sym_grad, trace

from study.solve.signorini import Signorini

Array = NDArray[np.float64]
MU, LAM, FRONT, STEP = 1.0, 1.0, 0.9, 1e-30
LEVELS = (8, 16, 32, 64, 128)
SEEDS = 16
"""Shaken meshes of each level; the table has root mean squares over them."""
FILE = Path(__file__).parents[1] / "results" / "benchmarks" / "curved.csv"


def displacement(x: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Return u at points (2, ...); complex points are for derivatives by the complex step."""
    r, theta = np.sqrt(x[0] ** 2 + x[1] ** 2), np.arctan(x[1] / x[0])
    y, beyond, before = (
        r - 0.5,
        np.where(theta.real > FRONT, theta - FRONT, 0),
        np.where(theta.real < FRONT, FRONT - theta, 0),
    )
    w, slope, p = 2 * beyond**4, 8 * beyond**3, 8 * before**2
    g, strain = np.cos(theta), -np.sin(theta)
    q, k = -(p + 2 * LAM * (w + strain)) / (2 * MU + LAM), 2 * (g - slope)
    phi = (1 - 2 * y) ** 2 * (1 + 4 * y)
    radial, angular = (w + y * q) * phi, (g + y * k) * phi
    return np.array([radial * x[0] - angular * x[1], radial * x[1] + angular * x[0]]) / r


def strain(x: Array) -> Array:
    """Return ε(u) at points, (2, 2, ...)."""
    steps = (x.astype(complex) + 1j * STEP * np.eye(2)[j].reshape(2, *(1,) * (x.ndim - 1)) for j in range(2))
    gradient = np.stack([displacement(moved).imag / STEP for moved in steps], axis=1)
    return (gradient + gradient.swapaxes(0, 1)) / 2


def stress(e: Array) -> Array:
    """Return σ for a strain (2, 2, ...)."""
    return 2 * MU * e + LAM * eye(trace(e), 2)


def ring(n: int, seed: int | None) -> MeshTri:
    """Return a mesh of the quarter ring, n × n/2 cells cut by one diagonal, with random vertices if a seed is given."""
    mesh = MeshTri.init_tensor(np.linspace(0, 1, n + 1), np.linspace(0, 1, n // 2 + 1))
    s, t = mesh.p.copy()
    if seed is not None:
        shift = np.random.default_rng((n, seed)).uniform(-0.25, 0.25, (2, s.size))
        s += shift[0] / n * ((s > 0) & (s < 1))
        t += shift[1] / (n // 2) * ((t > 0) & (t < 1))
    r, theta = (1 + t) / 2, np.pi / 2 * s
    return MeshTri(np.array([r * np.cos(theta), r * np.sin(theta)]), mesh.t)


def normals(mesh: MeshTri, vertices: Array, averaged: bool) -> Array:
    """Return the outward normals at the vertices of Γ3, in the order of their angles, (2, m)."""
    points = mesh.p[:, vertices]
    if not averaged:
        return -points / np.linalg.norm(points, axis=0)
    along = np.diff(points, axis=1)
    of_edges = np.array([-along[1], along[0]]) / np.linalg.norm(along, axis=0)
    mean = np.hstack([of_edges[:, :1], (of_edges[:, 1:] + of_edges[:, :-1]) / 2, of_edges[:, -1:]])
    return mean / np.linalg.norm(mean, axis=0)


@BilinearForm
def energy(u, v, _):  # type: ignore[no-untyped-def]
    return ddot(stress(sym_grad(u)), sym_grad(v))


@LinearForm
def inner_work(v, w):  # type: ignore[no-untyped-def]
    return ddot(stress(strain(w.x)), sym_grad(v))


@LinearForm
def contact_work(v, w):  # type: ignore[no-untyped-def]
    traction = np.einsum("ij...,j...->i...", stress(strain(w.x)), w.n)
    return dot(traction, v)


@Functional
def squared_error(w):  # type: ignore[no-untyped-def]
    e = strain(w.x) - sym_grad(w["u"])
    return ddot(stress(e), e)


def errors(n: int, seed: int | None) -> list[dict[str, float]]:
    """Return ‖u − u_h‖, ‖Π^h u − u_h‖ and the distance to u_h with exact normals; for exact, then averaged normals."""
    mesh = ring(n, seed)
    basis = Basis(mesh, ElementVector(ElementTriP1()), intorder=6)
    radius = np.linalg.norm(mesh.p, axis=0)
    vertices = np.flatnonzero(radius < 0.5 + 1e-9)
    vertices = vertices[np.argsort(np.arctan2(mesh.p[1, vertices], mesh.p[0, vertices]))]
    facets = mesh.facets_satisfying(lambda x: np.linalg.norm(x, axis=0) < 0.5 + 1e-9, boundaries_only=True)
    facets = np.intersect1d(facets, [f for f in mesh.boundary_facets() if np.isin(mesh.facets[:, f], vertices).all()])
    K = energy.assemble(basis)
    load = inner_work.assemble(basis) - contact_work.assemble(FacetBasis(mesh, basis.elem, facets=facets, intorder=6))
    free = np.setdiff1d(np.arange(K.shape[0]), basis.nodal_dofs[:, radius > 1 - 1e-9])
    S = K[np.ix_(free, free)].tocsc()
    interpolant = np.zeros(K.shape[0])
    interpolant[basis.nodal_dofs] = displacement(mesh.p.astype(complex) + [[1e-300], [0]]).real
    found, solutions = [], []
    for averaged in (False, True):
        N = sps.lil_array((vertices.size, K.shape[0]))
        for row, (vertex, nu) in enumerate(zip(vertices, normals(mesh, vertices, averaged).T, strict=True)):
            N[row, basis.nodal_dofs[:, vertex]] = nu
        u = np.zeros(K.shape[0])
        u[free], _ = Signorini(S, N.tocsr()[:, free])(load[free])
        solutions.append(u)
        discrete, apart = ((v - u) @ K @ (v - u) for v in (interpolant, solutions[0]))
        error = squared_error.assemble(basis, u=u)
        found.append({"error": error**0.5, "discrete_error": discrete**0.5, "distance": apart**0.5})
    return found


def main() -> None:
    """Measure all variants and write the table."""
    rows = []
    for meshes in ("uniform", "shaken"):
        for n in LEVELS:
            seeds = range(SEEDS) if meshes == "shaken" else [None]
            measured = [errors(n, seed) for seed in seeds]
            for number, kind in enumerate(("exact", "averaged")):
                means = (pd.DataFrame([found[number] for found in measured]) ** 2).mean() ** 0.5
                rows.append({"meshes": meshes, "normals": kind, "n": n} | means.map("{:.4g}".format).to_dict())
                print(rows[-1])
    FILE.parent.mkdir(parents=True, exist_ok=True)
    pd.DataFrame(rows).to_csv(FILE, index=False, lineterminator="\n")


if __name__ == "__main__":
    main()
