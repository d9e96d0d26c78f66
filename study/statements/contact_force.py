"""The computed contact force converges to the exact contact pressure p, and there is no penetration between vertices.

The paper claims nothing about the contact force. It is judged separately, because the order of the error in V hardly
shows mistakes in it. Where all of Γ3 is in contact, contact forces that are wrong by a fifth do not change u^h. Penalty
methods have the right order in V on coarse meshes, although their error stagnates later.

The error is **measured** for every case of Proposition 5.4 with contact. The multipliers λ_n of the midpoint rule are
the nodal contact forces at the time t_{n−1/2}. With them Problem 5.1 reads

    (σ^h, ε(v))_Q + λ_n·Nv = (f, v)_V,   v ∈ V^h,    and exactly   (σ, ε(v))_Q + ∫_{Γ3} p v_ν = (f, v)_V.

So ⟨p − p^h, v_ν⟩ = ∫_{Γ3} p v_ν − λ_n·Nv is the error of the contact force. It is measured without the load and without
a matrix of the problem, because p comes from the exact stress at points of the faces.

**Predicted** orders are for norms in L²(0,T), with k ~ h. If the load is integrated exactly,
⟨p − p^h, v_ν⟩ = (σ^h − σ, ε(v))_Q for every v ∈ V^h.

* **dual norm**: 3/2 to 2 on one-diagonal meshes and 1 to 2 on others, as for ‖Π^h u − u^h‖_V. The dual norm is the
  supremum of the right side over v ∈ V^h with ‖v‖_V = 1. Only the part of σ^h − σ = Aε(u̇^h − u̇) + Gε(u^h − u) that is
  not orthogonal to strains of V^h contributes, so the same errors cancel as in Π^h u − u^h. No higher order is
  possible, because p^h is piecewise linear and a front cuts cells.
* **L²(Γ3)**: order 1 to 3/2. Take v with a given trace on Γ3 that vanishes at all vertices off Γ3. It is non-zero only
  in the cells along Γ3. These contain O(h^{3/2}) of ‖σ − σ^h‖_Q for ε(u) ∈ W^{1,∞}, and ‖v‖_V ≤ c h^{−1/2} ‖v_ν‖. This
  gives order 1 without cancellation. With cancellation, the inverse inequality gives half an order less than the order
  of the dual norm.
* **resultant**: at least the order of the dual norm, because v with v_ν = 1 on a piece of Γ3 is one of the v in the
  supremum. For such a smooth v, (σ^h − σ, ε(v − Π^h v)) is of order 2 by the argument of Aubin and Nitsche, if the
  contact zone is known. A moving front is known only up to one cell, which adds the pressure in that cell to the error.
  On coarse levels orders above 2 are observed where a contact patch is only a few cells wide, so the window has no
  upper end.

On irregular meshes ‖p − p^h‖_{L²(Γ3)} is dominated by the few edges that happen to be long where p is strongly curved.
A pilot study had ten random meshes on each of the levels n = 8, 16, 32. The logarithm of this error had a standard
deviation of 0.2 on every level, and its order was 1.16 ± 0.18. The error also depends on the corners at the ends of Γ3.
For *corner* it doubles on unstructured meshes if the corner belongs to one cell instead of two. Therefore this order is
only reported on irregular meshes. The order of the dual norm, which is a sum over cells, was 1.51 ± 0.09; it is judged.
But where Γ3 meets Γ1 the corner changes the dual norm as well, by a factor of about four for *contact-at-clamp*. For
such faces its order is judged on one-diagonal meshes only, on which all corners are alike.

**Sign conditions** are judged as well: u^h_ν ≤ 0 at every point of straight faces, and λ ≥ 0, up to round-off. The
first one holds because u^h ∈ K^h and u^h_ν is linear between vertices.

If the whole face comes into contact with a non-zero velocity, p jumps in time. In the step with the jump every scheme
returns a mean of the values before and after the jump. So the error in L²(0,T) is of order 1/2 in k, times a factor
that depends on the position of the jump within the step. This order is only reported.
"""

from dataclasses import replace

import numpy as np
import scipy.sparse as sps
import sympy as sp

