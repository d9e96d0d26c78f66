"""The checker stands alone, judges the file that it reads, and proves what ``study bound`` computes."""

import runpy
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from bodies import CLAMPED, CONTACT, LAW, LOADED, YIELDS
from costly_cases import slow, slow_unless
from places import CERTIFICATES, ROOT
from sympy import Rational, sin, sqrt

from manufactured import (
    Data,
    KelvinVoigt,
    isotropic,
    polygon,
    pos,
    t,
    unit_square,
    x1,
)
from manufactured.factor import layers, x2
from manufactured.law import Linear as Tensor
from study.bound.bounded import bounded_solution
from study.bound.problem import BoundError
from study.bound.trajectory import Refined
from study.certify import certified, checker
from study.certify.certified import check_certifiable, make_certificate, write
from study.certify.statement import in_doubles, rational, rational_mesh, statement, voigt
from study.fem.mesh import OneDiagonal, Shaken, Unstructured
from study.ledger.files import write_text
from study.solve.tableau import MIDPOINT

SMALL = Path(__file__).parent / "square-2.json.gz"
COMMITTED = [
    slow_unless(path.name.startswith("bracket"), path, id=path.name) for path in sorted(CERTIFICATES.glob("*.json.gz"))
]
"""One is checked by the quick tests; `make certificates-check` checks all of them."""


def test_it_has_the_size_that_is_claimed_for_it():
    weigh = runpy.run_path(str(ROOT / ".ci" / "weight.py"))["weigh"]
    assert weigh(Path(checker.__file__).read_text()).lines <= 830


def test_a_copy_of_the_file_checks_a_certificate_without_any_package(tmp_path):
    copied = tmp_path / "check.py"
    copied.write_text(Path(checker.__file__).read_text())
    command = [sys.executable, "-I", "-S", str(copied), str(SMALL)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env={"PYTHONIOENCODING": "utf-8"})
    assert "8 cells, h = 0.5000: max ‖u − u_h‖_V in [0.0" in done.stdout


@pytest.mark.parametrize("path", COMMITTED)
def test_committed_certificates_prove_positive_intervals(path):
    found = checker.verified(checker.load(path))
    assert 0 < found.low < found.high < 10 * found.low


def test_certificates_of_two_problems_give_no_order(certificate, tmp_path, capsys):
    first = write(tmp_path / "one.json.gz", certificate)
    certificate["problem"]["loads"] = {}
    certificate["stress"]["tractions"] = [row[:8] + row[24:] for row in certificate["stress"]["tractions"]]
    other = write(tmp_path / "other.json.gz", certificate)
    assert checker.main([str(first), str(other)]) == 1
    assert "its problem differs from the problem of the first file" in capsys.readouterr().out


FUNCTIONS = runpy.run_path(str(CERTIFICATES / "problems.py"))
PROBLEMS = {name: FUNCTIONS[name]() for name in ("square", "wedge", "bracket")}


