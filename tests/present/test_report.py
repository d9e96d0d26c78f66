"""The page of results shows every row of the data, asks no network for anything, and refuses data it cannot show."""

from __future__ import annotations

import base64
import json
import re
import shutil
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from committed import RESULTS, TABLES, copy_results

from study.cli.main import main
from study.ledger.datafiles import DataError
from study.ledger.files import write_packed
from study.ledger.pictures import FINE, STEPS, Packed
from study.present.notation import typeset
from study.present.picture import Picture, picture_path, read_record, read_values
from study.present.report import TEXTS, write_report
from study.present.tables import bounds_table, equivalence_table, ledger_table, rates_table, stress_table
from study.run.fingerprint import ROOT
from study.run.plan import full
from study.run.provenance import read_provenance, sources
from study.statements.pictures import Pictures

PLANE, SOLID = ["advance-recede", "corner"], "cube-disc"
HOSTILE = """</script><img src=x onerror="document.title='broken'"> & "quoted\""""
FILES = [*(f"{name}.csv" for name in TABLES), "pictures/corner.json.gz", f"pictures/{SOLID}.json.gz"]


def write_data(directory: Path) -> Path:
    """Copies the committed data of three cases and adds text that is hard on HTML."""
    copy_results(directory, (*PLANE, SOLID), (*PLANE, SOLID))
    data = directory / "data"
    shutil.copy(RESULTS / "data" / "controls.csv", data)
    for name, columns in (("cases", ["summary"]), ("claims", ["case", "quantity"]), ("controls", ["defect"])):
        table = pd.read_csv(data / f"{name}.csv", dtype=str)
        row = table.index[table["case"] == SOLID] if name == "cases" else table.index[-1:]
        table.loc[row, columns] = HOSTILE
        table.to_csv(data / f"{name}.csv", index=False)
    provenance = json.loads((RESULTS / "data" / "provenance.json").read_text(encoding="utf-8"))
    (data / "provenance.json").write_text(json.dumps(provenance | {"machine": HOSTILE}))
    return directory


def report(directory: Path) -> Path:
    """What `study report` does."""
    return write_report(directory, read_provenance(directory))


class Page(HTMLParser):
    """The elements of a page: tags with attributes, rows of tables as texts, scripts of data."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.rows: list[list[str]] = []
        self.data: list[str] = []
        self.text = ""
        self._in_cell = self._in_data = False
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")
            self._in_cell = True
        if tag == "script" and dict(attrs).get("type") == "application/json":
            self.data.append("")
            self._in_data = True

    def handle_endtag(self, tag: str) -> None:
        self._in_cell &= tag not in ("td", "th")
        self._in_data &= tag != "script"

    def handle_data(self, data: str) -> None:
        self.text += data
        if self._in_cell:
            self.rows[-1][-1] += data
        if self._in_data:
            self.data[-1] += data


def plain(text: str) -> str:
    """Text without the marks of scripts, which the page raises and lowers instead."""
    return re.sub(r"[\^_{}]", "", text)


@pytest.fixture(scope="module")
def directory(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Data and page; tests only read them."""
    made = write_data(tmp_path_factory.mktemp("report"))
    report(made)
    return made


@pytest.fixture(scope="module")
def text(directory: Path) -> str:
    return (directory / "report.html").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def page(text: str) -> Page:
    return Page(text)


@pytest.fixture
def data(directory: Path, tmp_path: Path) -> Path:
    """A directory with the same data only, to spoil."""
    shutil.copytree(directory / "data", tmp_path / "data")
    return tmp_path


def test_every_row_of_the_ledger_is_on_the_page_in_its_order(directory: Path, page: Page) -> None:
    columns = ["case", "quantity", "expected", "observed", "low", "high", "verdict"]
    expected = [[plain(cell) for cell in row] for row in ledger_table(directory).cells[columns].to_numpy()]
    start = page.rows.index(columns) + 1
    rows = [[plain(cell) for cell in row] for row in page.rows[start:] if len(row) == len(columns)]
    assert rows[: len(expected)] == expected
    heads = [row[0] for row in page.rows[start:] if len(row) == 1]
    labels = pd.read_csv(directory / "data" / "claims.csv").groupby(["label", "statement"], sort=False).groups
    assert len(heads) == len(labels)
    for head, (label, statement) in zip(heads, labels, strict=True):
        assert plain(f"{label} {statement}") in plain(head)


def test_the_numbers_of_verdicts_are_those_of_the_ledger(directory: Path, page: Page) -> None:
    claims = pd.read_csv(directory / "data" / "claims.csv")
    for verdict in ("holds", "reported", "missed", "undecided", "fails"):
        count = (claims["verdict"] == verdict).sum()
        assert f"{count} {verdict}" in page.text
    by_statement = [row for row in page.rows if len(row) == 8 and row[7].startswith("study/")]
    totals = claims.groupby(["label", "statement"], sort=False).size()
    assert [sum(int(count or 0) for count in row[2:7]) for row in by_statement] == totals.tolist()


