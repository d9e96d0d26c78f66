"""Polyhedra, their meshes, quadrature and V^h: the code of polygons in dimension 3."""

from __future__ import annotations

from itertools import product
from math import factorial

import numpy as np
import pytest
from skfem import Basis, BilinearForm, ElementTetP1, ElementVector
from skfem.helpers import ddot, sym_grad, trace

from manufactured import Body, BodyError, Kind, Part, box, isotropic, named, unit_square
from manufactured.tensors import mandel
from study.fem.error_norm import ErrorNorm
from study.fem.independent import LeadingTerm, load_from_forces
from study.fem.mesh import (
    FAMILIES,
    CrissCross,
    MeshError,
    OneDiagonal,
    Shaken,
    Unstructured,
    barycentric_gradients,
    boundary_parts,
    facet_measures,
)
from study.fem.quadrature import Line, cell_rules, facet_rule, simplex_rule
from study.fem.space import Space
from study.statements.pictures import contact_weights

SKEW = np.array([[1.2, 0.3, 0.1], [0.0, 0.9, 0.2], [-0.2, 0.0, 1.1]])
SOLID = [OneDiagonal(), Shaken()]


def face(kind: Kind, *corners: tuple[float, float, float]) -> Part:
    return Part(kind, np.array(corners, dtype=float).T)


def skewed() -> Body:
    """A parallelepiped, moved."""
    return Body(tuple(Part(part.kind, SKEW @ part.corners + [[3.0], [-1.0], [0.5]]) for part in box().parts))


def half_supported() -> Body:
    """The unit cube with Γ3 the left half of the bottom, so that the condition changes inside a face."""
    others = [part for part in box().parts if part.kind is not Kind.CONTACT]
    left = face(Kind.CONTACT, (0, 0, 0), (0, 1, 0), (0.5, 1, 0), (0.5, 0, 0))
    right = face(Kind.LOADED, (0.5, 0, 0), (0.5, 1, 0), (1, 1, 0), (1, 0, 0))
    return Body((*others, left, right))


def prism() -> Body:
    """An L-shaped polygon times (0, 1): not convex, its flat ends cut into squares."""
    plan = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
    sides = [
        face(Kind.LOADED, (*a, 0), (*b, 0), (*b, 1), (*a, 1)) for a, b in zip(plan, plan[1:] + plan[:1], strict=True)
    ]
    squares = [[(x, y), (x, y + 1), (x + 1, y + 1), (x + 1, y)] for x, y in ((0, 0), (1, 0), (0, 1))]
    bottom = [face(Kind.CONTACT, *((*c, 0) for c in square)) for square in squares]
    top = [face(Kind.CLAMPED, *((*c, 1) for c in square[::-1])) for square in squares]
    return Body((*sides, *bottom, *top))


BODIES = {"cube": box(), "slab": box((2.0, 1.0, 0.5), left=Kind.CONTACT), "skewed": skewed(), "half": half_supported()}


@pytest.mark.parametrize(
    ("body", "volume"),
    [(BODIES["slab"], 1.0), (skewed(), np.linalg.det(SKEW)), (half_supported(), 1.0), (prism(), 3.0)],
    ids=["slab", "skewed", "half", "prism"],
)
def test_the_volume_is_that_of_the_divergence_theorem(body: Body, volume: float) -> None:
    assert body.measure == pytest.approx(volume)
    assert np.allclose(sum(part.measure * part.normal for part in body.parts), 0)


def test_local_axes_are_right_handed_and_those_of_the_bottom_are_x_and_y() -> None:
    body = box((2.0, 3.0, 1.0))
    (bottom,) = body.of(Kind.CONTACT)
    assert np.allclose(bottom.frame, np.eye(3))
    assert np.allclose(bottom.coordinates(np.array([0.3, 0.4, 0.7]))[0], [0.3, 0.4])
    for part in (*body.parts, *skewed().parts):
        assert np.allclose(part.frame.T @ part.frame, np.eye(3))
        assert np.linalg.det(part.frame) == pytest.approx(1)
        assert np.allclose(part.point(part.outline), part.corners)
        assert np.allclose(part.outline[:, 0], 0)
        assert part.outline[1].min() >= -1e-12


def test_a_point_lies_in_the_body_or_outside() -> None:
    rng = np.random.default_rng(1)
    x = rng.uniform(-0.5, 2.5, (3, 4000))
    inside = (x[:2].min(axis=0) > 0) & (x[:2].max(axis=0) < 2) & (x[:2].min(axis=0) < 1) & (abs(x[2] - 0.5) < 0.5)
    assert (prism().contains(x) == inside).all()
    assert (prism().contains(x.reshape(3, 40, 100)) == inside.reshape(40, 100)).all()


