"""The command on tables from public issue threads, regression files and documentation, as people pasted them."""

import json
import re
import shlex
import time
from pathlib import Path

import pytest

from convergence_orders.columns import Options, read_series
from convergence_orders.command import main

CASES = Path(__file__).parent / "cases"


VERDICTS = {
    "01-pytools-eoc.txt --expected 2": "fails",
    "01-pytools-eoc.txt --expected 1": "holds",
    "02-trixi-three-columns.txt --expected 2": "holds, holds, holds",
    "03-trixi-zero-column.txt --expected 4": "undecided, undecided, skipped, undecided",
    "04-dispersive-n-repeated.txt --expected 2": "fails, fails, skipped",
    "05-dealii-step7-global.txt --expected H1=1,L2=2": "undecided, undecided",
    "08-moose-pandas-index.csv --expected 1": "holds",
    "10-markdown-nlfem.txt --expected 2": "holds",
    "11-benchphaseflow-blowup.csv --expected 2": "fails, fails, fails, skipped",
    "14-matlab-no-h.txt --ratio 2 --expected '||u-u_h||=3,||Du-Du_h||=2'": "holds, holds, None, None",
    "15-castro-transposed.txt --expected 4": "holds, holds, undecided, holds",
    "17-pygbe-elements-3d-surface.txt --dim 2 --expected 2": "holds",
    "18-fd-points-not-cells.txt --expected '2nd order=2,6th order=6'": "undecided, None, fails",
    "21-semicolon-decimal-comma.csv --expected 1": "holds",
    "23-rates-not-errors.txt --ratio 2 --expected 2": "undecided, undecided, undecided",
    "24-firedrake-keyvalue.txt --expected 2": "holds",
    "25-superconvergence.csv --expected L2=2,H1=1": "holds, higher",
    "25-superconvergence.csv --at-least 0.9": "holds, holds",
    "26-nan-row.txt --expected 4": "undecided, skipped, undecided, undecided",
    "28-roundoff-after-good-orders.csv --expected 8": "holds",
    "29-comment-header-gnuplot.dat --expected 1": "holds",
    "30-latex-body.tex --expected 2": "holds",
    "31-h-dt-error-three-columns.csv --expected 2": "holds",
    "34-one-sided.csv --expected 2": "holds",
    "37-drifts-down.csv --expected 4": "holds",
    "37-floor.csv --expected 1": "fails",
    "37-floor.csv --expected 1 --floor 1e-3": "holds",
    # Further public tables; where each one comes from stands in cases/README.md.
    "ferrite.txt --expected Linf=2,L2=2,H1=1": "holds, holds, holds",
    "lethe.rst --dim 2 --expected error_velocity=1": "holds, None",
    "dealii_results.md --expected 2 --tolerance 0.2": "holds",
    "codegallery.tex --dim 2 --at-least 0.95": "holds, holds, holds",
    "trixiatmo.txt --expected h_vcon1=2": "None, undecided, None, None, undecided, None",
    "step78.dox --dim 1 --expected L2=2,H1=1,Linfty=2": "holds, holds, holds",
    "step7adaptive.txt --dim 2 --expected L2=2,H1=1": "undecided, undecided, None",
    "math471.m --in n --expected 2": "holds",
    "test2b.m --expected 2": "holds",
    "gadopt.txt --ratio 2 --expected 2": "fails, fails, fails",
    "multirow-unreadable-sizes.tex --expected 2": "fails, fails, holds, holds",
    "times-in-sizes.tex --expected 2": "fails",
    "levels-repeated-ratio.md --expected 2": "fails, holds",
    "levels-repeated-ratio.md --expected 2 --ratio 2": "fails, holds",
    "names-with-blanks.txt --expected 'val L2=2,grad L2=2,val L2-post=3'": "fails, fails, undecided, "
    "holds, holds, holds, higher, higher, higher",
    "unknown-unit-in-cells.md --expected 1": "undecided, undecided",
    "one-name-per-line-in-prose.txt --ratio 2 --expected 2": "holds",
    "tecplot.dat --expected 1": "undecided, undecided, undecided, undecided, undecided",
    "sfrac.tex --expected '$H^1(\\Omega)$=1,$L^2(\\Omega)$=2,$L^\\infty(\\Omega)$=1.5'": "higher, holds, holds",
    "comment-block-fitted-row.txt --expected 'N 1=2,N 2=3'": "undecided, undecided, undecided, undecided",
    "error-against-finest-run.csv --expected 1": "undecided, undecided",
    "r-matrix.txt --expected L2=2,H1=1": "holds, holds",
    "dealii-cycle-cells-dofs.txt --expected L2=3,H1=2,Linfty=3": "holds, holds, holds",
    "rates-of-one-list.txt --expected 'L2 errors=2,H1 errors=1'": "holds, holds",
    "matlab-table.txt --expected errL2=2,errH1=1": "holds, holds",
    "inverse-h-two-degrees.tex --at-least 1.9": "holds, holds",
    "quotients-first-cell-left-out.txt --expected 2": "holds",
    "mfem-ref-dofs.txt --dim 3 --expected 1": "holds, holds",
}
REFUSED = {
    "14-matlab-no-h.txt": "Give --ratio 2",
    "17-pygbe-elements-3d-surface.txt": "give --dim",
    "22-mpas-console.txt": "no table was recognised",
    "23-rates-not-errors.txt": "Give --ratio 2",
    "lists-without-brackets.txt": "has 2 values, expected 3",
    "computed-and-analytical.txt": "give --dim",
    "one-name-per-line-in-prose.txt": "Give --ratio 2",
    "33-repeated-h.csv": "the mesh size 0.05 occurs twice",
    "gadopt.txt": "Give --ratio 2",
    "libceed.txt": "convergence order of u (order)",
    "mfem-ref-dofs.txt": "give --dim D (dim=D in Python)",
    "ngsolve-words-and-numbers.txt": "6 columns, but no line above names them",
    "p-refinement-with-unknowns.txt": "column p has degrees: errors against the degree (p-refinement)",
    "mirgecom_bare.txt": "6 columns, but no line above names them",
}


