"""The project of the tutorial on CI: its tests and the steps of the action turn red when its solver is broken."""

import math
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml
from costly_cases import slow
from places import ROOT

TUTORIAL = (ROOT / "docs/how-to/convergence-orders.md").read_text(encoding="utf-8")
FILES = dict(re.findall(r"^```\{code-block\} \w+\n:caption: (\S+)\n\n(.*?)^```$", TUTORIAL, re.DOTALL | re.MULTILINE))
RIGHT = "f(x[1:-1])"
WRONG = "f(x[:-2])"


@pytest.fixture
def project(tmp_path):
    """The files of the tutorial, in a directory outside the repository."""
    for name in ("solver.py", "test_convergence.py", "convergence.yml"):
        (tmp_path / name).write_text(FILES[name], encoding="utf-8")
    return tmp_path


def run(project, command, *arguments, **variables):
    """Runs a command as it is typed, with further arguments and environment variables."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    env = os.environ | {"PATH": path, "PYTHONPATH": str(ROOT)} | variables
    command = [*shlex.split(command), *arguments]
    return subprocess.run(command, cwd=project, env=env, capture_output=True, text=True, check=False)


def act(project, **given):
    """Runs the last step of the action, which judges a table."""
    steps = yaml.safe_load((ROOT / ".github/actions/check-orders/action.yml").read_text())["runs"]["steps"]
    files = {name: str(project / name.lower()) for name in ("GITHUB_OUTPUT", "GITHUB_STEP_SUMMARY")}
    return run(project, "bash --noprofile --norc -eo pipefail -c", steps[-1]["run"], **files, **given)


def judge(project):
    """Runs the steps of the job by hand: the solver writes its table, and the action judges it."""
    *_, solver, action = yaml.safe_load(FILES["convergence.yml"])["jobs"]["orders"]["steps"]
    assert run(project, "bash -c", solver["run"]).returncode == 0
    done = act(project, TABLE=action["with"]["table"], OPTIONS=action["with"]["options"])
    assert done.stderr == ""
    assert (project / "github_output").read_text().splitlines()[-1] == f"code={done.returncode}"
    assert (project / "orders.png").exists()
    return done.returncode, (project / "github_step_summary").read_text(encoding="utf-8")


@pytest.mark.slow
def test_the_tutorial_turns_red_when_its_solver_breaks(project):
    tests = run(project, "python -m pytest -q -p no:cacheprovider -W error")
    assert tests.returncode == 0, tests.stdout
    assert "max_error: holds: converges with order 2.00" in tests.stdout
    code, summary = judge(project)
    assert code == 0
    assert (project / "errors.csv").read_text() == FILES["errors.csv"]
    assert "| max_error | holds |" in summary

    solver = FILES["solver.py"]
    assert solver.count(RIGHT) == 1
    (project / "solver.py").write_text(solver.replace(RIGHT, WRONG))
    tests = run(project, "python -B -m pytest -q -p no:cacheprovider")
    assert tests.returncode == 1
    said = "max_error: fails: converges with order 1.12 (orders 1.16, 1.08)"
    assert said in tests.stdout
    assert said in TUTORIAL
    code, summary = judge(project)
    assert code == 1
    assert "| max_error | fails |" in summary


def test_errors_that_cannot_be_judged_fail_with_a_sentence_and_no_traceback(convergence_orders):
    for h, errors, said in (([0.5, 0.25], [1.0], "^u: .*1"), ([0.5, 0.25], {"u": 1}, "^u: ")):
        with pytest.raises(pytest.fail.Exception, match=said) as failed:
            convergence_orders("u", h, errors)
        assert not failed.value.pytrace


@pytest.mark.parametrize(
    "errors", [[1.0, 2.0, 4.0], [4.0, math.nan, 1.0], [4.0, 4.0, 4.0], np.ma.masked_less([4.0, 2.0, 1.0], 1.5)]
)
def test_errors_that_do_not_fall_or_are_not_finite_fail_without_an_expected_order(errors, convergence_orders):
    with pytest.raises(pytest.fail.Exception, match=r"grows|not finite|stagnates"):
        convergence_orders("u", [4, 2, 1], errors)


CHECKS = """
import numpy as np
import pytest

