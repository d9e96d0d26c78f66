"""Bodies, their meshes, quadrature, and V^h with its loads, in dimensions 2 and 3."""

from itertools import product
from math import factorial

import numpy as np
import pytest
from bodies import ANGLE, CLAMPED, CONTACT, LOADED, SQUARE, TURNED
from costly_cases import slow
from measures import close, smallest_angle
from on_meshes import space_on
from skfem import Basis, ElementTetP1, ElementTriP1, ElementVector, MeshTri
from skfem.models import linear_elasticity

from manufactured import Body, BodyError, Kind, Part, box, isotropic, named, polygon, unit_square
from study.fem.error_norm import ErrorNorm
from study.fem.independent import LeadingTerm, load_from_forces
from study.fem.mesh import (
    FAMILIES,
    CrissCross,
    Graded,
    MeshError,
    OneDiagonal,
    Shaken,
    Unstructured,
    boundary_parts,
    cell_volumes,
)
from study.fem.quadrature import Line, cell_rules, facet_rule, simplex_rule
from study.fem.space import Space
from study.statements.shared.meshes import body_of, first_with_each, fits, spacing

SKEW = np.array([[1.2, 0.3, 0.1], [0.0, 0.9, 0.2], [-0.2, 0.0, 1.1]])
FOR_SQUARES = [family for family in FAMILIES if family.serves(unit_square())]
PENTAGON = polygon([(0, 0), (1, 0), (1.3, 0.7), (0.5, 1.2), (-0.2, 0.6)], [CONTACT, LOADED, CLAMPED, LOADED, CONTACT])
GRADED = polygon(ANGLE, [CONTACT, LOADED, LOADED, LOADED, CLAMPED, LOADED], refine=[(1, 1), (0, 2)])
LAYERED = {
    name: polygon(SQUARE, [CONTACT, LOADED, CLAMPED, LOADED], refine=[(1, 1)], interfaces=interfaces)
    for name, interfaces in (
        ("level", [((0, 0.25), (1, 0.25)), ((1, 0.5), (0, 0.5))]),
        ("slanted", [((0, 0.3), (1, 0.7))]),
        ("branching", [((0, 0.3), (1, 0.7)), ((0, 0.3), (1, 0.25)), ((0.2, 1), (1, 0.7))]),
    )
}


# Corners of the unit cube: X is (1, 0, 0), XY is (1, 1, 0).
O, X, Y, Z = np.zeros(3), *np.eye(3)
XY = X + Y


FACES = box().parts


def face(kind, *corners):
    return Part(kind, np.array(corners).T)


def skewed():
    return Body(tuple(Part(part.kind, SKEW @ part.corners + [[3.0], [-1.0], [0.5]]) for part in FACES))


def split_bottom(*halves):
    """Return the unit cube with other parts as its bottom, such that the boundary condition changes inside a face."""
    return Body((*(part for part in FACES if part.kind is not CONTACT), *halves))


HALF = split_bottom(face(CONTACT, O, Y, Y + X / 2, X / 2), face(LOADED, X / 2, X / 2 + Y, XY, X))


def prism():
    """Return an L-shaped polygon times (0, 1): not convex, its flat ends cut into squares."""
    outline = [x * X + y * Y for x, y in ANGLE]
    sides = [face(LOADED, a, b, b + Z, a + Z) for a, b in zip(outline, outline[1:] + outline[:1], strict=True)]
    squares = [[corner, corner + Y, corner + XY, corner + X] for corner in (O, X, Y)]
    bottom = [face(CONTACT, *square) for square in squares]
    top = [face(CLAMPED, *(corner + Z for corner in square[::-1])) for square in squares]
    return Body((*sides, *bottom, *top))


SLAB = box((2.0, 1.0, 0.5), left=CONTACT)

# ---- polyhedra