@pytest.mark.parametrize("command", VERDICTS)
def test_a_public_table_has_the_verdict_of_an_analyst(command, rates):
    file, _, options = command.partition(" ")
    verdicts = VERDICTS[command]
    code = 1 if re.search("fails|higher", verdicts) else 3 if "undecided" in verdicts else 0
    found = json.loads(rates(CASES / file, f"--json {options}", code))
    assert ", ".join(str(column["verdict"]) for column in found) == verdicts


@pytest.mark.parametrize("file", REFUSED)
def test_a_table_with_two_readings_is_refused_with_the_edit(file, rates):
    assert REFUSED[file] in rates(CASES / file, "--expected 2", 2)


@pytest.mark.parametrize(
    ("command", "sentence"),
    {
        "04-dispersive-n-repeated.txt": "eta: the error grows as h decreases: orders -0.38, -0.12, -1.19, -0.97; it "
        "does not converge v: stagnates at about 1.1e-06 from h = 0.0039062 on",
        "05-dealii-step7-global.txt --dim 2": "H1: pre-asymptotic",
        "18-fd-points-not-cells.txt": "orders fall on the finest meshes: 1.99, 2.00, 1.08",
        "25-superconvergence.csv --expected H1=1": "higher than expected",
        "28-roundoff-after-good-orders.csv": "round-off of about 4.1e-14 from h = 0.0078125 on",
        "37-drifts-down.csv": "orders fall on the finest meshes: 3.99, 3.94, 3.92, 3.89",
        "37-floor.csv": "the error tends to 0.0008, not to 0",
        "gadopt.txt --ratio 2": "are these orders or values of a quantity (--values), not errors?",
        "trixiatmo.txt": "h error (linf): orders fall",
        "lethe.rst --dim 2": "error_pressure: stagnates",
        "lethe_torque.txt --dim 2 --values": "T_z: monotone, order 0.87",
        "values-past-an-extremum.csv --dim 3 --values": "szz: not monotone",
        "error-against-finest-run.csv --expected 1": "solution computed with h = 15.1? Take a finer reference",
        "computed-and-analytical.txt --dim 2": "errors rise and fall: orders -3.73, 6.02",
        "comment-block-fitted-row.txt": "printed orders 0.56, 0.87, 1.11 are not the computed ones 1.12, 1.74, 2.22",
        "names-with-blanks.txt": "h = cells^(-1/2) from column cells, which the printed orders confirm",
        "quotients-first-cell-left-out.txt": "ignored: ratio (quotients)",
        "rates-of-one-list.txt": "H1 errors: converges with order 1.00 (orders 1.00, 1.00, 1.00) read as lists",
    }.items(),
)
def test_the_diagnosis_names_what_an_analyst_sees(command, sentence, capsys):
    file, *options = shlex.split(command)
    main([str(CASES / file), *options])
    output = capsys.readouterr().out
    assert sentence in " ".join(output.split())
    assert max(map(len, output.splitlines())) <= 80


