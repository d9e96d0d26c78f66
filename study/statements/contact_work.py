"""Beyond the paper: the work of contact for solutions with contact patches of every size.

The error estimate (5.21) has a contact term, which a linear problem does not have: ‖R(·; Π^h u − u)‖^{1/2}_{L¹(0,T)}.
It is the root of the *work of contact*, the work of the exact contact force on the interpolation error. The term is of
order 1 for u ∈ W^{1,1}(0,T;H²), for any trace (``edge_work``); for a fixed u it is even o(h). In the cases of the
catalogue, which have a few smooth fronts, it is 1e-6 to 1e-3 of the error (0.03 in natural-front, 0.1 in rough-trace).
That is too small to be observed. Here it is measured for the cases of ``manufactured.multiscale``, whose contact zones
have details of the size of h on every mesh.

Three quantities are **measured**. Their integrals are computed on a refined mesh, whose cells are at most a third of
the depth ℓ over which the contact data are continued into the body:

* ``work``: ‖R(·; Π^h u − u)‖^{1/2}_{L¹(0,T)}, where R = ∫_{Γ3} p Π^h w with the gap w, because p w = 0;
* ``error``: max_t ‖u − u^h‖_V;
* ``excess``: max_t ‖u^h − u^h_lin‖_V, where u^h_lin solves the linear problem with p as a given traction. The
  excess is the part of the error that is due to contact.

**Predictions** follow from the form of gap and pressure. They consist of trains of waves of width ℓ, and ℓ is halved
from one train to the next.

* *On grids* all edges are equal and cut every train at the same places. So R/h² is a sum over the trains, and the term
  of a train is a function of ℓ/h. The sum is constant, and the root of R has order 1, as long as there are trains of
  all widths h/2 to 4h. This holds for 32 ≤ n ≤ 128; the window is ± 0.15. On coarser meshes the order is lower.
* *With random vertices* each edge cuts the waves at another place. Only four to sixteen edges lie on the train that
  contributes most, and the contributions R_E of single edges vary by 100 %. So single orders may be off by 0.5; they
  are reported. If this explanation is right, the mean of R over random vertices has the order 1, and its relative
  standard deviation falls like n^{−1/2}. Both are claimed.
* *Unstructured meshes* have equal edges on each piece of Γ3, but their number does not double from level to level. The
  edges cut the waves at other places on every level, all edges in the same way. So the work may nearly vanish on one
  level (observed: orders −2.5 to 1.2, and work / error as small as 0.011).

No order is predicted for the error and the excess. A mesh resolves a train only for h < ℓ/10, so on these meshes the
error has hardly begun to fall. On grids work / error must be above 1/50, twenty times its value for smooth fronts.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np
import scipy.sparse as sps

from manufactured.body import Kind
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.exact.solution import FaceFields
from manufactured.multiscale import FadingFace
from manufactured.tensors import Array, Points
from study.fem.error_norm import ErrorNorm
from study.fem.mesh import Shaken
from study.fem.naming import family_named, resolve
from study.fem.refining import inclusion_of, refined
from study.fem.seminorm import composite_gauss
from study.fem.space import Space
from study.ledger.check import ENOUGH, Check, Groups, consequence
from study.ledger.quantities import level_by_level, quotients
from study.ledger.window import Window, around, at_least
from study.solve.evolution import SemiDiscrete
from study.solve.steps import rate_steps
from study.solve.tableau import MIDPOINT
from study.statements.shared.base import SEED, Judged, ListedNumbers, Numbers, Setting, grid, with_h
from study.statements.shared.meshes import space_of, split_irregular
from study.statements.shared.norms import ContactWork, midpoints, norm

PARTS = 3
"""Number of cells of the refined mesh across the depth over which contact data are continued into the body."""


class Resolved:
    """The P1 space on a mesh, with a finer mesh for integrals of exact solutions that have details smaller than a cell.

    Attributes:
        solution: the exact solution.
        space: the P1 displacement space V^h on the mesh.
        v_norm: the error norm, which is integrated on the refined mesh.
        inclusion: the matrix that maps degrees of freedom of V^h to degrees of freedom on the refined mesh.
    """

    def __init__(self, solution: ExactSolution, space: Space) -> None:
        mesh, nodal = refined(space.mesh, lambda corners: least_depth(solution, corners) / PARTS)
        fine = Space(mesh, space.body)
        self.solution = solution
        self.space = space
        self.v_norm = ErrorNorm(solution, fine, along=())
        self.inclusion: sps.csr_array = inclusion_of(space, fine, nodal)


def least_depth(solution: ExactSolution, corners: Points) -> Array:
    """Return for each cell the smallest depth of the contact faces whose data are continued into the cell, (cells,).

    An exact solution continues the gap and the pressure of each contact face into the body, down to a certain depth.
    The result is infinite for cells that no face reaches.

    Args:
        solution: the exact solution.
        corners: the corners of the cells, (2, 3, cells).
    """
    found = np.full(corners.shape[2:], math.inf)
    for face in solution.faces:
        assert isinstance(face, ContactFace | FadingFace)
        (along,), into = face.part.coordinates(corners)
        depth = face.least_depth if isinstance(face, FadingFace) else face.profile.depth
        met = (into.min(axis=0) < depth) & (along.max(axis=0) > 0) & (along.min(axis=0) < face.part.measure)
        found[met] = np.minimum(found[met], depth)
    return found


def pressing_on(at: Resolved) -> Callable[[float], Array]:
    """Return the exact contact pressure as a load: a function of time with values v ↦ ∫_{Γ3} p v_ν on V^h, (dofs,).

    The prescribed pressure is used, which is a hundred times faster than the pressure from the exact stress.
    """
    work = ContactWork(at.solution, at.v_norm.space, (), FaceFields.stated_pressure)
    return lambda time: -np.asarray(at.inclusion.T @ work.load(time))


FACE_RULE = composite_gauss(512, 4)
"""Quadrature rule on a contact face. Waves are at least 1/64 of the face wide, so each has at least 8 intervals."""
TIME_NODES = 8
"""Number of nodes of the midpoint rule that integrates over time."""
DRAWS = 400
"""Number of random sets of vertices on Γ3 over which mean and standard deviation of the work are computed."""


class TotalWork:
    """Computes the work of the contact force on the interpolation error, integrated over time.

    This is ∫_0^T R(t; Π^h u − u) dt with R = ∫_{Γ3} p Π^h w for the pressure p and the gap w. It depends on the mesh
    only through the vertices on Γ3. Time is integrated by the midpoint rule. Many sets of vertices are evaluated
    together: the contribution of an edge is a difference of cumulative sums over the quadrature points.
    """

    def __init__(self, solution: ExactSolution) -> None:
        self.times = midpoints(solution.body.T, TIME_NODES)
        # Cumulative sums make the integral over any edge a difference of two values. Each piece has its face, its
        # quadrature points, and the cumulative weighted sums of p and of p s, (2, points + 1, TIME_NODES).
        self.pieces = []
        for face in solution.faces:
            place, weights = (face.part.measure * values for values in FACE_RULE)
            pressure = solution.on(face, place[None]).stated_pressure(self.times)
            weighted = pressure * (weights * solution.body.T / TIME_NODES)[:, None]
            sums = np.cumsum([weighted, weighted * place[:, None]], axis=1)
            self.pieces.append((face, place, np.concatenate([np.zeros((2, 1, TIME_NODES)), sums], axis=1)))

    def __call__(self, vertices: Sequence[Array]) -> Array:
        """Return the work of the pressure p on the interpolated gap Π^h w for one or several sets of vertices.

        On the edge that begins at s_i, p Π^h w = p w(s_i) + p (s − s_i) w', where w' is the derivative of Π^h w.

        Args:
            vertices: for each contact face, the increasing coordinates of its vertices, (..., vertices).

        Returns:
            The work for each set of vertices, (...).
        """
        total = np.zeros(np.shape(vertices[0])[:-1])
        for (face, place, moments), s in zip(self.pieces, vertices, strict=True):
            w = face.gap_jet(s[None, ..., None], self.times)[(0,)]
            derivative = np.diff(w, axis=-2) / np.diff(s)[..., None]
            pressed, turned = np.diff(moments[:, np.searchsorted(place, s)], axis=-2)
            turned = turned - s[..., :-1, None] * pressed
            total += np.sum(pressed * w[..., :-1, :] + turned * derivative, axis=(-1, -2))
        return total


def vertices_on(space: Space) -> list[Array]:
    """Return the increasing coordinates of the vertices along every contact face."""
    parts = space.body.of(Kind.CONTACT)
    return [np.sort(part.coordinates(space.mesh.p[:, space.vertices(part)])[0][0]) for part in parts]


def shaken(vertices: Sequence[Array], rng: np.random.Generator) -> list[Array]:
    """Return vertices moved at random as on shaken meshes: by up to a fifth of an edge, except the end points.

    Args:
        vertices: equidistant coordinates of vertices on each contact face.
        rng: the random generator.
    """
    moved = []
    for s in vertices:
        shift = rng.uniform(-1, 1, s.size) * Shaken().amplitude * (s[1] - s[0])
        shift[[0, -1]] = 0
        moved.append(s + shift)
    return moved


COARSE = 32
"""The coarsest level on which there are wave trains of all widths from h/2 to 4h."""


def from_32(key: str, quantity: str, column: str, window: Window) -> Check:
    """Return the criterion for the observed orders of a column from level to level, without levels below n = 32."""
    found = consequence(
        key, f"{quantity}, level by level from n = 32", level_by_level(column), window, levels=ENOUGH, finest=True
    )
    return replace(found, value=lambda levels: found.value(levels[levels["level"] >= COARSE]))


ROOT = "order of ‖R(·; Π^h u − u)‖^{1/2}"
FIRST_ORDER = around(1, 0.15, "there are wave trains of all widths from h/2 to 4h")
HALF = around(0.5, 0.15, "the edges contribute to R like independent random numbers")
NOT_RESOLVED = "a mesh resolves a wave train of width ℓ only for h < ℓ/10"
ON_GRIDS = (
    from_32("order", f"{ROOT}, on grids", "work", FIRST_ORDER),
    from_32("order-mean", f"{ROOT}, R averaged over {DRAWS} random meshes", "mean work", FIRST_ORDER),
    from_32("spread", "order of the relative standard deviation of R over random vertices", "spread", HALF),
    consequence(
        "share",
        "smallest ‖R‖^{1/2} / error",
        quotients("work", "error"),
        at_least(0.02, "cases with a few smooth fronts have only 1e-6 to 1e-3"),
    ),
)
SINGLE = from_32("order-irregular", f"{ROOT}, on single irregular meshes", "work", FIRST_ORDER)
ON_IRREGULAR_MESHES = replace(SINGLE, if_missed="on irregular meshes single orders depend on chance")
ON_ALL_MESHES = (
    replace(from_32("error", "order of ‖u − u^h‖_V", "error", Window()), if_missed=NOT_RESOLVED),
    replace(
        consequence("excess-share", "largest ‖u^h − u^h_lin‖_V / error", quotients("excess", "error"), Window()),
        if_missed="the study has no bound of this excess in V",
    ),
    replace(from_32("excess", "order of ‖u^h − u^h_lin‖_V", "excess", Window()), if_missed=NOT_RESOLVED),
)


class WorkOfContact(ListedNumbers):
    """Measures the square root of the work of contact, the error ‖u − u^h‖_V, and the excess ‖u^h − u^h_lin‖_V.

    The displacement u^h_lin solves the linear problem in which the exact pressure is a given traction. So the excess is
    the part of the error that is due to contact.
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
        case = resolve(setting.case)
        space = space_of(setting)
        steps = rate_steps(space.body.T, setting.level, case.pace)
        solution = case.solution
        at = Resolved(solution, space)
        v_norm = at.v_norm
        inclusion = at.inclusion
        press = pressing_on(at)
        # Loads are cached, because both problems need them at the same times.
        load = lru_cache(maxsize=None)(lambda time: np.asarray(inclusion.T @ v_norm.load(time)))
        start = space.interpolate(solution.at(space.mesh.p).displacement(0.0))
        problem = SemiDiscrete.of(space, solution.law, load, start)
        linear = replace(problem, N=problem.N[:0], load=lambda time: load(time) - press(time))
        sizes = []
        for state, free in zip(MIDPOINT.march(problem, steps), MIDPOINT.march(linear, steps), strict=True):
            error = v_norm.distance(v_norm.sample(state.time), inclusion @ state.u)
            sizes.append((error, norm(problem, state.u - free.u)))
        error, excess = np.max(sizes, axis=0)
        total = TotalWork(solution)
        vertices = vertices_on(space)
        found = {"error": error, "excess": excess, "work": math.sqrt(total(vertices))}
        if not family_named(setting.family).irregular:
            rng = np.random.default_rng(SEED)
            moved = zip(*(shaken(vertices, rng) for _ in range(DRAWS)), strict=True)
            works = total([np.array(of_piece) for of_piece in moved])
            found |= {"mean work": math.sqrt(np.mean(works)), "spread": np.std(works) / np.mean(works)}
        return with_h(space.h, found)

    def checks_of(self, case: str, groups: Groups) -> Judged:
        irregular, on_grid = split_irregular(groups)
        judged = (on_grid, ON_GRIDS), (irregular, (ON_IRREGULAR_MESHES,)), (groups, ON_ALL_MESHES)
        return [(rule, tables) for tables, rules in judged for rule in rules]