@pytest.fixture(autouse=True, scope="module")
def constants_of_a_coarse_mesh():
    """The semidefinite programme is most of what a small certificate costs."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(certified, "CONSTANTS_LEVEL", 3)
        yield


@pytest.mark.parametrize("name", PROBLEMS)
def test_committed_certificates_state_the_problems_beside_them(name):
    assert checker.load(CERTIFICATES / f"{name}-4.json.gz")["problem"] == statement(PROBLEMS[name])


TWO_FACES = polygon([(0, 0), (2, 0), (3, 1), (3, 2), (0, 2)], [CONTACT, CONTACT, LOADED, CLAMPED, LOADED])
IRRATIONAL = polygon([(0, 0), (1, -(0.3**0.5)), (1, 1), (0, 1)], [CONTACT, LOADED, LOADED, CLAMPED])


PUSHED = {"f0": (0, 0), "f2": {2: (-t, -2 * t)}}
COMPUTED = {
    "a square": (PROBLEMS["square"], OneDiagonal(), 2, 1e-6),
    "two faces that meet": (Data.formulas(TWO_FACES, LAW, **PUSHED), Unstructured(), 3, 0.01),
    "irrational slope": (Data.formulas(IRRATIONAL, LAW, **PUSHED), Unstructured(), 3, 0.01),
}
"""Data, mesh and the relative accuracy with which the certificate repeats the computed interval."""


@pytest.mark.parametrize("name", COMPUTED)
def test_what_is_proved_is_what_is_computed(name, plain):
    data, family, level, accuracy = COMPUTED[name]
    steps = MIDPOINT, 2, Refined(0, 1)
    computed = bounded_solution(data, None, family, level, *steps).enclosure
    bounds = pytest.approx([computed.lowest, computed.highest, computed.bound[-1]], rel=accuracy)
    proofs = [checker.verified(make_certificate(data, family, level, *steps)), *[plain] * (name == "a square")]
    assert [[float(x) for x in (proof.low, proof.high, proof.last)] for proof in proofs] == [bounds] * len(proofs)


def formulas(f0=(0, 0), law=LAW, **more):
    return Data.formulas(unit_square(), law, f0=f0, **more)


def loaded(f2):
    return formulas(f2={1: (f2, 0)})


LAYERS = KelvinVoigt(isotropic(1, 0.5, factor=layers((0, 1), 0.5, 2)), isotropic(1, 1), "layers")
REFUSED = {
    "f_0 has .*support polynomials": formulas((0, sin(x1))),
    "coefficients are not rational": formulas((0, sqrt(3) * t)),
    "f_0 has a kink": formulas((0, pos(x1 - t, 3))),
    "f_2 has the summand": loaded(pos(t - Rational(1, 2), 1) * pos(x2 - t, 2)),
    "u_0 has .*support polynomials": formulas(u0=(0, (1 - x2) * pos(x1 - Rational(1, 2), 2))),
    "G is not linear and uniform": formulas(law=YIELDS),
    "A is not linear and uniform": formulas(law=LAYERS),
    # The checker would refuse these.
    "no certificate can be made of this problem: .*integer from 0 to 10": formulas((0, x1**11)),
    "no certificate can .*integer from 0 to 10": loaded(pos(x2 - t, 11)),
    "no certificate can .*u_0ν ≤ 0 on Γ3 cannot be shown": formulas(u0=(0, (x2 - 1) * x1)),
}


@pytest.mark.parametrize(("message", "data"), REFUSED.items())
def test_what_is_not_served_is_refused_in_words_before_it_is_computed(data, message):
    with pytest.raises(BoundError, match=message):
        check_certifiable(data)


def test_cases_are_refused_by_the_command(refused):
    assert "certificates support data that are formulas" in refused("certify full-contact")


@pytest.mark.parametrize("name", ["bracket", slow("wedge")])
def test_the_command_writes_certificates_checks_them_and_keeps_none_of_another_problem(name, told, tmp_path):
    out = tmp_path / name
    for file, content in ((".lock", ""), ("problem.txt", "another problem"), ("../certificate-9.json.gz", "")):
        write_text(out / "data" / file, content)
    options = f"--levels 2 3 --steps 2 --refine 0 --shorter 1 --out {tmp_path}"
    said = told(f"certify {CERTIFICATES}/problems.py:{name} {options}", 0)
    assert said.count("cells, h = ") == 2
    assert f"removed from {out}: results of other data" in said
    assert {path.name for path in out.glob("*.gz")} == {"certificate-2.json.gz", "certificate-3.json.gz"}


def test_more_refinements_than_the_checker_accepts_are_refused(refused):
    said = refused(f"certify {CERTIFICATES}/problems.py:square --refine 9")
    assert "--refine 9: a certificate allows at most 8 refinements" in said


def test_doubles_are_read_as_the_fractions_that_are_meant():
    assert rational(0.8) == Fraction(4, 5)
    assert rational(1 / 3) == Fraction(1, 3)
    assert rational(3**0.5) == Fraction(3**0.5)
    root = 2**0.5
    matrix = voigt(Tensor(np.array([[3, 1, 0.3 * root], [1, 2, 0], [0.3 * root, 0, 2 * 0.7]])).matrix)
    assert matrix[0][2] == Fraction(3, 10)
    assert matrix[2][2] == Fraction(7, 10)


def test_loads_are_read_as_they_are():
    push = 4 * t * pos(1 - (x1 - t / 2) ** 2, 3) + x1 * t**2
    formula = checker.formula(statement(loaded(push))["loads"]["1"][0])
    for place in ((0.5, 1.0, 0.25), (1.75, 0.0, 0.5), (0.0, 0.5, 1.0)):
        wanted = float(push.subs(dict(zip((x1, x2, t), place, strict=True))))
        exact = [checker.constant(Fraction(c)) for c in place]
        (value,) = checker.total(term(*exact).plain() for term in formula).values()
        assert value == pytest.approx(wanted, abs=1e-14)


@pytest.mark.parametrize("family", [OneDiagonal(), Shaken(), Unstructured()])
def test_meshes_are_those_of_the_families_up_to_a_little(family):
    data = PROBLEMS["wedge"]
    mesh = family(data.body, 4)
    exact = checker.Mesh.of(rational_mesh(mesh, data.body), checker.Problem(statement(data)))
    assert abs(in_doubles(exact).p - mesh.p).max() < 0.02
