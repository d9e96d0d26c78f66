"""What `study show` writes can be read back, and shows the motion that was solved."""

from itertools import pairwise
from xml.etree import ElementTree

import meshio
import numpy as np
import pytest
from commands import study
from matplotlib.text import Annotation
from numpy.testing import assert_allclose
from PIL import Image, ImageSequence

from manufactured.colours import VERMILLION
from manufactured.tensors import full, mandel
from study.cli import problem
from study.cli.present import SHOWN_EVERY, affordable_family, mesh_series, solve_showcase
from study.fem.mesh import FAMILIES
from study.fem.naming import resolve
from study.ledger.pictures import UNITS
from study.present.picture import Picture
from study.present.show import NO_FFMPEG, draw_show, write_mp4
from study.solve.motion import Motion, von_mises
from study.statements import pictures

CASE = "hexagon"


@pytest.fixture(scope="module")
def motion():
    return Motion.of(resolve(CASE).solution, pictures.FAMILY, 6, 8)


def picture_of(motion):
    return Picture(pictures.record("any", motion, SHOWN_EVERY)).at_every(1)


@pytest.fixture(scope="module")
def shown(tmp_path_factory):
    """A case on a coarse mesh with few steps, where there is no ffmpeg any more."""
    directory = tmp_path_factory.mktemp("shows")
    case = resolve(CASE)
    notified = []
    (directory / "animation.mp4").touch()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("study.cli.present.PICTURE_STEPS", 8)
        patch.setattr("study.present.show.find_ffmpeg", lambda: None)
        record, series = solve_showcase(case, affordable_family(case, 6), 6, lambda: notified.append("frame"))
        files = draw_show(record, series, directory, lambda: notified.append("image"))
    assert notified == ["frame"] * 9 + ["image"] * (1 + len(record["times"]))
    return directory, *files


def test_everything_written_is_reported_and_what_is_left_out_has_its_reason(shown):
    directory, written, left_out = shown
    assert sorted(written) == sorted(path for path in directory.rglob("*") if path.is_file())
    names = {path.name for path in written}
    assert {"storyboard.png", "animation.gif", f"{CASE}.pvd", f"{CASE}-004.vtu"} <= names
    assert left_out == [f"animation.mp4: {NO_FFMPEG}"]


def test_the_collection_lists_every_file_with_its_time(shown):
    folder = shown[0] / "vtk"
    sets = ElementTree.parse(folder / f"{CASE}.pvd").findall("./Collection/DataSet")
    listed = {entry.get("file"): float(entry.get("timestep")) for entry in sets}
    assert listed == {path.name: n / 4 for n, path in enumerate(sorted(folder.glob("*.vtu")))}


def test_a_vtu_file_reads_back_as_the_mesh_and_the_fields_of_its_frame(shown, motion):
    frame = motion.frames[-1]
    space = motion.space
    read = meshio.read(shown[0] / f"vtk/{CASE}-004.vtu")
    np.testing.assert_array_equal(read.cells_dict["triangle"], space.mesh.t.T)
    assert_allclose(read.points, np.pad(space.mesh.p.T, ((0, 0), (0, 1))))
    for name, values in (("displacement", frame.u), ("velocity", frame.velocity)):
        assert_allclose(read.point_data[name][:, :2], space.nodal(values).T)
    assert_allclose(read.cell_data["von_mises"][0], von_mises(frame.stress))
    stress = np.pad(np.moveaxis(full(frame.stress), -1, 0), ((0, 0), (0, 1), (0, 1)))
    assert_allclose(read.cell_data["stress"][0], stress.reshape(-1, 9))
    for number, (_, vertices) in enumerate(space.contact, start=1):
        gap, pressure = (read.point_data[f"{name}_{number}"] for name in ("gap", "pressure"))
        assert set(np.flatnonzero(np.isfinite(gap))) == set(vertices)
        assert (gap[vertices] * pressure[vertices] <= 1e-9 * np.nanmax(pressure)).all()
        assert pressure[vertices].max() > 0


def test_a_solid_has_tetrahedra_and_all_nine_stresses():
    motion = Motion.of(resolve("cube-disc").solution, FAMILIES[0], 2, 2)
    frame = motion.frames[-1]
    _, mesh = mesh_series(motion, 1)[-1]
    assert mesh.cells[0].type == "tetra"
    assert_allclose(mandel(np.moveaxis(mesh.cell_data["stress"][0].reshape(-1, 3, 3), 0, -1)), frame.stress)
    assert {"gap", "pressure"} <= set(mesh.point_data)


