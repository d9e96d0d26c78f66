"""Bounds of the error of a displacement u_h that another program has computed.

u_h is given by its mesh, times and nodal values. ``given`` checks these arrays, and ``bound_displacement`` bounds the
error. u_h must vanish on the clamped boundary Γ1. It may penetrate the foundation and may even solve another problem,
because nothing else is assumed: a more accurate admissible displacement ũ is computed, the error of ũ is bounded, and
the triangle inequality then bounds the error of u_h from both sides. The mesh of ũ is a refinement of the mesh of u_h,
and its time steps have equal length.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sps
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree
from skfem import Mesh

from manufactured.arguments import Count, checked
from manufactured.body import Body, Kind
from manufactured.case import Case
from manufactured.data import Data
from manufactured.tensors import Array, Points
from study.bound.bounded import BoundedSolution, both_bounds, check_problem
from study.bound.discretisation import Discretisation
from study.bound.enclosing import squared_distances
from study.bound.problem import BoundError, place
from study.bound.trajectory import Computed, Refined, on_refinement
from study.fem.mesh import FIT_TOLERANCE, MeshError, boundary_parts, cell_volumes, simplicial_mesh
from study.fem.space import Quadratic
from study.ledger.text import interval
from study.solve.steps import require_steps

LEAST_STEPS = 16
"""The number of time steps of ũ is chosen as if u_h had at least this many time steps."""
SAME_LENGTH = 0.01
"""When bodies and meshes are compared, two lengths count as equal if their relative difference is below this number."""
SINGLE = 1e-6
"""Relative accuracy of the numbers in files, which may be in single precision."""
JOINED_UP_TO = 1e-8
"""Points are joined if their distance is at most this fraction of the size of the mesh."""
CLAMPED_UP_TO = 1e-9
"""A displacement on the clamped boundary counts as 0 up to this fraction of the largest displacement."""
UNMOVED_UP_TO = 1e-12
"""A vertex counts as unmoved up to this distance, relative to the size of the mesh."""
SCALED, SCALED_IN_TIME, ALIKE, NEAR = 0.03, 0.1, 0.7, 0.02
"""Limits in the test whether a displacement is nearly a multiple of the solution, for example because of wrong units.

