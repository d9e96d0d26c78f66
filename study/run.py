"""A run: choose the jobs, do what is not done yet, write the data files, judge them."""

from __future__ import annotations

import json
import platform
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from dataclasses import asdict, dataclass, replace
from importlib.metadata import version
from itertools import pairwise
from pathlib import Path
from typing import Any

import pandas as pd
from threadpoolctl import threadpool_limits

from manufactured.admissibility import prove
from manufactured.case import Case
from manufactured.catalogue import catalogue
from study.claims import Verdict, judge
from study.fem.mesh import FAMILIES, boundary_parts
from study.jobs import EquivalenceJob, Job, PictureJob, RateJob, UsageError, resolve
from study.rates import orders
from study.store import FORMAT, Store, require_format, write_text

SERIES = ["claim", "case", "family", "scheme"]


@dataclass(frozen=True)
class Plan:
    """What a run computes.

    Attributes:
        cases: references, catalogue names or FILE.py:NAME.
        levels: levels for cases with (5.36).
        rough_levels: levels for the others, whose orders need more of them.
        scheme: name of the time scheme.
        equivalence: levels of the check of Theorem 4.2.
        name: quick or full, for the provenance.
        without: pairs (family, level) that are left out.
    """

    cases: tuple[str, ...]
    levels: tuple[int, ...]
    rough_levels: tuple[int, ...]
    equivalence: tuple[int, ...]
    scheme: str = "midpoint"
    name: str = "quick"
    without: frozenset[tuple[str, int]] = frozenset()

    def resolved(self) -> list[Case]:
        return [resolve(reference) for reference in self.cases]

    def check(self) -> None:
        """Refuse what cannot be run, before time is spent.

        Raises:
            UsageError: levels below 2, not increasing, or two cases of one name.
            SelfProofError: a case is not an exact solution.
        MeshError: a mesh does not fit the boundary parts of a body.
        """
        for levels in (self.levels, self.rough_levels):
            if not levels or min(levels) < 2:
                raise UsageError(f"levels must be 2 or more, got {' '.join(map(str, levels)) or 'none'}")
            if any(b <= a for a, b in pairwise(levels)):
                raise UsageError(
                    f"levels must increase, got {' '.join(map(str, levels))}; sort them and drop repetitions"
                )
        names = [case.name for case in self.resolved()]
        if len(set(names)) < len(names):
            raise UsageError(f"two cases have the same name among {', '.join(names)}; rename one")
        for case in self.resolved():
            prove(case.solution, f"case {case.name}")
        self._check_meshes()

    def _check_meshes(self) -> None:
        """Every mesh must fit its body (MeshError); bodies that are equal are checked once."""
        seen = set()
        for case in self.resolved():
            body = case.solution.body
            shape = tuple((part.kind, *part.start, *part.end) for part in body.parts)
            for level in self.levels if case.regularity.satisfies_5_36 else self.rough_levels:
                if (shape, level) not in seen:
                    seen.add((shape, level))
                    for family in FAMILIES:
                        boundary_parts(family(body, level), body)

    def jobs(self) -> list[Job]:
        """All jobs of the plan."""
        jobs: list[Job] = []
        for reference in self.cases:
            levels = self.levels if resolve(reference).regularity.satisfies_5_36 else self.rough_levels
            jobs += [
                RateJob(reference, f.name, self.scheme, n)
                for f in FAMILIES
                for n in levels
                if (f.name, n) not in self.without
            ]
            jobs += [EquivalenceJob(reference, f.name, n, 2 * n) for f in FAMILIES[::2] for n in self.equivalence]
            jobs.append(PictureJob(reference))
        return jobs


def quick() -> Plan:
    """A minute's worth: enough levels for every verdict."""
    return Plan(tuple(case.name for case in catalogue()), (8, 16, 32), (5, 10, 20, 40), (4, 8))


def full() -> Plan:
    """The levels of the committed results; two families end a level earlier, to keep the run within an hour."""
    return replace(
        quick(),
        levels=(8, 16, 32, 64, 128, 256),
        rough_levels=(8, 16, 32, 64, 128, 256),
        equivalence=(4, 8, 16),
        name="full",
        without=frozenset({("criss-cross", 256), ("unstructured", 256)}),
    )


class JobsError(RuntimeError):
    """Some jobs raised; the others are finished and kept."""


Notify = Callable[[float], None]
"""Called with the cost of each finished job."""


