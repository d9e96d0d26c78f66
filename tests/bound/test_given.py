"""Displacements of another program: enclosed whatever they are, and refused by name where they do not fit."""

import re
import sys

import h5py
import meshio
import numpy as np
import pandas as pd
import pytest
from bodies import CLAMPED, CONTACT, LAW, LOADED, SIDES
from numpy.testing import assert_allclose
from on_meshes import discretised_on
from skfem import MeshTri

from manufactured import (
    Data,
    isotropic,
    named,
    plane_strain,
    plane_stress,
    polygon,
    static,
    t,
    unit_square,
    x2,
)
from study.bound.bounded import contact_sentences
from study.bound.enclosing import compute_static
from study.bound.fields import read
from study.bound.given import SINGLE, _check_cells, _on_boundary, bound_displacement, given
from study.bound.problem import BoundError
from study.bound.trajectory import compute, on_refinement
from study.fem.mesh import MeshError, OneDiagonal, Shaken, Unstructured
from study.fem.naming import resolve_data
from study.fem.space import Space, form, nodes_of
from study.ledger.files import write_text
from study.solve.tableau import MIDPOINT

of_both_degrees = pytest.mark.parametrize("degree", [1, 2])


def of_degree_2(points, triangles):
    """Return points and triangles with the midpoints of 01, 12 and 20; neighbours repeat the one that they share.

    The corners are not in the order of their numbers, as in files of most programs.
    """
    triangles = np.roll(triangles, 1, axis=1)
    middles = (points[triangles] + points[np.roll(triangles, -1, axis=1)]) / 2
    numbers = len(points) + np.arange(triangles.size).reshape(-1, 3)
    return np.vstack([points, middles.reshape(-1, 2)]), np.hstack([triangles, numbers])


CHANGES = {
    "the interpolant": lambda u, into: u,
    "too small": lambda u, into: 0.9 * u,
    "pushed into the foundation": lambda u, into: u + 0.3 * abs(u).max() * into,
    "of another problem": lambda u, into: -u[..., ::-1],
}


@of_both_degrees
@pytest.mark.parametrize("change", CHANGES)
def test_the_known_error_of_any_displacement_on_an_irregular_mesh_with_unequal_steps_is_enclosed(change, degree):
    case = named("rotated")
    times = np.array([0.0, 1, 3, 4.5, 6]) / 6
    mesh = Unstructured()(case.solution.body, 3)
    points, triangles = mesh.p.T, np.roll(mesh.t.T, 1, axis=1)  # corners in another order than the one of MeshTri
    if degree == 2:
        points, triangles = of_degree_2(points, triangles)
    fields = case.solution.at(points.T)
    (foundation,) = case.solution.body.of(CONTACT)
    u = np.array([fields.displacement(time).T for time in times])
    moves = (abs(u).max(axis=(0, 2)) > 1e-12)[:, None]
    field = CHANGES[change](u, moves * foundation.normal)
    found = bound_displacement(Data.of(case.solution), points, triangles, times, field, shorter=2, steps=4, case=case)
    one = found.enclosure
    assert one.contains
    assert one.lowest <= one.error.max() <= one.highest
    assert (one.error <= one.bound_at(one.times)).all()
    assert one.error.max() > 0.01
    assert not found.plain or one.error.max() <= found.plain.highest


def test_contact_sides_that_do_not_lie_on_one_line_are_called_a_curved_foundation():
    (sentence,) = contact_sentences(polygon([(0, 0), (1, -0.01), (2, 0), (1, 1)], [CONTACT, CONTACT, LOADED, CLAMPED]))
    assert re.search("^The 2 CONTACT sides do not lie on one line.*a curved one", sentence)
    in_one_line = polygon([(0, 0), (1, 0), (2, 0), (1, 1)], [CONTACT, CONTACT, LOADED, CLAMPED])
    assert contact_sentences(in_one_line) == []


PROBLEM = Data.formulas(unit_square(), LAW, (0, -t), {1: (t * x2, 0)})


