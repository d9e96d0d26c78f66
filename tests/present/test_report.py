"""The page of results shows every row of the data, asks no network for anything, and refuses data it cannot show."""

import json
import re
import shutil
from html import unescape

import numpy as np
import pandas as pd
import pytest
from committed import TABLES, copy_results
from places import DATA, ROOT

from study.ledger.datafiles import DataError
from study.ledger.files import write_packed
from study.ledger.pictures import Packed
from study.ledger.text import cell
from study.present.picture import Picture, picture_path, read_record
from study.present.report import PAGE_TEXTS, draw_case, write_report
from study.present.tables import all_checks, bounds, columns_of, equivalence, rates, stresses
from study.present.templates import typeset
from study.run.plan import full
from study.run.provenance import read_provenance, sources
from study.statements.pictures import Pictures

PLANE = ["advance-recede", "corner"]
SOLID = "cube-disc"
HOSTILE = """</script><img src=x onerror="document.title='broken'"> & "quoted\""""


def write_data(directory):
    """Copies the committed data of three cases and adds text that is hard on HTML."""
    copy_results(directory, (*PLANE, SOLID), (*PLANE, SOLID))
    data = directory / "data"
    shutil.copy(DATA / "faults.csv", data)
    for name, columns in (("cases", ["summary"]), ("claims", ["case", "quantity"]), ("faults", ["fault"])):
        table = pd.read_csv(data / f"{name}.csv", dtype=str)
        row = table.index[table["case"] == SOLID] if name == "cases" else table.index[-1:]
        table.loc[row, columns] = HOSTILE
        table.to_csv(data / f"{name}.csv", index=False)
    provenance = json.loads((DATA / "provenance.json").read_text(encoding="utf-8"))
    (data / "provenance.json").write_text(json.dumps(provenance | {"machine": HOSTILE}))
    return directory


def report(directory):
    return write_report(directory, read_provenance(directory))


class Page:
    """The parts of a page: its text, and rows of tables as texts."""

    def __init__(self, content):
        self.content = content
        self.markup = re.sub(r"<(script|style)\b.*?</\1>", "", content, flags=re.DOTALL)
        self.text = shown(self.markup)
        rows = re.findall(r"<tr\b[^>]*>(.*?)</tr>", self.markup, re.DOTALL)
        self.rows = [list(map(shown, re.findall(r"<t[dh]\b[^>]*>(.*?)</t[dh]>", row, re.DOTALL))) for row in rows]

    def values(self, attribute, tag=r"\w+"):
        """The values of an attribute in all tags, or in tags of one kind."""
        return list(map(unescape, re.findall(rf'<{tag}\b[^>]*?\s{attribute}="([^"]*)"', self.markup)))


def shown(markup):
    return unescape(re.sub(r"<[^>]*>", "", markup))


def plain(text):
    """Text without the marks of scripts, which the page raises and lowers instead."""
    return re.sub(r"[\^_{}]", "", text)


@pytest.fixture(scope="module")
def directory(tmp_path_factory):
    """Data and page; tests only read them."""
    made = write_data(tmp_path_factory.mktemp("report"))
    report(made)
    return made


@pytest.fixture(scope="module")
def page(directory):
    return Page((directory / "report.html").read_text(encoding="utf-8"))


@pytest.fixture
def data(directory, tmp_path):
    shutil.copytree(directory / "data", tmp_path / "data")
    return tmp_path


def test_every_row_of_the_ledger_is_on_the_page_in_its_order_below_its_statement(directory, page):
    columns = ["case", "quantity", "expected", "observed", "low", "high", "verdict"]
    expected = []
    texts = all_checks(directory).map(cell)
    for (label, claim), rows in texts.groupby(["label", "statement"], sort=False):
        expected += [[f"{label} {claim}"], *rows[columns].to_numpy().tolist()]
    start = page.rows.index(columns) + 1
    rows = [[cell.split(" study/")[0] for cell in row] for row in page.rows[start : start + len(expected)]]
    assert [list(map(plain, row)) for row in rows] == [list(map(plain, row)) for row in expected]


def test_the_numbers_of_verdicts_are_those_of_the_ledger(directory, page):
    claims = pd.read_csv(directory / "data/claims.csv")
    for verdict, count in claims["verdict"].value_counts().items():
        assert f"{count} {verdict}" in page.text
    totals = claims.groupby(["label", "statement"], sort=False).size().tolist()
    of_statements = [row[2:7] for row in page.rows if len(row) == 8 and row[7].startswith("study/")]
    assert [sum(int(count or 0) for count in counts) for counts in of_statements] == totals


def test_every_row_of_the_other_tables_is_on_the_page(directory, page):
    rows = [list(map(plain, row)) for row in page.rows]
    for table in (rates, equivalence, stresses, bounds):
        left_out = [] if table is bounds else ["case", "claim"]
        cells = table(directory).cells.drop(columns=left_out, errors="ignore").to_numpy().tolist()
        assert cells
        assert [row for row in cells if list(map(plain, row)) not in rows] == []
    faults = pd.read_csv(directory / "data/faults.csv")["fault"]
    assert set(map(plain, faults)) <= {row[1] for row in page.rows if len(row) > 1}


SYMBOL = re.compile(r"[^\W\d_]\^h|‖_\w|\b[^\W\d_]\b(?!\^)")
"""A letter that stands alone, or with h above it; the index of a norm."""