SMALL = "{}\n0.25,1.78\n0.125,0.697\n0.0625,0.317\n"
READ = {
    "capital H": SMALL.format("H,error"),
    "another order of the rows": "h,error\n0.0625,0.317\n0.25,1.78\n0.125,0.697\n",
    "quotes": '"h","error"\n"0.25","1.78"\n"0.125","0.697"\n"0.0625","0.317"\n',
    "a comma within a name": SMALL.format('h,"error, L2"'),
    "a trailing separator": "h, error,\n0.25, 1.78,\n0.125, 0.697,\n0.0625, 0.317,\n",
    "h and n": "h,n,error\n0.25,4,1.78\n0.125,8,0.697\n0.0625,16,0.317\n",
    "levels": "level,h,error\n0,0.25,1.78\n1,0.125,0.697\n2,0.0625,0.317\n",
    "underscores in numbers": "n,error\n1_0,1.78\n2_0,0.697\n4_0,0.317\n",
    "cells along the sides": "resolution,error\n4x4,1.78\n8x8,0.697\n16x16,0.317\n",
    "a row of units": "h,error\nm,-\n0.25,1.78\n0.125,0.697\n0.0625,0.317\n",
    "a row of types": " Row | h        error\n     | Float64  Float64\n"
    "   1 | 0.25     1.78\n   2 | 0.125    0.697\n   3 | 0.0625   0.317\n",
    "pairs in one line": "h: 0.25 Error: 1.78\nh: 0.125 Error: 0.697\nh: 0.0625 Error: 0.317\nRates [1.35 1.14]\n",
    "JSON": '[{"h": 0.25, "error": 1.78}, {"h": 0.125, "error": 0.697}, {"h": 0.0625, "error": 0.317}]',
    "nested JSON": '{"run": {"h": [0.25, 0.125, 0.0625], "errors": {"error": [1.78, 0.697, 0.317]}}}',
    "objects of JSON": '{"results": [{"h": 0.25, "errors": {"L2": 1.78}}, {"h": 0.125, "errors": {"L2": 0.697}},'
    ' {"h": 0.0625, "errors": {"L2": 0.317}}]}',
    "LaTeX of deal.II": "\\begin{tabular}{|c|c|} \\hline\n"
    "\\multicolumn{1}{|c|}{h} &\n\\multicolumn{2}{|c|}{error} \\\\ \\hline\n"
    "0.25 & 1.78 & - \\\\ \\hline\n0.125 & 0.697 & 1.36 \\\\ \\hline\n0.0625 & 0.317 & 1.14 \\\\ \\hline\n",
    "orders between errors": "variable  32->64  rate  64->128  rate  128->256\nrho  1.78  1.353  0.697  1.137  0.317\n",
    "a power of ten in brackets": SMALL.replace("1.78", "178(-2)").replace("0.697", "6.97(-1)").format("h,error"),
    "a blank before a percent sign": "h       rel. error\n0.25    178 %\n0.125   69.7%\n0.0625  31.7 %\n",
    "uncertainties": "h       error\n0.25    1.78 ± 0.01\n0.125   0.697 +/- 2e-3\n0.0625  0.317 ± 1e-3\n",
    "a grid with blanks": "Grid     L1 error\n4 x 4    1.78\n8 x 8    0.697\n16 x 16  0.317\n",
    "a name with letter and unit": SMALL.format("Mesh size h [m],error"),
    "words behind numbers between tabs": "h\terror\n0.25\t1.78\n0.125\t0.697 ok\n0.0625\t0.317\n",
    "lines that sum up": "h error\n0.25 1.78\n0.125 0.697\n0.0625 0.317\nmean 0.9\nElapsed 12.3\n",
    "meshes named max and min": "mesh h error\nmax 0.25 1.78\nmid 0.125 0.697\nmin 0.0625 0.317\n",
    "decimal commas in lines": "N = 8; Fehler = 1,78\nN = 16; Fehler = 0,697\nN = 32; Fehler = 0,317\n",
    "powers of ten in lines": "h = 0.25 err = 17.8 × 10⁻¹\nh = 0.125 err = 697 x 10^-3\nh = 0.0625 err = 31.7 %\n",
    "NumPy's numbers": "h = [0.25, 0.125, 0.0625]\nerr = [np.float64(1.78), np.float64(0.697), np.float64(0.317)]\n",
    "a numbered caption": "Table 1\nh error\n0.25 1.78\n0.125 0.697\n0.0625 0.317\n",
    "a tibble": "      h error\n  <dbl> <dbl>\n1 0.25   1.78\n2 0.125  0.697\n3 0.0625 0.317\n",
    "French powers": "| h | err |\n|-|-|\n| 1/4 | $178\\,10^{-2}$ |\n| 1/8 | $69.7\\,10^{-2}$ |\n| 1/16 | .317 |\n",
    "uncertain powers": "h,err\n0.25,17.8 ± 0.1 × 10⁻¹\n0.125,6.97 ± 0.01 × 10⁻¹\n0.0625,3.17 ± 0.01 × 10⁻¹\n",
    "smallest and largest cells": "hmin hmax error\n0.1 0.25 1.78\n0.09 0.125 0.697\n0.08 0.0625 0.317\n",
}  # fmt: skip