def field():
    """Return a mesh of the unit square with a displacement that vanishes on its top."""
    mesh = Shaken()(unit_square(), 2)
    times = np.array([0.0, 0.5, 1.0])
    u = times[:, None, None] * (1 - mesh.p.T[None, :, 1:]) * np.array([0.1, 0.2])
    return {"points": mesh.p.T, "triangles": mesh.t.T, "times": times, "u": u}


def test_a_peak_between_nearly_equal_times_is_a_part_of_the_error():
    arrays = field()
    arrays["u"] = np.array([0, 0, 9, 0, 0])[:, None, None] * arrays["u"][-1]
    arrays["times"] = np.array([0.0, 0.3, 0.3 + 1e-11, 0.3 + 2e-11, 1.0])
    assert bound_displacement(PROBLEM, **arrays, refine=0, shorter=1).error[1] > 1


@of_both_degrees
@pytest.mark.parametrize("refinements", [0, 1, 2])
def test_polynomials_of_the_degree_of_u_h_are_the_same_on_a_refinement_and_other_meshes_are_refused(
    degree, refinements
):
    mesh = Unstructured()(named("hexagon").solution.body, 3)
    fine = mesh.refined(refinements)

    def values(x):
        return np.array([(1 + x[0] - 3 * x[1]) ** degree, (2 + x[0] + x[1]) ** degree])

    nodes = mesh.p if degree == 1 else nodes_of(mesh)
    found = (on_refinement(mesh, degree, fine) @ values(nodes).T.ravel()).reshape(-1, 2).T
    at_vertices, on_edges = np.split(found, [fine.p.shape[1]], axis=1)
    at_middles = on_edges / 2 + at_vertices[:, fine.facets].sum(axis=1) / 4
    assert_allclose(np.hstack([at_vertices, at_middles]), values(nodes_of(fine)), atol=1e-11)
    with pytest.raises(BoundError, match="no refinement"):
        on_refinement(Shaken()(unit_square(), 3), degree, OneDiagonal()(unit_square(), 3).refined(refinements))


def test_arrays_of_other_shapes_mean_the_same():
    plain = given(PROBLEM, **field())
    arrays = field()
    points = arrays["points"]
    u = arrays["u"]
    corners = arrays["triangles"].ravel()
    solid = {"points": np.pad(points, ((0, 0), (0, 1)), constant_values=1.0), "u": np.pad(u, ((0, 0), (0, 0), (0, 1)))}
    # Every triangle with points of its own, and a point that belongs to no triangle.
    torn = {"points": np.vstack([points[corners], [[7.0, 7.0]]]), "u": u[:, [*corners, 0]] * 1.0}
    torn["triangles"] = np.arange(len(corners)).reshape(-1, 3)
    single = {"points": points.astype(np.float32), "u": u.astype(np.float32)}
    for changed in (solid, torn, single):
        found = given(PROBLEM, **(arrays | changed))
        assert found.mesh.t.shape == plain.mesh.t.shape
        order = [np.lexsort(np.round(each.mesh.p, 5)) for each in (found, plain)]
        values = [each.at(0.7).reshape(-1, 2)[at] for each, at in zip((found, plain), order, strict=True)]
        assert np.allclose(*values, atol=1e-6)


def with_value(array, place, value):
    changed = array.copy()
    changed[place] = value
    return changed