def execute(jobs: Sequence[Job], store: Store, executor: Executor, notify: Notify) -> None:
    """Do the jobs that the store does not hold, most expensive first, keeping each as it ends.

    Raises:
        JobsError: after all others are done; names each failed job and its error.
    """
    pending: dict[Future[dict[str, Any]], Job] = {}
    for job in sorted(jobs, key=lambda job: -job.cost):
        if store.load(job.key, job.fingerprint()) is None:
            pending[executor.submit(work, job)] = job
        else:
            notify(job.cost)
    failed = []
    try:
        while pending:
            for future in wait(pending, return_when=FIRST_COMPLETED).done:
                job = pending.pop(future)
                error = future.exception()
                if error is None:
                    store.save(job.key, job.fingerprint(), future.result())
                else:
                    failed.append(f"{job.key}: {type(error).__name__}: {error}")
                notify(job.cost)
    finally:
        for future in pending:
            future.cancel()
    if failed:
        raise JobsError("\n".join([f"{len(failed)} job(s) failed, the rest is kept:", *failed]))


def work(job: Job) -> dict[str, Any]:
    """Run one job with one thread: the processes share the cores already."""
    with threadpool_limits(1):
        return job.run()


def collect(plan: Plan, store: Store) -> None:
    """Write the data files of a plan from its finished jobs."""
    done: dict[type, list[dict[str, Any]]] = {RateJob: [], EquivalenceJob: [], PictureJob: []}
    for job in plan.jobs():
        result = store.load(job.key, job.fingerprint())
        assert result is not None, job.key
        done[type(job)].append(result)
    rates = pd.DataFrame(done[RateJob])
    rates["order"] = [float("nan")] * len(rates)
    for _, group in rates.groupby(SERIES, sort=False):
        if len(group) > 1:
            rates.loc[group.index[1:], "order"] = orders(group["h"].to_numpy(), group["error"].to_numpy())
    columns = list(rates.columns)
    columns.insert(columns.index("time_share") + 1, columns.pop(columns.index("order")))
    _write_csv(store.data / "rates.csv", rates[columns])
    _write_csv(store.data / "equivalence.csv", pd.DataFrame(done[EquivalenceJob]))
    _write_csv(store.data / "cases.csv", pd.DataFrame([describe(case) for case in plan.resolved()]))
    for result in done[PictureJob]:
        write_text(store.data / "pictures" / f"{result['case']}.json", json.dumps(result) + "\n")
    write_text(store.data / "provenance.json", json.dumps(provenance(plan), indent=2) + "\n")


def describe(case: Case) -> dict[str, Any]:
    """The line of a case in the catalogue."""
    motion = "moving" if case.regularity.moving else "no front" if case.regularity.gap == float("inf") else "fixed"
    return {
        "case": case.name,
        "summary": case.summary,
        "dimension": case.solution.body.dim,
        "law": case.solution.law.name,
        "zone": motion,
        "regularity": str(case.regularity),
        "expected_order": case.order,
        "statements": f"{case.proposition}, Thm 4.2",
        "reason": case.reason,
    }


def provenance(plan: Plan) -> dict[str, Any]:
    """What made the data: format, plan and versions. No date, so that equal runs give equal files."""
    packages = ("numpy", "scipy", "scikit-fem", "clarabel", "sympy")
    return {
        "format": FORMAT,
        "study": version("signorini-study"),
        "plan": asdict(plan) | {"without": sorted(plan.without)},
        "python": platform.python_version(),
        "machine": platform.machine(),
        "packages": {name: version(name) for name in packages},
    }


def check(directory: Path) -> list[Verdict]:
    """Judge the data on disk and write ``claims.csv``; nothing is solved.

    Raises:
        StoreError: no data, or data of another format.
    """
    data = directory / "data"
    path = data / "provenance.json"
    if not path.is_file():
        raise UsageError(f"{data} holds no finished run; make one with: study run --out {directory}")
    require_format(path, Store._read(path))
    tables = {name: pd.read_csv(data / f"{name}.csv") for name in ("rates", "equivalence", "cases")}
    expected = dict(zip(tables["cases"]["case"], tables["cases"]["expected_order"], strict=True))
    verdicts = judge(tables["rates"], tables["equivalence"], expected)
    _write_csv(data / "claims.csv", pd.DataFrame([asdict(verdict) for verdict in verdicts]))
    return verdicts


def _write_csv(path: Path, table: pd.DataFrame) -> None:
    write_text(path, table.to_csv(index=False, float_format="%.9g", lineterminator="\n"))
