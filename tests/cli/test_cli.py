"""Commands: what they print, what they refuse, what they leave on disk, and their exit codes."""

import json
import re
import sys
from dataclasses import replace
from fractions import Fraction

import pandas as pd
import pytest
from commands import python
from tables import everything

from manufactured.catalogue import OTHER_NAMES
from study.cli.common import code_of, progress_bar
from study.fem.naming import outside_the_catalogue
from study.ledger.files import UsageError, write_text
from study.ledger.verdict import FAILS, HOLDS, MISSED, UNDECIDED, Verdict
from study.run.store import STORE_FORMAT

HEAD = """
from dataclasses import replace
from manufactured import *
import sympy
case = named("advance-recede")
(face,) = case.solution.faces
def changed(**c): return replace(case, name="mine", solution=replace(case.solution, faces=(replace(face, **c),)))
"""


@pytest.mark.parametrize(
    ("line", "message"),
    {
        "mine = changed(gap=-face.gap)": r"u_ν ≤ g.*violated.*at x = .*t = ",
        "mine = changed(gap=face.gap * sympy.nan)": r"FormulaError.*complex or not finite",
        "mine = replace(case, order=2)": r"CaseError.*gives min",
        "mine = isotropic(1, -5)": r"LawError.*not elliptic",
        "mine = 3": r"is a int, expected",
        "raise SystemExit(0)": r"SystemExit",
        "other = case": r"defines no 'mine'",
    }.items(),
)
def test_a_users_case_that_is_no_exact_solution_is_refused_with_the_reason(refusal_of_case, line, message):
    assert re.search(message, refusal_of_case(HEAD + line), re.DOTALL)


def test_data_of_another_version_are_refused_by_name_and_no_data_with_the_command(told, tmp_path):
    assert "study run" in told(f"check --out {tmp_path}")
    write_text(tmp_path / "data/provenance.json", json.dumps({"format": STORE_FORMAT + 1}))
    for command in ("run --case full-contact", "check"):
        said = told(f"{command} --out {tmp_path}")
        assert re.search(rf"provenance.json.*format {STORE_FORMAT + 1}", said, re.DOTALL)


