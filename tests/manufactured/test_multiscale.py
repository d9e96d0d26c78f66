"""Cases with contact at many scales: exact solutions, with details of the widths that they state."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from manufactured import Case
from manufactured.body import Kind, polygon
from manufactured.catalogue import catalogue
from manufactured.exact import ExactSolution
from manufactured.multiscale import StripFace, multiscale
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


@pytest.mark.parametrize("j", [0, 3, 6])
@pytest.mark.parametrize("case", multiscale(), ids=lambda case: case.name)
def test_every_train_is_an_exact_solution(case: Case, j: int) -> None:
    assert [finding for finding in examine(alone(case, j)) if not finding.passes] == []


@pytest.mark.parametrize("case", multiscale(), ids=lambda case: case.name)
def test_every_train_has_twice_the_patches_of_the_one_before(case: Case) -> None:
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
