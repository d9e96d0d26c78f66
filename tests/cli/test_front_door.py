"""What a newcomer types by mistake is answered with what to type instead, and nothing is lost."""

import os

import pytest
from commands import python

import manufactured
from study.cli.options import COMPARE_TOLERANCE, FAMILY_NAMES, SCHEME_NAMES
from study.fem.mesh import FAMILIES, Alternating
from study.ledger.compare import Tolerance
from study.ledger.files import UsageError
from study.solve.tableau import SCHEMES

CASES = """
from manufactured import named

def patch():
    return named("travelling-patch")

front = named("advance-recede")
_hidden = front
"""


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "cases.py"
    path.write_text(CASES, encoding="utf-8")
    return path


def test_a_name_with_a_slip_is_answered_with_the_nearest_one(refused):
    assert "unknown case 'hexgon'; did you mean hexagon? All: full-contact" in refused("run --case hexgon")
    assert "did you mean midpoint?" in refused("run --scheme midpiont")
    assert "midpoint" in refused("run --scheme rk4")


def test_an_option_with_a_slip_is_answered_with_the_nearest_one_and_all_options_of_the_command(told):
    said = " ".join(told("run --cases hexagon").split())
    assert said.startswith("usage: study run [-h]")
    assert said.endswith("unrecognized arguments: --cases hexagon; did you mean --case?")


@pytest.mark.parametrize("name", ["", ":pach"])
def test_a_file_without_a_name_it_defines_is_answered_with_those_it_does(file, name, refused):
    said = refused(f"run --case {file}{name}")
    assert f"give {file}:front or {file}:patch" in said
    assert "_hidden" not in said
    assert "named" not in said


OWN = """
from sympy import Max
from manufactured import *
body = unit_square()
law = KelvinVoigt(isotropic(1, 1{of}), isotropic(1, 1{of}), "solid")
(floor,) = body.of(Kind.CONTACT)
z = t / 2 - s
face = {face}
mine = Case("mine", "", ExactSolution(body, law, (face,)), Regularity(gap=4, pressure=3, moving=True), 1, "none")
"""
LINEAR = "ContactFace.linear(floor, law, 1.0, {}, {}, {})"
PRESCRIBED = "ContactFace(floor, {}, Prescribed(((1.0, {}),)), z)"
RIGHT = OWN.format(face=LINEAR.format("pos(-z, 4)", "pos(z, 3)", "z"), of="")


@pytest.mark.parametrize(
    ("face", "kink", "instead"),
    [
        (LINEAR.format("pos(-z, 4)", "40*Max(z, 0)**2", "z"), "Max(0, -s + t/2)**2", "pos(-s + t/2, 2)"),
        (LINEAR.format("Max(-z, 0)**3", "pos(z, 2)", "z"), "Max(0, s - t/2)**3", "pos(s - t/2, 3)"),
        (LINEAR.format("pos(-z, 4)", "pos(z, 2)", "abs(z)"), "Abs(s - t/2)", "pos(s - t/2, 1) + pos(-s + t/2, 1)"),
        (PRESCRIBED.format("pos(-z, 4)", "-Max(z, 0)**2"), "Max(0, -s + t/2)**2", "pos(-s + t/2, 2)"),
    ],
)
def test_a_kink_is_answered_with_pos_before_label_symbols_and_dimension(face, kink, instead, refusal_of_case):
    said = refusal_of_case(OWN.format(face=face, of=", dim=3"))
    assert f"instead of {kink} write {instead} (" in said
    assert said.endswith("mine.py, line 8); correct the file\n")
    assert "label" not in said
    assert len(said.splitlines()) == 1