def test_every_row_of_the_other_tables_is_on_the_page(directory: Path, page: Page) -> None:
    for table in (rates_table(directory), equivalence_table(directory), stress_table(directory)):
        shown = table.cells.drop(columns=["case", "claim"], errors="ignore").to_numpy().tolist()
        assert shown
        assert [row for row in shown if [plain(cell) for cell in row] not in page.rows] == []
    bounds = bounds_table(directory).cells.to_numpy().tolist()
    assert [row for row in bounds if row not in page.rows] == []
    controls = pd.read_csv(directory / "data" / "controls.csv")
    assert set(controls["defect"]) <= {row[1] for row in page.rows if len(row) > 1}


SYMBOL = re.compile(r"[^\W\d_]\^h|‖_\w|\b[^\W\d_]\b(?!\^)")
"""A letter that stands alone, or with h above it; the index of a norm."""


@pytest.mark.parametrize("make", [rates_table, stress_table, equivalence_table, bounds_table])
def test_symbols_in_the_heading_of_a_table_are_explained_beside_it(make: Any, directory: Path) -> None:
    table = make(directory)
    said = " ".join(f"{letter} {meaning}" for letter, meaning in TEXTS["letters"][table.name].items())
    symbols = {symbol for column in table.columns for symbol in SYMBOL.findall(column.heading)}
    assert symbols
    assert {symbol for symbol in symbols if symbol not in said} == set()


def test_text_of_the_data_cannot_become_markup(text: str, page: Page) -> None:
    assert "img" not in {tag for tag, _ in page.tags}
    # The summary in the list of cases and on the page of its case; a row of the ledger: its case, also in the filter,
    # and its quantity; a defect; the machine.
    assert page.text.count(HOSTILE) == 2 + 2 + 1 + 1 + 1
    attributes = [value for _, attributes in page.tags for value in attributes.values()]
    assert HOSTILE in attributes
    assert "<img" not in text


def test_nothing_on_the_page_is_fetched(text: str, page: Page) -> None:
    addresses = [
        value or "" for _, attributes in page.tags for key, value in attributes.items() if key in ("src", "href")
    ]
    assert addresses
    assert [address for address in addresses if not address.startswith(("#", "data:"))] == []
    assert not re.search(r"https?://(?!www\.w3\.org/2000/svg)|@import|url\(", text)
    assert "default-src 'none'" in text


def test_links_lead_to_sections_of_the_page(page: Page) -> None:
    ids = {attributes.get("id") for _, attributes in page.tags}
    links = [attributes["href"] or "" for tag, attributes in page.tags if tag == "a"]
    assert {link[1:].split("?")[0] for link in links} <= ids
    assert len({attributes["id"] for _, attributes in page.tags if "id" in attributes}) == sum(
        "id" in attributes for _, attributes in page.tags
    )


def test_every_case_is_shown_in_motion(page: Page) -> None:
    films = [attributes["data-case"] for tag, attributes in page.tags if tag == "section" and "data-case" in attributes]
    assert films == [*PLANE, SOLID]
    assert {f"case/{case}" for case in films} <= {attributes.get("id") for _, attributes in page.tags}
    sliders = [attributes for tag, attributes in page.tags if attributes.get("type") == "range"]
    assert [slider["id"] for slider in sliders] == ["front-corner", *(f"time-{case}" for case in films)]
    for case, content in zip(films, page.data, strict=True):
        assert len(json.loads(content)["view"]) == (3 if case == SOLID else 2)


def test_the_motion_on_the_page_passes_through_the_shapes_of_the_picture(directory: Path, page: Page) -> None:
    for case, content in zip((*PLANE, SOLID), page.data, strict=True):
        film = json.loads(content)
        record = read_record(picture_path(directory, case))
        raw = np.frombuffer(base64.b64decode(film["displacement"]), dtype="<i2")
        moving = film["unit"] * raw.reshape(len(film["times"]), len(film["vertices"]), -1)
        for shape in Picture.of(record).shapes:
            assert (abs(moving[film["times"].index(shape.time)] - shape.displacement) <= 0.51 * film["unit"]).all()
        assert abs(raw).max() == STEPS


def test_the_faces_of_a_solid_on_the_page_are_those_of_its_picture(directory: Path, page: Page) -> None:
    film = json.loads(page.data[-1])
    record = read_record(picture_path(directory, SOLID))
    for shown, face in zip(film["faces"], record["faces"], strict=True):
        for name in ("s", "x", "gap", "gap_exact", "pressure", "pressure_exact"):
            np.testing.assert_allclose(shown[name], read_values(face[name]), rtol=6e-4)
        np.testing.assert_array_equal(np.sign(shown["level"]), np.sign(read_values(face["level_exact"])))
        corners = np.reshape(film["cells"], (-1, 3))[shown["cells"]].ravel()
        np.testing.assert_array_equal(np.array(face["nodes"])[shown["facets"]], corners)
        assert max(shown["edges"]) < len(face["nodes"])
        assert max(shown["quarters"]) + 1 == len(face["nodes"]) + len(shown["edges"]) / 2 == np.shape(shown["level"])[1]


