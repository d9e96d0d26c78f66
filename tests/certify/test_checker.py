"""The checker of certificates: it needs nothing else, rounds outward and refuses what proves nothing."""

from __future__ import annotations

import ast
import math
import runpy
import subprocess
import sys
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from study.bound.growth import Sizes, grow
from study.bound.growth import Step as StepFloat
from study.certify import checker
from study.certify.certified import differences, write
from study.certify.checker import RefusedError

HERE = Path(__file__).parents[2] / "examples" / "certificates"
CERTIFICATES = [
    pytest.param(path, id=path.name, marks=() if path.name.startswith("bracket") else pytest.mark.slow)
    for path in sorted(HERE.glob("*.json.gz"))
]
"""One is checked by the quick tests; `make certificates-check` checks all of them."""


def test_it_imports_the_standard_library_only() -> None:
    tree = ast.parse(Path(checker.__file__).read_text())
    names = [n.module or "" for n in ast.walk(tree) if isinstance(n, ast.ImportFrom)]
    names += [alias.name for n in ast.walk(tree) if isinstance(n, ast.Import) for alias in n.names]
    assert {name.partition(".")[0] for name in names} <= set(sys.stdlib_module_names)


def lines_of_code(text: str) -> int:
    """The lines of a program that hold something else than blanks, comments and docstrings."""
    strings = [
        node.value
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
    ]
    said = {n for node in strings for n in range(node.lineno, (node.end_lineno or node.lineno) + 1)}
    lines = enumerate(text.splitlines(), 1)
    return sum(n not in said and bool(line.strip()) and not line.strip().startswith("#") for n, line in lines)


def test_it_has_the_size_that_is_claimed_for_it() -> None:
    assert lines_of_code('"""A doc\nstring."""\n\n# Why.\nx = 1  # So.\n"""Of x."""\ny = """\ntext"""\n') == 3
    assert lines_of_code(Path(checker.__file__).read_text()) <= 830


def test_a_copy_of_the_file_checks_a_certificate_without_any_package(tmp_path: Path) -> None:
    copied = tmp_path / "check.py"
    copied.write_text(Path(checker.__file__).read_text())
    command = [sys.executable, "-I", "-S", str(copied), str(Path(__file__).parent / "square-2.json.gz")]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env={"PYTHONIOENCODING": "utf-8"})
    assert "8 cells, h = 0.5000: max ‖u − u_h‖_V in [0.0" in done.stdout


def test_the_program_checks_the_files_that_follow_its_name(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["checker.py", str(Path(__file__).parent / "square-2.json.gz")])
    with pytest.raises(SystemExit, match=r"^0$"):
        runpy.run_path(checker.__file__, run_name="__main__")
    assert "8 cells, h = 0.5000" in capsys.readouterr().out


@pytest.mark.parametrize("path", CERTIFICATES)
def test_committed_certificates_prove_positive_intervals(path: Path) -> None:
    found = checker.verified(checker.load(path))
    assert 0 < found.low < found.high < 10 * found.low


def edit(*keys: Any, to: Any = None, by: Callable[[Any], Any] | None = None) -> Callable[[Any], None]:
    """Change one entry."""

    def change(data: Any) -> None:
        for key in keys[:-1]:
            data = data[key]
        data[keys[-1]] = by(data[keys[-1]]) if by else to

    return change


def stated(data: Any) -> checker.Mesh:
    return checker.Mesh.of(data["mesh"], checker.Problem(data["problem"]))


def at_time(rows: list[list[int]], time: int, place: int, to: int) -> list[list[int]]:
    """Rows, given by their second differences, of which one has another number."""
    plain = checker.summed(rows)
    plain[time][place] = to
    return differences(plain)