@pytest.mark.parametrize(
    ("body", "volume"), [(SLAB, 1.0), (skewed(), np.linalg.det(SKEW)), (HALF, 1.0), (prism(), 3.0)]
)
def test_the_volume_follows_from_the_divergence_theorem(body, volume):
    assert body.measure == pytest.approx(volume)
    assert np.allclose(sum(part.measure * part.normal for part in body.parts), 0)


def test_a_point_lies_in_the_body_or_outside_and_samples_are_evenly_distributed(rng):
    body = prism()
    x = rng.uniform(-0.5, 2.5, (3, 40, 100))
    low, high = np.sort(x[:2], axis=0)
    inside = (low > 0) & (low < 1) & (high < 2) & (abs(x[2] - 0.5) < 0.5)
    assert (body.contains(x) == inside).all()
    sample = body.sample(rng, 6000)
    assert body.contains(sample).all()
    assert sample.mean(axis=1) == pytest.approx([5 / 6, 5 / 6, 1 / 2], abs=0.03)


@pytest.mark.parametrize(
    ("message", "make"),
    {
        "not flat": lambda: face(LOADED, O, X, XY + 0.1 * Z, Y),
        "not convex": lambda: face(LOADED, O, 2 * X, XY / 2, 2 * Y),
        "area 0": lambda: face(LOADED, O, X, 2 * X),
        "edge of length 0": lambda: face(LOADED, O, O, X),
        r"do not enclose the body: ∫ν .* is \[1.0, 0.0, 0.0\]": lambda: Body(FACES[1:]),
        "counter-clockwise": lambda: Body(tuple(Part(p.kind, p.corners[:, ::-1]) for p in FACES)),
        "do not enclose": lambda: Body((Part(LOADED, FACES[0].corners + 0.1), *FACES[1:])),
        "dimensions": lambda: Body((*FACES, *unit_square().parts)),
        "in a 2D body": lambda: Body(FACES, interfaces=(Part(Kind.INTERFACE, FACES[0].corners),)),
    }.items(),
)
def test_wrong_faces_and_bodies_are_refused(make, message):
    with pytest.raises(BodyError, match=message):
        make()


# ---- meshes


def test_shaken_vertices_slide_along_edges_and_along_lines_where_the_condition_or_the_material_changes():
    for body, n in ((HALF, 4), (LAYERED["level"], 8)):
        plain = OneDiagonal()(body, n).p
        held = np.isin(plain, (0, 1))
        if body is HALF:
            held[0] |= (plain[0] == 0.5) & (plain[2] == 0)
        else:
            held[1] |= np.isin(plain[1], (0.25, 0.5))
        off = abs(Shaken()(body, n).p - plain)
        assert off[held].max() <= 1e-15
        assert off[~held].min() > 1e-6


CHANGE_OFF_THE_GRID = polygon([(0, 0), (0.3, 0), (1, 0), (1, 1), (0, 1)], [CONTACT, LOADED, LOADED, CLAMPED, LOADED])
MESH = OneDiagonal()(unit_square(), 4)
SOLID_MESH = OneDiagonal()(box(), 2)
# The diagonals of the cells do not end where this face is cut.
CUT = split_bottom(face(CONTACT, O, Y, X), face(LOADED, X, Y, XY))


