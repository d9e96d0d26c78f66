"""Rows as a study hands them to ``judge``, measured or invented, and verdicts by their keys."""

from functools import cache

import pandas as pd


def measured(statement, settings):
    return pd.DataFrame([row for s in settings for _, row in statement.records(s, statement.run(s))])


@cache
def quick_rows(statement):
    """The rows of the first and the last case of the quick settings."""
    settings = statement.places(full=False)
    cases = settings[0].case, settings[-1].case
    return measured(statement, [setting for setting in settings if setting.case in cases])


def invented(quantities, levels=(8, 16, 32), **where):
    """Rows of one case: one value, or one for each level, of each quantity."""
    values = pd.DataFrame(quantities, index=pd.Index(levels, name="level"), dtype=float)
    rows = values.reset_index().melt("level", var_name="quantity")
    return rows.assign(h=1 / rows["level"], **{"case": "a", "family": "one-diagonal"} | where)


def verdicts(statement, rows):
    """Key ↦ verdict."""
    return {verdict.key: verdict.verdict for verdict in statement.judge(rows)}


def wrong_values(rows, quantity, factor):
    """The rows with the values of a quantity multiplied by a factor, or by the level."""
    wrong = rows["value"] * (rows["level"] if factor == "level" else factor)
    return rows.assign(value=rows["value"].where(rows["quantity"] != quantity, wrong))
