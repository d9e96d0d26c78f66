"""Quadrature rules on the cells and facets of a mesh, adapted to where the solution is not smooth.

* If the exact strain is singular or has a kink along a line at all times, cells are cut along the line, and the
  quadrature points are concentrated (graded) towards it.
* Cells with a vertex at a singular point have Duffy's rule, graded towards the point.
* Cells that contact fronts cross at one time can be cut along the fronts (``sliced_rules``).
* All other cells have a standard rule.

**Integrals at many times** of an exact strain, of its stress and of its energy over the cells. An exact strain is a sum
of products of a function φ_k of the point and a function T_k of the coordinate s along a contact face and of time
(``manufactured.modes``):

    ε(x, t) = Σ_k E_k φ_k(x) T_k(s_j, t).

Only the T_k, called amplitudes here, change with time. So the integral over a cell T, by a quadrature rule with points
x_p and weights w_p, is a fixed sparse matrix B_k times the amplitudes:

    ∫_T ε dx = Σ_k E_k Σ_j B_k[T, j] T_k(s_j, t),      B_k[T, j] = Σ {w_p φ_k(x_p) : x_p ∈ T, j(p) = j}.

Many points have the same coordinate s_j, so few formulas are evaluated at each time. On facets there is one sum for
each vertex instead of each cell, and the weights contain the shape function of the vertex.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import combinations_with_replacement, compress
from math import factorial, isqrt, prod

import numpy as np
import scipy.sparse as sps
from skfem import Mesh
from skfem.quadrature import get_quadrature
from skfem.refdom import RefTet, RefTri

from manufactured.body import Part
from manufactured.law import KelvinVoigt, Linear
from manufactured.modes import Modes
from manufactured.tensors import Array, Points, Tensors, mapped
from study.fem.mesh import MeshedBody, MeshError, barycentric_gradients, cell_volumes, facet_measures

VERTEX_ON_LINE = 1e-9
"""A vertex counts as lying on a line up to this distance, relative to the size of the cell."""
GRADING = 8
"""Exponent of the substitution s = c + L ξ^8, 0 < ξ < 1, that grades quadrature points towards a line or vertex s = c.

