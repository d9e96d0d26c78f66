"""Charts show all of their data, and their triangles and orders are right."""

import math
import re
from itertools import product

import numpy as np
import pandas as pd
import pytest
from committed import SMOOTH
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from places import DATA, RESULTS, ROOT

from study.fem.mesh import FAMILIES
from study.ledger.datafiles import read_rates
from study.present.charts import draw_slope, label_ticks, last_orders, roller_rows
from study.present.drawing import family_styles, in_style
from study.present.figures import figure
from study.present.outcome import finest_orders
from study.present.report import svg_chart


@pytest.fixture(scope="module")
def enclosed():
    rows = pd.read_csv(DATA / "enclosures.csv")
    rows = rows.query(f"trajectory == 'enclosure' and case == {SMOOTH!r} and family == 'shaken'")
    return rows[rows["level"] == rows["level"].min()]


@pytest.fixture(scope="module")
def rates():
    return read_rates(RESULTS).query(f"case == {SMOOTH!r} and level <= 32")


def drawn(drawing):
    with in_style():
        return drawing.draw()


def test_every_value_is_drawn_within_its_axes_and_the_page_writes_words_as_text(rates):
    drawing = figure("convergence", rates, 1.0, case=SMOOTH)
    columns = ["error", "discrete_error", "in_time"]
    (axes,) = drawn(drawing).axes
    rates = rates.assign(in_time=rates["time_share"] * rates["error"])
    expected = [rows[["h", column]].to_numpy() for _, rows in rates.groupby("family") for column in columns]
    shown = [line.get_xydata() for line in axes.get_lines()]
    assert sorted(map(np.ndarray.tolist, shown)) == sorted(map(np.ndarray.tolist, expected))
    low, high = axes.get_ylim()
    assert low <= rates[columns].min(axis=None) < rates[columns].max(axis=None) <= high
    page = svg_chart(drawing)
    assert f'aria-label="{drawing.summary}"' in page
    for words in (*rates["family"].unique(), "share of time discretisation"):
        assert f">{words}</text>" in page


def test_where_the_error_is_unknown_the_distance_to_a_better_displacement_takes_its_place(enclosed):
    known = figure("enclosure", enclosed, "advance-recede, shaken")
    unknown = figure("enclosure", enclosed.assign(error=np.nan, plain=4.0), "ramp, shaken")
    assert "lines are the error itself" in known.caption
    assert "lines are the distance to a more accurate displacement" in unknown.caption
    for drawing, column in ((known, "error"), (unknown, "distance")):
        middle = drawn(drawing).axes[0].get_lines()[0]
        np.testing.assert_array_equal(middle.get_ydata(), enclosed[column])
    entries = [text.get_text() for text in drawn(unknown).legends[0].get_texts()]
    assert "bound from $u_h$ alone" in entries


@pytest.mark.parametrize("slope", [0.25, 1.0, 2.0])
def test_the_slope_triangle_has_its_slope_and_keeps_clear_of_the_curves(slope):
    h = 2.0 ** -np.arange(8, 2, -1, dtype=float)
    single, axes = Figure().subplots(2)
    single.loglog(1.0, 1.0)
    axes.loglog(h, 3 * h**0.5, h / 1.4, h**1.5, h[::-1], h[::-1] + 0.1)
    draw_slope(single, slope)
    draw_slope(axes, math.nan)
    assert not (*single.patches, *axes.patches)
    draw_slope(axes, slope)
    start, end, corner, *_ = np.log10(axes.patches[0].get_xy())
    assert (end - start)[1] == pytest.approx(slope * (end - start)[0])
    assert corner == pytest.approx([start[0], end[1]])
    assert axes.get_ylim()[1] > 10 ** end[1]
    for line in axes.get_lines():
        x, y = np.log10(np.sort(line.get_xydata(), axis=0)).T
        at = np.linspace(max(start[0], x[0]), end[0], 50)
        assert (start[1] + slope * (at - start[0]) - np.interp(at, x, y)).min() > 0.1


