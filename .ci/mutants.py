"""Mutation testing with Cosmic Ray of a fixed random sample: docs/explanation/mutants.md.

Usage: `.venv/bin/python .ci/mutants.py [AREA …]`. A second call continues and tries the survivors again. To try all
mutants again, remove the files of the areas in `results/mutants`.
"""

import csv
import difflib
import hashlib
import json
import os
import re
import resource
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from importlib import import_module
from itertools import accumulate
from pathlib import Path

import pytest
from cosmic_ray.ast import ast_nodes, get_ast_from_path
from cosmic_ray.mutating import use_mutation
from cosmic_ray.plugins import get_operator, operator_names
from cosmic_ray.work_item import MutationSpec
from coverage import Coverage

ROOT = Path(__file__).parents[1]
RESULTS = ROOT / "results" / "mutants"
PER_AREA, MOST, LIMIT = 100, 30.0, 90
"""Mutants of an area; CPU seconds of the tests of a mutant, and after which it counts as one that does not end."""
OF_RESULTS = "tests/project/test_results.py::test_"
AREAS = {  # files to change; tests
    "certify": ("study/certify/*.py", "tests/certify"),
    "bound": ("study/bound/*.py", "tests/bound"),
    "judging": (
        "study/ledger/*.py",
        f"tests/ledger {OF_RESULTS}the_committed_verdicts_follow_from_the_committed_data_and_none_fails",
    ),
    "measuring": (
        "study/statements/**/*.py study/fem/error_norm.py",
        f"tests/statements {OF_RESULTS}rows_measured_again_agree_with_the_committed_ones "
        f"{OF_RESULTS}numbers_of_statements_measured_again_agree_with_the_committed_ones "
        f"{OF_RESULTS}stresses_measured_again_agree_with_the_committed_ones "
        f"{OF_RESULTS}bounds_measured_again_agree_with_the_committed_ones "
        f"{OF_RESULTS}errors_of_the_second_solver_measured_again_agree_with_the_committed_ones "
        f"{OF_RESULTS}the_committed_verdicts_follow_from_the_committed_data_and_none_fails",
    ),
}
NOT_MEASURED = ("pictures.py", "unmeasured.py", "estimates.py")
OPERATORS = re.compile(
    "core/(NumberReplacer|AddNot|Replace(TrueWithFalse|FalseWithTrue|AndWithOr|OrWithAnd|BreakWithContinue)"
    "|ReplaceContinueWithBreak|ZeroIterationForLoop|ExceptionReplacer|ReplaceUnaryOperator_(USub_UAdd|Delete_Not)"
    "|ReplaceBinaryOperator_(Add_Sub|Sub_Add|Mul_Div|Div_Mul|Pow_Mul|FloorDiv_Div|Mod_Div|BitAnd_BitOr)"
    "|ReplaceComparisonOperator_(Lt_LtE|LtE_Lt|Gt_GtE|GtE_Gt|Lt_Gt|LtE_GtE|Gt_Lt|GtE_LtE|Eq_NotEq|NotEq_Eq|Is_IsNot"
    "|IsNot_Is))$"
)


def sample(patterns: str) -> dict[str, MutationSpec]:
    """The mutants with the smallest hashes of their kind and line of code: a line that moves stays in the sample."""
    ranked, seen = {}, Counter[str]()
    paths = {path for pattern in patterns.split() for path in Path().glob(pattern) if path.name not in NOT_MEASURED}
    for path in sorted(paths):
        nodes, lines = list(ast_nodes(get_ast_from_path(path))), path.read_text(encoding="utf-8").splitlines()
        for name in filter(OPERATORS.match, operator_names()):
            places = [place for node in nodes for place in get_operator(name)().mutation_positions(node)]
            for occurrence, (start, end) in enumerate(places):
                text = lines[start[0] - 1]
                key = f"{name[5:]} {text.strip()} {start[1] - len(text) + len(text.lstrip())}"
                seen[key] += 1
                rank = hashlib.sha256(f"sample 1 {key} {seen[key]}".encode()).hexdigest()
                ranked[rank[:16]] = MutationSpec(path, name, occurrence, start, end)
    return dict(sorted(ranked.items())[:PER_AREA])


def in_child(work: Callable[[], int]) -> str:
    """Run a function in a child process and return "survived" if it gives 0, "timeout" if it is ended, or "killed"."""
    child = os.fork()
    if child == 0:
        try:
            for stream in (1, 2):
                os.dup2(os.open(os.devnull, os.O_WRONLY), stream)
            os._exit(int(work() != 0))
        except BaseException:
            os._exit(1)
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    return "timeout" if status < 0 else "killed" if status else "survived"


