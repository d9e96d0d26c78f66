"""Controls of the evidence: inaccuracies that one part of a residual, share or supremum sees, and nothing else does.

A residual that ignores the sign of the contact forces, or a supremum over every second time, is too small. No window
for the correct solution can notice that. So each control here makes the computation inaccurate in one respect only, for
example at one time node. The row named by the control fails as long as its evidence looks there. If the evidence stops
looking there, the row holds and the control is reported as not caught.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from copy import copy
from dataclasses import replace
from functools import partial
from itertools import count
from types import SimpleNamespace
from typing import Any

import numpy as np
import scipy.sparse as sps

from manufactured.body import Kind
from manufactured.tensors import Array
from study.controls import defects
from study.controls.control import Control
from study.controls.inaccuracies import Freed
from study.controls.of_bounds import AGAIN, BOUND, ENCLOSURE
from study.controls.of_contact import PATCH, PRESSED
from study.controls.of_rates import MERGING, MOVING
from study.controls.of_rates import RESIDUAL as RESIDUAL_ROW
from study.controls.of_statements import (
    ADMISSIBLE,
    ADVANCING,
    AT_REST,
    BOUNDS,
    CLOSE,
    DEPENDENCE,
    ESTIMATE,
    GROWING,
    INTERPOLANT,
    LOADS,
    NATURAL,
    ONE_STRESS,
    PARTING,
    RESIDUAL,
    TRACTION,
    TRAJECTORY,
    VELOCITY,
    slip,
)
from study.controls.of_stresses import BOTH, OWN
from study.controls.slips import Slip, Together, in_experiments_of
from study.solve.evolution import State
from study.solve.signorini import ContactSolver, Signorini
from study.solve.stress_programme import StressState
from study.solve.tableau import Tableau
from study.statements.prop_5_4.experiment import Experiment
from study.statements.thm_4_2.stands_alone import Sides

Function = Callable[..., Any]
Solver = Callable[[sps.csc_array, sps.csr_array], ContactSolver]
NODES = "first", "odd", "even", "last"
"""Time nodes with an inaccuracy of their own: whoever skips the middle or every second node misses one of them."""


def node(which: str, last: int) -> int:
    """The number of a time node: 1, an odd or even one in the middle, or the last."""
    return {"first": 1, "odd": last // 2 | 1, "even": (last // 2 + 2) // 2 * 2, "last": last}[which]


# One wrong state of a trajectory, or one wrong contact solve.


def marched(setup: Experiment, change: Callable[[int, int, State], State]) -> Experiment:
    """Change the states that a trajectory reports; change has the arguments (node, number of steps, state)."""

    def march(problem: Any, steps: int) -> Iterator[State]:
        return (change(n, steps, state) for n, state in enumerate(setup.scheme.march(problem, steps)))

    scheme: Any = SimpleNamespace(name=setup.scheme.name, order=setup.scheme.order, march=march)
    return replace(setup, scheme=scheme)


def state_off(which: str, halvings: int, factors: dict[str, float], setup: Experiment) -> Experiment:
    """Multiply parts of the state at one node of the trajectory with 2^halvings times the steps of the experiment."""
    wanted = int(setup.steps * 2**halvings)

    def change(n: int, steps: int, state: State) -> State:
        if steps != wanted or n != node(which, steps):
            return state
        return replace(state, **{name: factor * getattr(state, name) for name, factor in factors.items()})

    return marched(setup, change)


def rival_off(which: str, setup: Experiment) -> Experiment:
    """A displacement that is off by a thousandth at one node, in all problems but that of the experiment."""

    def march(problem: Any, steps: int) -> Iterator[State]:
        for n, state in enumerate(setup.scheme.march(problem, steps)):
            off = problem is not setup.problem and n == node(which, steps)
            yield replace(state, u=1.001 * state.u) if off else state

    scheme: Any = SimpleNamespace(name=setup.scheme.name, order=setup.scheme.order, march=march)
    return replace(setup, scheme=scheme)


def scheme_off(which: str, right_first: int, scheme: Tableau) -> Any:
    """A time scheme that reports ten times the displacement at one node, except in its first calls."""
    calls = count()

    def march(problem: Any, steps: int) -> Iterator[State]:
        off = next(calls) >= right_first
        for n, state in enumerate(scheme.march(problem, steps)):
            yield replace(state, u=10 * state.u) if off and n == node(which, steps) else state

    return SimpleNamespace(name=scheme.name, order=scheme.order, march=march)


def solved_once_by(wrong: Solver, which: str, refinement: float, setup: Experiment) -> Experiment:
    """Solve one of ``refinement`` times the experiment's steps by a wrong contact solver, all others correctly."""
    call = node(which, int(refinement * setup.steps))

    def solver(S: sps.csc_array, N: sps.csr_array) -> ContactSolver:
        right, other, calls = Signorini(S, N), wrong(S, N), count(1)
        return lambda b: (other if next(calls) == call else right)(b)

    return replace(setup, problem=replace(setup.problem, solver=solver))