@pytest.mark.parametrize("form", READ)
def test_small_tables_in_many_forms_have_the_same_orders(form, rates):
    (column,) = json.loads(rates(READ[form], "--json"))
    assert column["orders"] == pytest.approx([1.3527, 1.1367], abs=1e-3)


@pytest.mark.parametrize(
    ("table", "orders"),
    {
        "h,u,p\n0.4,1.6,0.16\n0.2,0.4,0.08\n0.1,0.1,0.04\n": {"u": 2, "p": 1},
        "h,u,p\n0.4,1.6,-\n0.2,0.4,2.00\n0.1,0.1,2.00\n": {"u": 2},
        "h,CG,DG\n0.4,1.6,0.16\n0.2,0.4,0.08\n0.1,0.1,0.04\n": {"CG": 2, "DG": 1},
        "dt,Euler,Heun (2nd order)\n0.4,0.16,1.6\n0.2,0.08,0.4\n0.1,0.04,0.1\n": {"Euler": 1, "Heun (2nd order)": 2},
        "cells  val L2  grad L2\n16  1.6 -  0.16 -\n64  0.4 2.0  0.08 1.0\n256  0.1 2.0  0.04 1.0\n": {
            "val L2": 2,
            "grad L2": 1,
        },
        "h,L2,notes\n0.4,1.6,\n0.2,0.4,coarse\n0.1,0.1,\n": {"L2": 2},
        "|mass|h|err|\n|-|-|-|\n|total|.4|1.6|\n|total|.2|.8|\n|rate|.4|.16|\n|rate|.2|.04|\n": {
            "err (mass total)": 1,
            "err (mass rate)": 2,
        },
        "Degree 1\nh L2\n0.4 1.6\n0.2 0.8\n0.1 0.4\nDegree 2\nh L2\n0.4 1.6\n0.2 0.4\n0.1 0.1\n": {
            "L2 (Degree 1)": 1,
            "L2 (Degree 2)": 2,
        },
        "k;h;err\n1;0,4;1,6\n1;0,2;0,8\n2;0,4;1,6\n2;0,2;0,4\n": {"err (k 1)": 1, "err (k 2)": 2},
    }.items(),
)
def test_columns_of_errors_are_told_from_orders_counts_and_remarks(table, orders, rates):
    found = {column["name"]: column["orders"][-1] for column in json.loads(rates(table, "--json --dim 2"))}
    assert found == pytest.approx(orders, abs=1e-9)