def test_samples_are_even_in_the_body_and_on_its_faces() -> None:
    rng = np.random.default_rng(2)
    body = prism()
    x = body.sample(rng, 6000)
    assert body.contains(x).all()
    assert np.allclose(x.mean(axis=1), [5 / 6, 5 / 6, 1 / 2], atol=0.03)
    triangle = face(Kind.LOADED, (1, 0, 0), (0, 2, 0), (0, 0, 3))
    points = triangle.sample(rng, 6000)
    assert triangle.contains(points, 1e-12).all()
    assert np.allclose(points.mean(axis=1), [1 / 3, 2 / 3, 1], atol=0.05)
    assert np.allclose(points[0] + points[1] / 2 + points[2] / 3, 1)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: face(Kind.LOADED, (0, 0, 0), (1, 0, 0), (1, 1, 0.1), (0, 1, 0)), "not flat"),
        (lambda: face(Kind.LOADED, (0, 0, 0), (2, 0, 0), (0.5, 0.5, 0), (0, 2, 0)), "not convex"),
        (lambda: face(Kind.LOADED, (0, 0, 0), (1, 0, 0)), "cannot have corners of the shape"),
        (lambda: face(Kind.LOADED, (0, 0, 0), (1, 0, 0), (2, 0, 0)), "area 0"),
        (lambda: face(Kind.LOADED, (0, 0, 0), (0, 0, 0), (1, 0, 0)), "edge of length 0"),
        (lambda: face(Kind.LOADED, (0, 0, 0), (1, 0, 0), (0, np.nan, 0)), "not a finite number"),
        (lambda: Body(box().parts[1:]), "do not enclose"),
        (lambda: Body(box().parts[:1] + box().parts), "do not enclose"),
        (lambda: Body(tuple(Part(p.kind, p.corners[:, ::-1]) for p in box().parts)), "counter-clockwise"),
        (lambda: Body((Part(Kind.LOADED, box().parts[0].corners + 0.1), *box().parts[1:])), "do not enclose"),
        (lambda: Body((*box().parts, *unit_square().parts)), "dimensions"),
        (lambda: box(top=Kind.LOADED), "no part Γ1"),
        (lambda: Body(box().parts, refine=((0.5, 0.0, 0.0),)), "not one of the vertices"),
        (lambda: Body(box().parts, interfaces=(Part(Kind.INTERFACE, box().parts[0].corners),)), "in a 2D body"),
        (lambda: Body((Part(Kind.INTERFACE, box().parts[0].corners), *box().parts[1:])), "lies inside"),
    ],
)
def test_faces_and_bodies_that_are_none_are_refused(make, message: str) -> None:
    with pytest.raises(BodyError, match=message):
        make()


@pytest.mark.parametrize("family", SOLID, ids=lambda f: f.name)
@pytest.mark.parametrize("name", BODIES)
def test_tetrahedra_fill_the_body_and_their_facets_its_faces(family, name: str) -> None:
    body = BODIES[name]
    for n in (2, 6):
        space = Space(family(body, n), body)
        assert space.mesh.t.shape[1] == 6 * n**3
        assert space.volumes.sum() == pytest.approx(body.measure)
        # All cells of an unshaken mesh have the volume |Ω|/(6 n³).
        assert space.volumes.min() > 0.2 * body.measure / (6 * n**3)
        assert space.h == pytest.approx(body.measure ** (1 / 3) / n)
        for part, facets in zip(body.parts, space.parts, strict=True):
            assert facet_measures(space.mesh, facets).sum() == pytest.approx(part.measure)


def test_every_tetrahedron_of_a_kuhn_mesh_has_the_diagonal_of_its_cube() -> None:
    mesh = OneDiagonal()(box(), 3)
    corners = mesh.p[:, mesh.t]
    spread = np.ptp(corners, axis=1)
    assert np.allclose(spread, 1 / 3)
    sides = np.linalg.norm(corners[:, :, None] - corners[:, None], axis=0).max(axis=(0, 1))
    assert np.allclose(sides, np.sqrt(3) / 3)