from manufactured.contact import Face
from manufactured.exact import ExactSolution
from manufactured.tensors import Array
from study.fem.naming import is_own
from study.fem.space import Space
from study.ledger.check import MIN_LEVELS, Groups, accuracy, consequence, identity
from study.ledger.datafiles import CsvFile
from study.ledger.quantities import finest
from study.ledger.window import Window, around, at_least, at_most, between
from study.solve.evolution import histories
from study.solve.signorini import Signorini
from study.solve.tableau import MIDPOINT
from study.statements.shared.base import (
    EVOLVING,
    Experiment,
    Judged,
    Numbers,
    Setting,
    Statement,
    check_of_order,
    steps_like_h,
)
from study.statements.shared.meshes import split
from study.statements.shared.norms import FacePoints, maximum, midpoints
from study.statements.shared.scope import Scope

FORCE_ERRORS = "pressure", "dual", "resultant"
"""Columns with relative errors of the contact force over (0, T).

They are the error of the pressure in L²(Γ3), the error in the dual norm sup_v ∫ p v_ν/‖v‖_V, and the error of the total
force on each face.
"""
TIME_SHARES = tuple(f"{name}_time_share" for name in FORCE_ERRORS)
CONTACT = CsvFile("contact.csv")
FACET_GAUSS_POINTS, SOLID_FACET_GAUSS_POINTS = 20, 6
"""Number of Gauss points on a facet in 2D, and in each direction of a facet in 3D.

Many are needed, because the pressure has kinks inside facets."""


class PressedFace(FacePoints):
    """One contact face with quadrature points, the exact solution there, and the hat functions of its vertices.

    Args:
        solution: the exact solution.
        space: the P1 displacement space V^h.
        face: the contact face.
        vertices: the numbers of the m vertices of the face that are not clamped, (m,).

    Attributes:
        functions: the values of the hat functions φ_i of these vertices, (points, m).
        mass: the mass matrix ∫ φ_i φ_j over the face, (m, m).
    """

    def __init__(self, solution: ExactSolution, space: Space, face: Face, vertices: Array) -> None:
        count = FACET_GAUSS_POINTS if space.dim == 2 else SOLID_FACET_GAUSS_POINTS
        super().__init__(solution, space, face, count, face.rough)
        self.functions = self.hats[:, vertices]
        self.mass = (self.functions.T @ sps.diags_array(self.weights) @ self.functions).toarray()


class Forces:
    """Measures errors of nodal contact forces, and the penetration of the foundation between vertices.

    Args:
        setup: the experiment, which has the exact solution, the space V^h and the semi-discrete problem.

    Attributes:
        space: the P1 displacement space V^h.
        faces: the contact faces.
        ends: the numbers of the rows of N, the matrix of normal displacements, at which the rows of a new face begin.
        clamped: the number of faces that have a vertex on the clamped boundary Γ1.
        W: the matrix N M⁻¹ Nᵀ, with the matrix M of (·,·)_V. It gives the dual norm sup_v y·Nv/‖v‖_V = (y·Wy)^½ of
            nodal forces y, (m, m).
    """

    def __init__(self, setup: Experiment) -> None:
        self.space = space = setup.space
        self.faces = [
            PressedFace(setup.solution, space, face, vertices)
            for face, (_, vertices) in zip(setup.solution.faces, space.contact, strict=True)
        ]
        self.ends = np.cumsum([len(vertices) for _, vertices in space.contact])[:-1]
        # The matrix N has no rows for vertices on Γ1, so a face that meets Γ1 has fewer rows than vertices.
        self.clamped = sum(len(space.vertices(part)) > len(free) for part, free in space.contact)
        self.W = Signorini(setup.problem.M, space.N, space.free_points).W

    def squares(self, times: Array, multipliers: Array) -> tuple[Array, Array]:
        """Return sums over time of the squared errors of the contact force and of the squared exact norms, (3,) each.

        The three entries belong to the errors in ``FORCE_ERRORS``: of the pressure in L²(Γ3), in the dual norm, and of
        the total force on each face.

        Args:
            times: the times, (n,).
            multipliers: the nodal contact forces λ at the times, (n, m).
        """
        exact = []
        errors = 0.0
        sizes = 0.0
        for face, forces in zip(self.faces, np.split(multipliers.T, self.ends), strict=True):
            p = face.exact.pressure(times).reshape(-1, len(times))
            # Nodal forces λ are moments of a pressure, so the P1 pressure p^h follows from the mass matrix.
            p_h = face.functions @ np.linalg.solve(face.mass, forces)
            errors += (face.weights @ (p - p_h) ** 2).sum()
            sizes += (face.weights @ p**2).sum()
            exact.append(face.functions.T @ (face.weights[:, None] * p))
        y = np.concatenate(exact)
        missing = y - multipliers.T
        total, lost = (np.array([part.sum(axis=0) for part in np.split(nodal, self.ends)]) for nodal in (y, missing))
        squared = errors, np.vdot(missing, self.W @ missing), np.vdot(lost, lost)
        return np.array(squared), np.array([sizes, np.vdot(y, self.W @ y), np.vdot(total, total)])

    def penetration(self, u: Array) -> float:
        """Return the largest penetration (u_ν)_+ of a P1 displacement u at the quadrature points on contact faces.

        Args:
            u: the unknowns of the displacement, (dofs,).
        """
        nodal = self.space.nodal(u)
        return float(np.max([0.0, *((face.hats @ (face.normal @ nodal)).max() for face in self.faces)]))