def test_the_animation_has_a_frame_for_every_time_and_moves(shown):
    with Image.open(shown[0] / "animation.gif") as film_on_disk:
        assert film_on_disk.n_frames == 8 // SHOWN_EVERY + 1
        images = [np.asarray(frame.convert("RGB"), dtype=int) for frame in ImageSequence.Iterator(film_on_disk)]
    for before, after in pairwise(images):
        assert (before != after).any(axis=2).sum() > 200
    orange = [int(value) for value in bytes.fromhex(VERMILLION[1:])]
    for image in images[1:]:
        assert (abs(image - orange).sum(axis=2) < 30).sum() > 50, "arrows keep their colour"
    assert (shown[0] / "animation.gif").stat().st_size < 5e6


def test_the_shapes_of_an_animation_are_those_of_the_motion(motion):
    shown = picture_of(motion)
    frames = motion.frames[::SHOWN_EVERY]
    assert shown.times.tolist() == [frame.time for frame in frames]
    for found, expected in (
        (shown.displacement, [motion.space.nodal(frame.u) for frame in frames]),
        (shown.von_mises, [von_mises(frame.stress) for frame in frames]),
    ):
        assert_allclose(found, expected, atol=0.51 * np.max(np.abs(expected)) / UNITS)


@pytest.mark.slow
def test_a_film_is_written_by_the_ffmpeg_of_a_package_where_the_system_has_none(motion, tmp_path, monkeypatch):
    pytest.importorskip("imageio_ffmpeg")
    monkeypatch.setenv("PATH", "")
    path = write_mp4(tmp_path / "film.mp4", picture_of(motion))
    assert path.read_bytes()[4:8] == b"ftyp"


WITH_A_GAP_OF_THE_WRONG_SIGN = """from dataclasses import replace
from manufactured.catalogue import named
case = named("full-contact")
(face,) = case.solution.faces
solution = replace(case.solution, faces=(replace(face, gap=face.gap - 1),))
wrong = replace(case, solution=solution)
"""


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ("hexagon --mp4", "--mp4: ffmpeg is missing: install it, or `python -m pip install imageio-ffmpeg`"),
        ("{file}:wrong", "violated"),
        ("full-contact --out {file}", "cannot write {file}/full-contact/data/.lock: "),
    ],
)
def test_what_cannot_be_shown_is_refused(arguments, complaint, tmp_path, monkeypatch, out, told):
    monkeypatch.setattr("study.cli.present.find_ffmpeg", lambda: None)
    file = tmp_path / "wrong.py"
    file.write_text(WITH_A_GAP_OF_THE_WRONG_SIGN)
    assert complaint.format(file=file) in told(f"show --out {out} {arguments.format(file=file)}")
    assert [*tmp_path.iterdir()] == [file]


CLIP = """
from manufactured import Kind, plane_stress, polygon, static, x2

kinds = [Kind.CONTACT, Kind.LOADED, Kind.LOADED, Kind.CLAMPED]
body = polygon([(0, 0), (2, 0), (2, 1), (0, 1)], kinds)
clip = static(body, plane_stress(E=200.0, nu=0.3), f0=(0, -7), f2={1: (3, 0), 2: (0, -5 * x2)})
"""


def test_a_problem_is_drawn_as_it_is_stated(tmp_path, monkeypatch):
    """Numbers of sides, largest loads, and arrows: those that push end at their side, those that pull start there."""
    figures = []
    draw = problem.draw_problem
    monkeypatch.setattr(problem, "draw_problem", lambda *shown: figures.append(draw(*shown)) or figures[-1])
    (tmp_path / "clip.py").write_text(CLIP)
    assert study(f"show {tmp_path}/clip.py:clip --out {tmp_path}") == 0
    assert {"problem.png", "problem.svg", "problem.txt"} <= {path.name for path in (tmp_path / "clip").iterdir()}
    (axes,) = figures[0].axes
    assert {"0", "1", "2", "3", "$f_0$: 7", "5"} <= {text.get_text() for text in axes.texts}
    arrows = [text for text in axes.texts if isinstance(text, Annotation)]
    ends = np.array([(arrow.xyann, arrow.xy) for arrow in arrows])
    pulling = ends[ends[:, 0, 0] == 2]
    pushing = ends[np.isclose(ends[:, 1, 1], 1)]
    assert len(pulling) == len(pushing) == 7
    pulled = pulling[:, 1, 0] - 2
    pushed = pushing[:, 0, 1] - 1
    assert min(*pulled, *pushed) > 0
    assert max(pulled) / max(pushed) == pytest.approx(3 / 5)
    labels = [text.get_text() for text in figures[0].legends[0].get_texts()]
    assert labels == ["CLAMPED", "CONTACT", "load"]
