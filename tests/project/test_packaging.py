"""What is installed: the exact solutions with NumPy and SymPy, the study as an extra, and what says who made it."""

import doctest
import importlib
import json
import pkgutil
import re
import subprocess
import sys
import tomllib
from importlib.metadata import distributions, metadata
from pathlib import Path

import pytest
import yaml
from packaging.specifiers import SpecifierSet
from packaging.utils import canonicalize_name

import manufactured
from study.cli.main import LACKING, main

ROOT = Path(__file__).parents[2]
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PROJECT = PYPROJECT["project"]
PINS = {
    path.stem: dict(re.findall(r"^([\w-]+)==([\w.]+)", path.read_text(encoding="utf-8"), re.MULTILINE))
    for path in (ROOT / "requirements").iterdir()
}
EXTRAS = {
    **{"study": "runtime", "dev": "development"},
    **{"docs": "documentation", "cluster": "cluster", "film": "film"},
}


def names(requirements: list[str]) -> set[str]:
    return {re.split(r"[<>=\[ ]", requirement)[0] for requirement in requirements}


def test_the_base_is_numpy_and_sympy_the_study_needs_forty_packages_and_each_package_has_one_version() -> None:
    assert names(PROJECT["dependencies"]) == {"numpy", "sympy"}
    assert set(EXTRAS) == set(PROJECT["optional-dependencies"])
    assert set(PINS) == set(EXTRAS.values())
    for extra, file in EXTRAS.items():
        assert names(PROJECT["optional-dependencies"][extra]) <= set(PINS[file])
    assert len(PINS["runtime"]) <= 40
    assert set(PINS["runtime"]).isdisjoint({"pytest", "ruff", "mypy", "sphinx", "distributed", "selenium"})
    versions = {(package, version) for pins in PINS.values() for package, version in pins.items()}
    assert len(versions) == len({package for package, _ in versions})


def test_every_pinned_package_runs_on_the_oldest_python_that_the_project_names() -> None:
    oldest = PROJECT["requires-python"].removeprefix(">=") + ".0"
    # Some pins are for other systems or versions of Python, and are not installed.
    installed = {(canonicalize_name(found.name), found.version) for found in distributions()}
    pinned = {pin for pins in PINS.values() for pin in pins.items()}
    needed = {package: metadata(package).get("Requires-Python") for package, _ in pinned & installed}
    if len(needed) <= 0.9 * len(pinned):
        pytest.skip("other versions than the pinned ones are installed")
    assert [package for package, versions in needed.items() if oldest not in SpecifierSet(versions or "")] == []


def test_manufactured_imports_nothing_else() -> None:
    asked = (
        "import importlib, pkgutil, sys, manufactured\n"
        "for m in pkgutil.walk_packages(manufactured.__path__, 'manufactured.'): importlib.import_module(m.name)\n"
        "print(*{name.partition('.')[0] for name in sys.modules})"
    )
    done = subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True, check=True)
    others = names(PROJECT["optional-dependencies"]["study"]) - {"numpy", "sympy"}
    imported = {name.replace("-", "_") for name in others} | {"skfem", "PIL", "study"}
    assert set(done.stdout.split()) & imported == set()


def test_examples_in_docstrings_are_true() -> None:
    modules = [module.name for module in pkgutil.walk_packages(manufactured.__path__, "manufactured.")]
    assert [name for name in modules if doctest.testmod(importlib.import_module(name)).failed] == []


@pytest.mark.slow
def test_the_wheel_works_with_numpy_and_sympy_alone() -> None:
    done = subprocess.run(["make", "wheel"], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    said = r"run with convergence-orders \S+ mpmath \S+ numpy (\S+), signorini-study \S+ sympy \S+"
    runs = re.findall(said, done.stdout)
    assert runs[1:] == ["1.24.2"] * (sys.version_info[:2] == (3, 11))


@pytest.mark.parametrize(
    ("command", "lacking", "source"),
    [
        (["cases"], "scipy.sparse", "'.[study]'"),
        (["rates", "errors.csv"], "convergence_orders", "./convergence_orders"),
    ],
)
def test_a_command_without_a_package_says_how_to_install_it(command, lacking, source, capsys, monkeypatch) -> None:
    def without(name: str) -> None:
        raise ModuleNotFoundError(f"No module named '{lacking}', for {name}", name=lacking)

    monkeypatch.setattr("importlib.import_module", without)
    assert main(command) == 2
    assert capsys.readouterr().err == f"study: {LACKING.format(lacking, source)}\n"


def test_study_orders_without_its_package_says_how_to_install_it(monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "convergence_orders", None)
    monkeypatch.delitem(sys.modules, "study.orders", raising=False)
    with pytest.raises(ModuleNotFoundError, match=r"python -m pip install \./convergence_orders"):
        importlib.import_module("study.orders")


def test_the_wheel_says_that_its_packages_are_typed_and_has_the_texts_of_statements_without_a_measurement() -> None:
    for package in ("manufactured", "study"):
        assert "py.typed" in PYPROJECT["tool"]["setuptools"]["package-data"][package]
        assert (ROOT / package / "py.typed").is_file()
    assert "*.toml" in PYPROJECT["tool"]["setuptools"]["package-data"]["study.statements"]
    assert [path.name for path in ROOT.glob("study/statements/**/*.toml")] == ["unmeasured.toml"]


def test_everything_that_says_what_this_is_says_the_same() -> None:
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


def test_the_citation_of_the_paper_is_the_one_in_the_article() -> None:
    (paper,) = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))["references"]
    assert [author["family-names"] for author in paper["authors"]] == ["Barboteu", "Han", "Sofonea"]
    entry = (ROOT / "paper" / "references.bib").read_text().partition(paper["title"])[2].partition("@")[0]
    printed = {"number": paper["issue"], "pages": f"{paper['start']}--{paper['end']}"}
    for key, value in {**printed, "volume": paper["volume"], "year": paper["year"]}.items():
        assert f"{key} = {{{value}}}" in entry
