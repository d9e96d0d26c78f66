"""Beyond the paper: the work of contact, its bound on every edge, and the error that moving contact patches add.

The work on an edge is bounded by the Sobolev–Slobodeckij seminorm |v|_ϱ of functions v on an interval, for 0 < ϱ < 1:

    |v|_ϱ² = ∬ |v(x) − v(y)|² |x − y|^{−1−2ϱ} dx dy.

**Locally refined meshes for quadrature.** A solution with details of many sizes needs fine quadrature in a few places.
Cells are divided there by red, green and blue refinement. Every cell is then a union of finer cells, so each function
of V^h is also a P1 function on the finer mesh. Loads and errors of functions in V^h can thus be computed on the finer
mesh, where only the quadrature is approximate.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import product

import numpy as np
import pandas as pd
import scipy.sparse as sps
from scipy.interpolate import make_interp_spline
from scipy.spatial import cKDTree
from skfem import Mesh

from manufactured.body import Kind
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution, FaceFields
from manufactured.face_strain import composite_gauss
from manufactured.modes import at_each
from manufactured.multiscale import ROLLERS, START, FadingFace
from manufactured.tensors import Array, Points
from study.fem.error_norm import FACET_POINTS, ErrorNorm
from study.fem.mesh import Shaken, with_midpoints
from study.fem.naming import family_named, resolve
from study.fem.quadrature import PointsAndWeights, rule_on
from study.fem.space import Space, form
from study.ledger.check import MIN_LEVELS, Check, Groups, accuracy, consequence, identity
from study.ledger.quantities import level_by_level, quotients
from study.ledger.verdict import Verdict
from study.ledger.window import Window, around, at_least, at_most
from study.solve.evolution import SemiDiscrete, furthest, path
from study.solve.signorini import Signorini
from study.solve.steps import rate_steps, step_size
from study.solve.tableau import MIDPOINT
from study.statements.shared.base import (
    SEED,
    ByCase,
    Judged,
    ListedNumbers,
    Numbers,
    Setting,
    check_of_order,
    grid,
    with_h,
)
from study.statements.shared.meshes import posed, split
from study.statements.shared.norms import contact_load, displacement, midpoints, time_nodes, trace_error
from study.statements.shared.scope import Scope

MOST_REFINEMENTS = 40
"""Largest number of successive refinements of a mesh."""


def refined(mesh: Mesh, wanted: Callable[[Points], Array]) -> tuple[Mesh, sps.csr_array]:
    """Refine a mesh until its cells are small enough; return also the matrix that interpolates P1 functions to it.

    Args:
        mesh: a mesh of triangles.
        wanted: function from the corners of cells, (2, 3, cells), to the largest permitted length of the sides of each
            cell, (cells,).

    Returns:
        The refined mesh, and the matrix from vertex values on the given mesh to vertex values on the refined one,
        (refined vertices, vertices).

    Raises:
        ValueError: cells are still too large after ``MOST_REFINEMENTS`` refinements.
    """
    inclusion = sps.csr_array(sps.eye_array(mesh.p.shape[1]))
    for _ in range(MOST_REFINEMENTS):
        corners = mesh.p[:, mesh.t]
        sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=0).max(axis=0)
        large = np.flatnonzero(sides > wanted(corners) * (1 + 1e-9))
        if not large.size:
            return mesh, inclusion
        # The vertices of the finer mesh are old vertices and midpoints of old edges.
        interpolation = with_midpoints(mesh)
        finer = mesh.refined(large)
        distance, rows = cKDTree(interpolation @ mesh.p.T).query(finer.p.T)
        if distance.max() >= 1e-12:
            raise ValueError("a vertex of the finer mesh is no old vertex and no midpoint of an old edge")
        inclusion = sps.csr_array(interpolation[rows] @ inclusion)
        mesh = finer
    raise ValueError(
        f"{large.size} cells are still larger than wanted after {MOST_REFINEMENTS} refinements; ask for a positive, "
        "larger size"
    )


SEMINORM_PANELS, SEMINORM_POINTS = 64, 3
"""The quadrature of the double integral over x and y in the seminorm of H^ϱ(0, 1).

(0, 1) is divided into ``SEMINORM_PANELS`` equal panels with ``SEMINORM_POINTS`` Gauss points each. The rule in y has
one more point in each panel than the rule in x, so that x = y does not occur.
"""


PANEL_ENDS = np.linspace(0, 1, SEMINORM_PANELS + 1)
"""The ends of the equal panels of (0, 1)."""
FIRST, SECOND = composite_gauss(PANEL_ENDS, SEMINORM_POINTS), composite_gauss(PANEL_ENDS, SEMINORM_POINTS + 1)
"""The quadrature rules on (0, 1) for the double integral over x and y of the seminorm, in x and in y."""


def _kernel(first: PointsAndWeights, second: PointsAndWeights, rho: float) -> Array:
    """Return the products of the weights of two quadrature rules with |x − y|^{−1−2ϱ} at all pairs of nodes, (n, m)."""
    (x, wx), (y, wy) = first, second
    return np.asarray(np.multiply.outer(wx, wy) * abs(x[:, None] - y) ** (-1 - 2 * rho))


def seminorm(first: Array, second: Array, rho: float) -> Array:
    """Return the Sobolev–Slobodeckij seminorm |v|_ϱ in H^ϱ of functions v on (0, 1), (...).

    For a Lipschitz v and ϱ ≤ 1/2 the integrand is bounded. The relative error is a few per mille if v has about ten
    oscillations.

    Args:
        first: the values of each v at the n nodes of ``FIRST``, (..., n).
        second: the values of the same v at the m nodes of ``SECOND``, (..., m).
        rho: the order ϱ of the seminorm.
    """
    kernel = _kernel(FIRST, SECOND, rho)
    squares = first**2 @ kernel.sum(axis=1) + second**2 @ kernel.sum(axis=0)
    return np.sqrt(np.maximum(squares - 2 * np.einsum("...i,ij,...j->...", first, kernel, second, optimize=True), 0.0))


@lru_cache
def gram(panels: int, rho: float) -> Array:
    """Return the matrix G with |v|_ϱ² = cᵀ G c for piecewise linear functions v on equal panels of (0, 1).

    Args:
        panels: the number n of panels; c contains the values of v at their n + 1 ends, so G is (n + 1, n + 1).
        rho: the order ϱ of the Sobolev–Slobodeckij seminorm.
    """
    nodes = np.linspace(0, 1, panels + 1)
    rules = composite_gauss(nodes, SEMINORM_POINTS), composite_gauss(nodes, SEMINORM_POINTS + 1)
    hats = [np.maximum(0, 1 - panels * abs(nodes[:, None] - x)) for x, _ in rules]
    kernel = _kernel(*rules, rho)
    mixed = hats[0] @ kernel @ hats[1].T
    squares = [(hat * weights) @ hat.T for hat, weights in zip(hats, (kernel.sum(1), kernel.sum(0)), strict=True)]
    found: Array = squares[0] + squares[1] - mixed - mixed.T
    return found


EQUAL_BRANCHES = 2 / (2 + math.pi**2)
"""The fraction of an edge with a gap at which both expressions for the constant β in ``EdgeWork`` are equal."""
C_0 = math.sqrt((2 + math.pi**2) / (8 * math.pi**2))
EDGE_TIMES = 0.23, 0.5, 0.81
"""Times at which the work of contact on edges is computed, as fractions of the final time T."""
CHANGES = 16
"""Largest number of changes between contact and gap on an edge that is examined.

