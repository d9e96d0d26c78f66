"""A run: choose the jobs, do what is not done yet, write the data files, judge them."""

from __future__ import annotations

import json
import platform
from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from dataclasses import asdict, dataclass, fields, replace
from importlib.metadata import version
from itertools import pairwise
from pathlib import Path
from typing import Any

import pandas as pd
from threadpoolctl import threadpool_limits

from manufactured.admissibility import Finding, SelfProofError, examine
from manufactured.case import Case
from manufactured.catalogue import catalogue
from study import pictures
from study.bound.claims import judge_bounds
from study.bound.jobs import BoundJob
from study.bound.measure import BoundRow
from study.bound.plan import full_bounds, quick_bounds
from study.claims import complete, judge
from study.datafiles import SERIES, DataError, read_csv
from study.equilibrated.claims import judge_stresses
from study.equilibrated.measure import StressRow, places
from study.equivalence import Gaps
from study.fem.gauge import rough_lines
from study.fem.mesh import FAMILIES, MeshError, MeshFamily, boundary_parts
from study.fem.quadrature import rough_cells
from study.jobs import EquivalenceJob, Job, PictureJob, RateJob, StatementJob, StressJob
from study.naming import UsageError, family_named, resolve
from study.rates import orders
from study.statements import STATEMENTS, position
from study.store import FORMAT, Store, require_format, write_text
from study.sweep import Row, steps_for
from study.verdict import Verdict


@dataclass(frozen=True)
class Levels:
    """The levels of a plan for one kind of case.

    Attributes:
        all: levels on every mesh family that is used.
        first: finer levels on the first family of a case only.
    """

    all: tuple[int, ...]
    first: tuple[int, ...] = ()

    def of(self, position: int) -> tuple[int, ...]:
        """The levels on the family at a position."""
        return self.all if position else (*self.all, *self.first)