from convergence_orders import OrderResult

H = np.array([4, 2, 1]) / 8


@pytest.fixture
def solved(convergence_orders, request):
    convergence_orders("setup", H, H ** request.param, expected=2)
    yield
    convergence_orders("teardown", H, H, expected=2)


@pytest.mark.parametrize("solved", [1, 2], indirect=True)
def test_orders(solved, convergence_orders):
    assert isinstance(convergence_orders("call", H, H), OrderResult)


def test_negative_errors(convergence_orders):
    convergence_orders("negative", H, -H)
"""


@pytest.mark.parametrize("options", ["", slow("-n 1")])
def test_checks_in_fixtures_are_listed_and_refusals_printed_once(options, tmp_path):
    (tmp_path / "test_it.py").write_text(CHECKS)
    done = run(tmp_path, f"python -m pytest -p no:cacheprovider {options}")
    assert "= 1 failed, 1 passed, 2 errors in" in done.stdout, done.stdout
    listed = done.stdout.partition("= observed orders =")[2]
    found = re.findall(r"^(\w+): (?:(?:fails|holds): )?converges with order (\d)", listed, re.MULTILINE)
    assert sorted(found) == [("call", "1"), ("setup", "1"), ("setup", "2"), ("teardown", "1")]
    assert "During handling" not in done.stdout
    assert done.stdout.count("errors must not be negative") == 2, "once as the failure, once in pytest's summary"


@pytest.mark.slow
def test_options_of_the_action_may_have_quotes(project):
    (project / "errors.csv").write_text("h,||u - u_h||\n.4,.16\n.2,.04\n.1,.01\n")
    for options, code in (("--expected '||u - u_h||=2'", 0), ("--expected 1", 1)):
        assert act(project, TABLE="errors.csv", OPTIONS=options).returncode == code


@pytest.mark.parametrize("options", ["", "--tolerance 0.1", "--expected 'L2=2", "--expected 2 --help"])
def test_the_action_fails_without_an_expectation_or_a_judgement_and_shows_no_old_report(options, project):
    (project / "errors.csv").write_text("h,L2\n.4,.16\n.2,.04\n.1,.01\n")
    (project / "orders.md").write_text("| L2 | holds |")
    done = act(project, TABLE="errors.csv", OPTIONS=options)
    assert done.returncode == 2
    assert (project / "github_output").read_text() == "code=2\n"
    assert ("options" in done.stderr) == ("--help" not in options)
    assert "Traceback" not in done.stderr
    assert not (project / "github_step_summary").exists()


OWN_STUDY = """
import sys

import study


def test_the_package_of_the_project_is_imported_and_nothing_else():
    assert study.value == 3
    assert not {"scipy", "pandas", "numpy", "matplotlib"} & set(sys.modules)


def test_orders_are_judged(convergence_orders):
    assert convergence_orders("L2", [4, 2, 1], [16, 4, 1], expected=2).verdict == "holds"
    assert not hasattr(study, "orders")
"""


def test_a_project_with_a_package_study_uses_the_plugin(tmp_path):
    (tmp_path / "study").mkdir()
    (tmp_path / "study/__init__.py").write_text("value = 3\n")
    (tmp_path / "test_own.py").write_text(OWN_STUDY)
    code = (
        "import sys, pytest, convergence_orders.plugin; "
        "sys.exit(pytest.main(['-q', '-p', 'convergence_orders.plugin']))"
    )
    done = run(tmp_path, "python -c", code, str(ROOT), PYTEST_DISABLE_PLUGIN_AUTOLOAD="1")
    assert done.returncode == 0, done.stdout + done.stderr
