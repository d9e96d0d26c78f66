"""Mutation testing: every change that no test noticed has a reason in `results/mutants/survivors.csv`."""

from pathlib import Path

import pandas as pd

MUTANTS = Path(__file__).parents[2] / "results" / "mutants"
CHANGE = ["area", "file", "before", "after"]


def test_every_survivor_has_a_reason_and_every_reason_a_survivor() -> None:
    records = [path for path in sorted(MUTANTS.glob("*.csv")) if path.name != "survivors.csv"]
    tried = pd.concat(pd.read_csv(path, keep_default_na=False) for path in records)
    explained = pd.read_csv(MUTANTS / "survivors.csv", keep_default_na=False)
    survivors = tried[tried["result"] == "survived"]
    assert set(tried["result"]) <= {"killed", "survived", "timeout"}
    assert set(map(tuple, survivors[CHANGE].values)) == set(map(tuple, explained[CHANGE].values))
    assert set(explained["kind"]) <= {"equivalent", "wording or speed", "missing test"}
    assert all(len(reason) > 10 for reason in explained["reason"])
