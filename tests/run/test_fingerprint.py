"""The cache key of a result: it changes with computing code, versions and problems, and not with words."""

from __future__ import annotations

import shutil
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from study.fem.naming import resolve
from study.run import fingerprint as keys
from study.run.fingerprint import COMPUTING, ROOT, fingerprint, of_everything, problem
from study.statements.enclosure import resolve_problem
from study.statements.prop_5_4 import FirstOrder, RateSetting
from study.statements.shared.base import Setting
from study.statements.thm_4_2 import SameMesh

SETTING = RateSetting("full-contact", "shaken", 4, "midpoint", 8)


COMPUTE = (
    *("study/fem/space.py", "study/solve/steps.py", "manufactured/case.py", "study/statements/prop_5_4.py"),
    *("manufactured/cases/full_contact.py", "manufactured/cases/laws.py", "study/statements/shared/norms.py"),
)
"""Modules on which the order of convergence for the case *full-contact* depends."""
REST = (
    *("study/ledger/text.py", "study/run/executor.py", "study/cli/run.py", "manufactured/catalogue.py"),
    *("manufactured/cases/corner.py", "study/statements/korn.py", "study/statements/__init__.py"),
)
"""Other modules, among them another case, another statement and the lists of cases and statements."""
CACHED = ("code_hash", "measuring_code", "_modules", "_imported", "_code")


@pytest.fixture
def copied(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Some modules of the project below another root, of which the hash is computed."""
    for module in (*COMPUTE, *REST):
        (tmp_path / module).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / module, tmp_path / module)
    monkeypatch.setattr(keys, "ROOT", tmp_path)
    for name in CACHED:
        monkeypatch.setattr(keys, name, cache(getattr(keys, name).__wrapped__))
    return tmp_path


def test_a_change_of_computing_code_changes_the_key_and_a_change_of_words_does_not(copied: Path) -> None:
    def keys_after(old: str, new: str, *modules: str) -> tuple[str, str]:
        """The cache keys of a measurement, and of all that depends on any code, after a change of modules."""
        texts = {copied / module: (copied / module).read_text(encoding="utf-8") for module in modules}
        for path, text in texts.items():
            assert old in text, (path, old)
            path.write_text(text.replace(old, new, 1), encoding="utf-8")
        for name in CACHED:
            getattr(keys, name).cache_clear()
        found = fingerprint(FirstOrder(), SETTING), of_everything()
        for path, text in texts.items():
            path.write_text(text, encoding="utf-8")
        return found

    every = (*COMPUTE, *REST)
    before = keys_after("", "")
    assert keys_after('"""', '"""In other words: ', *every) == before
    assert keys_after("\n\n", "\n# A comment.\n\n", *every) == before
    for module in every:
        measured, everything = keys_after("\nfrom ", "\nCHANGED = 1\nfrom ", module)
        assert (measured != before[0]) == (module in COMPUTE)
        assert everything != before[1]
    measured, everything = keys_after("positive_at_most(0.02", "positive_at_most(0.03", "study/statements/prop_5_4.py")
    assert measured == before[0], "a changed window measures nothing anew"
    assert everything != before[1]


def test_all_packages_below_the_statements_are_part_of_the_key() -> None:
    hashed = {path.relative_to(ROOT).parts[:2] for pattern in COMPUTING for path in ROOT.glob(pattern)}
    packages = "fem solve stresses bound statements ledger"
    assert {package for top, package in hashed if top == "study"} == set(packages.split())
    assert "manufactured" in {top for top, _ in hashed}


def test_other_versions_of_libraries_change_the_key(monkeypatch: pytest.MonkeyPatch) -> None:
    before = fingerprint(FirstOrder(), SETTING)
    assert fingerprint(FirstOrder(), SETTING) == before
    monkeypatch.setattr(keys, "versions", lambda: {"numpy": "another"})
    assert fingerprint(FirstOrder(), SETTING) != before


def test_measurements_that_differ_in_one_respect_have_different_keys() -> None:
    changes = {"case": "no-contact", "family": "one-diagonal", "level": 5, "scheme": "bdf2", "steps": 9}
    others = [replace(SETTING, **{name: value}) for name, value in changes.items()]
    keys = {fingerprint(FirstOrder(), setting) for setting in (SETTING, *others)}
    keys.add(fingerprint(SameMesh(), Setting("full-contact", "shaken", 4)))
    assert len(keys) == len(changes) + 2


MINE = """
from dataclasses import replace
from functools import cache
from manufactured import named

FACTOR = 1
mine = replace(named("advance-recede"), name="mine", pace=PACE)
"""


def test_a_users_case_is_known_by_its_value_and_its_file_wherever_it_lies(tmp_path: Path) -> None:
    def key_of(folder: str, text: str) -> str:
        (tmp_path / folder).mkdir(exist_ok=True)
        file = tmp_path / folder / "mine.py"
        file.write_text(text, encoding="utf-8")
        for cached in (resolve, resolve_problem, problem):
            cached.cache_clear()
        return fingerprint(FirstOrder(), RateSetting(f"{file}:mine", "shaken", 4, "midpoint", 8))

    text = MINE.replace("PACE", "3")
    before = key_of("here", text)
    assert key_of("there", text) == before
    assert key_of("here", "# A comment." + text) == before
    for other in (text.replace("FACTOR = 1", "FACTOR = 2"), text.replace("pace=3", "pace=2")):
        assert key_of("here", other) != before
    assert key_of("here", text.replace("advance-recede", "travelling-patch")) != before
