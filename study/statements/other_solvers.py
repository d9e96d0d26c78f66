"""Comparison of the results with a second, independent solver and with contact codes of other people."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

import numpy as np
import pandas as pd
import scipy.sparse as sps
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import nnls
from scipy.sparse.linalg import splu
from skfem import Mesh

from manufactured.body import Kind
from manufactured.exact import ExactSolution
from manufactured.law import Linear
from manufactured.tensors import Array, Tensors, mandel
from study.fem.error_norm import rules
from study.fem.naming import family_named, resolve
from study.fem.quadrature import blocks, facet_rule
from study.ledger.check import accuracy
from study.ledger.codes import FROZEN, MADE, MARCH, NOT_EXPRESSED, OtherErrors
from study.ledger.datafiles import CsvFile
from study.ledger.quantities import quotients
from study.ledger.verdict import BECAUSE, HOLDS, NOWHERE, REPORTED, UNDECIDED, Verdict, row
from study.ledger.window import Window, around, at_most, positive_at_most
from study.solve.evolution import histories
from study.solve.signorini import ContactSolution
from study.solve.tableau import MIDPOINT
from study.statements.prop_5_4 import RATES, RateSetting
from study.statements.shared import estimates
from study.statements.shared.base import JOINED_SUFFIX as OF_FILE
from study.statements.shared.base import Experiment, ListedNumbers, Numbers, Setting, Statement, grid, with_h
from study.statements.shared.norms import hat_functions, maximum
from study.statements.shared.scope import Scope
from study.statements.shared.tasks import FROZEN_TIMES, Task

FINE_DEGREE = {2: 10, 3: 6}
"""Degrees of the quadrature rule on cells in 2D and in 3D. The first solver uses the degrees 4 and 2."""
FINE_POINTS = {2: 20, 3: 6}
"""Number of Gauss points on a contact facet in 2D, and in each direction of a facet in 3D."""
SETTLED, MOST_ITERATIONS = 1e-12, 100
"""Relative change at which the fixed-point iteration of a time step stops, and its largest number of iterations."""
ON = 1e-9
"""Relative tolerance for vertices on a boundary part.

