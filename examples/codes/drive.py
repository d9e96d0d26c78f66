"""Drive one adapter through tasks and write what the judge says.

    python drive.py ADAPTER TASKS OUT

An adapter is a module in this directory with CODE, VERSION and VARIANTS, names with all parameters ↦ make(task). It may
have FINEST, names of variants ↦ the level behind which they are not run for what it costs, and GAPS = True if it uses
the initial gap of a task. Tasks with a gap are left out for other adapters. OUT gets ADAPTER.json: for
each variant a judgement of each case and mesh family, or why the code cannot express it.
"""

from __future__ import annotations

import importlib
import json
import sys
from collections import defaultdict
from dataclasses import asdict
from pathlib import Path

import numpy as np
from common import CannotExpressError
from contact_judge import Task, answer, assess, read_tasks

NO_GAP = "the adapter does not use the initial gap"
SCALE = 10.0
"""The other load scale under which the coarsest task of a case is answered once more."""


def variant_on(make, tasks: list[Task]) -> dict:
    """The judgement of one variant on the meshes of one case, the cost in solves and the difference of two scales."""
    answers, cost = {}, []

    def counted(task: Task):
        step = make(task)
        cost.append(step)
        return step

    try:
        for task in tasks:
            answers[task.name] = answer(task, counted)
        (found,) = assess(tasks, answers)
        again = answer(tasks[0], make, SCALE) - answers[tasks[0].name]
    except CannotExpressError as reason:
        return {"left_out": str(reason)}
    apart = max(tasks[0].norm(tasks[0].strain(v)) for v in again) / found.errors[0].best
    solves = [getattr(step, "solves", None) for step in cost]
    return {**asdict(found), "invariance": apart, "solves": solves, "h": [task.data["h"] for task in tasks]}


def main(adapter: str, directory: str, out: str) -> None:
    """Drive the adapter."""
    module = importlib.import_module(adapter)
    groups = defaultdict(list)
    for task in sorted(read_tasks(Path(directory)), key=lambda one: one.data["level"]):
        groups[task.data["case"], task.data["family"]].append(task)
    rows = []
    finest = getattr(module, "FINEST", {})
    for variant, make in module.VARIANTS.items():
        for (case, family), tasks in groups.items():
            run = [task for task in tasks if task.data["level"] <= finest.get(variant, task.data["level"])]
            gap = any(one.any() for task in run for one in task.gaps())
            with np.errstate(all="ignore"):
                row = variant_on(make, run) if not gap or hasattr(module, "GAPS") else {"left_out": NO_GAP}
            rows.append({"code": module.CODE, "version": module.VERSION, "variant": variant} | {"case": case} | row)
            rows[-1]["family"] = family
            print(f"{module.CODE:<12}{variant:<42}{case:<22}{row.get('verdict', row.get('left_out'))}", flush=True)
    Path(out).mkdir(parents=True, exist_ok=True)
    (Path(out) / f"{adapter}.json").write_text(json.dumps(rows, indent=1))


if __name__ == "__main__":
    main(*sys.argv[1:])
