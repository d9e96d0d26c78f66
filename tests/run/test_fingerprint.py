"""What was measured is known by its code: what numbers depend on measures them anew, nothing else does."""

from __future__ import annotations

import ast
import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import FrameType

import pytest

from study.fem.naming import resolve
from study.run.code import BY_VALUE, NO_NUMBERS, ROOT, closure, digest, imports, source, without_docstrings
from study.run.fingerprint import fingerprint, modules_behind, problem
from study.run.job import Job
from study.run.plan import Plan, quick
from study.statements.green import Green
from study.statements.korn import Korn
from study.statements.prop_5_4 import FirstOrder, RateSetting
from study.statements.shared.base import Setting
from study.statements.thm_4_2 import SameMesh
from study.statements.thm_4_2_own_space import OwnSpace

PROGRAM = """
import gc
import json

gc.disable()

from dataclasses import replace
from study.run.plan import Plan, quick

scope = replace(quick(), cases=("full-contact", "advance-recede"))
print(json.dumps({job.key: job.fingerprint() for job in Plan.of(scope).jobs}))
"""
RATE, KORN = (
    "rates__advance-recede__one-diagonal__midpoint__00008",
    "statements__2.17__full-contact__one-diagonal__00004",
)


def fingerprints(root: Path) -> dict[str, str]:
    """Of all jobs of two cases of the quick study, by the code below a directory."""
    found = subprocess.run(
        [sys.executable, "-c", PROGRAM], cwd=root, env={"PYTHONPATH": str(root)}, capture_output=True, text=True
    )
    assert found.returncode == 0, found.stderr
    return json.loads(found.stdout)