A vertex lies on the part if its distance is below this number times the largest extent of the mesh."""
Trajectory = tuple[Array, Array]
"""A discrete solution at the time nodes: displacements u_n, (N + 1, n), and contact forces λ_n, (N + 1, m)."""


class PlainProblem:
    """A second, simple solver of the semi-discrete contact problem (Problem 5.1), for tests of the first solver.

    ``Recomputed`` compares both solvers. They share only the exact solution, the mesh, the points of quadrature, and
    the traces of the hat functions on Γ3. In this solver gradients come from inverse matrices of coordinates. Integrals
    are sums over the points of a finer quadrature rule, without the faster formulas of ``study.fem``. The law is
    evaluated at these points.

    A step of the midpoint rule

        M (u_n − u_{n−1})/k + (Gε((u_n + u_{n−1})/2), ε(·))_Q + Nᵀλ_n = F(t_{n−1/2})

    is solved by a fixed-point iteration for u_n, also for a linear law. SuperLU factorises M. The method of Lawson and
    Hanson computes the contact forces in each iteration.

    Args:
        solution: the exact solution, which gives the body, the law, the loads and the initial displacement.
        mesh: the mesh, of triangles or tetrahedra. A function in V^h, the P1 displacements that vanish on Γ1, is stored
            as the array of its n unknowns.

    Attributes:
        solution, dim: the exact solution, and the dimension of the body.
        free: the indices of the n unknowns among the values at all vertices, which are ordered vertex by vertex, (n,).
        at_vertices: the exact solution at the vertices.
        E: the matrix from unknowns to strains, (D · cells, n). The rows for all components 11 come first.
        cell, weights: the cell and the quadrature weight of each quadrature point, (points,) each.
        sums: the matrix that integrates values at the points over each cell, (cells, points).
        law, exact: the law and the exact solution at the points.
        faces: for each contact face the matrix that maps the pressure at its quadrature points to a load, (n, points),
            and the exact solution at these points.
        M: the matrix of the viscous form (A ε(u), ε(v))_Q, (n, n).
        elastic: the function v ↦ (Gε(v), ε(·))_Q, (n,) → (n,).
        N: the matrix that maps v to its normal displacements v_ν at the contact vertices that are not clamped, with one
            row for each vertex and normal, (m, n).
    """

    def __init__(self, solution: ExactSolution, mesh: Mesh) -> None:
        self.solution = solution
        self.dim = int(mesh.dim())
        tolerance = ON * float(np.ptp(mesh.p))
        clamped = np.any([part.contains(mesh.p, tolerance) for part in solution.body.of(Kind.CLAMPED)], axis=0)
        self.free = np.flatnonzero(np.repeat(~clamped, self.dim))
        self.at_vertices = solution.at(mesh.p)
        self._set_strains(mesh)
        self.faces = []
        selected = sps.eye_array(clamped.size, format="csr")
        rows = []
        for face in solution.faces:
            touching = face.part.contains(mesh.p, tolerance)
            boundary = mesh.boundary_facets()
            facets = boundary[touching[mesh.facets[:, boundary]].all(axis=0)]
            rule = facet_rule(mesh, facets, face.part, face.rough, FINE_POINTS[self.dim])
            nodal = hat_functions(mesh, rule).T * rule.weights.ravel()
            load = sps.csr_array(sps.kron(nodal, face.part.normal[:, None]))[self.free]
            self.faces.append((load, solution.on(face, rule.s)))
            rows.append(sps.kron(selected[touching & ~clamped], face.part.normal[None]))
        every = sps.csr_array(sps.vstack(rows))[:, self.free]
        # A vertex on two faces with equal normals has one row.
        _, first = np.unique(every.toarray().round(9), axis=0, return_index=True)
        self.N = every[np.sort(first)]
        self.M = self._form(self.law.A)
        self._solve = splu(self.M, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}).solve
        if isinstance(solution.law.G, Linear):
            self.elastic = self._form(self.law.G).__matmul__
        else:
            self.elastic = lambda v: self.work(self.law.G(self.strain(v)))
        # M⁻¹Nᵀ, and R with RᵀR = NM⁻¹Nᵀ.
        self._response = self._solve(self.N.T.toarray())
        self._root = cholesky(self.N @ self._response)

    def _set_strains(self, mesh: Mesh) -> None:
        """Set the quadrature points in the cells, with the law and the exact solution there, and the strain matrix."""
        on_cells = rules(self.solution, mesh, FINE_DEGREE[self.dim])
        self.cell = np.concatenate([np.repeat(rule.cells, rule.weights.shape[1]) for rule in on_cells])
        self.weights = np.concatenate([rule.weights.ravel() for rule in on_cells])
        self.sums = sps.csr_array((self.weights, (self.cell, np.arange(self.cell.size))))
        points = np.concatenate([rule.points.reshape(self.dim, -1) for rule in on_cells], axis=1)
        self.law = self.solution.law.at(points)
        self.exact = self.solution.at(points)
        # The basis functions are φ_i e_k, where φ_i is the hat function of a vertex.
        corners = mesh.p[:, mesh.t].T
        gradients = np.linalg.inv(np.insert(corners, 0, 1.0, axis=2))[:, 1:]
        strains = mandel(np.einsum("jk,cli->jlcik", np.eye(self.dim), gradients))
        numbers = np.broadcast_to(self.dim * mesh.t.T[..., None] + np.arange(self.dim), strains.shape)
        ends = np.arange(0, strains.size + 1, (self.dim + 1) * self.dim)
        self.E = sps.csr_array((strains.ravel(), numbers.ravel(), ends))[:, self.free]

    def _form(self, law: Callable[[Tensors], Tensors]) -> sps.csc_array:
        """Return the matrix of the form (Cε(u), ε(v))_Q for a linear law C, (n, n)."""
        units = np.eye(self.E.shape[0] // self.sums.shape[0])
        columns = [self.sums @ law(np.tile(unit[:, None], self.cell.size)).T for unit in units]
        components = np.transpose(columns, (2, 0, 1))
        tensor = sps.block_array([[sps.diags_array(values) for values in row] for row in components])
        return sps.csc_array(self.E.T @ tensor @ self.E)

    def work(self, stress: Tensors) -> Array:
        """Return the work (σ, ε(φ_i))_Q of a stress σ on the strain of every basis function φ_i of V^h.

        Args:
            stress: σ at the quadrature points in the cells, (D, points), or at several times, (D, points, times).

        Returns:
            The work, (n,) or (n, times), for the n unknowns.
        """
        return self.E.T @ np.concatenate([self.sums @ component for component in stress])

    def strain(self, v: Array) -> Tensors:
        """Return the strain ε(v) of a P1 displacement v at the quadrature points in the cells, (n,) → (D, points)."""
        return np.take((self.E @ v).reshape(-1, self.sums.shape[0]), self.cell, axis=1)

    def load(self, times: Array) -> Array:
        """Return the load vectors F(t) at several times, (times,) → (n, times).

        Their entries are (σ, ε(φ_i))_Q + ∫_{Γ3} p φ_iν for the basis functions φ_i of V^h, with the exact stress σ and
        the exact contact pressure p.
        """
        on_faces = [load @ exact.pressure(times).reshape(-1, times.size) for load, exact in self.faces]
        return self.work(self.exact.stress(times)) + np.sum(on_faces, axis=0)

    def interpolant(self, time: float) -> Array:
        """Return the nodal interpolant Π^h u(t) of the exact displacement, (n,)."""
        return self.at_vertices.displacement(time).T.ravel()[self.free]

    def contact(self, b: Array, k: float) -> ContactSolution:
        """Solve the contact problem of one time step by the method of Lawson and Hanson.

        The problem is M u/k + Nᵀλ = b, N u ≤ 0, λ ≥ 0, λ·N u = 0, with the matrix M of the viscous form and the
        constraint matrix N. With RᵀR = NM⁻¹Nᵀ, λ minimises |Rλ − R⁻ᵀNM⁻¹b| over λ ≥ 0.

        Args:
            b: the right-hand side, (n,).
            k: the time step.

        Returns:
            The displacement u, (n,), and the multipliers λ, (m,).
        """
        free = self._solve(b)
        multipliers, _ = nnls(self._root, solve_triangular(self._root, self.N @ free, trans="T"))
        return k * (free - self._response @ multipliers), multipliers

    def trajectory(self, steps: int, load: Callable[[Array], Array]) -> Trajectory:
        """Solve the problem by the midpoint rule from the initial value Π^h u_0, the nodal interpolant.

        Args:
            steps: the number of time steps.
            load: the function from several times to the load vectors F at these times, (times,) → (n, times).

        Returns:
            The displacements, (steps + 1, n), and the contact forces, (steps + 1, m), at the time nodes. The contact
            forces at t = 0 are set to 0.
        """
        k = self.solution.body.T / steps
        u = self.interpolant(0.0)
        guess = u
        displacements = [u]
        forces = [np.zeros(self.N.shape[0])]
        loads = [load(times) for times in blocks((np.arange(steps) + 0.5) * k, self.cell.size)]
        for at_midpoint in np.hstack(loads).T:
            before = u
            b = at_midpoint + self.M @ u / k
            for _ in range(MOST_ITERATIONS):
                u, multipliers = self.contact(b - self.elastic((guess + before) / 2), k)
                if self.norm(u - guess) <= SETTLED * self.norm(u):
                    break
                guess = u
            guess = 2 * u - before
            displacements.append(u)
            forces.append(multipliers)
        return np.array(displacements), np.array(forces)

    def norm(self, v: Array) -> float:
        """Return the norm ‖v‖_V of a P1 displacement v, given by its n unknowns, (n,)."""
        return math.sqrt(v @ (self.M @ v))

    def distance(self, time: float, *functions: Array) -> list[float]:
        """Return the distances ‖u(t) − v‖_V of the exact displacement u(t) from several P1 displacements v.

        Args:
            time: the time t.
            functions: the unknowns of each displacement v, (n,) each.

        Returns:
            One distance for each displacement v, in their order.
        """
        missing = [self.exact.strain(time) - self.strain(v) for v in functions]
        return [math.sqrt(np.sum(self.law.A(each) * each, axis=0) @ self.weights) for each in missing]


SECOND_ERRORS = "error", "interpolation_error", "discrete_error"
"""Columns with the largest errors over the time nodes, by the second solver.