TWO_ROWS = {
    "velocity L2, velocity H1, velocity Linf, pressure L2, pressure H1, pressure Linf": """
          velocity              pressure
  h     L2      H1     Linf     L2      H1     Linf
1/8  1.00e-2 1.00e-1 2.00e-1 1.00e-1 2.00e-1 3.00e-1
1/16 2.50e-3 5.00e-2 1.00e-1 5.00e-2 1.00e-1 1.50e-1
""",
    # Nothing shows where the second group begins: a number is better than a wrong name.
    "L2 (2), H1, L2 (4)": """
     velocity        pressure
 h     L2          H1        L2
1/8  1.00e-2     1.00e-1   1.00e-1
1/16 2.50e-3     5.00e-2   5.00e-2
""",
    "velocity L2, pressure L2": """
,velocity,,pressure,
h,L2,EOC,L2,EOC
1/8,1e-2,,1e-1,
1/16,2.5e-3,2,5e-2,1
""",
    r"$\|u-u_h\|_{L^2}$, $|u-u_h|_{H^{1}}$": r"""
& \multicolumn{2}{c}{$\|u-u_h\|_{L^2}$} & \multicolumn{2}{@{}c|}{$|u-u_h|_{H^{1}}$} \\ \cmidrule{2-5}
$h$ & error & EOC & error & EOC \\
1/8 & 1e-2 & & 1e-1 & \\
1/16 & 2.5e-3 & 2 & 5e-2 & 1 \\
""",
    "$k=1$, $k=2$": r"""
\multirow{2}{*}{$h$} & \multicolumn{2}{c|}{$k=1$} & \multicolumn{2}{c}{$k=2$} \\
 & error & rate & error & rate \\ \hline
1/8 & 1e-2 & & 1e-3 & \\
1/16 & 2.5e-3 & 2 & 1.25e-4 & 3 \\
""",
}
"""Names of the errors ↦ a table whose header has two rows."""


@pytest.mark.parametrize("names", TWO_ROWS)
def test_names_in_two_rows_belong_together(names):
    (series,) = read_series(TWO_ROWS[names], Options())
    assert ", ".join(series.errors) == names
    assert series.h == [1 / 8, 1 / 16]


@pytest.mark.parametrize(
    ("table", "options", "said"),
    [
        ("level error\n1 .64\n2 .16\n4 .01\n5 .0025\n", "--ratio 2", "levels in column level are not consecutive"),
        ("h,u,p\n4,1.6,-\n2,.4,2\n1,.1,2\n", "--expected p=1", "are u; left out, unless you give --columns"),
        ("h,err\n.4,.12\n.2,.03\n.1,0\n.05,.002\n", "", "exactly zero for h = 0.1, but not on all finer meshes"),
        ("h,err\n.4,.1\n.2,.025\n.1,.025\n.05,.00625\n.025,.0015625\n", "--expected 2", "undecided"),
        ("h,err\n.8,1\n.4,.25\n.2,.0625\n.1,.015625\n.05,0\n.025,.5\n", "--expected 2", "undecided"),
        ("h,err\n.4,.1\n.2,nan\n.1,.1\n", "", "0.2 nan nan"),
        ("h,drag\n.4,3.14\n.2,3.142\n.1,3.1425\n", "", "or are these orders or values of a quantity (--values), not"),
        ("h,drag\n.4,3.14\n.2,3.142\n.1,3.1425\n", "--values", "size: h from column h; values: drag"),
        ("level error\n4 .01\n3 .04\n2 .16\n1 .64\n", "--ratio 2", "orders 2.00, 2.00, 2.00"),
        ("level error\n1 .64\n2 .16\n3 .04\n4 .01\n", "--ratio 2", "orders 2.00, 2.00, 2.00"),
        ("Netz;Fehler\n1.024;0,16\n4.096;0,04\n16.384;0,01\n", "--in netz --dim 2", "0.03125 0.16"),
        ('h,"L2(0,T;H1)","e, max"\n.4,.4,.4\n.2,.1,.2\n.1,.025,.1\n', "--columns 'L2(0,T;H1),e, max'", "e, max: c"),
        ('h,"L2(0,T;H1)","e, max"\n.4,.4,.4\n.2,.1,.2\n.1,.025,.1\n', "--columns 'e, max'", "ignored: L2(0,T;H1)"),
        ("h,L2,H1,EOC,EOC\n4,16,4,-,-\n2,4,2,2,1\n1,1,1,2,1\n", "--in h", "ignored: EOC (4), EOC (5)"),
        ("steps error\n10 1e-2\n20 2.5e-3\n40 6.25e-4\n", "--in steps", "size: h = 1/steps"),
        ("h,‖u‖\n.4,.4\n.2,.1\n.1,.025\n", "--expected ‖u‖=2", "‖u‖: holds"),
        ("h,Größe,error\n.4,32,.16\n.2,128,.04\n.1,512,.01\n", "--columns=Größe --expected=2", "Größe: fails"),
    ],
)  # fmt: skip
def test_what_is_said_of_small_tables(table, options, said, rates):
    code = {"undecided": 3, "Größe: fails": 1}.get(said, 2 if "column" in said and "from" not in said else 0)
    assert said in rates(table, options, code)


