"""GetFEM: contact with a rigid obstacle by its bricks: augmented Lagrangians, penalty and Nitsche's method.

Parameters are stated in g = C_νννν. The obstacle is the half plane or half space of the face; the initial gap is zero.
"""

from __future__ import annotations

from functools import partial
from types import SimpleNamespace

import getfem as gf
import numpy as np
from common import CannotExpressError, debian_version, forces, normal_modulus, voigt
from contact_judge import Task, pairs
from scipy.spatial import cKDTree

CODE, VERSION = "GetFEM", debian_version("python3-getfem")
gf.util_trace_level(0)
gf.util_warning_level(0)


def strains(dim: int, u: str = "u") -> list[str]:
    """ε_11, ε_22, 2ε_12, or six in space, in GetFEM's language and the order of the task."""
    gradients = [(f"Grad_{u}({i + 1},{j + 1})", f"Grad_{u}({j + 1},{i + 1})") for i, j in pairs(dim)]
    return [one if one == other else f"({one}+{other})" for one, other in gradients]


def stress(dim: int) -> list[str]:
    """σ_11, σ_22, σ_12, or six in space."""
    e = strains(dim)
    rows = [[f"c{min(i, j)}{max(i, j)}*{e[j]}" for j in range(len(e))] for i in range(len(e))]
    return ["(" + "+".join(row) + ")" for row in rows]


def model(task: Task) -> SimpleNamespace:
    """The model with elasticity, Dirichlet condition and nodal forces; Γ3,i is region 10 + i."""
    d = task.dim
    mesh, md = gf.Mesh("empty", d), gf.Model("real")
    mesh.add_point(task.vertices.T)
    mesh.add_convex(gf.GeoTrans(f"GT_PK({d},1)"), task.vertices[task.cells].transpose(2, 1, 0))
    faces = {frozenset(c[:k] + c[k + 1 :]): (i, k) for i, c in enumerate(task.cells.tolist()) for k in range(d + 1)}
    for i, piece in enumerate(task.data["contact"]):
        mesh.set_region(10 + i, np.array([faces[frozenset(f)] for f in piece["facets"]]).T)
    clamped = set(task.clamped.tolist())
    held = [on for f, on in faces.items() if f <= clamped]
    mesh.set_region(1, np.array(held).T)
    fem, scalar, constant = (gf.MeshFem(mesh, components) for components in (d, 1, 1))
    fem.set_fem(gf.Fem(f"FEM_PK({d},1)"))
    scalar.set_fem(gf.Fem(f"FEM_PK({d},1)"))
    constant.set_fem(gf.Fem(f"FEM_PK({d},0)"))
    nodes = scalar.basic_dof_nodes().T
    # order[k] is the vertex of the k-th basis function.
    order = cKDTree(task.vertices).query(nodes)[1]
    rule = gf.MeshIm(mesh, gf.Integ("IM_TRIANGLE(6)" if d == 2 else "IM_TETRAHEDRON(6)"))
    md.add_fem_variable("u", fem)
    C = voigt(task)
    for i, j in zip(*np.triu_indices(len(C[0])), strict=True):
        md.add_initialized_fem_data(f"c{i}{j}", constant, C[:, i, j])
    work = "+".join(f"{s}*{e}" for s, e in zip(stress(d), strains(d, "Test_u"), strict=True))
    md.add_linear_term(rule, work)
    md.add_Dirichlet_condition_with_simplification("u", 1)
    rhs = md.add_explicit_rhs("u", np.zeros(fem.nbdof()))
    # ``names``: multipliers and initial stresses that a brick adds.
    return SimpleNamespace(md=md, fem=fem, scalar=scalar, constant=constant, order=order, rule=rule, rhs=rhs, names=[])


def obstacle(task: Task, i: int, m: SimpleNamespace) -> str:
    """The distance from the foundation of a piece, −(x − x_0)·ν."""
    piece = task.data["contact"][i]
    values = -(task.vertices[m.order] - task.vertices[piece["facets"][0][0]]) @ np.array(piece["normal"])
    m.md.add_initialized_fem_data(f"obstacle{i}", m.scalar, values)
    return f"obstacle{i}"


def nodal(task: Task, i: int, m: SimpleNamespace) -> None:
    """Multipliers at vertices, the rows of B_N those of the task."""
    normal, vertices, _ = task.pieces()[i]
    where = np.argsort(m.order)
    B = gf.Spmat("empty", len(vertices), m.fem.nbdof())
    for row, v in enumerate(vertices):
        for axis in range(task.dim):
            B.assign(row, int(task.dim * where[v] + axis), float(normal[axis]))
    m.md.add_variable(f"multiplier{i}", len(vertices))
    m.names.append(f"multiplier{i}")
    m.md.add_initialized_data(f"r{i}", [normal_modulus(task)])
    m.md.add_initialized_data(f"gap{i}", np.zeros(len(vertices)))
    m.md.add_initialized_data(f"alpha{i}", np.ones(len(vertices)))
    m.md.add_basic_contact_brick("u", f"multiplier{i}", f"r{i}", B, f"gap{i}", f"alpha{i}", 1)