Its panels (``SEMINORM_PANELS``) do not resolve more changes.
"""
SOBOLEV_EXPONENTS = 0.05, 0.25, 0.5
"""The exponents ϱ of seminorms in H^ϱ for which suprema are computed.

They belong to u ∈ H^{1+s} with s = ϱ + 1/2 = 0.55, 0.75 and 1.
"""
WORK = "R_E / bound"
OF_ALL = "supremum / bound"
OVERALL = "R_E / (h² |σ_ν| |u_ν'|)"
BRANCHES = "edges by |N|", "edges by |C|"
PROVED_ON_EDGES = at_most(1.0, "proved")


class EdgeWork(ListedNumbers):
    """Measures the work of contact |R_E|, the work of the contact pressure on the interpolation error on an edge E.

    Beyond the paper: a bound of the work of contact on every edge, so that Prop. 5.4 needs no trace in H²(Γ3).

    **The bound.** On an edge E of length h let N = {u_ν ≠ 0} be the part with a gap and C = {u_ν = 0} the part in
    contact. R_E = ∫_E σ_ν (Π^h u_ν − u_ν) is the work of contact on E. Since σ_ν = 0 almost everywhere on N, for all 0
    < ϱ < 1 (proof in paper/trace.tex)

        |R_E| ≤ β h^{1+2ϱ} |σ_ν|_{ϱ,E} |u_ν'|_{ϱ,E},
        β = min{(2π)^{−1} (h/|N|)^{1/2}, 8^{−1/2} (h/|C|)^{1/2}} ≤ C_0 < 0.388.

    The sum over edges gives |R| ≤ C_0 h^{2s} Σ_i |σ_ν|_{ϱ,Γ3,i} |u_ν'|_{ϱ,Γ3,i} with ϱ = s − 1/2.

    **Measured** are

    * the quotient |R_E| / bound with ϱ = 1/2 for exact solutions, at several times, on every edge on which neither N
      nor C is empty;
    * the supremum of |∫_E λ Π w| divided by its bound over **all** pressures λ that vanish on N and all piecewise
      quadratic gaps w that vanish on C. The sets N and C belong to the same edges. Each edge is split into 64 equal
      panels, and each panel belongs to N or to C. The functional depends on w only through its values at both ends, so
      it has rank two. The supremum is the root of the largest eigenvalue of a 2 × 2 matrix.

    **Predicted**: both quotients are at most 1, because the bound is proved. For exact solutions they are far below 1,
    because these are not extremal functions. The first expression in β is the smaller one if |N| > 2h/(2 + π²). Both
    kinds of edges must occur, otherwise only one expression is tested.

    **The check can fail**: a deliberate defect adds a constant to the pressure. The constant does not change the
    seminorm, but the pressure no longer vanishes on N, and the bound is exceeded.
    """

    label = "beyond: work on edges"
    claim = "|R_E| ≤ C_0 h^{2s} |σ_ν|_{s−1/2,E} |u_ν'|_{s−1/2,E} on every edge of Γ3, C_0 < 0.388"
    quick = grid(("trains", "merging-patches"), ("one-diagonal",), (16, 32))
    full = (
        *grid(("trains", "breathing-trains"), ("one-diagonal", "unstructured"), (16, 32, 64)),
        *grid(("merging-patches", "natural-front", "rough-1.75"), ("one-diagonal", "unstructured"), (8, 16, 32, 64)),
    )
    checks = (
        identity("solution", "|R_E| / (β h² |σ_ν|_{1/2,E} |u_ν'|_{1/2,E}), largest", WORK, PROVED_ON_EDGES),
        identity(
            "all",
            "supremum of |R_E| / bound over all σ_ν, u_ν' with the same contact zone, s = 0.55, 0.75, 1",
            OF_ALL,
            PROVED_ON_EDGES,
        ),
        identity("constant", "|R_E| / (h² |σ_ν|_{1/2,E} |u_ν'|_{1/2,E}), largest", OVERALL, at_most(C_0, "proved")),
    )

    def settings(self, scope: Scope) -> Sequence[Setting]:
        """Return the settings (case, mesh family, level) in which a study measures the work of contact on edges.

        A study of all statements also has the cases with wave trains, which are not part of the catalogue.
        """
        return self.places(scope.full) if scope.statements else super().settings(scope)

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        table = rows.pivot_table(index=["case", "family", "level"], columns="quantity", values="value")
        return [*super().judge(rows), BOTH_KINDS.verdict(self, "all cases", {"all families": table})]

    def measure(self, setting: Setting) -> Numbers:
        space, solution = posed(setting)
        touching, open_part, of_bound = mixed_edges(solution, space)
        suprema = [supremum(of_edge, rho) for of_edge in touching for rho in SOBOLEV_EXPONENTS]
        numbers = {
            WORK: np.max(of_bound / beta(open_part), initial=0.0),
            OF_ALL: np.max(suprema, initial=0.0),
            OVERALL: np.max(of_bound, initial=0.0),
            BRANCHES[0]: np.sum(open_part >= EQUAL_BRANCHES),
            BRANCHES[1]: np.sum(open_part < EQUAL_BRANCHES),
        }
        return with_h(space.h, numbers)


BOTH_KINDS = accuracy(
    "branches",
    "number of edges with β from |N|, and with β from |C|: the smaller number",
    lambda group: float(group[list(BRANCHES)].to_numpy().sum(axis=0).min()),
    at_least(1, "both expressions for β in the lemma are tested"),
)


def mixed_edges(solution: ExactSolution, space: Space) -> tuple[Array, ...]:
    """Return the work of contact on all edges of Γ3 that have both contact and a gap at a time.

    The work of contact on an edge E is R_E = ∫_E σ_ν (Π^h u_ν − u_ν). Each edge is mapped to the interval (0, 1). The
    map to an edge of length h multiplies R_E by h and leaves the seminorm |·|_{1/2} unchanged.

    Args:
        solution: the exact solution, with contact faces in 2D.
        space: the space V^h, whose mesh has the edges.

    Returns:
        Three arrays for the n edges that are found on all contact faces and at all ``EDGE_TIMES``:

        * whether there is contact at the nodes ``FIRST`` of a quadrature rule on the edge, (n, nodes);
        * the fraction |N|/h of the edge, of length h, with a gap, (n,);
        * the work over its bound without the factor β, |R_E| / (h² |σ_ν|_{1/2,E} |u_ν'|_{1/2,E}), (n,).
    """
    found = []
    for face, part in product(solution.faces, EDGE_TIMES):
        time = part * solution.body.T
        corners = space.mesh.p[:, space.mesh.facets[:, space.facets(face.part)]]
        ends = np.sort(face.part.coordinates(corners)[0][0], axis=0)
        touching = face.level_jet(linear(ends, FIRST[0])[None], time)[(0,)] >= 0
        changes = np.count_nonzero(np.diff(touching), axis=1)
        chosen = (changes >= 1) & (changes <= CHANGES)
        ends = ends[:, chosen]
        touching = touching[chosen]
        places = [linear(ends, x) for x, _ in (FIRST, SECOND)]
        pressure, other_pressure = (solution.on(face, s[None]).stated_pressure(time) for s in places)
        gap, other_gap = (face.gap_jet(s[None], time, 1) for s in places)
        interpolant = linear(face.gap_jet(ends[None], time)[(0,)], FIRST[0])
        h = ends[1] - ends[0]
        work = h * (pressure * (interpolant - gap[(0,)]) @ FIRST[1])
        of_slope = seminorm(gap[(1,)], other_gap[(1,)], 0.5)
        quotients = abs(work) / (h**2 * seminorm(pressure, other_pressure, 0.5) * of_slope)
        found.append((touching, 1 - touching @ FIRST[1], quotients))
    return tuple(map(np.concatenate, zip(*found, strict=True)))


def linear(ends: Array, x: Array) -> Array:
    """Return the values at points of functions that are linear on (0, 1), (n, points).

    Args:
        ends: the values of the n functions at 0 and at 1, (2, n).
        x: the points of (0, 1), (points,).
    """
    return ends[0][:, None] + (ends[1] - ends[0])[:, None] * x


def beta(open_part: Array) -> Array:
    """Return the constant β of the bound of the work of contact on an edge (``EdgeWork``), for n edges, (n,).

    Args:
        open_part: the fraction of the length of each edge with a gap, strictly between 0 and 1, (n,).
    """
    return np.minimum(1 / np.sqrt(open_part) / (2 * np.pi), 1 / np.sqrt(8 * (1 - open_part)))


def supremum(touching: Array, rho: float) -> float:
    """Return the supremum of the work of contact on an edge over all pressures λ and gaps w, divided by its bound.

    The edge is mapped to the interval (0, 1). Then the result is sup |∫ λ Π w| / (|λ|_ϱ |w'|_ϱ), divided by the
    constant β of the bound. Π w interpolates w linearly, and |·|_ϱ is the seminorm in H^ϱ. The interval is split into
    ``SEMINORM_PANELS`` equal panels, and each panel belongs to the part N with a gap or to the part C in contact. λ and
    w' are continuous and linear on each panel, with λ = 0 on N and w' = 0 on C. The result is 0 if λ or w' must vanish.

    The values of w at both ends of the edge follow from w' on the panels of N there, because w = 0 on the next panel of
    C. Between panels of C the integral of w' must be 0. This condition is ignored, so with a gap between panels of C
    the result is only an upper bound of the supremum.

    Args:
        touching: whether there is contact at the nodes ``FIRST`` of a quadrature rule on the edge, (nodes,).
        rho: the exponent ϱ of the seminorm.
    """
    contact = touching.reshape(SEMINORM_PANELS, -1).mean(axis=1) >= 0.5
    if contact.all() or not contact.any():
        return 0.0
    A = gram(SEMINORM_PANELS, rho)
    nodes = PANEL_ENDS
    mass = np.full(len(nodes), 1 / SEMINORM_PANELS)
    mass[[0, -1]] /= 2
    first, last = np.flatnonzero(contact)[[0, -1]] / SEMINORM_PANELS
    of_pressure = dual_products(A, contact, mass * np.array([1 - nodes, nodes]))
    of_slope = dual_products(A, ~contact, mass * np.array([nodes <= first, nodes > last]))
    largest_value = float(np.max(np.linalg.eigvals(of_pressure @ of_slope).real, initial=0.0))
    return math.sqrt(largest_value) / float(beta(np.array(1 - contact.mean())))


def dual_products(A: Array, panels: Array, functionals: Array) -> Array:
    """Return the products f_i · A⁻¹ f_j of two linear functionals f_1 and f_2 on piecewise linear functions, (2, 2).

    The functions are zero on all panels of the interval (0, 1) that are not marked. So A, f_1 and f_2 are restricted to
    the free nodes: those at which all neighbouring panels are marked.

    Args:
        A: a symmetric matrix of a form on the functions, (nodes, nodes).
        panels: whether each panel is marked, (panels,).
        functionals: the values of the functionals for the hat functions, (2, nodes).
    """
    padded = np.concatenate([[True], panels, [True]])
    free = padded[:-1] & padded[1:]
    if not free.any():
        return np.zeros((2, 2))
    chosen = functionals[:, free]
    return np.asarray(chosen @ np.linalg.solve(A[np.ix_(free, free)], chosen.T))


CELLS_ACROSS_DEPTH = 3
"""Number of cells of the refined mesh across the depth over which contact data are continued into the body."""


class Resolved:
    """The P1 space on a mesh, with a finer mesh for integrals of exact solutions that have details smaller than a cell.

    Args:
        solution: the exact solution.
        space: the P1 displacement space V^h in 2D.

    The finer mesh is made from the mesh of V^h. An exact solution continues gap and pressure of a contact face into the
    body, down to a certain depth. Cells that meet this strip are refined until they are at most a third of the depth.

    Attributes:
        solution, space: the arguments.
        v_norm: computes errors in V, integrated on the finer mesh.
        inclusion: the matrix that maps degrees of freedom of V^h to degrees of freedom on the finer mesh.
        start: the interpolant Π^h u_0 of the initial displacement, (dofs,).
    """

    def __init__(self, solution: ExactSolution, space: Space) -> None:
        mesh, nodal = refined(space.mesh, lambda corners: least_depth(solution, corners) / CELLS_ACROSS_DEPTH)
        fine = Space(mesh, space.body)
        self.solution = solution
        self.space = space
        self.v_norm = ErrorNorm(solution, fine, aligned=False)
        every = sps.csr_array(sps.kron(nodal, sps.eye_array(space.dim)))
        self.inclusion: sps.csr_array = sps.csr_array(every[fine.free][:, space.free])
        self.start = space.interpolate(solution.at(space.mesh.p).displacement(0.0))


def least_depth(solution: ExactSolution, corners: Points) -> Array:
    """Return for each cell the smallest depth of the contact faces whose data are continued into the cell, (cells,).

    An exact solution continues the gap and the pressure of each contact face into the body, down to a certain depth.
    The result is infinite for cells that no face reaches.

    Args:
        solution: the exact solution.
        corners: the corners of the cells, (2, 3, cells).
    """
    depths = np.full(corners.shape[2:], math.inf)
    for face in solution.faces:
        assert isinstance(face, ContactFace | FadingFace)
        (along,), into = face.part.coordinates(corners)
        depth = face.least_depth if isinstance(face, FadingFace) else face.profile.depth
        met = (into.min(axis=0) < depth) & (along.max(axis=0) > 0) & (along.min(axis=0) < face.part.measure)
        depths[met] = np.minimum(depths[met], depth)
    return depths


def pressing_on(at: Resolved) -> Callable[[float], Array]:
    """Return the vector of the exact contact pressure p as a function of the time, (dofs,).

    Its entries are ∫_{Γ3} p v_ν for the basis functions v of V^h, with the outward normal ν. The foundation pushes
    against ν, so this vector is subtracted from the load. p is the prescribed pressure, which is a hundred times faster
    to compute than the pressure from the exact stress.

    Args:
        at: the space V^h and the exact solution.
    """
    load = contact_load(at.solution, at.v_norm.space, (), FaceFields.stated_pressure)
    return lambda time: -np.asarray(at.inclusion.T @ load(time))


FACE_RULE = composite_gauss(np.linspace(0, 1, 513), 4)
"""Quadrature rule on a contact face. Waves are at least 1/64 of the face wide, so each has at least 8 intervals."""
TIME_NODES = 8
"""Number of nodes of the midpoint rule that integrates the work of contact over time."""
DRAWS = 400
"""Number of random sets of vertices on Γ3 over which mean and standard deviation of the work are computed."""


class TotalWork:
    """Computes the work of contact, the work of the contact pressure on the interpolation error, integrated over time.

    It is ∫_0^T R dt with R = ∫_{Γ3} p Π^h w for the pressure p, the gap w and its nodal interpolant Π^h w. R is the
    work on the interpolation error Π^h w − w, because p w = 0. R depends on the mesh only through the vertices on Γ3.
    Time is integrated by the midpoint rule.

    Args:
        solution: the exact solution, with contact faces in 2D.
    """

    def __init__(self, solution: ExactSolution) -> None:
        self.times = midpoints(solution.body.T, TIME_NODES)
        # For each face its quadrature points, and p times the weights in space and time, (points, TIME_NODES).
        self.pieces = []
        for face in solution.faces:
            places, weights = (face.part.measure * values for values in FACE_RULE)
            pressure = solution.on(face, places[None]).stated_pressure(self.times)
            self.pieces.append((face, places, pressure * (weights * solution.body.T / TIME_NODES)[:, None]))

    def __call__(self, vertices: Sequence[Array]) -> float:
        """Return the work of the pressure p on the interpolated gap Π^h w.

        Args:
            vertices: for each contact face, the increasing coordinates of its vertices, (vertices,).
        """
        total = 0.0
        for (face, places, forces), s in zip(self.pieces, vertices, strict=True):
            gaps = face.gap_jet(s[None, :, None], self.times)[(0,)]
            total += np.vdot(forces, make_interp_spline(s, gaps, k=1)(places))
        return total


def vertices_on(space: Space) -> list[Array]:
    """Return for every contact face the coordinates of the mesh vertices along the face, in increasing order.

    Args:
        space: the space V^h in 2D.

    Returns:
        One array for each contact face, (vertices,).
    """
    parts = space.body.of(Kind.CONTACT)
    return [np.sort(part.coordinates(space.mesh.p[:, space.vertices(part)])[0][0]) for part in parts]


def shaken(vertices: Sequence[Array], rng: np.random.Generator) -> list[Array]:
    """Return coordinates of vertices, moved at random by up to a fifth of an edge as on shaken meshes.

    Args:
        vertices: the equidistant, increasing coordinates of the vertices on each contact face, (vertices,) each. The
            end points are not moved.
        rng: the random generator.
    """
    moved = []
    for s in vertices:
        shift = rng.uniform(-1, 1, s.size) * Shaken().amplitude * (s[1] - s[0])
        shift[[0, -1]] = 0
        moved.append(s + shift)
    return moved


COARSEST_LEVEL = 32
"""The coarsest level on which there are wave trains of all widths from h/2 to 4h."""


def from_32(key: str, quantity: str, column: str, window: Window, if_missed: str = "") -> Check:
    """Return the check of the observed orders of a column from level to level, without levels below n = 32.

    Args:
        key: the short name of the check.
        quantity: the judged quantity in words.
        column: the name of the column whose orders in h are observed.
        window: the window in which all orders must lie.
        if_missed: if an order outside the window contradicts no claim, the reason for that.
    """
    orders = level_by_level(column)
    return consequence(
        key,
        f"{quantity}, level by level from n = 32",
        lambda levels: orders(levels[levels["level"] >= COARSEST_LEVEL]),
        window,
        levels=MIN_LEVELS,
        finest=True,
        if_missed=if_missed,
    )


ROOT_ORDER = "order of ‖R(·; Π^h u − u)‖^{1/2}"
FIRST_ORDER = around(1, 0.15, "there are wave trains of all widths from h/2 to 4h")
NOT_RESOLVED = "a mesh resolves a wave train of width ℓ only for h < ℓ/10"
ON_GRIDS = (
    from_32("order", f"{ROOT_ORDER}, on grids", "work", FIRST_ORDER),
    from_32("order-mean", f"{ROOT_ORDER}, R averaged over {DRAWS} random meshes", "mean work", FIRST_ORDER),
    from_32(
        "spread",
        "order of the relative standard deviation of R over random vertices",
        "spread",
        around(0.5, 0.15, "the edges contribute to R like independent random numbers"),
    ),
    consequence(
        "share",
        "smallest ‖R‖^{1/2} / error",
        quotients("work", "error"),
        at_least(0.02, "cases with a few smooth fronts have only 1e-6 to 1e-3"),
    ),
)
ON_IRREGULAR_MESHES = from_32(
    "order-irregular",
    f"{ROOT_ORDER}, on single irregular meshes",
    "work",
    FIRST_ORDER,
    "on irregular meshes single orders depend on chance",
)
NO_BOUND_OF_EXCESS = "the study has no bound of this excess in V"
ON_ALL_MESHES = (
    from_32("error", "order of ‖u − u^h‖_V", "error", Window(), NOT_RESOLVED),
    consequence(
        "excess-share",
        "largest ‖u^h − u^h_lin‖_V / error",
        quotients("excess", "error"),
        Window(),
        if_missed=NO_BOUND_OF_EXCESS,
    ),
    from_32("excess", "order of ‖u^h − u^h_lin‖_V", "excess", Window(), NOT_RESOLVED),
)


class WorkOfContact(ListedNumbers):
    """Measures the square root of the work of contact, the error ‖u − u^h‖_V, and its part that is due to contact.

    Beyond the paper: the work of contact for solutions with contact patches of every size.

    **The question.** The error estimate (5.21) has a contact term, which a linear problem does not have: ‖R(·; Π^h u −
    u)‖^{1/2}_{L¹(0,T)}. It is the root of the *work of contact*, the work of the exact contact force on the
    interpolation error. The term is of order 1 for u ∈ W^{1,1}(0,T;H²), for any trace (``EdgeWork``); for a fixed u it
    is even o(h). In the cases of the catalogue, which have a few smooth fronts, it is 1e-6 to 1e-3 of the error (0.03
    in natural-front, 0.1 in rough-trace). That is too small to be observed. Here it is measured for the cases of
    ``manufactured.multiscale``, whose contact zones have details of the size of h on every mesh.

    **Measured** are three quantities:

    * ``work``: ‖R(·; Π^h u − u)‖^{1/2}_{L¹(0,T)} = (∫_0^T ∫_{Γ3} p Π^h w)^{1/2} with the pressure p and the gap w,
      because p w = 0;
    * ``error``: max_t ‖u − u^h‖_V;
    * ``excess``: max_t ‖u^h − u^h_lin‖_V, where u^h_lin solves the linear problem with p as a given traction. The
      excess is the part of the error that is due to contact.

    The exact solutions continue gap and pressure from Γ3 into the body, down to a depth that may be smaller than a
    cell. So integrals over the body are computed on a refined mesh (``Resolved``), whose cells in this strip are at
    most a third of its depth.

    On grids the work is also measured for many sets of random vertices on Γ3, with its mean and its standard deviation.

    **Predicted**, from the form of gap and pressure. They consist of trains of waves of width ℓ, and ℓ is halved from
    one train to the next. Here R is the integral ∫_0^T ∫_{Γ3} p Π^h w, whose root is ``work``, and R_E is the part of
    it on an edge E.

    * *On grids* all edges are equal and cut every train at the same places. So R/h² is a sum over the trains, and the
      term of a train is a function of ℓ/h. The sum is constant, and the root of R has order 1, as long as there are
      trains of all widths h/2 to 4h. This holds for 32 ≤ n ≤ 128; the window is ± 0.15. On coarser meshes the order is
      lower.
    * *With random vertices* each edge cuts the waves at another place. Only four to sixteen edges lie on the train that
      contributes most, and the contributions R_E of single edges vary by 100 %. So single orders may be off by 0.5;
      they are reported. If this explanation is right, the root of the mean of R over random vertices has the order 1,
      and the relative standard deviation of R falls like n^{−1/2}. Both are claimed.
    * *Unstructured meshes* have equal edges on each piece of Γ3, but their number does not double from level to level.
      The edges cut the waves at other places on every level, all edges in the same way. So the work may nearly vanish
      on one level. The order is reported.
    * *On grids work / error* is above 1/50, twenty times its value for smooth fronts.
    * No order is predicted for the error and the excess. A mesh resolves a train only for h < ℓ/10, so on these meshes
      the error has hardly begun to fall.

    **Found** on unstructured meshes: orders −2.5 to 1.2, and work / error as small as 0.011.
    """

    label = "beyond: work of contact"
    claim = "‖R(·; Π^h u − u)‖^{1/2} = O(h) with contact at every scale, u_ν not bounded in H²(Γ3)"
    outside_catalogue = True
    effort = 5
    # The quick study leaves this statement out, because the claimed orders begin at n = 32, which takes long.
    full = (
        *grid(("trains", "breathing-trains"), ("one-diagonal", "shaken"), (16, 32, 64, 128)),
        *grid(("trains",), ("unstructured",), (16, 32, 64, 128)),
    )

    def measure(self, setting: Setting) -> Numbers:
        space, solution = posed(setting)
        steps = rate_steps(space.body.T, setting.level, resolve(setting.case).pace)
        at = Resolved(solution, space)
        v_norm = at.v_norm
        inclusion = at.inclusion
        press = pressing_on(at)

        def load(times: Array) -> Array:
            return np.asarray(inclusion.T @ v_norm.load(times))

        problem = SemiDiscrete.of(space, solution.law, load, at.start)
        linear = replace(problem, N=problem.N[:0], load=lambda times: load(times) - at_each(times, press))
        states = path(problem, MIDPOINT, steps)
        total = TotalWork(solution)
        vertices = vertices_on(space)
        numbers: Numbers = {
            "error": v_norm.largest(time_nodes(problem.T, steps), (inclusion @ u for u in states)),
            "excess": furthest(problem, states, path(linear, MIDPOINT, steps)),
            "work": math.sqrt(total(vertices)),
        }
        if not family_named(setting.family).irregular:
            rng = np.random.default_rng(SEED)
            works = [total(shaken(vertices, rng)) for _ in range(DRAWS)]
            numbers |= {"mean work": math.sqrt(np.mean(works)), "spread": np.std(works) / np.mean(works)}
        return with_h(space.h, numbers)

    def checks_of(self, case: str, groups: Groups) -> Judged:
        irregular, on_grid = split(groups, "irregular")
        judged = (on_grid, ON_GRIDS), (irregular, (ON_IRREGULAR_MESHES,)), (groups, ON_ALL_MESHES)
        return [(rule, tables) for tables, rules in judged for rule in rules]


# Cases and meshes, chosen to separate meshes with equal neighbourhoods of contact vertices from all others.
ROLLER, PUSHING, STEEP, STANDING = ROLLERS
PLAIN_FAMILIES = "one-diagonal", "criss-cross"
"""Mesh families on which the cells around all vertices of Γ3 are arranged alike."""
ALTERNATING = "alternating"
UNSTRUCTURED = "unstructured"
SEEDS = ("shaken", *(f"shaken-{seed}" for seed in range(1, 8)))
"""Random mesh families over which the measured excess is averaged. The finest level uses the first half of them."""
ROLLER_LEVELS = 16, 32, 64, 128
COARSE_ROLLER_LEVELS = ROLLER_LEVELS[:3]
"""Levels without the finest one, to save time.

They are used for rollers other than ROLLER, for meshes with two diagonals, and for half of the random meshes."""
HALVED = 32
"""The level at which ``Rollers`` also computes the excess with half the time step."""
PER_H = 8
"""Number of time steps in which a roller moves by the length of one edge."""
SAMPLED_PARTS = 32
"""Number of time intervals at whose ends the error and the error of the best approximation, E_h, are measured."""


class OnContact:
    """The semi-discrete problem (Problem 5.1) for A = G, reduced to the normal displacements at the contact vertices.

    For A = G the operator B in (4.2) is the identity. Let P_h be the projection onto V^h in (·,·)_V and π the nodal
    forces of the pressure p. Then Problem 5.1 reads M(u̇^h + u^h) + Nᵀλ = M(P_hu̇ + P_hu) + Nᵀπ. With y = N u^h, g = N
    P_hu and S = (N M⁻¹ Nᵀ)⁻¹ it becomes

        S(ẏ + y) + λ = S(ġ + g) + π,     y ≤ 0,   λ ≥ 0,   λ·y = 0.

    This is again Problem 5.1, with as many unknowns as Γ3 has vertices, so the same time schemes solve it.

    Args:
        at: the P1 space V^h and the exact solution, with one contact face and A = G.

    Attributes:
        at: the argument.
        M: the matrix of the inner product (·,·)_V, (dofs, dofs).
        condensed: the contact solver for the matrix M and the constraint matrix N.
        S: the Schur complement (N M⁻¹ Nᵀ)⁻¹, (m, m).
        start: the interpolant Π^h u_0 of the initial displacement, (dofs,).
        places: the coordinates s of the m contact vertices along Γ3, (1, m).
    """

    def __init__(self, at: Resolved) -> None:
        space = at.space
        solution = at.solution
        self.at = at
        self.M = form(space, solution.law.A)
        self.condensed = Signorini(self.M, space.N)
        inverse = np.linalg.inv(self.condensed.W)
        self.S = (inverse + inverse.T) / 2
        self.start = at.start
        (self._face,) = solution.faces
        (_, vertices) = space.contact[0]
        self.places = self._face.part.coordinates(space.mesh.p[:, vertices])[0]

    def functional(self, time: float) -> Array:
        """Return the products (u(t), v)_V of the exact displacement u with all basis functions v of V^h, (dofs,)."""
        v_norm = self.at.v_norm
        law = self.at.solution.law
        return np.asarray(self.at.inclusion.T @ v_norm.space.functional(law.A.matrix @ v_norm.sample(time).means))

    def projected(self, time: float) -> Array:
        """Return the projection P_hu(t) of the exact displacement onto V^h, orthogonal in (·,·)_V, (dofs,)."""
        return self.condensed.factor(self.functional(time))

    def gap(self, time: float) -> Array:
        """Return the exact gap at the m contact vertices, in the order of the rows of the constraint matrix, (m,)."""
        return self._face.gap_jet(self.places, time)[(0,)]


@dataclass(frozen=True, eq=False)
class Trajectories:
    """Normal displacements at the contact vertices over time, with contact (y) and without contact (y_lin).

    Both are computed by the midpoint rule for the problem ``OnContact``, in which N is the constraint matrix, S = (N
    M⁻¹ Nᵀ)⁻¹, and P_h the projection onto V^h in (·,·)_V with the matrix M. Without contact, the forces λ are the
    forces π of the exact pressure p, so that u^h_lin = P_hu + e^{−t}(Π^h u_0 − P_hu_0). Contact adds the displacement z
    = M⁻¹Nᵀc with c = S(y − y_lin), and

        ‖u^h − u^h_lin‖_V² = cᵀ N z = (y − y_lin)ᵀ S (y − y_lin).

    Attributes:
        on: the reduced problem.
        steps: the number of time steps.
        k: the time step.
        projected: the normal displacements g = N P_hu of the projection at the time nodes, (steps + 1, m).
        forces: the exact contact forces π in the middle of each step, (steps, m).
        contact, linear: y and y_lin at the time nodes, (steps + 1, m).
    """

    on: OnContact
    steps: int
    k: float
    projected: Array
    forces: Array
    contact: Array
    linear: Array

    @classmethod
    def of(cls, on: OnContact, steps: int) -> Trajectories:
        """Solve the reduced problem with and without contact by the midpoint rule.

        The values of g = N P_hu, the normal displacements of the projected exact displacement, and of ġ in the middle
        of a step are computed from g at its ends.

        Args:
            on: the reduced problem.
            steps: the number of time steps.
        """
        T = on.at.space.body.T
        k = step_size(T, steps)
        N = on.at.space.N
        projected = on.condensed.gap(np.array([on.functional(time) for time in time_nodes(T, steps)]))
        forces = at_each(midpoints(T, steps), pressing_on(on.at)).T @ N.T
        moved = (np.diff(projected, axis=0) / k + (projected[1:] + projected[:-1]) / 2) @ on.S

        def during(values: Array) -> Callable[[Array], Array]:
            return lambda times: values[np.rint(times / k - 0.5).astype(int)].T

        S = sps.csc_array(on.S)
        start = N @ on.start
        contact = SemiDiscrete(S, S, None, sps.csr_array(np.eye(len(start))), during(moved + forces), start, T)
        linear = replace(contact, N=contact.N[:0], load=during(moved))
        return cls(on, steps, k, projected, forces, path(contact, MIDPOINT, steps), path(linear, MIDPOINT, steps))

    @cached_property
    def nodal_errors(self) -> Array:
        """The errors |(P_hu − u)_ν| of the projected exact displacement P_hu at the contact vertices, (steps + 1, m).

        The first axis belongs to the time nodes. P_h is the projection onto V^h in (·,·)_V.
        """
        gaps = at_each(time_nodes(self.on.at.space.body.T, self.steps), self.on.gap)
        return abs(self.projected + gaps.T)

    def excess(self) -> Array:
        """Return the distance ‖u^h − u^h_lin‖_V of the solutions with and without contact at time nodes, (steps + 1,).

        It is called the excess, the part of the error that is due to contact. Without contact, the exact contact force
        is a given load.
        """
        z = self.contact - self.linear
        return np.sqrt(np.maximum(np.sum(z @ self.on.S * z, axis=1), 0.0))

    def displacement(self, n: int) -> Array:
        """Return the discrete displacement u^h with contact at the n-th time node, (dofs,).

        P_h is the projection onto V^h in (·,·)_V, k the time step, y and y_lin the normal displacements with and
        without contact. Then u^h(t_n) = P_hu(t_n) + ((1 − k/2)/(1 + k/2))^n (Π^h u_0 − P_hu_0) + M⁻¹Nᵀc, where c = S(y
        − y_lin).
        """
        on = self.on
        left = ((1 - self.k / 2) / (1 + self.k / 2)) ** n * (on.start - on.projected(0.0))
        forces = on.S @ (self.contact[n] - self.linear[n])
        return on.projected(n * self.k) + left + on.condensed.factor(on.at.space.N.T @ forces)


def sides(solutions: Trajectories) -> Numbers:
    """Return the error ‖u − u^h‖_V for a roller, its bound, and the quantities in the bound, by the names of columns.

    The columns are "error", "right side" for the bound, "E_h", "M_h" and "J_h" with their meaning in ``Rollers``, and
    "force", the total contact force integrated over time.

    Args:
        solutions: the solutions over time with and without contact.
    """
    on = solutions.on
    at = on.at
    space = on.at.space
    distance = at.v_norm.distance
    finer = at.inclusion
    measured = []
    for n in range(0, solutions.steps + 1, max(1, solutions.steps // SAMPLED_PARTS)):
        time = n * solutions.k
        sample = at.v_norm.sample(time)
        projected = finer @ on.projected(time)
        error = distance(sample, finer @ solutions.displacement(n))
        measured.append((error, distance(sample, projected), interpolation_error(at.solution, space, time)))
    error, best, between = np.max(measured, axis=0)
    nodal = solutions.nodal_errors.max()
    (part,) = space.body.of(Kind.CONTACT)
    (top,) = space.body.of(Kind.CLAMPED)
    theta = space.interpolate(np.multiply.outer(part.normal, top.coordinates(space.mesh.p)[1]))
    field = math.sqrt(theta @ (on.M @ theta))
    start = distance(at.v_norm.sample(0.0), finer @ on.start)
    force = solutions.k * solutions.forces.sum()
    right = best + start + 2 * field * nodal + math.sqrt(2 * (2 * nodal + between) * force)
    right *= math.exp(at.solution.law.kappa * space.body.T)
    return {"error": error, "right side": right, "E_h": best, "M_h": nodal, "J_h": between, "force": force}


def nodal_error_near_patch(solutions: Trajectories, width: float) -> float:
    """Return the largest nodal error |(P_hu − u)_ν| at vertices near a moving contact patch, for t ≥ T/2.

    P_hu is the projection of the exact displacement u onto V^h in (·,·)_V. Near means within 2ℓ of the middle of the
    patch. At these times the patch is far from all corners.

    Args:
        solutions: the solutions over time, for a patch that moves with the velocity 1.
        width: the width ℓ of the patch.
    """
    half = solutions.steps // 2
    times = solutions.k * np.arange(half, solutions.steps + 1)
    middles = float(START) + times - width / 2
    near = abs(solutions.on.places[0] - middles[:, None]) <= 2 * width
    return float(solutions.nodal_errors[half:][near].max())


def interpolation_error(solution: ExactSolution, space: Space, time: float) -> float:
    """Return the largest interpolation error on Γ3 at one time, max |u − Π^h u|.

    It equals max |w − Π^h w| for the gap w, because u has no tangential component on Γ3.

    Args:
        solution: the exact solution, with one contact face.
        space: the space V^h, which gives the interpolation Π^h.
        time: the time.
    """
    (face,) = solution.faces
    rule = rule_on(space, face.part, FACET_POINTS)
    error, _ = trace_error(displacement(solution, time), space, face.part, rule)
    return float(abs(error).max())


# Criteria. Windows below and above 1 differ, because a logarithm can only lower an order.
EXCESS = "order of the excess ‖u^h − u^h_lin‖_V"
EQUAL_VERTICES = Window(0.75, 1.1, "1 up to a logarithm, as all vertices of Γ3 have equal neighbourhoods")
HALF = around(0.5, 0.15, "the roller leaves different displacements at neighbouring vertices; equal ones give 1")
STANDING_ORDER = around(1, 0.25, "displacements remain at few vertices only")
HALF_STEP_EXCESS = "excess, k/2"
"""Name of the column with the excess ‖u^h − u^h_lin‖_V that is computed with half the time step."""


def change_by_half_steps(levels: pd.DataFrame) -> Array:
    """Return the relative change of the excess ‖u^h − u^h_lin‖_V if the time step is halved, for each level, (levels,).

    The excess is the distance of the discrete solution u^h from the solution of the linear problem with the exact
    pressure as a traction. Levels that were not measured with half the time step are left out.

    Args:
        levels: one row for each level, with the excess in the columns "excess" and ``HALF_STEP_EXCESS``.
    """
    both = levels.dropna()
    return abs(both[HALF_STEP_EXCESS] / both["excess"] - 1).to_numpy()


def over_seeds(groups: Groups) -> pd.DataFrame:
    """Return mean and relative standard deviation of the excess ‖u^h − u^h_lin‖_V over random meshes, for each level.

    The random meshes are the mesh families ``SEEDS``.

    Args:
        groups: the measured tables by mesh family.

    Returns:
        A table with one row for each level from coarse to fine, with the mean in the column "excess" and the relative
        standard deviation in the column "scatter". It is empty if one of the families was not measured.
    """
    if not set(SEEDS) <= set(groups):
        return pd.DataFrame()
    levels = pd.concat([groups[name] for name in SEEDS]).groupby("level", as_index=False)
    table = levels.agg(h=("h", "mean"), excess=("excess", "mean"), spread=("excess", "std"))
    return table.assign(scatter=table["spread"] / table["excess"]).sort_values("h", ascending=False)


class Rollers(ListedNumbers):
    """Measures the error, its bound, and the distance to the solution of the linear problem, for moving rollers.

    Beyond the paper: without u̇(t) ∈ H² and σ_ν ∈ L^p, p > 1, order 1/2 is proved, and rollers suggest that it is
    sharp.

    A *roller* is an exact solution in which a contact patch of width ℓ moves along Γ3. On every mesh ℓ = 2h, so the
    patch is two cells wide, however fine the mesh is. The formulas in ``manufactured.multiscale.rollers`` have a factor
    Q in the pressure p and in the normal strain q, and a factor ω in the gap. They are Q = 1 and ω = 1/10, unless one
    of them is doubled.

    **The bound.** Proposition 5.4 assumes u̇(t) ∈ H². A theorem of this study (proof in paper/velocity.tex) proves the
    order s/2 for u ∈ L¹(0,T;H^{1+s}), without a logarithm. Measured is another bound, proved in paper/companion.tex,
    for u ∈ L^∞(0,T;H^{1+s}) ∩ W^{1,1}(0,T;V):

        ‖u − u^h‖_V ≤ e^{κT} (E_h + ‖u_0 − Π^hu_0‖_V + 2ΘM_h + (2D_h‖ϑ‖_{L¹(0,T)})^{1/2}).

    The symbols are

    * κ = L_G/m_A;
    * E_h = sup_t ‖u − P_hu‖_V, the error of the best approximation; P_h is the projection onto V^h in (·,·)_V;
    * M_h, the largest nodal error |(P_hu − Π^hu)_ν| at vertices of Γ3, over all times;
    * J_h = sup_{Γ3} |u − Π^hu|, the largest interpolation error on Γ3 over all times, and D_h = 2M_h + J_h;
    * ϑ = ∫_{Γ3} p, the total contact force;
    * Θ = ‖Π^hθ‖_V, where θ is the normal ν times the distance from Γ1.

    For s = 1, M_h is of order h. So this bound is of order 1/2, up to a logarithm.

    **Measured** are

    * both sides of the bound, with all constants. E_h, J_h and the error are evaluated at 33 times, M_h at all time
      nodes.
    * the *excess*, the largest ‖u^h − u^h_lin‖_V over time. Here u^h_lin solves the linear problem in which the exact
      pressure p is given as a traction. The error of u^h_lin is of the order of E_h, so the excess is the part of the
      error that is due to contact. The midpoint rule with k = h/8 is used. With k/2 the excess must change by less than
      1/50.
    * the orders of E_h. A logarithm lowers them, because |u|_{H²} grows like |log ℓ|^{1/2}. This growth is measured on
      Γ3 by the squared seminorm |q|²_{1/2} of the normal strain q. A step of height 1 in q adds 2 log 2 whenever ℓ is
      halved.

    **Predicted**, before the programs of this file existed. Prototypes had shown the order 1 with one diagonal, and 1/2
    with alternating diagonals and on shaken meshes (reasons in paper/experiments.tex). When the roller has passed a
    vertex, a displacement of the size h remains there. If it is the same at all vertices, the excess is ~ h |log
    h|^{1/2}. If neighbouring vertices keep different displacements, the excess is ~ h^{1/2}. So the predicted orders of
    the excess are

    * 1 less a logarithm, within [¾, 1.1], with one and with two diagonals, because all vertices of Γ3 have equal
      neighbourhoods;
    * ½ ± 0.15 with alternating diagonals, where vertices are of two kinds. The meshes are not random;
    * ½ ± 0.15 on shaken meshes for the mean over eight meshes, for n = 128 over four. The roller passes about 0.7n
      vertices, whose contributions are nearly independent. So the excess has the relative standard deviation ~ ½
      (0.7n)^{−1/2}, and single orders scatter;
    * ½ ± 0.3 on unstructured meshes;
    * ½ ± 0.15 with alternating diagonals also if Q or ω is doubled;
    * 1 ± 0.25 for patches that do not move, because displacements remain at few vertices only. The bound does not show
      this.

    These orders are judged, except the two that the next paragraph calls reported.

    **Found** where the prediction was wrong or is only just met:

    * A patch that does not move showed the orders 0.9 and 2.3 on single shaken meshes. Its excess depends on the cells
      around few vertices. Over eight shaken meshes the excess has a relative standard deviation of a third to a half on
      every level, and its mean has the orders 0.97 and 1.06. The order on single shaken meshes is reported and not
      judged.
    * On unstructured meshes 0.75 is observed, at the edge of the prediction. Over six random meshes the mean has the
      orders 1.05 and 0.59 up to n = 64. The mesh generator moves points to the middle of their cells eight times, which
      makes neighbourhoods on Γ3 nearly equal. The excess is then about as large as with one diagonal, and differences
      between neighbours show from n = 64 on. With one such sweep instead of eight, the excess is twice as large at n =
      64, and its orders are 0.61 and 0.46. The prediction ignored both effects, so the order is reported and not
      judged. The orders of E_h are 0.6 to 0.8 on these levels, where the logarithm still matters.
    * With one diagonal the orders of the excess from level to level are 0.84, 1.00 and 1.16, and the orders of M_h are
      0.9, 1.4 and 1.8. Both quantities are maxima, whose places change from level to level. M_h occurs at the end of
      Γ3 near which the roller starts, and falls like h² from the second level on. Near the patch and far from the
      ends of Γ3, nodal errors over h are 0.076, 0.076, 0.074 and 0.073. The reason is that for ℓ = 2h the solution near
      the patch looks the same on every level. The largest excess occurs at the start, at t ~ h, for n = 16, 32 and 64,
      but at T, behind the roller, for n = 128. At T the excess over h is 0.104, 0.093, 0.109 and 0.136. From the second
      level on this rises faster than |log h|^{1/2}. So orders below 1 are expected on finer meshes; n = 256 would take
      minutes. The order over all levels is judged. The orders at T and near the patch are reported.
    """

    label = "beyond: rollers"
    claim = (
        "the error is O(h^{s/2}) if u ∈ L¹(0,T;H^{1+s}); for rollers of width 2h on irregular meshes the error that "
        "contact adds to the linear problem has the order 1/2"
    )
    outside_catalogue = True
    # The quick study leaves rollers out, because the orders only show on fine meshes. In the case ROLLER-n the roller
    # has the width 2h on level n.
    full = tuple(
        Setting(f"{kind}-{n}", family, n)
        for kind, families, levels in (
            (ROLLER, (PLAIN_FAMILIES[0], ALTERNATING, UNSTRUCTURED, *SEEDS[:4]), ROLLER_LEVELS),
            (ROLLER, (PLAIN_FAMILIES[1], *SEEDS[4:]), COARSE_ROLLER_LEVELS),
            (PUSHING, (ALTERNATING,), COARSE_ROLLER_LEVELS),
            (STEEP, (ALTERNATING,), COARSE_ROLLER_LEVELS),
            (STANDING, (PLAIN_FAMILIES[0], ALTERNATING, SEEDS[0]), COARSE_ROLLER_LEVELS),
        )
        for family in families
        for n in levels
    )

    def cost(self, setting: Setting) -> float:
        """Return the expected run time in µs.

        The run time grows like n³ with the level n: there are about n² cells, and the number of time steps is
        proportional to n.
        """
        return 12.0 * setting.level**3

    def measure(self, setting: Setting) -> Numbers:
        space, solution = posed(setting)
        on = OnContact(Resolved(solution, space))
        steps = round(PER_H * setting.level * space.body.T)
        solutions = Trajectories.of(on, steps)
        excess = solutions.excess()
        numbers = {"excess": excess.max(), "excess at T": excess[-1], **sides(solutions)}
        if setting.family == PLAIN_FAMILIES[0]:
            # The squared seminorm |q|²_{1/2} at the time T/2, for the linear interpolant of q on equal panels of Γ3.
            (face,) = solution.faces
            panels = 4 * setting.level
            assert isinstance(face, FadingFace)
            nodes = np.linspace(0, face.part.measure, panels + 1)
            _, strain, _ = face.traces
            q = strain(nodes[None], space.body.T / 2)[(0,)]
            numbers["|q|²"] = q @ gram(panels, 0.5) @ q
        if setting.case == f"{ROLLER}-{setting.level}" and setting.family in PLAIN_FAMILIES:
            numbers["M_h beside"] = nodal_error_near_patch(solutions, 2 / setting.level)
        if setting.level == HALVED and setting.family not in SEEDS[1:]:
            numbers[HALF_STEP_EXCESS] = Trajectories.of(on, 2 * steps).excess().max()
        return with_h(space.h, numbers)

    def by_case(self, rows: pd.DataFrame) -> ByCase:
        """Divide measured rows by kinds of rollers, which are the names of the cases without the level."""
        return super().by_case(rows.assign(case=rows["case"].str.rpartition("-")[0]))

    def checks_of(self, kind: str, groups: Groups) -> Judged:
        """Yield the criteria for one kind of roller, each with the measurements that it judges, by mesh family.

        The criteria for the *excess* judge the distance of u^h from the discrete solution of the linear problem in
        which the exact contact pressure acts as a traction.

        Args:
            kind: the kind of roller, which is the name of the case without the level.
            groups: the measured tables by mesh family, with one row for each level.
        """

        def on(*families: str) -> Groups:
            # A missing family gets an empty table, so that the check is undecided.
            return {name: groups.get(name, pd.DataFrame()) for name in families}

        yield ROLLER_BOUND, groups
        if kind == STANDING:
            # The excess on a single shaken mesh depends on the cells around few vertices.
            still = f"{EXCESS}, patches that do not move"
            not_random = {family: table for family, table in groups.items() if family not in SEEDS}
            yield check_of_order("order-standing", still, "excess", STANDING_ORDER), not_random
            shaken_order = check_of_order(
                "order-standing-shaken",
                f"{still}, single shaken meshes",
                "excess",
                STANDING_ORDER,
                if_missed="the order depends on the cells around few vertices",
            )
            yield shaken_order, on(SEEDS[0])
            return
        yield check_of_order("order-alternating", f"{EXCESS}, alternating diagonals", "excess", HALF), on(ALTERNATING)
        if kind != ROLLER:
            return
        plain = on(*PLAIN_FAMILIES)
        shaken = {SEEDS[0]: over_seeds(groups)}
        yield ORDER_EQUAL, plain
        yield ORDER_AT_END, plain
        yield NODAL_ORDER, plain
        yield check_of_order("order-shaken", f"{EXCESS}, mean over shaken meshes", "excess", HALF), shaken
        yield ORDER_UNSTRUCTURED, on(UNSTRUCTURED)
        yield SCATTER_ORDER, shaken
        yield BEST_ORDER, groups
        yield EXCESS_SHARE, groups
        yield HALF_STEP_CHANGE, {name: table for name, table in groups.items() if HALF_STEP_EXCESS in table}
        yield STEP_GROWTH, on(PLAIN_FAMILIES[0])


ORDER_EQUAL = check_of_order("order-equal", f"{EXCESS}, one or two diagonals", "excess", EQUAL_VERTICES)
ORDER_AT_END = check_of_order(
    "order-end",
    f"{EXCESS} at T, one or two diagonals",
    "excess at T",
    EQUAL_VERTICES,
    if_missed=(
        "this quantity was chosen after the maximum over time had shown orders above 1: with one diagonal that maximum "
        "occurs at the start, on all meshes except the finest"
    ),
)
NODAL_ORDER = check_of_order(
    "nodal-beside",
    "order of the nodal errors of P_hu next to the patch, one or two diagonals",
    "M_h beside",
    around(1, 0.1, "the solution near the patch looks alike for every ℓ = 2h"),
    if_missed=(
        "this quantity was chosen after M_h had shown orders above 1: with one diagonal M_h occurs at an end of Γ3"
    ),
)
ORDER_UNSTRUCTURED = check_of_order(
    "order-unstructured",
    f"{EXCESS}, unstructured meshes",
    "excess",
    around(0.5, 0.3, "a single random mesh on every level"),
    if_missed="the generator makes neighbourhoods nearly equal, and the order on a single mesh depends on chance",
)
SCATTER_ORDER = check_of_order(
    "scatter",
    "order of the relative standard deviation over shaken meshes",
    "scatter",
    around(0.5, 0.35, "the vertices contribute like independent random numbers"),
    if_missed="eight meshes determine a standard deviation only up to a quarter",
)
BEST_ORDER = check_of_order(
    "best",
    "order of E_h = ‖u − P_hu‖_V, the error of the linear problem",
    "E_h",
    Window(0.75, 1.1, "1 less a logarithm, as |u|_{H²} grows like |log ℓ|^{1/2}"),
    if_missed="a logarithm changes the order from level to level",
)
ROLLER_BOUND = identity(
    "bound", "error / right side of the bound", quotients("error", "right side"), at_most(1.0, "proved")
)
EXCESS_SHARE = consequence(
    "share",
    "largest excess / error",
    quotients("excess", "error"),
    Window(),
    if_missed=NO_BOUND_OF_EXCESS,
)
HALF_STEP_CHANGE = accuracy(
    "time",
    "change of the excess with half the step",
    change_by_half_steps,
    at_most(0.02, "of the excess, so the excess does not come from time steps"),
)
# The growth from every level to the next must lie in the window; the last one is displayed.
STEP_GROWTH = accuracy(
    "step",
    "growth of |q|²_{1/2,Γ3} with every halving of ℓ",
    lambda table: np.diff(table["|q|²"].to_numpy()),
    around(2 * math.log(2), 0.15, "2 log 2 for a step of height 1; other powers of ℓ tend to 0 or infinity"),
    levels=MIN_LEVELS,
    finest=True,
)
