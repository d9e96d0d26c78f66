"""Every figure says what it shows, from its data alone, in a size and in colours that can be read."""

import re
import shutil
from copy import copy
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from changed import overridden
from commands import study
from committed import CORNER, SMOOTH, SOLID, copy_results
from costly_cases import slow
from matplotlib.text import Text
from PIL import Image
from places import DATA, RESULTS

from study.ledger.datafiles import read_rates
from study.ledger.files import UsageError
from study.present.body import DRAWN_DISPLACEMENT, magnification
from study.present.charts import order_in_words
from study.present.drawing import (
    Output,
    column_width,
    draw_one,
    drawn_for_use,
    family_styles,
    in_style,
    page_width,
)
from study.present.figures import drawings, drawings_of, figure, overview
from study.present.picture import misplaced_length, read_pictures

SMALLEST = 7.0
"""Points, of all text but scripts."""


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    return copy_results(tmp_path_factory.mktemp("results"))


@pytest.fixture(scope="module")
def figures(measured):
    return {drawing.name: drawing for drawing in drawings(measured)}


@pytest.fixture
def alone(tmp_path):
    """Data of one case, to change."""
    return copy_results(tmp_path, (SMOOTH,), ())


def named(directory, name):
    (drawing,) = (drawing for drawing in drawings(directory) if drawing.name == name)
    return drawing


def drawn(drawing):
    with in_style():
        figure = drawing.draw()
        figure.draw_without_rendering()
    return figure


def cut_off_or_tiny(figure):
    """The texts of a drawn figure that are too small, and the labels and titles that reach beyond its ends."""
    axes = [axes for axes in figure.axes if axes.get_visible()]
    labels = [text for one in axes for text in (one.xaxis.label, one.yaxis.label, one.title) if text.get_text()]
    inside = figure.bbox.padded(1e-6).count_contains
    beyond = [one for one in (*labels, *figure.legends) if inside(one.get_window_extent().corners()) < 4]
    shown = [text for text in figure.findobj(Text) if text.get_visible() and text.get_text().strip()]
    return beyond + [text for text in shown if text.get_fontsize() < SMALLEST]


@pytest.mark.parametrize("every", [False, slow(True)])
def test_every_figure_fits_a_page_with_letters_large_enough_and_no_label_cut_off(figures, every):
    with in_style():
        narrowest = column_width()
        widest = page_width()
    for name in figures if every else ("collapsed", f"zone-{CORNER}"):
        figure = drawn(figures[name])
        assert narrowest <= figure.get_figwidth() <= widest, name
        assert cut_off_or_tiny(figure) == [], name


def test_every_caption_says_what_to_see_with_numbers(figures):
    for drawing in figures.values():
        assert re.search(r"What to see: .*\d.*\.$", drawing.caption), drawing.name
        assert "nan" not in drawing.caption, drawing.name


# Old versions of Matplotlib use names of pyparsing that are deprecated.
@pytest.mark.filterwarnings("error::UserWarning", "ignore::DeprecationWarning")
@pytest.mark.parametrize("level", [-1.0, slow(1.0)])
def test_a_face_of_a_solid_without_or_wholly_in_contact_can_be_drawn(measured, level):
    solid = read_pictures(measured)[-1]
    pressure = max(level, 0.0)
    given = {"level": level, "pressure": pressure, "pressure_exact": pressure, "gap": 0.0, "gap_exact": 0.0}
    values = {name: np.broadcast_to(value, getattr(solid.faces[0], name).shape) for name, value in given.items()}
    faces = [replace(face, **values) for face in solid.faces]
    shown = overridden(copy(solid.showing(solid.shown[:1])), faces=faces)
    for kind in ("fronts", "body"):
        drawing = figure(kind, shown)
        drawn(drawing)
        assert "nan" not in drawing.caption


# Uses: articles, slides, pages.


def size_of(png):
    with Image.open(png) as image:
        return image.size


def test_every_figure_of_a_slide_is_sixteen_to_nine_with_large_letters_not_cut_off(figures, tmp_path):
    slides = Output("slides", ("png",))
    png, *_ = draw_one(tmp_path, figures["orders"], slides)
    assert size_of(png) == (1920, 1080)
    for name in ("orders", f"profiles-{CORNER}"):
        with in_style(slides):
            figure = drawn_for_use(figures[name])
            figure.draw_without_rendering()
            assert cut_off_or_tiny(figure) == [], name


def test_every_slide_has_a_headline_of_at_most_three_lines_which_the_figure_of_an_article_has_not(figures):
    for drawing in figures.values():
        assert 10 < len(drawing.headline) < 3 * 76, drawing.name
        assert drawing.headline.lower() in drawing.caption.lower()
    with in_style(Output("slides")):
        assert drawn_for_use(figures["problem"]).get_suptitle().startswith("Where there is a gap ")
    with in_style():
        assert drawn_for_use(figures["problem"]).get_suptitle() == ""


def test_figures_with_more_rows_or_axes_than_can_be_read_on_a_slide_are_for_articles():
    sheets = {drawing.name: drawing.sheet for drawing in overview(RESULTS)}
    assert {name for name, sheet in sheets.items() if sheet} == {"convergence", "convergence-prop-5-3", "faults"}


def test_the_slide_of_the_main_result_says_the_observed_orders_and_names_every_line(measured, figures):
    smooth = read_rates(measured).query("claim == 'Prop. 5.4'")
    with in_style(Output("slides")):
        figure = drawn_for_use(figures["collapsed"])
    said = r"The error is O\(h\): observed orders \d\.\d\d to \d\.\d\d .* over the last two refinements"
    assert re.fullmatch(said, figure.get_suptitle().replace("\n", " "))
    entries = [text.get_text() for text in figure.legends[0].get_texts()]
    assert entries == ["mesh family", *family_styles(smooth["family"]), "C h, not fitted"]
    slow = order_in_words(smooth.assign(error=smooth["error"] * smooth["h"] ** -0.3))
    assert slow.startswith("on these meshes the error is not O(h): observed orders 0.")


