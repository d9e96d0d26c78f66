"""What the README shows is what the data say, and what it tells a newcomer to type works."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest

from study.cli.main import parser
from study.ledger.datafiles import DataError, read_claims, read_csv, write_csv
from study.ledger.rounding import above, below
from study.present.article.source import FullRun
from study.present.readme import headline, refresh
from study.statements.prop_5_3 import LIMIT
from study.statements.prop_5_4.from_rates import Turned
from study.statements.prop_5_4.judge import NOT_AT_START

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")
LINES = [line for block in re.findall(r"```sh\n(.*?)```", TEXT, re.DOTALL) for line in block.strip().splitlines()]
STUDY = [line for line in LINES if line.startswith(".venv/bin/study ")]
MINUTES = ("bound",)
"""Commands that take a minute, for the slow tests."""
PROSE = re.sub(r"```.*?```|^\|.*?$", "", TEXT, flags=re.DOTALL | re.MULTILINE)
"""The README without its blocks and tables."""
INLINE = re.findall(r"`((?:make|study|\.venv/bin/\w+|python|pip|dask|sudo)\s[^`]+)`", PROSE)
CI = re.findall(r"^(?:make|\.venv/bin/study) .*$", (ROOT / ".ci" / "run").read_text(encoding="utf-8"), re.MULTILINE)
ELSEWHERE = {
    "make docs": "project/test_habits.py::test_the_pages_of_the_api_are_made_without_a_warning",
    "dask scheduler": "run/test_cluster.py::scheduler",
    "dask worker": "run/test_cluster.py::cluster",
    "study run --cluster": "run/test_cluster.py::"
    "test_two_workers_on_loopback_give_the_same_files_as_processes_byte_for_byte",
}
"""How a command begins ↦ the test or fixture that runs it."""
EXCLUDED = {
    "make full": "half an hour: the nightly workflow runs it",
    "make bench": "times the machine",
    "make seeds": "three quarters of an hour: the nightly workflow runs it",
    "study seeds": "the quick study twenty times: test_seeds.py looks at what it wrote",
    "sudo apt-get": "changes the system, for peers that are optional",
    ".venv/bin/pip install osqp": "changes the environment, for a peer that is optional",
    "pip install '.[cluster]'": "the environment of the tests has Dask",
}
"""How a command begins that nothing runs ↦ why."""


def is_one_of(line: str, commands: Iterable[str]) -> bool:
    """Whether a line to type is the beginning of a command; words in capitals stand for any other."""
    mine, *others = (shlex.split(text.removeprefix(".venv/bin/"), comments=True) for text in (line, *commands))
    starts = [other[: len(mine)] for other in others if len(other) >= len(mine)]
    return any(all(word.isupper() or word == same for word, same in zip(mine, other, strict=True)) for other in starts)


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", TEXT, re.DOTALL)


def outwards(ends: tuple[float, float]) -> tuple[float, float]:
    """An interval to three decimals that contains it."""
    return float(below(ends[0], 3)), float(above(ends[1], 3))


@pytest.fixture
def newcomer(tmp_path: Path) -> Path:
    """A directory with the files that the README tells to save."""
    for name, code in zip(("pocket.py", "wedge.py"), blocks("python"), strict=True):
        (tmp_path / name).write_text(code)
    (table,) = blocks("csv")
    (tmp_path / "errors.csv").write_text(table)
    return tmp_path


def test_the_tables_of_the_readme_come_from_the_committed_data(tmp_path: Path) -> None:
    copy = tmp_path / "README.md"
    copy.write_text(TEXT, encoding="utf-8")
    assert not refresh(copy, ROOT / "results"), "run: .venv/bin/python -m study.present.readme README.md results"


def test_the_orders_at_its_head_are_those_of_the_errors_measured() -> None:
    """Worked out here from ``rates.csv`` alone, fits over the four finest meshes, not from the verdicts."""
    rates = read_csv(ROOT / "results", "rates.csv", ["claim", "case", "family", "h", "error"])
    rates = rates[rates["claim"] == "Prop. 5.4"].sort_values("h", ascending=False)
    fits, orders = [], []
    for _, rows in rates.groupby(["case", "family"]):
        h, error = np.log(rows["h"]), np.log(rows["error"])
        fits.append(np.polyfit(h[-4:], error[-4:], 1)[0])
        orders += list(np.diff(error) / np.diff(h))
    (row,) = re.findall(r"fitted orders (\S+) … (\S+), level by level (\S+) … (\S+) \|", TEXT)
    shown = [float(value) for value in row]
    assert shown == pytest.approx([min(fits), max(fits), min(orders), max(orders)], abs=0.01)
    assert shown[0] <= min(fits) <= max(fits) <= shown[1]
    assert shown[2] <= min(orders) <= max(orders) <= shown[3]


def test_what_its_head_says_is_at_most_so_large_is_not_larger_and_hardly_smaller() -> None:
    strains = read_csv(ROOT / "results", "equivalence.csv", ["stress_gap", "stress_bound"])
    claims = read_claims(ROOT / "results")
    shares = claims.loc[(claims["label"] == "bound") & (claims["key"] == "above"), "high"]
    limits = claims.loc[(claims["label"] == "Prop. 5.3") & (claims["key"] == "limit"), "high"]
    bound, gap = strains["stress_bound"].max(), strains["stress_gap"].max()
    for text, largest, digit in (
        (r"at most (\S+) by its duality gap", bound, bound / 10),
        (r"stresses differ by at most (\S+) \|", gap, gap / 10),
        (r"error / bound at most (\S+) \|", shares.max(), 1e-3),
        (r"a positive limit is at most (\S+) % of", 100 * limits.max(), 1),
    ):
        (shown,) = map(float, re.findall(text, TEXT))
        assert largest <= shown < largest + digit, text


def test_the_row_on_smoothness_shows_whatever_orders_were_seen_and_gives_no_verdict(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "results" / "data", tmp_path / "data")
    claims = read_claims(tmp_path)
    claims.loc[claims["label"] == "(5.36)", ["observed", "low", "high"]] = [0.604, 0.604, 0.706]
    write_csv(tmp_path / "data" / "claims.csv", claims)
    data = FullRun.read(tmp_path)
    assert data is not None
    (row,) = [line for line in headline(data).splitlines() if "(5.36)" in line]
    assert row.endswith("| orders 0.60 … 0.71 | reported |")


def test_the_cases_it_names_for_an_error_largest_at_the_start_are_those_of_the_data() -> None:
    rates = read_csv(ROOT / "results", "rates.csv", ["claim", "case", "error", "initial_error"])
    rates = rates[rates["claim"] == "Prop. 5.4"]
    found = set(rates.loc[rates["initial_error"] >= NOT_AT_START * rates["error"], "case"])
    (named,) = re.findall(r"In two cases, \*(\S+)\* and \*(\S+)\*, the largest error is that at t = 0", TEXT)
    assert found == set(named)


def test_windows_it_names_in_its_text_are_those_of_the_program() -> None:
    told, axes = " ".join(TEXT.split()), {rule.key: rule.window for rule in Turned.rules}
    for window, words, value in (
        (LIMIT, "at most 10 % of the two finest errors", 0.1),
        (axes["errors"], "must equal those of the former to 10⁻¹⁰ of their size", 1e-10),
        (axes["discrete-error"], "rounding counts about h⁻² times, to 10⁻⁷", 1e-7),
    ):
        assert words in told
        assert window.high == value


def test_a_readme_without_marks_is_refused(tmp_path: Path) -> None:
    (tmp_path / "README.md").write_text("# Nothing\n")
    with pytest.raises(DataError, match="lacks <!-- headline -->"):
        refresh(tmp_path / "README.md", ROOT / "results")


def test_data_that_are_not_of_a_full_run_are_refused(tmp_path: Path) -> None:
    (tmp_path / "README.md").write_text(TEXT, encoding="utf-8")
    with pytest.raises(DataError, match="not that of a full run: `make full`"):
        refresh(tmp_path / "README.md", tmp_path)
    assert (tmp_path / "README.md").read_text(encoding="utf-8") == TEXT


def test_every_line_to_type_is_run_by_a_test_or_by_ci_or_has_a_reason_why_not() -> None:
    """Those of blocks and those within the prose; what ``STUDY`` has is run below."""
    told = [*LINES, *INLINE]
    assert {".venv/bin/study report --out results/quick", "study check", "make paper"} <= set(INLINE)
    left = [line for line in told if not is_one_of(line, [*CI, *STUDY])]
    assert [line for line in left if not line.startswith((*ELSEWHERE, *EXCLUDED))] == []
    assert [start for start in (*ELSEWHERE, *EXCLUDED) if not any(line.startswith(start) for line in left)] == []


@pytest.mark.parametrize("place", ELSEWHERE.values())
def test_what_runs_the_others_is_there(place: str) -> None:
    file, _, name = place.partition("::")
    assert f"def {name}(" in (ROOT / "tests" / file).read_text(encoding="utf-8")


def test_a_line_is_run_if_it_begins_a_command_that_is() -> None:
    run = [".venv/bin/study check --junit results/junit.xml --out results", "make study"]
    assert is_one_of("study check", run)
    assert is_one_of("study check --junit FILE", run)
    assert is_one_of("make study    # some minutes", run)
    assert not is_one_of("study check --out results", run)
    assert not is_one_of("study tables", run)
    assert not is_one_of("make studies", run)


@pytest.mark.parametrize(
    "line",
    [pytest.param(x, marks=pytest.mark.slow if shlex.split(x)[1] in MINUTES else ()) for x in STUDY],
    ids=lambda line: shlex.split(line)[1],
)
def test_a_command_of_the_readme_ends_with_success(newcomer: Path, line: str) -> None:
    command = [str(Path(sys.executable).with_name("study")), *shlex.split(line)[1:]]
    done = subprocess.run(command, cwd=newcomer, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_intervals_in_the_text_are_those_of_the_same_problem_in_the_data() -> None:
    """The wedge of the README is the problem ``ramp`` of the study."""
    bounds = read_csv(ROOT / "results", "bounds.csv", ["trajectory", "case", "level", "lowest", "highest"])
    ramp = bounds[(bounds["case"] == "ramp") & (bounds["trajectory"] == "enclosure")].sort_values("level")
    text = " ".join(TEXT.split())
    ends = re.search(r"lies in \[(.*?)\] and \[(.*?)\] on the two .* lies in \[(.*?)\] on the third", text)
    typed = [tuple(map(float, pair.split(", "))) for pair in ends.groups()]
    # Rounded outwards, or they would not enclose.
    assert typed == [outwards(row) for row in zip(ramp["lowest"], ramp["highest"], strict=True)]


def test_so_is_the_interval_for_the_order() -> None:
    claims = read_claims(ROOT / "results")
    rows = claims[(claims["label"] == "enclosure") & (claims["case"] == "ramp") & (claims["key"] == "order")]
    (row,) = rows.itertuples()
    levels = re.search(r"`--levels ([\d ]+)`, a minute more", TEXT)
    first, *_, last = levels[1].split()
    assert f"n = {first} to {last}, {row.family} meshes" in row.quantity
    typed = re.search(r"from the first to the last in \[(.*?)\]", " ".join(TEXT.split()))
    assert tuple(map(float, typed[1].split(", "))) == outwards((row.low, row.high))


def targets() -> set[str]:
    return set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))


def test_every_make_target_of_the_readme_exists() -> None:
    assert set(re.findall(r"(?:`|^)make ([a-z-]+)", TEXT, re.MULTILINE)) <= targets()


def test_the_commands_of_the_table_are_those_of_the_program() -> None:
    table = TEXT[TEXT.index("## Commands") : TEXT.index("## From statement")]
    listed = set(re.findall(r"`study ([a-z]+)", table))
    (commands,) = [action for action in parser()._actions if action.choices]
    assert listed == set(commands.choices)


def test_files_named_in_the_readme_exist() -> None:
    named = re.findall(r"`((?:study|manufactured|tests|paper|results|examples)/[\w./-]*)`", TEXT)
    missing = [name for name in named if not (ROOT / name).exists() and "/quick" not in name]
    assert missing == []