It turns (s − c)^{2(α−2)}, the square of a singular second derivative, into a nonnegative power of ξ for every α > 3/2.
"""


PointsAndWeights = tuple[Array, Array]
"""The points of a quadrature rule, in coordinates that each function names, and their weights."""


@dataclass(frozen=True, eq=False)
class CellRule:
    """A quadrature rule on several cells, with equally many points in each cell.

    Attributes:
        cells: the numbers of the cells, (n,).
        points: the quadrature points, (d, n, q).
        weights: the weights, (n, q); their sum over q is the volume of the cell.
    """

    cells: Array
    points: Points
    weights: Array


@dataclass(frozen=True, eq=False)
class FacetRule:
    """A quadrature rule on several facets of one boundary part.

    Attributes:
        facets: the numbers of the facets, (n,).
        s: the coordinates of the points along the part, (d−1, n, q).
        shapes: the P1 basis functions of the d vertices of the facet at the points, (d, n, q).
        weights: the weights, (n, q).
    """

    facets: Array
    s: Array
    shapes: Array
    weights: Array


@lru_cache
def gauss(count: int) -> PointsAndWeights:
    """Return nodes and weights of the Gauss–Legendre rule with ``count`` points on (0, 1), (count,) each."""
    x, w = np.polynomial.legendre.leggauss(count)
    found = (x + 1) / 2, w / 2
    for part in found:
        part.setflags(write=False)
    return found


def graded(
    left: Array, right: Array, count: int, power: Array | int = 1, to_right: Array | bool = False
) -> PointsAndWeights:
    """Return Gauss rules on intervals, graded towards one end of each interval.

    A Gauss rule in ξ on (0, 1) is mapped by the substitution s = near + (far − near) ξ^power, where ``near`` and
    ``far`` are the two ends of an interval. A power above 1 concentrates the points at the end ``near``.

    Args:
        left, right: the ends of the intervals, (..., 1).
        count: the number of points in each interval.
        power: the exponent of the substitution, one for all intervals or one for each, (..., 1).
        to_right: whether ``near`` is the right end, for all intervals or for each, (..., 1).

    Returns:
        Points and weights, (..., count) each.
    """
    xi, w = gauss(count)
    near = np.where(to_right, right, left)
    far = np.where(to_right, left, right)
    length = far - near
    slopes = power * xi ** (power - 1.0)
    return near + length * xi**power, abs(length) * slopes * w


def simplex_rule(dim: int, degree: int) -> PointsAndWeights:
    """Return a rule of the given degree on a simplex: barycentric points (d+1, q) and weights (q,) with sum 1.

    On triangles the degree can be up to 19, on tetrahedra up to 8. Rules of scikit-fem 12 are used. On tetrahedra its
    rule of degree 4 has negative weights, and from degree 5 on its rules are exact to one degree less than requested (a
    test verifies this); a rule of a higher degree is used instead.
    """
    rule = get_quadrature(RefTri, degree) if dim == 2 else get_quadrature(RefTet, degree + (degree > 3))
    points, weights = rule
    first = 1 - points.sum(axis=0)
    return np.vstack([first, points]), weights / weights.sum()


def duffy(along: int, across: int, grading: int = 1) -> PointsAndWeights:
    """Return Duffy's quadrature rule on a triangle with the vertices v_0, v_1, v_2, graded towards v_0.

    Gauss rules in ξ and η on the unit square are mapped to the triangle T by x = v_0 + ξ^g ((1−η)(v_1 − v_0) + η (v_2 −
    v_0)), with dx = 2|T| g ξ^{2g−1} dξ dη.

    Args:
        along: number of points in ξ, the direction away from v_0.
        across: number of points in η.
        grading: the exponent g.

    Returns:
        Barycentric points, (3, q), and weights with sum 1, (q,).

    Source: M. G. Duffy, Quadrature over a pyramid or cube of integrands with a singularity at a vertex, SIAM J. Numer.
    Anal. 19 (1982) 1260–1262.
    """
    (xi, wx), (eta, we) = gauss(along), gauss(across)
    far = np.repeat(xi**grading, across)
    share = np.tile(eta, along)
    jacobians = 2 * grading * xi ** (2 * grading - 1)
    weights = np.outer(jacobians * wx, we).ravel()
    return np.array([1 - far, far * (1 - share), far * share]), weights


def indices(degree: int, variables: int = 3) -> list[tuple[int, ...]]:
    """Return the multi-indices α ≥ 0 with |α| = degree, which number the Bernstein polynomials of this degree.

    They are tuples of integers, in descending lexicographic order.

    Args:
        degree: the degree.
        variables: the number of entries of α, which is the number of barycentric coordinates: 2 on an edge, 3 on a
            triangle.
    """
    choices = combinations_with_replacement(range(variables), degree)
    return [tuple(choice.count(i) for i in range(variables)) for choice in choices]


def bernstein(degree: int, barycentric: Array) -> Array:
    """Return the values of all Bernstein polynomials of a degree at points, in the order of ``indices``.

    Args:
        degree: the degree of the polynomials.
        barycentric: barycentric coordinates of the points, (v, ...), with v = 2 on an edge and 3 on a triangle.

    Returns:
        The values, (polynomials, ...).
    """

    def polynomial(alpha: tuple[int, ...]) -> Array:
        powers = (x**a for x, a in zip(barycentric, alpha, strict=True))
        return factorial(degree) / prod(map(factorial, alpha)) * prod(powers)

    return np.array([polynomial(alpha) for alpha in indices(degree, len(barycentric))])


def placed(vertices: Points, simplices: Array, barycentric: Array) -> Points:
    """Return the points that have given barycentric coordinates in each of n simplices, (d, n, q).

    Args:
        vertices: vertices of a mesh, (d, vertices).
        simplices: vertex numbers of the simplices, (k+1, n).
        barycentric: barycentric coordinates of q points in a k-simplex, (k+1, q).
    """
    return np.einsum("dvn,vq->dnq", vertices[:, simplices], barycentric)


def facet_rule(
    mesh: Mesh, facets: Array, part: Part, rough: Sequence[float], points: int, divisions: int = 1
) -> FacetRule:
    """Return a quadrature rule on facets of one boundary part, exact for polynomials of degree 2 · points − 2.

    Args:
        mesh: the mesh.
        facets: the numbers of the facets, (n,).
        part: the part on which the facets lie.
        rough: in 2D the coordinates along the part at which the integrand is not smooth. Facets are divided there, and
            the quadrature points are graded towards these coordinates.
        points: the number of Gauss points per direction, in 2D on each piece into which a facet is divided.
        divisions: in 2D the number of equal pieces into which every facet is divided.

    Raises:
        MeshError: ``rough`` is given in 3D.
    """
    if mesh.dim() == 3:
        if rough:
            raise MeshError(
                f"the rough coordinates {rough} were given on a face of a 3D body, but facets are divided in 2D only; "
                "use a contact face without `rough`"
            )
        barycentric, weights = duffy(points, points)
        s, _ = part.coordinates(placed(mesh.p, mesh.facets[:, facets], barycentric))
        shapes = np.repeat(barycentric[:, None], len(facets), axis=1)
        return FacetRule(facets, s, shapes, np.outer(facet_measures(mesh, facets), weights))
    corners = mesh.p[:, mesh.facets[:, facets]]
    (ends,), _ = part.coordinates(corners)
    low = ends.min(axis=0)
    high = ends.max(axis=0)
    cuts = [np.clip(c, low, high) for c in rough]
    nodes = np.sort([*np.linspace(low, high, divisions + 1), *cuts], axis=0)
    nodes = nodes.T[..., None]
    # Whether a node is one of the coordinates ``rough``, up to round-off.
    tolerance = VERTEX_ON_LINE * (high - low)
    is_rough = (abs(nodes - rough) <= tolerance[:, None, None]).any(axis=2, keepdims=True)
    from_left = is_rough[:, :-1]
    from_right = is_rough[:, 1:]
    power = np.where(from_left | from_right, GRADING, 1)
    s, weights = graded(nodes[:, :-1], nodes[:, 1:], points, power, from_right & ~from_left)
    s = s.reshape(len(facets), -1)
    start, end = ends[..., None]
    first = (end - s) / (end - start)
    shapes = np.stack([first, 1 - first])
    return FacetRule(facets, s[None], shapes, weights.reshape(s.shape))


def rule_on(space: MeshedBody, part: Part, points: int, rough: tuple[float, ...] = ()) -> FacetRule:
    """Return the quadrature rule of ``facet_rule`` on all facets of one boundary part of a meshed body.

    Args:
        space: the body and its mesh.
        part: the boundary part.
        points, rough: see ``facet_rule``.
    """
    return facet_rule(space.mesh, space.facets(part), part, rough, points)


# Cells in 2D in which the integrand is not smooth: how they are found, and their quadrature rules.

Point = tuple[float, ...]


@dataclass(frozen=True)
class Line:
    """The line {x : direction·x = offset} in the plane.

    Raises:
        MeshError: ``direction`` is not a unit vector.
    """

    direction: tuple[float, ...]
    offset: float

    def __post_init__(self) -> None:
        length = float(np.linalg.norm(self.direction))
        if abs(length - 1) > VERTEX_ON_LINE:
            raise MeshError(
                f"the direction {self.direction} of a line has the length {length:.9g}, expected 1; "
                "divide it and the offset by its length"
            )

    @property
    def tangent(self) -> Array:
        """The unit vector along the line, (2,): the vector ``direction`` rotated by +90°, counter-clockwise."""
        return np.array([-self.direction[1], self.direction[0]])

    def distance(self, points: Points) -> Array:
        """Return the signed distances of points from the line, (2, ...) → (...)."""
        return np.tensordot(self.direction, points, axes=1) - self.offset

    def __str__(self) -> str:
        terms = " + ".join(f"{c:.4g} x{i}" for i, c in enumerate(self.direction, start=1) if abs(c) > VERTEX_ON_LINE)
        return f"{{{terms} = {self.offset:.4g}}}"


def rough_cells(mesh: Mesh, lines: Sequence[Line], points: Sequence[Point]) -> Array:
    """Return whether each of several lines and points meets each cell, (lines + points, cells).

    Args:
        mesh: the mesh.
        lines: lines across which the solution is not smooth.
        points: points at which the solution is singular; each must be a vertex of the mesh.

    Returns:
        One row for each line, then one for each point. No cell occurs in two rows.

    Raises:
        MeshError: two lines or points meet the same cell, a point is not a vertex of the mesh, or lines or points are
            given in 3D.
    """
    names = [*map(str, lines), *(f"the point {point}" for point in points)]
    sizes = {mesh.dim(), *(len(line.direction) for line in lines)}
    if names and sizes != {2}:
        raise MeshError(
            f"the solution is not smooth at {', '.join(names)}, but cells are cut and graded in 2D only; use a "
            "contact face without `rough`, a material without `steps` and a solution without `singular`"
        )
    of_lines = [_touching(mesh, line) for line in lines]
    of_points = [(mesh.t == _vertex_at(mesh, point)).any(axis=0) for point in points]
    meets = np.array([*of_lines, *of_points], dtype=bool).reshape(-1, mesh.t.shape[1])
    several = np.flatnonzero(meets.sum(axis=0) > 1)
    if several.size:
        cell = several[0]
        centre = mesh.p[:, mesh.t[:, cell]].mean(axis=1)
        place = ", ".join(f"{x:.3g}" for x in centre)
        first, second, *_ = np.flatnonzero(meets[:, cell])
        raise MeshError(
            f"the cell around ({place}) meets two lines or points at which the solution is not smooth, "
            f"{names[first]} and {names[second]}, but a cell is cut for one of them only; take a finer level, "
            "or change the solution if they cross"
        )
    return meets


def _vertex_at(mesh: Mesh, point: Point) -> int:
    """Return the number of the vertex at a point; raise MeshError if there is none."""
    distances = np.linalg.norm(mesh.p.T - point, axis=1)
    vertex = int(distances.argmin())
    if distances[vertex] > VERTEX_ON_LINE * np.sqrt(cell_volumes(mesh).sum()):
        raise MeshError(
            f"the solution is singular at {point}, which is not a vertex of the mesh (the nearest is "
            f"{distances[vertex]:.3g} away); make it a vertex of the body"
        )
    return vertex


def _touching(mesh: Mesh, line: Line) -> Array:
    """Return for every cell whether a line crosses it or touches it at an edge or a vertex, (cells,)."""
    distances = line.distance(mesh.p)[mesh.t]
    low = distances.min(axis=0)
    high = distances.max(axis=0)
    near = VERTEX_ON_LINE * (high - low)
    return np.asarray((low <= near) & (high >= -near))


def fan_rule(mesh: Mesh, cells: Array, point: Point, degree: int) -> CellRule:
    """Return Duffy's rule on the cells that have a given point as a vertex, exact to the given degree.

    The rule is accurate for powers of the distance to the point. The substitution of ``duffy`` makes them smooth along
    the rays from the point.

    Args:
        mesh: the mesh.
        cells: the numbers of the cells, (n,).
        point: the point.
        degree: the degree of the polynomials for which the rule is exact.
    """
    simplices = mesh.t[:, cells]
    # The point becomes the first vertex of every cell.
    first = (simplices == _vertex_at(mesh, point)).argmax(axis=0)
    order = (first + np.arange(3)[:, None]) % 3
    simplices = np.take_along_axis(simplices, order, axis=0)
    barycentric, weights = duffy(GRADING * (degree + 2) // 2, degree + 8, GRADING)
    points = placed(mesh.p, simplices, barycentric)
    return CellRule(cells, points, np.outer(cell_volumes(mesh)[cells], weights))


def cut_rule(mesh: Mesh, cells: Array, line: Line, degree: int) -> CellRule:
    """Return a quadrature rule on cells that a line meets, graded towards the line.

    The cells are cut into slabs by the line and by its parallels through the vertices. In each slab, the rule across
    the line is a Gauss rule in ξ on (0, 1) after the substitution s = c + L ξ^8. Here s is the signed distance from the
    line, c its value at the side of the slab that is nearer to the line, and |L| the width of the slab.

    Args:
        mesh: the mesh.
        cells: the numbers of the cells, (n,).
        line: the line.
        degree: the degree of the polynomials for which the rule is exact.
    """

    def towards_line(left: Array, right: Array) -> PointsAndWeights:
        return graded(left, right, degree + GRADING, GRADING, abs(left) > abs(right))

    return _slab_rule(mesh, cells, [line], towards_line, degree)


def sliced_rules(mesh: Mesh, fronts: Sequence[Line], but: Array, degree: int) -> Iterator[CellRule]:
    """Yield quadrature rules for the cells that contact fronts cross; the cells are cut along the fronts.

    A cell is cut along all parallel fronts that meet it. If fronts of different directions meet a cell, it is cut only
    along those whose direction comes first in ``fronts``, and the rule is less accurate for integrands that are not
    smooth across the others.

    Args:
        mesh: a mesh in 2D.
        fronts: lines through the contact fronts of one time.
        but: whether a cell gets no rule, (cells,).
        degree: degree of the rules.
    """
    across = partial(graded, count=degree // 2 + 2)
    remaining = ~but
    for direction in dict.fromkeys(front.direction for front in fronts):
        parallel = [front for front in fronts if front.direction == direction]
        met = remaining & [_touching(mesh, front) for front in parallel]
        for pattern in np.unique(met[:, met.any(axis=0)], axis=1).T:
            cells = np.flatnonzero((met == pattern[:, None]).all(axis=0))
            yield _slab_rule(mesh, cells, [*compress(parallel, pattern)], across, degree)
        remaining &= ~met.any(axis=0)


def _slab_rule(
    mesh: Mesh,
    cells: Array,
    lines: Sequence[Line],
    across: Callable[[Array, Array], PointsAndWeights],
    degree: int,
) -> CellRule:
    """Return a quadrature rule on triangles that are cut into slabs by parallel lines.

    Let s be the signed distance from the first line and r the coordinate along it. The slabs end at the vertices of a
    triangle and at the lines. In each slab a rule in s is combined with a Gauss rule in r.

    Args:
        mesh: a mesh in 2D.
        cells: numbers of the n cells.
        lines: the lines, with equal directions.
        across: function from the ends of k slabs of every cell, (n, k, 1) each, to points and weights of a rule in s,
            (n, k, p) each.
        degree: degree of the rule in r.
    """
    line = lines[0]
    corners = mesh.p[:, mesh.t[:, cells]]
    s = line.distance(corners)
    r = np.tensordot(line.tangent, corners, axes=1)
    # The vertices of a cell in the order of their distances, (3, n, 1, 1).
    order = np.argsort(s, axis=0)
    s = np.take_along_axis(s, order, axis=0)[..., None, None]
    r = np.take_along_axis(r, order, axis=0)[..., None, None]
    cuts = [np.clip(parallel.offset - line.offset, s[0], s[2]) for parallel in lines]
    ends = np.concatenate(np.sort([*s, *cuts], axis=0), axis=1)
    x, weights = across(ends[:, :-1], ends[:, 1:])

    def chord(low: int, high: int) -> Array:
        """Return the coordinates r of the points with s = x on the edge between two vertices, (n, k, p)."""
        length = s[high] - s[low]
        change = r[high] - r[low]
        slope = np.divide(change, length, out=np.zeros_like(length), where=length > 0)
        return np.asarray(r[low] + slope * (x - s[low]))

    long = chord(0, 2)
    # Which edges bound the slab is decided by its last point, because rounding can put the first point outside the
    # slab.
    short = np.where(x[..., -1:] <= s[1], chord(0, 1), chord(1, 2))
    width = short - long
    eta, we = gauss(degree // 2 + 2)
    along = long[..., None] + width[..., None] * eta
    distances = np.broadcast_to(x[..., None], along.shape)
    coordinates = np.stack([line.offset + distances, along]).reshape(2, len(cells), -1)
    axes = np.transpose([line.direction, line.tangent])
    weights = (weights * abs(width))[..., None] * we
    return CellRule(cells, mapped(axes, coordinates), weights.reshape(len(cells), -1))


# Quadrature rules that together cover every cell once. Many of their points share their coordinate along a contact
# face, so that functions of this coordinate are evaluated once for all of them.

CELLS_IN_RULE = 4096
"""Largest number of ordinary cells in one quadrature rule, so that its points fit into the processor's cache."""
LARGEST_SHIFT = 1 / 32
"""If quadrature points are aligned with lines, their barycentric coordinates change by at most this number."""
TIE = 1e-9
"""A number added to the logarithm of a spacing before it is rounded down.

Congruent cells thereby get equal spacings of quadrature points despite round-off.
"""


