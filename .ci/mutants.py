"""Mutation testing with Cosmic Ray of a fixed random sample: docs/explanation/mutants.md.

Usage: `.venv/bin/python .ci/mutants.py [AREA …]`. A second run continues the first one. Remove `build/mutants` after
a change of the code or the tests: it has a copy of the last commit, in which files are changed, and the results.
"""

import csv
import hashlib
import os
import re
import subprocess
import sys
from collections import Counter
from contextlib import suppress
from pathlib import Path

from cosmic_ray.ast import ast_nodes, get_ast_from_path
from cosmic_ray.commands import execute
from cosmic_ray.config import ConfigDict
from cosmic_ray.plugins import get_operator, operator_names
from cosmic_ray.work_db import use_db
from cosmic_ray.work_item import MutationSpec, WorkItem

ROOT = Path(__file__).parents[1]
WORK = ROOT / "build" / "mutants"
PER_AREA, SECONDS = 100, 900  # the tests of an area take a minute on an idle machine
RESULTS = "tests/project/test_results.py::test_"
VERDICTS = RESULTS + "the_committed_verdicts_follow_from_the_committed_data_and_none_fails"
NUMBERS = RESULTS + "numbers_of_statements_measured_again_agree_with_the_committed_ones"
AREAS = {  # files to change; tests that should fail, the quickest first
    "judging": ("study/ledger/**/*.py", f"tests/ledger {VERDICTS}"),
    "certify": ("study/certify/*.py", "tests/certify"),
    "bound": ("study/bound/*.py", "tests/bound"),
    "measuring": ("study/statements/**/*.py study/fem/error_norm.py", f"tests/statements {NUMBERS}"),
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


def run(area: str) -> list[list[str]]:
    """Runs what is left of the sample of an area; a row for each change that was tried."""
    patterns, tests = AREAS[area]
    command = f"{sys.executable} -m pytest -x -q -p no:cacheprovider {tests}"
    with use_db(str(WORK / f"{area}.sqlite")) as database:
        if not database.num_work_items:
            subprocess.run(command.split(), check=True)  # tests that fail without a change prove nothing
            database.add_work_items(sample(patterns))
        with suppress(KeyboardInterrupt):
            execute(
                database, ConfigDict({"test-command": command, "timeout": SECONDS, "distributor": {"name": "local"}})
            )
        done = database.completed_work_items
    rows = []
    for item, result in done:
        lines = [line for line in (result.diff or "").splitlines() if re.match(r"[-+](?![-+]{2} )", line)]
        change = [" ".join(line[1:].strip() for line in lines if line[0] == sign) for sign in "-+"]
        rows.append(
            [
                area,
                str(item.mutations[0].module_path),
                *change,
                "timeout" if result.output == "timeout" else result.test_outcome.value,
            ]
        )
    return sorted(rows)


if __name__ == "__main__":
    (WORK / "copy").mkdir(parents=True, exist_ok=True)
    if not (WORK / "code.tar").exists():
        subprocess.run(["git", "archive", "-o", WORK / "code.tar", "HEAD"], cwd=ROOT, check=True)
    os.chdir(WORK / "copy")
    subprocess.run(["tar", "-xf", WORK / "code.tar"], check=True)  # also undoes what an interrupted run has left
    os.environ["PYTHONPATH"] = os.getcwd()
    for name in sys.argv[1:] or AREAS:
        rows = run(name)
        with (ROOT / "results" / "mutants" / f"{name}.csv").open("w", newline="", encoding="utf-8") as file:
            csv.writer(file, lineterminator="\n").writerows([["area", "file", "before", "after", "result"], *rows])
