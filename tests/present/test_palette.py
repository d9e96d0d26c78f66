"""The colours of the report page: every variable has a colour, and every text is readable."""

import re
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from study.fem.mesh import FAMILIES
from study.present.palette import RAMPS, family_styles

CSS, SCRIPT = (
    (Path(__file__).parents[2] / "study" / "present" / "page" / name).read_text(encoding="utf-8")
    for name in ("page.css", "page.js")
)
THEMES = [dict(re.findall(r"--(\w+): ([^;]+);", line)) for line in CSS.splitlines() if ":root" in line]
TEXTS = ("ink", "soft", "link", "good", "bad", "warn")


def luminance(colour: str) -> float:
    """The relative luminance of the Web Content Accessibility Guidelines 2.2: 0 for black, 1 for white."""
    rgb = np.array(to_rgb(colour))
    return float(np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4) @ (0.2126, 0.7152, 0.0722))


def contrast(one: str, other: str) -> float:
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


def test_every_colour_that_the_page_uses_is_defined_for_light_and_for_dark_pages() -> None:
    used = {*re.findall(r"var\(--([a-z]+)\)", CSS + SCRIPT), *re.findall(r'theme\("--([a-z]+)"\)', SCRIPT)} - {*RAMPS}
    assert "warn" in used
    assert len(THEMES) == 2
    assert all(used <= set(theme) for theme in THEMES)


@pytest.mark.parametrize("name", TEXTS)
def test_texts_have_enough_contrast_on_the_page_and_on_tinted_lines(name: str) -> None:
    """At least 4.5, as criterion 1.4.3 of the guidelines demands; #767676 on white is their example."""
    assert contrast("#767676", "#fff") == pytest.approx(4.54, abs=0.005)
    for theme in THEMES:
        assert min(contrast(theme[name], theme[ground]) for ground in ("paper", "shade")) >= 4.5


def test_a_new_mesh_family_has_a_style_that_no_other_family_has() -> None:
    names = [*(family.name for family in FAMILIES), "new"]
    styles = family_styles(names).values()
    assert len({style.colour for style in styles}) == len({style.marker for style in styles}) == len(names)
