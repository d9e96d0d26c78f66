"""Meshes refined towards singular points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from skfem import Mesh

from manufactured.body import Body
from study.fem.mesh.family import MeshError
from study.fem.mesh.geometry import determinants, simplicial_mesh
from study.fem.mesh.segments import distance
from study.fem.mesh.unstructured import Unstructured


@dataclass(frozen=True)
class Graded:
    """Unstructured meshes drawn towards the points c of ``body.refine``.

    x ↦ c + (x − c)(|x − c|/R)^{e−1} for |x − c| < R makes cells of the size h ϱ^{1−1/e} at the distance ϱ from c and
    h^e at c itself. P1 functions then approximate |x − c|^λ in H¹ with the order 1 if 1/e < λ: e = 5/2 serves the
    exponents λ ≥ 1/2 of re-entrant corners and of changes of the boundary condition.

    Sources: I. Babuška, R. B. Kellogg, J. Pitkäranta, Direct and inverse error estimates for finite elements with
    mesh refinements, Numer. Math. 33 (1979) 447–471; T. Apel, Anisotropic finite elements: local estimates and
    applications, Teubner 1999.
    """

    exponent: float = 2.5
    reach: float = 0.5
    name: str = "graded"

    def serves(self, body: Body) -> bool:
        return body.dim == 2 and len(body.refine) > 0

    def __call__(self, body: Body, n: int) -> Mesh:
        if not self.serves(body):
            raise MeshError(
                "a graded mesh needs a 2D body with points to refine towards; list them in `refine`, "
                "or use the unstructured family"
            )
        mesh = Unstructured()(body, n)
        points = mesh.p.copy()
        for point in body.refine:
            centre, radius = np.array(point)[:, None], self.radius(body, point)
            share = np.linalg.norm(mesh.p - centre, axis=0) / radius
            inside = share < 1
            points[:, inside] = centre + (mesh.p - centre)[:, inside] * share[inside] ** (self.exponent - 1)
        if (determinants(points, mesh.t) * determinants(mesh.p, mesh.t) <= 0).any():
            raise MeshError(f"grading turns cells over at the level {n}; take a finer one")
        return simplicial_mesh(points, mesh.t)

    def radius(self, body: Body, point: tuple[float, ...]) -> float:
        """R = ``reach`` × the distance to the parts and interfaces that c is not on, and to other points."""
        centre = np.array(point)
        tolerance = 1e-8 * np.sqrt(body.measure)
        lines = [part for part in (*body.parts, *body.interfaces) if not part.contains(centre, tolerance)]
        distances = [distance(centre[:, None], part.corners)[0] for part in lines]
        distances += [np.linalg.norm(centre - other) for other in body.refine if other != point]
        return self.reach * float(min(distances))
