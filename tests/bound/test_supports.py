"""Rollers, prescribed displacements and holes: exact solutions, another program, and what is refused."""

import math

import numpy as np
import pytest
from bodies import CLAMPED, CONTACT, ROLLER
from bodies import LOADED as FREE
from on_meshes import bounded_on

from benchmarks.trials.supports import row
from manufactured import BodyError, Data, KelvinVoigt, isotropic, plane_stress, polygon, static, t
from manufactured.factor import Factor, x1, x2
from manufactured.symbols import FormulaError
from study.bound.discretisation import refuse_unserved
from study.bound.fields import read
from study.bound.given import bound_displacement
from study.bound.problem import BoundError
from study.certify.statement import statement
from study.fem.mesh import Shaken, Unstructured, cell_volumes

OUTLINE = [(0, 0), (2, 0), (2, 1), (0, 1)]
HOLE = [(0.7, 0.3), (0.8, 0.7), (1.2, 0.6), (1.1, 0.3)]
G = plane_stress(E=2.0, nu=0.25)
LAW = KelvinVoigt(G, G, "G")


def pierced(hole, outline=OUTLINE):
    """A body with a hole that is clamped at the bottom."""
    return polygon(outline, [CLAMPED, FREE, FREE, FREE], holes=[(hole, [FREE] * 4)])


@pytest.mark.parametrize("how", ["prescribed", "loaded", "in time"])
def test_a_uniform_stress_around_a_hole_is_exact_up_to_rounding(how):
    """σ_11 = 0.02 and no other stress: u = (0.01 x1, −0.0025 x2); the hole is loaded by σν.

    In time u is t times this displacement, and the viscosity is G, so that σ_11 = 0.02 (1 + t).
    """
    right = ROLLER if how == "prescribed" else FREE
    body = polygon(OUTLINE, [ROLLER, right, FREE, ROLLER], holes=[(HOLE, [FREE] * 4)])
    tension = 0.02 * (1 + t) if how == "in time" else 0.02
    tractions = {i: (tension * part.normal[0], 0) for i, part in enumerate(body.parts) if part.kind is FREE}
    if how == "in time":
        data = Data.formulas(body, LAW, (0, 0), tractions)
    else:
        data = static(body, G, f2=tractions, u={1: (0.02, 7)} if how == "prescribed" else None)
    found = bounded_on(data, 5, Unstructured())
    energy = math.sqrt(0.02 * 0.01 * body.measure)
    assert found.enclosure.evidence.kind == "guaranteed"
    assert found.error[1] <= 1e-9 * energy
    assert found.norm == pytest.approx((energy, energy), rel=1e-9)


