"""Mutation testing: every change that no test noticed has a reason in `results/mutants/survivors.csv`."""

import re
from pathlib import Path

import pandas as pd

ROOT = Path(__file__).parents[2]
MUTANTS, PAGE = ROOT / "results" / "mutants", ROOT / "docs" / "explanation" / "mutants.md"
AREAS = ["certify", "bound", "judging", "measuring"]
CHANGE = ["area", "file", "before", "after"]
WITH_TEST = "missing test", "other test"
TEST = re.compile(r"killed by `(\w+)` in `(\S+)`")


def results(area: str) -> pd.DataFrame:
    path = MUTANTS / f"{area}.csv"
    return pd.read_csv(path, keep_default_na=False) if path.exists() else pd.DataFrame(columns=[*CHANGE, "result"])


def test_every_survivor_has_a_reason_and_every_missing_test_has_been_written() -> None:
    tried = pd.concat(map(results, AREAS))
    explained = pd.read_csv(MUTANTS / "survivors.csv", keep_default_na=False)
    missing = explained["kind"] == "missing test"
    survivors = tried[tried["result"] == "survived"]
    assert set(tried["result"]) <= {"killed", "survived", "timeout"}
    assert set(explained["kind"]) <= {"equivalent", "wording or speed", "stated choice", "open", *WITH_TEST}
    assert set(map(tuple, survivors[CHANGE].values)) == set(map(tuple, explained[~missing][CHANGE].values))
    assert all(len(reason) > 10 for reason in explained["reason"])
    for reason in explained["reason"][explained["kind"].isin(WITH_TEST)]:
        found = TEST.search(reason)
        assert found, f"{reason} does not name a test as in: killed by `test_name` in `tests/folder/file.py`"
        assert f"def {found[1]}(" in (ROOT / found[2]).read_text(encoding="utf-8")


def test_the_page_counts_the_results() -> None:
    for area in AREAS:
        counts = results(area)["result"].value_counts()
        numbers = [counts.sum(), *(counts.get(result, 0) for result in ("killed", "timeout", "survived"))]
        row = " | ".join([area, *(str(int(number)) for number in numbers)])
        assert f"| {row} |" in PAGE.read_text(encoding="utf-8"), f"docs/explanation/mutants.md should say: | {row} |"