class Recorder:
    """Plugin of pytest: coverage.py stores the lines that each test reaches; `seconds` are those of passing tests."""

    def __init__(self, coverage: Coverage) -> None:
        self.coverage, self.seconds = coverage, dict[str, float]()

    @pytest.hookimpl(hookwrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        self.coverage.switch_context(item.nodeid)
        start, failed = time.process_time(), item.session.testsfailed
        yield
        if item.session.testsfailed == failed:
            self.seconds[item.nodeid] = time.process_time() - start


def record(area: str, path: Path) -> int:
    """Run all tests of an area without a change, and store the lines that each reaches and its CPU seconds."""
    coverage = Coverage(data_file=str(path.with_suffix(".coverage")), source=["study"], config_file=False)
    recorder = Recorder(coverage)
    with coverage.collect():
        for file in {mutation.module_path for mutation in sample(AREAS[area][0]).values()}:
            import_module(".".join(file.with_suffix("").parts))  # no test counts as reaching what runs at import
        pytest.main(["-q", "-p", "no:cacheprovider", *AREAS[area][1].split()], [recorder])
    coverage.save()
    path.write_text(json.dumps(recorder.seconds), encoding="utf-8")
    return 0


def tests_of(mutation: MutationSpec, coverage: Coverage, seconds: dict[str, float]) -> list[str]:
    """The quickest tests, of MOST seconds together, that reach the statement, or its file if it runs at import."""
    reached = coverage.get_data().contexts_by_lineno(str(mutation.module_path.resolve()))
    line = max((line for line in reached if line <= mutation.start_pos[0]), default=min(reached, default=0))
    everywhere = {name for names in reached.values() for name in names}
    names = seconds.keys() & (set(reached.get(line, ())) - {""} or everywhere)
    ordered = sorted(names, key=lambda name: (seconds[name], name))
    totals = accumulate(seconds[name] for name in ordered)
    return [name for name, total in zip(ordered, totals, strict=True) if total <= MOST] or ordered[:1]


def run_tests(names: list[str]) -> int:
    resource.setrlimit(resource.RLIMIT_CPU, (LIMIT, LIMIT))
    signal.alarm(40 * LIMIT)  # ends tests that wait; other programs may leave little of the processor
    sys.dont_write_bytecode = True
    return pytest.main(["-x", "-q", "-p", "no:cacheprovider", *names])


def try_mutant(mutation: MutationSpec, tests: list[str]) -> list[str]:
    """Run the tests of a mutant and return its row."""
    path = mutation.module_path
    times = path.stat()
    with use_mutation(path, get_operator(mutation.operator_name)(), mutation.occurrence) as (before, after):
        result = in_child(lambda: run_tests(tests)) if tests else "survived"
    os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))  # so that compiled files stay valid
    changed = list(difflib.unified_diff(before.splitlines(), after.splitlines(), n=0, lineterm=""))[2:]
    lines = [" ".join(line[1:].strip() for line in changed if line[0] == sign) for sign in "-+"]
    return [str(path), *lines, result]


def main(area: str, work: Path) -> None:
    """Try the mutants of an area that have no result or survived, and write the results after each mutant."""
    path, table = work / f"{area}.json", RESULTS / f"{area}.csv"
    if not path.exists():
        in_child(lambda: record(area, path))
    seconds = json.loads(path.read_text(encoding="utf-8"))
    coverage = Coverage(data_file=str(path.with_suffix(".coverage")), config_file=False)
    coverage.load()
    quick = sorted(seconds, key=lambda name: seconds[name])[:20]
    if in_child(lambda: run_tests(quick)) != "survived":
        raise SystemExit(f"tests of {area} fail without a change: {' '.join(quick)}")
    mutants, rows = sample(AREAS[area][0]), {}
    if table.exists():
        with table.open(newline="", encoding="utf-8") as file:
            rows = {row[1]: row for row in csv.reader(file) if row[1] in mutants}
    for key, mutation in mutants.items():
        if key not in rows or rows[key][-1] == "survived":
            rows[key] = [area, key, *try_mutant(mutation, tests_of(mutation, coverage, seconds))]
            with table.open("w", newline="", encoding="utf-8") as file:
                head = ["area", "mutant", "file", "before", "after", "result"]
                csv.writer(file, lineterminator="\n").writerows([head, *sorted(rows.values())])


if __name__ == "__main__":
    commit = subprocess.run(["git", "rev-parse", "HEAD"], cwd=ROOT, check=True, capture_output=True, text=True).stdout
    work = ROOT / "build" / "mutants" / commit.strip()
    (work / "copy").mkdir(parents=True, exist_ok=True)
    archive = subprocess.run(["git", "archive", "HEAD"], cwd=ROOT, check=True, capture_output=True).stdout
    os.chdir(work / "copy")
    subprocess.run(["tar", "-xf", "-"], input=archive, check=True)  # also undoes what an interrupted run has left
    os.environ["PYTHONPATH"] = os.getcwd()
    sys.path.insert(0, os.getcwd())
    # Children inherit what is not changed.
    for name in ("hypothesis", "matplotlib.pyplot", "pandas", "scipy.stats", "skfem", "clarabel", "manufactured"):
        import_module(name)
    for area in sys.argv[1:] or AREAS:
        main(area, work)
