"""No result is typed into the papers: their numbers and tables come from the data, and claim no more than the data."""

import gzip
import json
import re
import runpy
import shutil
from collections import Counter
from copy import copy
from itertools import pairwise
from types import SimpleNamespace

import pandas as pd
import pytest
from changed import overridden
from places import DATA, RESULTS, ROOT

from study.certify.statement import statement
from study.ledger.datafiles import DataError
from study.ledger.verdict import CheckKind, window_share, worst_value
from study.present.article import BEYOND, article, group_of, window_ends
from study.present.pages import expected_texts
from study.present.templates import FullRun, context, percent, power, prose, render

PAPER = ROOT / "paper"
SOURCES = sorted(PAPER.glob("*.tex"))

SETTINGS = {
    "95": "confidence of intervals, in per cent",
    "3.11": "the oldest Python",
    "0.1": "half a window of fully discrete orders",
    "0.15": "the same for the order in h",
}
"""Decimal numbers and percentages that are settings, not results."""
STATEMENT = r"(?:Problems?|Theorems?|Propositions?)[~ ][2-5]\.\d+(?: and(?:~| |\n)(?:Proposition~)?[2-5]\.\d+)?"
EQUATION = r"\([2-5]\.\d{1,2}\)"
LAYOUT = r"\.\d+\\linewidth|\\setlength\{[^}]*\}\{[^}]*\}|\\documentclass\[[^]]*\]"
LABEL = r"\\label\{([^}]*)\}"
MACRO = re.compile(r"\\newcommand\{\\([A-Za-z]+)\}\{(.*)\}")


def text(path):
    """The LaTeX source without its comments."""
    return re.sub(r"(?<!\\)%.*", "", path.read_text(encoding="utf-8"))


EVERYTHING = "\n".join(map(text, SOURCES))
"""The LaTeX sources of all documents."""


def typed_results(source):
    """Decimal numbers, percentages and powers of ten that are no numbers of statements, layout or settings."""
    bare = re.sub(f"{STATEMENT}|{EQUATION}|{LAYOUT}", "", source)
    found = re.findall(r"\d*\.\d+|\d+(?=(?:\\,|~|\s)*\\%)|10\^\{?-?\d+", bare)
    return [number for number in found if number not in SETTINGS]


def macros(content):
    return {match[1]: match[2] for line in content.splitlines() if (match := MACRO.fullmatch(line))}


NUMBERS = macros((RESULTS / "article/numbers.tex").read_text(encoding="utf-8"))
"""The macros in the committed file: name ↦ number."""


@pytest.fixture(scope="module")
def full():
    return FullRun.read(RESULTS)


@pytest.fixture(scope="module")
def claims(full):
    return full.claims


def test_no_result_is_typed_into_a_paper():
    assert typed_results("orders (0.97) by Proposition~5.4 and (5.36), width .48\\linewidth") == ["0.97"]
    assert typed_results(r"the share is 2\,\%, the gap $10^{-7}$") == ["2", "10^{-7"]
    assert {source.name: typed for source in SOURCES if (typed := typed_results(text(source)))} == {}


def test_everything_that_follows_from_the_committed_data_is_what_they_say():
    """Tables, inputs of the papers, captions of figures, badges and README."""
    expected = expected_texts(RESULTS)
    assert set(article(RESULTS)) == set((RESULTS / "article").iterdir()) < set(expected)
    stale = {str(path): made for path, (wanted, made) in expected.items() if path.read_text("utf-8") != wanted}
    assert stale == {}


def test_every_macro_is_used_and_every_file_exists():
    commands = set(re.findall(r"\\([A-Za-z]+)", EVERYTHING))
    assert set(NUMBERS) <= commands
    for name in re.findall(r"\\input\{([^}]*)\}", EVERYTHING):
        # `make paper` writes what is in build.
        assert name.startswith("build/") or (PAPER / f"{name}.tex").is_file(), name