def cell_rules(
    mesh: Mesh, degree: int, lines: Sequence[Line], points: Sequence[Point] = (), along: Sequence[Line] = ()
) -> list[CellRule]:
    """Return quadrature rules that together cover every cell once.

    Args:
        mesh: a mesh in 2D; in 3D only if there are no lines and points.
        degree: degree of the rule on ordinary cells, up to 19 in 2D and 8 in 3D. Cells at a line or point get enough
            points for the same accuracy.
        lines: lines at which the integrand is not smooth.
        points: vertices of the mesh at which the integrand is singular.
        along: at most two lines, not parallel. The quadrature points of ordinary cells are moved so that many of them
            have the same distance to one of these lines, as described in ``shared``.

    Raises:
        MeshError: as in ``rough_cells``.
    """
    special = rough_cells(mesh, lines, points)
    made = [partial(cut_rule, mesh, line=line, degree=degree) for line in lines]
    made += [partial(fan_rule, mesh, point=point, degree=degree) for point in points]
    rules = [rule(cells=np.flatnonzero(met)) for met, rule in zip(special, made, strict=True) if met.any()]
    ordinary = np.flatnonzero(~special.any(axis=0))
    barycentric, weights = simplex_rule(mesh.dim(), degree)
    volumes = cell_volumes(mesh)[:, None]
    gradients = barycentric_gradients(mesh) if along else None
    for start in range(0, ordinary.size, CELLS_IN_RULE):
        cells = ordinary[start : start + CELLS_IN_RULE]
        x = placed(mesh.p, mesh.t[:, cells], barycentric)
        shares = weights
        if gradients is not None:
            x, shares = shared(x, gradients[cells], barycentric, weights, along)
        rules.append(CellRule(cells, x, volumes[cells] * shares))
    return rules


