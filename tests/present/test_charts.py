"""Charts draw the curves that they describe, and their triangles, orders and ticks are right."""

import math
import re
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from committed import RESULTS, SMOOTH
from matplotlib.colors import to_rgb

from study.fem.mesh import FAMILIES
from study.ledger.datafiles import read_rates
from study.present.charts import (
    Chart,
    Curve,
    convergence_chart,
    draw_chart,
    enclosure_chart,
    finest_orders,
    last_orders,
    rollers_chart,
    slope_triangle,
)
from study.present.drawing import in_style
from study.present.palette import Style, family_styles
from study.present.report import svg_chart


@pytest.fixture(scope="module")
def enclosed() -> pd.DataFrame:
    rows = pd.read_csv(RESULTS / "data" / "enclosures.csv")
    rows = rows.query(f"trajectory == 'enclosure' and case == {SMOOTH!r} and family == 'shaken'")
    return rows[rows["level"] == rows["level"].min()]


@pytest.fixture(scope="module")
def charts(enclosed: pd.DataFrame) -> dict[str, Chart]:
    errors = read_rates(RESULTS).query(f"case == {SMOOTH!r} and level <= 32")
    return {
        "convergence": convergence_chart(errors, 1.0),
        "enclosure": enclosure_chart(enclosed, "advance-recede, shaken"),
        "unknown error": enclosure_chart(enclosed.assign(error=np.nan, plain=4.0), "ramp, shaken"),
    }


@pytest.mark.parametrize("name", ["convergence", "unknown error"])
def test_figure_shows_every_curve_within_its_axes_and_the_page_writes_its_words_as_text(
    name: str, charts: dict[str, Chart]
) -> None:
    chart = charts[name]
    with in_style():
        figure = draw_chart(chart)
    for axes, subplot in zip(figure.axes, chart.subplots, strict=True):
        # Last come the curves, after horizontal lines.
        lines = axes.get_lines()[len(subplot.rules) :]
        for line, curve in zip(lines, subplot.curves, strict=True):
            np.testing.assert_array_equal(line.get_xydata(), np.column_stack([curve.x, curve.y]))
            assert line.get_color() == curve.style.colour
            if curve.style.stroke == "solid":
                assert axes.get_ylim()[0] <= curve.y.min() <= curve.y.max() <= axes.get_ylim()[1]
        assert len(axes.get_yticks()) == len(subplot.y.ticks())
    (legend,) = figure.legends
    entries = [text.get_text() for text in legend.get_texts() if text.get_text() != " "]
    assert len(entries) == sum(map(len, chart.legend))
    page = svg_chart("name", chart)
    assert chart.summary in page
    for words in (text for text in entries if "$" not in text):
        assert f">{words}</text>" in page


def test_where_the_error_is_unknown_the_distance_to_a_better_displacement_takes_its_place(charts, enclosed) -> None:
    known, unknown = charts["enclosure"], charts["unknown error"]
    assert "lines are the error itself" in known.caption
    assert "lines are the distance to a more accurate displacement" in unknown.caption
    np.testing.assert_array_equal(unknown.subplots[0].curves[-1].y, enclosed["distance"])
    assert "bound from u_h alone" in [text for text, _ in unknown.legend[1]]


@pytest.mark.parametrize("slope", [0.25, 1.0, 2.0])
def test_the_slope_triangle_has_its_slope_and_keeps_clear_of_the_curves(slope: float) -> None:
    h = 2.0 ** -np.arange(8, 2, -1, dtype=float)
    points = [(h, 3 * h**0.5), (h / 1.4, h**1.5), (h[::-1], h[::-1] + 0.1)]
    curves = [Curve(x, y, Style("black")) for x, y in points]
    triangle = slope_triangle(curves, slope, decades=2.0)
    assert triangle is not None
    (x0, y0), (x1, y1), corner = np.log10(triangle.corners)
    assert (y1 - y0) / (x1 - x0) == pytest.approx(slope)
    assert corner == pytest.approx([x0, y1])
    assert triangle.top > 10**y1
    for x, y in points:
        order = np.argsort(x)
        at = np.linspace(max(x0, np.log10(x.min())), x1, 50)
        assert (y0 + slope * (at - x0) - np.interp(at, np.log10(x[order]), np.log10(y[order]))).min() > 0.1
    single = [replace(curve, x=curve.x[:1], y=curve.y[:1]) for curve in curves]
    assert slope_triangle(single, slope, 2.0) is slope_triangle(curves, math.nan, 2.0) is None


