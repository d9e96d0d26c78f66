"""The data files of a run, from its finished jobs."""

from __future__ import annotations

import json
from dataclasses import fields
from typing import Any

import pandas as pd

from manufactured.case import Case
from study.fem.naming import resolve
from study.ledger.datafiles import SERIES, write_csv
from study.ledger.files import write_text
from study.ledger.orders import orders
from study.run.job import EquivalenceJob, PictureJob, RateJob, StatementJob, StressJob
from study.run.plan import Plan
from study.run.provenance import provenance
from study.run.store import Store
from study.statements.enclosure.jobs import BoundJob
from study.statements.enclosure.measure import BoundRow
from study.statements.thm_4_2.own_space import StressRow


def collect(plan: Plan, store: Store) -> None:
    """Write the data files of a plan from its finished jobs."""
    kinds = RateJob, EquivalenceJob, StressJob, PictureJob, StatementJob, BoundJob
    done: dict[type, list[dict[str, Any]]] = {kind: [] for kind in kinds}
    for job in plan.jobs:
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
    write_csv(store.data / "rates.csv", rates[columns])
    write_csv(store.data / "equivalence.csv", pd.DataFrame(done[EquivalenceJob]))
    columns = [field.name for field in fields(StressRow)]
    write_csv(store.data / "stresses.csv", pd.DataFrame(done[StressJob], columns=columns))
    write_csv(
        store.data / "statements.csv", pd.DataFrame(statement_rows(done[StatementJob]), columns=STATEMENT_COLUMNS)
    )
    write_csv(store.data / "bounds.csv", pd.DataFrame([result["row"] for result in done[BoundJob]], columns=BOUNDS))
    write_csv(store.data / "enclosures.csv", pd.DataFrame(enclosure_rows(done[BoundJob]), columns=ENCLOSURES))
    write_csv(store.data / "cases.csv", pd.DataFrame([describe(case) for case in plan.resolved()]))
    for result in done[PictureJob]:
        write_text(store.data / "pictures" / f"{result['case']}.json", picture_text(result))
    write_text(store.data / "provenance.json", json.dumps(provenance(plan), indent=2) + "\n")


def picture_text(picture: dict[str, Any]) -> str:
    """A picture as in its file: without spaces after separators, which would be a tenth of it."""
    return json.dumps(picture, separators=(",", ":")) + "\n"


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
