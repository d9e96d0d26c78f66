"""Deliberate faults of the discrete problem, each named after the equation of the paper that it violates.

A fault changes the problem that is solved, or its data. The exact solution, the norm and the measurement of errors stay
right. ``study.controls.matrix`` measures in which cases a fault is noticed.

Most faults have a size δ: a relative change of a datum, a coefficient of friction, an angle. The fault of size 0 is no
fault.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache, partial
from types import SimpleNamespace
from typing import Any

import numpy as np
import scipy.sparse as sps

from manufactured.body import Kind, Part
from manufactured.law import Yield, isotropic_matrix
from manufactured.modes import at_each
from manufactured.tensors import Array
from study.fem.error_norm import ErrorNorm
from study.fem.independent import work_on
from study.fem.space import Space, means
from study.solve.evolution import SemiDiscrete, remainder
from study.solve.signorini import ContactSolution, ContactSolver, Signorini
from study.statements.pictures import contact_weights
from study.statements.shared.base import Experiment

Faulty = Experiment | None
"""An experiment with a fault; None where the fault cannot occur."""
Rule = Callable[[Signorini, Array], Array]
"""Function of a contact solver and of the penetrations that the load causes without contact forces.

It returns the forces of the constraints.
"""
Change = Callable[[Experiment, float], Faulty]
"""Function of an experiment and a size δ that returns the experiment with the fault; None where it cannot occur."""


@dataclass(frozen=True)
class Fault:
    """A deliberate fault.

    Attributes:
        name: the fault in a few words.
        equation: the equation or condition of the paper that the faulty program violates.
        change: the function that makes the fault, from the experiment without the fault and the size δ.
        sizes: the sizes δ that are tried, from large to small.
        single: whether orders need not notice the fault, while contact forces and the constraint do. Such a fault
            concerns a single vertex or cell, which hardly changes u^h (a missing cell by O(h^{d/2})), or it changes
            contact forces only.
    """

    name: str
    equation: str
    change: Change
    sizes: tuple[float, ...] = (1.0,)
    single: bool = False


def solving(setup: Experiment, **changes: Any) -> Experiment:
    """Return an experiment that measures errors as before, but solves a problem with changed attributes.

    Args:
        setup: the experiment.
        changes: the changed attributes of the semi-discrete problem (``SemiDiscrete``), by their names.
    """
    return replace(setup, solved=replace(setup.solved or setup.problem, **changes))


# ---- (2.1), (3.1), (3.2): the law


def with_tensor(setup: Experiment, name: str, matrix: Array, factor: Array) -> Faulty:
    """Return an experiment that is solved with another tensor A or G; None if G is changed and is nonlinear.

    Args:
        setup: the experiment.
        name: "A" or "G".
        matrix: the tensor in Mandel form, (D, D).
        factor: the material factor on the cells, (cells,).
    """
    if name == "G" and setup.problem.remainder is not None:
        return None
    return solving(setup, **{"M" if name == "A" else "reference": setup.space.form(matrix, factor)})


def tensor_fault(name: str, change: Callable[[Array, float], Array]) -> Change:
    """Return the fault that changes the constant tensor of A or G.

    Args:
        name: "A" or "G".
        change: the function from the right tensor in Mandel form, (D, D), and the size δ of the fault to the wrong
            tensor.
    """

    def faulty(setup: Experiment, size: float) -> Faulty:
        tensor = getattr(setup.solution.law, name)
        return with_tensor(setup, name, change(tensor.reference, size), means(setup.space, tensor.factor))

    return faulty


def factor_fault(change: Callable[[Space, Array], Array]) -> Change:
    """Return the fault that changes the material factors of A and G on the cells; it needs a factor that varies.

    Args:
        change: the function from the space V^h and the right factors on the cells, (cells,), to the wrong ones.
    """

    def faulty(setup: Experiment, size: float) -> Faulty:
        law = setup.solution.law
        space = setup.space
        varies = any(np.ptp(means(space, tensor.factor)) > 0 for tensor in (law.A, law.G))
        return with_factors(setup, lambda factor: change(space, factor)) if varies else None

    return faulty


def with_factors(setup: Experiment, change: Callable[[Array], Array]) -> Experiment:
    """Return an experiment that is solved with changed material factors of A and of a linear G.

    The tensors of the law are constant tensors times scalar factors α(x) for A and β(x) for G, whose means on the cells
    are changed. A nonlinear G is not changed.

    Args:
        setup: the experiment.
        change: the function from the right factors on the cells, (cells,), to the wrong ones. It is applied to α and to
            β.
    """
    for name in ("A", "G"):
        tensor = getattr(setup.solution.law, name)
        setup = with_tensor(setup, name, tensor.reference, change(means(setup.space, tensor.factor))) or setup
    return setup


def exchanged(matrix: Array, size: float) -> Array:
    """Return a tensor in which the fraction δ = ``size`` of the moduli μ and λ is exchanged.

    With λ = μ nothing changes. In a tensor that is not isotropic, the entry (1, 2) counts as λ and half of the last
    entry as μ.
    """
    mu = matrix[-1, -1] / 2
    lam = matrix[0, 1]
    dim = 2 if len(matrix) == 3 else 3
    return matrix + size * (isotropic_matrix(lam, mu, dim) - isotropic_matrix(mu, lam, dim))


def axes_exchanged(matrix: Array, size: float) -> Array:
    """Return a tensor (D, D) in which the coordinate axes 1 and 2 are exchanged; ``size`` is not used."""
    order = [1, 0, 2] if len(matrix) == 3 else [1, 0, 2, 4, 3, 5]
    return matrix[np.ix_(order, order)]


def shear_scaled(matrix: Array, size: float) -> Array:
    """Return a tensor (D, D) whose rows and columns of shear are multiplied by 1 + δ, where δ = ``size``.

    With δ = √2 − 1 components in Mandel form are mistaken for components in Voigt form.
    """
    d = 2 if len(matrix) == 3 else 3
    weights = np.where(np.arange(len(matrix)) < d, 1.0, 1.0 + size)
    return weights[:, None] * matrix * weights


def elasticity_scaled(setup: Experiment, size: float) -> Experiment:
    """Return an experiment that is solved with (1 + δ) G in place of G, linear or not, where δ = ``size``."""
    problem = setup.problem
    nonlinear = problem.remainder
    scaled = None if nonlinear is None else lambda v: (1 + size) * nonlinear(v)
    return solving(setup, reference=(1 + size) * problem.reference, remainder=scaled)


def stressless_start(setup: Experiment, size: float) -> Faulty:
    """Return an experiment whose elastic forces are computed from u − u_0 in place of u; None if u_0 = 0.

    ``size`` is not used.
    """
    problem = setup.problem

    def remainder(v: Array) -> Array:
        return problem.elastic(v - problem.u0) - problem.reference @ v

    return solving(setup, remainder=remainder) if problem.u0.any() else None


def yield_radius(setup: Experiment, size: float) -> Faulty:
    """Return an experiment that is solved with a convex set K in the law (3.3) whose radius is 1 + δ times as large.

    δ is ``size``. The result is None if the law is another one.
    """
    G = setup.solution.law.G
    if not isinstance(G, Yield):
        return None
    larger = replace(G, convex=replace(G.convex, radius=(1 + size) * G.convex.radius))  # type: ignore[type-var]
    factor = means(setup.space, larger.factor)
    return solving(setup, remainder=remainder(setup.space, larger, factor))


def linear_part_only(setup: Experiment, size: float) -> Faulty:
    """Return an experiment that is solved with the constant reference tensor of a nonlinear G; None if G is linear.

    ``size`` is not used.
    """
    return None if setup.problem.remainder is None else solving(setup, remainder=None)


def cell_missing(setup: Experiment, size: float) -> Experiment:
    """Return an experiment whose matrices of A and G lack the cell that is nearest to the centre of the body.

    ``size`` is not used.
    """
    mesh = setup.space.mesh
    away = mesh.p[:, mesh.t].mean(axis=1) - mesh.p.mean(axis=1, keepdims=True)
    missing = np.linalg.norm(away, axis=0).argmin()
    present = np.arange(away.shape[1]) != missing
    return with_factors(setup, lambda factor: present * factor)


# ---- (2.2), (2.4): body force and traction


def added_load(part: Callable[[Experiment, float], Array]) -> Change:
    """Return the fault that adds δ times a vector to the load.

    Args:
        part: the function from the experiment and a time to the vector, (dofs,).
    """

    def faulty(setup: Experiment, size: float) -> Experiment:
        right = setup.problem.load
        return solving(setup, load=lambda times: right(times) + size * at_each(times, partial(part, setup)))

    return faulty


@lru_cache(maxsize=4096)
def traction_load(setup: Experiment, time: float, kind: Kind = Kind.LOADED) -> Array:
    """Return the load vector of the exact traction σν at a time on the boundary parts of one kind, (dofs,).

    On the loaded parts, the default, the traction is f_2.

    Args:
        setup: the experiment, which has the exact solution and the mesh.
        time: the time.
        kind: the kind of the boundary parts.
    """
    return work_on(kind, setup.solution, setup.space, time)


def body_load(setup: Experiment, time: float) -> Array:
    """Return the load vector of the body force f_0 at a time, (dofs,)."""
    return setup.problem.load(time) - traction_load(setup, time)


def load_at_contact(setup: Experiment, time: float) -> Array:
    """Return the load of an experiment at a time, set to 0 at all vertices that are not on Γ3, (dofs,)."""
    on_contact = np.isin(setup.space.free // setup.space.dim, contact_vertices(setup.space))
    return np.where(on_contact, setup.problem.load(time), 0.0)


def tangential_load(setup: Experiment, time: float) -> Array:
    """Return the part of the load at a time that is tangential to Γ3 at the vertices of Γ3, 0 elsewhere, (dofs,)."""
    T, _ = tangents(setup.space, setup.space.dim - 1)
    return np.asarray(T.T @ (T @ setup.problem.load(time)))


def late(setup: Experiment, size: float) -> Experiment:
    """Return an experiment that is solved at a time t with the load of the time max(t − δT, 0), where δ = ``size``."""
    right = setup.problem.load
    delay = size * setup.problem.T

    def delayed(times: Array) -> Array:
        return right(np.maximum(times - delay, 0.0))

    return solving(setup, load=delayed)


def step_of_unit_time(setup: Experiment, size: float) -> Faulty:
    """Return an experiment whose n time steps of length T/n are taken for steps of length 1/n; None if T = 1.

    So its velocities are T times as large as they should be. ``size`` is not used.
    """
    T = setup.problem.T
    return None if T == 1 else solving(setup, M=sps.csc_array(T * setup.problem.M))


# ---- (2.3): the clamped boundary


@dataclass(frozen=True, eq=False)
class Loosened(Space):
    """V^h without the condition v = 0 at every second vertex of Γ1."""

    @cached_property
    def _held(self) -> tuple[Array, Array]:
        fixed = np.zeros((self.count, self.dim), dtype=bool)
        for part in self.body.of(Kind.CLAMPED):
            fixed[self.vertices(part)[::2]] = True
        return fixed.ravel(), super()._held[1]


INSIDE_SHARE = 1e-9
"""Share of the way from Γ1 to the middle of the body."""


def partly_clamped(setup: Experiment, size: float) -> Experiment:
    """Return an experiment in which only every second vertex of Γ1 is clamped.

    The load at the other vertices of Γ1 does not contain the force with which the support holds the body. ``size`` is
    not used.
    """
    solution = setup.solution
    space = Loosened(setup.space.mesh, setup.space.body)
    v_norm = ErrorNorm(solution, space)

    # On Γ1 itself the stress is 0 where a profile of the exact solution ends, so it is taken slightly inside.
    centre = space.body.vertices.mean(axis=1)
    inside = SimpleNamespace(at=lambda x: solution.at(x + INSIDE_SHARE * (centre.reshape(-1, *[1] * (x.ndim - 1)) - x)))

    def load(times: Array) -> Array:
        return v_norm.load(times) - at_each(times, partial(work_on, Kind.CLAMPED, inside, space))  # type: ignore[arg-type]

    return replace(setup, space=space, v_norm=v_norm, problem=replace(SemiDiscrete.of_exact(v_norm), load=load))


# ---- (2.5): contact


def components(space: Space, directions: Callable[[Part], Array], left_out: Array | None = None) -> sps.csr_array:
    """Return the matrix from displacements to components in given directions at the vertices of Γ3, (rows, dofs).

    It has a row for each contact part, each direction on the part, and each vertex of the part, in this order. With one
    direction for each part, the rows are in the order of the rows of N, the matrix to normal displacements.

    Args:
        space: the space V^h.
        directions: returns for a contact part k directions as columns, (d, k) in dimension d.
        left_out: numbers of vertices that get no row; by default there are none.
    """
    rows = []
    for part, numbers in space.contact:
        used = numbers if left_out is None else np.setdiff1d(numbers, left_out)
        rows += [(SimpleNamespace(normal=direction), used) for direction in directions(part).T]
    return space.normal_components(rows)  # type: ignore[arg-type]


def contact_vertices(space: Space) -> Array:
    """Return the number of the vertex to which each of the m contact constraints belongs, (m,).

    A constraint is a row of the matrix N that maps displacements to normal displacements. A vertex on two contact faces
    occurs twice.

    Args:
        space: the space V^h.
    """
    return np.concatenate([numbers for _, numbers in space.contact])


def tangents(space: Space, count: int) -> tuple[sps.csr_array, Array]:
    """Return the matrix T from displacements to tangential components at the vertices of Γ3.

    Vertices that lie on several contact parts have no tangent and are left out.

    Args:
        space: the space V^h.
        count: how many of the d − 1 tangents of each contact part are used.

    Returns:
        T, and for each row of T the row of N of the same vertex, (rows,).
    """
    vertices, occurrences = np.unique(contact_vertices(space), return_counts=True)
    corners = vertices[occurrences > 1]
    rows_of_N = []
    first = 0
    for _, numbers in space.contact:
        rows_of_N += [first + np.flatnonzero(np.isin(numbers, corners, invert=True))] * count
        first += len(numbers)
    return components(space, lambda part: part.frame[:, :count], corners), np.concatenate(rows_of_N)


def along_contact(setup: Experiment, size: float, name: str, first_only: bool = False) -> Faulty:
    """Return an experiment with springs or dashpots that act along Γ3.

    If ``first_only`` is set and the body is plane, the result is None. The stiffness for an area is δ times the normal
    modulus of G or A, divided by a unit length.

    Args:
        setup, size: the experiment, and the factor δ of the stiffness.
        name: "reference" for springs, "M" for dashpots: the matrix of the problem to which they are added.
        first_only: whether they act only along the first of the two tangents of each contact part.
    """
    space = setup.space
    if first_only and space.dim == 2:
        return None
    T, rows_of_N = tangents(space, 1 if first_only else space.dim - 1)
    tensor = getattr(setup.solution.law, "A" if name == "M" else "G")
    modulus = np.linalg.eigvalsh(tensor.reference)[-1]
    stiffness = T.T @ sps.diags_array(size * modulus * contact_weights(space)[rows_of_N]) @ T
    return solving(setup, **{name: sps.csc_array(getattr(setup.problem, name) + stiffness)})


def friction(setup: Experiment, size: float) -> Experiment:
    """Return an experiment with Coulomb friction, |σ_τ| ≤ δ |σ_ν| with δ = ``size``, at the vertices of Γ3.

    Friction opposes the tangential displacement u_τ, not its velocity as in Coulomb's law; in 3D each of its two
    components has this bound. With δ = ∞ the body is glued to the foundation where it is in contact. In each time step
    contact forces and friction forces are computed in turn, with the bound of friction from the last contact forces,
    until the contact forces no longer change.
    """
    m = setup.problem.N.shape[0]
    T, rows_of_N = tangents(setup.space, setup.space.dim - 1)

    def coulomb(solver: Signorini, gap: Array) -> Array:
        W = solver.W
        pressure = np.zeros(m)
        shear = np.zeros(len(gap) - m)
        for _ in range(100):
            before = pressure
            pressure = with_matrix(solver, W[:m, :m], gap[:m] - W[:m, m:] @ shear)
            on = pressure[rows_of_N]
            bound = np.where(on > 0, size * np.maximum(on, np.finfo(float).tiny), 0.0)
            shear = bounded(W[m:, m:], gap[m:] - W[m:, :m] @ pressure, bound, shear)
            if abs(pressure - before).max(initial=0.0) <= 1e-12 * abs(pressure).max(initial=0.0):
                break
        return np.concatenate([pressure, shear])

    return other_forces(setup, coulomb, T)


def with_matrix(solver: Signorini, W: Array, gap: Array) -> Array:
    """Return the contact forces (k,) that solve the complementarity problem of ``Signorini`` with another matrix W.

    Args:
        solver: the solver, whose first k constraints are used. It remembers which of them are active.
        W: the matrix from contact forces to the normal displacements that they cause, (k, k).
        gap: the penetration without contact forces, (k,).
    """
    other = copy(solver)
    vars(other).update(W=W, active=solver.active[: len(W)], _factored=None)
    forces = Signorini.complementarity(other, gap)
    solver.active[: len(W)] = other.active
    return forces


def bounded(W: Array, free: Array, bound: Array, start: Array) -> Array:
    """Return the forces λ with |λ_i| ≤ bound_i that minimise ½ λᵀWλ − free·λ, by a primal–dual active set method.

    Args:
        W: the symmetric positive definite matrix from forces to the displacements that they cause, (k, k).
        free: the displacements without these forces, (k,), with the sign for which Wλ = free at a free minimum.
        bound: the largest absolute values of the forces, (k,).
        start: the forces with which the iteration starts, (k,).
    """
    forces = np.clip(start, -bound, bound)
    sides = np.full(len(forces), np.nan)
    for _ in range(50):
        trial = forces + (free - W @ forces) / W.diagonal()
        above = (bound == 0) | (trial > bound)
        following = np.where(above, 1.0, np.where(trial < -bound, -1.0, 0.0))
        if (following == sides).all():
            break
        sides = following
        inside = sides == 0
        forces = np.where(inside, 0.0, sides * np.where(inside, 0.0, bound))
        if inside.any():
            rest = free[inside] - W[np.ix_(inside, ~inside)] @ forces[~inside]
            forces[inside] = np.linalg.solve(W[np.ix_(inside, inside)], rest)
    return forces


def tilted(setup: Experiment, size: float) -> Experiment:
    """Return an experiment whose constraint has normals that are turned by the angle ``size`` towards a tangent."""

    def turned(part: Part) -> Array:
        return np.cos(size) * part.normal[:, None] + np.sin(size) * part.frame[:, :1]

    return solving(setup, N=components(setup.space, turned))


def normals_of_next_part(setup: Experiment, size: float) -> Faulty:
    """Return an experiment whose constraint on each contact part has the normal of the next part; None for one part.

    ``size`` is not used.
    """
    parts, numbers = zip(*setup.space.contact, strict=True)
    following = [*parts[1:], parts[0]]
    N = setup.space.normal_components([*zip(following, numbers, strict=True)])
    return solving(setup, N=N) if len(parts) > 1 else None


def unconstrained(which: Callable[[int], Iterable[int]]) -> Change:
    """Return the fault that leaves some vertices of Γ3 unconstrained.

    Args:
        which: the function from the number m of contact constraints to the numbers of the ones that are left out.
    """

    def faulty(setup: Experiment, size: float) -> Experiment:
        count = setup.problem.N.shape[0]
        held = np.delete(np.arange(count), [*which(count)])

        def held_only(solver: Signorini, gap: Array) -> Array:
            forces = np.zeros(count)
            forces[held] = with_matrix(solver, solver.W[np.ix_(held, held)], gap[held])
            return forces

        return other_forces(setup, held_only)

    return faulty


def other_forces(setup: Experiment, rule: Rule, *further: sps.csr_array) -> Experiment:
    """Return an experiment in which another rule computes the contact forces, perhaps with further constraints.

    Args:
        setup: the experiment. Its contact constraints are N u ≤ g, one for each of the m rows of N.
        rule: returns the forces of all k constraints, (k,), from the contact solver and from the penetrations, (k,),
            that the load causes without contact forces. The first m forces are the contact forces.
        further: matrices whose rows are added to N as further constraints, with the initial gap 0, (rows, dofs) each;
            k is m plus the number of these rows.
    """
    N = sps.csr_array(sps.vstack([setup.problem.N, *further]))
    m = setup.problem.N.shape[0]
    initial_gap = np.zeros(N.shape[0])
    initial_gap[:m] = setup.problem.gap

    class Faulty(Signorini):
        def complementarity(self, gap: Array) -> Array:
            return rule(self, gap)

    def solver(S: sps.csc_array, _: sps.csr_array, **of_right: Array) -> ContactSolver:
        solve = Faulty(S, N, setup.space.free_points, initial_gap)

        def solved(b: Array) -> ContactSolution:
            u, forces = solve(b)
            return u, forces[:m]

        return solved

    return solving(setup, solver=solver)


def tied(solver: Signorini, gap: Array) -> Array:
    """Return the contact forces, (m,), if no vertex of Γ3 can leave the foundation; a ``Rule`` for ``other_forces``.

    Args:
        solver: the contact solver, which has the matrix from forces to normal displacements.
        gap: the penetrations that the load causes without contact forces, (m,).
    """
    return solver.multipliers_on(np.ones_like(solver.active), gap)


def never_released(solver: Signorini, gap: Array) -> Array:
    """Return the contact forces, (m,), if a vertex that has once been in contact stays there, even if it is pulled.

    It is a ``Rule`` for ``other_forces``.

    Args:
        solver: the contact solver. It remembers which vertices have been in contact.
        gap: the penetrations that the load causes without contact forces, (m,).
    """
    held = active = solver.active
    for _ in range(50):
        forces = solver.multipliers_on(active, gap)
        following = held | (np.where(active, forces, gap - solver.W @ forces) > 0)
        if (following == active).all():
            break
        active = following
    solver.active = active
    return forces


def forces_scaled(setup: Experiment, size: float) -> Experiment:
    """Return an experiment in which the computed contact forces are multiplied by 1 + δ, where δ = ``size``."""
    return other_forces(setup, lambda solver, gap: (1 + size) * Signorini.complementarity(solver, gap))


def springs(setup: Experiment, size: float) -> Experiment:
    """Return an experiment with springs that resist penetration in place of the rigid foundation; δ = ``size``.

    A spring of an area has the stiffness of the largest modulus of A per unit length, divided by δ.
    """
    modulus = np.linalg.eigvalsh(setup.solution.law.A.reference)[-1]
    compliance = np.diag(size / (modulus * contact_weights(setup.space)))
    return other_forces(setup, lambda solver, gap: with_matrix(solver, solver.W + compliance, gap))


def relaxed(setup: Experiment, size: float) -> Experiment:
    """Return an experiment whose constraint permits a penetration of ``size`` into the foundation."""
    problem = setup.problem
    return solving(setup, gap=np.broadcast_to(problem.gap, problem.N.shape[0]) + size)


def gap_fault(change: Callable[[Array], Array]) -> Change:
    """Return the fault that changes the initial gaps of the vertices; it cannot occur in a case without initial gap.

    Args:
        change: the function from the right gaps of the vertices on one contact part, sorted along the part,
            (vertices,), to the wrong ones.
    """

    def faulty(setup: Experiment, size: float) -> Faulty:
        if not np.any(setup.problem.gap):
            return None
        gap = np.array(setup.problem.gap)
        first = 0
        for part, numbers in setup.space.contact:
            s, _ = part.coordinates(setup.space.mesh.p[:, numbers])
            order = first + np.lexsort(s)
            gap[order] = change(gap[order])
            first += len(numbers)
        return solving(setup, gap=gap)

    return faulty


def opposite_faces(setup: Experiment, size: float) -> Faulty:
    """Return an experiment with the constraint u_ν ≤ 0 on the loaded boundary Γ2, too; None if it has no vertex.

    ``size`` is not used.
    """
    space = setup.space
    taken = contact_vertices(space)
    free = space.free[:: space.dim] // space.dim
    more = []
    for part in space.body.of(Kind.LOADED):
        more.append((part, np.setdiff1d(np.intersect1d(space.vertices(part), free), taken)))
        taken = np.concatenate([taken, more[-1][1]])
    further = space.normal_components(more)
    return other_forces(setup, Signorini.complementarity, further) if further.shape[0] else None


def gap_from_start(setup: Experiment, size: float) -> Faulty:
    """Return an experiment with the constraint (u − u_0)_ν ≤ 0 in place of u_ν ≤ 0; None if u_0 = 0.

    ``size`` is not used.
    """
    start = setup.problem.u0
    return solving(setup, gap=setup.problem.N @ start) if start.any() else None


# ---- (2.6): the initial condition


def start_scaled(setup: Experiment, size: float) -> Faulty:
    """Return an experiment that starts from (1 + δ) u_0 in place of u_0, where δ = ``size``; None if u_0 = 0."""
    u0 = setup.problem.u0
    return solving(setup, u0=(1 + size) * u0) if u0.any() else None


def in_both_tensors(
    name: str, change: Callable[[Array, float], Array], sizes: tuple[float, ...] = (1.0,)
) -> list[Fault]:
    """Return two faults: the first changes the constant tensor of A, the second the constant tensor of G.

    Args:
        name: what is changed; it becomes the name of the faults, with "in A" or "in G".
        change: the function from the right tensor, (D, D), and the size δ of the fault to the wrong tensor.
        sizes: the sizes δ that are tried.
    """
    return [Fault(f"{name} in {of}", "(2.1)", tensor_fault(of, change), sizes) for of in ("A", "G")]


FAULTS = (
    Fault("A too large", "(2.1)", tensor_fault("A", lambda matrix, size: (1 + size) * matrix), (0.5, 0.05)),
    Fault("G too large", "(2.1)", elasticity_scaled, (0.5, 0.05)),
    Fault("G left out", "(2.1)", lambda setup, size: elasticity_scaled(setup, -1.0)),
    *in_both_tensors("λ and μ exchanged", exchanged, (0.5, 0.1)),
    *in_both_tensors("axes exchanged", axes_exchanged),
    *in_both_tensors("shear scaled", shear_scaled, (0.414, 0.05)),
    Fault(
        "factors replaced by their means",
        "(3.1), (3.2)",
        factor_fault(lambda space, f: 0 * f + space.volumes @ f / space.volumes.sum()),
    ),
    Fault("factors off by one cell", "(3.1), (3.2)", factor_fault(lambda space, f: np.roll(f, 1))),
    Fault("time step 1/n", "(2.1)", step_of_unit_time),
    Fault("stress of u_0 left out", "(2.1)", stressless_start),
    Fault("yield radius too large", "(3.3)", yield_radius, (0.5,)),
    Fault("nonlinear part of G left out", "(3.2)", linear_part_only),
    Fault("a cell missing", "(2.2)", cell_missing, single=True),
    Fault("f too large", "(3.7)", added_load(lambda setup, time: setup.problem.load(time)), (0.2, 0.02)),
    Fault("f_0 too large", "(2.2)", added_load(body_load), (0.2, 0.02)),
    Fault("f_2 too large", "(2.4)", added_load(traction_load), (0.2, 0.02)),
    Fault("loads at Γ3 left out", "(2.2)", added_load(lambda setup, time: -load_at_contact(setup, time))),
    Fault("loads at Γ3 doubled", "(2.2)", added_load(load_at_contact)),
    Fault("tangential loads at Γ3 left out", "(2.2)", added_load(lambda setup, time: -tangential_load(setup, time))),
    Fault(
        "contact pressure added to the load",
        "(3.7)",
        added_load(lambda setup, time: traction_load(setup, time, Kind.CONTACT)),
        single=True,
    ),
    Fault("load late by δT", "(3.7)", late, (0.1, 0.02)),
    Fault("every second vertex of Γ1 free", "(2.3)", partly_clamped),
    Fault("no contact", "(2.5) u_ν ≤ 0", unconstrained(range)),
    Fault("every second vertex of Γ3 free", "(2.5) u_ν ≤ 0", unconstrained(lambda count: range(0, count, 2))),
    Fault("penetration of δ permitted", "(2.5) u_ν ≤ 0", relaxed, (0.1, 0.03)),
    Fault("first vertex of Γ3 free", "(2.5) u_ν ≤ 0", unconstrained(lambda count: [0]), single=True),
    Fault("middle vertex of Γ3 free", "(2.5) u_ν ≤ 0", unconstrained(lambda count: [count // 2]), single=True),
    Fault("last vertex of Γ3 free", "(2.5) u_ν ≤ 0", unconstrained(lambda count: [count - 1]), single=True),
    Fault("springs of compliance δ", "(2.5) u_ν ≤ 0", springs, (0.1, 0.01)),
    Fault("no lift-off", "(2.5) σ_ν ≤ 0", lambda setup, size: other_forces(setup, tied)),
    Fault("no lift-off after contact", "(2.5) σ_ν ≤ 0", lambda setup, size: other_forces(setup, never_released)),
    Fault("contact forces scaled", "(2.5) σ_ν ≤ 0", forces_scaled, (0.5, 0.1)),
    Fault("opposite faces in contact", "(2.5) σ_ν u_ν = 0", opposite_faces),
    Fault("glued on Γ3", "(2.5) σ_τ = 0", partial(along_contact, name="reference"), (1e6,)),
    Fault("glued where in contact", "(2.5) σ_τ = 0", lambda setup, size: friction(setup, np.inf)),
    Fault("Coulomb friction δ", "(2.5) σ_τ = 0", friction, (0.3, 0.1)),
    Fault("springs along Γ3", "(2.5) σ_τ = 0", partial(along_contact, name="reference"), (0.3, 0.1)),
    Fault("dashpots along Γ3", "(2.5) σ_τ = 0", partial(along_contact, name="M"), (0.3, 0.1)),
    Fault("one tangent of Γ3 held", "(2.5) σ_τ = 0", lambda setup, size: along_contact(setup, 1e6, "reference", True)),
    Fault("normals tilted by δ", "(2.5) u_ν", tilted, (0.35, 0.035)),
    Fault("normals of the next part", "(2.5) u_ν", normals_of_next_part),
    Fault("normals inwards", "(2.5) u_ν", lambda setup, size: solving(setup, N=-setup.problem.N)),
    Fault("gap measured from u_0", "(2.5) gap", gap_from_start),
    Fault("initial gap left out", "(2.5) gap", gap_fault(lambda gap: 0 * gap)),
    Fault("initial gap reversed", "(2.5) gap", gap_fault(lambda gap: gap[::-1])),
    Fault("initial gap shifted", "(2.5) gap", gap_fault(lambda gap: np.roll(gap, 1))),
    Fault("initial gap sorted downwards", "(2.5) gap", gap_fault(lambda gap: np.sort(gap)[::-1])),
    Fault("start at 0", "(2.6)", lambda setup, size: start_scaled(setup, -1.0)),
    Fault("start too large", "(2.6)", start_scaled, (0.2, 0.05)),
)
"""All faults of the equations and data, in the order of the paper."""
