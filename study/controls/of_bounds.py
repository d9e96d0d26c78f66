"""Controls of rows that compare two things: axes, rows computed again, and bounds of errors with the errors."""

from __future__ import annotations

from typing import Any

from study.bound.trajectory import Refined, SmoothedInTime
from study.controls import defects, inaccuracies, mistakes
from study.controls.control import Control
from study.controls.side_by_side import Bounding, Twins, TwoWays
from study.controls.slips import Slip
from study.controls.small_defects import OfAmount
from study.statements.enclosure.courses import by_midpoint
from study.statements.enclosure.inside import BoundedError, EnclosedError

MOVING = "advance-recede"
TURNED, AGAIN = Twins("rotated", (8, 16)), TwoWays(MOVING, 8)
BOUND = Bounding(BoundedError(), tuple(by_midpoint(MOVING, "one-diagonal", (4,), SmoothedInTime())))
ENCLOSURE = Bounding(EnclosedError(), tuple(by_midpoint(MOVING, "one-diagonal", (4,), Refined(0, 2))))
REPORTED_ROW = "study.statements.prop_5_4.measure"


def reported(column: str, factor: float) -> Slip:
    """A column of ``rates.csv`` is wrong by a factor."""
    return Slip(REPORTED_ROW, "Measurement.row", mistakes.column_times(column, factor))


BOUNDS: tuple[Control[Any], ...] = (
    Control("axes", "the axis nearest to ν in place of ν", TURNED, defects.normal_along_an_axis, "discrete-error"),
    Control(
        "width for length",
        "w ‖·‖_V with the width w along the first axis",
        TURNED,
        Slip("study.fem.gauge", "Gauge.distance", mistakes.times_width),
        "errors",
    ),
    Control("error off by 1 %", "1.01 ‖u − u^h‖_V is reported", AGAIN, reported("error", 1.01), "error"),
    Control(
        "interpolation off by 1 %",
        "0.99 ‖u − Π^h u‖_V is reported",
        AGAIN,
        reported("interpolation_error", 0.99),
        "interpolation-error",
    ),
    Control(
        "discrete error off by 2 %",
        "1.02 ‖Π^h u − u^h‖_V is reported",
        AGAIN,
        reported("discrete_error", 1.02),
        "discrete-error",
    ),
    Control("again: start at zero", "u_0^h = 0 in place of Π^h u_0", AGAIN, defects.zero_start, "start"),
    Control("again: load", "1.05 F for F", AGAIN, inaccuracies.load_slightly_too_large, "displacement"),
    Control(
        "again: multipliers", "1.2 λ beside the right u^h", AGAIN, defects.multipliers_a_fifth_too_large, "multipliers"
    ),
    Control(
        "again: modulus", "λ of A larger by a millionth", AGAIN, OfAmount("λ of A", 1e-6), "displacement-same-load"
    ),
    Control(
        "again: forces",
        "λ larger by a millionth beside the right u^h",
        AGAIN,
        OfAmount("contact force λ", 1e-6),
        "multipliers-same-load",
    ),
    Control(
        "bound without residual",
        "nothing for what the law misses",
        BOUND,
        Slip("study.bound.equilibration", "Equilibration.products", mistakes.times(0.0)),
        "above",
    ),
    Control(
        "enclosure: half the norm",
        "½ ‖·‖_V for ‖·‖_V on V^h",
        ENCLOSURE,
        Slip("study.bound.discretisation", "Discretisation.norm", mistakes.times(0.5)),
        "above",
    ),
    Control(
        "enclosure: twice the norm",
        "2 ‖·‖_V for ‖·‖_V on V^h",
        ENCLOSURE,
        Slip("study.bound.discretisation", "Discretisation.norm", mistakes.times(2.0)),
        "below",
    ),
)