@pytest.mark.parametrize("dim", [2, 3])
def test_the_worst_shaking_leaves_a_simplex_of_the_grid_a_fifth_of_its_volume(dim: int) -> None:
    """The volume is linear in every coordinate, so extreme where all shifts are."""
    path = np.tri(dim + 1, dim, -1)
    shifts = np.array(list(product([-1, 1], repeat=path.size))).reshape(-1, *path.shape) * Shaken().amplitude * 2 / dim
    moved = path + shifts
    assert np.linalg.det(moved[:, 1:] - moved[:, :1]).min() == pytest.approx(1 - 4 * Shaken().amplitude)


def test_shaken_vertices_slide_along_the_line_where_the_condition_changes() -> None:
    body = half_supported()
    plain, shaken = OneDiagonal()(body, 4).p, Shaken()(body, 4).p
    on = (plain[0] == 0.5) & (plain[2] == 0)
    assert (shaken[0, on] == 0.5).all()
    assert (shaken[2, on] == 0).all()
    moved = abs(shaken - plain).max(axis=0) > 1e-3
    inner = on & (plain[1] > 0) & (plain[1] < 1)
    assert moved[inner].all()
    assert not moved[on & ~inner].any()
    edge = (plain[1] == 0) & (plain[2] == 1) & (plain[0] > 0) & (plain[0] < 1)
    assert moved[edge].all()
    assert np.allclose(shaken[1:, edge], plain[1:, edge])


def test_meshes_that_do_not_fit_a_solid_are_refused() -> None:
    with pytest.raises(MeshError, match="is not a vertex of the mesh"):
        boundary_parts(OneDiagonal()(half_supported(), 3), half_supported())
    with pytest.raises(MeshError, match="dimension 2 was given for a body of dimension 3"):
        boundary_parts(OneDiagonal()(unit_square(), 3), box())
    with pytest.raises(MeshError, match="parallelepiped"):
        OneDiagonal()(prism(), 3)
    # The diagonals of the cells do not end where this face is cut.
    others = [part for part in box().parts if part.kind is not Kind.CONTACT]
    cut = [face(Kind.CONTACT, (0, 0, 0), (0, 1, 0), (1, 0, 0)), face(Kind.LOADED, (1, 0, 0), (0, 1, 0), (1, 1, 0))]
    with pytest.raises(MeshError, match="facets of total area"):
        Space(OneDiagonal()(Body((*others, *cut)), 4), Body((*others, *cut)))
    for family in (CrissCross(), Unstructured()):
        assert not family.serves(box())
        with pytest.raises(MeshError, match="2D bodies"):
            family(box(), 3)
    assert [family.name for family in FAMILIES if family.serves(skewed())] == ["one-diagonal", "shaken"]


@pytest.mark.parametrize(("dim", "degree"), [*product([2, 3], range(1, 9)), (2, 12), (2, 19)])
def test_a_rule_on_a_simplex_is_exact_to_its_degree(dim: int, degree: int) -> None:
    """∫ Π λ_i^{a_i} = d! |T| Π a_i! / (d + Σ a_i)!, the integral of a product of barycentric coordinates."""
    points, weights = simplex_rule(dim, degree)
    for powers in product(range(degree + 1), repeat=dim):
        if sum(powers) <= degree:
            exact = factorial(dim) * np.prod([factorial(a) for a in powers]) / factorial(dim + sum(powers))
            found = weights @ np.prod(points[1:] ** np.array(powers)[:, None], axis=0)
            assert found == pytest.approx(exact, rel=1e-11)


def test_cell_rules_integrate_quartics_over_a_solid() -> None:
    mesh = Shaken()(box(), 3)
    total = sum(float(np.sum(np.prod(r.points[:2] ** 2, axis=0) * r.weights)) for r in cell_rules(mesh, 4, ()))
    assert total == pytest.approx(1 / 9, rel=1e-12)


def test_facet_rules_integrate_sextics_over_the_faces_of_a_solid() -> None:
    body = box((1.0, 2.0, 3.0))
    mesh = Shaken()(body, 3)
    exact = [0, 8 * 27 / 9, 0, 4 * 27 / 9, 0, 9 * 8 / 9]
    for part, facets, integral in zip(body.parts, boundary_parts(mesh, body), exact, strict=True):
        rule = facet_rule(mesh, facets, part, (), 4)
        x = part.point(rule.s)
        assert np.allclose(np.einsum("dkn,knq->dnq", mesh.p[:, mesh.facets[:, facets]], rule.shapes), x)
        assert rule.weights.sum() == pytest.approx(part.measure)
        assert np.sum(np.prod(x**2, axis=0) * rule.weights) == pytest.approx(integral, abs=1e-11)


