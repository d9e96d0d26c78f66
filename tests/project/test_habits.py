"""What the project says about itself is so: workflows, examples, recipes, documentation."""

import inspect
import re
import runpy
import shlex
import sys
import tomllib
from inspect import getdoc, getsource
from pathlib import Path
from types import ModuleType

import pytest
import yaml
from case_docstrings import missing_parts
from commands import study
from pages import PAGES, Page
from places import EXAMPLES, ROOT

import manufactured
from manufactured.cases import plane
from manufactured.catalogue import NAMES
from study.cli.main import parser
from study.controls import faults
from study.controls.matrix import distance_of_solutions
from study.solve.tableau import MIDPOINT
from study.statements.shared.base import Experiment, Setting

WORKFLOWS = [*sorted((ROOT / ".github/workflows").glob("*.yml")), EXAMPLES / "convergence-check.yml"]
RUN_THE_STUDY = ROOT / "docs/how-to/run-the-study.md"
TYPED = [ROOT / "README.md", RUN_THE_STUDY, ROOT / "CONTRIBUTING.md", EXAMPLES / "README.md"]
"""Pages whose commands have no words in capitals in place of a name."""
TARGETS = set(re.findall(r"^([a-z][a-z-]*):", (ROOT / "Makefile").read_text(), re.MULTILINE))


RECIPES = {
    text.splitlines()[0].removeprefix("# "): text
    for text in re.findall(r"```python\n(.*?)```", (ROOT / "CONTRIBUTING.md").read_text(), re.DOTALL)
}


def steps(workflow):
    return [step for job in yaml.safe_load(workflow.read_text())["jobs"].values() for step in job["steps"]]


def commands(path):
    """Every command line of a workflow, or of a page in shell blocks and within sentences, without redirections."""
    if path.suffix == ".yml":
        texts = [str(step["run"]) for step in steps(path) if "run" in step]
    else:
        texts = [*Page(path).typed, *re.findall(r"`((?:\.venv/bin/|make )[^`]+)`", path.read_text())]
    for line in "\n".join(texts).replace("\\\n", " ").splitlines():
        if words := shlex.split(line.partition(" > ")[0], comments=True):
            yield words


def module(monkeypatch, name):
    """The module of a recipe, as if its file were there."""
    found = ModuleType(name)
    monkeypatch.setitem(sys.modules, name, found)
    if name.startswith("study."):
        monkeypatch.setattr(name, found, raising=False)
    path = name.replace(".", "/") + ".py"
    exec(compile(RECIPES[path], path, "exec"), vars(found))
    return found


def added(path, module):
    """What a recipe adds to a module, by name."""
    found = {}
    exec(RECIPES[path], vars(module), found)
    return found


# Workflows.


def test_every_make_target_and_study_command_of_workflows_and_pages_exists():
    for path in [*WORKFLOWS, *(page.path for page in PAGES)]:
        for words in commands(path):
            if words[0] == "make":
                assert {word for word in words[1:] if "=" not in word} <= TARGETS, words
            elif Path(words[0]).name == "study" and path in (*WORKFLOWS, *TYPED):
                parser().parse_args(words[1:])


@pytest.mark.parametrize("workflow", WORKFLOWS)
def test_workflows_use_actions_of_a_fixed_commit_and_may_write_nothing(workflow):
    assert yaml.safe_load(workflow.read_text())["permissions"] == {"contents": "read"}
    used = re.findall(r"uses: (.+)", workflow.read_text())
    assert used and all(re.fullmatch(r"actions/[a-z-]+@[0-9a-f]{40} # v[\d.]+", action) for action in used)  # noqa: PT018


# The example for other projects.

TABLE = EXAMPLES / "errors.csv"


def test_the_example_prints_its_table_which_holds(tmp_path, capsys):
    runpy.run_path(str(EXAMPLES / "errors.py"), run_name="__main__")
    assert capsys.readouterr().out == TABLE.read_text()
    assert [study(f"rates {file} --expected 1") for file in (TABLE, tmp_path / "none.csv")] == [0, 2]


# The recipes of CONTRIBUTING.md.


@pytest.mark.slow
def test_the_case_of_the_recipe_is_new_and_holds_and_has_the_order_that_its_docstring_predicts(tmp_path, out):
    (recipe,) = added("manufactured/cases/plane.py", plane).values()
    case = recipe()
    assert missing_parts(getdoc(recipe), case) == []
    assert case.regularity.satisfies_5_36
    assert case.name not in NAMES
    path = tmp_path / "plane.py"
    path.write_text(getsource(plane) + RECIPES["manufactured/cases/plane.py"])
    assert study(f"run --case {path}:{recipe.__name__} --levels 8 16 32 --out {out}") == 0


def test_the_statement_of_the_recipe_holds_and_its_own_test_breaks_it(monkeypatch):
    module(monkeypatch, "study.statements.trace")
    recipe = module(monkeypatch, "tests.statements.test_trace")
    recipe.test_the_trace_on_contact_is_bounded_uniformly()
    recipe.test_sums_over_vertices_are_not(monkeypatch)


def test_the_fault_of_the_recipe_changes_what_is_solved():
    *_, fault = added("study/controls/faults.py", faults).values()
    assert fault.name not in {known.name for known in faults.FAULTS}
    right = Experiment.at(Setting("advance-recede", "one-diagonal", 4), MIDPOINT, 4)
    assert distance_of_solutions(right, fault.change(right, fault.sizes[0])) > 1e-6


def test_every_public_name_is_documented():
    """Constants are documented in the docstring of the package."""
    for name in manufactured.__all__:
        value = getattr(manufactured, name)
        if inspect.isclass(value) or inspect.isroutine(value) or hasattr(value, "cache_info"):
            # A dataclass without a docstring gets its signature for one.
            assert value.__doc__ and not value.__doc__.startswith(f"{name}("), name  # noqa: PT018
        else:
            assert f"``{name}``" in str(manufactured.__doc__)


def test_a_tree_that_is_heavier_than_recorded_fails_and_limits_only_go_down(tmp_path):
    module = runpy.run_path(str(ROOT / ".ci/weight.py"))
    texts = {
        "study/fem/a.py": '"""A docstring."""\nSMALL = [1, 2]  # four expressions\n',
        "study/fem/b.py": "SMALL = 3\n",
        "tests/test_a.py": "# a comment\nassert True\n",
        "examples/contact_judge.py": "print(1)\n",
        "study/page.html": "<p>\n</p>\n",
    }
    weights = module["measured"](texts)
    assert weights == {
        "product": 6,
        "tests": 1,
        "rest": 3,
        "files": 2,
        "web_lines": 2,
        "repeated_constants": 1,
        "study/fem per line": 3,
        "tests per line": 1,
    }
    limits = tmp_path / "limits.toml"
    compare = module["compare"]
    limits.write_text("".join(f'"{name}" = {weight + 1:g}  # a goal\n' for name, weight in weights.items()))
    for heavier, code in ((weights, 0), (weights | {"tests": 1.1}, 1)):
        assert compare(heavier, limits, record=True) == code
        assert tomllib.loads(limits.read_text()) == weights
    assert compare({"study/new per line": 5.6}, limits, record=False) == 1