FAULTS = [
    ("points", lambda p: p * [1.0, 2.0], r"\(0, 0\) to \(1, 2\).* the mesh of another body"),
    ("points", lambda p: p / 1000, "mesh is smaller than the body by the factor 1000: give both"),
    ("points", lambda p: p + [0.0, -0.5], r"is shifted by \(0, -0.5\): give both"),
    ("points", lambda p: with_value(p, 1, [0.5, 0.2]), r"does not cover the body: . sides .* near x = \(0.25, 0.1\)"),
    ("u", lambda u: with_value(u, (1, 3, 0), np.nan), r"1 numbers .* not finite, the first at t = 0.5, x = \("),
    ("triangles", lambda c: np.vstack([c, c[:1]]), "overlap or are listed twice|share a side n"),
    ("triangles", lambda c: np.vstack([c, c[:1][:, [0, 0, 1]]]), r"1 triangles have no area, .* near x = \("),
    (
        "u",
        lambda u: u + 0.01,
        r"u_h is 0.01 in the direction x1 at x = \(0, 1\) on side 2 \(CLAMPED\), and has to be 0 there.* --nearest",
    ),
    ("times", lambda at: at + 0.5, "initial time is missing: the first time is 0.5"),
    ("times", lambda at: at / 2, "the last time is 0.5, the problem ends at T = 1"),
    ("times", lambda at: at[:0], r"times has the shape \(0,\) .* expected real numbers, at least one"),
    ("u", lambda u: u.astype(str), "u has the shape .* and the type <U.*, expected real numbers"),
    ("triangles", lambda c: np.ma.masked_equal(c, 0), "triangles has masked entries"),
    ("points", lambda p: [[0, 0], [1]], "rows of different lengths"),
    ("points", lambda p: 1e200 * p, "larger than the body by the factor 1e"),
    ("times", lambda at: at[::-1], "increase strictly, got 0.5 after 1; the parts of a parallel run"),
    ("times", lambda at: np.column_stack([at, -at]), "strictly, got an array of the shape"),
    ("u", lambda u: u[:, 1:], r"u has the shape .* expected \(3, 9, 2\)"),
    ("triangles", lambda c: c[:, [0, 1, 2, 2]], "expected integers"),
    ("triangles", lambda c: c + 1, "numbers start at 0"),
    ("points", lambda p: np.column_stack([p, p[:, 0]]), "the third component of points is not constant"),
]
"""An array of ``field``, its change, and why it is refused."""


@pytest.mark.parametrize(("array", "change", "message"), FAULTS)
def test_what_does_not_fit_is_refused_by_name(array, change, message):
    with pytest.raises(BoundError, match=message):
        given(PROBLEM, **(field() | {array: change(field()[array])}))


@pytest.mark.parametrize("aspect", [5e3, 1e7])
def test_triangles_too_thin_for_double_precision_are_refused_with_their_place(aspect):
    data = static(unit_square(), isotropic(1, 1), (0, -1))
    mesh = MeshTri.init_tensor(np.array([0, 0.5, 0.5 + 0.5 / aspect, 1]), np.linspace(0, 1, 3))
    with pytest.raises(MeshError, match=r"x = \(0.5, .* times as long as high"):
        bound_displacement(data, mesh.p.T, mesh.t.T, None, 0 * mesh.p.T)


@pytest.mark.parametrize("size", [0.01, 1, 100])
def test_vertices_are_moved_to_a_side_from_a_distance_relative_to_the_size_of_the_body(size):
    body = polygon([(0, 0), (size, 0), (size, size), (0, size)], SIDES)
    p = size * np.array([[0.4, 0.6], [0.5 * SINGLE, 2 * SINGLE]])
    assert np.abs(_on_boundary(body, p)[1] / (size * SINGLE)).tolist() == pytest.approx([0, 2], abs=1e-6)


def test_a_small_cell_far_from_another_one_has_an_area():
    corner = np.array([[0, 1, 0], [0, 0, 1]])
    _check_cells(MeshTri(np.hstack([1e-7 * corner, 1 + 1e-7 * corner]), np.arange(6).reshape(2, 3).T))


def test_curved_triangles_and_a_single_time_are_refused():
    arrays = field()
    points, triangles = of_degree_2(arrays["points"], arrays["triangles"])
    points[-1] += 0.01
    curved = {"points": points, "triangles": triangles, "u": np.zeros((3, len(points), 2))}
    for changed, message in ((curved, "curved tri"), ({"times": np.zeros(1), "u": arrays["u"][:1]}, "one time only")):
        with pytest.raises(BoundError, match=message):
            given(PROBLEM, **(arrays | changed))