ERRORS_OF_TWO = ["4.12E-02", "2.96E-02", "2.70E-02", "2.65E-02", "1.23E-02", "3.11E-03", "7.80E-04", "1.95E-04"]


def two_series(header, first, between=""):
    """A table in which a scheme of order 2 stands below a scheme that does not converge; its first column is given."""
    rows = [f"{cell},{error}" for cell, error in zip(first.split(","), ERRORS_OF_TWO, strict=True)]
    return "\n".join([header, *rows[:4], *([between] if between != "none" else []), *rows[4:]])


SPANNED = r"\multirow{4}{*}{central},,,,\multirow{4}{*}{upwind},,,"
SIGNS_OF_A_NEW_SERIES = {
    "printed orders begin again": """
L2;order
4.12E-02;-
2.96E-02;0.48
2.70E-02;0.13
2.65E-02;0.03
1.23E-02;- ok
3.11E-03;1.98
7.80E-04;2.00
1.95E-04;2.00
""",
    "levels": two_series("level,error", "1,2,3,4,1,2,3,4", "none"),
    "a blank line": two_series("cpu,error", "1,1,1,1,1,1,1,1"),
    "a rule": two_series("cpu,error", "1,1,1,1,1,1,1,1", "-----------"),
    "a word": two_series("flux,error", "central,central,central,central,upwind,upwind,upwind,upwind", "none"),
    "a spanned word": two_series("flux,error", SPANNED, "none").replace(",", " & ").replace("\n", " \\\\\n"),
    "sizes": two_series("n,error", "10,20,40,80,15,30,60,120", "none"),
    "equal sizes": two_series("n,error", "10,20,40,80,10,20,40,80", "none"),
}
"""How a table shows that a series ends ↦ the table."""


@pytest.mark.parametrize("sign", SIGNS_OF_A_NEW_SERIES)
def test_two_series_in_one_table_never_hold_as_one(sign, rates):
    for options in ("--expected 2", "--expected 2 --ratio 2", "--expected 2 --in n"):
        rates(SIGNS_OF_A_NEW_SERIES[sign], options, 1, 2)


CASE_TABLES = {
    "degree": """
degree,n,L2
1,8,4e-2
1,16,1e-2
1,32,2.5e-3
2,8,8e-3
2,16,1e-3
2,32,1.25e-4
""",
    "degree once for a case": """
| p | n | L2 |
|--|--|--|
| 1 | 8 | 4e-2 |
|  | 16 | 1e-2 |
|  | 32 | 2.5e-3 |
| 2 | 8 | 8e-3 |
|  | 16 | 1e-3 |
|  | 32 | 1.25e-4 |
""",
    "multirow": r"""
$k$ & $N$ & error \\
\multirow{3}{*}{1} & 8 & 4e-2 \\
 & 16 & 1e-2 \\
 & 32 & 2.5e-3 \\
\multirow{3}{*}{2} & 8 & 8e-3 \\
 & 16 & 1e-3 \\
 & 32 & 1.25e-4 \\
""",
    "method": """
scheme,n,err
BDF1,8,4e-2
BDF1,16,1e-2
BDF1,32,2.5e-3
BDF2,8,8e-3
BDF2,16,1e-3
BDF2,32,1.25e-4
""",
    "name = value": """
Pk = 1
Nx = 8
error = 4e-2
Pk = 1
Nx = 16
error = 1e-2
Pk = 1
Nx = 32
error = 2.5e-3
Pk = 2
Nx = 8
error = 8e-3
Pk = 2
Nx = 16
error = 1e-3
Pk = 2
Nx = 32
error = 1.25e-4
""",
    "headings": """
### P1

|n|e|
|-|-|
|8|4e-2|
|16|1e-2|
|32|2.5e-3|

### P2

|n|e|
|-|-|
|8|8e-3|
|16|1e-3|
|32|1.25e-4|
""",
    "JSON": '{"P1": {"n": [8, 16, 32], "L2": [4e-2, 1e-2, 2.5e-3]}, "P2": {"n": [8, 16, 32], "L2": [8, 1, 0.125]}}',
    "lists": """
n = [8, 16, 32]
err = [4e-2, 1e-2, 2.5e-3]
n = [8, 16, 32]
err = [8e-3, 1e-3, 1.25e-4]
""",
}
"""How a table shows that it has two cases ↦ the table, of the orders 2 and 3."""


