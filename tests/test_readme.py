"""What the README shows is what the data say, and what it tells a newcomer to type works."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from study.cli import parser
from study.datafiles import DataError, read_claims, read_csv, write_csv
from study.overview import headline, refresh

ROOT = Path(__file__).parents[1]
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")
LINES = [line for block in re.findall(r"```sh\n(.*?)```", TEXT, re.DOTALL) for line in block.strip().splitlines()]
STUDY = [line for line in LINES if line.startswith(".venv/bin/study ")]
MINUTES = ("bound",)
"""Commands that take a minute, for the slow tests."""


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", TEXT, re.DOTALL)


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
    assert not refresh(copy, ROOT / "results"), "run: .venv/bin/python -m study.overview README.md results"


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
    shares = claims.loc[(claims["label"] == "bound") & (claims["quantity"] == "largest error / upper bound"), "high"]
    limits = claims.loc[claims["quantity"].str.startswith("limit e∞"), "high"]
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
    (row,) = [line for line in headline(tmp_path).splitlines() if "(5.36)" in line]
    assert row.endswith("| orders 0.60 … 0.71 | reported |")


def test_a_readme_without_marks_is_refused(tmp_path: Path) -> None:
    (tmp_path / "README.md").write_text("# Nothing\n")
    with pytest.raises(DataError, match="lacks <!-- headline -->"):
        refresh(tmp_path / "README.md", ROOT / "results")


def test_every_line_to_type_is_known_here() -> None:
    """So that no command slips in that nothing runs."""
    others = [line for line in LINES if line not in STUDY]
    assert {line.split()[0] for line in others} <= {"make", "sudo", ".venv/bin/pip"}
    assert {shlex.split(line)[1] for line in STUDY} == {"run", "rates", "bound"}


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
    ends = zip(np.floor(1000 * ramp["lowest"]), np.ceil(1000 * ramp["highest"]), strict=True)
    assert typed == [(low / 1000, high / 1000) for low, high in ends]


def targets() -> set[str]:
    return set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))


def test_every_make_target_of_the_readme_exists() -> None:
    assert set(re.findall(r"(?:`|^)make ([a-z-]+)", TEXT, re.MULTILINE)) <= targets()


@pytest.mark.parametrize("target", ["study", "test", "controls", "paper"])
def test_ci_runs_what_the_readme_tells_a_newcomer_to_make(target: str) -> None:
    assert f"make {target}" in (ROOT / ".ci" / "run").read_text(encoding="utf-8")


def test_the_commands_of_the_table_are_those_of_the_program() -> None:
    table = TEXT[TEXT.index("## Commands") : TEXT.index("## From statement")]
    listed = set(re.findall(r"`study ([a-z]+)", table))
    (commands,) = [action for action in parser()._actions if action.choices]
    assert listed == set(commands.choices)


def test_files_named_in_the_readme_exist() -> None:
    named = re.findall(r"`((?:study|manufactured|tests|paper|results|examples)/[\w./-]*)`", TEXT)
    missing = [name for name in named if not (ROOT / name).exists() and "/quick" not in name]
    assert missing == []
