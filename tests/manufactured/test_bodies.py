"""General bodies: turned axes, other sides, several contact faces, one long side, an end time other than 1."""

from dataclasses import replace
from typing import Any

import pytest
from changed import turned

from manufactured import Body, BodyError, Kind, examine, named, polygon, unit_square
from study.fem.mesh import OneDiagonal
from study.solve.tableau import MIDPOINT
from study.statements.prop_5_4 import measure
from study.statements.shared.base import Experiment

SIDES = [Kind.CONTACT, Kind.LOADED, Kind.CLAMPED, Kind.LOADED]


@pytest.mark.parametrize("angle", [0.3, pytest.param(2.5, marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    ("name", "rounding"), [("advance-recede", 1e-10), ("yield-on-a-part", 1e-9), ("rough-1.75", 1e-6)]
)
def test_a_turned_body_has_the_errors_of_the_unturned_one(name: str, rounding: float, angle: float) -> None:
    """To round-off, which a singular strain magnifies near its front."""
    solution = named(name).solution
    other = turned(solution, angle)
    assert all(finding.passes for finding in examine(other))
    one, same = (measure(Experiment.of(item, OneDiagonal(), 8, MIDPOINT, 8)).row() for item in (solution, other))
    for quantity in ("error", "interpolation_error", "discrete_error"):
        assert same[quantity] == pytest.approx(one[quantity], rel=rounding), quantity


def square(**options: Any) -> Body:
    return polygon([(0, 0), (1, 0), (1, 1), (0, 1)], SIDES, **options)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: square(refine=[(0.5, 0.5)]), "not one of the vertices"),
        (lambda: square(interfaces=[((0, 0.5), (0.8, 0.5))]), "expected a point of the boundary"),
        (lambda: square(interfaces=[((0, 0.5), (0, 1))]), "touches its boundary"),
        (lambda: square(interfaces=[((0, 0.5), (1, 0.5)), ((0.5, 0), (0.5, 1))]), "cross"),
        (lambda: square(T=0), "final time"),
        (lambda: Body(unit_square().parts[:2]), "three boundary parts"),
        (lambda: Body(unit_square().parts[::-1]), "but the next starts at"),
        (lambda: polygon([(0, 0), (1, 0), (1, 0), (0, 1)], SIDES), "list every vertex once"),
        (lambda: polygon([(0, 0), (0, 1), (1, 1), (1, 0)], SIDES), "counter-clockwise"),
        (lambda: polygon([(0, 0), (1, 0), (0, 1)], SIDES), "need 3 kinds, got 4"),
        (
            lambda: polygon([(0, 0), (1, 0), (1, 1), (0, 1)], [Kind.CONTACT, *3 * [Kind.LOADED]]),
            "no side .* is CLAMPED",
        ),
        (lambda: Body((replace(unit_square().parts[0], kind=Kind.INTERFACE), *unit_square().parts[1:])), "lies inside"),
        (lambda: Body(unit_square().parts, interfaces=(unit_square().parts[0],)), "has the kind"),
    ],
)
def test_a_body_that_is_none_or_that_no_mesh_could_serve_is_refused(make, message: str) -> None:
    with pytest.raises(BodyError, match=message):
        make()
