"""``study check`` trusts nothing: every edit is noticed and named, and --again measures a sample of the rows again."""

import json
import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from commands import study
from tables import texts

from study.cli import check
from study.cli.check import draw_jobs, expected_seconds, planned_jobs, verify
from study.ledger.datafiles import DataError, nested_keys, planned_keys, write_csv
from study.run.judgement import verdicts
from study.run.provenance import compare_sums


def rewritten(change, name):
    """Change the table in a data file, whose cells are texts."""

    def change_it(directory):
        path = directory / "data" / name
        write_csv(path, change(texts(path)))

    return change_it


def edit(name, column, change, where="index >= 0", rows=10**6):
    """Change a column in the first rows that a query chooses."""

    def changed(table):
        chosen = table.query(where, engine="python").index[:rows]
        assert len(chosen)
        table.loc[chosen, column] = table.loc[chosen, column].map(change)
        return table

    return rewritten(changed, name)


def times(factor):
    return lambda cell: f"{factor * float(cell):.12g}" if cell else cell


def to(value):
    return lambda cell: value


def twice(name):
    return rewritten(lambda table: pd.concat([table, table.iloc[[1]]]), name)


def recorded(change):
    def change_it(directory):
        path = directory / "data/provenance.json"
        made = json.loads(path.read_text(encoding="utf-8"))
        change(made)
        path.write_text(json.dumps(made), encoding="utf-8")

    return change_it


def planned(change):
    return recorded(lambda made: made.update(planned=nested_keys(change(planned_keys(made)))))


def emptied(directory):
    for path in (directory / "data").glob("*.csv"):
        rewritten(lambda table: table.head(0), path.name)(directory)
    planned(lambda keys: [])(directory)


@pytest.fixture
def refusal(told):
    """Checks a directory; returns what the command says."""
    return lambda directory, code=2: told(f"check --out {directory}", code)


RATES = "rates.csv"
CASES = "cases.csv"
EQUIVALENCE = "equivalence.csv"


def cell(name, column, change, said, where="index >= 0", rows=10**6):
    """An edit of a column, and what is said of the first cell that it changes."""
    line = "2" if where == "index >= 0" else r"\d+"
    return edit(name, column, change, where, rows), rf"{Path(name).name}, line {line}, column {column}: {said}"


EDITS = {
    "an order that nobody predicted": cell(CASES, "expected_order", to("0.9"), "found '0.9', expected '1'.*run"),
    "a row twice": (twice(RATES), r"rates.csv, line \d+: the row case pocket, .* is also in line 3"),
    "a row that no plan asked for": (edit(RATES, "level", to("9"), rows=1), r"rates.csv, line 2: .* 9 is not among"),
    "tables and plan emptied": (emptied, r"provenance.json has an empty plan"),
    "a smaller plan": (planned(lambda keys: keys[1:]), r"provenance.json does not plan .*, which disagrees with its"),
    "a row planned twice": (
        planned(lambda keys: [*keys, keys[0]]),
        r"provenance.json has .* a measurement twice",
    ),
    "a verdict": cell("claims.csv", "verdict", to("reported"), "found 'reported', expected 'holds': `study ta", rows=1),
    "what was observed": cell("claims.csv", "observed", times(1.001), "found", "observed != '0'", 1),
    "an error": (edit(RATES, "error", times(1.01), rows=1), "rates.csv was changed after the run"),
    "a size": (edit(EQUIVALENCE, "h", times(1.01), rows=1), "equivalence.csv was changed after the run"),
}


def verdicts_as_written(directory):
    """The part of ``study check`` that compares the ledger and tables with what would be written now."""
    check.as_written(directory, verdicts(directory))


@pytest.mark.parametrize("name", EDITS)
def test_an_edit_is_refused_by_file_line_and_column(name, own):
    change, message = EDITS[name]
    change(own)
    parts = {"claims.csv": verdicts_as_written, "was changed after": compare_sums}
    part = next((part for words, part in parts.items() if words in message), verify)
    with pytest.raises(DataError, match=message):
        part(own)


@pytest.mark.parametrize("part", ["verify", "verdicts", "compare_sums", "SeedRecord.read", "as_written"])
def test_the_command_refuses_what_one_of_its_parts_refuses(part, own, refusal, monkeypatch):
    def refuse(*_):
        raise DataError(f"{part} says no")

    monkeypatch.setattr(f"study.cli.check.{part}", refuse)
    assert f"study: {part} says no" in refusal(own)


