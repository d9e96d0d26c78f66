"""Other people's codes have our errors; one that has others, that was copied or left out is noticed."""

from functools import lru_cache

import numpy as np
import pytest
from costly_cases import slow
from measured_rows import measured
from numpy.testing import assert_allclose
from places import RESULTS
from skfem import ElementTriP1, FacetBasis

from manufactured.body import Kind
from manufactured.tensors import full
from study.fem.mesh import OneDiagonal, Unstructured
from study.fem.naming import resolve
from study.ledger.codes import FROZEN, MARCH, MESH_KEY, NOT_EXPRESSED
from study.ledger.verdict import FAILS, HOLDS, REPORTED, UNDECIDED
from study.run.judgement import joined
from study.statements.other_solvers import PEERS, THIS_STUDY, OtherCodes
from study.statements.shared.base import LISTED, grid
from study.statements.shared.tasks import Task

of_every_peer = pytest.mark.parametrize("peer", PEERS)
OTHERS = OtherCodes.joined_file


@lru_cache
def ours():
    """The errors of this study on a part of the meshes."""
    settings = grid(("advance-recede", "corner"), ("one-diagonal", "shaken"), (8, 16))
    return measured(OtherCodes(), settings)


@pytest.fixture
def others():
    """The committed errors of other codes."""
    return OTHERS.read(RESULTS)


def judged(others):
    tables = {LISTED: ours(), OTHERS: others}
    return {verdict.key: verdict for verdict in OtherCodes().judge(joined(OtherCodes(), tables))}


def verdicts(others):
    return {key: verdict.verdict for key, verdict in judged(others).items()}


def of(table, code, variant):
    return (table["code"] == code) & (table["variant"] == variant)


def one(table, peer, mode=FROZEN):
    """The place of an error of a code on one of the meshes."""
    on = (table["case"] == "advance-recede") & (table["level"] == 16) & (table["mode"] == mode)
    return int(np.flatnonzero(of(table, peer.code, peer.variant) & on)[0])


EVERY = {peer.key: HOLDS for peer in PEERS} | {"own-digits": HOLDS}


@pytest.mark.parametrize("name", ["full-contact", "hexagon"])
def test_resultants_of_a_task_are_what_vertices_carry_of_the_exact_pressure(name):
    """∫ p Σ_i φ_i over the vertices i of a piece of Γ3 that are not clamped; a front may cross a facet."""
    task = Task(resolve(name), Unstructured(), 8)
    time = 0.61 * task.solution.body.T
    mesh = task.space.mesh
    expected = []
    for face, (part, free) in zip(task.solution.faces, task.space.contact, strict=True):
        basis = FacetBasis(mesh, ElementTriP1(), facets=task.space.facets(part), intorder=40)
        carried = basis.zeros()
        carried[free] = 1.0
        s, _ = part.coordinates(np.asarray(basis.global_coordinates()))
        pressure = task.solution.on(face, s).pressure(time)
        expected.append(np.sum(pressure * basis.interpolate(carried) * basis.dx))
    assert task.resultants(time) == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize(
    ("name", "family", "level"),
    [
        ("corner", OneDiagonal(), 4),
        ("hexagon", Unstructured(), 4),
        slow("cube-two-faces", OneDiagonal(), 3),
    ],
)
def test_tractions_of_a_task_are_stresses_at_the_vertices_of_each_facet_times_the_normal(name, family, level):
    """On several faces with different normals."""
    task = Task(resolve(name), family, level)
    mesh = task.space.mesh
    time = 0.61 * task.solution.body.T
    at_vertices = task.solution.at(mesh.p)
    viscous = at_vertices.law.A(at_vertices.strain_rate(time))
    total = at_vertices.stress(time)
    for kind, stress in ((Kind.CONTACT, viscous), (Kind.LOADED, total)):
        for (part, facets), found in zip(task.space.on(kind), task.tractions(kind, time), strict=True):
            expected = np.einsum("ij...,j->i...", full(stress[:, mesh.facets[:, facets]]), part.normal)
            assert_allclose(found, expected.T, rtol=1e-9, atol=1e-9 * abs(stress).max())


def test_errors_of_other_codes_are_ours(others):
    assert verdicts(others) == EVERY


@pytest.mark.parametrize("mode", [FROZEN, MARCH])
@of_every_peer
def test_an_error_that_is_another_turns_the_row_of_its_code_to_fails(peer, mode, others):
    others.loc[one(others, peer, mode), "error"] *= 1 + 3 * peer.window.high
    assert verdicts(others) == EVERY | {peer.key: FAILS}


@of_every_peer
def test_a_column_that_was_copied_is_noticed(peer, others):
    """From this study to the code, on all meshes that both have."""
    place = [*MESH_KEY, "mode"]
    source = others[of(others, *THIS_STUDY)].set_index(place)["distance"]
    chosen = of(others, peer.code, peer.variant) & (others["class"] != NOT_EXPRESSED)
    others.loc[chosen, "distance"] = [source[names] for names in others.loc[chosen, place].itertuples(index=False)]
    assert judged(others)["own-digits"].observed == 1
    assert verdicts(others) == EVERY | {"own-digits": FAILS}


@of_every_peer
def test_a_mesh_or_a_code_that_is_left_out_without_a_reason_leaves_its_row_undecided(peer, others):
    without = judged(others.drop(index=one(others, peer)))[peer.key]
    assert without.verdict == UNDECIDED
    assert "1 problems lack an error" in without.expected
    gone = judged(others[~of(others, peer.code, peer.variant)])[peer.key]
    assert gone.verdict == UNDECIDED
    assert np.isnan(gone.observed)


def test_codes_that_nobody_ran_are_said_to_be_missing(tmp_path):
    tables = {LISTED: ours(), OTHERS: OTHERS.read(tmp_path)}
    for rows in (joined(OtherCodes(), tables), ours()):
        (only,) = OtherCodes().judge(rows)
        assert only.key == "none"
        assert only.verdict == REPORTED
        assert "make codes" in only.expected