def shared(
    points: Points, gradients: Array, barycentric: Array, weights: Array, lines: Sequence[Line]
) -> PointsAndWeights:
    """Move the points of a quadrature rule on triangles so that few different distances to given lines occur.

    The reason is run time: formulas of an exact solution in (s, t) are expensive, where s is the distance to a line and
    t the time, and on an unstructured mesh all quadrature points have different s. So each point is moved to the
    nearest of the lines s = jδ with integers j. It is moved perpendicularly to the line or, if there are two lines,
    along the other one. δ is the power of two with H/32 < δ ≤ H/16, or H/64 < δ ≤ H/32 if there are two lines, where H
    is the largest change of s within the cell in this direction; it is smaller if the rule has points very close to the
    edges. The weights are then changed as little as possible so that the rule is exact for polynomials of the highest
    degree that this number of weights permits, which is 2 for six points.

    Args:
        points: the points of the original rule on n triangles, (2, n, q).
        gradients: the gradients of the barycentric coordinates, ∇λ_i, (n, 3, 2).
        barycentric, weights: barycentric coordinates, (3, q), and weights with sum 1, (q,), of the original rule.
        lines: one or two lines, not parallel.

    Returns:
        The moved points, (2, n, q), and their weights, (n, q), with sum 1 on every triangle.
    """
    moves = np.linalg.pinv(np.array([line.direction for line in lines])).T
    limit = min(LARGEST_SHIFT, float(barycentric.min()) / 2) / len(moves)
    new = barycentric[:, None]
    for line, move in zip(lines, moves, strict=True):
        slopes = gradients @ move
        # The spacing δ is chosen such that no barycentric coordinate λ_i changes by more than the limit: moving a point
        # by δ/2 along the normal m of the line changes λ_i by half of δ ∇λ_i·m.
        largest = 2 * limit / abs(slopes).max(axis=1)
        spacing = np.exp2(np.floor(np.log2(largest) + TIE))[:, None]
        distances = line.distance(points)
        shift = np.rint(distances / spacing) * spacing - distances
        points = points + np.multiply.outer(move, shift)
        new = new + slopes.T[..., None] * shift
    return points, weights + _correction(new, weights)


