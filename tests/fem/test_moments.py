"""Exact strains as sums of products, quadrature points that share coordinates, and the integrals made of both."""

import numpy as np
import pytest
from costly_cases import BEYOND_THE_CATALOGUE, by_cost
from hypothesis import given
from hypothesis import strategies as st
from measures import close
from numpy.testing import assert_allclose
from on_meshes import space_on
from random_examples import RANDOM
from skfem import MeshTri

from manufactured.catalogue import NAMES
from manufactured.law import Linear
from study.fem.error_norm import FACET_POINTS, SOLID_FACET_POINTS, ErrorNorm, rules
from study.fem.mesh import FAMILIES, barycentric, barycentric_gradients
from study.fem.naming import resolve
from study.fem.quadrature import Line, facet_rule, placed, shared, simplex_rule

POINTS = 200


def summed(modes, times, rate):
    """The sums of modes at some times, (times, D, points); amplitudes at many times are those at each."""
    found = 0.0
    for part in modes:
        amplitudes = part.amplitudes(times, rate)[:, part.places]
        each = np.stack([part.amplitudes(time, rate)[:, part.places] for time in times.tolist()], axis=-1)
        assert_allclose(amplitudes, each, rtol=1e-13, atol=1e-14 * abs(each).max(initial=0.0))
        values = np.zeros((len(times), part.tensors.shape[1], POINTS))
        values[..., part.points] = np.einsum("kD,kn,knt->tDn", part.tensors, part.shapes, amplitudes)
        found = found + values
    return found


@pytest.mark.parametrize("name", by_cost([*NAMES, *BEYOND_THE_CATALOGUE]))
def test_modes_sum_to_the_strain_its_rate_and_the_force(name, rng):
    solution = resolve(name).solution
    times = solution.body.T * np.array([0.37, 0.8])
    fields = solution.at(solution.body.sample(rng, POINTS))
    strain, rate, stress = (np.moveaxis(of(times), -1, 0) for of in (fields.strain, fields.strain_rate, fields.stress))
    assert close(summed(fields.modes(), times, False), strain, 1e-13)
    assert close(summed(fields.modes(), times, True), rate, 1e-13)
    if name in NAMES and isinstance(solution.law.G, Linear):
        modes = fields.force_modes()
        force = np.moveaxis(fields.body_force(times), -1, 0)
        found = summed(modes.viscous, times, True) + summed(modes.elastic, times, False)
        assert abs(found - force).max() <= 1e-12 * max(abs(force).max(), abs(stress).max())


@pytest.mark.parametrize(
    "case",
    [
        "advance-recede",
        "hexagon",
        "re-entrant",
        "heterogeneous",
        "layered",
        "yield-and-release",
        "double-well",
        "cube-disc",
    ],
)
def test_error_and_load_are_integrals_over_the_points_of_the_rules(case, monkeypatch):
    """The load is (σ, ε(v))_Q + ∫_{Γ3} p v_ν. Strain, stress and pressure are evaluated point by point."""
    monkeypatch.setattr("study.fem.quadrature.MOST_POINTS", 500)
    solution = resolve(case).solution
    family = next(family for family in FAMILIES if family.serves(solution.body) and family.name != "one-diagonal")
    space = space_on(solution.body, 8 if solution.body.dim == 2 else 4, family)
    v_norm = ErrorNorm(solution, space)
    time = 0.61 * solution.body.T
    sample = v_norm.sample(time)
    square = 0.0
    of_interpolant = space.strain(sample.interpolant)
    integrals = np.zeros_like(of_interpolant)
    nodal = np.zeros_like(space.mesh.p)
    for rule in rules(solution, space.mesh, v_norm.degree, aligned=True):
        fields = solution.at(rule.points)
        apart = fields.strain(time) - of_interpolant[:, rule.cells, None]
        square += np.sum(apart * fields.law.A(apart) * rule.weights)
        integrals[:, rule.cells] = (fields.stress(time) * rule.weights).sum(axis=-1)
    assert v_norm.distance(sample, sample.interpolant) ** 2 == pytest.approx(square, rel=1e-10)
    for face in solution.faces:
        points = FACET_POINTS if space.dim == 2 else SOLID_FACET_POINTS
        on = facet_rule(space.mesh, space.facets(face.part), face.part, face.rough, points)
        local = np.einsum("anq,nq->an", on.shapes, on.weights * solution.on(face, on.s).pressure(time))
        nodal += space.scatter(space.mesh.facets[:, on.facets], np.multiply.outer(face.part.normal, local))
    expected = space.functional(integrals / space.volumes) + space.interpolate(nodal)
    assert close(v_norm.load(time), expected, 1e-12)


@given(rng=RANDOM, degree=st.sampled_from([4, 6]), angle=st.floats(0.2, 2.9), both=st.booleans())
def test_a_rule_with_shared_coordinates_is_exact_inside_and_positive(rng, degree, angle, both):
    mesh = MeshTri(rng.normal(size=(2, 15)), np.arange(15).reshape(3, 5))
    lines = [Line((1.0, 0.0), 0.2), Line((float(np.cos(angle)), float(np.sin(angle))), -0.1)][: 1 + both]
    rule = simplex_rule(2, degree)
    points, shares = shared(placed(mesh.p, mesh.t, rule[0]), barycentric_gradients(mesh), *rule, lines)
    local = barycentric(mesh.p, mesh.t, points)
    assert local.min() > 0
    assert shares.min() > 0
    # The mean of λ_i λ_j is 1/12, and 1/6 for i = j; as Σ λ_i = 1, they tell the means of all polynomials of degree 2.
    assert np.allclose(local.sum(axis=0), 1, rtol=1e-12)
    means = np.einsum("icq,jcq,cq->cij", local, local, shares)
    assert np.allclose(means, (1 + np.eye(3)) / 12, rtol=1e-11)
    for line in lines:
        for one in line.distance(points):
            # Spacings are powers of two and at least this part of the width of the points of a cell.
            multiples = one / np.exp2(np.floor(np.log2(np.ptp(one))) - 20)
            assert np.allclose(multiples, np.rint(multiples), atol=1e-6)