def errors_in_time(setup: Experiment, forces: Forces, steps: int) -> tuple[Array, float, float]:
    """Solve a problem, and return errors of the contact force and violations of both sign conditions of contact.

    Args:
        setup: the problem with its exact solution.
        forces: computes the errors of contact forces.
        steps: the number of time steps, which replaces the number of ``setup``.

    Returns:
        The relative errors over (0, T) of the pressure in L²(Γ3), of the contact force in the dual norm, and of the
        total force on each face, (3,); the largest relative penetration; and the largest relative tensile force.
    """
    u, multipliers = histories(setup.march(steps))
    squares, sizes = forces.squares(midpoints(setup.problem.T, steps), multipliers[1:])
    penetration = maximum(map(forces.penetration, u)) / abs(u).max()
    pulling = -multipliers.min(initial=0.0) / abs(multipliers).max()
    return np.sqrt(squares / sizes), float(penetration), float(pulling)


NO_ORDER = "p jumps in time, and the error comes from the step with the jump"
CORNER_CELLS = "a face meets Γ1, and the error depends on whether one cell or two meet there"
LANDS = "lift-and-land"
"""The case whose pressure jumps in time, for which no order of the contact force is claimed."""
NO_BOUND = "a face meets Γ1, so that the dual norm does not bound the error of the resultant"
"""Why no order of the resultant, the total force on a face, is claimed if the face meets the clamped boundary Γ1.

The order would follow from the dual norm with v_ν = 1. But v = 0 on Γ1, so no v ∈ V has v_ν = 1 on the whole face.
"""
PRESSURE_ORDER = check_of_order(
    "order-pressure",
    "order of ‖p − p^h‖_{L²(Γ3)}",
    "pressure",
    between(1, 1.5, 0.15, 0.7, "from the cells along Γ3; piecewise linear functions reach at most 2"),
)
OF_CHANCE = replace(
    PRESSURE_ORDER,
    key="order-pressure-irregular",
    quantity=f"{PRESSURE_ORDER.quantity}, irregular meshes",
    if_missed=(
        "on irregular meshes the pressure error depends on a few long edges where p has a kink, and on the corners"
    ),
)
DUAL = "order of sup ⟨p − p^h, v_ν⟩ / ‖v‖_V over V^h"
DUAL_ORDERS = (
    check_of_order(
        "order-dual-superclose",
        f"{DUAL}, superclose",
        "dual",
        between(1.5, 2, 0.2, 0.2, "the order of ‖Π^h u − u^h‖_V on one-diagonal meshes"),
    ),
    check_of_order(
        "order-dual-other",
        f"{DUAL}, other families",
        "dual",
        between(1, 2, 0.15, 0.2, "the order of ‖Π^h u − u^h‖_V on other meshes"),
    ),
)
"""The checks of the order of the contact force in the dual norm, on one-diagonal meshes and on all others."""
RESULTANT = at_least(1, "the order of the dual norm; 2 if the contact zone is known")
"""Window of the order of the contact resultant, the total contact force on a face.

It has no upper end: parts of the error of the resultant may cancel, so its order may exceed 2.
"""
FORCE_NORMS = (
    check_of_order(
        "order-resultant", "order of the error of the contact resultant on each face", "resultant", RESULTANT
    ),
    consequence(
        "resultant",
        "error of the contact resultant on each face",
        finest("resultant"),
        at_most(0.05, "of the exact resultant, on the finest level"),
    ),
    # The error in time of the resultant is not judged: it can only lower the order, whose window has no upper end, and
    # on symmetric meshes the error in space may vanish, so that no error in time is small against it.
    accuracy(
        "time-share",
        "error in time / error, for both norms of p − p^h",
        [*TIME_SHARES[:2]],
        at_most(0.5, "of each error; half as many steps show the error in time"),
    ),
)
FORCE_ROUND_OFF = at_most(1e-10, "only rounding, because faces are straight and elements linear")
EXACT = (
    identity("penetration", "max (u^h_ν)_+ between vertices / max |u^h|", "penetration", FORCE_ROUND_OFF),
    identity("pulling", "max λ_− / max |λ|", "pulling", FORCE_ROUND_OFF),
)