def _correction(barycentric: Array, weights: Array) -> Array:
    """Return the smallest change of the weights, (n, q), that makes a rule exact again after its points have moved.

    The change is measured relative to the weights.

    Args:
        barycentric: the moved points of n triangles, (3, n, q).
        weights: the original weights, (q,).
    """
    degree = (isqrt(8 * len(weights) + 1) - 3) // 2
    shapes = np.moveaxis(bernstein(degree, barycentric), 1, 0)
    # All Bernstein polynomials have the same mean value on a triangle, and their sum is 1.
    missing = 1 / shapes.shape[1] - shapes @ weights
    gram = (shapes * weights) @ shapes.swapaxes(1, 2)
    multipliers = np.linalg.solve(gram, missing[..., None])
    return weights * (multipliers.swapaxes(1, 2) @ shapes)[:, 0]


Amplitudes = Array
"""The type of the amplitudes of a strain, the time-dependent factors T_k(s_j, t) of its terms, at n times.

The strain is a sum of K products E_k φ_k(x) T_k(s, t), and s_j are the J coordinates of points along the contact face
(``Modes``). The J values of each of the K terms follow one after the other, (Σ K J, n).
"""
MOST_TIMES, MOST_VALUES = 32, 1 << 19
"""Largest number of times that are evaluated together, and largest number of values for all these times.

Formulas are called less often for blocks of times. Larger blocks would leave the processor's cache.
"""
MOST_POINTS = 250_000
"""Largest number of quadrature points at which ``StrainEnergy`` evaluates the strain together."""
MANY = 4
"""``StrainEnergy`` stores the energy as a matrix if it needs at most this many times the memory of the strain."""


