"""Vertices and points of quadrature of every mesh family count as points of the body, whatever rounding does."""

from __future__ import annotations

import numpy as np
import pytest

from manufactured import named
from manufactured.exact.domain import require_inside
from study.fem.quadrature import placed, simplex_rule
from study.statements.shared.scope import serving


@pytest.mark.parametrize("name", ["rotated", "hexagon", "re-entrant", "layered", "cube-two-faces"])
def test_points_of_meshes_lie_in_the_body(name: str) -> None:
    case = named(name)
    body = case.solution.body
    barycentric, _ = simplex_rule(body.dim, 4)
    for family in serving(case):
        mesh = family(body, 7)
        require_inside(body, mesh.p)
        require_inside(body, placed(mesh.p, mesh.t, barycentric))
        require_inside(body, np.mean(mesh.p[:, mesh.facets], axis=1))
