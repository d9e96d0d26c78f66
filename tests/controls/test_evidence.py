"""Evidence that becomes too small is noticed: each weakened line of the measuring code leaves a control uncaught.

The table has one line for each way in which the evidence of a module can become too small.

Without the inaccuracies of ``study.controls.table`` every row holds, whether the evidence is weakened or not.
"""

from __future__ import annotations
import __future__

import inspect
import re
import textwrap
from functools import reduce
from importlib import import_module
from typing import Any, NamedTuple
from unittest.mock import patch

import numpy as np
import pytest

from study.controls.run_controls import work
from study.controls.table import CONTROLS
from study.ledger.verdict import FAILS
from study.solve.paths import furthest
from study.solve.tableau import MIDPOINT
from study.statements.shared.base import Setting
from study.statements.shared.experiment import Experiment

BY_NAME = {control.name: control for control in CONTROLS}


class Weakened(NamedTuple):
    """One line of the measuring code that makes evidence too small, and the controls that must notice.

    ``place`` is "module:function" or "module:Class.function", where the function is looked up.
    """

    name: str
    place: str
    before: str
    after: str
    controls: tuple[str, ...]

    def patch(self) -> Any:
        """The time in which the line is weakened."""
        module, _, path = self.place.partition(":")
        *inside, name = path.split(".")
        owner = reduce(getattr, inside, import_module(module))
        function = inspect.unwrap(getattr(owner, name))
        source = textwrap.dedent(inspect.getsource(function))
        assert source.count(self.before) == 1, (self.name, self.before)
        code = compile(
            source.replace(self.before, self.after), self.place, "exec", __future__.annotations.compiler_flag
        )
        exec(code, getattr(function, "__func__", function).__globals__, made := {})
        return patch.object(owner, name, made[function.__name__])


def weakened_lines(text: str) -> list[Weakened]:
    """Read blocks "NAME @ PLACE", with indented lines: code "- OLD  ↦  NEW", and "=" before the controls.

    Code of several lines has "-" before each old line and "+" before each new one.
    """
    found = []
    for block in re.split(r"\n(?! )", text.strip()):
        head, *lines = block.splitlines()
        old, new, controls = ([line[4:] for line in lines if line[2] == mark] for mark in "-+=")
        name, place = head.split(" @ ")
        before, _, after = "\n".join(old).partition("  ↦  ")
        found.append(Weakened(name, place, before, after or "\n".join(new), tuple("; ".join(controls).split("; "))))
    return found


