"""What README and documentation show is what the data say."""

import re
from copy import copy

import pandas as pd
import pytest
from changed import overridden
from pages import README, SITE, Page
from places import RESULTS, ROOT

from manufactured.catalogue import NAMES
from manufactured.colours import VERMILLION
from study.controls.faults import FAULTS
from study.ledger.datafiles import DataError
from study.present.pages import badges, main, refresh, verdicts_in_words
from study.present.templates import FullRun
from study.run.plan import Plan
from study.run.plan import full as full_scope
from study.statements.prop_5_4 import ERROR_LIMIT

CHANGES = Page(ROOT / "CHANGELOG.md")


@pytest.fixture(scope="module")
def full():
    return FullRun.read(RESULTS)


@pytest.mark.parametrize("path", [page for page in SITE if "<!-- end -->" in page.text])
def test_the_tables_of_a_page_come_from_the_committed_data(path, full, tmp_path):
    copy = tmp_path / "page.md"
    copy.write_text(path.text, encoding="utf-8")
    assert not refresh(copy, full), "run: make pages"


@pytest.mark.parametrize(
    ("verdicts", "words"),
    [
        (["holds", "holds", "reported"], "all 2 checks hold"),
        (["holds", "fails", "undecided", "undecided"], "of 4 checks 1 fail, 2 undecided, 1 hold"),
    ],
)
def test_all_checks_hold_only_if_none_fails_or_is_undecided(verdicts, words):
    assert verdicts_in_words(pd.DataFrame({"verdict": verdicts}), "checks") == words


def test_badges_are_red_where_a_row_fails_and_a_defect_goes_unseen(full):
    """That they say what is so, is tested with everything else that follows from the data."""
    failing = full.claims.assign(verdict=["fails", *full.claims["verdict"][1:]])
    unseen = full.faults.assign(by_error="", by_others="")
    svg = badges(overridden(copy(full), claims=failing, faults=unseen), ROOT / "pyproject.toml")
    assert set(re.findall(r"\]\(results/badges/(\S+)\)\]", README.text)) == set(svg)
    for name, says in (("ledger.svg", " 1 fail</title>"), ("defects.svg", ": 0 of ")):
        assert says in svg[name]
        assert f'fill="{VERMILLION}"' in svg[name]


@pytest.mark.parametrize(
    ("pattern", "number"),
    {
        r"(\d+) measurements": len(Plan.of(full_scope()).jobs),
        r"(\d+) (?:deliberate )?faults": len(FAULTS),
        r"(\d+) (?:exact solutions|cases of viscoelastic)": len(NAMES),
        r"at most (\d+) % of the errors": round(100 * ERROR_LIMIT.high),
    }.items(),
)
def test_a_number_is_the_same_on_all_pages_and_in_the_program(pattern, number):
    said = [found for page in (README, CHANGES, *SITE) for found in re.findall(pattern, " ".join(page.text.split()))]
    assert {int(found) for found in said} == {number}


def test_a_page_without_marks_and_data_of_no_full_run_are_refused(full, tmp_path, monkeypatch):
    (tmp_path / "README.md").write_text("# Nothing\n")
    with pytest.raises(DataError, match="has no place for a table"):
        refresh(tmp_path / "README.md", full)
    monkeypatch.setattr("sys.argv", ["pages", str(tmp_path), str(README.path)])
    with pytest.raises(DataError, match="has no full run: `make full`"):
        main()