@pytest.mark.parametrize("form", CASE_TABLES)
def test_a_column_or_a_heading_splits_a_table_into_cases(form, rates):
    first, second = json.loads(rates(CASE_TABLES[form], "--json"))
    assert [first["order"], second["order"]] == pytest.approx([2, 3])
    label = second["table"]["label"]
    assert label not in ("", first["table"]["label"])
    rates(CASE_TABLES[form], f"--expected '{label}=3'")
    rates(CASE_TABLES[form], f"--expected '{label}=2'", 1)


@pytest.mark.parametrize(
    ("data", "words"),
    {
        b"": "is empty",
        b"h,error\n": "no line with numbers",
        b"h: .5, .25\nP1:\nL2: 1, .5\nP2:\nL2: 1, .5, .25\n": "h has 2 values, expected 3, one for each mesh",
        b"\x89PNG\r\n\x1a\n" + bytes(range(256)): "binary",
        b"h,error\n0.25,1.78\0\n": "line 2",
        "h,error\n.25,1\n.125,−0.5\n": "expected a number that is not negative",
        b"h,error\n1," + b"1" * 2_100 + b"\n.5,1\n": "line 2: error is '1111",
        b"h,error\n" + b"1,1\n" * 110_000: "100000 lines",
        b"h,error\n" + b"0.123456789,0.123456789\n" * 1_000_000: "more than 8 MB",
        b"h,error\n1,abc\n.5,1\n": "line 2: error is 'abc', expected a number",
        b"h,error\n.1,.2\n.1000000000001,.21\n.05,.1\n": "the mesh size 0.1 occurs twice: give one error for each",
        b"0.25 0.0131\n0.125 0.00661\n": "has 2 columns, but no line above names them: add a header such as 'h error'",
        b"word " * 20_000 + b": 1": "no table was recognised",
        (b"x" * 1_990 + b" ") * 60: "no line with numbers",
        (b"1" * 1_990 + b" ") * 60: "no table was recognised",
        b"x " * 70_000: "a line of more than 130000 characters",
        b"|1" * 20_000: "no table was recognised",
        b"h: 1 " * 10_000: "no column of errors among h (size)",
        b"elements,error\n32,.16\n128,.04\n512,.01\n": "column elements is a count",
        "h,Größe\n.4,32\n.2,128\n.1,512\n": "column Größe has whole numbers: numbers of cells, iterations or "
        "seconds, or errors? Name",
        b"Weite;Fehler;EOC\n.4;.16;\n.2;.04;2.0\n.1;.01;2.0\n": "no column is a mesh size; seen: Weite, Fehler, EOC",
        b"h,order\n1,-\n.5,2\n": "no column of errors among h (size), order (order)",
        b"h,L2,H1\n1,.1,.2\n.5,.05,\n": "line 3: H1 is '', expected a number that is not negative: write a number "
        "there, delete the line, or name the columns of errors with --columns",
        "degree,L2\n1,1e-1\n2,1e-2\n3,1e-3\n": "(p-refinement)",
        "p,L2\n1,1e-1\n2,1e-2\n3,1e-3\n": "(p-refinement)",
        "polynomial degree,L2\n1,1e-1\n2,1e-2\n3,1e-3\n": "(p-refinement)",
        b"h err\n1 .1\n.5 ****\n": "line 3: err is '****', expected a number",
        b"log10(h) log10(err)\n-1 -2\n-1.3 -2.6\n-1.6 -3.2\n": "column log10(h) holds logarithms",
        b"h,log_err\n1,5.1\n.5,4.5\n": "column log_err holds logarithms",
        b"u 1e17 3.8 1e16 3.9 1e15\nv 4e3 1e20 2e3 1e300 1e3\n": "no line above names them",
        b"h u v\n.4 1 1\n.2 .5 .5\n.1 failed failed\n": "line 4: u is 'failed', expected a number",
        b"h err\n.4 1\n.2 .5\n.1 out of memory\n": "line 4: 4 entries, expected 2: '.1 out of memory'; write nan if",
        b"h err\n.4 1 (coarse)\n.2 .5\n.1 .25\n": "line 2: 3 entries, expected 2: '.4 1 (coarse)'",
        b"h err EOC\n.4 1 -\n.2 .5 1 ok\n.1 .25 1\n": "line 3: 4 entries, expected 3: '.2 .5 1 ok'",
        b"h = [.4, .2, .1]\nu = [4.5, 2, 1]\np = [.4, None, None]\n": "value 2: p is 'None', expected a number",
        b"h=.4 u=.4 p=.4\nh=.2 u=.2 p=failed\nh=.1 u=.1 p=failed\n": "value 2: p is 'failed', expected a number",
        b"h=.4 u=.4\nh=.2\nh=.1 u=.1\n": "u has 2 values, expected 3, one for each mesh: write nan where a comp",
        b"n,err/order\n8,1.6e-2/-\n16,4e-3/2.0\n": "no column of errors among n (count), err/order (text)",
        b"Elapsed 12.3\nn cells  H1  L2\n0 64 2.8 - - 1.8 - -\n1 256 1.2 2 1 .4 4 2\n": "cells is a count",
        b"[0.4, 0.2, 0.1]\n[1.6, 0.4, 0.1]\n": "no table was recognised",
        b"[0.4 0.2 0.1 0.05]\n[1.6 0.4 0.1 0.025]\n": "has 4 columns, but no line above names them",
    }.items(),
)
def test_damaged_and_hostile_files_are_refused_in_words(data, words, rates):
    start = time.process_time()
    assert words in rates(data, "", 2)
    assert time.process_time() - start < 2


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252"])
@pytest.mark.parametrize("ends", ["\n", "\r\n", "\r"])
def test_one_table_in_every_encoding_gives_the_same_orders(encoding, ends, rates):
    rows = [("h", "error"), ("1/4", "1.6D-1"), ("0.125", "4×10^-2"), ("6.25e-2", "1%")]
    table = ends.join(";".join(row) for row in rows).encode(encoding)
    (column,) = json.loads(rates(table, "--expected 2 --json"))
    assert column["orders"] == pytest.approx([2, 2])