def test_lines_points_and_rough_coordinates_are_refused_in_a_solid() -> None:
    body = box()
    mesh = OneDiagonal()(body, 2)
    with pytest.raises(MeshError, match="2D only"):
        cell_rules(mesh, 4, (Line((1.0, 0.0, 0.0), 0.3),))
    with pytest.raises(MeshError, match="2D only"):
        facet_rule(mesh, boundary_parts(mesh, body)[4], body.parts[4], (0.3,), 4)


@pytest.mark.parametrize("family", SOLID, ids=lambda f: f.name)
def test_the_strain_of_an_affine_field_is_exact_and_so_is_its_energy(family) -> None:
    """With Γ1 at z = 1 and u = a (z − 1): ε = sym(a ⊗ e_3), (A ε, ε)_Q = |Ω| A ε·ε."""
    body, a, C = box(), np.array([0.3, -0.7, 0.5]), isotropic(1.3, 0.7, 3).matrix
    space = Space(family(body, 4), body)
    v = space.interpolate(np.multiply.outer(a, space.mesh.p[2] - 1))
    strain = mandel(np.multiply.outer(a, [0.0, 0.0, 1.0]))
    assert np.allclose(space.strain(v), strain[:, None])
    assert v @ space.form(C) @ v == pytest.approx(strain @ C @ strain)
    assert space.functional(np.ones((6, len(space.volumes)))) @ v == pytest.approx(strain.sum())


def test_barycentric_gradients_reproduce_affine_functions() -> None:
    mesh, slope = Shaken()(skewed(), 3), np.array([0.4, -1.1, 2.0])
    values = slope @ mesh.p + 0.7
    found = np.einsum("ci,cik->kc", values[mesh.t].T, barycentric_gradients(mesh))
    assert np.allclose(found, slope[:, None])


def test_the_matrix_of_a_form_is_the_one_scikit_fem_assembles_on_tetrahedra() -> None:
    body, mu, lam = skewed(), 1.3, 0.7
    space = Space(Shaken()(body, 3), body)
    basis = Basis(space.mesh, ElementVector(ElementTetP1()))

    @BilinearForm
    def form(u, v, _):
        e, d = sym_grad(u), sym_grad(v)
        return 2 * mu * ddot(e, d) + lam * trace(e) * trace(d)

    expected = form.assemble(basis)[space.free][:, space.free]
    assert abs(space.form(isotropic(mu, lam, 3).matrix) - expected).max() < 1e-12 * abs(expected).max()


def test_contact_constraints_of_a_solid_are_v_dot_nu_and_their_weights_cover_the_faces() -> None:
    body = BODIES["slab"]
    space = Space(Shaken()(body, 4), body)
    v = np.random.default_rng(3).normal(size=space.dofs)
    nodal = space.nodal(v)
    expected = np.concatenate([part.normal @ nodal[:, vertices] for part, vertices in space.contact])
    assert np.allclose(space.N @ v, expected)
    # Vertices on the edge between the two faces carry both constraints, those on Γ1 none.
    assert len(np.intersect1d(space.contact[0][1], space.contact[1][1])) == 5
    rows = [len(vertices) for _, vertices in space.contact]
    weights = np.split(contact_weights(space), np.cumsum(rows)[:-1])
    (_, vertices), (bottom, _) = space.contact
    assert np.isclose(weights[1].sum(), bottom.measure)
    assert weights[0].sum() < space.contact[0][0].measure
    assert (space.mesh.p[2, vertices] < 0.5).all()


@pytest.mark.slow
def test_the_two_loads_and_the_two_interpolation_errors_of_a_solid_meet_under_refinement() -> None:
    """Green's formula (2.14), f_0 with a jump across the moving circle, and the leading term of the interpolation
    error, in dimension 3."""
    solution = named("cube-disc").solution
    loads, shares = [], []
    for n in (4, 12):
        v_norm = ErrorNorm(solution, Space(Shaken()(solution.body, n), solution.body), raised=2)
        expected = v_norm.load(0.7)
        difference = expected - load_from_forces(solution, v_norm.space, 0.7, v_norm.degree)
        loads.append(np.linalg.norm(difference) / np.linalg.norm(expected))
        sample = v_norm.sample(0.7)
        shares.append(LeadingTerm(solution, v_norm.space)(0.7) / v_norm.distance(sample, sample.interpolant))
    assert loads[1] < min(loads[0] / 2, 0.02)
    assert abs(shares[1] - 1) < 0.05
    assert abs(shares[1] - 1) < abs(shares[0] - 1) / 3