def integral(task: Task, i: int, m: SimpleNamespace) -> None:
    """P1 multipliers on Γ3, r = 10 g."""
    m.md.add_filtered_fem_variable(f"multiplier{i}", m.scalar, 10 + i)
    m.names.append(f"multiplier{i}")
    m.md.add_initialized_data(f"r{i}", [10 * normal_modulus(task)])
    name = obstacle(task, i, m)
    m.md.add_integral_contact_with_rigid_obstacle_brick(m.rule, "u", f"multiplier{i}", name, f"r{i}", 10 + i, 1)


def penalty(factor: float, scaled: bool, task: Task, i: int, m: SimpleNamespace) -> None:
    """The penalty r = factor g, or factor g/h."""
    r = factor * normal_modulus(task) / (task.data["h"] if scaled else 1)
    m.md.add_initialized_data(f"r{i}", [r])
    m.md.add_penalized_contact_with_rigid_obstacle_brick(m.rule, "u", obstacle(task, i, m), f"r{i}", 10 + i, 1)


def nitsche(theta: float, task: Task, i: int, m: SimpleNamespace, history: bool = True) -> None:
    """γ0 = 25 g, which the brick divides by h; A ε(u̇)ν in the Neumann term, from the cells, if ``history``."""
    m.md.add_initialized_data(f"gamma{i}", [25 * normal_modulus(task)])
    s11, s22, s12 = stress(2)
    if history:
        for k in range(3):
            m.md.add_initialized_fem_data(f"s{i}{k}", m.constant, np.zeros(len(task.cells)))
            m.names.append(f"s{i}{k}")
        s11, s22, s12 = (f"({s}+s{i}{k})" for k, s in enumerate((s11, s22, s12)))
    # An explicit vector of traction.
    traction = f"[{s11}*Normal(1)+{s12}*Normal(2), {s12}*Normal(1)+{s22}*Normal(2)]"
    name = obstacle(task, i, m)
    m.md.add_Nitsche_contact_with_rigid_obstacle_brick(m.rule, "u", traction, name, f"gamma{i}", 10 + i, theta)


def make(brick, task: Task):
    """step(b, s0) ↦ u with a brick for each piece of contact."""
    m = model(task)
    for i in range(len(task.pieces())):
        brick(task, i, m)

    def step(load: np.ndarray, initial: np.ndarray) -> np.ndarray:
        b = forces(task, load, initial)
        m.md.set_private_rhs(m.rhs, b[m.order].ravel())
        m.md.set_variable("u", np.zeros(m.fem.nbdof()))
        full = initial / np.where(np.arange(initial.shape[1]) < task.dim, 1, np.sqrt(2))
        for name in m.names:
            m.md.set_variable(name, full[:, int(name[-1])] if name[0] == "s" else 0 * m.md.variable(name))
        found = m.md.solve("max_res", 1e-11 * abs(b).max(), "max_iter", 100)
        step.solves += int(found[0])
        u = np.zeros_like(task.vertices)
        u[m.order] = m.md.variable("u").reshape(-1, task.dim)
        return u

    step.solves = 0
    return step


def plane(brick, task: Task):
    """``make`` for methods whose class is a matter of orders: two meshes in space leave it open."""
    if task.dim != 2:
        raise CannotExpressError("two meshes in space do not say of which order it is, and a third takes too long")
    return make(brick, task)


VARIANTS = {
    "nodal augmented Lagrangian, r = g": partial(make, nodal),
    "integral augmented Lagrangian, r = 10 g": partial(plane, integral),
    "Nitsche θ = 0, γ0 = 25 g": partial(plane, partial(nitsche, 0)),
    "Nitsche θ = 1, γ0 = 25 g": partial(plane, partial(nitsche, 1)),
    "Nitsche θ = −1, γ0 = 25 g": partial(plane, partial(nitsche, -1)),
    "Nitsche θ = −1 without A ε(u̇)ν": partial(plane, partial(nitsche, -1, history=False)),
    "penalty 10 g/h": partial(plane, partial(penalty, 10, True)),
    "penalty 10 g": partial(plane, partial(penalty, 10, False)),
    "penalty 1000 g": partial(plane, partial(penalty, 1000, False)),
}
FINEST = dict.fromkeys(list(VARIANTS)[1:], 32)