@pytest.mark.parametrize("name", ["rates", "stresses", "equivalence", "bounds"])
def test_symbols_in_the_heading_of_a_table_are_explained_beside_it(name):
    # The page of a case explains the norms above the charts of the errors.
    letters = PAGE_TEXTS["letters"][name] | (PAGE_TEXTS["letters"]["norms"] if name == "rates" else {})
    said = " ".join(f"{letter} {meaning}" for letter, meaning in letters.items())
    symbols = SYMBOL.findall(" ".join(column.heading for column in columns_of(name)))
    assert symbols
    assert [symbol for symbol in symbols if symbol not in said] == []


def test_text_of_the_data_cannot_become_markup(page):
    assert "<img src=x" not in page.content
    # The summary in the list of cases and on the page of its case; a row of the ledger: its case, also in the filter,
    # and its quantity; a defect; the machine.
    assert page.text.count(HOSTILE) == 2 + 2 + 1 + 1 + 1
    assert HOSTILE in page.values("value") + page.values("data-case")


def test_nothing_on_the_page_is_fetched_and_links_lead_to_its_sections(page):
    addresses = page.values("src") + page.values("href")
    assert addresses
    assert [address for address in addresses if not address.startswith(("#", "data:"))] == []
    assert not re.search(r"https?://(?!www\.w3\.org/(2000/svg|1999/xlink))|@import|url\((?!#)", page.content)
    assert "default-src 'none'" in page.content
    ids = page.values("id")
    assert len(set(ids)) == len(ids)
    assert {link[1:].split("?")[0] for link in page.values("href", "a")} <= set(ids)


def test_every_case_is_shown_in_motion(directory, page):
    films = page.values("data-case", "section")
    assert films == [*PLANE, SOLID]
    images = [address for address in page.values("src") if address.startswith("data:image/webp")]
    assert len(set(images)) == len(images), "no image is there twice"
    sections = re.findall(r'<section class="film"[^>]*data-case.*?</section>', page.markup, re.DOTALL)
    for case, film in zip(films, sections, strict=True):
        picture = Picture(read_record(picture_path(directory, case)))
        frames = re.findall(r'<img src="data:image/webp;base64,(.+?)" alt="t = (.+?), (\d+) nodes? in contact">', film)
        touching = np.sum([face.touching.sum(axis=1) for face in picture.faces], axis=0)
        assert [float(time) for _, time, _ in frames] == pytest.approx(picture.times[::4], rel=5e-3)
        assert [int(count) for _, _, count in frames] == touching[::4].tolist()


def test_a_second_run_gives_the_same_page_and_says_how_to_measure_missing_faults(data, page):
    (data / "data/faults.csv").unlink()
    again = report(data).read_text(encoding="utf-8")
    assert "study faults" in again
    assert again.partition('id="defects"')[:2] == page.content.partition('id="defects"')[:2]


@pytest.mark.parametrize("name", [*(f"{name}.csv" for name in TABLES), "pictures/advance-recede.json.gz"])
def test_missing_data_are_named_with_the_command_that_makes_them(data, name):
    (data / "data" / name).unlink()
    with pytest.raises(DataError, match=rf"{re.escape(name)} is missing: make it with `study run --full --out"):
        report(data)
    assert not (data / "report.html").exists()


@pytest.mark.parametrize(
    ("displacement", "complaint"),
    [
        (None, r"corner\.json\.gz is not a picture with displacement .*older version .*study run"),
        (Packed.of(np.zeros((17, 2, 3))).record(), r"shape \(17, 2, 3\), expected"),
    ],
)
def test_a_picture_that_cannot_be_drawn_is_refused(data, displacement, complaint):
    path = picture_path(data, "corner")
    write_packed(path, json.dumps(read_record(path) | {"displacement": displacement}))
    with pytest.raises(DataError, match=complaint):
        draw_case(data, "corner", [])


def test_every_statement_names_the_files_that_judge_it():
    for label, found in sources().items():
        assert found["code"], label
        assert all((ROOT / file).exists() for file in found["code"])


@pytest.mark.parametrize(
    ("plain_text", "html"),
    {
        "‖u − u^h‖_V": "‖u − u<sup>h</sup>‖<sub>V</sub>",
        "‖v‖_{L∞(0,T;V)}": "‖v‖<sub>L∞(0,T;V)</sub>",
        "L^∞(0,T;H²) ∋ u^1": "L<sup>∞</sup>(0,T;H²) ∋ u<sup>1</sup>",
        "‖v‖_{H_{1}}": "‖v‖<sub>H<sub>1</sub></sub>",
        "w ~ r^1.75, H^(1+s)": "w ~ r<sup>1.75</sup>, H<sup>(1+s)</sup>",
        "a < b & c ^ d": "a &lt; b &amp; c ^ d",
    }.items(),
)
def test_scripts_are_raised_and_lowered_and_the_rest_is_escaped(plain_text, html):
    assert typeset(plain_text) == html


@pytest.mark.slow
def test_the_page_of_the_committed_run_has_at_most_7_megabytes_and_its_pictures_70_kilobytes(tmp_path):
    shutil.copytree(DATA, tmp_path / "data", ignore=shutil.ignore_patterns("jobs"))
    for setting in Pictures().settings(full()):
        (path,) = Pictures.file.write(tmp_path / "data", [Pictures().measure(setting)])
        assert path.stat().st_size <= 70e3
    assert report(tmp_path).stat().st_size <= 7e6