def forces_times(factor: float, S: sps.csc_array, N: sps.csr_array) -> ContactSolver:
    """A contact solver with the right displacement and contact forces that are wrong by a factor."""
    solve = Signorini(S, N)

    def solver(b: Array) -> tuple[Array, Array]:
        u, forces = solve(b)
        return u, factor * forces

    return solver


class Distant(Signorini):
    """Contact at a distance of 0.03 from the foundation: v_ν ≤ −0.03 in place of v_ν ≤ 0."""

    def complementarity(self, gap: Array) -> Array:
        return super().complementarity(gap + 0.03)


def distant(setup: Experiment) -> Experiment:
    """λ > 0 where a gap is open: λ·N u ≠ 0, all other conditions of the contact solve hold."""
    return replace(setup, problem=replace(setup.problem, solver=Distant))


# How errors are measured: one time, or one rule of quadrature.


def shadowed(setup: Experiment, **methods: Function) -> Experiment:
    """Replace methods of the object that measures errors."""
    gauge = copy(setup.gauge)
    vars(gauge).update(methods)
    return replace(setup, gauge=gauge)


def time_of(which: str, setup: Experiment) -> float:
    """The time of a node of the trajectory that is measured."""
    return setup.problem.T * node(which, 2 * setup.steps) / (2 * setup.steps)


def interpolant_off(which: str, setup: Experiment) -> Experiment:
    """5 Π^h u in place of Π^h u at one time."""
    sample, wrong = setup.gauge.sample, time_of(which, setup)

    def at(time: float) -> Any:
        found = sample(time)
        return replace(found, interpolant=5.0 * found.interpolant) if np.isclose(time, wrong) else found

    return shadowed(setup, sample=at)


def interpolation_error_off(which: str, factor: float, setup: Experiment) -> Experiment:
    """‖u − Π^h u‖_V is wrong by a factor at one time."""
    distance, wrong = setup.gauge.distance, time_of(which, setup)

    def measured(sample: Any, v: Array) -> float:
        off = v is sample.interpolant and np.isclose(sample.time, wrong)
        return (factor if off else 1.0) * distance(sample, v)

    return shadowed(setup, distance=measured)


def load_off(amount: Callable[[float], float], setup: Experiment) -> Experiment:
    """A load that is wrong by a relative amount that depends on t/T, as if its quadrature were coarse."""
    load, T = setup.gauge.load, setup.problem.T
    wrong = lambda time: (1 + amount(time / T)) * load(time)  # noqa: E731
    return shadowed(replace(setup, problem=replace(setup.problem, load=wrong)), load=wrong)


def five_percent(time: float) -> float:
    return 0.05


def early(time: float) -> float:
    """A wrong load early on, whose effect has faded at the end."""
    return 0.004 if time < 0.1 else 0.0


def coarse(right: int) -> int:
    """Quadrature of degree 1."""
    return 1


# Results of functions, wrong in one call or one entry.


def call_off(call: int, change: Function, right: Function) -> Function:
    """One of the calls returns a changed result."""
    calls = count()

    def found(*given: Any) -> Any:
        value = right(*given)
        return change(value) if next(calls) == call else value

    return found


def tenfold(value: Any) -> Any:
    return 10 * value


def hundredfold(value: Any) -> Any:
    return 100 * value


def negative(value: Any) -> Any:
    return -value


def shifted(value: Any) -> Any:
    return value + 1e-4


def without_body_force(terms: Any) -> Any:
    return replace(terms, body=0 * terms.body)


def larger(names: tuple[str, ...], course: Any) -> Any:
    """Some norms at one instant that are far too large."""
    return replace(course, **{name: 1e6 * getattr(course, name) for name in names})


