"""Which mutants of a sample do the tests let live? `make mutants`.

    python -m mutation.run [--count N] [--minutes M] [--jobs N] [--seed S] [--out DIRECTORY]

Every mutant has a process of its own, forked from one that holds everything that is imported from elsewhere; there the
module has its mistake, and the tests of its part run until one fails. What is on record in ``mutants.csv`` is not run
again, so that a run can be stopped, and the next one adds to it: mutants come in an order that the seed gives. Only
those that live, and of which the page does not say why, are run once more, and first: a test may have been written for
them. What noticed a mutant when it was tried first is kept beside what notices it today: others would meet tests that
were written without them, too.
"""

from __future__ import annotations

import argparse
import os
import random
import re
import resource
import signal
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import astuple, fields
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from pathlib import Path
from time import monotonic

import hypothesis.strategies  # noqa: F401  held, so that children need not read them again
import pandas as pd
import pytest
import skfem  # noqa: F401
import sympy  # noqa: F401
from scipy.stats import binomtest

from mutation.gates import every_mutant, gate_of
from mutation.mutants import Mutant, mutated
from study.present.marks import put

ROOT = Path(__file__).parents[2]
OUT = ROOT / "results" / "mutants"
PAGE = ROOT / "docs" / "explanation" / "mutants.md"
SEED = 2026
SECONDS = 240
"""Processor time after which a mutant counts as noticed: somebody would."""
LIVES, NOTHING_RUN = "lives", 5
PLACE = [field.name for field in fields(Mutant)]
COLUMNS = ["part", *PLACE, "at_first", "noticed_by"]
LISTED = re.compile(r"^\| `([^`]+)` \| (?:`([^`]+)` )?\| `(.+?)` → `(.+?)` \| .{10,} \|$", re.MULTILINE)
"""A line of the page: module, function (none for what stands in the module), change and why no test sees it."""


class Mistaken(MetaPathFinder):
    """Gives one module other code."""

    def __init__(self, mutant: Mutant) -> None:
        self.mutant, self.code = mutant, mutated(ROOT, mutant)

    def find_spec(self, fullname, path=None, target=None) -> ModuleSpec | None:
        if fullname != self.mutant.module:
            return None
        spec = PathFinder.find_spec(fullname, path, target)
        assert spec is not None
        assert spec.origin is not None
        spec.loader = _Loader(fullname, spec.origin, self.code)
        return spec


class _Loader(SourceFileLoader):
    def __init__(self, name: str, path: str, code: str) -> None:
        super().__init__(name, path)
        self.text = code

    def get_code(self, fullname: str):
        return compile(self.text, self.path, "exec")


class First:
    """Remembers the first test that failed."""

    def __init__(self) -> None:
        self.name = ""

    def pytest_runtest_logreport(self, report) -> None:
        if report.failed:
            # The file and the test, without its parameters.
            self.name = self.name or report.nodeid.partition("[")[0].removeprefix("tests/")

    def pytest_collectreport(self, report) -> None:
        if report.failed:
            self.name = self.name or f"import: {report.nodeid}"


def tried(mutant: Mutant, said: Path) -> int:
    """In a process of its own: run the tests of a mutant, write the name of the first that fails, return the pid."""
    sys.stdout.flush()
    if pid := os.fork():
        return pid
    try:
        with said.with_suffix(".log").open("w") as log:
            os.dup2(log.fileno(), 1)
            os.dup2(log.fileno(), 2)
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS + 5))
        os.chdir(said.parent)
        said.write_text(_noticed_by(mutant), encoding="utf-8")
    finally:
        os._exit(0)


def _noticed_by(mutant: Mutant) -> str:
    gate, first = gate_of(mutant.module), First()
    assert gate is not None
    tests = gate.tests_of(mutant.module)
    for name in [name for name in sys.modules if name.partition(".")[0] in ("study", "manufactured")]:
        del sys.modules[name]
    sys.meta_path.insert(0, Mistaken(mutant))
    os.chdir(ROOT)
    options = ["-x", "-q", "--tb=no", "-p", "no:cacheprovider", "-p", "no:xdist", f"--rootdir={ROOT}"]
    code = pytest.main([*options, *tests], plugins=[first])
    return first.name or (LIVES if code in (0, NOTHING_RUN) else f"pytest: {int(code)}")


def outcomes(mutants: Sequence[Mutant], jobs: int, deadline: float) -> Iterator[tuple[Mutant, str]]:
    """Mutants with what noticed them, as they are done."""
    running: dict[int, tuple[Mutant, Path]] = {}
    with tempfile.TemporaryDirectory() as directory:
        for number, mutant in enumerate(mutants):
            if monotonic() > deadline:
                break
            said = Path(directory) / str(number)
            running[tried(mutant, said)] = mutant, said
            if len(running) >= jobs:
                yield _ended(running)
        while running:
            yield _ended(running)


