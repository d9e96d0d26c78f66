"""``make codes``: run the codes that are installed on tasks of this study, say how to get the others, keep the errors.

    python run_codes.py [--mode march] [--only ADAPTER ...] [--cases NAME ...] [--families NAME ...] [--levels N ...]
                        [--out DIR] [--tasks DIR] [--check]

Each adapter runs in the Python that has its code: this one, that of build/codes-venv, or Debian's. Rows of codes that
do not run stay as they are. In a march each task has as many steps of the midpoint rule as its level.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from contact_judge import GOOD, Errors, classify

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
RESULTS = ROOT / "results" / "codes"
WHEELS, DEBIAN = ROOT / "build" / "codes-venv" / "bin" / "python", Path("/usr/bin/python3")
PLANE = (
    "advance-recede",
    "rotated",
    "corner",
    "layered",
    "anisotropic",
    "lift-and-land",
    "examples/codes/nearly_incompressible.py:case",
)
SOLID = {"cube-disc": (4, 8), "cube-two-faces": (3, 6)}
NUMBERS = {
    **dict.fromkeys(("error", "best"), 4),
    "discrete": 3,
    **dict.fromkeys(("distance", "pressure", "best_pressure"), 4),
    **dict.fromkeys(("penetration", "resultant", "tangential"), 3),
}
"""What is kept of an answer, and to how many digits."""
OF_EXACT = {"error": 17, "distance": 9}
"""Digits where a code is exact: the ledger compares its error with ours, and codes with each other by distances."""


@dataclass(frozen=True)
class Study:
    """What a mode runs unless it is told otherwise, and where its results are."""

    adapters: tuple[str, ...]
    cases: tuple[str, ...]
    families: tuple[str, ...]
    levels: tuple[int, ...]
    out: Path
    tasks: Path


@dataclass(frozen=True)
class Adapter:
    """A module beside this one, the Python for it, what must be there and how one gets it."""

    name: str
    python: Path
    imports: tuple[str, ...]
    get: str
    program: str = ""

    def missing(self) -> bool:
        if not self.python.exists() or (self.program and not shutil.which(self.program)):
            return True
        return self.run("-c", "import " + ", ".join(self.imports), capture_output=True).returncode != 0

    def run(self, *arguments: object, **options) -> subprocess.CompletedProcess:
        # The wheel of MPICH has its library in the folder lib of the environment.
        libraries = {"LD_LIBRARY_PATH": str(WHEELS.parents[1] / "lib")} if self.python == WHEELS else {}
        return subprocess.run([str(self.python), *map(str, arguments)], env=os.environ | libraries, **options)


KRATOS = "KratosMultiphysics", "KratosMultiphysics.ContactStructuralMechanicsApplication"
SFEPY = "make codes-venv && build/codes-venv/bin/python -m pip install sfepy==2026.3, which compiles for some minutes"
ADAPTERS = (
    Adapter("this_study", Path(sys.executable), ("study",), "make test"),
    Adapter("scikit_fem", Path(sys.executable), ("skfem",), "make test"),
    Adapter("kratos_mortar", WHEELS, KRATOS, "make codes-venv"),
    Adapter("ngsolve_penalty", WHEELS, ("ngsolve",), "make codes-venv"),
    Adapter("sfepy_contact", WHEELS, ("sfepy",), SFEPY),
    Adapter("dolfinx_snesvi", WHEELS, ("dolfinx", "petsc4py"), "make codes-venv PYTHON=python3.12, or newer, on Linux"),
    Adapter("getfem_contact", DEBIAN, ("getfem",), "the Debian package python3-getfem"),
    Adapter("freefem", Path(sys.executable), ("numpy",), "the Debian package freefem++", "FreeFem++"),
    Adapter("calculix", Path(sys.executable), ("numpy",), "the Debian package calculix-ccx", "ccx"),
)


FROZEN = Study(
    tuple(one.name for one in ADAPTERS),
    (*PLANE, *SOLID),
    ("one-diagonal", "shaken"),
    (8, 16, 32),
    RESULTS,
    ROOT / "build" / "tasks",
)
MARCH = Study(
    ("this_study", "scikit_fem", "kratos_mortar", "ngsolve_penalty", "dolfinx_snesvi", "getfem_contact", "freefem"),
    ("advance-recede", "anisotropic"),
    ("one-diagonal",),
    (8, 16, 32),
    RESULTS / "march",
    ROOT / "build" / "marches",
)
MODES = {"frozen": FROZEN, "march": MARCH}


def export(directory: Path, mode: str, cases: list[str], families: list[str], levels: list[int]) -> None:
    """The tasks, those that are not there yet."""
    for case in cases:
        kinds, numbers = (["one-diagonal"], list(SOLID[case])) if case in SOLID else (families, levels)
        name = "nearly-incompressible" if ":" in case else case
        names = [f"{name}-{family}-{mode}-{n}.json.xz" for family in kinds for n in numbers]
        if not all((directory / one).exists() for one in names):
            command = [Path(sys.executable).with_name("study"), "export", case, "--mode", mode, "--to", directory]
            command += ["--family", *kinds, "--levels", *map(str, numbers)]
            subprocess.run(list(map(str, command)), cwd=ROOT, check=True)


SERIES = "code", "variant", "case", "family"


def table(rows: list[dict]) -> tuple[list[dict], list[dict]]:
    """Rows of errors.csv, one for each mesh, and of classes.csv, one for each case and mesh family."""
    errors, classes = [], []
    for row in rows:
        key = {name: row[name] for name in ("code", "version", "variant", "case", "family")}
        if "left_out" in row:
            classes.append({**key, "class": "not expressed", "reason": row["left_out"]})
            continue
        kept = {name: _short(row[name]) for name in ("order_in_v", "order_of_distance", "order_of_pressure")}
        verdict = classify(row["h"], [Errors(**one) for one in row["errors"]])
        classes.append({**key, "class": verdict, **kept, "invariance": _short(row["invariance"])})
        for level, h, found, solves in zip(row["levels"], row["h"], row["errors"], row["solves"], strict=False):
            digits = NUMBERS | (OF_EXACT if verdict == GOOD[0] else {})
            numbers = {name: f"{found[name]:.{digits[name]}g}" for name in NUMBERS}
            mesh = {name: row[name] for name in SERIES}
            errors.append({**mesh, "level": str(level), "h": f"{h:.5g}", **numbers, "solves": solves})
    return errors, classes


def _short(value: float) -> str:
    return "" if value != value else f"{value:.4g}"


def merged(old: list[dict], new: list[dict], key: tuple[str, ...]) -> list[dict]:
    """The old rows with the new ones in their places or behind; rows of parameters that a code has no more are gone."""
    variants = {row["code"]: {one["variant"] for one in new if one["code"] == row["code"]} for row in new}
    stay = [row for row in old if row["variant"] in variants.get(row["code"], {row["variant"]})]
    return list({tuple(row[name] for name in key): row for row in (*stay, *new)}.values())


def write(directory: Path, errors: list[dict], classes: list[dict]) -> None:
    """Both files; a row of errors names its code, case and family by the number of its series in classes.csv."""
    numbers = {tuple(row[name] for name in SERIES): n for n, row in enumerate(classes, start=1)}
    short = [
        {"series": numbers[tuple(row[name] for name in SERIES)]} | {k: v for k, v in row.items() if k not in SERIES}
        for row in errors
    ]
    _write(directory / "errors.csv", short)
    _write(directory / "classes.csv", [{"series": n} | row for n, row in enumerate(classes, start=1)])


def read(directory: Path) -> tuple[list[dict], list[dict]]:
    """Both tables as ``table`` gives them; empty where there are none."""
    if not (directory / "classes.csv").exists():
        return [], []
    classes = {row.pop("series"): row for row in _rows(directory / "classes.csv")}
    errors = []
    for row in _rows(directory / "errors.csv"):
        of = classes[row.pop("series")]
        errors.append({name: of[name] for name in SERIES} | row)
    return errors, list(classes.values())


def _rows(path: Path) -> list[dict]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def _write(path: Path, rows: list[dict]) -> None:
    columns = list(dict.fromkeys(name for row in rows for name in row))
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def differing(classes: list[dict], committed: list[dict]) -> list[str]:
    """Where a class is not the one that is committed."""
    before = {tuple(row[name] for name in SERIES): row["class"] for row in committed}
    now = {tuple(row[name] for name in SERIES): row["class"] for row in classes}
    return [f"{', '.join(key)}: {before.get(key)} ↦ {found}" for key, found in now.items() if before.get(key) != found]


def main() -> int:
    """The command; 0 unless an adapter fails or, with --check, a class is another than in results/codes."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--mode", choices=MODES, default="frozen")
    parser.add_argument("--only", nargs="+", metavar="ADAPTER")
    parser.add_argument("--cases", nargs="+", metavar="NAME")
    parser.add_argument("--families", nargs="+", metavar="NAME")
    parser.add_argument("--levels", nargs="+", type=int, metavar="N")
    parser.add_argument("--out", type=Path, metavar="DIR")
    parser.add_argument("--tasks", type=Path, metavar="DIR")
    parser.add_argument("--check", action="store_true", help="compare the classes with those of results/codes")
    options = parser.parse_args()
    study = MODES[options.mode]
    tasks, out = options.tasks or study.tasks, options.out or study.out
    families, levels = options.families or study.families, options.levels or study.levels
    export(tasks, options.mode, options.cases or study.cases, families, levels)
    rows = answered([one for one in ADAPTERS if one.name in (options.only or study.adapters)], tasks)
    errors, classes = table(rows)
    before = read(out)
    write(out, merged(before[0], errors, (*SERIES, "level")), merged(before[1], classes, SERIES))
    changed = differing(classes, read(study.out)[1]) if options.check else []
    print("\n".join([f"written: {out}", *changed]))
    return 1 if changed else 0


def answered(adapters: list[Adapter], tasks: Path) -> list[dict]:
    """What the judge says of the adapters whose code is here, on all tasks."""
    raw, rows = tasks.with_name("answers-of-" + tasks.name), []
    for adapter in adapters:
        if adapter.missing():
            print(f"{adapter.name} is not installed: {adapter.get}")
            continue
        adapter.run(HERE / "drive.py", adapter.name, tasks, raw, check=True)
        rows += json.loads((raw / f"{adapter.name}.json").read_text(encoding="utf-8"))
    return rows


if __name__ == "__main__":
    sys.exit(main())
