"""The checker of certificates: it needs nothing else, and the interval that it prints is about the file it reads."""

from __future__ import annotations

import ast
import runpy
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from study.certify import checker
from study.certify.certified import write

ROOT = Path(__file__).parents[2]
SMALL = Path(__file__).parent / "square-2.json.gz"
CERTIFICATES = [
    pytest.param(path, id=path.name, marks=() if path.name.startswith("bracket") else pytest.mark.slow)
    for path in sorted((ROOT / "examples" / "certificates").glob("*.json.gz"))
]
"""One is checked by the quick tests; `make certificates-check` checks all of them."""


def test_it_imports_the_standard_library_only() -> None:
    tree = ast.parse(Path(checker.__file__).read_text())
    names = [n.module or "" for n in ast.walk(tree) if isinstance(n, ast.ImportFrom)]
    names += [alias.name for n in ast.walk(tree) if isinstance(n, ast.Import) for alias in n.names]
    assert {name.partition(".")[0] for name in names} <= set(sys.stdlib_module_names)


def test_it_has_the_size_that_is_claimed_for_it() -> None:
    code_lines = runpy.run_path(str(ROOT / ".ci" / "budget.py"))["code_lines"]
    assert code_lines(Path(checker.__file__).read_text()) <= 830


def test_a_copy_of_the_file_checks_a_certificate_without_any_package(tmp_path: Path) -> None:
    copied = tmp_path / "check.py"
    copied.write_text(Path(checker.__file__).read_text())
    command = [sys.executable, "-I", "-S", str(copied), str(SMALL)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env={"PYTHONIOENCODING": "utf-8"})
    assert "8 cells, h = 0.5000: max ‖u − u_h‖_V in [0.0" in done.stdout


@pytest.mark.parametrize("path", CERTIFICATES)
def test_committed_certificates_prove_positive_intervals(path: Path) -> None:
    found = checker.verified(checker.load(path))
    assert 0 < found.low < found.high < 10 * found.low


def test_what_is_proved_is_known(plain: checker.Enclosure, computed_bounds: dict[str, float]) -> None:
    assert {name: float(getattr(plain, name)) for name in computed_bounds} == pytest.approx(computed_bounds, rel=1e-6)


def test_the_level_is_not_believed(certificate: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """What is printed is counted on the mesh: 8 cells of the unit square, h = √(2/8)."""
    assert checker.main([str(write(tmp_path / "other-level.json.gz", certificate | {"level": 64}))]) == 0
    assert "    8 cells, h = 0.5000: max ‖u − u_h‖_V in [0.00392611, 0.27550807]" in capsys.readouterr().out


def test_u_h_is_what_the_interval_is_about(certificate: Any, plain: checker.Enclosure) -> None:
    """An error that is added to u_h at a vertex inside the body moves the interval by as much."""
    mesh = certificate["mesh"]
    (place,) = set(range(len(mesh["points"]))) - {v for side in mesh["sides"] for v in side}
    for u in certificate["computed"]:
        u[2 * place] += 1.0
    assert checker.verified(certificate).low > plain.high + 1 / 2


def test_certificates_of_two_problems_give_no_order(certificate: Any, tmp_path, capsys) -> None:
    first = write(tmp_path / "one.json.gz", certificate)
    certificate["problem"]["loads"] = {}
    certificate["stress"]["tractions"] = [row[:8] + row[24:] for row in certificate["stress"]["tractions"]]
    other = write(tmp_path / "other.json.gz", certificate)
    assert checker.main([str(first), str(other)]) == 1
    assert "its problem differs from the problem of the first file" in capsys.readouterr().out
