"""One call gives all fields of every case, and they belong together."""

from __future__ import annotations

import numpy as np
import pytest
from costly_cases import by_cost

from manufactured import Kind, evaluate, named
from manufactured.body import Body
from manufactured.catalogue import NAMES
from manufactured.tensors import Array, mandel, traction

TIME = 0.4


def inside(body: Body, count: int = 5) -> Array:
    """Random points of a body, (d, count)."""
    random = np.random.default_rng(5)
    low, high = body.vertices.min(axis=1), body.vertices.max(axis=1)
    points = low[:, None] + (high - low)[:, None] * random.random((body.dim, 200))
    return np.asarray(points[:, body.contains(points)][:, :count])


@pytest.mark.parametrize("name", by_cost(NAMES))
def test_the_gradient_has_the_strain_as_its_symmetric_part_and_all_else_is_what_the_fields_say(name: str) -> None:
    case = named(name)
    x, body = inside(case.solution.body), case.solution.body
    found, fields = evaluate(case, x, TIME), case.solution.at(x)
    size = abs(found.gradient).max()
    assert np.allclose(mandel(found.gradient), found.strain, rtol=0, atol=1e-11 * size)
    assert np.array_equal(found.displacement, fields.displacement(TIME))
    assert np.array_equal(found.velocity, fields.velocity(TIME))
    assert np.array_equal(found.strain_rate, fields.strain_rate(TIME))
    assert np.array_equal(found.stress, fields.stress(TIME))
    assert np.array_equal(found.body_force, fields.body_force(TIME))
    (*_, part) = body.of(Kind.LOADED)
    assert np.array_equal(found.surface_load(part), traction(found.stress, part.normal))


def test_the_gradient_is_the_difference_of_displacements() -> None:
    case, step = named("advance-recede"), 1e-6
    x = inside(case.solution.body)
    found = evaluate(case.solution, x, TIME).gradient
    for j in range(2):
        moved = [evaluate(case, x + sign * step * np.eye(2)[:, [j]], TIME).displacement for sign in (1, -1)]
        assert np.allclose(found[:, j], (moved[0] - moved[1]) / (2 * step), atol=1e-7)
