"""``make codes``: run the codes that are installed on tasks of this study, say how to get the others, keep the errors.

    python run_codes.py [--only ADAPTER ...] [--cases NAME ...] [--families NAME ...] [--levels N ...]
                        [--out DIR] [--tasks DIR] [--check]

Each adapter runs in the Python that has its code: this one, that of build/codes-venv, or Debian's.
"""

from __future__ import annotations

import argparse
import csv
import json
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from contact_judge import Errors, classify

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
WHEELS, DEBIAN = ROOT / "build" / "codes-venv" / "bin" / "python", Path("/usr/bin/python3")
PLANE = (
    "advance-recede",
    "merging-patches",
    "rotated",
    "corner",
    "layered",
    "anisotropic",
    "full-contact",
    "lift-and-land",
    "examples/codes/nearly_incompressible.py:case",
)
SOLID = {"cube-disc": (4, 8), "cube-two-faces": (3, 6)}
NUMBERS = (
    "error",
    "best",
    "discrete",
    "distance",
    "pressure",
    "best_pressure",
    "penetration",
    "resultant",
    "tangential",
)


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
        command = [str(self.python), "-c", "import " + ", ".join(self.imports)]
        return subprocess.run(command, capture_output=True, check=False).returncode != 0


KRATOS = "KratosMultiphysics", "KratosMultiphysics.ContactStructuralMechanicsApplication"
ADAPTERS = (
    Adapter("this_study", Path(sys.executable), ("study",), "make test"),
    Adapter("scikit_fem", Path(sys.executable), ("skfem",), "make test"),
    Adapter("kratos_mortar", WHEELS, KRATOS, "make codes-venv"),
    Adapter("ngsolve_penalty", WHEELS, ("ngsolve",), "make codes-venv"),
    Adapter("dolfinx_snesvi", DEBIAN, ("dolfinx", "petsc4py"), "the Debian packages python3-dolfinx python3-petsc4py"),
    Adapter("getfem_contact", DEBIAN, ("getfem",), "the Debian package python3-getfem"),
    Adapter("freefem", Path(sys.executable), ("numpy",), "the Debian package freefem++", "FreeFem++"),
    Adapter("calculix", Path(sys.executable), ("numpy",), "the Debian package calculix-ccx", "ccx"),
)


def export(directory: Path, cases: list[str], families: list[str], levels: list[int]) -> None:
    """The tasks, those that are not there yet."""
    for case in cases:
        kinds, numbers = (["one-diagonal"], list(SOLID[case])) if case in SOLID else (families, levels)
        name = "nearly-incompressible" if ":" in case else case
        names = [f"{name}-{family}-frozen-{n}.json.gz" for family in kinds for n in numbers]
        if not all((directory / one).exists() for one in names):
            command = [Path(sys.executable).with_name("study"), "export", case, "--to", directory]
            command += ["--family", *kinds, "--levels", *map(str, numbers)]
            subprocess.run(list(map(str, command)), cwd=ROOT, check=True)


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
            numbers = {name: f"{found[name]:.4g}" for name in NUMBERS}
            mesh = {name: value for name, value in key.items() if name != "version"}
            errors.append({**mesh, "level": level, "h": _short(h), **numbers, "solves": solves})
    return errors, classes


def _short(value: float) -> str:
    return f"{value:.5g}"


def write(path: Path, rows: list[dict]) -> None:
    """A CSV file with all columns of the rows."""
    columns = list(dict.fromkeys(name for row in rows for name in row))
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def differing(classes: list[dict], committed: Path) -> list[str]:
    """Where a class is not the one that is committed."""
    names = "code", "variant", "case", "family"
    with committed.open(newline="", encoding="utf-8") as file:
        before = {tuple(row[name] for name in names): row["class"] for row in csv.DictReader(file)}
    now = {tuple(row[name] for name in names): row["class"] for row in classes}
    return [f"{', '.join(key)}: {before.get(key)} ↦ {found}" for key, found in now.items() if before.get(key) != found]


def main() -> int:
    """The command; 0 unless an adapter fails or, with --check, a class is another than in results/codes."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", default=[one.name for one in ADAPTERS], metavar="ADAPTER")
    parser.add_argument("--cases", nargs="+", default=[*PLANE, *SOLID], metavar="NAME")
    parser.add_argument("--families", nargs="+", default=["one-diagonal", "shaken"], metavar="NAME")
    parser.add_argument("--levels", nargs="+", type=int, default=[8, 16, 32], metavar="N")
    parser.add_argument("--out", type=Path, default=ROOT / "results" / "codes", metavar="DIR")
    parser.add_argument("--tasks", type=Path, default=ROOT / "build" / "tasks", metavar="DIR")
    parser.add_argument("--check", action="store_true", help="compare the classes with those of results/codes")
    options = parser.parse_args()
    export(options.tasks, options.cases, options.families, options.levels)
    raw = options.tasks.with_name("answers-of-" + options.tasks.name)
    for adapter in (one for one in ADAPTERS if one.name in options.only):
        if adapter.missing():
            print(f"{adapter.name} is not installed: {adapter.get}")
            continue
        command = [str(adapter.python), str(HERE / "drive.py"), adapter.name, str(options.tasks), str(raw)]
        subprocess.run(command, check=True)
    rows = [row for one in ADAPTERS if one.name in options.only for row in _read(raw / f"{one.name}.json")]
    errors, classes = table(rows)
    write(options.out / "errors.csv", errors)
    write(options.out / "classes.csv", classes)
    changed = differing(classes, ROOT / "results" / "codes" / "classes.csv") if options.check else []
    print("\n".join([f"written: {options.out}", *changed]))
    return 1 if changed else 0


def _read(path: Path) -> list[dict]:
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else []


if __name__ == "__main__":
    sys.exit(main())
