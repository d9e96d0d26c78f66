"""Every deliberate defect turns a named row of the ledger to *fails*; without one all rows hold."""

from __future__ import annotations

from dataclasses import asdict

import defects
import pandas as pd
import pytest

from manufactured import catalogue
from study.claims import prop_5_4
from study.fem.mesh import OneDiagonal
from study.solve.evolution import Midpoint
from study.sweep import Setup, measure, steps_for
from study.verdict import FAILS, HOLDS, Verdict

LEVELS = (8, 16, 32)
CASES = {case.name: case for case in catalogue()}


def ledger(case_name: str, defect: defects.Defect, levels: tuple[int, ...] = LEVELS) -> list[Verdict]:
    """The rows that the study would print for a case, had it the defect."""
    case, family = CASES[case_name], OneDiagonal()
    rows = []
    for level in levels:
        setup = Setup.of(case.solution, family, level, Midpoint(), steps_for(case, level))
        rows.append(measure(defect(setup)).row(case.name, family.name, level))
    return prop_5_4(case.name, pd.DataFrame([asdict(row) for row in rows]), case.order)


def failing(verdicts: list[Verdict]) -> set[str]:
    return {verdict.quantity for verdict in verdicts if verdict.verdict == FAILS}


@pytest.mark.parametrize("case", ["advance-recede", "travelling-patch", "fixed-front-off-vertex", "no-contact"])
def test_without_a_defect_every_row_holds(case: str) -> None:
    assert {verdict.verdict for verdict in ledger(case, lambda setup: setup)} == {HOLDS}


ORDER = "order of the error, level by level"
SIZE = "size of the error"
DISCRETE = "order of ‖Π^h u − u^h‖_V, superclose"
SHARE = "time share"
RESIDUAL = "residual of the contact solves"
CLAMPED = "u^h = 0 on Γ1"
PREDICTED = "‖u − Π^h u‖_V / leading term"
QUADRATURE = "change under finer quadrature"


@pytest.mark.parametrize(
    ("case", "defect", "caught_by"),
    [
        ("full-contact", defects.contact_dropped, ORDER),
        ("no-contact", defects.contact_two_sided, ORDER),
        ("full-contact", defects.normal_flipped, ORDER),
        ("full-contact", defects.constraint_relaxed, ORDER),
        ("advance-recede", defects.contact_work_sign_flipped, ORDER),
        ("advance-recede", defects.one_active_set_iteration, RESIDUAL),
        ("advance-recede", defects.load_one_step_late, DISCRETE),
        ("no-contact", defects.zero_start, ORDER),
        ("no-contact", defects.elasticity_dropped, ORDER),
        ("no-contact", defects.viscosity_and_elasticity_swapped, ORDER),
        ("advance-recede", defects.backward_euler_with_k_like_h, SHARE),
        ("fixed-front-off-vertex", defects.norm_of_h1, PREDICTED),
        ("fixed-front-off-vertex", defects.norm_with_elasticity, PREDICTED),
        ("fixed-front-off-vertex", defects.one_point_quadrature, PREDICTED),
        ("fixed-front-off-vertex", defects.sum_of_square_roots, ORDER),
        ("fixed-front-off-vertex", defects.slope_of_the_baseline, DISCRETE),
        ("travelling-patch", defects.final_time_only, SIZE),
        ("full-contact", defects.clamp_one_cell_short, CLAMPED),
    ],
    ids=lambda value: getattr(value, "__name__", None),
)
def test_a_defect_turns_a_named_row_to_fails(case: str, defect: defects.Defect, caught_by: str) -> None:
    found = failing(ledger(case, defect))
    assert caught_by in found, f"caught by {found or 'nothing'}"