@pytest.mark.parametrize(
    ("message", "make"),
    {
        r"\[0.5, 1.0, 0.0\], which is not a vertex of the mesh": lambda: space_on(HALF, 3),
        "not a vertex of .*take a level at which it is, or the unstr": lambda: Space(
            OneDiagonal()(CHANGE_OFF_THE_GRID, 8), CHANGE_OFF_THE_GRID
        ),
        "edges of the mesh follow it": lambda: space_on(LAYERED["level"], 6),
        "facets of total area": lambda: space_on(CUT, 4),
        "dimension 2 was given for a body of dimension 3": lambda: Space(OneDiagonal()(unit_square(), 3), box()),
        "parallelepiped": lambda: OneDiagonal()(prism(), 3),
        "5 corners": lambda: OneDiagonal()(PENTAGON, 8),
        "2D bodies": lambda: CrissCross()(box(), 3),
        "list points in `refine`": lambda: Graded()(unit_square(), 8),
        "expected 1": lambda: Line((1.0, 1.0), 0.5),
        "not a vertex of .*make it a vertex of the body": lambda: cell_rules(MESH, 4, (), [(0.3, 0.3)]),
        "two lines or points": lambda: cell_rules(MESH, 4, (Line((1.0, 0.0), 0.1),), [(0.0, 0.0)]),
        "x1 = 0.3}, but cells are cut and graded in 2D only": lambda: cell_rules(
            SOLID_MESH, 4, (Line((1.0, 0.0, 0.0), 0.3),)
        ),
        "cells are cut and graded in 2D only": lambda: cell_rules(MESH, 4, (Line((1.0,), 0.3),)),
        "facets are divided in 2D only": lambda: facet_rule(
            SOLID_MESH, boundary_parts(SOLID_MESH, box())[4], FACES[4], (0.3,), 4
        ),
    }.items(),
)
def test_meshes_that_do_not_fit_a_body_and_lines_and_points_without_a_rule_are_refused(make, message):
    with pytest.raises(MeshError, match=message):
        make()


def test_families_serve_the_bodies_that_they_can_mesh():
    for body, names in (
        (skewed(), ["one-diagonal", "shaken"]),
        (prism(), []),
        (PENTAGON, ["unstructured"]),
        (LAYERED["level"], [family.name for family in FAMILIES]),
        (LAYERED["slanted"], ["unstructured", "graded"]),
        (LAYERED["branching"], ["unstructured", "graded"]),
    ):
        assert [family.name for family in FAMILIES if family.serves(body)] == names
    # At the level 20 both ends of the contact side at 0.3 and interfaces at 1/4 are on the grid.
    for body, family in product((PENTAGON, CHANGE_OFF_THE_GRID, *LAYERED.values()), FAMILIES):
        if family.serves(body):
            space_on(body, 20, family)  # which refuses a mesh whose edges do not follow the interfaces


def test_graded_meshes_shrink_towards_their_points_and_change_nothing_elsewhere():
    """The cells at c have diameters of the order n^{-5/2}, the others of the order 1/n."""
    nearest = []
    largest = []
    for n in (16, 32, 64):
        mesh = Graded()(GRADED, n)
        plain = Unstructured()(GRADED, n)
        nearest.append(np.sort(np.linalg.norm(mesh.p - 1, axis=0))[1])
        largest.append(np.sqrt(cell_volumes(mesh).max()))
        far = [np.linalg.norm(plain.p.T - c, axis=1) >= Graded().radius(GRADED, c) for c in GRADED.refine]
        assert (mesh.p == plain.p)[:, np.all(far, axis=0)].all()
    assert np.diff(np.log2(nearest)) == pytest.approx(-2.5, abs=0.25)
    assert np.diff(np.log2(largest)) == pytest.approx(-1, abs=0.2)


# ---- quadrature


@pytest.mark.parametrize(("dim", "degree"), [*product([2, 3], range(1, 9)), (2, 12), (2, 19)])
def test_a_rule_on_a_simplex_is_exact_to_its_degree(dim, degree):
    """∫ Π λ_i^{a_i} = d! |T| Π a_i! / (d + Σ a_i)!, the integral of a product of barycentric coordinates."""
    points, weights = simplex_rule(dim, degree)
    for powers in product(range(degree + 1), repeat=dim):
        if sum(powers) <= degree:
            exact = factorial(dim) * np.prod([factorial(a) for a in powers]) / factorial(dim + sum(powers))
            found = weights @ np.prod(points[1:] ** np.array(powers)[:, None], axis=0)
            assert found == pytest.approx(exact, rel=1e-11)


