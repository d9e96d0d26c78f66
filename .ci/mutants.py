"""Mutation testing with Cosmic Ray of a fixed random sample: docs/explanation/mutants.md.

Usage: `.venv/bin/python .ci/mutants.py [AREA …]`. A second run continues the first one. Remove `build/mutants` after
a change of the code or the tests: it has a copy of the last commit, in which files are changed, and the results.
"""

import ast
import csv
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
from pathlib import Path
from types import FrameType
from typing import Any

import pytest
from cosmic_ray.ast import ast_nodes, get_ast_from_path
from cosmic_ray.mutating import use_mutation
from cosmic_ray.plugins import get_operator, operator_names
from cosmic_ray.work_item import MutationSpec, WorkItem

ROOT = Path(__file__).parents[1]
WORK, RESULTS = ROOT / "build" / "mutants", ROOT / "results" / "mutants"
PER_AREA = 100
MOST, LIMIT = 30.0, 120
"""CPU seconds: of the tests that are run for a change, and after which a change counts as one that does not end."""
OF_RESULTS = "tests/project/test_results.py::test_"
AREAS = {  # files to change; tests
    "judging": (
        "study/ledger/**/*.py",
        f"tests/ledger {OF_RESULTS}the_committed_verdicts_follow_from_the_committed_data_and_none_fails",
    ),
    "certify": ("study/certify/*.py", "tests/certify"),
    "bound": ("study/bound/*.py", "tests/bound"),
    "measuring": (
        "study/statements/**/*.py study/fem/error_norm.py",
        f"tests/statements {OF_RESULTS}numbers_of_statements_measured_again_agree_with_the_committed_ones",
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


def sample(patterns: str) -> list[WorkItem]:
    """The changes with the smallest hashes of their kind and line of code: a line that moves stays in the sample."""
    ranked, seen = [], Counter[str]()
    for path in sorted(path for pattern in patterns.split() for path in Path().glob(pattern)):
        if path.name in NOT_MEASURED:
            continue
        nodes, lines = list(ast_nodes(get_ast_from_path(path))), path.read_text(encoding="utf-8").splitlines()
        for name in filter(OPERATORS.match, operator_names()):
            places = [place for node in nodes for place in get_operator(name)().mutation_positions(node)]
            for occurrence, (start, end) in enumerate(places):
                text = lines[start[0] - 1]
                key = f"{name[5:]} {text.strip()} {start[1] - len(text) + len(text.lstrip())}"
                seen[key] += 1
                rank = hashlib.sha256(f"sample 1 {key} {seen[key]}".encode()).hexdigest()
                ranked.append((rank, MutationSpec(path, name, occurrence, start, end)))
    ranked.sort(key=lambda pair: pair[0])
    return [WorkItem.single(rank, mutation) for rank, mutation in ranked[:PER_AREA]]


class CalledFunctions:
    """Plugin of pytest: which functions of the copy each test calls, and how long it takes.

    Attributes:
        tests: test that passes ↦ (its CPU seconds, "path:line" of every function of ``study`` that it calls).
    """

    def __init__(self) -> None:
        self.tests: dict[str, tuple[float, list[str]]] = {}
        self._failed: set[str] = set()

    @pytest.hookimpl(hookwrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        called, inside = set(), str(Path("study").resolve())

        def trace(frame: FrameType, event: str, _: Any) -> None:
            code = frame.f_code
            if code.co_filename.startswith(inside):
                called.add((code.co_filename, code.co_firstlineno))

        start = time.process_time()
        sys.settrace(trace)
        yield
        sys.settrace(None)
        if item.nodeid not in self._failed:
            names = sorted(f"{Path(file).relative_to(Path.cwd())}:{line}" for file, line in called)
            self.tests[item.nodeid] = time.process_time() - start, names

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed:
            self._failed.add(report.nodeid)


def in_child(work: Callable[[], int]) -> str:
    """Run a function in a child process and return "killed" if it gives 1, "survived" if 0, otherwise "timeout"."""
    sys.stdout.flush()
    child = os.fork()
    if child == 0:
        try:
            sink = os.open(os.devnull, os.O_WRONLY)
            os.dup2(sink, 1)
            os.dup2(sink, 2)
            os._exit(int(work()))
        except BaseException:
            os._exit(1)
    _, status = os.waitpid(child, 0)
    return {0: "survived", 1: "killed"}.get(os.waitstatus_to_exitcode(status), "timeout")


def record(area: str) -> dict[str, tuple[float, list[str]]]:
    """Return the tests of an area that pass without a change, and the functions that they call."""
    path = WORK / f"{area}-tests.json"

    def run() -> int:
        plugin = CalledFunctions()
        pytest.main(["-q", "-p", "no:cacheprovider", *AREAS[area][1].split()], [plugin])
        path.write_text(json.dumps(plugin.tests), encoding="utf-8")
        return 0

    if not path.exists():
        in_child(run)
    return json.loads(path.read_text(encoding="utf-8"))


def tests_of(mutation: MutationSpec, tests: dict[str, tuple[float, list[str]]]) -> list[str]:
    """Return the quickest tests, of MOST seconds together, that call the innermost function around a change.

    Outside of functions, or if no test calls the function: of all tests that call any function of the file.
    """
    line, spans = mutation.start_pos[0], []
    for node in ast.walk(ast.parse(mutation.module_path.read_text(encoding="utf-8"))):
        if isinstance(node, (ast.FunctionDef, ast.Lambda)):
            first = min([node.lineno, *(d.lineno for d in getattr(node, "decorator_list", []))])
            if first <= line <= (node.end_lineno or first):
                spans.append((first, node.end_lineno))
    functions = {f"{mutation.module_path}:{first}" for first, _ in sorted(spans)[-1:]}
    chosen = {name for name, (_, called) in tests.items() if functions & set(called)}
    if not chosen:
        file = f"{mutation.module_path}:"
        chosen = {name for name, (_, called) in tests.items() if any(each.startswith(file) for each in called)}
    total, found = 0.0, []
    for name in sorted(chosen, key=lambda name: tests[name][0]):
        total += tests[name][0]
        if found and total > MOST:
            break
        found.append(name)
    return found


def run_tests(names: list[str]) -> str:
    """Return how tests end, by the result that this means for a change."""

    def run() -> int:
        resource.setrlimit(resource.RLIMIT_CPU, (LIMIT, LIMIT))
        signal.alarm(10 * LIMIT)
        sys.dont_write_bytecode = True
        return int(pytest.main(["-x", "-q", "-p", "no:cacheprovider", *names]) != 0)

    return in_child(run)


def try_change(area: str, item: WorkItem, tests: dict[str, tuple[float, list[str]]]) -> list[str]:
    """Run the tests of a change and return its row."""
    (mutation,) = item.mutations
    chosen, path = tests_of(mutation, tests), mutation.module_path
    times = path.stat()

    with use_mutation(path, get_operator(mutation.operator_name)(), mutation.occurrence) as (before, after):
        result = run_tests(chosen) if chosen else "survived"
    os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))  # so that compiled files stay valid
    lines = [text.splitlines() for text in (before, after)]
    changed = [(a.strip(), b.strip()) for a, b in zip(*lines, strict=False) if a != b]
    return [area, str(path), *(" ".join(texts) for texts in zip(*changed, strict=True)), result]


def main(areas: list[str]) -> None:
    """Try what is left of the samples, area by area, and write the results after every change."""
    for area in areas:
        tests, path = record(area), WORK / f"{area}.json"
        quick = sorted(tests, key=lambda name: tests[name][0])[:20]
        if run_tests(quick) != "survived":
            raise SystemExit(f"tests of {area} fail without a change: {' '.join(quick)}")
        done: dict[str, list[str]] = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
        for item in sample(AREAS[area][0]):
            if item.job_id not in done:
                done[item.job_id] = try_change(area, item, tests)
                path.write_text(json.dumps(done), encoding="utf-8")
                with (RESULTS / f"{area}.csv").open("w", newline="", encoding="utf-8") as file:
                    head = ["area", "file", "before", "after", "result"]
                    csv.writer(file, lineterminator="\n").writerows([head, *sorted(done.values())])


if __name__ == "__main__":
    (WORK / "copy").mkdir(parents=True, exist_ok=True)
    if not (WORK / "code.tar").exists():
        subprocess.run(["git", "archive", "-o", WORK / "code.tar", "HEAD"], cwd=ROOT, check=True)
    os.chdir(WORK / "copy")
    subprocess.run(["tar", "-xf", WORK / "code.tar"], check=True)  # also undoes what an interrupted run has left
    os.environ["PYTHONPATH"] = os.getcwd()
    sys.path.insert(0, os.getcwd())
    # Children inherit what is not changed.
    for name in ("hypothesis", "matplotlib.pyplot", "pandas", "scipy.stats", "skfem", "clarabel", "manufactured"):
        import_module(name)
    main(sys.argv[1:] or [*AREAS])
