"""What ``study certify`` proves is what ``study bound`` computes; what it does not serve is refused in words."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sympy import Min, Rational, sin, sqrt

from manufactured import Data, FrobeniusBall, KelvinVoigt, Kind, Yield, isotropic, polygon, pos, t, unit_square, x1
from manufactured.factor import layers, x2
from manufactured.law import Linear as Tensor
from study.bound.bounded import bounded_solution
from study.bound.discretisation import Discretisation
from study.bound.problem import BoundError
from study.bound.trajectory import Refined
from study.certify import checker
from study.certify.certified import Making
from study.certify.statement import Twins, in_doubles, rational, rational_mesh, statement, voigt
from study.certify.witnesses import AdmissibleRounding, StressEncoder, element, value_of
from study.cli.main import main
from study.fem.mesh import MeshFamily, OneDiagonal, Shaken, Unstructured
from study.solve.tableau import MIDPOINT

PROBLEMS = Path(__file__).parents[2] / "examples" / "certificates" / "problems.py"
LAW = KelvinVoigt(isotropic(1, 0.5), isotropic(2, 3), "linear")
pytestmark = pytest.mark.usefixtures("constants_of_a_coarse_mesh")


Problems = Callable[[str], Data]


def test_what_is_proved_is_what_is_computed(problem: Problems, computed_bounds: dict[str, float]) -> None:
    data, family, refined = problem("square"), OneDiagonal(), Refined(0, 1)
    found = checker.verified(Making(data, family, MIDPOINT, refined).certificate(2, 2))
    computed = bounded_solution(data, None, family, 2, MIDPOINT, 2, refined).enclosure
    bounds = {"low": computed.lowest, "high": computed.highest, "last": computed.bound[-1]}
    assert bounds == pytest.approx(computed_bounds, rel=1e-6)
    assert {name: float(getattr(found, name)) for name in bounds} == pytest.approx(bounds, rel=1e-6)


def test_better_witnesses_prove_a_narrower_interval_for_the_same_error(
    problem: Problems, plain: checker.Enclosure
) -> None:
    wide, data = plain, problem("square")
    narrow = checker.verified(Making(data, OneDiagonal(), MIDPOINT, Refined(1, 1)).certificate(2, 2))
    assert wide.low < narrow.low < narrow.high < wide.high


@pytest.mark.parametrize("name", ["square", "wedge", "bracket"])
def test_committed_certificates_state_the_problems_beside_them(name: str, problem: Problems) -> None:
    stored = checker.load(PROBLEMS.parent / f"{name}-4.json.gz")
    assert stored["problem"] == statement(problem(name))


CORNERS = [(0, 0), (2, 0), (3, 1), (3, 2), (0, 2)]
KINDS = [Kind.CONTACT, Kind.CONTACT, Kind.LOADED, Kind.CLAMPED, Kind.LOADED]


def test_two_faces_of_contact_that_meet_are_served() -> None:
    data = Data.formulas(polygon(CORNERS, KINDS), LAW, f0=(0, -4 * t), f2={2: (-t, 0)})
    making = Making(data, Unstructured(), MIDPOINT, Refined(0, 1))
    found = checker.verified(making.certificate(3, 2))
    assert 0 < found.low < found.high


def formulas(f0: Any = (0, 0), law: KelvinVoigt = LAW, **more: Any) -> Data:
    return Data.formulas(unit_square(), law, f0=f0, **more)


REFUSED: dict[str, tuple[Data, str]] = {
    "no polynomial": (formulas((0, sin(x1))), "f_0 has .*support polynomials"),
    "not rational": (formulas((0, sqrt(3) * t)), "coefficients are not rational"),
    "a kink in f_0": (formulas((0, pos(x1 - t, 3))), "f_0 has a kink"),
    "a ramp in f_0 that stops": (formulas((0, Min(t, Rational(1, 2)))), "f_0 has .*support polynomials"),
    "a ramp in f_2 that stops": (formulas(f2={1: (Min(t, Rational(1, 2)), 0)}), "f_2 has .*support polynomials"),
    "a kinked ramp of a kink that moves": (
        formulas(f2={1: (pos(t - Rational(1, 2), 1) * pos(x2 - t, 2), 0)}),
        "f_2 has the summand",
    ),
    "a kink in a kink": (
        formulas(f2={1: (pos(x2 - pos(t - Rational(1, 2), 1), 1), 0)}),
        "f_2 has .*support polynomials",
    ),
    "a kink in u_0": (formulas(u0=(0, (1 - x2) * pos(x1 - Rational(1, 2), 2))), "u_0 has .*support polynomials"),
    "a jump": (formulas(f2={1: (pos(x2 - t, 0), 0)}), "f_2 has the summand"),
    "two kinks": (formulas(f2={1: (pos(x2 - t, 1) * pos(t - x2 / 2, 2), 0)}), "f_2 has the summand"),
    "a fractional power": (formulas(f2={1: (pos(x2 - t, Rational(3, 2)), 0)}), "f_2 has the summand"),
    "a law that yields": (
        formulas(law=KelvinVoigt(isotropic(1, 0.5), Yield(2.0, FrobeniusBall(0.1)), "yields")),
        "G is not linear and uniform",
    ),
    "layers": (
        formulas(law=KelvinVoigt(isotropic(1, 0.5, factor=layers((0, 1), 0.5, 2)), isotropic(1, 1), "layers")),
        "A is not linear and uniform",
    ),
}


@pytest.mark.parametrize("name", REFUSED, ids=str)
def test_what_is_not_served_is_refused_in_words(name: str) -> None:
    data, message = REFUSED[name]
    with pytest.raises(BoundError, match=message):
        statement(data)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (formulas((0, x1**11)), "integer from 0 to 10"),
        (formulas((0, x1**6 * t**5)), "degree above 10"),
        (formulas(f2={1: (pos(x2 - t, 11), 0)}), "integer from 0 to 10"),
        (formulas(u0=(0, (x2 - 1) * x1)), "u_0ν ≤ 0 on Γ3 cannot be shown"),
    ],
    ids=["degree", "total degree", "power", "u_0 in the foundation"],
)
def test_what_the_checker_would_refuse_is_refused_before_it_is_computed(data: Data, message: str) -> None:
    with pytest.raises(BoundError, match=f"no certificate can be made of this problem: .*{message}"):
        Making(data, OneDiagonal(), MIDPOINT, Refined(0, 1)).check()


def test_cases_are_refused_by_the_command(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert main(["certify", "full-contact", "--out", str(tmp_path)]) == 2
    assert "certificates support data that are formulas" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["bracket", pytest.param("wedge", marks=pytest.mark.slow)])
def test_the_command_serves_the_other_examples(name: str, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    options = ["--levels", "2", "--steps", "2", "--refine", "0", "--shorter", "1", "--out", str(tmp_path)]
    assert main(["certify", f"{PROBLEMS}:{name}", *options]) == 0
    assert "cells, h = " in capsys.readouterr().out


def test_the_command_writes_certificates_and_checks_them(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    options = ["--levels", "2", "4", "--steps", "2", "--refine", "0", "--shorter", "1", "--family", "one-diagonal"]
    assert main(["certify", f"{PROBLEMS}:square", *options, "--out", str(tmp_path)]) == 0
    assert "32 cells, h = 0.2500: max ‖u − u_h‖_V in [" in capsys.readouterr().out
    assert (tmp_path / "square" / "certificate-4.json.gz").is_file()


def test_doubles_are_read_as_the_fractions_that_are_meant() -> None:
    assert (rational(0.8), rational(1 / 3)) == (Fraction(4, 5), Fraction(1, 3))
    assert rational(3**0.5) == Fraction(3**0.5)
    root = 2**0.5
    coupled = np.array([[3, 1, 0.3 * root], [1, 2, 0], [0.3 * root, 0, 2 * 0.7]])
    assert voigt(Tensor(coupled).matrix)[0][2] == Fraction(3, 10)
    assert voigt(Tensor(coupled).matrix)[2][2] == Fraction(7, 10)


def test_loads_are_read_as_they_are() -> None:
    push = 4 * t * pos(1 - (x1 - t / 2) ** 2, 3) + x1 * t**2
    formula = checker.formula(statement(formulas(f2={1: (push, 0)}))["loads"]["1"][0])
    for place in ((0.5, 1.0, 0.25), (1.75, 0.0, 0.5), (0.0, 0.5, 1.0)):
        exact = tuple(Fraction(c) for c in place)
        wanted = float(push.subs(dict(zip((x1, x2, t), place, strict=True))))
        assert value_of(formula, exact) == pytest.approx(wanted, abs=1e-14)


@pytest.mark.parametrize("normals", [[(1, 4)], [(0, -1)], [(0, -1), (1, -1)], [(0, -1), (-3, -1)]], ids=str)
def test_rounded_displacements_are_admissible_and_near(normals: list[tuple[int, int]]) -> None:
    rng = np.random.default_rng(0)
    for _ in range(50):
        value = [int(c) for c in rng.integers(-(10**9), 10**9, 2)]
        rounded = AdmissibleRounding._admissible(value, normals)
        products = [x * rounded[0] + y * rounded[1] for x, y in normals]
        assert max(products) <= 0
        if all(x * value[0] + y * value[1] < -100 for x, y in normals):
            assert max(abs(a - b) for a, b in zip(value, rounded, strict=True)) < 20


def test_stresses_come_back_from_their_numbers(problem: Problems) -> None:
    """What the checker decodes is the stress that was encoded, in every cell and component."""
    data = problem("bracket")
    stated = checker.Problem(statement(data))
    exact = checker.Mesh.of(rational_mesh(Unstructured()(data.body, 4), data.body), stated)
    fine = Discretisation(data, in_doubles(exact))
    twins = Twins(fine.mesh, exact)
    encoder = StressEncoder(stated, twins, fine)
    bits, coarse = 50, 4
    load = encoder.loads(Fraction(1, 2), Fraction(1))[-1]
    strain = fine.strain(np.random.default_rng(3).normal(size=fine.displacements.dofs))
    found = fine.equilibrium(encoder.study_loads(load), strain, None)
    stress = encoder.bernstein(found.values)
    tractions, inner = encoder.numbers(stress, load, bits, coarse)
    decoder = checker.Stresses(exact, {"bits": bits, "coarse": coarse}, element())
    field, unbalanced = decoder.field(decoder.tractions(tractions)[0], inner, [])
    for cell, mine, theirs in zip(exact.cells, field, stress, strict=True):
        pushed = np.tensordot(checker.voigt(*cell.F), np.array(mine, dtype=float).reshape(3, 3, 10), 1)
        wanted = np.einsum("tna,taI->Itn", encoder.to_monomials, theirs)
        assert pushed * (exact.h / cell.det**2 / decoder.unit) == pytest.approx(wanted, abs=1e-8 * abs(wanted).max())
    assert float(unbalanced) < 1e-9 * abs(stress).max()


@pytest.mark.parametrize("family", [OneDiagonal(), Shaken(), Unstructured()], ids=lambda family: family.name)
def test_meshes_are_those_of_the_families_up_to_a_little(family: MeshFamily, problem: Problems) -> None:
    body = problem("wedge").body
    mesh = family(body, 4)
    exact = checker.Mesh.of(rational_mesh(mesh, body), checker.Problem(statement(problem("wedge"))))
    moved = abs(in_doubles(exact).p - mesh.p).max()
    assert moved < 0.02