def test_a_bar_of_varying_stiffness_has_hand_values_on_every_cell_of_an_irregular_mesh():
    """E = 1/(1 + x1) and σ_11 = 1: u = (x1 + x1²/2, 0), and ‖u‖² is |T| (1 + x1) at the middle of a triangle T."""
    bar = isotropic(0.5, 0, factor=Factor(1 / (1 + x1), 1 / 3, 1.0))
    pulled, loaded = (polygon(OUTLINE, [ROLLER, right, FREE, ROLLER]) for right in (ROLLER, FREE))
    mesh = Shaken()(loaded, 4)
    middles = mesh.p[0, mesh.t].mean(axis=0)
    data = static(loaded, bar, f2={1: (1, 0)})
    found = bound_displacement(data, mesh.p.T, mesh.t.T, None, 0 * mesh.p.T)
    assert found.enclosure.on_cells == pytest.approx(cell_volumes(mesh) * (1 + middles), rel=1e-9)
    assert found.error == pytest.approx((2, 2), rel=1e-9)
    found = bounded_on(static(pulled, bar, u={1: (4, 0)}), 4, Shaken())
    assert found.norm == pytest.approx((2, 2), rel=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_another_program_computes_an_error_and_a_norm_inside_the_intervals(seed):
    assert row(seed)["inside"]


@pytest.mark.parametrize("size", [1e-20, 1e10])
def test_bodies_with_holes_have_any_size(size):
    outline, hole = (size * np.array(corners) for corners in (OUTLINE, HOLE))
    assert [len(loop) for loop in pierced(hole, outline).loops] == [4, 4]


UNFIT = [
    *(
        (lambda kinds=kinds: polygon(OUTLINE, kinds), "no side of the body is CLAMPED")
        for kinds in ([FREE, FREE, FREE, ROLLER], [FREE, ROLLER, FREE, ROLLER], [ROLLER, FREE, FREE, FREE])
    ),
    *(
        (lambda shift=shift: pierced(np.array(HOLE) + shift), "does not lie inside the outline")
        for shift in ((0.8, 0), (0, 0.5), (3, 0))
    ),
    (lambda: pierced(HOLE[::-1]), "is listed counter-clockwise"),
    (
        lambda: polygon([(0, 0), (2, 0), (1.8, 1), (0, 1)], [CLAMPED, ROLLER, FREE, FREE]),
        r"the ROLLER side from \[2.0, 0.0\] .* not parallel to an axis",
    ),
]


@pytest.mark.parametrize(("make", "message"), UNFIT)
def test_rollers_that_do_not_hold_a_body_or_are_slanted_and_holes_that_are_none_are_refused(make, message):
    with pytest.raises(BodyError, match=message):
        make()


def test_certificates_refuse_what_the_checker_does_not_know():
    for body in (polygon(OUTLINE, [CONTACT, ROLLER, FREE, CLAMPED]), pierced(HOLE)):
        with pytest.raises(BoundError, match="neither ROLLER sides nor holes"):
            statement(Data.formulas(body, LAW, (0, 0)))
    moved = static(polygon(OUTLINE, [CLAMPED, FREE, FREE, FREE]), G, u={0: (1, 0)})
    with pytest.raises(BoundError, match="only `static` problems"):
        refuse_unserved(Data.formulas(moved.body, LAW, (0, 0)))


def test_one_of_several_load_steps_is_read(tmp_path):
    u = np.arange(12.0).reshape(2, 3, 2)
    np.savez(tmp_path / "u.npz", points=np.zeros((3, 2)), triangles=[[0, 1, 2]], times=[1, 2], u=u)
    assert (read(tmp_path / "u.npz", step=-1).u == u[1]).all()
    with pytest.raises(BoundError, match="has 2 load steps: --step is 0 to 1, or -1 for the last, got 2"):
        read(tmp_path / "u.npz", step=2)


@pytest.mark.parametrize("noise", [0, 1e-8])
def test_prescribed_displacements_in_files_may_be_rounded(noise):
    """A body that moves far and is stretched little: the rounding of u_h must not be taken for its error."""
    body = polygon(OUTLINE, [FREE, CLAMPED, FREE, CLAMPED])
    data = static(body, G, u={1: (100.01, 0), 3: (100, 0)})
    mesh = Unstructured()(body, 4)
    u = np.array([100 + 0.005 * mesh.p[0], 0 * mesh.p[0]]).T
    u[mesh.p[0] == 0] += 100 * noise
    found = bound_displacement(data, mesh.p.T, mesh.t.T, None, u, refine=0)
    assert found.computed.offset == pytest.approx(0, abs=1e-4)
    assert (found.computed.offset > 1e-6) == (noise > 0)


@pytest.mark.parametrize(
    ("u", "message"),
    [
        ({0: (x1**2, 0)}, r"u on part 0 is x1\*\*2, and only linear"),
        ({1: (0, 0)}, r"the CLAMPED and ROLLER parts of the plane are \[0, 3\]"),
        ({0: (0.1, 0)}, r"differ by 0.1 at their common corner \[0.0, 0.0\]"),
        ({3: (0, x2)}, r"differ by 1 at their common corner \[0.0, 1.0\]"),
    ],
)
def test_displacements_that_cannot_be_prescribed_are_refused(u, message):
    body = polygon(OUTLINE, [CLAMPED, FREE, CONTACT, CLAMPED])
    with pytest.raises(FormulaError, match=message):
        static(body, G, u=u)