def test_the_catalogue_is_listed_as_text_without_making_a_case_and_as_json(told, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr(sys.modules["manufactured.catalogue"], "import_module", None)
        text = told("cases", 0)
    entries = json.loads(told("cases --json", 0))
    assert {"dimension", "law", "zone", "regularity", "statements"} <= set(entries[0])
    listed = {entry["case"]: entry["expected_order"] for entry in entries}
    printed = {name: float(Fraction(order)) for name, order in re.findall(r"^(\S+) +order (\S+)$", text, re.MULTILINE)}
    assert printed == pytest.approx(listed, abs=1e-3)
    assert [case.name for case in outside_the_catalogue()] == [*OTHER_NAMES]
    assert ", ".join(OTHER_NAMES) in text


def test_a_run_makes_only_its_cases_and_writes_figures_and_tables_only_if_asked(tmp_path):
    """In a process of its own, because other tests have made other cases."""
    script = """
import sys, manufactured
from study.cli import present
from study.cli.main import main
drawings = present.drawings
present.drawings = lambda directory: drawings(directory)[:1]  # Drawing all takes most of the time.
catalogue, made = sys.modules["manufactured.catalogue"], []
make = catalogue._made
catalogue._made = lambda name: made.append(name) or make(name)
main(sys.argv[1:])
print(sorted(set(made)))
"""
    words = f"run --case full-contact --levels 2 --jobs 1 --out {tmp_path}"
    for more, folders in (([], {"data"}), (["--figures"], {"data", "figures", "tables"})):
        printed, _ = python(script, *words.split(), *more)
        assert printed.splitlines()[-1] == "['full-contact']"
        assert {path.name for path in tmp_path.iterdir()} == folders


def test_a_users_case_goes_through_the_same_line_to_a_judged_table(made):
    finished = made / "results"
    claims = pd.read_csv(finished / "data/claims.csv")
    # Its largest error comes at t = 0, and its shaken meshes are coarse.
    unclaimed = {"start-share", "order-dual-superclose", "order-pressure-irregular"}
    assert set(claims.loc[claims["verdict"] != "holds", "key"]) == unclaimed
    assert not set(claims["verdict"]) & {"fails", "undecided"}
    assert not claims.duplicated(["label", "key", "case", "family"]).any()
    assert list(dict.fromkeys(claims["label"])) == ["data", "Thm 4.2", "(5.23)", "Prop. 5.4", "contact force"]
    for kind in ("pdf", "png"):
        assert list((finished / "figures").glob(f"*.{kind}"))
    assert not list(finished.rglob("*.part"))


def test_a_run_that_would_drop_rows_of_a_finished_one_is_refused(told, made):
    said = told(f"run --case {made}/pocket.py:pocket --levels 8 16 --out {made}/results")
    assert re.search(r"pocket one-diagonal 32.*--out", said, re.DOTALL)


def test_a_second_run_computes_only_what_is_missing_and_gives_the_same_data(made, told, monkeypatch):
    data = made / "results/data"
    before = everything(data)
    jobs = sorted((data / "jobs").glob("rates__*__00008.json"))
    jobs[0].unlink()
    jobs[1].write_text(jobs[1].read_text()[:100])
    untouched = {path: path.stat().st_mtime_ns for path in (data / "jobs").iterdir() if path not in jobs[:2]}
    said = told(f"run --case {made}/pocket.py:pocket --levels 8 16 32 --jobs 1 --out {made}/results", code=0)
    # Verdicts are printed when the last measurement of a statement has ended, and only for what was measured.
    assert re.search(r"Prop\. 5\.4, pocket: \d+ holds", said)
    assert "Thm 4.2, pocket" not in said
    assert everything(data) == before
    assert {path: path.stat().st_mtime_ns for path in untouched} == untouched


COLUMNS = "label,key,case,family,reason\n"
ROW = Verdict(
    "(0.0)", "a claim", "pocket", "an order", "1 ± 0.1", 1, 0.5, 1.5, HOLDS, "order", "shaken", "claim", 0.9, 1.1
)
LINE = "(0.0),order,pocket,shaken,three levels leave the order open\n"


def listed(directory, text):
    file = directory / "undecided.csv"
    file.write_text(text, encoding="utf-8")
    return file


@pytest.mark.parametrize(
    ("verdict", "lines", "code"),
    [(HOLDS, "", 0), (MISSED, "", 0), (UNDECIDED, "", 3), (UNDECIDED, LINE, 0), (HOLDS, LINE, 3), (FAILS, LINE, 1)],
)
def test_undecided_rows_are_accepted_if_exactly_these_are_listed(tmp_path, verdict, lines, code, capsys):
    file = listed(tmp_path, COLUMNS + lines)
    assert code_of([replace(ROW, verdict=verdict)], file) == code
    differs = {(UNDECIDED, ""): "undecided but not listed", (HOLDS, LINE): "not undecided but listed"}
    row = f"this check is {differs.get((verdict, lines))} in {file}: (0.0), order, pocket, shaken\n"
    assert capsys.readouterr().err == (row if code == 3 else "")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (COLUMNS + "(0.0),order,pocket,shaken, \n", "line 2: the reason why the row is undecided is missing"),
        ("label,key\n", "has the columns label, key, expected label, key, case, family, reason"),
        ("", "cannot be read as CSV"),
        (None, "cannot be read as CSV"),
    ],
)
def test_a_list_without_reasons_or_columns_or_without_a_file_is_refused(tmp_path, text, message):
    with pytest.raises(UsageError, match=message):
        code_of([ROW], tmp_path / "none.csv" if text is None else listed(tmp_path, text))


@pytest.fixture
def bar(monkeypatch):
    """A progress bar whose clock stands still until a test sets it."""
    monkeypatch.setattr("tqdm.std.time", lambda: 0.0)
    with progress_bar(100) as shown:
        yield shown


def test_the_remaining_time_follows_from_the_mean_speed_although_the_last_job_was_slow(bar):
    bar.update(40)
    bar._time = lambda: 10.0
    bar.update(10)
    bar._time = lambda: 42.0
    assert str(bar).endswith("<00:42")