def test_a_static_problem_takes_one_time_only():
    problem = static(unit_square(), plane_stress(2.0, 0.3), (0, -1))
    with pytest.raises(BoundError, match="static, and u_h has 3 times"):
        given(problem, **field())
    assert given(problem, **(field() | {"times": None, "u": field()["u"][-1]})).T == 1


def test_values_on_the_clamped_part_are_replaced_and_the_change_is_added_to_the_error():
    """The change is 0.01 t x on the top, (x, x) at its nodes, and the largest at t = 1."""
    bent = field()
    bent["u"] = bent["u"] + 0.01 * bent["points"][:, :1] * bent["times"][:, None, None]
    bounded = bound_displacement(PROBLEM, **bent, nearest=True, refine=0, shorter=1, steps=2)
    change = bent["u"][-1] - bounded.computed.nodes[-1].reshape(-1, 2)
    assert change == pytest.approx(0.01 * bent["points"][:, :1] * (bent["points"][:, 1:] == [1, 1]))
    held_below = Space(bounded.computed.mesh, polygon(CORNERS, [CLAMPED, *3 * [LOADED]]))
    v = change.ravel()[held_below.free]
    offset = bounded.computed.offset
    assert offset == pytest.approx(np.sqrt(v @ form(held_below, LAW.A) @ v), rel=1e-9)
    assert any("u_h is changed by up to 0.01 on side 2 (CLAMPED)" in remark for remark in bounded.remarks)
    ends = re.search(r"lies in \[(.*), (.*)\]$", bounded.remarks[-1]).groups()
    low = bounded.enclosure.lowest - offset
    high = bounded.enclosure.highest + offset
    assert [float(end) for end in ends] == pytest.approx([max(0.0, low), high], rel=1e-3)


PLANE = {"stress": plane_stress(2.0, 0.3), "strain": plane_strain(2.0, 0.3)}


@pytest.mark.parametrize(
    ("here", "there", "factor", "question"),
    [
        ("stress", "stress", "another shape", ""),
        ("stress", "stress", 1.0, ""),
        ("stress", "stress", 1e3, "is 1000 times .*: metres and millimetres[?]"),
        ("stress", "stress", 1e-6, "is 1e-06 times .*: pascals and megapascals[?]"),
        ("stress", "stress", -1.0, "is -1 times .*: loads in the opposite direction[?]"),
        ("stress", "stress", -1.05, "is -1.05 times .*: loads in the opposite direction[?]"),
        ("stress", "stress", 1.5, "is 1.5 times .*: compare loads, stiffness and units"),
        ("strain", "stress", 1.0, "is 1.0.* times .*: plane stress there, and plane strain here[?]"),
        ("stress", "strain", 1.0, "is 0.9.* times .*: plane strain there, and plane stress here[?]"),
    ],
)
@pytest.mark.parametrize("level", [2, 6])
def test_the_usual_mistakes_are_named_by_the_factor_of_the_displacement_on_coarse_and_fine_meshes(
    level, here, there, factor, question
):
    """The displacement solves the problem with the law ``there``, and is bounded for the one with the law ``here``."""
    given_problem, problem = (static(unit_square(), PLANE[law], (0, -1), {1: (1, 0)}) for law in (there, here))
    coarse = discretised_on(given_problem, level, Shaken())
    solution = compute_static(coarse)
    u = solution.at_vertices[0].T
    u = u[:, ::-1] * [1, -1] if factor == "another shape" else factor * u
    found = bound_displacement(problem, coarse.mesh.p.T, coarse.mesh.t.T, None, u)
    told = [remark for remark in found.remarks if "times the one of this problem" in remark]
    assert len(told) == bool(question)
    assert all(re.search(question, remark) for remark in told)