@dataclass(frozen=True)
class Plan:
    """What a run computes.

    Attributes:
        cases: references, catalogue names or FILE.py:NAME.
        plane: levels for plane cases with (5.36).
        rough: levels for the others, whose orders need more of them.
        solid: levels in 3D.
        equivalence, solid_equivalence: levels of the check of Theorem 4.2, in 2D and 3D.
        families: mesh families a plane case with (5.36) is measured on: its first one and others in turn, so
            that all are used; one in turn for a rougher case, the first in 3D. None for all.
        scheme: name of the time scheme.
        name: quick or full, for the provenance.
        k: time step at every level; without it each case's own.
        statements: whether the numbered statements are measured one by one, and Problem 3.2 on its own space, too.
        finest: pairs (case, level) measured beside these on the first family of the case.
    """

    cases: tuple[str, ...]
    plane: Levels
    rough: Levels
    solid: Levels
    equivalence: tuple[int, ...]
    solid_equivalence: tuple[int, ...]
    families: int | None = None
    scheme: str = "midpoint"
    name: str = "quick"
    k: float | None = None
    statements: bool = True
    finest: tuple[tuple[str, int], ...] = ()

    def resolved(self) -> list[Case]:
        return [resolve(reference) for reference in self.cases]

    def check(self, spread: Callable[..., Iterable[Any]] = map) -> None:
        """Refuse what cannot be run, before time is spent; ``spread`` maps a function over cases.

        Raises:
            UsageError: levels below 2, not increasing, or two cases of one name.
            SelfProofError: a case is not an exact solution.
            MeshError: a mesh does not fit the boundary parts of a body, or no cell rule serves the places where a
                solution is rough.
        """
        if self.k is not None and not 0 < self.k <= min(case.solution.body.T for case in self.resolved()):
            raise UsageError(f"the time step must be positive and at most T, got k = {self.k:g}")
        for kind in (self.plane, self.rough, self.solid):
            levels = kind.of(0)
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
            if not any(family.serves(case.solution.body) for family in FAMILIES):
                raise UsageError(
                    f"no mesh family can mesh the body of {case.name}: in 3D it has to be a parallelepiped"
                )
        for reference, failed in zip(self.cases, spread(violations, self.cases), strict=True):
            if failed:
                raise SelfProofError(f"case {resolve(reference).name}", failed)
        self._check_meshes()

    def _check_meshes(self) -> None:
        """Every mesh must fit its body, and its cells the rough places of every solution that is measured on it."""
        groups: dict[Hashable, list[tuple[Case, str, int]]] = {}
        for case, family, level in self.meshes():
            body = case.solution.body
            shape = tuple((part.kind, *part.corners.ravel()) for part in (*body.parts, *body.interfaces))
            groups.setdefault((shape, family, level), []).append((case, family, level))
        for group in groups.values():
            case, family, level = group[0]
            try:
                mesh = family_named(family)(case.solution.body, level)
                boundary_parts(mesh, case.solution.body)
                for case, _, _ in group:
                    rough_cells(mesh, rough_lines(case.solution), case.solution.singular)
            except MeshError as error:
                raise MeshError(f"{case.name}, {family}, level {level}: {error}") from error

    def meshes(self) -> Iterator[tuple[Case, str, int]]:
        """(case, mesh family, level) of every job; the numbered statements choose meshes that serve."""
        for job in self.jobs():
            if isinstance(job, RateJob | EquivalenceJob):
                yield resolve(job.case), job.family, job.level
            elif isinstance(job, StressJob):
                yield resolve(job.place.case), job.place.family, job.place.level
            elif isinstance(job, PictureJob):
                yield resolve(job.case), pictures.FAMILY.name, pictures.LEVEL
            elif isinstance(job, BoundJob) and job.problem in self.cases:
                yield resolve(job.problem), job.family, job.level

    def steps(self, case: Case, level: int) -> int:
        """Time steps at a level: of the size asked for, or as many as the case's pace says."""
        return steps_for(case, level) if self.k is None else round(case.solution.body.T / self.k)

    def keys(self) -> list[tuple[str, ...]]:
        """What identifies the rows of the data files, sorted."""
        found: list[tuple[str, ...]] = []
        for job in self.jobs():
            if isinstance(job, RateJob):
                found.append((resolve(job.case).name, job.family, job.scheme, str(job.level)))
            elif isinstance(job, EquivalenceJob):
                found.append((resolve(job.case).name, job.family, str(job.level)))
            elif isinstance(job, BoundJob):
                found.append((job.trajectory.name, job.problem, job.family, job.scheme, str(job.level)))
            elif isinstance(job, StressJob):
                found.append((job.place.case, job.place.family, str(job.place.level), "stress"))
            elif isinstance(job, StatementJob):
                found.append((job.label, job.setting.case, job.setting.family, str(job.setting.level), "statement"))
        return sorted(found)

    def families_of(self, case: Case) -> list[MeshFamily]:
        """The mesh families a case is measured on, graded ones where there are."""
        serving = [family for family in FAMILIES if family.serves(case.solution.body)]
        if self.families is None:
            return serving
        first, *others = serving
        turn = [case.name for case in self.resolved()].index(case.name)
        if case.solution.body.dim == 3:
            return [first]
        if case.solution.body.refine:
            return [first, others[-1]]
        if not case.regularity.satisfies_5_36:
            return [serving[turn % len(serving)]]
        return [first, *(others[(turn + i) % len(others)] for i in range(min(self.families - 1, len(others))))]

    def levels_of(self, case: Case) -> Levels:
        """The levels of a case."""
        if case.solution.body.dim == 3:
            return self.solid
        return self.plane if case.regularity.satisfies_5_36 else self.rough

    def jobs(self) -> list[Job]:
        """All jobs of the plan."""
        jobs: list[Job] = []
        for reference in self.cases:
            case = resolve(reference)
            families, levels = self.families_of(case), self.levels_of(case)
            jobs += [
                RateJob(reference, family.name, self.scheme, n, self.steps(case, n))
                for position, family in enumerate(families)
                for n in (*levels.of(position), *(n for name, n in self.finest if name == case.name and not position))
            ]
            plane = case.solution.body.dim == 2
            jobs += [
                EquivalenceJob(reference, family.name, n, 2 * n)
                for family in families[::2]
                for n in (self.equivalence if plane else self.solid_equivalence)
            ]
            if plane:
                jobs.append(PictureJob(reference))
        return jobs + ([*self.stress_jobs(), *self.statement_jobs(), *self.bound_jobs()] if self.statements else [])

    def stress_jobs(self) -> list[Job]:
        """Problem 3.2 on its own stress space, on the cases of the plan."""
        return [StressJob(place) for place in places(self.name == "full") if place.case in self.cases]

    def bound_jobs(self) -> list[BoundJob]:
        """The bounds of the errors of the cases of the plan."""
        return (full_bounds if self.name == "full" else quick_bounds)(self.resolved())

    def statement_jobs(self) -> list[Job]:
        """The measurements of numbered statements on the cases of the plan."""
        return [
            StatementJob(statement.label, setting)
            for statement in STATEMENTS
            for setting in statement.settings(self.name == "full")
            if setting.case in self.cases
        ]