@pytest.fixture(scope="module")
def copied(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The packages, to be changed."""
    root = tmp_path_factory.mktemp("code")
    for package in ("manufactured", "study"):
        shutil.copytree(ROOT / package, root / package, ignore=shutil.ignore_patterns("__pycache__"))
    return root


@pytest.fixture(scope="module")
def before(copied: Path) -> dict[str, str]:
    return fingerprints(copied)


@pytest.fixture
def anew(copied: Path, before: dict[str, str]) -> Callable[..., set[str]]:
    """(module, a text in it, what is put there), … ↦ the jobs that are measured anew."""

    def changed(*changes: tuple[str, str, str]) -> set[str]:
        files = {copied / source(module).relative_to(ROOT): (old, new) for module, old, new in changes}
        texts = {file: file.read_text(encoding="utf-8") for file in files}
        for file, (old, new) in files.items():
            assert old in texts[file], (file, old)
            file.write_text(texts[file].replace(old, new, 1), encoding="utf-8")
        try:
            after = fingerprints(copied)
        finally:
            for file, text in texts.items():
                file.write_text(text, encoding="utf-8")
        assert after.keys() == before.keys()
        return {key for key in before if after[key] != before[key]}

    return changed


def test_words_windows_and_figures_measure_nothing_anew(anew) -> None:
    assert (
        anew(
            ("study.fem.gauge", '"""', '"""In other words: '),
            ("study.fem.space", "\nclass ", "\n# A comment.\n\nclass "),
            ("study.statements.prop_5_4", "above_nothing(0.02", "above_nothing(0.03"),
            ("study.ledger.measures", "ENOUGH = 3", "ENOUGH = 4"),
            ("study.ledger.terminal", "WIDTH = 110", "WIDTH = 100"),
        )
        == set()
    )


def test_a_constant_of_a_quadrature_measures_all_anew_that_uses_it(anew, before: dict[str, str]) -> None:
    found = anew(("study.fem.gauge", "DEGREE, SOLID_DEGREE = 4", "DEGREE, SOLID_DEGREE = 5"))
    assert {key for key in before if key.startswith("rates__")} <= found


def test_what_one_statement_alone_uses_measures_no_other_anew(anew) -> None:
    found = anew(("study.statements.shared.eigen", "SMALLEST, LARGEST = 1e-9", "SMALLEST, LARGEST = 1e-8"))
    assert KORN in found
    assert RATE not in found


def test_strings_that_stand_alone_do_not_count_and_others_do() -> None:
    def tree(text: str) -> str:
        return ast.dump(without_docstrings(ast.parse(text)))

    assert tree('"""A."""\nx = 1\n"""B."""\ndef f():\n    """C."""\n    return 1') == tree(
        "x = 1\ndef f():\n    return 1"
    )
    assert tree("# a\nx = (1 +\n     2)") == tree("x = 1 + 2")
    assert tree('x = "a"') != tree('x = "b"')


def test_the_exact_solution_counts_by_value_and_by_the_code_of_its_types() -> None:
    assert problem("advance-recede") != problem("full-contact")
    assert problem("rotated") != problem("advance-recede")
    assert "manufactured.contact.contact_face" in modules_behind("advance-recede")
    assert any("singular" in module for module in modules_behind("re-entrant"))
    assert all(not module.startswith(BY_VALUE) for module in closure(modules_behind("advance-recede")))


def test_settings_that_differ_have_other_fingerprints() -> None:
    jobs = Plan.of(quick()).jobs
    assert len({job.fingerprint() for job in jobs}) == len(jobs)
    setting = RateSetting("full-contact", "shaken", 4, "midpoint", 8)
    assert fingerprint(FirstOrder(), setting) == fingerprint(FirstOrder(), setting)
    assert fingerprint(FirstOrder(), setting) != fingerprint(
        FirstOrder(), RateSetting(*list(vars(setting).values())[:4], 9)
    )


@pytest.mark.parametrize(
    "job",
    [
        Job(FirstOrder(), RateSetting("advance-recede", "one-diagonal", 4, "bdf2", 3)),
        Job(FirstOrder(), RateSetting("yield-and-release", "shaken", 4, "midpoint", 3)),
        Job(FirstOrder(), RateSetting("re-entrant", "graded", 4, "backward-euler", 3)),
        Job(SameMesh(), Setting("full-contact", "unstructured", 3)),
        Job(OwnSpace(), Setting("advance-recede", "one-diagonal", 4)),
        Job(Korn(), Setting("hexagon", "unstructured", 4)),
        Job(Green(), Setting("full-contact", "one-diagonal", 4)),
    ],
    ids=lambda job: job.key,
)
def test_every_module_whose_code_runs_in_a_measurement_counts(job: Job) -> None:
    measure = type(job.statement).measure.__module__
    counted = closure(frozenset({measure, *modules_behind(job.setting.case)}))
    solution = resolve(job.setting.case).solution
    assert solution is not None
    ran: set[str] = set()

    def notice(frame: FrameType, event: str, argument: object) -> None:
        if event == "call":
            ran.add(str(frame.f_globals.get("__name__")))

    sys.setprofile(notice)
    try:
        job.statement.measure(job.setting)
    finally:
        sys.setprofile(None)
    of_project = {module for module in ran if module.partition(".")[0] in ("manufactured", "study")}
    assert len(of_project) > 5
    assert {module for module in of_project - counted if not module.startswith((*BY_VALUE, *NO_NUMBERS))} == set()


def test_imports_are_followed_through_packages_and_within_functions() -> None:
    assert "study.fem.gauge" in imports("study.statements.prop_5_4")
    assert "study.fem.gauge" in closure(frozenset({"study.statements.prop_5_4"}))
    assert not any(
        module.startswith(("study.present", "study.cli")) for module in closure(frozenset({"study.run.plan"}))
    )


def test_a_module_of_a_users_case_counts_by_its_file(tmp_path: Path) -> None:
    text = "from manufactured.cases.full_contact import case\n\nLENGTH = 1\n"
    (tmp_path / "mine.py").write_text(text)
    resolve(f"{tmp_path / 'mine.py'}:case")
    assert digest("case_mine") == digest("case_mine")
    assert source("case_mine") == tmp_path / "mine.py"