@pytest.mark.parametrize(("factor", "named"), [(1.05, False), (1000.0, True)])
def test_in_time_a_factor_of_some_per_cent_may_come_from_long_steps_and_a_large_one_is_named(factor, named):
    coarse = discretised_on(PROBLEM, 3, Shaken())
    solution = compute(coarse, MIDPOINT, 2)
    u = factor * solution.at_vertices.swapaxes(1, 2)
    arrays = {"points": coarse.mesh.p.T, "triangles": coarse.mesh.t.T, "times": solution.times, "u": u}
    found = bound_displacement(PROBLEM, **arrays, refine=0, shorter=1)
    said = [remark for remark in found.remarks if "times the one" in remark]
    assert ["metres and millimetres?" in remark for remark in said] == [True] * named


@pytest.mark.parametrize("wrong", [{"refine": -1}, {"shorter": 0}, {"steps": 1.5}, {"refine": 0.5}, {"nearest": "no"}])
def test_arguments_that_make_no_sense_are_refused_by_name(wrong):
    with pytest.raises(BoundError, match=r"(refine|shorter|steps|nearest).* has to be"):
        bound_displacement(PROBLEM, **field(), **wrong)


PULLED = """
from manufactured import Kind, plane_stress, polygon, static

CLAMPED, FREE, ROLLER = Kind.CLAMPED, Kind.LOADED, Kind.ROLLER
body = polygon([(0, 0), (1, 0), (1, 1), (0, 1)], [ROLLER, FREE, FREE, ROLLER])
plate = static(body, plane_stress(E=2.0, nu=0.25), f2={1: (2, 0)})
"""
"""The solution is (x, −y/4), and the energy of its stress σ_11 = 2 is 2."""


@pytest.fixture
def pulled(tmp_path):
    return write_text(tmp_path / "pulled.py", PULLED)


@pytest.mark.parametrize(("factor", "advised"), [(1.0, True), (0.9, False)])
def test_a_lower_end_of_zero_for_degree_2_says_which_refinement_to_take(factor, advised, pulled):
    points, triangles = of_degree_2(CORNERS, np.array(HALVES))
    _, data, _ = resolve_data(f"{pulled}:plate")
    found = bound_displacement(data, points, triangles, None, factor * points * [1, -1 / 4], refine=0)
    assert any("try --refine 1" in remark for remark in found.remarks) == advised


def test_penetration_is_reported_with_its_place():
    arrays = field()
    arrays["u"] = arrays["u"] * [1, -1]
    (remark,) = given(PROBLEM, **arrays).remarks
    assert remark.startswith("u_h penetrates the foundation at its nodes by up to 0.2, 100 % of its largest comp")
    assert "at t = 1" in remark


# Files.


def write(path, points, triangles, times, u, form="XML"):
    """Write a displacement, with its velocity and lines as other programs add them."""
    cells = [({3: "triangle", 6: "triangle6"}[triangles.shape[1]], triangles), ("line", triangles[:1, :2])]
    solid, vectors = (np.insert(array, 2, 0.0, axis=-1) for array in (points, u))
    if path.suffix == ".npz":
        np.savez(path, points=points, triangles=triangles, times=times, u=u)
    elif path.suffix == ".pvd":
        lines = ""
        for number, (time, at_time) in enumerate(zip(times, vectors, strict=True)):
            file = f"{path.stem}-{number}.vtu"
            meshio.Mesh(solid, cells, {"displacement": at_time, "velocity": at_time}).write(path.with_name(file))
            lines += f'<DataSet timestep="{time}" file="{file}"/>'
        path.write_text(f"<VTKFile type='Collection'><Collection>{lines}</Collection></VTKFile>")
    else:
        with meshio.xdmf.TimeSeriesWriter(path, data_format=form) as writer:
            writer.write_points_cells(solid, cells[:1])
            for time, at_time in zip(times, vectors, strict=True):
                writer.write_data(time, point_data={"displacement": at_time})
    return path