def test_every_reference_is_cited_and_every_citation_has_one():
    cited = {key for keys in re.findall(r"\\cite\{([^}]*)\}", EVERYTHING) for key in keys.split(",")}
    listed = re.findall(r"@\w+\{(\w+),", (PAPER / "references.bib").read_text(encoding="utf-8"))
    assert Counter(listed) == Counter(cited)


def whole(name):
    """A document with everything that it inputs from its own directory."""
    found = text(PAPER / f"{name}.tex")
    return re.sub(r"\\input\{(\w+)\}", lambda match: whole(match[1]), found)


@pytest.mark.parametrize("names", [("theory",), ("study", "supplement")], ids=" and ".join)
def test_every_statement_has_one_proof_and_every_reference_a_label_in_the_paper_or_its_supplement(names):
    source = "".join(map(whole, names))
    labels = re.findall(LABEL, source)
    assert len(set(labels)) == len(labels)
    # S- and T- begin labels of supplement.tex and theory.tex in the other documents. LaTeX checks the prefix.
    assert set(re.findall(r"\\(?:eq)?ref\{(?:[ST]-)?([^}]*)\}", source)) <= set(re.findall(LABEL, EVERYTHING))
    begins = [match.start() for match in re.finditer(r"\\begin\{(theorem|lemma|proposition|corollary)\}", source)]
    assert len(begins) > 9
    for start, following in pairwise([*begins, len(source)]):
        (label,) = re.findall(r"\\label\{((?:thm|lem|prop|cor):[\w-]+)\}", source[start:following])
        after = len(re.findall(r"\\begin\{proof\}(?!\[Proof of)", source[start:following]))
        named = len(re.findall(rf"\\begin\{{proof\}}\[Proof of \w+~\\ref\{{(?:[ST]-)?{label}\}}[^]]*\]", EVERYTHING))
        assert after + named == 1, label


@pytest.mark.parametrize("name", ["theory", "study", "supplement"])
def test_every_figure_and_table_is_mentioned_before_its_place(name):
    """The package flafter keeps LaTeX from moving a figure or table to a place before it."""
    source = whole(name)
    floats = re.findall(r"\\label\{((?:fig|tab):[\w-]+)\}", source)
    assert floats
    assert "flafter" in text(PAPER / "preamble.tex")
    for label in floats:
        mention = source.find(rf"\ref{{{label}}}")
        assert 0 <= mention < source.index(rf"\label{{{label}}}"), label


def test_figures_are_set_as_they_are_drawn_and_two_fill_a_line():
    """A line is 164 mm wide."""
    names = re.findall(r"\\includegraphics\{([^}]*)\}", EVERYTHING)
    assert len(names) == EVERYTHING.count(r"\includegraphics") > 6
    (drawn,) = re.findall(r"^FIGURES := ((?:.*\\\n)*.*)", text(PAPER.parent / "Makefile"), re.MULTILINE)
    assert sorted(names) == sorted(drawn.replace("\\\n", " ").split())
    (width,) = re.findall(r"^figure.figsize: ([\d.]+)", text(PAPER / "figures.mplstyle"), re.MULTILINE)
    assert 0.98 * 164 < 2 * 25.4 * float(width) <= 164


def test_extremes_are_rounded_outwards_and_zero_is_zero(full, claims):
    changed = overridden(
        copy(full), claims=claims.assign(high=1.1001), equivalence=full.equivalence.assign(membership=0)
    )
    values = macros(render("numbers.tex.j2", context(changed)))
    assert values["orderLevelMax"] == "1.11"
    assert values["agreeMembership"] == "0"
    assert percent(0.01201) == r"1.3\,\%"
    assert power(2.01e-7) == r"\(2.1\cdot 10^{-7}\)"


def test_an_order_of_the_source_that_is_wrong_by_one_would_fail(claims):
    orders = claims[(claims["kind"] == CheckKind.CLAIM) & claims["key"].str.startswith("order")]
    orders = orders[orders["verdict"].isin(["holds", "fails"])]
    assert len(orders) > 20
    assert (orders["window_high"] - orders["window_low"] < 1).all()


