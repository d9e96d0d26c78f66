"""Cases with contact at many scales, and rollers: exact solutions, with details of the widths that they state."""

from dataclasses import replace

import numpy as np
import pytest

from manufactured import Case
from manufactured.body import Kind, polygon
from manufactured.catalogue import catalogue
from manufactured.exact import ExactSolution
from manufactured.multiscale import FadingFace, StripFace, multiscale, rollers
from manufactured.proved import proved_order
from manufactured.self_proof import examine


def alone(case: Case, j: int) -> ExactSolution:
    """One train on a body no deeper than its lifting: random points of the unit square would hardly ever meet it."""
    face = case.solution.faces[j]
    assert isinstance(face, StripFace)
    length, depth = face.part.measure, face.profile.depth
    corners = [(0.0, 0.0), (length, 0.0), (length, depth), (0.0, depth)]
    body = polygon(corners, [Kind.CONTACT, Kind.LOADED, Kind.CLAMPED, Kind.LOADED])
    return ExactSolution(body, case.solution.law, (replace(face, part=body.of(Kind.CONTACT)[0]),))


@pytest.mark.parametrize(
    ("number", "j"),
    [(0, 6), *(pytest.param(*one, marks=pytest.mark.slow) for one in ((0, 0), (1, 3), (1, 0), (0, 3), (1, 6)))],
)
def test_every_train_is_an_exact_solution(number: int, j: int) -> None:
    assert [finding for finding in examine(alone(multiscale()[number], j)) if not finding.passes] == []


def test_every_train_has_twice_the_patches_of_the_one_before() -> None:
    for case in multiscale():
        counts = []
        for face in case.solution.faces:
            s = np.linspace(0, face.part.measure, 20_001)[1:-1]
            touching = face.level_jet(s[None], 0.5)[(0,)] >= 0
            counts.append(int(np.sum(touching[1:] & ~touching[:-1])))
        growth = np.divide(counts[3:], counts[2:-1])
        assert growth == pytest.approx(2, rel=0.2)


def test_a_lifting_does_not_reach_above_the_next_piece() -> None:
    solution = multiscale()[0].solution
    face = solution.faces[0]
    x = np.array([np.linspace(0, 1, 201), np.full(201, 1e-3)])
    u = face.at(x).displacement(1.0)
    assert np.abs(u[:, x[0] > 1 / 8]).max() == 0
    assert np.abs(u[:, x[0] < 1 / 8]).max() > 0


def test_the_theorem_raises_the_proved_order_only_where_the_trace_is_rough() -> None:
    raised = {case.name for case in catalogue() if proved_order(case) > case.regularity.proved_order}
    assert raised == {"rough-trace"}
    assert all(proved_order(case) <= case.order for case in catalogue())


HISTORY = "(2.6)"
"""Of the self-proof: u = u_0 + ∫ u̇ dt by a rule with 256 steps, too few for what passes a point within a time ℓ."""


@pytest.mark.parametrize("level", [16, pytest.param(64, marks=pytest.mark.slow)])
@pytest.mark.parametrize("kind", [1, *(pytest.param(kind, marks=pytest.mark.slow) for kind in (0, 2, 3))])
def test_every_roller_is_an_exact_solution(kind: int, level: int) -> None:
    case = rollers(level)[kind]
    found = [finding for finding in examine(case.solution) if not finding.passes]
    assert [finding for finding in found if not finding.condition.startswith(HISTORY)] == []


@pytest.mark.slow
@pytest.mark.parametrize("kind", [0, 3])
def test_displacements_of_rollers_are_integrals_of_their_velocities(kind: int) -> None:
    solution = rollers(16)[kind].solution
    fields = solution.at(np.array([[0.2, 0.5, 0.55], [0.0, 0.03, 0.2]]))
    ends = np.linspace(0, solution.body.T, 3001)
    total = np.trapezoid([fields.velocity(time) for time in ends], ends, axis=0)
    change = fields.displacement(solution.body.T) - fields.displacement(0.0)
    assert total == pytest.approx(change, abs=1e-5 * abs(change).max())
    assert abs(change).max() > 1e-3


def test_a_roller_of_half_the_width_has_half_the_patch_and_leaves_the_same_strain_behind() -> None:
    wide, narrow = (rollers(level)[0].solution.faces[0] for level in (16, 32))
    s = np.linspace(0, 1, 40_001)[None]
    touching = [np.mean(face.level_jet(s, 0.35)[(0,)] >= 0) for face in (wide, narrow)]
    assert touching == pytest.approx([1 / 8, 1 / 16], abs=1e-3)
    assert isinstance(wide, FadingFace)
    assert isinstance(narrow, FadingFace)
    behind = np.array([[0.1, 0.2, 0.3]])
    left = [rollers(level)[0].solution.at(np.vstack([behind[0], 0 * behind[0]])).strain(0.35) for level in (16, 32)]
    assert left[0] == pytest.approx(left[1])
    assert left[0][1] == pytest.approx(-np.exp(behind[0] - 0.5))


def test_a_roller_fades_above_a_depth_that_grows_with_the_distance_from_it() -> None:
    solution = rollers(32)[0].solution
    under, behind = np.vstack([np.full(2, 0.47), [0.04, 0.05]]), np.vstack([np.full(2, 0.1), [0.27, 0.29]])
    for places in (under, behind):
        u = abs(solution.at(places).displacement(0.35)).max(axis=0)
        assert u[0] > 0
        assert u[1] == 0


def test_points_of_a_roller_that_share_a_place_along_the_face_have_the_fields_that_each_has_alone() -> None:
    solution = rollers(8)[0].solution
    grid = np.array(np.meshgrid(np.linspace(0, 1, 9), np.linspace(0, 0.6, 13), indexing="ij"))
    together = solution.at(grid)
    for i, x in enumerate(np.moveaxis(grid, 1, 0)):
        alone = solution.at(x)
        for name in ("displacement", "strain", "strain_rate", "strain_gradient"):
            here, own = getattr(together, name)(0.41), getattr(alone, name)(0.41)
            np.testing.assert_allclose(here[..., i, :], own, rtol=1e-13, atol=1e-13 * abs(here).max())