@pytest.mark.parametrize(("suffix", "form"), [(".npz", ""), (".pvd", ""), (".xdmf", "XML"), (".xdmf", "HDF")])
@of_both_degrees
def test_files_of_other_programs_are_read(suffix, form, degree, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # meshio writes the file .h5 of an .xdmf file into the working directory.
    arrays = field()
    if degree == 2:
        arrays["points"], arrays["triangles"] = of_degree_2(arrays["points"], arrays["triangles"])
        arrays["u"] = arrays["times"][:, None, None] * (1 - arrays["points"][None, :, 1:] ** 2) * np.array([0.1, 0.2])
    expected = given(PROBLEM, **arrays)
    found = given(PROBLEM, **vars(read(write(tmp_path / f"mine{suffix}", **arrays, form=form))))
    assert np.allclose(found.times, expected.times)
    assert np.allclose(found.nodes, expected.nodes)
    assert found.degree == degree


MESH = """
<Geometry GeometryType="XY"><DataItem DataType="Float" Dimensions="3 2" Format="XML">0 0 1 0 0 1</DataItem></Geometry>
<Topology TopologyType="Triangle"><DataItem DataType="Int" Dimensions="1 3" Format="XML">0 1 2</DataItem></Topology>
"""
FIELD = """
<Attribute Name="u" Center="Node">
<DataItem DataType="Float" Dimensions="3 2" Format="XML">0 0 0 0 0 0</DataItem>
</Attribute>
"""


def series(mesh, field=FIELD):
    """A file in the form XDMF, with another mesh or another field at the second of two times."""
    return f"""
<Xdmf Version="3.0"><Domain><Grid GridType="Collection" CollectionType="Temporal">
<Grid GridType="Uniform"><Time Value="0"/>{MESH}{FIELD}</Grid>
<Grid GridType="Uniform"><Time Value="1"/>{mesh}{field}</Grid>
</Grid></Domain></Xdmf>
"""


@pytest.fixture(scope="module")
def unusable(tmp_path_factory):
    """A directory with files in which no displacement can be read."""
    directory = tmp_path_factory.mktemp("unusable")
    write(directory / "mine.pvd", **field())
    for noise in ("noise.vtu", "noise.npz", "noise.frd"):
        (directory / noise).write_text("noise")
    step = "<V><DataSet {}/></V>"
    texts = {
        "lost.pvd": step.format('timestep="0" file="lost.vtu"'),
        "untimed.pvd": step.format('file="mine-0.vtu"'),
        "bomb.pvd": step.format('timestep="0" file="bomb.xdmf"'),
        **dict.fromkeys(("bomb.xdmf", "bomb.xmf"), '<Xdmf><DataItem Format="HDF">bomb.h5:/u</DataItem></Xdmf>'),
        "moved.xdmf": series(MESH.replace("0 0 1 0 0 1", "0 0 1 0 0 2")),
        "turned.xdmf": series(MESH.replace("0 1 2", "1 2 0")),
        "other.xdmf": series(MESH, FIELD.replace('"u"', '"w"')),
        "strange.xdmf": series("<Geometry/>"),
    }
    for name, text in texts.items():
        (directory / name).write_text(text)
    np.savez_compressed(directory / "bomb.npz", **(field() | {"u": np.zeros(100_000_000, dtype=np.int8)}))
    zeros = meshio.Mesh(np.zeros((10_000_000, 3)), [("triangle", np.array([[0, 1, 2]]))])
    zeros.write(directory / "bomb.vtu", compression="zlib")
    for bomb in ("bomb.h5", "bomb.med"):
        with h5py.File(directory / bomb, "w") as file:
            file.create_dataset("u", (10_000_000, 2), float, chunks=True, compression="gzip")
    np.savez(directory / "short.npz", points=field()["points"])
    packed = bytearray((directory / "short.npz").read_bytes())
    # The flag of encryption in the header of the entry and in the table of all entries.
    packed[6] = packed[packed.rindex(b"PK\x01\x02") + 8] = 1
    (directory / "locked.npz").write_bytes(packed)
    np.savez_compressed(directory / "broken.npz", **field())
    broken = bytearray((directory / "broken.npz").read_bytes())
    broken[120:160] = bytes(40)
    (directory / "broken.npz").write_bytes(broken)
    return directory


@pytest.mark.parametrize(
    ("name", "message"),
    {
        "missing.npz": "there is no file",
        "noise.vtu": "noise.vtu is broken, incomplete or no .*: write it again",
        "noise.npz": "noise.npz is no .npz file: write it by numpy.savez, with the arrays points, triangles",
        "noise.frd": "a format that cannot be read: expected .npz, .*; docs/tutorials/bound.md converts .frd",
        "lost.pvd": "there is no file .*lost.vtu",
        "untimed.pvd": "DataSet without timestep or file",
        "short.npz": "lacks triangles, u; expected the arrays points, triangles, times, u",
        "bomb.npz": "bomb.npz has .* bytes and unpacks to 100000776 bytes, .* write it without compression",
        "bomb.vtu": "bomb.vtu has .* bytes and unpacks to 80.* bytes, more than 100 times as many",
        **dict.fromkeys(("bomb.pvd", "bomb.xmf"), "bomb.h5 has .* unpacks to 160000000 bytes"),
        "bomb.med": "bomb.med has .* unpacks to 160000000 bytes",
        "bomb.xdmf": "bomb.h5 has .* bytes and unpacks to 160000000 bytes, more than 100 times as many",
        "locked.npz": "locked.npz is encrypted: write it by numpy.savez",
        "broken.npz": "broken.npz cannot be read",
        "strange.xdmf": "strange.xdmf cannot be read: ReadError",
        "moved.xdmf": "moved.xdmf has another mesh at t = 1.0 than before",
        "turned.xdmf": "with other points or other triangles",
        "other.xdmf": "has no field 'u' at t = 1.0: give the same field at all times",
    }.items(),
)
def test_files_without_a_displacement_are_refused(unusable, name, message):
    with pytest.raises(BoundError, match=message):
        read(unusable / name)


@pytest.mark.parametrize("series", [True, False])
def test_a_file_that_needs_a_missing_package_says_which(series, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "mine.xdmf"
    arrays = field()
    if series:
        write(path, **arrays, form="HDF")
    else:
        meshio.Mesh(arrays["points"], [("triangle", arrays["triangles"])], {"u": arrays["u"][0]}).write(path)
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(BoundError, match=r"mine\.xdmf needs the package h5py: install it"):
        read(path)


CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
HALVES = [[0, 1, 2], [0, 2, 3]]


def test_of_several_fields_of_other_names_the_displacement_has_to_be_named(tmp_path):
    path = tmp_path / "several.vtu"
    mesh = meshio.Mesh(np.insert(CORNERS, 2, 0.0, axis=1), [("triangle", HALVES)])
    mesh.point_data = {"velocity": 0 * mesh.points, "depl": 1 + mesh.points}
    mesh.write(path)
    with pytest.raises(BoundError, match="fields at points are velocity, depl; choose one with --field NAME"):
        read(path)
    with pytest.raises(BoundError, match=r"does not have stress: its vector fields at points are .*velocity"):
        read(path, "stress")
    assert read(path, "depl").u.min() == 1
    del mesh.point_data["velocity"]
    mesh.write(path)
    assert read(path).u.min() == 1


@pytest.mark.parametrize("kind", ["triangle", "triangle6", "VTK_LAGRANGE_TRIANGLE"])
def test_the_command_bounds_the_displacement_in_a_vtk_file_by_its_error(kind, pulled, tmp_path, told):
    """u_h is 9/10 of the solution."""
    points, cells = (CORNERS, np.array(HALVES)) if kind == "triangle" else of_degree_2(CORNERS, np.array(HALVES))
    solid, u = (np.insert(array, 2, 0.0, axis=1) for array in (points, 0.9 * points * [1, -1 / 4]))
    meshio.Mesh(solid, [(kind, cells)], {"u": u}).write(tmp_path / "mine.vtu")
    told(f"bound {pulled}:plate --displacement {tmp_path}/mine.vtu --out {tmp_path}", code=0)
    (row,) = pd.read_csv(tmp_path / "plate-mine" / "levels.csv").to_dict("records")
    assert [row["lowest"], row["highest"], row["plain"]] == pytest.approx(3 * [0.1 * 2**0.5])
