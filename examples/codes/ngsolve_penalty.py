"""NGSolve: a penalty energy on Γ3, once as a boundary term and once by its ContactBoundary with a meshed foundation.

NGSolve has no method for contact with multipliers of its own; the penalty is what its documentation shows. g = C_νννν.
"""

from __future__ import annotations

from functools import partial

import netgen.meshing as nm
import ngsolve as ng
import numpy as np
from common import CannotExpressError, forces, normal_modulus, voigt
from contact_judge import Task

CODE, VERSION = "NGSolve", ng.__version__
ng.ngsglobals.msg_level = 0
MARGIN = 0.25


def meshed(task: Task, foundation: bool) -> ng.Mesh:
    """The mesh with the boundaries clamped, contact, loaded and, below each piece, a slab of one segment if wanted."""
    if task.dim != 2:
        raise CannotExpressError("this adapter is for the plane")
    mesh, names = nm.Mesh(dim=2), ["clamped", "contact", "free", "foundation", "slab"]
    points = [mesh.Add(nm.MeshPoint(nm.Pnt(x, y, 0))) for x, y in task.vertices]
    body = mesh.Add(nm.FaceDescriptor(surfnr=1, domin=1, bc=1))
    mesh.SetMaterial(1, "body")
    for cell in task.cells:
        mesh.Add(nm.Element2D(body, [points[v] for v in cell]))
    edges = {}
    for cell in task.cells.tolist():
        for a, b in zip(cell, [*cell[1:], cell[0]], strict=True):
            edges[frozenset((a, b))] = None if frozenset((a, b)) in edges else (a, b)
    contact = {frozenset(facet) for piece in task.data["contact"] for facet in piece["facets"]}
    clamped = set(task.clamped.tolist())
    for edge in filter(None, edges.values()):
        kind = 2 if frozenset(edge) in contact else 1 if set(edge) <= clamped else 3
        mesh.Add(nm.Element1D([points[v] for v in edge], index=kind))
    if foundation:
        mesh.Add(nm.FaceDescriptor(surfnr=2, domin=1, bc=1))
        mesh.SetMaterial(2, "slab")
        for piece in task.data["contact"]:
            _slab(mesh, task.vertices[np.unique(piece["facets"])], np.array(piece["normal"]))
    for number, name in enumerate(names):
        mesh.SetBCName(number, name)
    return ng.Mesh(mesh)


def _slab(mesh: nm.Mesh, face: np.ndarray, normal: np.ndarray) -> None:
    """Two triangles that touch a face and are longer than it."""
    along = np.array([-normal[1], normal[0]])
    s = face @ along
    length = np.ptp(s)
    ends = [face[0] + (t - s[0]) * along for t in (s.min() - MARGIN * length, s.max() + MARGIN * length)]
    corners = np.array([*ends, ends[1] + MARGIN * length * normal, ends[0] + MARGIN * length * normal])
    # Along × ν is negative, so that the corners run clockwise.
    p = [mesh.Add(nm.MeshPoint(nm.Pnt(x, y, 0))) for x, y in corners]
    for triangle in ((0, 2, 1), (0, 3, 2)):
        mesh.Add(nm.Element2D(2, [p[i] for i in triangle]))
    for a, b, kind in ((1, 0, 4), (2, 1, 5), (3, 2, 5), (0, 3, 5)):
        mesh.Add(nm.Element1D([p[a], p[b]], index=kind))


def problem(task: Task, mesh: ng.Mesh) -> tuple[ng.VectorH1, ng.BilinearForm]:
    """V^h and the form of elasticity; the slab is held."""
    fes = ng.VectorH1(mesh, order=1, dirichlet="clamped|foundation|slab")
    constants, C = ng.L2(mesh, order=0), voigt(task)
    cf = {}
    for i, j in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)):
        field = ng.GridFunction(constants)
        field.vec.FV().NumPy()[:] = np.append(C[:, i, j], np.full(mesh.ne - len(C), C[:, i, j].max()))
        cf[i, j] = cf[j, i] = field
    u, v = fes.TnT()

    def strain(w):
        g = ng.Grad(w)
        return [g[0, 0], g[1, 1], g[0, 1] + g[1, 0]]

    e, d = strain(u), strain(v)
    a = ng.BilinearForm(fes)
    a += sum(cf[i, j] * e[i] * d[j] for i in range(3) for j in range(3)) * ng.dx
    return fes, a


def newton(task: Task, fes, a, before=None):
    """step(b, s0) ↦ u by Newton's method, started anew for each step."""
    n, count = len(task.vertices), fes.mesh.nv
    u = ng.GridFunction(fes)

    def step(load: np.ndarray, stress: np.ndarray) -> np.ndarray:
        b, f, r, w = forces(task, load, stress), u.vec.CreateVector(), u.vec.CreateVector(), u.vec.CreateVector()
        f[:], u.vec[:] = 0.0, 0.0
        for axis in range(2):
            f.FV().NumPy()[axis * count : axis * count + n] = b[:, axis]
        free = np.array([fes.FreeDofs()[i] for i in range(fes.ndof)])
        for _ in range(60):
            if before:
                before(u, a)
            a.Apply(u.vec, r)
            r.data -= f
            if np.linalg.norm(r.FV().NumPy()[free]) <= 1e-12 * np.linalg.norm(b):
                break
            a.AssembleLinearization(u.vec)
            w.data = a.mat.Inverse(fes.FreeDofs(), inverse="sparsecholesky") * r
            u.vec.data -= w
            step.solves += 1
        values = u.vec.FV().NumPy()
        return np.stack([values[axis * count : axis * count + n] for axis in range(2)], axis=1)

    step.solves = 0
    return step


def boundary_term(factor: float, scaled: bool, task: Task):
    """½ γ ∫ (u_ν)_+² over Γ3."""
    mesh = meshed(task, foundation=False)
    fes, a = problem(task, mesh)
    gamma = factor * normal_modulus(task) / (task.data["h"] if scaled else 1)
    normal = fes.TrialFunction().Trace() * ng.specialcf.normal(2)
    a += ng.Variation(gamma / 2 * ng.IfPos(normal, normal * normal, 0) * ng.ds("contact", bonus_intorder=4))
    return newton(task, fes, a)


def contact_boundary(factor: float, scaled: bool, task: Task):
    """The same by ContactBoundary, between Γ3 and slabs of one segment."""
    mesh = meshed(task, foundation=True)
    fes, a = problem(task, mesh)
    gamma = factor * normal_modulus(task) / (task.data["h"] if scaled else 1)
    u, X = fes.TrialFunction(), ng.CF((ng.x, ng.y))
    contact = ng.ContactBoundary(mesh.Boundaries("contact"), mesh.Boundaries("foundation"))
    deep = (X + u - X.Other() - u.Other()) * ng.specialcf.normal(2)
    contact.AddEnergy(gamma / 2 * ng.IfPos(deep, deep * deep, 0))
    # Places are found with the body undeformed: displacements are small.
    at_rest = ng.GridFunction(fes)
    at_rest.vec[:] = 0.0

    def before(now, form) -> None:
        contact.Update(at_rest, form, intorder=6, maxdist=0.1)

    return newton(task, fes, a, before)


VARIANTS = {
    "penalty 10 g": partial(boundary_term, 10, False),
    "ContactBoundary, penalty 10 g/h": partial(contact_boundary, 10, True),
    "ContactBoundary, penalty 10 g": partial(contact_boundary, 10, False),
}
# The boundary term has the same numbers.
FINEST = {"ContactBoundary, penalty 10 g": 32}