def test_figures_are_drawn_by_name_from_one_directory_into_another(alone, out, told):
    shutil.copy(DATA / "provenance.json", alone / "data")
    command = f"figures --data {alone} --out {out} --jobs 1 --only"
    assert study(f"{command} problem orders --format png") == 0
    written = {path.name for path in (out / "figures").iterdir()}
    assert written == {"orders.csv", "orders.png", "orders.txt", "problem.png", "problem.txt"}
    assert not (alone / "figures").exists()
    assert re.search(rf"--only order: {alone} has no such figure, only .*orders", told(f"{command} order"))


def test_each_picture_has_an_alternative_text_which_begins_with_its_kind(figures, tmp_path):
    drawing = figures[f"zone-{CORNER}"]
    assert drawing.alternative.startswith(f"The contact zone in space and time, exact and computed: {CORNER}. ")
    png, svg, pdf, txt, csv = draw_one(tmp_path, drawing, Output(formats=("png", "svg", "pdf")))
    with Image.open(png) as image:
        assert image.info["Description"] == drawing.alternative
    assert {"gap_exact", "pressure_exact"} < {*pd.read_csv(csv)}
    assert drawing.alternative[:60] in svg.read_text(encoding="utf-8")
    assert b"/Subject" in pdf.read_bytes()
    assert "Alternative text: The contact zone" in txt.read_text(encoding="utf-8")


def test_every_figure_has_its_data_beside_it_except_a_sketch(figures):
    assert [name for name, drawing in figures.items() if drawing.table() is None] == ["problem"]
    nodes = figures[f"profiles-{CORNER}"].table()
    assert nodes[["time", "face", "x1", "x2"]].drop_duplicates().shape[0] == len(nodes) > 100
    assert np.minimum(nodes["gap_exact"], nodes["pressure_exact"]).abs().max() < 1e-8


def test_a_style_file_replaces_entries_and_its_figure_size_sets_the_column_width(alone, tmp_path):
    style = tmp_path / "journal.mplstyle"
    style.write_text("figure.figsize: 5.0, 4.0\nfont.size: 10\n")
    png, *_ = draw_one(tmp_path, named(alone, "orders"), Output(formats=("png",), dpi=100, style=style))
    assert size_of(png)[0] == 500
    style.write_text("figure.fgsize: 5.0, 4.0\n")
    complaint = r"--style .*journal.mplstyle is not a Matplotlib style file"
    with pytest.raises(UsageError, match=complaint), in_style(Output(style=style)):
        pass


def test_figures_of_one_case_are_chosen_by_its_name_and_an_unknown_name_is_refused(alone):
    assert {drawing.case for drawing in drawings_of(alone, [SMOOTH])} == {SMOOTH}
    with pytest.raises(UsageError, match=rf"--case nobody: {alone} has no such case, only {SMOOTH}"):
        drawings_of(alone, ["nobody"])


# What is computed from a picture before anything is drawn.


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    return read_pictures(copy_results(tmp_path_factory.mktemp("results"), (SMOOTH, SOLID), (SMOOTH, SOLID)))


@pytest.fixture
def face(pictures):
    """The contact face of a body in the plane, with vertices at equal distances, which the file rounds."""
    (face,) = pictures[0].segments
    return replace(face, s=np.linspace(0, 1, len(face.s)))


def test_the_exact_zone_is_as_deep_as_the_distance_to_its_fronts_and_ends_of_the_face_are_no_fronts(face):
    zone = [[], [(0.2, 0.6)], [(0.0, 0.3), (0.7, 1.0)]]
    s = np.array([0.0, 0.1, 0.25, 0.5, 0.8, 1.0])
    empty, middle, ends = face.depth(zone, s)
    assert (empty == -np.inf).all()
    assert middle == pytest.approx([-0.2, -0.1, 0.05, 0.1, -0.2, -0.4])
    assert ends == pytest.approx([0.3, 0.2, 0.05, -0.2, 0.1, 0.3])


def test_displacements_are_magnified_to_the_stated_share_of_the_body(pictures):
    for shown in pictures:
        largest = np.linalg.norm(shown.displacement, axis=1).max()
        size = np.ptp(shown.vertices, axis=1).max()
        share = magnification(shown.vertices, shown.displacement) * largest / size
        assert 0.9 * DRAWN_DISPLACEMENT < share <= DRAWN_DISPLACEMENT
    assert magnification(shown.vertices, np.zeros_like(shown.displacement)) == 1


def test_a_zone_that_should_not_be_there_counts_with_its_length(face):
    pressure = np.zeros_like(face.pressure)
    empty = replace(face, zone=[[] for _ in face.zone_times], pressure=pressure)
    assert not empty.outside.any()
    pressure[:, 2:5] = 1.0
    assert misplaced_length(empty) == pytest.approx(3.0, abs=0.01)
    # At the first time nothing has been solved.
    np.testing.assert_array_equal(empty.outside.sum(axis=1), [0, *[3] * (len(face.times) - 1)])


def test_between_known_times_ends_of_the_exact_zone_are_interpolated_unless_their_number_changes(face):
    moving = replace(face, zone_times=np.array([0.0, 1.0, 2.0]), zone=[[(0.0, 0.4)], [(0.0, 0.6)], []])
    assert moving.exact_zone(0.25) == [(0.0, pytest.approx(0.45))]
    assert moving.exact_zone(1.4) == [(0.0, 0.6)]
    assert moving.exact_zone(1.6) == []
