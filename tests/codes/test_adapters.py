"""Adapters are driven as they are stated, and what ``make codes`` keeps is what the judge says."""

from __future__ import annotations

import json
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
from judged_codes import task

from study.ledger.codes import FOLDER, MARCHES, Codes
from study.ledger.datafiles import DataError
from study.present.charts import codes_chart
from study.run.tasks import frozen, write_task

RESULTS = Path(__file__).parents[2] / "results"
KEY = ["code", "variant", "case", "family"]


@pytest.fixture(scope="module")
def directory(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("tasks")
    for case, levels in (("corner", (4, 8)), ("cube-disc", (2, 3))):
        for n in levels:
            write_task(place, frozen(task(case, n), (0.15, 0.55)))
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
    assert (levels["slow", "corner"], levels["quick", "corner"]) == ([4], [4, 8])
    assert levels["slow", "cube-disc"] == levels["quick", "cube-disc"] == [2, 3]


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
    codes, seen = Codes.read(RESULTS, folder), set()
    assert codes is not None
    classes = codes.classes.set_index(KEY)["class"]
    columns = [field.name for field in fields(contact_judge.Errors) if field.name in codes.errors]
    for name, rows in codes.errors.sort_values("level").groupby(KEY):
        errors = [contact_judge.Errors(**row) for row in rows[columns].to_dict("records")]
        assert classes[name] == contact_judge.classify(list(rows["h"]), errors), name
        seen.add(classes[name])
    assert seen >= grades


def test_the_caption_counts_what_the_order_does_not_see() -> None:
    codes = Codes.read(RESULTS)
    assert codes is not None
    finest, classes = codes.errors.sort_values("level").groupby(KEY).last(), codes.classes.set_index(KEY)
    passed = classes[(abs(classes["order_in_v"] - 1) <= 0.15) & classes["class"].isin(["stagnates", "wrong"])].index
    worst = (finest["pressure"] / finest["best_pressure"])[passed].max()
    caption = codes_chart(codes).caption
    assert f"of {len(passed)} runs whose" in caption
    assert f"up to {worst:.0f} times" in caption


def test_results_without_other_codes_have_none_and_half_a_table_is_refused(tmp_path: Path) -> None:
    assert Codes.read(tmp_path) is None
    (tmp_path / "codes").mkdir()
    (tmp_path / "codes" / "errors.csv").write_text("code,version\na,1\n")
    with pytest.raises(DataError, match="make codes"):
        Codes.read(tmp_path)