def test_a_second_run_gives_the_same_bytes(data: Path, text: str) -> None:
    assert report(data).read_text(encoding="utf-8") == text


@pytest.mark.parametrize("name", FILES)
def test_missing_data_are_named_with_the_command_that_makes_them(data: Path, name: str) -> None:
    (data / "data" / name).unlink()
    with pytest.raises(DataError, match=rf"{re.escape(name)} is missing: make it with `study run --full --out"):
        report(data)
    assert not (data / "report.html").exists()


def test_a_picture_of_an_older_version_and_a_directory_without_a_run_are_refused(
    data: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = picture_path(data, "corner")
    record = read_record(path)
    write_packed(path, json.dumps({name: record[name] for name in ("case", "times", "vertices", "cells", "faces")}))
    assert main(["report", "--out", str(data)]) == 2
    message = capsys.readouterr().err
    assert "corner.json.gz holds no displacement" in message
    assert "older version" in message
    assert "study run" in message
    assert not (data / "report.html").exists()
    assert main(["report", "--out", str(data / "empty")]) == 2
    assert "study run" in capsys.readouterr().err


def test_a_film_with_other_cells_than_its_mesh_is_refused(data: Path) -> None:
    path = picture_path(data, "corner")
    record = read_record(path)
    record["displacement"] = Packed.of(np.zeros((17, 2, 3))).record()
    write_packed(path, json.dumps(record))
    with pytest.raises(DataError, match=r"shape \(17, 2, 3\), expected"):
        report(data)


def test_without_measured_defects_the_page_says_how_to_measure_them(data: Path) -> None:
    (data / "data" / "controls.csv").unlink()
    assert "study controls" in report(data).read_text(encoding="utf-8")


def test_every_statement_of_the_committed_ledger_names_the_files_that_judge_it() -> None:
    found = sources()
    for label in pd.read_csv(RESULTS / "data" / "claims.csv")["label"].unique():
        assert found[label]["code"], label
        assert all((ROOT / file).exists() for file in found[label]["code"])


@pytest.mark.parametrize("steps", [STEPS, FINE])
def test_packed_values_are_kept_to_half_a_unit(steps: int) -> None:
    values = np.random.default_rng(1).normal(size=(5, 2, 7)).cumsum(axis=0)
    # Changes of the largest size: from one end of the range to the other.
    values[2:4, 0, 0] = -abs(values).max(), abs(values).max()
    record = json.loads(json.dumps(Packed.of(values, steps).record()))
    again = Packed.read(record)
    # The unit itself is kept to six digits.
    assert abs(again.values - values).max() <= (0.501 + 1e-6 * steps) * again.unit
    assert again.unit == pytest.approx(abs(values).max() / steps, rel=1e-5)
    assert not Packed.of(np.zeros((3, 4))).values.any()


@pytest.mark.parametrize(
    ("plain_text", "html"),
    [
        ("‖u − u^h‖_V", "‖u − u<sup>h</sup>‖<sub>V</sub>"),
        ("‖v‖_{L∞(0,T;V)}", "‖v‖<sub>L∞(0,T;V)</sub>"),
        ("L^∞(0,T;H²) ∋ u^1", "L<sup>∞</sup>(0,T;H²) ∋ u<sup>1</sup>"),
        ("‖v‖_{H_{1}}", "‖v‖<sub>H<sub>1</sub></sub>"),
        ("w ~ r^1.75, H^(1+s)", "w ~ r<sup>1.75</sup>, H<sup>(1+s)</sup>"),
        ("a < b & c ^ d", "a &lt; b &amp; c ^ d"),
        ("x^<", "x^&lt;"),
    ],
)
def test_scripts_are_raised_and_lowered_and_the_rest_is_escaped(plain_text: str, html: str) -> None:
    assert typeset(plain_text) == html


@pytest.mark.slow
def test_the_page_of_the_committed_run_has_at_most_6_megabytes_and_its_pictures_70_kilobytes(tmp_path: Path) -> None:
    shutil.copytree(RESULTS / "data", tmp_path / "data", ignore=shutil.ignore_patterns("jobs"))
    for setting in Pictures().settings(full()):
        (path,) = Pictures.file.write(tmp_path / "data", [Pictures().measure(setting)])
        assert path.stat().st_size <= 70e3
    assert report(tmp_path).stat().st_size <= 6e6
