"""The evidence for the error of a row: u^h on Γ1, the parallelogram law, the leading term, and a second solver."""

from dataclasses import replace

import numpy as np
import pytest
from costly_cases import slow
from measured_rows import verdicts
from places import RESULTS

from study.fem.space import Space
from study.ledger.verdict import FAILS, HOLDS
from study.run.judgement import joined
from study.solve.tableau import MIDPOINT
from study.statements.other_solvers import Recomputed
from study.statements.prop_5_4 import RATES, measure
from study.statements.shared.base import Experiment, Setting


def measured(name, n=8):
    return measure(Experiment.at(Setting(name, "one-diagonal", n), MIDPOINT, 8))


def test_u_h_on_the_clamped_part_is_relative_to_its_largest_value(monkeypatch):
    found = measured("no-contact", 4)
    assert found.clamped() == 0
    inside = Space.nodal
    off = np.array([[0.3], [0.4]])
    largest = np.linalg.norm(found.experiment.space.nodal(found.worst.u) + off, axis=0).max()
    monkeypatch.setattr(Space, "nodal", lambda space, u: inside(space, u) + off)
    assert found.clamped() == pytest.approx(0.5 / largest)


@pytest.mark.parametrize("name", ["no-contact", "advance-recede", "heterogeneous", slow("cube-disc")])
def test_the_parallelogram_law_fails_if_u_minus_its_interpolant_is_recorded_as_the_error_alone(name):
    """Also where the largest error is the error of the start, which both share."""
    found = measured(name)
    time, _, interpolation, *others = found.history
    assert found.parallelogram() <= 1e-11
    assert replace(found, history=np.array([time, interpolation, interpolation, *others])).parallelogram() >= 0.5


# Numbers that are computed again by the second solver.


def recomputed(tables):
    return verdicts(Recomputed(), joined(Recomputed(), tables))


def test_both_ways_agree_and_a_reported_size_that_is_missing_or_wrong_by_a_factor_is_caught():
    """In the committed rows of one case."""
    tables = {file: file.read(RESULTS).query("case == 'natural-front'") for file in (RATES, Recomputed.file)}
    assert set(recomputed(tables).values()) == {HOLDS}
    for column, change in (("error", 0.01), ("interpolation_error", 0.01), ("discrete_error", 0.05)):
        for factor in (1 - change, 1 + change):
            found = recomputed({**tables, RATES: tables[RATES].assign(**{column: factor * tables[RATES][column]})})
            assert {key for key, verdict in found.items() if verdict == FAILS} == {column.replace("_", "-")}
    assert recomputed({**tables, RATES: tables[RATES].iloc[:0]})["error"] == FAILS