WEAKENED = weakened_lines(r"""
no sign @ study.solve.evolution:ContactStep._residual
  - float(-multipliers.min(initial=0.0)) / force  ↦  0.0
  = residual: sign
no balance @ study.solve.evolution:ContactStep._residual
  - math.sqrt(defect @ defect) / max(math.sqrt(b @ b), TINY)  ↦  0.0
  = residual: balance; residual: first step; residual: last step
residual of every second step @ study.controls.baselines:measure
  - maximum(residuals)  ↦  maximum(residuals[::2])
  = residual: first step; residual: odd step
every even time @ study.controls.baselines:measure
  - history.append(  ↦  n % 2 or history.append(
  = supremum: odd node; supremum of interpolation: odd node
the error at the last time @ study.statements.prop_5_4:Measurement.row
  - "error": float(error[first])  ↦  "error": float(error[-1])
  = supremum: odd node; supremum: even node
discrete time share of the error @ study.statements.prop_5_4:Measurement.row
  - drift / float(discrete[third])  ↦  drift / float(error[first])
  = time share: odd node; time share: even node
no response to the load @ study.statements.prop_5_4:Measurement.quadrature_change
  - (abs(raised - error) + drift)  ↦  abs(raised - error)
  = quadrature: load; quadrature: early load
too large errors alone @ study.statements.prop_5_4:Measurement.parallelogram
  - abs(missed).max()  ↦  missed.max()
  = parallelogram: 0.8 at the odd node
the law at every even time @ study.statements.prop_5_4:Measurement.parallelogram
  - abs(missed).max()  ↦  abs(missed)[::2].max()
  = parallelogram: 1.2 at the odd node
nothing on Γ1 @ study.statements.prop_5_4:Measurement.clamped
  - size[np.any(on, axis=0)].max()  ↦  size[np.any(on, axis=0)].min()
  = clamp short
penetration at the last time @ study.statements.contact_force:errors_in_time
  - np.max(extremes, axis=0)  ↦  np.array([extremes[-1][0], *np.max(extremes, axis=0)[1:]])
  = contact: odd node; contact: even node
no share of the dual norm @ study.controls.baselines:measure_contact
  - / errors  ↦  / errors * [1, 0, 1]
  = contact: share of the dual norm
discrete error of the last step @ study.statements.superclose:Superclose.measure
  - "discrete error": maximum(discrete)  ↦  "discrete error": discrete[-1]
  = superclose: odd node; superclose: even node
violations in the last step @ study.statements.admissibility:largest_violations
  - np.maximum(worst, now)  ↦  np.array(now)
  = u_n without contact: odd step; u_n without contact: even step; u_n held: odd step; u_n held: even step
  = u_n pressed: odd step; u_n pressed: even step
gaps in the last step @ study.controls.baselines:gaps
  - np.maximum(worst, now)  ↦  np.array(now)
  = 3.2: stress, first step; 3.2: stress, odd step; 3.2: stress, even step; 3.2: displacement, first step
  = 3.2: displacement, odd step; 3.2: displacement, even step
duality gap of the last step @ study.controls.baselines:gaps
  - q * radius + np.sqrt(dual.gap)  ↦  np.sqrt(dual.gap)
  = 3.2: duality gap, first step; 3.2: duality gap, odd step; 3.2: duality gap, even step
inadmissible in the last step @ study.statements.thm_4_2_own_space:measure
  - history["admissibility"].max()  ↦  history["admissibility"][-1]
  = admissible: jumps; admissible: misses f_2; admissible: tangential; admissible: pulls
pulling is admissible @ study.statements.thm_4_2_own_space:inadmissible
  - np.maximum(total[edges, :, 0], 0.0)  ↦  0.0
  = admissible: pulls
jumps are not looked at @ study.statements.thm_4_2_own_space:inadmissible
  -     return
  +     total[np.bincount(space.edges.ravel()) > 1] = 0
  +     return
  = admissible: jumps
other ways in the last step @ study.statements.uniqueness:OneTrajectory.measure
  - np.max(both, axis=0)  ↦  both[-1]
  = other ways: odd node; other ways: even node
differences in the last step @ study.statements.wellposed:quotients
  - np.array(found)  ↦  np.array(found)[-1:]
  = dependence: odd node; dependence: even node
error of the last node @ study.statements.error_bounds:sides
  - maximum(v_norm.distance(v_norm.sample(state.time), state.u) for state in states)
  + [v_norm.distance(v_norm.sample(state.time), state.u) for state in states][-1]
  = bounds: odd node; bounds: even node
(5.12) in the last step @ study.statements.steps_of_the_estimate:at_nodes
  - np.max(found, axis=0)  ↦  found[-1]
  = contact held: odd step; contact held: even step; multipliers: odd step; multipliers: even step
tractions at the last instant @ study.statements.boundary:tractions
  - .sum()
  -     return
  + .iloc[-1]
  +     return
  = one instant: σ^h
trajectories at the last node @ study.statements.recomputed:gaps
  - missing.max()  ↦  missing[-1]
  = computed again: u, odd node; computed again: u, even node
bound at the last time @ study.controls.baselines:bounded
  - (found.error / found.upper).max()  ↦  (found.error / found.upper)[-1]
  = bound: error at time 5
R at the last time @ study.statements.residual:defects
  - maximum(values) if values  ↦  values[-1] if values
  = R without f_0 at one time
Π^h u at the last time @ study.statements.constraint:over_time
  - maximum(violation(trace, space.interpolate(nodal)) for nodal in values)
  + violation(trace, space.interpolate(values[-1]))
  = sign of u at one time
norms at the last time @ study.statements.residual_bound:share_of_bound
  - np.max(rows, axis=0)  ↦  rows[-1]
  = R at one time
traction at every even time @ study.statements.norms_in_time:TractionInTime.measure
  - maximum(squares)  ↦  maximum(squares[::2])
  = traction at one time
growth in the last step @ study.statements.solution_divergence:over_bound
  - other)).max() for  ↦  other))[-1] for
  = growth: odd node; growth: even node
the last node @ study.statements.growing_errors:furthest
  - .max()  ↦  [-1]
  = backward Euler: one node
the error of a front at the last node @ study.statements.advancing_front:AdvancingFront.measure
  - range(0, 2 * steps + 1,  ↦  range(2 * steps, 2 * steps + 1,
  = front: error at one node
the load at the first time @ study.statements.advancing_front:AdvancingFront.measure
  - midpoints(problem.T, FEW)  ↦  midpoints(problem.T, FEW)[:1]
  = front: load at one time
""")


def caught(name: str) -> bool:
    control = BY_NAME[name]
    found = {verdict.key: verdict.verdict for verdict in work(control.setting, control)}
    return all(found[key] == FAILS for key in control.keys)


FAST = ("no sign", "every even time")
"""A line about residuals and one about maxima in time; the nightly job tries all."""


@pytest.mark.parametrize(
    "weakened",
    [pytest.param(each, marks=[] if each.name in FAST else pytest.mark.slow) for each in WEAKENED],
    ids=lambda weakened: weakened.name,
)
def test_evidence_that_is_too_small_leaves_controls_uncaught(weakened: Weakened) -> None:
    with weakened.patch():
        assert [name for name in weakened.controls if caught(name)] == []


def test_the_supremum_of_two_trajectories_is_over_all_nodes() -> None:
    """Shared by the statements on time steps, landings, rollers and fronts."""
    setup = Experiment.at(Setting("full-contact", "one-diagonal", 2), MIDPOINT, 4)
    one = np.zeros((5, len(setup.problem.u0)))
    for n in range(5):
        other = one.copy()
        other[n, 0] = 2.0
        assert furthest(setup.problem, one, other) == pytest.approx(2 * np.sqrt(setup.problem.M[0, 0]))