def touches(solution: ExactSolution) -> bool:
    """Return whether an exact solution has contact at some time.

    The formulas of its contact faces decide: there is no contact if the pressure is 0 or the level function is
    negative.
    """
    return any(
        (face.pressure_jet is None or face.pressure_jet.expression != 0) and not sp.sympify(face.level).is_negative
        for face in solution.faces
    )


class ContactForce(Statement):
    """Measures errors of the nodal contact forces, penetration and tensile forces, by the midpoint rule with k ~ h.

    k is the time step and h the mesh size.
    """

    label = "contact force"
    claim = "−σ^h_ν → p on Γ3, and u^h_ν ≤ 0 between vertices, for the solutions of Proposition 5.4"
    file = CONTACT
    of_own_cases = True
    per_step = 5.0, 120.0

    def settings(self, scope: Scope) -> list[Setting]:
        """Return the settings (case, mesh family, level) for the cases of Proposition 5.4 with contact.

        A case of the catalogue is measured on each of its mesh families, on the three finest levels of the study; the
        quick study measures some of these cases. A user's case is measured on all levels, because its user may add a
        finer level to a run: with the three finest levels only, the coarsest row of the run would no longer be used.
        """
        return [
            Setting(reference, family.name, level)
            for reference, case, family in scope.on_families()
            if is_own(reference) or (scope.statements and (scope.full or reference in EVOLVING))
            if case.proposition == "Prop. 5.4" and touches(case.solution)
            for level in scope.levels_of(case).all[0 if is_own(reference) else -MIN_LEVELS :]
        ]

    def setup(self, setting: Setting) -> Experiment:
        return Experiment.at(setting, MIDPOINT, self.steps(setting))

    def measure(self, setup: Experiment) -> Numbers:
        """Return the measured columns of a row of ``contact.csv``; the number of time steps must be even."""
        forces = Forces(setup)
        errors, penetration, pulling = errors_in_time(setup, forces, setup.steps)
        coarse, *_ = errors_in_time(setup, forces, setup.steps // 2)
        shares = abs(errors - coarse) / errors
        return {
            "h": setup.space.h,
            "steps": setup.steps,
            **dict(zip(FORCE_ERRORS, errors.tolist(), strict=True)),
            **dict(zip(TIME_SHARES, shares.tolist(), strict=True)),
            "penetration": penetration,
            "pulling": pulling,
            "clamped": forces.clamped,
        }

    def checks_of(self, case: str, groups: Groups) -> Judged:
        norms = []
        clamped = any(table["clamped"].any() for table in groups.values())
        for check in FORCE_NORMS:
            if clamped and check.key == "order-resultant":
                yield replace(check, if_missed=NO_BOUND), groups
            else:
                norms.append((check, groups))
        irregular, others = split(groups, "irregular")
        if others:
            norms.append((PRESSURE_ORDER, others))
        if irregular and case == LANDS:
            norms.append((OF_CHANCE, irregular))
        elif irregular:
            yield OF_CHANCE, irregular
        superclose_order, other_order = DUAL_ORDERS
        superclose, other = split(groups, "superclose")
        if superclose:
            norms.append((superclose_order, superclose))
        if other:
            norms.append((replace(other_order, if_missed=CORNER_CELLS if clamped else ""), other))
        for check, tables in norms:
            if case == LANDS:
                jump = around(0.5, 0.2, "k^{1/2}") if check.key.startswith("order") else Window()
                check = replace(check, window=jump, if_missed=NO_ORDER)
            yield check, tables
        yield from ((check, groups) for check in EXACT)

    def steps(self, setting: Setting) -> int:
        # In the plane the error in space falls faster than h. With fewer steps the error in time would be a large part.
        return steps_like_h(setting) * (2 if setting.dim == 2 else 1)
