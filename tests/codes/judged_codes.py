"""Tasks of cases as another code reads them, and the judgement of a code that solves them."""

import json
from functools import cache

import contact_judge as judge
import numpy as np

from study.cli.export import frozen, march, plain
from study.fem.naming import family_named, resolve
from study.statements.shared.tasks import Task


def task(case, level=8, family="one-diagonal"):
    return Task(resolve(case), family_named(family), level)


def read(data):
    return judge.Task(f"{data['case']}-{data['level']}-{data['scale']}", json.loads(json.dumps(plain(data))))


def at_one_time(case, level=4, family="one-diagonal", scale=1.0):
    """The data of the static problem of a case at one time, as they are written."""
    return frozen(task(case, level, family), (0.55,), scale)


@cache
def exported(
    case,
    level=8,
    steps=0,
    family="one-diagonal",
    times=(0.15, 0.55, 0.9),
    scale=1.0,
):
    """The static problems of a case at some times, or a march of some steps, as the judge reads them from a file."""
    mine = task(case, level, family)
    return read(march(mine, steps) if steps else frozen(mine, times, scale))


def answers(make, tasks):
    return {one.name: judge.answer(one, make) for one in tasks}


def judged(make, *tasks):
    (found,) = judge.assess(list(tasks), answers(make, tasks))
    return found


def assessed(task, u, **reports):
    """The judgement of an answer to one task, with what the code reports."""
    (found,) = judge.assess([task], {task.name: np.asarray(u)}, {task.name: reports} if reports else {})
    return found
