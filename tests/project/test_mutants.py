"""Mutants are small mistakes in real code, and every one that the tests let live is explained."""

from __future__ import annotations

import ast
import sys
from dataclasses import astuple
from pathlib import Path

import pandas as pd
import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests"))

from mutation.gates import GATES, every_mutant, gate_of, measured_with  # noqa: E402
from mutation.mutants import Mutant, mutants, mutated  # noqa: E402
from mutation.run import COLUMNS, LIVES, OUT, PAGE, PLACE, explained, kept, summary, to_try  # noqa: E402

CODE = '''
def verdict(values, low, high=1.0):
    """Text is left alone."""
    if not values:
        raise ValueError(f"{low + 1} values")
    found = [value for value in values if value is not None]
    return low <= min(found) and abs(max(found)) < 2 * high
'''


def changes(code: str, tmp_path: Path) -> set[tuple[str, str]]:
    (tmp_path / "code.py").write_text(code, encoding="utf-8")
    found = mutants(tmp_path, "code")
    for one in found:
        assert ast.dump(ast.parse(mutated(tmp_path, one))) != ast.dump(ast.parse(code))
    assert len(set(found)) == len(found)
    return {(one.before, one.after) for one in found}


def test_comparisons_numbers_filters_and_guards_are_changed_and_texts_are_not(tmp_path: Path) -> None:
    found = changes(CODE, tmp_path)
    after = {after for _, after in found}
    assert {
        "low >= min(found) and abs(max(found)) < 2 * high",
        "low <= min(found) and abs(max(found)) > 2 * high",
        "return low <= min(found) or abs(max(found)) < 2 * high",
        "max(found)",
        "max(found) < 2 * high",
        "abs(max(found)) < 2 / high",
        "3 * high",
        "for value in values",
        "pass",
    } <= after
    assert not any("low - 1" in one or "Text" in one for one in after)


def test_a_mistake_of_another_version_of_the_code_is_not_made(tmp_path: Path) -> None:
    (tmp_path / "code.py").write_text("a = 1 + b\n", encoding="utf-8")
    one = mutants(tmp_path, "code")[0]
    (tmp_path / "code.py").write_text("a = c\n", encoding="utf-8")
    with pytest.raises(LookupError, match="code has no"):
        mutated(tmp_path, one)


def test_every_part_has_code_and_tests_that_exist() -> None:
    parts = every_mutant(ROOT)
    assert all(len(found) > 40 for found in parts.values())
    for gate in GATES:
        assert all((ROOT / test.partition("::")[0]).exists() for test in gate.tests)
    assert gate_of("study.ledger.criterion") is GATES[0]
    assert measured_with("study.statements.green")[0] == "Green"
    assert measured_with("study.present.pages") == []


def test_what_is_on_record_is_a_sample_of_what_there_was() -> None:
    table, parts = kept(OUT), pd.read_csv(OUT / "parts.csv").set_index("part")["mutants"]
    assert list(table.columns) == COLUMNS
    assert not table.duplicated(PLACE).any()
    counts = table["part"].value_counts()
    assert set(counts.index) <= set(parts.index)
    assert (counts <= parts[counts.index]).all()


def test_every_mutant_that_lives_has_a_reason_on_the_page() -> None:
    table = kept(OUT)
    living = table.loc[table["noticed_by"] == LIVES, PLACE[:-1]]
    assert explained(PAGE) == set(living.itertuples(index=False, name=None))


def test_what_lives_without_a_reason_is_tried_again_before_what_is_new() -> None:
    old, why, seen, new = (Mutant("study.a", "f", before, "c", 0) for before in "abde")
    rows = [["part", *map(str, astuple(one)), LIVES, by] for one, by in ((why, LIVES), (old, LIVES), (seen, "test"))]
    table = pd.DataFrame(rows, columns=COLUMNS)
    assert to_try([new, seen, why, old], table, {("study.a", "f", "b", "c")}) == [old, new]


def test_the_table_of_the_page_is_that_of_the_record() -> None:
    assert summary(OUT) in PAGE.read_text(encoding="utf-8"), "run: make mutants"