def violations(reference: str) -> list[Finding]:
    """The conditions that the exact solution of a case violates."""
    return [finding for finding in examine(resolve(reference).solution) if not finding.passes]


def quick() -> Plan:
    """A minute's worth: enough levels for every verdict, two mesh families for each case."""
    return Plan(
        cases=tuple(case.name for case in catalogue()),
        plane=Levels((8, 16, 32)),
        rough=Levels((8, 16, 32, 64)),
        solid=Levels((6, 9, 12)),
        equivalence=(4, 8),
        solid_equivalence=(3,),
        families=2,
    )


def full() -> Plan:
    """The levels of the committed results: half an hour."""
    return replace(
        quick(),
        plane=Levels((8, 16, 32, 64), (128,)),
        rough=Levels((8, 16, 32, 64, 128)),
        solid=Levels((6, 9, 12, 18), (24,)),
        equivalence=(4, 8, 16),
        solid_equivalence=(3, 6),
        families=None,
        name="full",
        finest=tuple(
            (name, 256) for name in ("full-contact", "no-contact", "fixed-front-off-vertex", "advance-recede")
        ),
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
    kinds = RateJob, EquivalenceJob, StressJob, PictureJob, StatementJob, BoundJob
    done: dict[type, list[dict[str, Any]]] = {kind: [] for kind in kinds}
    for job in plan.jobs():
        result = store.load(job.key, job.fingerprint())
        assert result is not None, job.key
        # What a case is a case of may be relabelled without measuring it again.
        claim = {"claim": resolve(job.case).proposition} if isinstance(job, RateJob) else {}
        done[type(job)].append(claim | result)
    rates = pd.DataFrame(done[RateJob])
    rates["order"] = [float("nan")] * len(rates)
    for _, group in rates.groupby(SERIES, sort=False):
        if len(group) > 1:
            rates.loc[group.index[1:], "order"] = orders(group["h"].to_numpy(), group["error"].to_numpy())
    columns = list(rates.columns)
    columns.insert(columns.index("time_share") + 1, columns.pop(columns.index("order")))
    _write_csv(store.data / "rates.csv", rates[columns])
    _write_csv(store.data / "equivalence.csv", pd.DataFrame(done[EquivalenceJob]))
    columns = [field.name for field in fields(StressRow)]
    _write_csv(store.data / "stresses.csv", pd.DataFrame(done[StressJob], columns=columns))
    _write_csv(
        store.data / "statements.csv", pd.DataFrame(statement_rows(done[StatementJob]), columns=STATEMENT_COLUMNS)
    )
    _write_csv(store.data / "bounds.csv", pd.DataFrame([result["row"] for result in done[BoundJob]], columns=BOUNDS))
    _write_csv(store.data / "enclosures.csv", pd.DataFrame(enclosure_rows(done[BoundJob]), columns=ENCLOSURES))
    _write_csv(store.data / "cases.csv", pd.DataFrame([describe(case) for case in plan.resolved()]))
    for result in done[PictureJob]:
        write_text(store.data / "pictures" / f"{result['case']}.json", json.dumps(result) + "\n")
    write_text(store.data / "provenance.json", json.dumps(provenance(plan), indent=2) + "\n")


BOUND_KEY = ["trajectory", "case", "family", "scheme", "level"]
BOUNDS = [field.name for field in fields(BoundRow)]
ENCLOSURES = [*BOUND_KEY, "time", "error", "distance", "bound"]


def enclosure_rows(results: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """One row per bound and time."""
    return [
        {**{key: result["row"][key] for key in BOUND_KEY}, **dict(zip(result["times"], values, strict=True))}
        for result in results
        for values in zip(*result["times"].values(), strict=True)
    ]


STATEMENT_KEY = ["label", "case", "family", "level"]
STATEMENT_COLUMNS = [*STATEMENT_KEY, "h", "quantity", "value"]


def statement_rows(results: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """One row per measured quantity."""
    return [
        {
            **{key: result[key] for key in STATEMENT_KEY},
            "h": result["measured"]["h"],
            "quantity": quantity,
            "value": value,
        }
        for result in results
        for quantity, value in result["measured"].items()
        if quantity != "h"
    ]


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
        "proved_order": case.regularity.proved_order,
        "twin": case.twin,
        "statements": f"{case.proposition}, Thm 4.2",
        "reason": case.reason,
    }


def provenance(plan: Plan) -> dict[str, Any]:
    """What made the data: format, plan and versions. No date, so that equal runs give equal files."""
    packages = ("numpy", "scipy", "scikit-fem", "clarabel", "sympy")
    return {
        "format": FORMAT,
        "study": version("signorini-study"),
        "plan": plan.name,
        "planned": plan.keys(),
        "python": platform.python_version(),
        "machine": platform.machine(),
        "packages": {name: version(name) for name in packages},
    }


RATE_KEY = ["case", "family", "scheme", "level"]
EQUIVALENCE_KEY = ["case", "family", "level"]


def check(directory: Path) -> list[Verdict]:
    """Judge the data on disk and write ``claims.csv``; nothing is solved.

    Raises:
        UsageError: no data.
        StoreError, DataError: data of another format, missing or damaged.
    """
    provenance = read_provenance(directory)
    rates = read_csv(directory, "rates.csv", [*RATE_KEY, *(field.name for field in fields(Row))])
    equivalence = read_csv(directory, "equivalence.csv", [*EQUIVALENCE_KEY, *Gaps._fields])
    stresses = read_csv(directory, "stresses.csv", [field.name for field in fields(StressRow)])
    statements = read_csv(directory, "statements.csv", STATEMENT_COLUMNS)
    bounds = read_csv(directory, "bounds.csv", BOUNDS)
    cases = read_csv(directory, "cases.csv", ["case", "expected_order", "proved_order", "twin"])
    unknown = sorted({*rates["case"], *equivalence["case"]} - set(cases["case"]))
    if unknown:
        raise DataError(
            f"{directory}/data/cases.csv lacks {', '.join(unknown)}: make it with `study run --out {directory}`"
        )
    found = keys(rates, RATE_KEY) | keys(equivalence, EQUIVALENCE_KEY)
    found |= keys(bounds, BOUND_KEY)
    found |= {(*key, "stress") for key in keys(stresses, EQUIVALENCE_KEY)}
    found |= {(*key, "statement") for key in keys(statements, STATEMENT_KEY)}
    planned = {tuple(key) for key in provenance["planned"]}
    verdicts = [complete(planned, found), *judge(rates, equivalence, cases), *judge_bounds(bounds, set(cases["case"]))]
    verdicts += judge_stresses(stresses, {case: resolve(case).regularity for case in stresses["case"].unique()})
    verdicts += judge_statements(statements)
    ordered = sorted(verdicts, key=lambda verdict: position(verdict.label))
    _write_csv(directory / "data" / "claims.csv", pd.DataFrame([asdict(verdict) for verdict in ordered]))
    return ordered


def judge_statements(rows: pd.DataFrame) -> list[Verdict]:
    """The verdicts of every numbered statement that was measured, or that needs no measurement."""
    found: list[Verdict] = []
    for statement in STATEMENTS:
        mine = rows[rows["label"] == statement.label]
        if len(mine) or (len(rows) and not statement.settings(True)):
            found += statement.judge(mine)
    return found


def keys(table: pd.DataFrame, columns: list[str]) -> set[tuple[str, ...]]:
    """What identifies the rows of a table, as text."""
    return set(table[columns].astype(str).itertuples(index=False, name=None))


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


def _write_csv(path: Path, table: pd.DataFrame) -> None:
    write_text(path, table.to_csv(index=False, float_format="%.12g", lineterminator="\n"))
