"""What made the data of a finished run, and what it promised to contain."""

from __future__ import annotations

import platform
from importlib.metadata import version
from pathlib import Path
from typing import Any

from study.ledger.errors import UsageError
from study.run.plan import Plan
from study.run.sources import sources
from study.run.store import FORMAT, Store, require_format
from study.run.versions import packages


def provenance(plan: Plan) -> dict[str, Any]:
    """What made the data: format, plan and versions. No date, so that equal runs give equal files."""
    return {
        "format": FORMAT,
        "study": version("signorini-study"),
        "plan": plan.scope.name,
        "planned": plan.keys(),
        "statements": sources(),
        "python": platform.python_version(),
        "machine": platform.machine(),
        "packages": packages(),
    }


def read_provenance(directory: Path) -> dict[str, Any]:
    """``provenance.json`` of a finished run.

    Raises:
        UsageError: there is none.
        StoreError: it is of another format, or damaged.
    """
    path = directory / "data" / "provenance.json"
    if not path.is_file():
        raise UsageError(f"{path.parent} holds no finished run; make one with: study run --out {directory}")
    content = Store.read(path)
    require_format(path, content)
    assert content is not None
    return content


def protect(plan: Plan, directory: Path) -> None:
    """Refuse a run that would replace a larger one on disk.

    Raises:
        UsageError: rows of the finished run are not in the plan.
    """
    if (directory / "data" / "provenance.json").exists():
        lost = {tuple(key) for key in read_provenance(directory)["planned"]} - set(plan.keys())
        if lost:
            raise UsageError(
                f"{directory} holds a run with {len(lost)} rows that this one does not have (such as "
                f"{' '.join(min(lost))}); give another directory with --out, or remove that one"
            )