@pytest.mark.parametrize(("ends", "least"), {(0.011, 0.13): 3, (0.21, 0.34): 3, (1e-9, 1.0): 3, (2.0, 3e4): 2}.items())
def test_a_logarithmic_axis_has_enough_labels_and_not_too_many(ends, least):
    axes = Figure().subplots()
    axes.loglog(ends, ends)
    label_ticks([axes], least)
    bins, _ = np.histogram(axes.get_xticks(), 1, axes.get_xlim())
    assert least <= bins[0] <= 10


def test_orders_are_those_of_a_power_of_h_and_graded_meshes_are_kept_apart():
    h = 1 / np.array([16.0, 32.0, 64.0])
    frame = pd.DataFrame({"family": "shaken", "h": h, "error": 3 * h**0.5})
    assert finest_orders(frame.head(1), 2) == finest_orders(frame.assign(error=0.0), 2) == {}
    graded = frame.assign(family="graded", error=h)
    assert last_orders(pd.concat([frame, graded])) == ([pytest.approx(0.5)], [pytest.approx(1.0)])


def of_rollers(excess, kind="roller"):
    """Rows of ``statements.csv`` with the excess c/n for every family."""
    rows = [(f"{kind}-{n}", family, n, 1 / n, c / n) for family, c in excess.items() for n in (16, 32)]
    table = pd.DataFrame(rows, columns=["case", "family", "level", "h", "value"])
    return table.assign(label="beyond: rollers", quantity="excess")


def test_random_meshes_of_rollers_are_one_curve_with_their_range():
    drawing = figure("rollers", roller_rows(of_rollers({"one-diagonal": 1.0, "shaken": 2.0, "shaken-1": 4.0})))
    (axes,) = drawn(drawing).axes
    first, mean, slope = (line.get_ydata() for line in axes.get_lines())
    band = axes.collections[0].get_paths()[0].get_extents()
    assert [*first, *mean, band.y0, band.y1] == pytest.approx([1 / 16, 1 / 32, 3 / 16, 3 / 32, 2 / 32, 4 / 16])
    assert slope[1] == pytest.approx(2 * slope[0])
    assert "1.00 (one-diagonal), 1.00 (shaken)" in drawing.caption
    assert roller_rows(of_rollers({"shaken": 1.0}, "standing")).empty


# Colours: every variable has one, and every text is readable.


CSS = (ROOT / "study/present/page/page.css").read_text(encoding="utf-8")
THEMES = [dict(re.findall(r"--(\w+): ([^;]+);", line)) for line in CSS.splitlines() if ":root" in line]
TEXTS = ("ink", "soft", "link", "good", "bad", "warn")


def luminance(colour):
    """The relative luminance of the Web Content Accessibility Guidelines 2.2: 0 for black, 1 for white."""
    rgb = np.array(to_rgb(colour))
    return float(np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4) @ (0.2126, 0.7152, 0.0722))


def contrast(one, other):
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


def test_every_colour_of_the_page_is_defined_for_light_and_dark_pages_and_texts_have_enough_contrast():
    used = {*re.findall(r"var\(--([a-z]+)\)", CSS)}
    assert "warn" in used
    assert len(THEMES) == 2
    assert all(used <= set(theme) for theme in THEMES)
    # A contrast of at least 4.5, as criterion 1.4.3 of the guidelines demands.
    for name, theme, ground in product(TEXTS, THEMES, ("paper", "shade")):
        assert contrast(theme[name], theme[ground]) >= 4.5, (name, ground)


def test_a_new_mesh_family_has_a_style_that_no_other_family_has():
    names = [*(family.name for family in FAMILIES), "new"]
    styles = family_styles(names).values()
    assert len({style["color"] for style in styles}) == len({style["marker"] for style in styles}) == len(names)
