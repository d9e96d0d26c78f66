"""Adapters are driven as they are stated, and what ``make codes`` keeps is what the judge says."""

from __future__ import annotations

import json
import re
import sys
from dataclasses import fields
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import common
import contact_judge
import drive
import pytest
import run_codes
import this_study

from study.fem.naming import family_named, resolve
from study.ledger.codes import FOLDER, MARCHES, Codes
from study.ledger.datafiles import DataError
from study.present.charts import codes_chart
from study.run.tasks import frozen, write_task
from study.statements.shared.tasks import Task

ROOT = Path(__file__).parents[2]
RESULTS = ROOT / "results"


@pytest.fixture(scope="module")
def directory(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("tasks")
    for case, levels in (("corner", (4, 8)), ("cube-disc", (2, 4))):
        for n in levels:
            write_task(place, frozen(Task(resolve(case), family_named("one-diagonal"), n), (0.15, 0.55)))
    return place


@pytest.mark.parametrize("adapter", ["this_study", "scikit_fem"])
def test_an_adapter_whose_code_is_here_is_exact_in_the_plane_and_in_space(
    adapter: str, directory: Path, tmp_path: Path
) -> None:
    drive.main(adapter, str(directory), str(tmp_path))
    rows = json.loads((tmp_path / f"{adapter}.json").read_text())
    assert {(row["case"], row["verdict"]) for row in rows} == {(c, "exact for P1") for c in ("corner", "cube-disc")}
    assert max(row["invariance"] for row in rows) < 1e-10
    errors, classes = run_codes.table(rows)
    assert len(errors) == 4
    assert [row["class"] for row in classes] == ["exact for P1"] * 2


def test_a_task_that_a_code_cannot_express_is_named_with_the_reason(directory: Path) -> None:
    tasks = contact_judge.read_tasks(directory)

    def make(task: Any) -> Any:
        raise common.CannotExpressError("no springs in this code")

    row = drive.variant_on(make, tasks[:2])
    key = dict.fromkeys(("code", "version", "variant", "case", "family"), "x")
    errors, (left,) = run_codes.table([key | row])
    assert errors == []
    assert (left["class"], left["reason"]) == ("not expressed", "no springs in this code")


def test_a_variant_stops_at_its_finest_level_and_its_class_is_that_of_the_meshes_before(
    directory: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (make,) = this_study.VARIANTS.values()
    two = SimpleNamespace(CODE="c", VERSION="1", VARIANTS={"slow": make, "quick": make}, FINEST={"slow": 4})
    monkeypatch.setitem(sys.modules, "two_variants", two)
    drive.main("two_variants", str(directory), str(tmp_path))
    rows = json.loads((tmp_path / "two_variants.json").read_text())
    levels = {(row["variant"], row["case"]): row["levels"] for row in rows}
    assert levels == {
        ("slow", "corner"): [4],
        ("quick", "corner"): [4, 8],
        ("slow", "cube-disc"): [2, 4],
        ("quick", "cube-disc"): [2, 4],
    }


def test_a_class_that_is_not_the_committed_one_is_reported() -> None:
    _, committed = run_codes.read(RESULTS / "codes")
    rows = [dict(row) for row in committed]
    assert run_codes.differing(rows, committed) == []
    rows[0]["class"] = "wrong"
    (told,) = run_codes.differing(rows, committed)
    assert told.endswith("↦ wrong")


@pytest.mark.parametrize("folder", ["codes", "codes/march"])
def test_committed_files_are_what_their_rows_are_written_as(folder: str, tmp_path: Path) -> None:
    run_codes.write(tmp_path, *run_codes.read(RESULTS / folder))
    for name in ("errors.csv", "classes.csv"):
        assert (tmp_path / name).read_text() == (RESULTS / folder / name).read_text()


@pytest.mark.parametrize(
    ("folder", "grades"),
    [(FOLDER, {"exact for P1", "consistent", "stagnates", "wrong"}), (MARCHES, {"exact for P1", "consistent"})],
)
def test_committed_classes_are_those_of_the_committed_errors(folder: str, grades: set[str]) -> None:
    codes, classify = Codes.read(RESULTS, folder), contact_judge.classify
    assert codes is not None
    key = list(KEY)
    classes = codes.classes.set_index(key)["class"]
    seen = set()
    for name, rows in codes.errors.sort_values("level").groupby(key):
        columns = [field.name for field in fields(contact_judge.Errors) if field.name in rows]
        errors = [contact_judge.Errors(**row) for row in rows[columns].to_dict("records")]
        assert classes[name] == classify(list(rows["h"]), errors), name
        seen.add(classes[name])
    assert seen >= grades


def test_the_caption_counts_what_the_order_does_not_see() -> None:
    codes = Codes.read(RESULTS)
    assert codes is not None
    errors, classes = codes.errors, codes.classes
    passed = classes[(abs(classes["order_in_v"] - 1) <= 0.15) & classes["class"].isin(["stagnates", "wrong"])]
    caption = codes_chart(codes).caption
    assert int(re.search(r"of (\d+) runs whose", caption)[1]) == len(passed)  # type: ignore[index]
    worst = 0.0
    for row in passed.to_dict("records"):
        mine = errors[(errors[list(KEY)] == [row[name] for name in KEY]).all(axis=1)].sort_values("level").iloc[-1]
        worst = max(worst, mine["pressure"] / mine["best_pressure"])
    assert f"up to {worst:.0f} times" in caption


KEY = ("code", "variant", "case", "family")


def test_results_without_other_codes_have_none_and_half_a_table_is_refused(tmp_path: Path) -> None:
    assert Codes.read(tmp_path) is None
    (tmp_path / "codes").mkdir()
    (tmp_path / "codes" / "errors.csv").write_text("code,version\na,1\n")
    with pytest.raises(DataError, match="make codes"):
        Codes.read(tmp_path)