@pytest.mark.parametrize(
    ("lines", "said"),
    {
        "def mine():\n    named('hexagon')": "mine returned None, expected a manufactured.Case: add a return statement",
        RIGHT.replace("pos(z, 3)", "I*pos(z, 3)"): "has a number that is complex or not",
        RIGHT.replace(
            "Solution(body", "Solution(other"
        ): "got 1 contact faces, of which face 1 is on no part Γ3 of this body",
        RIGHT.replace(
            'isotropic(1, 1), "solid', 'skew, "solid'
        ): "G is not symmetric, so Problem 3.2 and the stored energy are not defined",
        RIGHT.replace("unit_square()", "low"): "`profile=cutoff(depth)` of ContactFace lets it end above Γ1",
    }.items(),
    ids=["no return", "complex", "another body", "no potential", "a low body"],
)
def test_a_case_that_cannot_be_measured_is_refused_with_what_to_change(lines, said, refusal_of_case):
    skew = "skew = NonSymmetric(isotropic(1, 1).matrix + [[0, 0.1, 0], [-0.1, 0, 0], [0, 0, 0]])\n"
    other = "from sympy import I\nother = unit_square()\n"
    other += "sides = [Kind.CONTACT, Kind.LOADED, Kind.CLAMPED, Kind.LOADED]\n"
    other += "low = polygon([(0, 0), (1, 0), (1, 0.5), (0, 0.5)], sides)\n"
    assert said in refusal_of_case(f"from manufactured import *\n{skew}{other}{lines}")


def test_help_names_what_there_is_in_80_columns_and_needs_nothing_that_takes_time():
    asked = (
        "import sys; from study.cli.options import parser; parser().print_help(); print(*sys.modules, file=sys.stderr)"
    )
    printed, modules = python(asked, env={**os.environ, "COLUMNS": "80"})
    assert not {"numpy", "sympy", "pandas", "matplotlib", "skfem", "scipy"} & set(modules.split())
    assert {*SCHEME_NAMES, *FAMILY_NAMES} <= set(printed.replace(",", " ").replace(".", " ").split())
    assert max(map(len, printed.splitlines())) <= 80
    assert set(SCHEME_NAMES) == {scheme.name for scheme in SCHEMES}
    assert [*FAMILY_NAMES] == [*(family.name for family in FAMILIES), Alternating().name]
    assert Tolerance.relative == COMPARE_TOLERANCE


def test_names_of_the_package_are_found_when_they_are_asked_for():
    asked = "import manufactured.catalogue, sys; print('sympy' in sys.modules); from manufactured import *; print(pos)"
    printed, _ = python(asked)
    assert printed.split() == ["False", "pos"]
    assert {*manufactured.__all__} < {*dir(manufactured)}
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        manufactured.nothing  # noqa: B018


@pytest.mark.parametrize(
    ("command", "words"),
    {
        "run --jobs 0": "1 to 1024",
        "figures --dpi 1": "10 to 2400",
        "check --again 0": "1 or more rows",
        "check --again 1 --seed -1": "0 or more",
        "check --again 1 --tolerance nan": "a number, 0 or more",
        "compare a b --absolute inf": "a number, 0 or more",
        "export corner --levels 1": "2 or more",
        "export corner --mode march --steps 0": "1 or more",
        "export corner --levels 4 --foundation 0": "1 or more",
        "export corner --scale 1e-320": "1e-100 to 1e100",
        "show hexagon --level 1": "2 or more",
        "bound ramp --adapt 5% --cells 0": "1 or more",
        "seeds --minutes -1": "0 or more (0 prints the record)",
        "seeds --seeds 0": "1 or more",
        "bound ramp --refine 99999": "0 to 20",
    }.items(),
)
def test_a_number_that_is_not_permitted_is_refused_before_a_module_is_imported(command, words, told, monkeypatch):
    monkeypatch.setattr("importlib.import_module", None)
    *_, flag, value = command.split()
    assert told(command).endswith(f"error: argument {flag}: must be {words}, got {value}\n")


def test_an_own_case_with_the_name_of_another_is_refused(file, refused):
    said = refused(f"run --case {file}:front --levels 2 4 8")
    assert "cases.py:front has the name advance-recede of a case of the catalogue; give it another name" in said


def test_levels_with_meshes_that_do_not_fit_a_body_are_refused(refused):
    assert "level 5: facets of total length 0" in refused("run --levels 5 10 20")


def test_too_few_levels_are_named_before_anything_is_measured(refused, monkeypatch):
    def stop(*arguments):
        raise UsageError("here it would begin")

    monkeypatch.setattr("study.cli.run.refuse_too_large", stop)
    said = refused("run --case corner full-contact --levels 8")
    few = "a verdict on an order needs 3 levels, not only 8; give 3 or more, such as --levels 8 16 32"
    assert said.splitlines() == [
        f"study: corner: {few}",
        f"study: full-contact: {few}",
        "study: here it would begin",
    ]
    assert "needs 4 levels" in refused("run --case rough-1.75 --levels 8 16 32")
    assert refused("run") == "study: here it would begin\n"
