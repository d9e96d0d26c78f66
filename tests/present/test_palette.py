"""The colours of the report page: every variable has a colour, and every text is readable."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from study.fem.mesh import FAMILIES
from study.present.palette import CONTRAST, PAGE, RAMPS, contrast, family_styles, readable

PAGES = Path(__file__).parents[2] / "study" / "present" / "page"
TEXTS = ("ink", "soft", "link", "good", "bad", "warn")


def test_every_colour_that_the_page_uses_is_defined_for_light_and_for_dark_pages() -> None:
    text = "".join((PAGES / name).read_text(encoding="utf-8") for name in ("page.css", "page.js"))
    used = {*re.findall(r"var\(--([a-z]+)\)", text), *re.findall(r'theme\("--([a-z]+)"\)', text)} - {*RAMPS}
    assert "warn" in used
    for page in PAGE.values():
        assert used <= set(page)


@pytest.mark.parametrize("page", PAGE)
@pytest.mark.parametrize("name", TEXTS)
def test_texts_have_enough_contrast_on_the_page_and_on_tinted_lines(page: str, name: str) -> None:
    colours = PAGE[page]
    assert min(contrast(colours[name], colours[ground]) for ground in ("paper", "shade")) >= CONTRAST


def test_contrast_is_21_between_black_and_white_and_1_between_equal_colours() -> None:
    assert contrast("#000000", "#ffffff") == pytest.approx(21)
    assert contrast("#d55e00", "#D55E00") == 1
    assert contrast("#767676", "#fff") == pytest.approx(4.54, abs=0.005)  # the example of the guidelines


def test_a_colour_that_is_readable_is_not_changed() -> None:
    assert readable("#0072b2", "#ffffff") == "#0072b2"


def test_a_new_mesh_family_has_a_style_that_no_other_family_has() -> None:
    names = [*(family.name for family in FAMILIES), "new"]
    styles = family_styles(names)
    assert (
        len({style.colour for style in styles.values()})
        == len({style.marker for style in styles.values()})
        == len(names)
    )
