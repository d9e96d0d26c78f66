"""Mutation testing with Cosmic Ray: a fixed random sample of small changes to the code, and whether tests fail on them.

Usage, in an environment with Cosmic Ray: `python tests/mutants.py [AREA …]`, or `make mutants`. A second run continues
the first one. `build/mutants` holds a copy of the repository, in which the code is changed, and a database per area;
remove it after a change of the code. The result is `results/mutants/AREA.csv`.
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

from cosmic_ray.commands import execute, init
from cosmic_ray.config import ConfigDict
from cosmic_ray.work_db import WorkDB, use_db
from cosmic_ray.work_item import MutationSpec, WorkerOutcome, WorkResult

ROOT = Path(__file__).parents[1]
WORK = ROOT / "build" / "mutants"
PER_AREA = 100
SECONDS = 120
LEDGER = "tests/project/test_results.py::test_the_committed_verdicts_follow_from_the_committed_data_and_none_fails"
NUMBERS = "tests/project/test_results.py::test_numbers_of_statements_measured_again_agree_with_the_committed_ones"
AREAS = {  # files to mutate; tests that must fail, the quickest first
    "judging": (["study/ledger/**/*.py"], f"tests/ledger {LEDGER}"),
    "certify": (["study/certify/*.py"], "tests/certify"),
    "bound": (["study/bound/*.py"], "tests/bound/test_growth.py tests/bound/test_terms.py tests/bound/test_guaranteed.py"),
    "measuring": (["study/fem/gauge.py", "study/statements/**/*.py"], "tests/statements " + NUMBERS),
}
# One replacement for each operator of the language. `|` is left out, since it stands in types.
OPERATORS = re.compile(
    "core/(NumberReplacer|AddNot|ReplaceTrueWithFalse|ReplaceFalseWithTrue|ReplaceAndWithOr|ReplaceOrWithAnd"
    "|ReplaceBreakWithContinue|ReplaceContinueWithBreak|ZeroIterationForLoop|ExceptionReplacer"
    "|ReplaceUnaryOperator_(USub_UAdd|Delete_Not)"
    "|ReplaceBinaryOperator_(Add_Sub|Sub_Add|Mul_Div|Div_Mul|Pow_Mul|FloorDiv_Div|Mod_Div|BitAnd_BitOr)"
    "|ReplaceComparisonOperator_(Lt_LtE|LtE_Lt|Gt_GtE|GtE_Gt|Lt_Gt|LtE_GtE|Gt_Lt|GtE_LtE|Eq_NotEq|NotEq_Eq|Is_IsNot"
    "|IsNot_Is|In_NotIn|NotIn_In))$"
)


def rank(mutation: MutationSpec, seen: Counter[str]) -> str:
    """Hash of a change that depends on its line of code alone, so that a moved line stays in the sample."""
    line, column = mutation.start_pos
    text = mutation.module_path.read_text(encoding="utf-8").splitlines()[line - 1]
    key = f"{mutation.operator_name} {text.strip()} {column - len(text) + len(text.lstrip())}"
    seen[key] += 1
    return hashlib.sha256(f"sample 1 {key} {seen[key]}".encode()).hexdigest()


def choose(database: WorkDB) -> None:
    """Marks all changes as skipped but the sample: those with the smallest hashes."""
    seen: Counter[str] = Counter()
    items = [item for item in database.work_items if OPERATORS.match(item.mutations[0].operator_name)]
    items.sort(key=lambda item: (str(item.mutations[0].module_path), item.mutations[0].occurrence))
    chosen = {item.job_id for item in sorted(items, key=lambda item: rank(item.mutations[0], seen))[:PER_AREA]}
    others = [item.job_id for item in database.work_items if item.job_id not in chosen]
    database.set_multiple_results(others, WorkResult(worker_outcome=WorkerOutcome.SKIPPED))


def run_area(name: str) -> list[list[str]]:
    """Runs what is left of the sample of one area, and returns a row for each change: file, line, change, result."""
    patterns, tests = AREAS[name]
    command = f"{sys.executable} -m pytest -x -q -p no:cacheprovider -p no:benchmark {tests}"
    config = ConfigDict({"test-command": command, "timeout": SECONDS, "distributor": {"name": "local"}})
    with use_db(str(WORK / f"{name}.sqlite")) as database:
        if not database.num_work_items:
            subprocess.run(command.split(), check=True)  # tests that fail without a change prove nothing
            init(sorted(path for pattern in patterns for path in Path().glob(pattern)), database, {})
            choose(database)
        with suppress(KeyboardInterrupt):
            execute(database, config)
        done = [pair for pair in database.completed_work_items if pair[1].worker_outcome != WorkerOutcome.SKIPPED]
    rows = []
    for item, result in done:
        changed = [line for line in (result.diff or "").splitlines() if re.match(r"[-+](?![-+])", line)]
        rows.append([name, str(item.mutations[0].module_path), item.mutations[0].definition_name or ""])
        rows[-1] += [" ".join(line[1:].strip() for line in changed if line[0] == sign) for sign in "-+"]
        rows[-1].append(str(result.test_outcome.value))
    return sorted(rows)


def main(areas: list[str]) -> None:
    """Copies the repository, runs the areas, and writes the table of what was run so far."""
    copy, archive = WORK / "copy", WORK / "code.tar"
    copy.mkdir(parents=True, exist_ok=True)
    if not archive.exists():
        subprocess.run(["git", "archive", "-o", archive, "HEAD"], cwd=ROOT, check=True)
    subprocess.run(["tar", "-xf", archive], cwd=copy, check=True)  # undoes a change that an interrupted run has left
    os.chdir(copy)
    os.environ["PYTHONPATH"] = str(copy)
    for area in areas or AREAS:
        with (ROOT / "results" / "mutants" / f"{area}.csv").open("w", newline="", encoding="utf-8") as file:
            csv.writer(file).writerows([["area", "file", "function", "before", "after", "result"], *run_area(area)])


if __name__ == "__main__":
    main(sys.argv[1:])