The factor must differ from 1 by more than ``SCALED``, or by more than ``SCALED_IN_TIME`` for problems in time, because
long time steps and penalties change the factor by some per cent. The relative distance that remains after division by
this factor must be below ``ALIKE``. A usual mistake explains the factor if the factors that it can have differ from it
by less than ``NEAR``, relatively, or by less than the square of the remaining distance.
"""
AS_PRESCRIBED = 1e-15
"""A prescribed displacement counts as exact up to this fraction of the largest displacement."""
UNCHANGED_UP_TO = 1e-9
"""A change of u_h by at most this fraction of its norm is rounding, and is not reported."""
LOW_END = 0.1
"""The lower end of an interval counts as small up to this fraction of the upper end."""
MIDPOINT_UP_TO = 1e-5
"""A node counts as the midpoint of a side up to this distance, relative to the length of the side."""
FLAT = 1e-12
"""A triangle counts as degenerate if its area divided by its squared diameter is below this number."""


@checked(BoundError)
def bound_displacement(
    data: Data,
    points: Any,
    triangles: Any,
    times: Any,
    u: Any,
    refine: int = 1,
    shorter: int = 4,
    steps: Count | None = None,
    nearest: bool = False,
    case: Case | None = None,
    progress: Callable[[float], object] = lambda time: None,
) -> BoundedSolution:
    """Bound the error ‖u(t) − u_h(t)‖_V of a displacement u_h, computed by any program, from below and from above.

    Args:
        data: the problem. If it is ``Static``, the norm is the energy norm of the elasticity.
        points, triangles, times, u: the mesh and the displacement u_h, as in ``given``.
        refine: how often the mesh of u_h is refined for the second, more accurate displacement ũ that the bounds need.
        shorter: the number of time steps of ũ, divided by the number of time steps of u_h (or by ``steps``, if given).
        steps, nearest: as in ``given``.
        case: the case if the exact solution is known; the true error is then reported as well.
        progress: a function that is called with each time up to which the bounds are computed.

    Raises:
        BoundError: the displacement does not fit the problem, or the problem cannot be bounded.
        LoadError: no solution can exist for the data.
    """
    refined = Refined(refine, shorter)
    check_problem(data, steps, refined)
    return bounded_displacement(data, given(data, points, triangles, times, u, steps, nearest), refined, case, progress)


def bounded_displacement(
    data: Data,
    computed: Computed,
    refined: Refined,
    case: Case | None,
    progress: Callable[[float], object],
) -> BoundedSolution:
    """Return bounds of the error of a displacement that ``given`` has checked.

    Args:
        data: the problem.
        computed: the displacement.
        refined: how the second, more accurate displacement is computed from which the bounds follow.
        case: the case if the exact solution is known; the true error is then reported as well.
        progress: a function that is called with each time up to which the bounds are computed.
    """
    coarse = Discretisation(data, computed.mesh)
    if data.in_time:
        require_steps(refined.shorter * computed.steps)
    bounded = both_bounds(coarse, computed, refined, true_error(case, coarse, computed), progress)
    low, high = bounded.error
    remarks = [*suspicion(bounded, data), *computed.remarks, *bounded.remarks]
    if computed.offset > UNCHANGED_UP_TO * high:
        of_file = interval(max(0.0, low - computed.offset), high + computed.offset, 4)
        remarks.append(f"the error of the displacement in the file lies in {of_file}")
    if low <= LOW_END * high and computed.degree == 2:
        more = refined.refinements + 1
        remarks.append(f"the lower end is small, because ũ is hardly better than u_h of degree 2: try --refine {more}")
    return replace(bounded, remarks=tuple(remarks))


def suspicion(bounded: BoundedSolution, data: Data) -> list[str]:
    """Return a list with a warning if u_h is nearly a constant multiple of the solution, otherwise an empty list.

    A factor such as 1000 shows that u_h solves the problem with other units or data. The warning states the factor, and
    asks for the usual mistake that gives this factor, such as metres and millimetres.

    Args:
        bounded: the displacement u_h with the bounds of its error, and the more accurate displacement with which it is
            compared.
        data: the problem.
    """
    factor, rest = bounded.enclosure.factor
    is_scaled = abs(factor - 1) > (SCALED_IN_TIME if data.in_time else SCALED)
    # If displacements are prescribed, the factor of a Galerkin solution is not 1, and wrong values are refused.
    if data.body.is_moved or not is_scaled or rest >= ALIKE:
        return []
    stiff, side = abs(data.law.A.matrix[0, :2])
    # Poisson's ratio if the law here means plane strain, and if it means plane stress.
    strain = side / (stiff + side)
    stress = side / stiff
    usual = [
        (1e3, 1e3, "metres and millimetres?"),
        (1e-3, 1e-3, "metres and millimetres?"),
        (1e6, 1e6, "pascals and megapascals?"),
        (1e-6, 1e-6, "pascals and megapascals?"),
        (-1.0, -1.0, "loads in the opposite direction?"),
        (1.0, 1 / (1 - strain**2), "plane stress there, and plane strain here?"),
        (1 - stress**2, 1.0, "plane strain there, and plane stress here?"),
    ]
    off = math.inf
    for low, high, mistake in usual:
        distance = abs(np.clip(factor, low, high) / factor - 1)
        if distance < off:
            off = distance
            question = mistake
    # The part of u_h that is no multiple of the solution changes the factor by about its square.
    if off > max(NEAR, rest**2):
        question = "compare loads, stiffness and units."
    return [
        f"the displacement is {float(f'{factor:.3g}'):g} times the one of this problem: {question} Divided by this "
        f"factor it differs by {_percent(rest)}"
    ]


def true_error(case: Case | None, coarse: Discretisation, computed: Computed) -> Callable[[float, Array], float] | None:
    """Return the function (t, u_h(t)) ↦ ‖u(t) − u_h(t)‖_V, or None if the exact solution is unknown.

    Args:
        case: the case with the exact solution u, or None.
        coarse: the problem on the mesh of u_h.
        computed: the displacement u_h, of degree 1 or 2. The argument u_h(t) of the function is the array of its nodal
            values.
    """
    if case is None:
        return None
    u_h = computed.on(coarse)
    exact = case.solution
    data = coarse.data

    def error(time: float, _: Array) -> float:
        rough = *data.lines, *data.fronts(time)
        squares = squared_distances(coarse, lambda x: exact.at(x).strain(time), u_h(time), rough)
        return math.sqrt(squares.sum())

    return error


# The remaining functions check the arrays of a displacement that another program has computed.


@checked(BoundError)
def given(
    data: Data,
    points: Any,
    triangles: Any,
    times: Any,
    u: Any,
    steps: Count | None = None,
    nearest: bool = False,
) -> Computed:
    """Check the displacement of another program and return it together with its mesh.

    Points that belong to no triangle are removed. Points at the same position with the same displacement are merged.
    Vertices whose distance to the boundary of the body is less than 1e-6 of its size are moved onto the boundary.

    Args:
        data: the problem.
        points: the coordinates of the points, (n, 2), or (n, 3) with equal third coordinates.
        triangles: for each cell the numbers of its points: (cells, 3) for a linear displacement; (cells, 6) for a
            quadratic one, with the corners 0, 1, 2 first, then the midpoints of the sides 01, 12 and 20.
        times: the times, increasing from 0 to T, (k,). For a ``Static`` problem None or one time.
        u: the displacements of the points at the times, (k, n, 2), or (k, n, 3) with third component 0.
        steps: the number of time steps of the more accurate displacement ũ is a multiple of this number. The default is
            the number of time intervals of u, but at least ``LEAST_STEPS``.
        nearest: what to do if u has other values on CLAMPED and ROLLER sides than prescribed: if true, replace the
            values at the nodes there, otherwise raise an error.

    Raises:
        BoundError: an array is invalid. The message names the array and the position of the fault, and says how to
            correct it.
    """
    times = np.zeros(1) if times is None else times
    points, triangles, times, u = _arrays(points, triangles, times, u)
    if not data.in_time:
        if len(times) > 1:
            raise BoundError(f"the problem is static, and u_h has {len(times)} times: choose one by --step")
        times = np.array([0.0, data.body.T])
        u = np.concatenate([u, u])
    times = _checked_times(times, data.body.T)
    _check_box(points[np.unique(triangles[:, :3])], data.body)
    points, triangles, u, remarks = _joined(points, triangles, u)
    mesh, nodes, degree = _mesh(data.body, points, triangles)
    before = points[nodes[: mesh.p.shape[1]]].T
    moved = np.linalg.norm(mesh.p - before, axis=0).max()
    if moved > UNMOVED_UP_TO * np.ptp(points, axis=0).max():
        remarks.append(
            f"vertices near the boundary were moved onto it, by at most {moved:.2g}; u_h is meant on that mesh"
        )
    _check_fit(mesh, data.body)
    values = u[:, nodes].reshape(len(times), -1)
    steps = steps or max(len(times) - 1, LEAST_STEPS)
    computed = Computed(mesh, data.body, degree, times, values, steps)
    remarks += _penetration(computed, data.in_time)
    return _clamped(data, replace(computed, remarks=tuple(remarks)), nearest)


def _arrays(points: Array, triangles: Array, times: Array, u: Array) -> tuple[Array, Array, Array, Array]:
    """Convert the arrays to shapes (n, 2), (cells, 3 or 6), (k,), (k, n, 2); raise BoundError if one is invalid."""
    points = _real("points", points)
    times = np.atleast_1d(_real("times", times))
    u = _real("u", u)
    triangles = _unmasked("triangles", triangles)
    if triangles.ndim != 2 or triangles.shape[1] not in (3, 6) or not np.issubdtype(triangles.dtype, np.integer):
        raise BoundError(
            f"triangles have the shape {triangles.shape} and the type {triangles.dtype}, expected integers (cells, 3) "
            "for linear or (cells, 6) for quadratic displacements; other cells are not served"
        )
    triangles = triangles.astype(np.int64)
    if points.ndim != 2 or points.shape[1] not in (2, 3):
        raise BoundError(f"points have the shape {points.shape}, expected (n, 2)")
    if u.ndim == 2 and len(times) == 1:
        u = u[None]
    wanted = len(times), len(points), 2
    if u.ndim != 3 or u.shape[:2] != wanted[:2] or u.shape[2] not in (2, 3):
        raise BoundError(
            f"u has the shape {u.shape}, expected {wanted}: one displacement for each of "
            f"{len(times)} times and {len(points)} points"
        )
    for name, array in (("points", points), ("times", times), ("u", u)):
        wrong = np.argwhere(~np.isfinite(array))
        if len(wrong):
            row = wrong[0, 0]
            where = f" in row {row} (rows are numbered from 0)"
            if name == "u":
                where = f" at t = {times[row]:.6g}, x = {place(points[wrong[0, 1], :2])}"
            raise BoundError(f"{name} has {len(wrong)} numbers that are not finite, the first{where}")
    for name, array in (("points", points), ("u", u)):
        if array.shape[-1] == 3 and np.ptp(array[..., 2]) > SINGLE * np.ptp(array):
            raise BoundError(f"the third component of {name} is not constant, and the bound serves plane bodies")
    least = triangles.min(initial=len(points))
    most = triangles.max(initial=-1)
    if not 0 <= least <= most < len(points):
        raise BoundError(
            f"triangles have point numbers from {least} to {most}, expected 0 to {len(points) - 1}; numbers start at 0"
        )
    return points[:, :2], triangles, times, u[..., :2]


def _real(name: str, array: Any) -> Array:
    """Convert an array to floating-point numbers; raise BoundError if it is empty or not real."""
    numbers = _unmasked(name, array)
    if numbers.size == 0 or numbers.dtype.kind not in "iufc" or np.imag(numbers).any():
        raise BoundError(
            f"{name} has the shape {numbers.shape} and the type {numbers.dtype}, expected real numbers, at least one"
        )
    return np.asarray(np.real(numbers), dtype=float)


def _unmasked(name: str, array: Any) -> Array:
    """Return an array without a mask; raise BoundError if entries are masked or rows have different lengths."""
    try:
        if not np.ma.is_masked(array):
            return np.asarray(array)
    except ValueError:
        pass
    raise BoundError(f"{name} has masked entries or rows of different lengths, expected an array of numbers")


def _checked_times(times: Array, T: float) -> Array:
    """Check that the times increase from 0 to T, and return them; steps equal up to rounding are made equal."""
    falls = np.flatnonzero(np.diff(times) <= 0)
    if times.ndim != 1 or falls.size:
        got = f"an array of the shape {times.shape}"
        if times.ndim == 1:
            before, after = times[falls[0] :][:2]
            got = f"{after:g} after {before:g}"
        raise BoundError(
            f"times have to increase strictly, got {got}; the parts of a parallel run have to be merged into one file "
            "for each time"
        )
    if abs(times[0]) > SINGLE * T:
        raise BoundError(
            f"the initial time is missing: the first time is {times[0]:.6g}. Errors depend on all that happens from "
            "t = 0 on; add the displacement at t = 0, which is u_0 or its approximation"
        )
    if len(times) < 2:
        raise BoundError(
            "there is one time only, and the problem is one in time: give the displacement at several times from 0 to "
            f"T = {T:g}; a problem without time is made by `static`"
        )
    if abs(times[-1] - T) > SINGLE * T:
        raise BoundError(f"the last time is {times[-1]:.6g}, the problem ends at T = {T:g}: change T of its body")
    equal = np.linspace(0.0, T, len(times))
    # Steps that were equal before rounding to single precision differ slightly, so they are made equal again.
    if abs(times - equal).max() <= SINGLE * equal[1]:
        return equal
    return np.array([0.0, *times[1:-1], T])


def _joined(points: Points, triangles: Array, u: Array) -> tuple[Points, Array, Array, list[str]]:
    """Remove points that belong to no triangle, and merge points at the same position.

    Files of discontinuous fields repeat a point for each of its triangles.
    """
    radius = JOINED_UP_TO * np.ptp(points, axis=0).max()
    used, inverse = np.unique(triangles, return_inverse=True)
    triangles = inverse.reshape(triangles.shape)
    points = points[used]
    u = u[:, used]
    pairs = cKDTree(points).query_pairs(radius, output_type="ndarray")
    if not len(pairs):
        return points, triangles, u, []
    count = len(points)
    graph = sps.coo_array((np.ones(len(pairs)), pairs.T), shape=(count, count))
    _, label = connected_components(graph, directed=False)
    _, first = np.unique(label, return_index=True)
    repeated = count - len(first)
    jump = abs(u - u[:, first[label]]).max()
    if jump > SINGLE * abs(u).max():
        raise BoundError(
            f"{repeated} points lie where others do, and u differs there by up to {jump:.3g}: u_h has to be "
            "continuous; give one displacement for each point"
        )
    return points[first], label[triangles], u[:, first], [f"{repeated} points that repeat others were joined"]


def _check_box(vertices: Array, body: Body) -> None:
    """Raise BoundError if a mesh with given vertices, (n, 2), differs from the body in size, unit or position.

    Their bounding boxes are compared first, because all other messages about the mesh assume that these agree.
    """
    low = vertices.min(axis=0)
    high = vertices.max(axis=0)
    start = body.vertices.min(axis=1)
    end = body.vertices.max(axis=1)
    size = end - start
    if abs(np.array([low - start, high - end])).max() <= SAME_LENGTH * size.max():
        return
    ratios = (high - low) / size
    factor = ratios.mean()
    if np.ptp(ratios) > SAME_LENGTH * ratios.max() or not ratios.all():
        remedy = "It is the mesh of another body"
    elif abs(ratios - 1).max() <= SAME_LENGTH:
        remedy = f"The mesh is shifted by {place(low - start)}: give both in the same coordinates"
    elif factor > 1:
        remedy = f"The mesh is larger than the body by the factor {factor:.4g}: give both in the same unit of length"
    else:
        remedy = (
            f"The mesh is smaller than the body by the factor {1 / factor:.4g}: give both in the same unit of length"
        )
    raise BoundError(
        f"the mesh does not fit the body: the mesh reaches from x = {place(low)} to {place(high)}, the body from "
        f"x = {place(start)} to {place(end)}. {remedy}"
    )


def _mesh(body: Body, points: Points, triangles: Array) -> tuple[Mesh, Array, int]:
    """Make the mesh from points and triangles.

    Returns:
        The mesh; for each of its nodes the number of the point there, in the order that ``Computed``
        describes; and the polynomial degree of the displacement, 1 or 2.
    """
    corners, local = np.unique(triangles[:, :3], return_inverse=True)
    p = _on_boundary(body, points[corners].T)
    mesh = simplicial_mesh(p, local.reshape(-1, 3).T)
    _check_cells(mesh)
    if triangles.shape[1] == 3:
        return mesh, corners, 1
    midpoints = np.zeros(mesh.facets.shape[1], dtype=np.int64)
    # The mesh lists the corners of a triangle in increasing order. So sides are compared by the corner opposite.
    sides = mesh.t2f[[1, 2, 0]].T
    order = np.argsort(triangles[:, :3], axis=1)
    numbers = np.take_along_axis(triangles[:, [4, 5, 3]], order, axis=1)
    midpoints[sides] = numbers
    if (midpoints[sides] != numbers).any():
        raise BoundError("two triangles have different midpoints of a common side; number the midpoint once")
    start, end = np.moveaxis(p[:, mesh.facets], 1, 0)
    off = np.linalg.norm(points[midpoints].T - (start + end) / 2, axis=0)
    relative = off / np.linalg.norm(end - start, axis=0)
    worst = int(relative.argmax())
    if relative[worst] > MIDPOINT_UP_TO:
        raise BoundError(
            f"the node of the side near x = {place(points[midpoints[worst]])} lies {off[worst]:.3g} off its midpoint: "
            "curved triangles, and midpoints in another order than 01, 12, 20, are not served"
        )
    return mesh, np.concatenate([corners, midpoints]), 2


def _on_boundary(body: Body, p: Points) -> Points:
    """Move vertices that are close to a corner or a side of the body onto it, (2, n) → (2, n).

    Such vertices lie off the boundary only because files are in single precision.
    """
    p = p.copy()
    near = SINGLE * body.extent
    for part in body.parts:
        _, off = part.coordinates(p)
        close = part.contains(p, near)
        p[:, close] += off[close] * part.normal[:, None]
    for corner in body.vertices.T[..., None]:
        close = np.linalg.norm(p - corner, axis=0) < near
        p[:, close] = corner
    return p


def _check_cells(mesh: Mesh) -> None:
    """Raise BoundError for cells without area and for sides that belong to more than two cells."""
    corners = mesh.p[:, mesh.t]
    sides = corners - np.roll(corners, 1, axis=1)
    diameters = np.linalg.norm(sides, axis=0).max(axis=0)
    flat = np.flatnonzero(cell_volumes(mesh) <= FLAT * diameters**2)
    if flat.size:
        where = place(corners[:, :, flat[0]].mean(axis=1))
        raise BoundError(f"{flat.size} triangles have no area, the first near x = {where}; remove them")
    cells_at_side = np.bincount(mesh.t2f.ravel())
    most = cells_at_side.max()
    if most > 2:
        where = place(mesh.p[:, mesh.facets[:, cells_at_side.argmax()]].mean(axis=1))
        raise BoundError(f"{most} triangles share a side near x = {where}: triangles overlap or are listed twice")


def _check_fit(mesh: Mesh, body: Body) -> None:
    """Raise BoundError unless the mesh covers the body and follows the parts of its boundary."""
    tolerance = FIT_TOLERANCE * math.sqrt(body.measure)
    ends = mesh.p[:, mesh.facets[:, mesh.boundary_facets()]]
    on_part = np.any([part.contains(ends, tolerance).all(axis=0) for part in body.parts], axis=0)
    stray = ends.mean(axis=1)[:, ~on_part]
    if stray.size:
        raise BoundError(
            f"the mesh does not cover the body: {stray.shape[1]} sides of triangles have a triangle on one side only "
            f"and lie on no part of the boundary, the first near x = {place(stray[:, 0])}. The mesh has a hole "
            "that the body lacks, or hanging nodes there, or it is the mesh of another body"
        )
    try:
        boundary_parts(mesh, body)
    except MeshError as error:
        raise BoundError(f"the mesh does not fit the body: {error}") from error


def _penetration(computed: Computed, in_time: bool) -> list[str]:
    """Return a list with a sentence that says how far u_h penetrates the foundation; empty if it does not."""
    space = computed.space
    values = computed.nodes.reshape(len(computed.times), -1, 2)
    depths = np.zeros(values.shape[:2])
    for part in computed.body.of(Kind.CONTACT):
        on = space.numbers_on(part)
        depths[:, on] = np.maximum(depths[:, on], values[:, on] @ part.normal)
    time, node = np.unravel_index(depths.argmax(), depths.shape)
    depth = depths[time, node]
    size = abs(values).max()
    if depth <= CLAMPED_UP_TO * size:
        return []
    when = f"t = {computed.times[time]:.4g}, " if in_time else ""
    return [
        f"u_h penetrates the foundation at its nodes by up to {depth:.3g}, {_percent(depth / size)} of its largest "
        f"component, at {when}x = {place(space.nodes[:, node])}"
    ]


class _Unclamped(Quadratic):
    """Displacements of degree 2 without conditions on CLAMPED and ROLLER sides."""

    @cached_property
    def free(self) -> Array:
        return np.arange(self.dim * self.count)


def _clamped(data: Data, computed: Computed, nearest: bool) -> Computed:
    """Return a displacement with the prescribed values on CLAMPED and ROLLER sides, which are 0 by default.

    If the displacement ``computed`` has these values up to round-off, it is returned. Otherwise, if ``nearest`` is
    true, the values at the nodes of these sides are replaced. If ``nearest`` is false, BoundError is raised.
    """
    body = computed.body
    space = computed.space
    u = computed.nodes
    prescribed = u.copy()
    fixed = np.setdiff1d(np.arange(u.shape[1]), space.free)
    # Prescribed displacements are linear on a side, so their Bernstein coefficients are their values at the nodes.
    prescribed[:, fixed] = space.prescribed[fixed]
    change = abs(u - prescribed)
    largest = float(change.max())
    size = float(abs(u).max())
    # Prescribed values may have rounding errors, and a common motion of all points would hide errors of the strain.
    if largest <= (AS_PRESCRIBED if body.is_moved else CLAMPED_UP_TO) * size:
        return computed
    offset = _largest_norm(data, computed, u - prescribed)
    norm = _largest_norm(data, computed, u)
    share = f"{offset:.3g} = {_percent(offset / norm if norm else math.inf)} of the largest ‖u_h‖_V"
    time, number = np.unravel_index(change.argmax(), change.shape)
    node, direction = divmod(int(number), 2)
    x = space.nodes[:, node]
    held = (part for part in body.parts if part.kind in (Kind.CLAMPED, Kind.ROLLER))
    side = next(part for part in held if part.contains(x, SINGLE * body.extent))
    where = f"side {body.parts.index(side)} ({side.kind.name})"
    if not (nearest or (body.is_moved and largest <= SINGLE * size)):
        raise BoundError(
            f"u_h is {u[time, number]:.4g} in the direction x{direction + 1} at x = {place(x)} on {where}, and has to "
            f"be {prescribed[time, number]:.4g} there. With --nearest (nearest=True) the values at the nodes of such "
            f"sides are replaced, which changes u_h by {share}"
        )
    remarks = computed.remarks
    if offset > UNCHANGED_UP_TO * norm:
        changed = f"u_h is changed by up to {largest:.3g} on {where}, to the prescribed values, and in ‖·‖_V by {share}"
        remarks = *remarks, changed
    return replace(computed, nodes=prescribed, remarks=remarks, offset=offset)


def _largest_norm(data: Data, computed: Computed, nodes: Array) -> float:
    """Return the largest norm ‖·‖_V of a displacement that is given by its values at the nodes of u_h, (k, values)."""
    V = _Unclamped(computed.mesh, computed.body)
    M = V.form(data.law.A.matrix, data.law.A.factor(V.points))
    v = on_refinement(computed.mesh, computed.degree, computed.mesh) @ nodes.T
    with np.errstate(over="ignore", invalid="ignore"):
        squares = (v * (M @ v)).sum(axis=0)
    return float(np.sqrt(np.maximum(squares.max(), 0.0)))


def _percent(share: float) -> str:
    """Return a share in per cent with two significant digits, without an exponent for 100 % and more."""
    return f"{float(f'{100 * share:.2g}'):g} %"