def _ended(running: dict[int, tuple[Mutant, Path]]) -> tuple[Mutant, str]:
    pid, status = os.wait()
    mutant, said = running.pop(pid)
    late = os.WIFSIGNALED(status) and os.WTERMSIG(status) in (signal.SIGXCPU, signal.SIGKILL)
    text = said.read_text(encoding="utf-8") if said.is_file() else ""
    return mutant, text or ("no end" if late else "crash")


def kept(out: Path) -> pd.DataFrame:
    """What is on record."""
    file = out / "mutants.csv"
    return pd.read_csv(file, dtype=str, keep_default_na=False) if file.is_file() else pd.DataFrame(columns=COLUMNS)


def explained(page: Path) -> set[tuple[str, ...]]:
    """(module, function, before, after) of what may live, as the page says why."""
    found = LISTED.findall(page.read_text(encoding="utf-8"))
    return {tuple(text.replace("\\|", "|") for text in place) for place in found}


def summary(out: Path) -> str:
    """A line for every part, in Markdown: mutants, how many were tried and live, and what share lived at first.

    Of the first ones it is not known whether they lived at first; they do not count for the share.
    """
    table, parts = kept(out), pd.read_csv(out / "parts.csv")
    lines = ["| part | mutants | tried | live | lived at first |", "|---|---|---|---|---|"]
    for part, count in [*zip(parts["part"], parts["mutants"], strict=True), ("all", parts["mutants"].sum())]:
        mine = table if part == "all" else table[table["part"] == part]
        live, known = int((mine["noticed_by"] == LIVES).sum()), mine[mine["at_first"] != ""]
        lived = int((known["at_first"] == LIVES).sum())
        low, high = binomtest(lived, len(known)).proportion_ci(method="exact") if len(known) else (0.0, 1.0)
        share = f"{lived} of {len(known)}: {100 * low:.0f} … {100 * high:.0f} %" if len(known) else ""
        lines.append(f"| {part} | {count} | {len(mine)} | {live} | {share} |")
    return "\n".join([*lines, ""])


def to_try(mutants: Sequence[Mutant], table: pd.DataFrame, explained: set[tuple[str, ...]]) -> list[Mutant]:
    """Those on record that live without a reason, then those that are not on record."""
    lived = {tuple(place): by == LIVES for *place, by in table[[*PLACE, "noticed_by"]].itertuples(index=False)}
    named = [(mutant, tuple(map(str, astuple(mutant)))) for mutant in mutants]
    again = [mutant for mutant, place in named if lived.get(place) and place[:-1] not in explained]
    return again + [mutant for mutant, place in named if place not in lived]


def refresh(page: Path, out: Path) -> None:
    """Put the summary into a page between its marks."""
    page.write_text(put(page.read_text(encoding="utf-8"), "mutants", summary(out)), encoding="utf-8")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, help="how many mutants are to be on record in the end (default: all)")
    parser.add_argument("--minutes", type=float, default=120.0, help="after how many none is begun any more")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--out", type=Path, default=OUT)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    parts = every_mutant(ROOT)
    sizes = pd.DataFrame({"part": list(parts), "mutants": [len(found) for found in parts.values()]})
    sizes.assign(seed=options.seed).to_csv(options.out / "parts.csv", index=False)
    chosen = [mutant for found in parts.values() for mutant in found]
    random.Random(options.seed).shuffle(chosen)
    table = kept(options.out)
    chosen = to_try(chosen[: options.count], table, explained(PAGE))
    for mutant, by in outcomes(chosen, options.jobs, monotonic() + 60 * options.minutes):
        part, place = gate_of(mutant.module), list(map(str, astuple(mutant)))
        assert part is not None
        same = (table[PLACE] == place).all(axis=1)
        if same.any():
            table.loc[same, "noticed_by"] = by
        else:
            table.loc[len(table)] = [part.name, *place, by, by]
        with suppress(OSError):
            print(f"{by[:60]:60}  {mutant.module} {mutant.function}: {mutant.before} → {mutant.after}", flush=True)
        table.sort_values(PLACE).to_csv(options.out / "mutants.csv", index=False)
    if options.out == OUT:
        refresh(PAGE, OUT)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(f"{(used.ru_utime + used.ru_stime) / 60:.1f} minutes of processor time")
    print(f"{(table['noticed_by'] == LIVES).sum()} of {len(table)} mutants on record live")


if __name__ == "__main__":
    main()