def program(name):
    """The names of a program in the directory of the papers."""
    return SimpleNamespace(**runpy.run_path(str(PAPER / f"{name}.py")))


@pytest.mark.slow
def test_the_certified_interval_contains_the_true_error():
    low, high, error, cells = program("certified").interval_and_error()
    assert low < error < high
    assert cells == 32


def test_the_certificate_is_about_the_problem_with_the_known_solution():
    certified = program("certified")
    stated = json.loads(gzip.decompress(certified.CERTIFICATE.read_bytes()))["problem"]
    assert json.loads(json.dumps(statement(certified.known()))) == stated


@pytest.mark.slow
def test_the_supplement_has_the_formulas_of_every_case():
    formulas = program("formulas").written()
    names = re.findall(r"\\textbf\{([^}]*)\}", formulas)
    assert names == [prose(name) for name in pd.read_csv(DATA / "cases.csv")["case"]]
    (line,) = (line for line in formulas.splitlines() if "textbf{advance-recede}" in line)
    assert r"w=20 (s - 2 t (1 - t) - 1 / 4)_+^{4}" in line


def test_the_example_of_the_study_paper_defines_a_case(tmp_path):
    (listing,) = re.findall(r"\\begin\{verbatim\}\n(from .*?)\\end\{verbatim\}", text(PAPER / "study.tex"), re.DOTALL)
    path = tmp_path / "pocket.py"
    path.write_text(listing, encoding="utf-8")
    assert runpy.run_path(str(path))["pocket"].order == 1


def test_a_statement_belongs_to_the_group_with_the_longest_beginning():
    assert group_of("(5.36)") == group_of("Prop. 5.4") != group_of("(5.23)")
    assert group_of("beyond: rollers") == group_of("a statement of tomorrow") == BEYOND


def test_a_table_shows_the_ends_of_a_window():
    """The committed tables show windows with a finite lower end."""
    assert window_ends(pd.Series({"window_low": float("-inf"), "window_high": 1e-12})) == "≤ 1e-12"


def test_a_row_holds_if_and_only_if_it_uses_at_most_its_window_and_its_worst_value_is_shown(claims):
    judged = claims[claims["verdict"].isin(["holds", "fails"])]
    shares = judged.apply(window_share, axis=1).dropna()
    assert len(shares) > 0.95 * len(judged)
    # The file has twelve digits: equality counts as inside.
    assert ((shares <= 1 + 1e-9) == (judged.loc[shares.index, "verdict"] == "holds")).all()
    row = {"observed": 1.02, "low": 0.95, "high": 1.02, "window_low": 0.9, "window_high": 1.1, "verdict": "holds"}
    assert worst_value(pd.Series(row)) == 0.95


@pytest.mark.parametrize("lacking", ["a full plan", "the cases that papers name", "faults.csv"])
def test_only_a_full_run_with_its_faults_makes_the_inputs_of_the_papers(lacking, tmp_path):
    data = shutil.copytree(DATA, tmp_path / "data", ignore=shutil.ignore_patterns("pictures", "jobs"))
    if lacking == "a full plan":
        plan = data / "provenance.json"
        plan.write_text(plan.read_text("utf-8").replace('"plan":"full"', '"plan":"quick"'), "utf-8")
    elif lacking == "faults.csv":
        (data / lacking).unlink()
    else:
        pd.read_csv(data / "cases.csv").query("case == 'corner'").to_csv(data / "cases.csv", index=False)
    assert article(tmp_path) == {}


def test_a_row_that_a_paper_names_may_not_be_missing(full, claims):
    with pytest.raises(DataError, match="natural-front"):
        overridden(copy(full), claims=claims[claims["case"] != "natural-front"]).checks(
            "(5.36)", "order", case="natural-front"
        )
    with pytest.raises(DataError, match=r"Thm 4\.2"):
        render("numbers.tex.j2", context(overridden(copy(full), claims=claims[claims["label"] != "Thm 4.2"])))