def test_rules_integrate_quartics_over_a_solid_and_sextics_over_its_faces():
    """∫ x² y² over a box, and ∫ x² y² z² over its faces: |F|³ c²/9 for the area |F| and the distance c from 0."""
    body = box((1.0, 2.0, 3.0))
    mesh = Shaken()(body, 3)
    total = sum(float(np.sum(np.prod(r.points[:2] ** 2, axis=0) * r.weights)) for r in cell_rules(mesh, 4, ()))
    assert total == pytest.approx(8 / 3, rel=1e-12)
    for part, facets in zip(body.parts, boundary_parts(mesh, body), strict=True):
        rule = facet_rule(mesh, facets, part, (), 4)
        x = part.point(rule.s)
        assert np.allclose(np.einsum("dkn,knq->dnq", mesh.p[:, mesh.facets[:, facets]], rule.shapes), x)
        assert rule.weights.sum() == pytest.approx(part.measure)
        integral = np.sum(np.prod(x**2, axis=0) * rule.weights)
        across = part.normal @ part.corners[:, 0]
        assert integral == pytest.approx(part.measure**3 / 9 * across**2, abs=1e-11)


@pytest.mark.parametrize("direction", [(1.0, 0.0), (0.6, 0.8)])
@pytest.mark.parametrize("exponent", [-0.5, 0.0, 0.5, 2.0])
def test_split_cells_integrate_powers_of_the_distance_to_a_line(direction, exponent):
    """∫ (s − c)_+^e (1 + r) over the unit square, turned so that s is the coordinate across the line, r along it."""
    plain = Shaken()(unit_square(), 6)
    line = Line(direction, 1 / 3)
    turned = np.array([direction, line.tangent])
    total = area = 0.0
    for rule in cell_rules(MeshTri(turned.T @ plain.p, plain.t), 6, (line,)):
        s, r = np.tensordot(turned, rule.points, axes=1)
        right = s > line.offset
        total += ((s[right] - line.offset) ** exponent * (1 + r[right])) @ rule.weights[right]
        area += rule.weights.sum()
    assert area == pytest.approx(1.0, rel=1e-12)
    # Away from the crossed cells the ordinary rule limits the accuracy.
    assert total == pytest.approx(1.5 * (2 / 3) ** (exponent + 1) / (exponent + 1), rel=2e-4)


@pytest.mark.parametrize(
    ("exponent", "exact"), [(-1, 2 * np.arcsinh(1)), (0, 1), (1, (np.sqrt(2) + np.arcsinh(1)) / 3), (2, 2 / 3)]
)
def test_cells_at_a_singular_point_integrate_powers_of_the_distance_to_it(exponent, exact):
    """∫ r^e over the unit square, with two cells at its corner; other cells around them limit the accuracy."""
    for mesh, degree, accuracy in (
        (OneDiagonal()(unit_square(), 1), 4, 1e-12),
        (Unstructured()(unit_square(), 8), 6, 1e-5),
    ):
        rules = cell_rules(mesh, degree, (), [(0.0, 0.0)])
        total = sum(np.sum(np.hypot(*rule.points) ** exponent * rule.weights) for rule in rules)
        assert total == pytest.approx(exact, rel=accuracy)


# ---- V^h


@pytest.mark.parametrize(("family", "body"), [*((f, TURNED) for f in FOR_SQUARES), (Shaken(), skewed())])
def test_the_matrix_of_a_form_is_the_one_that_scikit_fem_assembles(family, body, rng):
    mu = 1.3
    lam = 0.7
    space = space_on(body, 5 if body.dim == 2 else 3, family)
    basis = Basis(space.mesh, ElementVector(ElementTriP1() if body.dim == 2 else ElementTetP1()))
    expected = linear_elasticity(lam, mu).assemble(basis)[space.free][:, space.free]
    C = isotropic(mu, lam, body.dim).matrix
    v = rng.standard_normal(space.dofs)
    assert close(space.form(C), expected, 1e-12)
    assert close(space.functional(C @ space.strain(v)), expected @ v, 1e-12)