def hang_a_node(data: Any) -> None:
    """Cut a cell in two without its neighbour."""
    mesh = data["mesh"]
    boundary = stated(data).boundary
    n, (a, b, c) = next((n, cell) for n, cell in enumerate(mesh["cells"]) if tuple(cell[:2]) not in boundary)
    mesh["denominator"] *= 2
    mesh["points"] = [[2 * x, 2 * y] for x, y in mesh["points"]]
    p, q = mesh["points"][a], mesh["points"][b]
    mesh["points"].append([(p[0] + q[0]) // 2, (p[1] + q[1]) // 2])
    mesh["cells"][n : n + 1] = [[a, len(mesh["points"]) - 1, c], [len(mesh["points"]) - 1, b, c]]
    data["computed"] = [[*u, 0.0, 0.0] for u in data["computed"]]


def numbers_on(data: Any, kind: str) -> int:
    """The place of the second component of a vertex on a part, away from its ends."""
    edges = [edge for edge, side in stated(data).boundary.items() if side.kind == kind]
    inner = [v for edge in edges for v in edge if sum(v in other for other in edges) == 2]
    return 2 * inner[0] + 1


def enter_the_foundation(data: Any) -> None:
    # Γ3 is the bottom.
    moved, place = data["displacement"], numbers_on(data, "contact")
    moved["nodes"] = at_time(moved["nodes"], -1, place, -1)


def leave_the_wall(data: Any) -> None:
    moved, place = data["displacement"], numbers_on(data, "clamped")
    moved["nodes"] = at_time(moved["nodes"], 0, place, 1)


def move_u_h_on_the_wall(data: Any) -> None:
    data["computed"][1][numbers_on(data, "clamped")] = 2.0**-60


def pull_on_the_foundation(data: Any) -> None:
    data["stress"]["tractions"] = at_time(data["stress"]["tractions"], 2, 0, 1)


def shorter(rows: list[list[int]]) -> list[list[int]]:
    return [row[:-1] for row in rows]


def squeezed(column: list[int]) -> list[int]:
    """A stress of the element that is 0 on its sides, and not in balance: X Y (1 − X − Y) in the third component."""
    bubble = {(1, 1, 0): 1, (2, 1, 0): -1, (1, 2, 0): -1}
    return [0] * 60 + [bubble.get(key, 0) for key in checker.CUBIC] * 3


TAMPERED: dict[str, tuple[Callable[[Any], None], str]] = {
    "ũ enters the foundation": (enter_the_foundation, "ũ_ν > 0 on Γ3"),
    "ũ leaves the wall": (leave_the_wall, "ũ does not vanish on Γ1"),
    "u_h leaves the wall": (move_u_h_on_the_wall, "u_h does not vanish on Γ1"),
    "the foundation pulls": (pull_on_the_foundation, "σ̃_ν > 0 on Γ3"),
    "a cell is missing": (edit("mesh", "cells", by=lambda x: x[:-1]), "a boundary inside or outside|does not fit side"),
    "a cell is there twice": (edit("mesh", "cells", by=lambda x: [*x, x[0]]), "two cells lie on the same side"),
    "a cell is clockwise": (edit("mesh", "cells", 0, by=lambda x: x[::-1]), "not counter-clockwise"),
    "a hanging node": (hang_a_node, "a boundary inside or outside the polygon|does not fit side"),
    "a vertex off the boundary": (edit("mesh", "points", 1, 1, by=lambda y: y - 1), "does not fit|boundary inside"),
    "a clockwise polygon": (edit("problem", "vertices", by=lambda v: v[::-1]), "the polygon is not counter-clockwise"),
    "a polygon that meets itself": (edit("problem", "vertices", 2, to=["-1", "1/2"]), "meet|not counter-clockwise"),
    "no wall": (edit("problem", "kinds", 2, to="loaded"), "no part is clamped"),
    "A is not elliptic": (edit("problem", "A", 0, 0, to="0"), "A is not symmetric and positive definite"),
    "A is not symmetric": (edit("problem", "A", 0, 1, to="1/3"), "A is not symmetric and positive definite"),
    "G is not monotone": (edit("problem", "G", 2, 2, to="-1"), "G is not symmetric and positive semidefinite"),
    "too much damping": (edit("m", to="2001/1000"), "G − mA is not positive semidefinite"),
    "negative damping": (edit("m", to="-1"), "m is negative"),
    "a smaller constant in Ω": (edit("constants", "volume", by=lambda x: str(2 * Fraction(x))), "constant of forces"),
    "a smaller constant on Γ2": (edit("constants", "surface", by=lambda x: str(2 * Fraction(x))), "constant of loads"),
    "another tensor field": (edit("constants", "field", 3, 0, by=lambda x: x + 2**28), "the tensor field does not"),
    "a stress is missing": (edit("stress", "tractions", by=lambda x: x[:-1]), "one stress for every"),
    "a traction is missing": (edit("stress", "tractions", by=shorter), "tractions have another size"),
    "a traction of one time is missing": (edit("stress", "tractions", 0, by=lambda x: x[:-1]), "equal lengths"),
    "an inner number is missing": (edit("stress", "inner", by=shorter), "the inner numbers have another size"),
    "a traction is not finite": (edit("stress", "tractions", 3, 20, to=math.nan), "is nan, but must be an integer"),
    "ũ has too few numbers": (edit("displacement", "nodes", by=shorter), "ũ has another size"),
    "tractions of the element differ": (edit("element", "columns", 7, 31, by=lambda x: x + 1), "tractions of the ref"),
    "tractions in the element jump": (edit("element", "columns", 40, 3, by=lambda x: x + 1), "reference element"),
    "the element does not balance": (edit("element", "columns", 40, by=squeezed), "does not balance"),
    "a side is short": (edit("mesh", "sides", 0, by=lambda x: x[:-1]), "does not fit side 0"),
    "u_h has nodes inside halves of pieces of ũ": (edit("computed", by=lambda u: [*u, u[-1]]), "u_h has a node inside"),
    "f_0 with a kink": (edit("problem", "force", 1, 0, 2, to=1), "f_0 with kinks"),
    "f_2 on Γ3": (edit("problem", "loads", by=lambda x: {"0": x["1"]}), "which is not of Γ2"),
    "time runs backwards": (edit("problem", "T", to="-1"), "T is not positive"),
    "time does not run": (edit("problem", "T", to="0"), "T is not positive"),
    "u_0 off the wall": (edit("problem", "start", 0, to=[["1", 0, 0]]), "u_0 does not vanish on Γ1"),
    "u_0 in the foundation": (edit("problem", "start", 1, to=[["-1", 0, 0], ["1", 0, 1]]), "u_0ν ≤ 0 on Γ3"),
}


@pytest.mark.parametrize("tampered", TAMPERED, ids=str)
def test_what_is_tampered_with_is_refused(tampered: str, certificate: Any) -> None:
    change, message = TAMPERED[tampered]
    change(certificate)
    with pytest.raises(RefusedError, match=message):
        checker.verified(certificate)


def move_a_vertex(data: Any) -> None:
    mesh = stated(data)
    inner = next(v for v in range(len(mesh.points)) if not any(v in edge for edge in mesh.boundary))
    data["displacement"]["nodes"][1][2 * inner] += 2**36


CLAIMS = {
    "another load": edit("problem", "loads", "1", 0, 0, 0, 0, 0, to="-3"),
    "another force": edit("problem", "force", 1, 0, 0, 0, 0, by=lambda c: str(2 * Fraction(c))),
    "another start": edit("problem", "start", 1, to=[["1/10", 0, 0], ["-1/10", 0, 1]]),
    "a traction moved": edit("stress", "tractions", 3, 40, by=lambda x: x + 2**34),
    "an inner number moved": edit("stress", "inner", 3, 40, by=lambda x: x + 2**12),
    "ũ moved": move_a_vertex,
}


@pytest.mark.parametrize("claim", CLAIMS, ids=str)
def test_witnesses_of_something_else_prove_less(claim: str, certificate: Any, plain: checker.Enclosure) -> None:
    """They stay true: an interval is wider, by what they do not fit."""
    CLAIMS[claim](certificate)
    assert checker.verified(certificate).last > plain.last


def test_what_is_proved_is_known(plain: checker.Enclosure, computed_bounds: dict[str, float]) -> None:
    assert {name: float(getattr(plain, name)) for name in computed_bounds} == pytest.approx(computed_bounds, rel=1e-6)


def test_the_level_is_not_believed(certificate: Any, plain: checker.Enclosure, tmp_path, capsys) -> None:
    """What is printed is counted on the mesh: 8 cells of the unit square, h = √(2/8)."""
    path = write(tmp_path / "other-level.json.gz", certificate | {"level": 64})
    assert checker.verified(checker.load(path)) == plain
    assert (plain.cells, float(plain.h)) == (8, 0.5)
    assert checker.main([str(path)]) == 0
    assert "    8 cells, h = 0.5000: max" in capsys.readouterr().out


def test_u_h_is_what_the_interval_is_about(certificate: Any, plain: checker.Enclosure) -> None:
    """An error that is added to u_h moves the interval by as much."""
    place = numbers_on(certificate, "contact")
    for u in certificate["computed"]:
        u[place] += 1.0
    assert checker.verified(certificate).low > plain.high + 1 / 2


def test_certificates_of_two_problems_give_no_order(certificate: Any, tmp_path, capsys) -> None:
    first = write(tmp_path / "one.json.gz", certificate)
    certificate["problem"]["loads"] = {}
    certificate["stress"]["tractions"] = [row[:8] + row[24:] for row in certificate["stress"]["tractions"]]
    other = write(tmp_path / "other.json.gz", certificate)
    assert checker.main([str(first), str(other)]) == 1
    assert "its problem differs from the problem of the first file" in capsys.readouterr().out


def test_the_bound_grows_as_that_of_the_study(certificate: Any) -> None:
    problem = checker.Problem(certificate["problem"])
    growth, rng = checker.Growth(problem, Fraction(2)), np.random.default_rng(1)
    for y in (0.0, 0.01, 1.0):
        rho = rng.normal(size=(3, 5))
        M = [[Fraction(float(c)) for c in row] for row in rho @ rho.T]
        k, contact, loads = Fraction(1, 8), Fraction(1, 1000), Fraction(1, 100)
        found = growth(Fraction(y), k, M, contact, loads)
        A, G = (np.array([[float(c) for c in row] for row in m]) for m in (problem.A, problem.G))
        values, v = np.linalg.eig(np.linalg.solve(A, G))
        v = v / np.sqrt(np.einsum("ij,ik,kj->j", v, A, v))
        squares = np.einsum("Ii,IJ,Ji->i", v, rho @ rho.T, v) / float(k)
        sizes = Sizes(squares[:, None], np.zeros(1), float(contact / k), float(loads / k))
        # Largest values, of which the checker knows nothing, are not of use here.
        added = StepFloat(float(k), sizes, Sizes(4 * sizes.residual, np.zeros(1), 4 * sizes.contact, 2 * sizes.rest))
        assert [float(x) for x in found] == pytest.approx(grow(y, values, added), rel=1e-8)