def blocks(times: Array | float, size: int) -> list[Array]:
    """Divide times, (n,), into blocks that are evaluated together.

    Args:
        times: the times, (n,).
        size: the number of values that are computed for each time. It limits the length of a block, so that the values
            of a block fit into the processor's cache.
    """
    most = max(1, min(MOST_TIMES, MOST_VALUES // size))
    return np.split(np.atleast_1d(times), range(most, np.size(times), most))


def amplitudes_of(modes: Sequence[Modes]) -> Callable[[Array, bool], Amplitudes]:
    """Return the function that evaluates the amplitudes, the time-dependent factors of a strain.

    The strain is a sum of products ε(x, t) = Σ_k E_k φ_k(x) T_k(s, t), where E_k are constant tensors, and s is the
    coordinate of x along the contact face (``Modes``). The amplitudes are the values T_k(s_j, t) of all terms k at
    their coordinates s_j. If ``rate`` is true, they are ∂_t T_k(s_j, t), the amplitudes of the strain rate ε̇.

    Args:
        modes: the sums of products that add up to the strain. A sum has K terms and J coordinates s_j.

    Returns:
        A function from n times, (n,), and the flag ``rate`` to the amplitudes, (Σ K J, n). The rows of the sums follow
        one after the other.
    """
    # The returned function stores only these references. A reference to the modes would keep their large arrays in
    # memory.
    each = [part.amplitudes for part in modes]

    def at(times: Array, rate: bool) -> Amplitudes:
        # A loop, because a comprehension is one more call in Python 3.11, and the depth of calls is limited.
        found = []
        for of in each:
            found.append(of(times, rate).reshape(-1, len(times)))
        return np.concatenate(found)

    return at


@dataclass(frozen=True, eq=False)
class QuadraturePoints:
    """Quadrature points for several weighted sums, one sum for each cell or for each vertex of a mesh.

    Attributes:
        x: the points, (d, n).
        sums: for each point, the index of the sum to which it contributes, (n,).
        weights: the quadrature weights, (n,).
        count: the number of sums.
    """

    x: Array
    sums: Array
    weights: Array
    count: int

    @classmethod
    def on_cells(cls, rules: Sequence[CellRule]) -> QuadraturePoints:
        """Return the points of quadrature rules that together cover every cell once.

        The weighted values at the points of a cell are added up to one sum, the integral over this cell. The sums are
        numbered like the cells.
        """
        return cls(
            np.hstack([rule.points.reshape(len(rule.points), -1) for rule in rules]),
            np.concatenate([np.repeat(rule.cells, rule.weights.shape[1]) for rule in rules]),
            np.concatenate([rule.weights.ravel() for rule in rules]),
            sum(len(rule.cells) for rule in rules),
        )

    @classmethod
    def on_facets(cls, rule: FacetRule, part: Part, mesh: Mesh) -> tuple[QuadraturePoints, Array]:
        """Return the points of a rule on facets, with one sum for each vertex, and the numbers of the vertices.

        The sum of a vertex is the integral of a function times the hat function of the vertex. The weights contain the
        hat function, so a point of a facet occurs once for each of the d vertices of the facet.

        Args:
            rule: the quadrature rule on facets of a boundary part.
            part: the boundary part.
            mesh: the mesh to which the facets belong.

        Returns:
            The points, and the numbers of the vertices in the order of the sums, (count,).
        """
        vertices, sums = np.unique(mesh.facets[:, rule.facets], return_inverse=True)
        x = part.point(rule.s)
        weights = rule.shapes * rule.weights
        copies = np.tile(x.reshape(len(x), -1), len(weights))
        sums = np.repeat(sums, weights.shape[2])
        return cls(copies, sums, weights.ravel(), len(vertices)), vertices

    def adding(self, weights: Array) -> sps.csr_array:
        """Return the matrix that maps values at the n points to the weighted sums, (count, n).

        Args:
            weights: the weights of the points, (n,), for example ``self.weights`` times a material factor.
        """
        points = np.arange(len(weights))
        return sps.csr_array((weights, (self.sums, points)), shape=(self.count, len(weights)))


def shapes_at_points(modes: Sequence[Modes], count: int) -> Iterator[sps.csr_array]:
    """Yield for each term of a strain the matrix that maps its amplitudes to its values at the quadrature points.

    A term is E_k φ_k(x) T_k(s, t) with a constant tensor E_k; its amplitudes are T_k(s_j, t) at J coordinates s_j along
    the contact face (``Modes``). The matrix, (count, J), maps the amplitudes to φ_k(x_p) T_k(s_{j(p)}, t) at the points
    x_p, where s_{j(p)} is the coordinate of x_p.

    Args:
        modes: the sums of products that add up to the strain.
        count: the number of quadrature points.
    """
    for part in modes:
        # Each row belongs to a point and has one entry, so the arrays of the CSR format can be filled without sorting.
        rows = np.searchsorted(part.points, np.arange(count + 1)).astype(np.int32)
        places = part.places.astype(np.int32)
        for shape in part.shapes:
            yield sps.csr_array((shape, places, rows), shape=(count, part.count))


def strain_matrix(modes: Sequence[Modes], count: int) -> sps.csr_array:
    """Return the matrix from the amplitudes of a strain to the strain at ``count`` points, (D · count, Σ K J).

    The rows are ordered component by component, with D Mandel components. The columns are the amplitudes in the order
    of ``amplitudes_of``.

    Args:
        modes: the sums of products that add up to the strain; a sum has K terms and J amplitudes for each term.
        count: the number of points.
    """
    tensors = np.concatenate([part.tensors for part in modes])
    shapes = shapes_at_points(modes, count)
    columns = [sps.kron(E[:, None], shape) for E, shape in zip(tensors, shapes, strict=True)]
    return sps.csr_array(sps.hstack(columns))


class StrainSums:
    """Computes weighted sums Σ w_p ε(x_p, t) of a strain ε over points x_p at n times, (D, sums, n).

    A call needs the amplitudes of the strain, its time-dependent factors, as ``amplitudes_of`` returns them.

    Args:
        modes: the strain ε at the points x_p, as sums of products (``Modes``).
        points: the points, with the sums to which they contribute.
        weights: the weights w_p, (points,), which are quadrature weights, possibly times material factors.
    """

    def __init__(self, modes: Sequence[Modes], points: QuadraturePoints, weights: Array) -> None:
        add = points.adding(weights)
        count = len(weights)
        blocks = []
        first = 0
        width = sum(len(part.tensors) * part.count for part in modes)
        for shape in shapes_at_points(modes, count):
            sums = add @ shape
            shifted = sums.data, sums.indices + first, sums.indptr
            blocks.append(sps.csr_array(shifted, shape=(points.count, width)))
            first += shape.shape[1]
        # ``block_diag`` would need twice the memory.
        self._matrix = sps.vstack(blocks, format="csr")
        self._tensors = np.concatenate([part.tensors for part in modes]).T

    def __call__(self, amplitudes: Amplitudes, C: Array | None = None) -> Tensors:
        """Return the sums of the strain ε, or of the stress C ε if a tensor C is given in Mandel form, (D, D)."""
        sums = (self._matrix @ amplitudes).reshape(self._tensors.shape[1], -1, amplitudes.shape[1])
        return mapped(self._tensors if C is None else C @ self._tensors, sums)


class StressSums:
    """Computes weighted sums Σ w_p σ(x_p, t) of the stress σ = A ε(u̇) + G ε(u) at n times, (D, sums, n).

    A and G may contain scalar factors that depend on the point; each has its own factor. A call needs the amplitudes of
    the strain ε(u), then those of its rate ε(u̇), at these times, as ``amplitudes_of`` returns them.

    Args:
        law: the material law, with A and G.
        modes: the strain ε(u) at the points x_p, as sums of products (``Modes``).
        points: the points x_p with their quadrature weights w_p and the sums to which they contribute.

    Attributes:
        viscous: the sums Σ w_p α(x_p) of the factor α of A, (sums,).
        strains: computes the sums Σ w_p α(x_p) ε(x_p, t) of the strain from its amplitudes, also with the factor of A.
            Divided by ``viscous`` they are the weighted means of the strain.
    """

    def __init__(self, law: KelvinVoigt, modes: Sequence[Modes], points: QuadraturePoints) -> None:
        self._A = law.A
        G = law.G
        viscous, elastic = (points.weights * tensor.factor(points.x) for tensor in (law.A, G))
        self.viscous = np.bincount(points.sums, viscous, points.count)
        self.strains = StrainSums(modes, points, viscous)
        self._elastic: Callable[[Amplitudes], Tensors]
        if isinstance(G, Linear):
            linear = self.strains if np.array_equal(viscous, elastic) else StrainSums(modes, points, elastic)
            self._elastic = lambda strains: linear(strains, G.matrix)
        else:
            strain = strain_matrix(modes, len(elastic))
            add = points.adding(elastic)

            def nonlinear(strains: Amplitudes) -> Tensors:
                stress = G((strain @ strains).reshape(-1, len(elastic), strains.shape[1]))
                return np.array([add @ component for component in stress])

            self._elastic = nonlinear

    def __call__(self, strains: Amplitudes, rates: Amplitudes) -> Tensors:
        return self.strains(rates, self._A.matrix) + self._elastic(strains)


class StrainEnergy:
    """Computes the energies ∫_Ω α C ε·ε dx of a strain ε at several times, (times,), from its amplitudes.

    The amplitudes are the time-dependent factors of the strain, as ``amplitudes_of`` returns them. If many points have
    the same coordinate along the contact face, there are few amplitudes, and the energy is stored as a quadratic form
    of them. Otherwise the matrix of this form would be too large, and the strain at the points is computed first.

    Args:
        modes: the strain ε at the quadrature points, as sums of products (``Modes``).
        weights: quadrature weights times the material factor α, (points,).
        C: a symmetric tensor in Mandel form, (D, D).
    """

    def __init__(self, modes: Sequence[Modes], weights: Array, C: Array) -> None:
        self._strain: sps.csr_array | None = None
        of_form = sum(len(part.tensors) ** 2 * part.count for part in modes)
        of_strain = sum(part.shapes.size for part in modes)
        if of_form > MANY * of_strain:
            self._strain = strain_matrix(modes, len(weights))
            self._form = sps.csr_array(sps.kron(C, sps.diags_array(weights)))
            return
        # The strain at all points together would need most of the memory of a run.
        forms = []
        for first in range(0, len(weights), MOST_POINTS):
            some = weights[first : first + MOST_POINTS]
            strain = strain_matrix([part.among(first, first + MOST_POINTS) for part in modes], len(some))
            forms.append(strain.T @ sps.kron(C, sps.diags_array(some)) @ strain)
        self._form = sps.csr_array(sum(forms))

    def __call__(self, amplitudes: Amplitudes) -> Array:
        v = amplitudes if self._strain is None else self._strain @ amplitudes
        return np.einsum("in,in->n", v, self._form @ v)
