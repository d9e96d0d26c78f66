"""What is installed: the exact solutions with NumPy and SymPy, the study as an extra, and what says who made it."""

import doctest
import importlib
import json
import pkgutil
import re
import subprocess
import sys
import tomllib

import pytest
import yaml
from commands import python
from places import ROOT

import manufactured
from study.cli.main import LACKING

PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PROJECT = PYPROJECT["project"]
PINS = {
    path.stem: dict(re.findall(r"^([\w-]+)==([\w.]+)", path.read_text(encoding="utf-8"), re.MULTILINE))
    for path in (ROOT / "requirements").iterdir()
}
EXTRAS = {"study": "runtime", "cluster": "cluster", "film": "film"}
GROUPS = {"dev": "development", "docs": "documentation"}


def names(requirements):
    return {re.split(r"[<>=\[ ]", requirement)[0] for requirement in requirements}


def test_the_base_is_numpy_and_sympy_the_study_needs_forty_packages_and_each_package_has_one_version():
    assert names(PROJECT["dependencies"]) == {"numpy", "sympy"}
    assert set(EXTRAS) == set(PROJECT["optional-dependencies"])
    assert set(GROUPS) == set(PYPROJECT["dependency-groups"])
    needed = PROJECT["optional-dependencies"] | PYPROJECT["dependency-groups"]
    assert set(PINS) == {*EXTRAS.values(), *GROUPS.values()}
    for part, file in (EXTRAS | GROUPS).items():
        assert names(needed[part]) <= set(PINS[file])
    assert len(PINS["runtime"]) <= 40
    assert set(PINS["runtime"]).isdisjoint({"pytest", "ruff", "mypy", "sphinx", "distributed", "selenium"})
    versions = {(package, version) for pins in PINS.values() for package, version in pins.items()}
    assert len(versions) == len({package for package, _ in versions})


def test_manufactured_imports_nothing_else():
    asked = (
        "import importlib, pkgutil, sys, manufactured\n"
        "for m in pkgutil.walk_packages(manufactured.__path__, 'manufactured.'): importlib.import_module(m.name)\n"
        "print(*{name.partition('.')[0] for name in sys.modules})"
    )
    printed, _ = python(asked)
    others = names(PROJECT["optional-dependencies"]["study"]) - {"numpy", "sympy"}
    imported = {name.replace("-", "_") for name in others} | {"skfem", "PIL", "study"}
    assert set(printed.split()) & imported == set()


def test_examples_in_docstrings_are_true():
    modules = [module.name for module in pkgutil.walk_packages(manufactured.__path__, "manufactured.")]
    assert [name for name in modules if doctest.testmod(importlib.import_module(name)).failed] == []


@pytest.mark.slow
def test_the_wheel_of_the_source_distribution_works_with_numpy_and_sympy_alone():
    done = subprocess.run(["make", "dist"], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    said = r"run with convergence-orders \S+ mpmath \S+ numpy (\S+), signorini-study \S+ sympy \S+"
    runs = re.findall(said, done.stdout)
    assert runs[1:] == ["1.24.2"] * (sys.version_info[:2] == (3, 11))


@pytest.mark.parametrize(
    ("command", "lacking", "source"),
    [
        ("cases", "scipy.sparse", "'.[study]'"),
        ("rates errors.csv", "convergence_orders", "./convergence_orders"),
    ],
)
def test_a_command_without_a_package_says_how_to_install_it(command, lacking, source, told, monkeypatch):
    def without(name):
        raise ModuleNotFoundError(f"No module named '{lacking}', for {name}", name=lacking)

    monkeypatch.setattr("importlib.import_module", without)
    assert told(command) == f"study: {LACKING.format(lacking, source)}\n"


def test_everything_that_says_what_this_is_says_the_same():
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    deposited = json.loads((ROOT / ".zenodo.json").read_text(encoding="utf-8"))
    (newest, *_) = re.findall(r"^## \[(.+?)\]", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)
    (holder,) = re.findall(r"Copyright \(c\) \d{4} (.+)", (ROOT / "LICENSE").read_text())
    assert {"cff-version", "message", "title", "authors"} <= set(cited)
    assert cited["version"] == PROJECT["version"] == newest
    assert cited["license"] == PROJECT["license"] == deposited["license"]
    assert cited["title"] == deposited["title"]
    assert " ".join(cited["abstract"].split()) == deposited["description"]
    assert cited["keywords"] == PROJECT["keywords"] == deposited["keywords"]
    assert cited["authors"] == PROJECT["authors"] == deposited["creators"] == [{"name": holder}]
