"""Tables of benchmarks on disk: CSV, Markdown, and the machine they were made on."""

from __future__ import annotations

import json
import os
import platform
import subprocess
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from io import StringIO
from pathlib import Path
from typing import Any

import pandas as pd
from threadpoolctl import threadpool_info

from study.ledger.files import write_text

ROOT = Path(__file__).parents[1]
RESULTS = ROOT / "results" / "benchmarks"
LIBRARIES = ("numpy", "scipy", "pyamg", "scikit-fem", "sympy", "pytest-benchmark")


def machine() -> dict[str, Any]:
    """What a timing depends on, without names of hosts or places; ``threads`` are those of this process."""
    pools = threadpool_info()
    return {
        "processor": _processor(),
        "cores": os.cpu_count(),
        "memory_bytes": os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"),
        "system": platform.system(),
        "threads": max((pool["num_threads"] for pool in pools), default=1),
        "python": platform.python_version(),
        "blas": sorted({f"{pool['internal_api']} {pool['version']}" for pool in pools}),
        **{library: version(library) for library in LIBRARIES},
    }


def _processor() -> str:
    """The model of the processor as the system names it."""
    info = Path("/proc/cpuinfo")
    names = [line.partition(":")[2].strip() for line in _lines(info) if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


def _lines(path: Path) -> list[str]:
    return path.read_text(encoding="utf-8").splitlines() if path.exists() else []


def write(directory: Path, name: str, table: pd.DataFrame, title: str, notes: Sequence[str]) -> None:
    """NAME.csv and NAME.md, and the machine under NAME in machine.json."""
    this = machine()
    write_text(directory / f"{name}.csv", table.to_csv(index=False, float_format="%.6g"))
    threads = f"threads of a process: {this['threads']}"
    foot = f"{this['processor']}, {this['cores']} cores; {threads}; versions in `machine.json`."
    paragraphs = [f"# {title}", *notes, markdown(table), foot]
    write_text(directory / f"{name}.md", "\n\n".join(paragraphs) + "\n")
    path = directory / "machine.json"
    known: dict[str, Any] = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    write_text(path, json.dumps(known | {name: this}, indent=2, ensure_ascii=False) + "\n")


def markdown(table: pd.DataFrame) -> str:
    """The table with three significant digits; a missing number is a dash."""
    shown = table.astype(object).map(_shown)
    return str(shown.to_markdown(index=False, disable_numparse=True))


def _shown(value: object) -> str:
    if pd.isna(value):
        return "–"
    if not isinstance(value, float):
        return str(value)
    return f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"


def committed(path: Path) -> pd.DataFrame | None:
    """A table as it was last committed; None if it never was, or without git."""
    name = path.resolve().relative_to(ROOT).as_posix()
    try:
        shown = subprocess.run(["git", "show", f"HEAD:{name}"], cwd=ROOT, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return None
    return pd.read_csv(StringIO(shown.stdout))


def single_thread(environment: Mapping[str, str]) -> dict[str, str]:
    """An environment in which numerical libraries use one thread."""
    return {**environment, **dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")}