def rows_off(calls: tuple[int, ...], row: int, factor: float, right: Function) -> Function:
    """One row of an array, the displacement at one time, is wrong by a factor in some calls."""
    number = count()

    def found(*given: Any) -> Array:
        values: Array = np.array(right(*given))
        if not calls or next(number) in calls:
            values[row] *= factor
        return values

    return found


def at_time(time: float, change: Function, method: Function) -> Function:
    """A method with the time as its first argument returns a changed result at one time."""
    return lambda of, now, *given: (change if np.isclose(now, time) else unchanged)(method(of, now, *given))


def unchanged(value: Any) -> Any:
    return value


def hundredfold_each(values: list[float]) -> list[float]:
    return [100 * value for value in values]


def load_of_forces_off(right: Function) -> Function:
    """A load by the coarse rule that is wrong at one time."""

    def load(solution: Any, space: Any, time: float, degree: int) -> Array:
        off = degree < 3 and np.isclose(time, 0.375 * solution.body.T)
        return np.asarray((1.1 if off else 1.0) * right(solution, space, time, degree))

    return load


def stress_off_at_an_instant(discrete_stresses: Function) -> Function:
    """σ^h is ten times too large at the fifth of the instants."""

    def found(setup: Any) -> Iterator[tuple[float, Array]]:
        for n, (time, stress) in enumerate(discrete_stresses(setup)):
            yield time, (10 if n == 4 else 1.0) * stress

    return found


def stress_list_off(stresses: Function) -> Function:
    """A stress that is off by a thousandth in one step, by all solvers but the usual one."""

    def found(experiment: Any) -> list[Array]:
        values: list[Array] = stresses(experiment)
        return [(1.001 if n == 6 and experiment.solver is not Signorini else 1.0) * v for n, v in enumerate(values)]

    return found


def known_error_off(call: int, factor: float, known_error: Function) -> Function:
    """The known error is wrong by a factor at one of the times."""
    return lambda *given: call_off(call, partial(_times, factor), known_error(*given))


def _times(factor: float, value: float) -> float:
    return factor * value


def solution_off(method: str, time: float, change: Function, resolve: Function) -> Function:
    """Cases whose exact solution is wrong at one time, a part of T."""

    def resolved(name: str) -> Any:
        solution = resolve(name).solution
        return SimpleNamespace(solution=_at_one_time(solution, method, time, change))

    return resolved


def displacement_off(time: float, change: Function, over_time: Function) -> Function:
    """An exact displacement that is wrong at one time, a part of T."""
    return lambda trace, solution: over_time(trace, _at_one_time(solution, "displacement", time, change))


def _at_one_time(solution: Any, method: str, time: float, change: Function) -> Any:
    def at(x: Array) -> Any:
        fields = solution.at(x)

        def evaluated(*given: Any) -> Any:
            off = np.isclose(given[-1], time * solution.body.T)
            return (change if off else unchanged)(getattr(fields, method)(*given))

        return SimpleNamespace(**{method: evaluated})

    return SimpleNamespace(body=solution.body, at=at)


# Problem 3.2.


def dual_off(which: str, changes: dict[str, float], sides: Sides) -> Sides:
    """Parts of the state of Problem 3.2 are wrong by factors in one of its steps."""
    honest = sides.stresses(sides.displacements)
    right = honest.march

    def march(steps: int) -> Iterator[StressState]:
        for n, state in enumerate(right(steps)):
            off = {name: factor * getattr(state, name) for name, factor in changes.items()}
            yield replace(state, **off) if n == node(which, steps) else state

    wrong = copy(honest)
    vars(wrong)["march"] = march
    return replace(sides, stresses=lambda problem: wrong)


def companion_off(companion: Function) -> Function:
    """The stress with half as many steps is wrong in one of them."""

    def found(experiment: Any) -> Iterator[Any]:
        for n, state in enumerate(companion(experiment)):
            off = replace(state.stress, values=5 * state.stress.values)
            yield replace(state, stress=off) if n == 2 else state

    return found