They are the norms in V of the error u − u^h, the interpolation error u − Π^h u and the discrete error Π^h u − u^h."""
GAPS = "displacement", "multipliers"
"""Columns with relative differences between both solvers.

They compare displacements at all times, in the norm of V, and nodal contact forces."""
SAME_LOAD = "displacement_same_load", "multipliers_same_load"
"""Columns with the differences of displacements and contact forces if both solvers use the load of the study."""
TINY_START = 1e-12
"""An initial displacement counts as zero if its norm is at most this number times the largest norm over time."""


def gaps(setup: Experiment, plain: PlainProblem, own_load: Trajectory, same_load: Trajectory) -> Numbers:
    """Return the relative differences between the study and the second solver, by the names of columns.

    The column "start" has the difference of initial values, and the columns ``GAPS`` the differences of displacements
    and contact forces. The columns ``SAME_LOAD`` have the differences of displacements and contact forces if both
    solvers use the load of the study. A difference of displacements is the largest norm in V over time. A difference of
    contact forces is the Euclidean norm over all times. Each is divided by the same norm of the result of the second
    solver with its own load.

    Args:
        setup: the experiment of the study.
        plain: the problem of the second solver.
        own_load, same_load: the trajectories of the second solver with its own load and with the load of the study.
    """
    u, multipliers = histories(setup.march(2 * setup.steps))
    sizes = [plain.norm(v) for v in own_load[0]]
    size_of_forces = np.linalg.norm(own_load[1])
    # Both loads start from the same initial value.
    start = max(sizes[0], TINY_START * max(sizes))
    numbers: Numbers = {"start": quotient(plain.norm(u[0] - own_load[0][0]), start)}
    for (of_displacement, of_forces), (displacements, forces) in ((GAPS, own_load), (SAME_LOAD, same_load)):
        numbers[of_displacement] = maximum(map(plain.norm, u - displacements)) / maximum(sizes)
        numbers[of_forces] = quotient(np.linalg.norm(multipliers - forces), size_of_forces)
    return numbers


def quotient(difference: Any, size: Any) -> float:
    """Return a difference relative to a size. If the size is 0, return 1 if there is a difference, otherwise 0."""
    return float(difference / size if size else difference > 0)


IN_BOTH = "in rates.csv / computed again"
FORCES = "|λ − λ̃| / |λ̃| over all steps"
DISPLACEMENTS = "max_n ‖u^h_n − ũ^h_n‖_V / max_n ‖ũ^h_n‖_V"
BOTH_SAME_LOAD = "both with the same load"
TRAJECTORIES = (
    accuracy("start", "‖u^h_0 − ũ^h_0‖_V / ‖ũ^h_0‖_V", "start", at_most(1e-10, "of ‖Π^h u_0‖_V; only rounding")),
    accuracy(
        "displacement",
        DISPLACEMENTS,
        "displacement",
        at_most(2e-3, "of ‖u^h‖_V; the load is integrated by two rules"),
    ),
    accuracy("multipliers", FORCES, "multipliers", at_most(0.01, "of λ; the load is integrated by two rules")),
    accuracy(
        "displacement-same-load",
        f"{DISPLACEMENTS}, {BOTH_SAME_LOAD}",
        "displacement_same_load",
        positive_at_most(1e-9, "of ‖u^h‖_V; tolerances of both solvers"),
    ),
    accuracy(
        "multipliers-same-load",
        f"{FORCES}, {BOTH_SAME_LOAD}",
        "multipliers_same_load",
        at_most(1e-9, "of λ; tolerances of both solvers"),
    ),
)
NARROW_PATCHES = ("travelling-patch",)
"""Cases whose contact patch is only two or three cells wide on the coarsest meshes."""


class Recomputed(Statement):
    """Compares errors, displacements and contact forces of the study with the results of a second solver.

    The criteria of Proposition 5.4 do not notice small mistakes: an error that is wrong by five per cent has the same
    order. Therefore the rows of ``rates.csv`` on the coarsest meshes are computed again: ``PlainProblem`` solves the
    same discrete problems with other quadrature, assembly and solvers.

    **Measured** are

    * the errors of the second solver, which are compared with the errors in ``rates.csv``;
    * the differences between the trajectories of both solvers, that is, between their discrete solutions over time. A
      wrong load, modulus, initial value or time step changes a trajectory to first order, but an error only to second
      order;
    * the same differences if the second solver uses the load of the study.

    **Predicted** differences:

    * Errors agree within 0.5 %. ``ErrorNorm`` integrates by rules of degree 4 with points moved along the face, the
      second solver by rules of degree 10. Checks of ``rates.csv`` bound the effect of quadrature on an error by 2 %.
      Both rules cut the same cells, so their difference is much smaller.
    * Discrete errors are a few times smaller than errors, and agree within 1 %.
    * Displacements agree within 2e-3. Trajectories differ only because of the load. Its relative quadrature error is
      smaller by a power of h than the error of the solution.
    * Nodal forces agree within 1 %, because they are differences of large terms.
    * Initial values Π^h u_0 agree up to rounding, because they need no quadrature.
    * With the same load, displacements and forces agree to 1e-9. Both solvers then solve the same discrete problem with
      exact quadrature. Both stop at 1e-12 of the solution, there are some tens of steps, and nodal forces are
      differences that lose a digit or two. So these checks notice relative defects of 1e-9 in a modulus, an initial
      value or a force.
    """

    label = "computed again"
    claim = "the errors in rates.csv, computed again from Problem 5.1 with other quadrature, assembly and solvers"
    file = CsvFile("recomputed.csv")
    joined_file = RATES
    per_step = 120.0, 600.0
    checks = (
        accuracy(
            "error", f"‖u − u^h‖_V {IN_BOTH}", quotients(f"error{OF_FILE}", "error"), around(1, 0.005, "quadrature")
        ),
        accuracy(
            "interpolation-error",
            f"‖u − Π^h u‖_V {IN_BOTH}",
            quotients(f"interpolation_error{OF_FILE}", "interpolation_error"),
            around(1, 0.005, "quadrature"),
        ),
        accuracy(
            "discrete-error",
            f"‖Π^h u − u^h‖_V {IN_BOTH}",
            quotients(f"discrete_error{OF_FILE}", "discrete_error"),
            around(1, 0.01, "quadrature, also of the load"),
        ),
        *TRAJECTORIES,
    )

    def settings(self, scope: Scope) -> list[RateSetting]:
        """Return the settings: every case on all its mesh families in the study, on the coarsest level.

        On random meshes the cases of Proposition 5.3 and the cases with a narrow contact patch are left out. Their
        quadrature error depends on the random size of a few cells, at the singularity or below the patch.
        """
        return [
            RateSetting(reference, family.name, level, scope.scheme, scope.steps(case, level))
            for reference, case, family in scope.on_families()
            if scope.scheme == MIDPOINT.name
            if not (family.random and (case.proposition == "Prop. 5.3" or case.name in NARROW_PATCHES))
            for level in scope.levels_of(case).all[:1]
        ]

    def setup(self, setting: RateSetting) -> Experiment:
        return Experiment.at(setting, MIDPOINT, setting.steps)

    def measure(self, setup: Experiment) -> Numbers:
        """Solve an experiment again by the second solver, and return the measured columns of ``recomputed.csv``.

        The columns are the largest errors of the second solver over time, and the differences of both solvers
        (``gaps``). Both solvers use half the time step of the experiment, because ``rates.csv`` has the errors with
        half the time step.

        Args:
            setup: the experiment, which the first solver solves as well.
        """
        plain = PlainProblem(setup.solution, setup.space.mesh)
        steps = 2 * setup.steps
        own_load, same_load = (plain.trajectory(steps, load) for load in (plain.load, setup.problem.load))
        errors = []
        for n, u in enumerate(own_load[0]):
            time = n * setup.problem.T / steps
            interpolant = plain.interpolant(time)
            errors.append([*plain.distance(time, u, interpolant), plain.norm(interpolant - u)])
        largest = dict(zip(SECOND_ERRORS, np.max(errors, axis=0), strict=True))
        return {"h": setup.space.h, **largest, **gaps(setup, plain, own_load, same_load)}

    def memory(self, setting: RateSetting) -> float:
        return estimates.SMALL_MEMORY if setting.dim == 2 else estimates.SOLID_MEMORY


LABEL = "other codes"
ALL_PROBLEMS = "all cases"


ROUNDED_IN_FILES = at_most(1e-10, "of the error; ten times the rounding of numbers in a task file")


@dataclass(frozen=True)
class Peer:
    """A contact code of other people, its parameters, and the tolerance for the difference from this study.

    The difference is the relative difference of the errors in V. Only codes are compared that, according to their
    documentation, impose the contact condition at vertices. scikit-fem is not compared, because this study uses it for
    assembly.

    Attributes:
        key: the key of the check that compares the code with this study.
        code, variant: the name and the parameters of the code, as in ``errors.csv``.
        window: the window of |error of the code / error of this study − 1|.
    """

    key: str
    code: str
    variant: str
    window: Window = ROUNDED_IN_FILES


THIS_STUDY = "this study", "condensed active set"
PEERS = (
    Peer("snesvi", "DOLFINx + PETSc SNESVI", "vinewtonrsls, rtol 1e-12"),
    Peer("getfem", "GetFEM", "nodal augmented Lagrangian, r = g"),
    Peer("freefem", "FreeFEM", "scripted primal-dual active set"),
    Peer(
        "kratos",
        "Kratos",
        "ALM mortar, foundation as fine as the face",
        at_most(1e-8, "of the error; this code evaluates contact in the deformed position, 1e-5 away"),
    ),
)
PLANE = "advance-recede", "rotated", "corner", "layered", "anisotropic", "lift-and-land"
MARCHED = frozenset(grid(("advance-recede", "anisotropic"), ("one-diagonal",), (8, 16, 32)))
"""The settings (case, mesh family, level) in which solutions in time of other codes are compared as well."""
PROBLEM_KEY = ["case", "family", "level", "quantity"]
"""The columns that identify a problem. The column "quantity" is the mode, static ("frozen") or in time ("march")."""


class OtherCodes(ListedNumbers):
    """Compares errors of this study with errors of contact codes of other people, on the same discrete problems.

    A program may contain the same mistake as its author's test. Therefore contact codes of other people solved problems
    of these cases: static ("frozen") problems, and in two cases problems in time by the midpoint rule, in which each
    step of a code starts from the result of its previous step. The problems are plain data (``shared.tasks``) with
    mesh, loads and exact solution. The codes used their own assembly and contact algorithms; for FreeFEM this is a loop
    in its scripting language, as in its documentation.

    **Measured** are the errors in V of the same problems with the quadrature and the solver of this study. They are
    compared with the errors of the codes, which ``make codes`` wrote; a script that imports only NumPy computed them.

    **Predictions.**

    * Errors agree to 1e-10. Numbers of a task are rounded to 13 digits. This changes a strain by about 1e-13 ‖u‖/h,
      which is at most 1e-11 of the error on these meshes. A code that imposes the contact condition at vertices by
      multipliers finds the solution in K^h up to rounding of its linear solver. With a condition number like h^−2 this
      rounding is less than 1e-11.
    * The same holds for solutions in time, because time steps do not amplify perturbations.
    * Errors of Kratos were predicted to agree to 1e-5. Kratos imposes contact in the deformed configuration. Therefore
      its loads are multiplied by 1e-5: points then move by about 1e-5, and displacements change by about 1e-5 of their
      size. 5e-10 was measured, and the window was narrowed to 1e-8.

    **No copies.** A further check tests that no column of errors was copied from another code. A task contains the
    solution in K^h with 14 digits. The distance of a code from it has two parts: the missing digits, which are the same
    for all codes, and the round-off of the linear solver of the code. The second part is about a thousandth of the
    distance. So two codes agree by chance in the nine reported digits on one mesh in a million; copied columns agree on
    all meshes. (The errors cannot be used for this test: in double precision they agree on up to three meshes of
    eight.)
    """

    label = LABEL
    claim = "other codes have the same errors as this study, in static problems and in time stepping"
    joined_file = OtherErrors("codes/errors.csv", label=LABEL)
    quick = grid(("advance-recede",), ("one-diagonal",), (8,))
    full = (
        *grid(PLANE, ("one-diagonal", "shaken"), (8, 16, 32)),
        *grid(("cube-disc",), ("one-diagonal",), (4, 8)),
        *grid(("cube-two-faces",), ("one-diagonal",), (3, 6)),
    )

    def measure(self, setting: Setting) -> Numbers:
        task = Task(resolve(setting.case), family_named(setting.family), setting.level)
        errors = {FROZEN: task.error(FROZEN_TIMES)}
        if setting in MARCHED:
            errors[MARCH] = task.error_of_march(setting.level)
        return with_h(task.space.h, errors)

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        rows = rows.rename(columns=lambda name: name.removesuffix(OF_FILE))
        if "code" not in rows or rows["code"].isna().all():
            nothing = float("nan"), NOWHERE, REPORTED
            made = f"no claim: these data lack the file with errors of other codes, which `{MADE}` makes"
            return [row(self, "none", "errors of other codes", Window(), nothing, ALL_PROBLEMS, expected=made)]
        return [*(self.agreement(rows, peer) for peer in PEERS), self.own_digits(rows)]

    def agreement(self, rows: pd.DataFrame, peer: Peer) -> Verdict:
        """Return the check that compares the errors of one code with the errors of this study.

        It is undecided if the code lacks a problem without a documented reason.

        Args:
            rows: the rows of ``statements.csv`` joined with ``codes/errors.csv``: one row for each problem and code,
                with the columns of both files.
            peer: the code, with the tolerance for the difference.
        """
        problems = rows_of(rows, peer.code, peer.variant)
        run = problems[problems["class"] != NOT_EXPRESSED]
        missing = len(rows[PROBLEM_KEY].drop_duplicates()) - len(problems)
        name = f"{peer.code} {' '.join(sorted(run['version'].unique()))}, {peer.variant}"
        quantity = f"{name}: |‖u − u^h‖_V / error of this study − 1|, {len(run)} problems"
        judged = accuracy(peer.key, quantity, differences, peer.window, levels=0).verdict(self, ALL_PROBLEMS, {"": run})
        if not missing:
            return judged
        verdict = UNDECIDED if judged.verdict == HOLDS else judged.verdict
        return replace(judged, verdict=verdict, expected=f"{judged.expected}{BECAUSE}{missing} problems lack an error")

    def own_digits(self, rows: pd.DataFrame) -> Verdict:
        """Return the check that no code copied the results of another.

        For every pair of codes, this study included, problems are counted in which both have the same distance from the
        discrete solution. The largest fraction of such problems is judged.

        Args:
            rows: the rows of ``statements.csv`` joined with ``codes/errors.csv``.
        """
        names = [THIS_STUDY, *((peer.code, peer.variant) for peer in PEERS)]
        columns = [rows_of(rows, *name).set_index(PROBLEM_KEY)["distance"].dropna() for name in names]
        both = [pd.concat(pair, axis=1, join="inner").to_numpy() for pair in combinations(columns, 2)]
        shares = np.array([np.mean(pair[:, 0] == pair[:, 1]) for pair in both if len(pair)])
        quantity = "share of problems in which two codes have the same distance from the solution in K^h"
        return accuracy(
            "own-digits",
            quantity,
            lambda _: shares,
            at_most(0.1, "equal to nine digits; 1 if one code copies the solutions of another"),
            levels=0,
        ).verdict(self, ALL_PROBLEMS, {"": rows})

    def cost(self, setting: Setting) -> float:
        """Return the expected run time in µs.

        If the setting has a solution in time, the run time is multiplied by the level n, which is the number of time
        steps.
        """
        return super().cost(setting) * (setting.level if setting in MARCHED else 1)


def differences(rows: pd.DataFrame) -> Array:
    """Return |error/value − 1| for the errors of another code and the errors of this study in each row, (rows,).

    Args:
        rows: the errors of the other code in the column ``error``, and the errors of this study in the column
            ``value``.
    """
    return (rows["error"] / rows["value"] - 1).abs().to_numpy()


def rows_of(rows: pd.DataFrame, code: str, variant: str) -> pd.DataFrame:
    """Return the rows with the errors of one code and variant, for the quantity that the code computed.

    A row belongs to one problem of this study and one code. It is selected if the column "mode" of the code, static
    ("frozen") or in time ("march"), agrees with the column "quantity" of this study.

    Args:
        rows: the rows of ``statements.csv`` joined with ``codes/errors.csv``.
        code, variant: the name and the parameters of the code.
    """
    return rows[(rows["mode"] == rows["quantity"]) & (rows["code"] == code) & (rows["variant"] == variant)]