def test_many_rows_and_many_columns_are_read_within_seconds(rates):
    start = time.process_time()
    rates("h,error\n" + "".join(f"{1 / n!r},{1 / n**2!r}\n" for n in range(2, 3_000)), "--expected 2")
    wide = f"h{',e' * 200}\n" + "".join(f"{h}{f',{h}' * 200}\n" for h in (1, 0.5, 0.25, 0.125))
    assert rates(wide, "--expected 1").count(": holds: ") == 200
    assert time.process_time() - start < 4


@pytest.mark.parametrize(
    ("name", "numbers", "code"),
    [
        ("Anzahl Elemente", "32 128 512 2048", 2),
        ("セル数", "32.0 128.0 512.0 2048.0", 2),
        ("wrong pixels", "64 16 4 1", 2),
        ("N", "32 128 512 2048", None),
        ("error in cells", "64 16 4 1", 0),
        ("error in cells", "1 2 4 8", 1),
        ("velocity", "2.0e+0 3.0e+1 4.0e+2 5.0e+3", 1),
        ("velocity", "1.5 2.5 4 8", 1),
        ("wrong pixels", "0 0 0 0", 0),
    ],
)
def test_whole_numbers_with_an_unknown_name_are_asked_for_and_other_numbers_judged(name, numbers, code, rates):
    """A name of counts is ignored."""
    rows = [f"{size};{number};{size**2}" for size, number in zip((1, 0.5, 0.25, 0.125), numbers.split(), strict=True)]
    table = "\n".join([f"h;{name};error", *rows])
    said = rates(table, "--expected 2", code or 0)
    assert {None: f"ignored: {name}", 2: f"column {name} has whole numbers"}.get(code, f"errors: {name}, error") in said
    assert f"ignored: {name}" in rates(table, "--columns error --expected 2")
