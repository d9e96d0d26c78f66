"""The formulas of the gallery are those that the cases state, in the form that browsers draw."""

import re
import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType

import pytest
from docutils.utils.math.latex2mathml import tex2mathml

from manufactured import catalogue

ROOT = Path(__file__).parents[2]


def extension(name: str) -> ModuleType:
    """A module of the site."""
    sys.path.insert(0, str(ROOT / "docs" / "extensions"))
    try:
        return import_module(name)
    finally:
        sys.path.pop(0)


@pytest.fixture(scope="module")
def gallery() -> ModuleType:
    return extension("gallery")


@pytest.mark.parametrize(
    ("formula", "drawn"),
    [
        (r"(1, \tfrac12)", "<mn>1</mn><mn>2</mn></mfrac><mostretchy"),
        (r"\tilde\sigma_\nu", '<msub><mover><mi>σ</mi><mostretchy="false">~</mo></mover><mi>ν</mi></msub>'),
        (r"\lVert u\rVert_V", '<mi>u</mi><msub><mostretchy="false">‖</mo><mi>V</mi></msub>'),
        (r"\sum_{i=1}^{n} a_i", "<munderover><mo"),
    ],
)
def test_a_formula_is_drawn_as_it_is_written(formula: str, drawn: str) -> None:
    mathml = extension("mathml").mathml
    assert drawn in re.sub(r"\s", "", mathml(formula, as_block=True))


def test_the_formulas_of_a_case_can_be_drawn_and_none_is_left_in_letters_of_a_keyboard(gallery: ModuleType) -> None:
    for case in catalogue():
        _, _, text = gallery.formulas(case)
        found = re.findall(r"\$(.+?)\$", text)
        assert len(found) > 2, case.name
        for formula in found:
            assert tex2mathml(formula), case.name
        assert re.findall(r"^    |[\^]|_\{", re.sub(r"\$.+?\$|``.*?``", "", text), re.MULTILINE) == [], case.name


@pytest.mark.parametrize(
    ("written", "latex"),
    [
        ("w = 8 (−ψ)_+^4/(1/5 − ψ)³", "w = 8 (-ψ)_+^4/(1/5 - ψ)^3"),
        ("p = a Q̇ + A_nnnn θ̇", r"p = a \dot{Q} + A_{nnnn} \dot{θ}"),
        ("|Γ3,2| − x^{−1/2}", "|Γ_{3,2}| - x^{-1/2}"),
        ("Re(a z^α) cos λω", r"\operatorname{Re}(a z^α) \operatorname{cos} λω"),
    ],
)
def test_a_formula_becomes_latex(written: str, latex: str, gallery: ModuleType) -> None:
    assert sys.modules["formulas"].latex(written) == latex