def test_errors_that_fit_each_other_and_miss_the_claim_fail(own, refusal):
    path = own / "data" / RATES
    table = pd.read_csv(path)
    errors = ["error", "interpolation_error", "discrete_error", "predicted_interpolation", "initial_error"]
    table[errors] = table[errors].mul(table["h"] ** 0.3, axis=0)
    table["order"] += 0.3
    write_csv(path, table)
    assert "rates.csv was changed after the run" in refusal(own)
    recorded(lambda made: made.pop("sha256"))(own)
    assert "fails: Prop. 5.4, pocket: order of the error, extrapolated" in refusal(own, code=1)
    report = own.parent / "ledger.xml"
    assert study(f"check --out {own} --junit {report}") == 1
    assert 'failures="0"' not in report.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "damage",
    [
        {"sha256": None},
        {"sha256": []},
        {"planned": [1, 2]},
        {"scope": None},
        {"scope": {"plane": "x"}},
        {"scope": {"cases": [], "other": 1}},
    ],
    ids=str,
)
def test_a_record_of_another_form_is_called_damaged(damage, own, refusal):
    recorded(lambda made: made.update(damage))(own)
    assert "provenance.json is damaged" in refusal(own)


def test_a_case_whose_file_is_gone_is_refused(own, refusal):
    (own.parent / "pocket.py").unlink()
    assert "there is no file" in refusal(own)


def test_a_case_whose_file_predicts_something_else_now_is_refused(own, refusal):
    path = own.parent / "pocket.py"
    path.write_text(path.read_text(encoding="utf-8").replace('reason="', 'reason="now '), encoding="utf-8")
    assert re.search(r"cases.csv, line 2, column reason: found .*, expected 'now ", refusal(own))


def test_tables_writes_what_check_asks_for_and_check_writes_nothing(own, refusal):
    edit("claims.csv", "observed", to("0.5"), rows=1)(own)
    assert "`study tables" in refusal(own)
    assert study(f"report --out {own}") == 2
    assert study(f"tables --out {own}") == 0
    written = {path: path.stat().st_mtime_ns for path in own.rglob("*.*") if path.name != ".lock"}
    refusal(own, code=0)
    assert {path: path.stat().st_mtime_ns for path in own.rglob("*.*") if path.name != ".lock"} == written
    (own / "data/claims.csv").unlink()
    assert "claims.csv is missing: `study tables" in refusal(own)


def test_rows_that_were_changed_are_noticed(own, told, monkeypatch):
    """Without checksums, only a measurement shows these changes, in the first rows."""
    changes = {RATES: ("quadrature_change", 1.001), EQUIVALENCE: ("steps", 2.0)}
    jobs = planned_jobs(own)
    first = [next(job for job in jobs if job.statement.file.name == file) for file in changes]
    monkeypatch.setattr("study.cli.check.draw_jobs", lambda jobs, count, seed: first)
    for file, (column, factor) in changes.items():
        edit(file, column, times(factor), rows=1)(own)
    recorded(lambda made: made.pop("sha256"))(own)
    said = told(f"check --jobs 1 --again 1000 --out {own}", code=1)
    for file, (column, _) in changes.items():
        assert f"{file}: differs" in said
        assert f"{column}: 1 beyond tolerance" in said


def test_a_seed_without_rows_to_draw_is_refused(told):
    assert "--seed chooses the rows of --again: give --again N with it" in told("check --seed 1")


def test_a_sample_is_repeated_by_its_seed_and_its_expected_time_is_bounded():
    costs = 1e6 * np.geomspace(0.3, 300, 500)
    jobs = [SimpleNamespace(cost=cost) for cost in costs]
    drawn = [draw_jobs(jobs, 5, seed) for seed in range(400)]
    assert drawn[3] == draw_jobs(jobs, 5, 3) != drawn[4]
    bound = 5 * len(jobs) / (1 / costs).sum() / 1e6
    mean = np.mean([expected_seconds(sample) for sample in drawn])
    assert 0.6 * bound < mean < 1.6 * bound < 0.2 * 5 * costs.mean() / 1e6