def test_orders_are_those_of_a_power_of_h_and_graded_meshes_are_kept_apart() -> None:
    h = 1 / np.array([8.0, 16.0, 32.0, 64.0])
    # The coarsest level does not count.
    frame = pd.DataFrame({"family": "shaken", "level": [8, 16, 32, 64], "h": h, "error": 3 * h**0.5 + (h == 0.125)})
    assert finest_orders(frame, 2) == {"shaken": pytest.approx(0.5)}
    assert finest_orders(frame.head(1), 2) == finest_orders(frame.assign(error=0.0), 2) == {}
    graded = frame.assign(family="graded", error=h)
    assert last_orders(pd.concat([frame, graded])) == ([pytest.approx(0.5)], [pytest.approx(1.0)])


def of_rollers(excess: dict[str, float], kind: str = "roller") -> pd.DataFrame:
    """Rows of ``statements.csv`` with the excess c/n for every family."""
    rows = [(f"{kind}-{n}", family, n, 1 / n, c / n) for family, c in excess.items() for n in (16, 32)]
    table = pd.DataFrame(rows, columns=["case", "family", "level", "h", "value"])
    return table.assign(label="beyond: rollers", quantity="excess")


def test_random_meshes_of_rollers_are_one_curve_with_their_range() -> None:
    chart = rollers_chart(of_rollers({"one-diagonal": 1.0, "shaken": 2.0, "shaken-1": 4.0}))
    assert chart is not None
    (subplot,) = chart.subplots
    first, mean, slope = subplot.curves
    assert first.y == pytest.approx([1 / 16, 1 / 32])
    assert mean.y == pytest.approx([3 / 16, 3 / 32])
    assert slope.y[1] / slope.y[0] == pytest.approx(2)
    (band,) = subplot.bands
    assert (band.low, band.high) == (pytest.approx([2 / 16, 2 / 32]), pytest.approx([4 / 16, 4 / 32]))
    assert "1.00 (one-diagonal), 1.00 (shaken)" in chart.caption
    assert subplot.y.high >= 4 / 16
    assert rollers_chart(of_rollers({"shaken": 1.0}, "standing")) is None


# Colours: every variable has one, and every text is readable.


CSS = (Path(__file__).parents[2] / "study" / "present" / "page" / "page.css").read_text(encoding="utf-8")
THEMES = [dict(re.findall(r"--(\w+): ([^;]+);", line)) for line in CSS.splitlines() if ":root" in line]
TEXTS = ("ink", "soft", "link", "good", "bad", "warn")


def luminance(colour: str) -> float:
    """The relative luminance of the Web Content Accessibility Guidelines 2.2: 0 for black, 1 for white."""
    rgb = np.array(to_rgb(colour))
    return float(np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4) @ (0.2126, 0.7152, 0.0722))


def contrast(one: str, other: str) -> float:
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


def test_every_colour_of_the_page_is_defined_for_light_and_dark_pages_and_texts_have_enough_contrast() -> None:
    used = {*re.findall(r"var\(--([a-z]+)\)", CSS)}
    assert "warn" in used
    assert len(THEMES) == 2
    assert all(used <= set(theme) for theme in THEMES)
    # A contrast of at least 4.5, as criterion 1.4.3 of the guidelines demands; #767676 on white is their example.
    assert contrast("#767676", "#fff") == pytest.approx(4.54, abs=0.005)
    for name, theme, ground in product(TEXTS, THEMES, ("paper", "shade")):
        assert contrast(theme[name], theme[ground]) >= 4.5, (name, ground)


def test_a_new_mesh_family_has_a_style_that_no_other_family_has() -> None:
    names = [*(family.name for family in FAMILIES), "new"]
    styles = family_styles(names).values()
    assert len({style.colour for style in styles}) == len({style.marker for style in styles}) == len(names)
