"""``study rates`` on tables from public issue threads and documentation, as people pasted them."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

import pytest

from study.cli.main import main

CASES = Path(__file__).parent / "cases"
VERDICTS = {
    "01-pytools-eoc.txt --expected 2": ["fails"],
    "01-pytools-eoc.txt --expected 1": ["holds"],
    "02-trixi-three-columns.txt --expected 2": ["holds"] * 3,
    "03-trixi-zero-column.txt --expected 4": ["undecided", "undecided", "skipped", "undecided"],
    "04-dispersive-n-repeated.txt --expected 2": ["fails", "fails", "skipped"],
    "05-dealii-step7-global.txt --dim 2 --expected H1=1,L2=2": ["undecided", "undecided"],
    "08-moose-pandas-index.csv --expected 1": ["holds"],
    "10-markdown-nlfem.txt --expected 2": ["holds"],
    "11-benchphaseflow-blowup.csv --expected 2": ["fails", "fails", "fails", "skipped"],
    "14-matlab-no-h.txt --ratio 2 --expected '||u-u_h||=3,||Du-Du_h||=2'": ["holds", "holds", None, None],
    "15-castro-transposed.txt --expected 4": ["holds", "holds", "undecided", "holds"],
    "17-pygbe-elements-3d-surface.txt --dim 2 --expected 2": ["holds"],
    "18-fd-points-not-cells.txt --in n --expected '2nd order=2,6th order=6'": ["undecided", None, "fails"],
    "21-semicolon-decimal-comma.csv --expected 1": ["holds"],
    "23-rates-not-errors.txt --ratio 2 --expected 2": ["undecided"] * 3,
    "24-firedrake-keyvalue.txt --expected 2": ["holds"],
    "25-superconvergence.csv --expected L2=2,H1=1": ["holds", "higher"],
    "25-superconvergence.csv --at-least 0.9": ["holds", "holds"],
    "26-nan-row.txt --expected 4": ["undecided", "skipped", "undecided", "undecided"],
    "28-roundoff-after-good-orders.csv --expected 8": ["holds"],
    "29-comment-header-gnuplot.dat --expected 1": ["holds"],
    "30-latex-body.tex --expected 2": ["holds"],
    "31-h-dt-error-three-columns.csv --expected 2": ["holds"],
    "34-one-sided.csv --expected 2": ["holds"],
    "34-one-sided.csv --at-least 1.8": ["holds"],
    "37-drifts-down.csv --expected 4": ["holds"],
    "37-floor.csv --expected 1": ["holds"],
}
REFUSED = {
    "05-dealii-step7-global.txt": "give --dim",
    "14-matlab-no-h.txt": "Give --ratio 2",
    "17-pygbe-elements-3d-surface.txt": "give --dim",
    "18-fd-points-not-cells.txt": "give --in n",
    "22-mpas-console.txt": "no table was recognised",
    "23-rates-not-errors.txt": "give --ratio 2",
    "33-repeated-h.csv": "line 4: h = 0.05 stands in line 3 already",
}


@pytest.mark.parametrize("command", VERDICTS)
def test_a_public_table_has_the_verdict_of_an_analyst(command: str, capsys) -> None:
    file, *options = shlex.split(command)
    code = main(["rates", str(CASES / file), *options, "--json"])
    verdicts = [column["verdict"] for column in json.loads(capsys.readouterr().out)]
    assert verdicts == VERDICTS[command]
    red = {"fails", "higher"} & set(verdicts)
    assert code == (1 if red else 3 if "undecided" in verdicts else 0)


@pytest.mark.parametrize("file", REFUSED)
def test_a_table_with_two_readings_is_refused_with_the_edit(file: str, capsys) -> None:
    assert main(["rates", str(CASES / file), "--expected", "2"]) == 2
    assert REFUSED[file] in capsys.readouterr().err


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "is empty"),
        (b"h,error\n", "no line with numbers"),
        (b"\0\0", "binary"),
        (b"h,error\n0.25,1.78\0\n", "line 2"),
        (b"n,error\n0,1\n8,.5\n", "sizes must be positive"),
        ("h,error\n.25,1\n.125,−0.5\n".encode(), "must not be negative"),
        (b"h,error\n1," + b"1" * 131_072 + b"\n.5,1\n", "131072 characters"),
        (b"h,error\n" + b"1,1\n" * 1_000_000, "100000 lines"),
        (b"h,error\n1,abc\n.5,1\n", "line 2: the entry of error is 'abc'"),
    ],
)
def test_damaged_and_hostile_files_are_refused_in_words(data: bytes, words: str, tmp_path, capsys) -> None:
    (tmp_path / "table").write_bytes(data)
    assert main(["rates", str(tmp_path / "table")]) == 2
    assert words in capsys.readouterr().err


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le"])
@pytest.mark.parametrize("ends", ["\n", "\r\n"])
@pytest.mark.parametrize("form", ["{},{}", "{};{}", "{}\t{}", "{}  {}", "| {} | {} |", "{} & {} \\\\"])
def test_one_table_in_every_form_gives_the_same_orders(encoding, ends, form, tmp_path, capsys) -> None:
    rows = [("h", "error"), ("1/4", "1.6D-1"), ("0.125", "4×10⁻²"), ("6.25e-2", "1%")]
    (tmp_path / "table").write_bytes(ends.join(form.format(*row) for row in rows).encode(encoding))
    assert main(["rates", str(tmp_path / "table"), "--expected", "2", "--json"]) == 0
    (column,) = json.loads(capsys.readouterr().out)
    assert column["orders"] == pytest.approx([2, 2])


def test_a_table_without_an_expectation_exits_with_0(tmp_path) -> None:
    (tmp_path / "table").write_text("h,error\n.5,1\n.25,1.9\n.125,4.3\n")
    assert main(["rates", str(tmp_path / "table")]) == 0