@pytest.mark.parametrize(("family", "body", "both"), [*((f, TURNED, 1) for f in FOR_SQUARES), (Shaken(), SLAB, 5)])
def test_constraints_are_v_dot_nu_on_every_face_and_twice_where_two_faces_meet(family, body, both, rng):
    space = space_on(body, 4, family)
    v = rng.normal(size=space.dofs)
    assert np.allclose(
        space.N @ v, np.hstack([part.normal @ space.nodal(v)[:, vertices] for part, vertices in space.contact])
    )
    assert len(np.intersect1d(space.contact[0][1], space.contact[1][1])) == both


# ---- loads and the leading term of the interpolation error, by independent formulas


@pytest.mark.parametrize("family", [OneDiagonal(), Shaken(), Unstructured()])
@pytest.mark.parametrize("name", ["full-contact", "no-contact"])
def test_the_load_from_stresses_is_the_load_from_forces_if_the_force_is_smooth(name, family):
    """By (2.14)."""
    solution = named(name).solution
    v_norm = ErrorNorm(solution, space_on(solution.body, 8, family), raised=4)
    load = load_from_forces(solution, v_norm.space, 0.7, v_norm.degree)
    assert np.linalg.norm(v_norm.load(0.7) - load) < 1e-9 * np.linalg.norm(load)


@pytest.mark.parametrize(
    ("family", "name", "n", "tolerance"),
    [
        *((family, "full-contact", 24, 3e-3) for family in FOR_SQUARES),
        slow(Shaken(), "cube-disc", 12, 0.05),
    ],
)
def test_the_leading_term_is_the_interpolation_error_on_fine_meshes(family, name, n, tolerance):
    solution = named(name).solution
    v_norm = ErrorNorm(solution, space_on(solution.body, n, family))
    sample = v_norm.sample(0.7)
    (leading,) = LeadingTerm(solution, v_norm.space)(np.array([0.7]))
    assert v_norm.distance(sample, sample.interpolant) == pytest.approx(leading, rel=tolerance)


# ---- random meshes


@pytest.mark.parametrize(("body", "n"), [(unit_square(), 24), (box(), 9)])
def test_vertices_are_moved_evenly_up_to_the_amplitude(body, n):
    """Uniform on ± a in each direction: the largest is close to a, the mean square a²/3, directions are independent."""
    plain = OneDiagonal()(body, n).p
    shaken = Shaken()(body, n).p
    inside = ((plain > 0) & (plain < 1)).all(axis=0)
    moved = (shaken - plain)[:, inside] * n / (Shaken().amplitude * 2 / body.dim)
    assert abs(moved).max(axis=1) == pytest.approx(1, abs=0.02)
    assert abs(moved).max() <= 1 + 1e-12
    # Mean squares and means of products.
    assert moved @ moved.T / moved.shape[1] == pytest.approx(np.eye(body.dim) / 3, abs=3 / np.sqrt(moved.shape[1]))


SHAPES = (*(case.name for case in first_with_each(body_of)), "layered")
"""Cases with the bodies of the catalogue, each once; one has interfaces."""


@pytest.mark.parametrize("name", SHAPES)
def test_no_cell_is_close_to_degenerate(name):
    """In 3D shaken simplices keep a fifth of their volume, in the plane angles stay away from 0."""
    body = named(name).solution.body
    for family in (family for family in FAMILIES if family.serves(body)):
        step = spacing(name, family.name)
        for n in (2 * step, 3 * step) if body.dim == 3 else [step * -(-n // step) for n in (8, 16)]:
            assert fits(family, body, n)
            mesh = family(body, n)
            volumes = cell_volumes(mesh)
            if body.dim == 3:
                assert volumes.min() > 0.2 * volumes.mean(), (family.name, n)
            else:
                assert np.degrees(smallest_angle(mesh.p[:, mesh.t])) > family.least_angle, (family.name, n)
