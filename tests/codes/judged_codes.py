"""Tasks of cases as another code reads them, and the judgement of a code that solves them."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache
from typing import Any

import contact_judge as judge
import numpy as np

from study.fem.naming import family_named, resolve
from study.run.tasks import frozen, march, plain
from study.statements.shared.tasks import Task

Make = Callable[[Any], Callable[[np.ndarray, np.ndarray], np.ndarray]]


def task(case: str, level: int = 8, family: str = "one-diagonal") -> Task:
    return Task(resolve(case), family_named(family), level)


def read(data: dict[str, Any]) -> judge.Task:
    return judge.Task(f"{data['case']}-{data['level']}-{data['scale']}", json.loads(json.dumps(plain(data))))


@cache
def exported(
    case: str,
    level: int = 8,
    family: str = "one-diagonal",
    times: tuple[float, ...] = (0.15, 0.55, 0.9),
    steps: int = 0,
    scale: float = 1.0,
) -> judge.Task:
    """The static problems of a case at some times, or a march of some steps, as the judge reads them from a file."""
    mine = task(case, level, family)
    return read(march(mine, steps) if steps else frozen(mine, times, scale))


def judged(make: Make, *tasks: judge.Task) -> judge.Judgement:
    (found,) = judge.assess(list(tasks), {one.name: judge.answer(one, make) for one in tasks})
    return found


def assessed(task: judge.Task, u: Any, **reports: Any) -> judge.Judgement:
    """The judgement of an answer to one task, with what the code reports."""
    (found,) = judge.assess([task], {task.name: np.asarray(u)}, {task.name: reports} if reports else {})
    return found