def inadmissible_once(kind: str, call: int, inadmissible: Function) -> Function:
    """In one step a stress jumps between cells, misses f_2, is tangential or pulls: by some thousandths of its size."""
    calls = count()

    def found(space: Any, state: Any) -> float:
        if next(calls) != call:
            return float(inadmissible(space, state))
        tractions = state.stress.tractions.copy()
        where = {"misses f_2": Kind.LOADED, "tangential": Kind.CONTACT, "pulls": Kind.CONTACT}
        on = np.flatnonzero(space.mesh.f2t[1] >= 0) if kind == "jumps" else space.on(where[kind])[0][1]
        cell, side = np.argwhere(space.edges == on[len(on) // 2])[0]
        little = 1e-3 * call * abs(tractions).max()
        if kind == "pulls":
            tractions[cell, side, :, 0] = little
        else:
            tractions[cell, side, :, 1] += little
        return float(inadmissible(space, replace(state, stress=replace(state.stress, tractions=tractions))))

    return found


def coarse_forces(alternating: bool, amount: float, setup: Experiment) -> Experiment:
    """Contact forces of the run with half as many steps that are off, with the same sign everywhere or in turns."""

    def change(n: int, steps: int, state: State) -> State:
        signs = (-1.0) ** np.arange(len(state.multipliers)) if alternating else 1.0
        off = amount * signs * (state.multipliers if not alternating else state.multipliers.max())
        return replace(state, multipliers=state.multipliers + off) if steps < setup.steps else state

    return marched(setup, change)


# Evidence that is too small in ten ways at once, for an inaccurate computation: other rows must notice.


def balance_alone(residual: Function) -> Function:
    """A residual without the sign of the contact forces, complementarity and the gap."""

    def found(step: Any, u: Array, multipliers: Array, b: Array) -> float:
        return float(np.linalg.norm(step.S @ u + step.forces @ multipliers - b) / np.linalg.norm(b))

    return found


def hastily(measure: Function) -> Function:
    """Look at every second time, and at the residual and the time share of the last time only."""

    def found(experiment: Experiment) -> Any:
        right = measure(experiment)
        *_, coarse = experiment.scheme.march(experiment.problem, experiment.steps)
        *_, fine = experiment.scheme.march(experiment.problem, 2 * experiment.steps)
        difference = coarse.u - fine.u
        drift = float(np.sqrt(difference @ (experiment.problem.M @ difference)))
        return replace(right, history=right.history[:, ::2], drift=drift, residual=fine.residual())

    return found


def tiny(right: Function) -> Function:
    """Evidence that is always small."""
    return lambda *given: 1e-9


def at_the_last_time(parallelogram: Function) -> Function:
    """The parallelogram law at the last time only."""
    return lambda found: parallelogram(replace(found, history=found.history[:, -1:]))


MEASURE = "study.statements.prop_5_4.measure"
TEN_AT_ONCE = Together(
    (
        Slip("study.solve.evolution", "ContactStep._residual", balance_alone),
        Slip("study.controls.baselines", "measure", hastily),
        Slip(MEASURE, "Measurement.parallelogram", at_the_last_time),
        Slip(MEASURE, "Measurement.clamped", tiny),
        Slip(MEASURE, "Measurement.quadrature_change", tiny),
        defects.contact_two_sided,
        defects.load_one_step_late,
    )
)
"""No sign, no complementarity, no gap, only the last step, every second time, time share at the last time, law at the
last time, nothing on Γ1 and of quadrature, for forces that pull and a load that is late: ten of measuring, two of
computing."""

# The table.

QUADRATURE = "quadrature"
ERRORS, PLAIN, BOUND_ROWS = (
    f"study.statements.{module}" for module in ("thm_4_2.stress_errors", "recomputed.plain", "enclosure.bound_rows")
)
HALF = "odd", "even"
"""Nodes in the middle: where these are looked at, a supremum is one over all times."""


def rates(name: str, what: str, defect: Function, *rows: str) -> Control[Any]:
    return Control(name, what, MOVING, defect, rows)


def listed(name: str, what: str, setting: Any, module: str, function: str, by: Function, *rows: str) -> Control[Any]:
    return Control(name, what, setting, slip(module, function, by), rows)


OF_RATES: tuple[Control[Any], ...] = (
    rates("residual: sign", "v_ν = 0: forces that pull, all else solved", defects.contact_two_sided, RESIDUAL_ROW),
    rates("residual: complementarity", "forces where a gap is open, all else solved", distant, RESIDUAL_ROW),
    rates("residual: gap", "v_ν ≤ 0 at every other vertex, all else solved", defects.contact_in_places, RESIDUAL_ROW),
    rates("residual: balance", "1.2 λ for λ, all else solved", defects.multipliers_a_fifth_too_large, RESIDUAL_ROW),
    *(
        rates(
            f"residual: {which} step",
            f"1.5 λ for λ in the {which} step alone",
            partial(solved_once_by, partial(forces_times, 1.5), which, 2),
            RESIDUAL_ROW,
        )
        for which in NODES
    ),
    *(
        rates(
            f"supremum: {which} node",
            f"5 u^h for u^h at the {which} node alone",
            partial(state_off, which, 1, {"u": 5.0}),
            *("order", "discrete-order-superclose"),
        )
        for which in NODES
    ),
    *(
        rates(
            f"supremum of interpolation: {which} node",
            f"5 Π^h u for Π^h u at the {which} node alone",
            partial(interpolant_off, which),
            "leading-term",
        )
        for which in NODES
    ),
    *(
        rates(
            f"time share: {which} node",
            f"0.9 u^h for u^h with the longer steps, at the {which} node alone",
            partial(state_off, which, 0, {"u": 0.9}),
            *("time-share", "discrete-time-share"),
        )
        for which in NODES
    ),
    *(
        rates(
            f"parallelogram: {factor:g} at the {which} node",
            f"{factor:g} ‖u − Π^h u‖_V at the {which} node alone",
            partial(interpolation_error_off, which, factor),
            "parallelogram",
        )
        for which in HALF
        for factor in (0.8, 1.2)
    ),
    rates(
        "quadrature: load", "1.05 f for f, the error's own rule is right", partial(load_off, five_percent), QUADRATURE
    ),
    rates("quadrature: early load", "1.004 f for f until T/10 alone", partial(load_off, early), QUADRATURE),
    rates(
        "quadrature: error",
        "the error's rule has one point, the load's is right",
        defects.one_point_quadrature,
        QUADRATURE,
    ),
    Control(
        "quadrature: degree", "rules of degree 1 for 4", MERGING, Slip("study.fem.gauge", "DEGREE", coarse), QUADRATURE
    ),
    rates(
        "ten defects at once",
        "evidence too small in ten ways, forces that pull, a late load",
        TEN_AT_ONCE,
        *("order", "order-fitted", "size", "discrete-order-superclose", "discrete-share"),
    ),
)
OF_CONTACT: tuple[Control[Any], ...] = (
    *(
        Control(
            f"contact: {which} node",
            f"−u^h and −λ for u^h and λ at the {which} node alone",
            PATCH,
            partial(state_off, which, 0, {"u": -1.0, "multipliers": -1.0}),
            ("penetration", "pulling"),
        )
        for which in HALF
    ),
    Control(
        "contact: share of the dual norm",
        "1.01 λ for λ with half as many steps",
        PATCH,
        partial(coarse_forces, False, 0.01),
        "time-share",
    ),
    Control(
        "contact: share of the pressure",
        "λ off in turns by 1 % with half as many steps",
        PRESSED,
        partial(coarse_forces, True, 0.01),
        "time-share",
    ),
    *(
        Control(
            f"contact: time share, {which} node",
            f"30 λ for λ with half as many steps, at the {which} node alone",
            PATCH,
            partial(state_off, which, -1, {"multipliers": 30.0}),
            "time-share",
        )
        for which in HALF
    ),
)
OF_STRESSES: tuple[Control[Any], ...] = (
    *(
        Control(
            f"3.2: {name}, {which} step", f"{what} in the {which} step alone", BOTH, partial(dual_off, which, off), rows
        )
        for which in NODES
        for name, what, off, rows in (
            ("stress", "σ larger by a thousandth", {"stress": 1.001}, ("stress", "admissibility", "energy")),
            ("displacement", "−u for u", {"u": -1.0}, ("displacement", "membership")),
            ("duality gap", "a gap 10¹⁴ times as large", {"gap": 1e14}, "allowed"),
        )
    ),
    *(
        Control(
            f"admissible: {kind}",
            f"a stress that {what} by a few thousandths, at one edge in one step",
            OWN,
            Slip(ERRORS, "inadmissible", partial(inadmissible_once, kind, call)),
            "admissible",
        )
        for call, (kind, what) in enumerate(
            (
                ("jumps", "jumps between cells"),
                ("misses f_2", "misses f_2"),
                ("tangential", "is tangential on Γ3"),
                ("pulls", "pulls on Γ3"),
            ),
            start=3,
        )
    ),
    Control(
        "own space: time share",
        "5 σ for σ with half as many steps, in one step alone",
        OWN,
        Slip(ERRORS, "StressExperiment.companion", companion_off),
        "time-share",
    ),
)
IN_MARCHES: tuple[tuple[Any, ...], ...] = (
    ("u_n without contact", "V^h for K^h", ADMISSIBLE, "admissibility", Freed, 1.0, ("membership",)),
    ("u_n held", "v_ν = 0 for v_ν ≤ 0", ADMISSIBLE, "admissibility", defects.Bilateral, 1.0, ("cone", "displacements")),
    (
        "u_n pressed",
        "forces where a gap is open",
        ADMISSIBLE,
        "admissibility",
        Distant,
        1.0,
        ("work", "displacements"),
    ),
    ("contact held", "v_ν = 0 for v_ν ≤ 0", ESTIMATE, "steps_of_the_estimate", defects.Bilateral, 1 / 8, ("5.12",)),
    (
        "multipliers",
        "1.5 λ for λ",
        ESTIMATE,
        "steps_of_the_estimate",
        partial(forces_times, 1.5),
        1 / 8,
        ("slack-5.12",),
    ),
)
"""Contact solves that are wrong in one step: name, what, setting, module, solver, part of the steps, rows."""
STATEMENTS_OVER_TIME: tuple[Control[Any], ...] = (
    *(
        Control(
            f"{name}: {which} step",
            f"{what} in the {which} step alone",
            where,
            in_experiments_of(module, partial(solved_once_by, solver, which, part)),
            rows,
        )
        for name, what, where, module, solver, part, rows in IN_MARCHES
        for which in HALF
    ),
    *(
        Control(
            f"{name}: {which} node",
            f"{what} at the {which} node alone",
            where,
            in_experiments_of(module, partial(state_off, which, halvings, {"u": factor})),
            rows,
        )
        for name, what, where, module, halvings, factor, rows in (
            ("superclose", "10 u^h for u^h", CLOSE, "superclose", 0, 10.0, "order"),
            (
                "superclose: time share",
                "1.5 u^h for u^h, half as many steps,",
                CLOSE,
                "superclose",
                -1,
                1.5,
                "time-share",
            ),
            ("bounds", "1000 u^h for u^h", BOUNDS, "error_bounds", 0, 1e3, ("constant-5.21", "constant-5.42")),
        )
        for which in HALF
    ),
    *(
        Control(
            f"other ways: {which} node",
            f"1.001 u^h for u^h by every other way, at the {which} node alone",
            TRAJECTORY,
            in_experiments_of("uniqueness", partial(rival_off, which)),
            ("random-starts", "least-squares", "fixed-point", "interior-point"),
        )
        for which in HALF
    ),
    listed(
        "other ways to σ: one step",
        "1.001 σ for σ by every other way, in one step alone",
        ONE_STRESS,
        *("uniqueness", "stresses", stress_list_off),
        *("random-starts", "least-squares", "interior-point"),
    ),
    *(
        listed(f"{name}: {which} node", f"10 u_n for u_n at the {which} node alone", where, *patch, *rows)
        for which in HALF
        for name, where, right_first, rows in (
            ("velocity", VELOCITY, 0, ("bounded", "limit")),
            ("dependence", DEPENDENCE, 1, ("bound", "monotone")),
            ("growth", PARTING, 0, ("bound",)),
        )
        for patch in (("wellposed", "BACKWARD_EULER", partial(scheme_off, which, right_first)),)
    ),
    listed(
        "backward Euler: one node",
        "100 u_n for u_n at one node alone",
        GROWING,
        *("growing_errors", "interpolated", partial(rows_off, (), 129, 100.0)),
        "time",
    ),
    listed(
        "one instant: e",
        "10⁶ ‖e‖² for ‖e‖² at the fourth instant alone",
        ESTIMATE,
        *("steps_of_the_estimate", "course", partial(call_off, 3, partial(larger, ("e",)))),
        *("5.14", "5.16", "5.19"),
    ),
    listed(
        "one instant: η",
        "10⁶ ‖η‖² and (e, η)_V for the right ones at the fourth instant alone",
        ESTIMATE,
        *("steps_of_the_estimate", "course", partial(call_off, 3, partial(larger, ("eta", "both")))),
        *("5.15", "5.18"),
    ),
    listed(
        "one instant: σ^h",
        "10 σ^h for σ^h at the fifth instant alone",
        NATURAL,
        *("boundary", "discrete_stresses", stress_off_at_an_instant),
        *("loaded", "contact", "loaded-weakly", "tangential-weakly"),
    ),
    *(
        listed(f"front: {name}", what, ADVANCING, "advancing_front", *patch, key)
        for name, what, patch, key in (
            ("error at one node", "3 u^h for u^h at one node", ("path", partial(rows_off, (7,), 51, 3.0)), "order"),
            ("excess at one node", "3 u^h_lin at one node", ("path", partial(rows_off, (2, 5, 8), 13, 3.0)), "excess"),
            (
                "time share, odd node",
                "1.2 u^h, longer steps, one node",
                ("path", partial(rows_off, (0,), 7, 1.2)),
                "time",
            ),
            (
                "time share, even node",
                "1.2 u^h, longer steps, one node",
                ("path", partial(rows_off, (0,), 8, 1.2)),
                "time",
            ),
            (
                "load at one time",
                "1.1 f for f by the coarse rule",
                ("load_from_forces", load_of_forces_off),
                "quadrature",
            ),
        )
    ),
    *(
        Control(
            f"computed again: {name}, {which} node",
            f"{what} at the {which} node alone",
            AGAIN,
            partial(state_off, which, 1, off),
            rows,
        )
        for which in HALF
        for name, what, off, rows in (
            ("u", "1.1 u^h for u^h", {"u": 1.1}, ("displacement", "displacement-same-load")),
            ("λ", "2 λ for λ", {"multipliers": 2.0}, ("multipliers", "multipliers-same-load")),
        )
    ),
    Control(
        "computed again: errors at one time",
        "errors that are a hundred times too large, by the plain way",
        AGAIN,
        Slip(PLAIN, "PlainProblem.distance", partial(at_time, 33 / 64, hundredfold_each)),
        ("error", "interpolation-error"),
    ),
    Control(
        "computed again: Π^h u at one time",
        "10 Π^h u for Π^h u, by the plain way",
        AGAIN,
        Slip(PLAIN, "PlainProblem.interpolant", partial(at_time, 33 / 64, tenfold)),
        ("interpolation-error", "discrete-error"),
    ),
    *(
        Control(
            f"{name} at time {call}",
            f"{factor:g} times the known error at one time",
            where,
            Slip(BOUND_ROWS, "known_error", partial(known_error_off, call, factor)),
            key,
        )
        for call in (5, 6)
        for name, where, factor, key in (
            ("bound: error", BOUND, 1e3, "above"),
            ("enclosure: large error", ENCLOSURE, 1e3, "above"),
            ("enclosure: small error", ENCLOSURE, 1e-6, "below"),
        )
    ),
    listed(
        "R without f_0 at one time",
        "(f_0, v) left out of R at the second time alone",
        RESIDUAL,
        *("residual", "terms", partial(call_off, 1, without_body_force)),
        *("smooth", "remainder", "bound"),
    ),
    listed(
        "sign of u at one time",
        "−u for u at T/2 alone",
        INTERPOLANT,
        *("constraint", "over_time", partial(displacement_off, 0.5, negative)),
        "exact",
    ),
    listed(
        "Γ1 moved at one time",
        "u + 10⁻⁴ for u at 15 T/32 alone",
        INTERPOLANT,
        *("constraint", "over_time", partial(displacement_off, 15 / 32, shifted)),
        "clamped",
    ),
    listed(
        "R at one time",
        "100 R for R at one time alone",
        AT_REST,
        *("residual_bound", "Energies.functional", partial(call_off, 5, hundredfold)),
        "bound",
    ),
    listed(
        "load at one time",
        "100 ‖f(t_i) − f(t_{i−1})‖ in one interval alone",
        LOADS,
        *("norms_in_time", "dual_norm", partial(call_off, 30, hundredfold)),
        *("variation", "increments"),
    ),
    listed(
        "traction at one time",
        "10⁴ σν for σν at one time of the finest grid alone",
        TRACTION,
        *("norms_in_time", "resolve", partial(solution_off, "surface_load", 33 / 64, partial(_times, 1e4))),
        "bounded",
    ),
)
EVIDENCE: tuple[Control[Any], ...] = (*OF_RATES, *OF_CONTACT, *OF_STRESSES, *STATEMENTS_OVER_TIME)
