"""The replacements for deliberate defects, which ``study.controls.table`` lists.

A replacement is a function that returns the wrong part of the study, given the correct part. Functions with parameters
return such a replacement. "Deliberate defect: X" means that X is true after the replacement.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from copy import copy
from dataclasses import replace
from functools import partial
from itertools import count, islice, pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import scipy.sparse as sps
from skfem import Basis, ElementTriP1

from manufactured import isotropic
from manufactured.body import Kind
from manufactured.law import Yield
from study.controls.control import Replacement, overridden, replaced
from study.fem.error_norm import DEGREE, ErrorNorm
from study.fem.mesh import Unstructured
from study.fem.space import Space
from study.solve.evolution import SemiDiscrete
from study.solve.signorini import Signorini
from study.solve.tableau import BACKWARD_EULER
from study.statements.growing_errors import projection
from study.statements.shared.eigen import mass
from study.statements.thm_4_2 import Derived

Function = Callable[..., Any]

# Defects of any function or number.


def replaced_by(other: Any) -> Replacement:
    """Return the replacement by the given object."""
    return lambda right: other


def returns(value: Any) -> Replacement:
    """Deliberate defect: the function always returns the given value."""
    return lambda right: lambda *given, **options: value


def result(change: Function) -> Replacement:
    """Deliberate defect: the function returns its result after the given change."""
    return lambda right: lambda *given, **options: change(right(*given, **options))


def times(factor: float) -> Replacement:
    """Deliberate defect: the result is multiplied by a factor."""
    return result(lambda value: factor * value)


def column_times(column: str, factor: float) -> Replacement:
    """Deliberate defect: the function returns a table row with one number multiplied by a factor."""
    return result(lambda row: {**row, column: factor * row[column]})


def zeroed(*quantities: str) -> Replacement:
    """Deliberate defect: a measurement returns 0 for the named quantities."""
    return result(lambda found: {**found, **dict.fromkeys(quantities, 0.0)})


def in_one_call(call: int, change: Function) -> Replacement:
    """Deliberate defect: the function returns a changed result in one of its calls, counted from 0."""

    def wrong(right: Function) -> Function:
        calls = count()
        return lambda *given: (change if next(calls) == call else lambda value: value)(right(*given))

    return wrong


def at_time(time: float, change: Function) -> Replacement:
    """Deliberate defect: a method whose first argument is the time returns a changed result at one time."""
    return lambda method: lambda of, now, *given: _when(np.isclose(now, time), change, method(of, now, *given))


def row_times(calls: tuple[int, ...], row: int, factor: float) -> Replacement:
    """Deliberate defect: returned displacements are multiplied by a factor at one time.

    Args:
        calls: numbers of the calls of the function that have this defect, from 0; () for all calls.
        row: the index of the time.
    """

    def wrong(right: Function) -> Function:
        number = count()

        def found(*given: Any) -> Any:
            values = np.array(right(*given))
            if not calls or next(number) in calls:
                values[row] *= factor
            return values

        return found

    return wrong


def _when(condition: Any, change: Function, value: Any) -> Any:
    return change(value) if condition else value


energy = result(lambda norm: norm**2 / 2)
squared = result(lambda value: value**2)
squared_each = result(lambda errors: {name: error**2 for name, error in errors.items()})


# Wrong contact solvers. A contact solver is made from the matrix S, the normals N and, for some solvers, the points of
# the unknowns. It is a function that returns the displacement u and the contact forces λ, given the right-hand side b.


def contact(rule: Callable[[Signorini, Any], Any]) -> Replacement:
    """Deliberate defect: the contact forces come from ``rule``.

    Args:
        rule: function of the solver and of the gaps without contact forces.
    """

    def solver(S: Any, N: Any, *points: Any) -> Any:
        made = Signorini(S, N)
        return overridden(made, complementarity=lambda gap: rule(made, gap))

    return replaced_by(solver)


def solution(change: Callable[[Signorini, Any], Any]) -> Replacement:
    """Deliberate defect: displacement and forces come from ``change``, a function of the correct solver and of b."""

    return replaced_by(lambda S, N, *points: partial(change, Signorini(S, N)))


def shifted_gap(by: float) -> Replacement:
    """Deliberate defect: the constraint is v_ν ≤ by instead of v_ν ≤ 0."""
    return contact(lambda solver, gap: Signorini.complementarity(solver, gap - by))


def forces_times(factor: float) -> Replacement:
    """Deliberate defect: the contact forces are multiplied by a factor; the displacement is correct."""

    def change(solver: Signorini, b: Any) -> Any:
        u, forces = solver(b)
        return u, factor * forces

    return solution(change)


def unconstrained(solver: Signorini, b: Any) -> Any:
    """Return displacement and zero forces in V^h instead of K^h."""
    return solver.factor(b), np.zeros(solver.N.shape[0])


held = contact(lambda solver, gap: solver.multipliers_on(np.ones_like(solver.active), gap))
one_iteration = contact(lambda solver, gap: solver.multipliers_on(gap > 0, gap))
freed = solution(unconstrained)
no_multipliers = solution(lambda solver, b: (solver.factor(b), np.zeros(0)))


def in_places(right: Any) -> Any:
    """Deliberate defect: v_ν ≤ 0 is imposed at every other vertex of Γ3 only."""

    def solver(S: Any, N: Any, *points: Any) -> Any:
        made, forces = Signorini(S, N[::2]), np.zeros(N.shape[0])

        def solve(b: Any) -> Any:
            u, forces[::2] = made(b)
            return u, forces.copy()

        return solve

    return solver


def springs(right: Any) -> Any:
    """Deliberate defect: springs that push and pull, with a fixed stiffness, replace the condition v_ν ≤ 0."""
    return lambda S, N: freed(right)(sps.csc_array(S + 100.0 / N.shape[0] * (N.T @ N)), N)


class RandomSearch(Signorini):
    """Deliberate defect: the contact solve starts from a random active set and stops after the first iteration."""

    def __init__(self, S: sps.csc_array, N: sps.csr_array, *points: Any) -> None:
        super().__init__(S, N)
        self.rng = np.random.default_rng(0)

    def complementarity(self, gap: Any) -> Any:
        return self.multipliers_on((gap > 0) | (self.rng.uniform(size=len(gap)) < 0.5), gap)


def in_one_step(wrong: Replacement, which: str, part: float) -> Replacement:
    """Deliberate defect: one step is solved by a wrong contact solver.

    Args:
        wrong: replacement of the contact solver.
        which: the step, as for ``node``.
        part: number of steps among which the step is chosen, relative to the steps of the experiment.
    """

    def change(setup: Any) -> Any:
        call = node(which, int(part * setup.steps))

        def solver(S: Any, N: Any, *points: Any) -> Any:
            solve, other, calls = Signorini(S, N), wrong(Signorini)(S, N), count(1)
            return lambda b: (other if next(calls) == call else solve)(b)

        return replaced(setup, "problem.solver", replaced_by(solver))

    return change


# Time schemes that report a wrong trajectory.


def node(which: str, last: int) -> int:
    """Return the number of a time node: "first" is 1; "odd" and "even" lie in the middle; "last" is ``last``."""
    return {"first": 1, "odd": last // 2 | 1, "even": (last // 2 + 2) // 2 * 2, "last": last}[which]


def marching(march: Callable[[Any, Any, int], Iterator[Any]]) -> Replacement:
    """Deliberate defect: the time scheme yields the states of ``march``.

    Args:
        march: function of the correct scheme, a problem and a number of steps, which returns the states.
    """
    return lambda scheme: SimpleNamespace(
        name=scheme.name,
        order=scheme.order,
        march=lambda problem, steps: march(scheme, problem, steps),
    )


def states(change: Callable[[Any, int, Any, int], Any]) -> Replacement:
    """Deliberate defect: the time scheme yields changed states.

    Args:
        change: function of a state, its number, the problem and the number of steps, which returns the changed state.
    """

    def march(scheme: Any, problem: Any, steps: int) -> Iterator[Any]:
        return (change(state, n, problem, steps) for n, state in enumerate(scheme.march(problem, steps)))

    return marching(march)


def solving(alter: Callable[[SemiDiscrete], SemiDiscrete]) -> Replacement:
    """Deliberate defect: the scheme solves another problem than the one for which errors are measured."""
    return marching(lambda scheme, problem, steps: scheme.march(alter(problem), steps))


def state_off(which: str, halvings: int, **factors: float) -> Replacement:
    """Deliberate defect: parts of the state at one node are multiplied by factors.

    Args:
        which: the node, as for ``node``.
        halvings: only the trajectory with 2^halvings times the steps of the experiment has the defect.
        factors: name of an attribute of the state ↦ its factor.
    """

    def change(setup: Any) -> Any:
        defective = int(setup.steps * 2**halvings)

        def changed(state: Any, n: int, problem: Any, steps: int) -> Any:
            return _times_parts(state, factors) if steps == defective and n == node(which, steps) else state

        return replaced(setup, "scheme", states(changed))

    return change


def _times_parts(state: Any, factors: dict[str, float]) -> Any:
    return replace(state, **{name: factor * getattr(state, name) for name, factor in factors.items()})


def rival_off(which: str) -> Replacement:
    """Deliberate defect: other solutions than the experiment's are wrong by a thousandth at one node."""

    def change(setup: Any) -> Any:
        def changed(state: Any, n: int, problem: Any, steps: int) -> Any:
            off = problem is not setup.problem and n == node(which, steps)
            return _times_parts(state, {"u": 1.001}) if off else state

        return replaced(setup, "scheme", states(changed))

    return change


def displacement_off(which: str, right_first: int) -> Replacement:
    """Deliberate defect: the scheme reports ten times the displacement at one node, except in its first calls.

    Args:
        which: the node, as for ``node``.
        right_first: number of calls of ``march`` without the defect.
    """

    def change(scheme: Any) -> Any:
        calls = count()
        wrong = states(
            lambda state, n, _, steps: _times_parts(state, {"u": 10.0}) if n == node(which, steps) else state
        )

        def march(right: Any, problem: Any, steps: int) -> Iterator[Any]:
            found: Iterator[Any] = (right if next(calls) < right_first else wrong(right)).march(problem, steps)
            return found

        return marching(march)(scheme)

    return change


def coarse_forces(change: Callable[[Any], Any]) -> Replacement:
    """Deliberate defect: the contact forces of the run with half as many steps are changed."""

    def changed(setup: Any) -> Any:
        def alter(state: Any, n: int, problem: Any, steps: int) -> Any:
            return replace(state, multipliers=change(state.multipliers)) if steps < setup.steps else state

        return replaced(setup, "scheme", states(alter))

    return changed


def off_in_turns(forces: Any) -> Any:
    """Return contact forces that are wrong by a hundredth of the largest force, with alternating signs."""
    return forces + 0.01 * (-1.0) ** np.arange(len(forces)) * forces.max()


def _last_state(scheme: Any, problem: Any, steps: int) -> Iterator[Any]:
    *_, last = scheme.march(problem, steps)
    yield last


def _one_behind(scheme: Any, problem: Any, steps: int) -> Iterator[Any]:
    first, *states = scheme.march(problem, steps)
    yield first
    for before, state in pairwise((first, *states)):
        yield replace(state, u=before.u)


last_state, one_behind = marching(_last_state), marching(_one_behind)
without_residual = states(lambda state, *where: replace(state, residual=lambda: 0.0))
no_viscosity = solving(lambda problem: replace(problem, M=0 * problem.M))
no_elasticity = solving(lambda problem: replace(problem, reference=0 * problem.reference))
swapped = solving(lambda problem: replace(problem, M=problem.reference, reference=problem.M))


def companion_is_the_run(setup: Any) -> Any:
    """Deliberate defect: the trajectory with step k consists of every other state of the trajectory with k/2.

    The distance of the two trajectories, which should show the time share, is then 0.
    """

    def march(scheme: Any, problem: Any, steps: int) -> Iterator[Any]:
        halved = steps == setup.steps
        return islice(scheme.march(problem, 2 * steps), 0, None, 2) if halved else scheme.march(problem, steps)

    return replaced(setup, "scheme", marching(march))


def every_other_state(companion: Function) -> Function:
    """Deliberate defect: Problem 3.2 with half as many steps is every other state of the solution with all steps."""
    return lambda experiment: islice(experiment.march(), 1, None, 2)


# Defects of the data of an experiment.


def an_eighth(steps: int) -> int:
    """Return an eighth of the number of time steps."""
    return max(steps // 8, 1)


def no_contact(problem: Any) -> Any:
    """Deliberate defect: V^h instead of K^h, without constraints."""
    return replace(problem, N=problem.N[:0], gap=0.0, solver=freed(problem.solver))


def constraint_relaxed(setup: Any) -> Any:
    """Deliberate defect: v_ν ≤ √h instead of v_ν ≤ 0."""
    return replaced(setup, "problem.solver", shifted_gap(math.sqrt(setup.space.h)))


def nearest_axis(N: Any) -> Any:
    """Deliberate defect: the nearest axis instead of ν, in 2D."""
    N = N.copy()
    normals = N.data.reshape(-1, 2)
    nearest = np.arange(2) == abs(normals).argmax(axis=1)[:, None]
    N.data = np.where(nearest, np.sign(normals), 0.0).ravel()
    return N


def load_late(setup: Any) -> Any:
    """Deliberate defect: F(t − k) instead of F(t)."""
    k = setup.problem.T / setup.steps
    return replaced(setup, "problem.load", lambda load: lambda t: load(max(t - k, 0.0)))


def contact_work_times(factor: float) -> Replacement:
    """Deliberate defect: the work of contact in the load (3.7) is multiplied by a factor."""

    wrong = other_contact_work(factor)(ErrorNorm)
    return lambda setup: replaced(setup, "problem.load", replaced_by(wrong(setup.solution, setup.space).load))


def other_contact_work(factor: float) -> Replacement:
    """Deliberate defect: the class that measures errors multiplies the work of contact by a factor."""

    def make(v_norm: type[ErrorNorm]) -> Function:
        def made(*given: Any) -> Any:
            found = v_norm(*given)
            right = found._contact_work
            return overridden(found, _contact_work=lambda *amplitudes: factor * right(*amplitudes))

        return made

    return make


def start_at_the_end(setup: Any) -> Any:
    """Deliberate defect: u_0^h = Π^h u(T)."""
    return replaced(setup, "problem.u0", replaced_by(setup.v_norm.sample(setup.problem.T).interpolant))


def start_outside(problem: Any) -> Any:
    """Deliberate defect: u_0^h ∉ K^h."""
    return replace(problem, u0=problem.u0 + 10 * problem.N.T @ np.ones(problem.N.shape[0]))


def start_at_projection(setup: Any) -> Any:
    """Deliberate defect: u_0^h = P_h u_0, the projection in (·,·)_V, for a homogeneous A."""
    return replaced(setup, "problem.u0", replaced_by(projection(setup, 0.0)))


def clamp_one_cell_short(setup: Any) -> Any:
    """Deliberate defect: functions of V^h need not vanish at the first vertex of every part of Γ1."""
    space = Space(setup.space.mesh, setup.space.body)
    ends = [_nearest(space, part.start) for part in space.body.of(Kind.CLAMPED)]
    loose = space.dim * np.array(ends)[:, None] + np.arange(space.dim)
    overridden(space, free=np.union1d(setup.space.free, loose))
    v_norm = ErrorNorm(setup.solution, space)
    problem = SemiDiscrete.of(space, setup.solution.law, v_norm.load, v_norm.sample(0.0).interpolant)
    return replace(setup, space=space, v_norm=v_norm, problem=problem)


def _nearest(space: Space, x: Any) -> int:
    return int(np.linalg.norm(space.mesh.p - x[:, None], axis=0).argmin())


def k_like_h(setup: Any) -> Any:
    """Deliberate defect: a fully discrete solution, of first order in k ~ h, instead of u^h."""
    return replace(setup, scheme=BACKWARD_EULER, steps=round(1 / setup.space.h))


# Defects of the measurement of errors.


def _v_norm(setup: Any, **methods: Any) -> Any:
    """Return the experiment with a new object that measures errors, with the given methods replaced."""
    return replace(setup, v_norm=overridden(ErrorNorm(setup.solution, setup.space), **methods))


def norm_of_l2(setup: Any) -> Any:
    """Deliberate defect: ‖v‖_{L²} instead of (A ε(v), ε(v))^½."""
    return _v_norm(setup, distance=_l2_distance(setup))


def _l2_distance(setup: Any) -> Function:
    basis = Basis(setup.space.mesh, ElementTriP1(), intorder=DEGREE)
    exact = setup.solution.at(np.asarray(basis.global_coordinates()))

    def distance(sample: Any, v: Any) -> float:
        computed = np.array([np.asarray(basis.interpolate(component)) for component in setup.space.nodal(v)])
        return float(np.sqrt(np.sum((exact.displacement(sample.time) - computed) ** 2 * basis.dx)))

    return distance


def norm_of_h1(setup: Any) -> Any:
    """Deliberate defect: (‖v‖² + ‖ε(v)‖²)^½ instead of (A ε(v), ε(v))^½."""
    found, of_values = _v_norm(setup, A=isotropic(0.5, 0, setup.space.dim)), _l2_distance(setup)
    of_strain = found.v_norm.distance
    overridden(found.v_norm, distance=lambda sample, v: math.hypot(of_strain(sample, v), of_values(sample, v)))
    return found


def norm_with_elasticity(setup: Any) -> Any:
    """Deliberate defect: (G ε(v), ε(v))^½ instead of (A ε(v), ε(v))^½."""
    return _v_norm(setup, A=setup.solution.law.G)


def one_point_quadrature(setup: Any) -> Any:
    """Deliberate defect: ε(u) at the centres of cells only, where the interpolant's strain is nearly exact."""
    centres = setup.solution.at(setup.space.mesh.p[:, setup.space.mesh.t].mean(axis=1))
    sample = setup.v_norm.sample
    return _v_norm(setup, sample=lambda t: replace(sample(t), means=centres.strain(t), oscillation=0.0))


def sum_of_roots(setup: Any) -> Any:
    """Deliberate defect: Σ_T ‖·‖_T instead of (Σ_T ‖·‖_T²)^½, with the oscillation divided evenly among the cells."""

    def distance(sample: Any, v: Any) -> float:
        difference = sample.means - setup.space.strain(v)
        local = np.sum(setup.v_norm.A(difference) * difference, axis=0) * setup.space.volumes
        return float(np.sqrt(local + sample.oscillation / len(local)).sum())

    return _v_norm(setup, distance=distance)


def interpolant_off(which: str) -> Replacement:
    """Deliberate defect: 5 Π^h u instead of Π^h u at one node."""

    five = lambda found: replace(found, interpolant=5.0 * found.interpolant)  # noqa: E731

    def change(setup: Any) -> Any:
        at_node: Function = lambda time: np.isclose(time, _time(which, setup))  # noqa: E731
        return replaced(setup, "v_norm.sample", lambda right: lambda time: _when(at_node(time), five, right(time)))

    return change


def interpolation_error_off(which: str, factor: float) -> Replacement:
    """Deliberate defect: ‖u − Π^h u‖_V is multiplied by a factor at one node."""

    def change(setup: Any) -> Any:
        right = setup.v_norm.distance

        def distance(sample: Any, v: Any) -> float:
            off = v is sample.interpolant and np.isclose(sample.time, _time(which, setup))
            return float((factor if off else 1.0) * right(sample, v))

        return replaced(setup, "v_norm.distance", replaced_by(distance))

    return change


def _time(which: str, setup: Any) -> float:
    """Return the time of a node of the measured trajectory."""
    return float(setup.problem.T * node(which, 2 * setup.steps) / (2 * setup.steps))


def load_off(amount: Callable[[float], float]) -> Replacement:
    """Deliberate defect: the load has a relative error, a function of t/T, as if its quadrature were coarse."""

    def change(setup: Any) -> Any:
        right, T = setup.v_norm.load, setup.problem.T
        wrong = replaced_by(lambda time: (1 + amount(time / T)) * right(time))
        return replaced(replaced(setup, "problem.load", wrong), "v_norm.load", wrong)

    return change


# Defects that make diagnostics too small.


def balance_alone(residual: Function) -> Function:
    """Deliberate defect: the residual ignores the sign of the contact forces, complementarity and the gap."""
    size = np.linalg.norm
    return lambda step, u, multipliers, b: float(size(step.S @ u + step.forces @ multipliers - b) / size(b))


def every_second_time(measure: Function) -> Function:
    """Deliberate defect: only every second time is measured, and residual and time share at the last time only."""

    def found(setup: Any) -> Any:
        right = measure(setup)
        (*_, coarse), (*_, fine) = (setup.scheme.march(setup.problem, steps * setup.steps) for steps in (1, 2))
        drift = float(np.sqrt((coarse.u - fine.u) @ (setup.problem.M @ (coarse.u - fine.u))))
        return replace(right, history=right.history[:, ::2], drift=drift, residual=fine.residual())

    return found


def at_the_last_time(parallelogram: Function) -> Function:
    """Deliberate defect: the parallelogram law is tested at the last time only."""
    return lambda found: parallelogram(replace(found, history=found.history[:, -1:]))


# Defects of Theorem 4.2 with both problems on one mesh.


def stress_from_displacement(sides: Any) -> Any:
    """Deliberate defect: the stress of Problem 3.1 replaces the stress of Problem 3.2.

    The two stresses then agree perfectly, which proves nothing.
    """
    honest = sides.stresses(sides.displacements)
    return replace(sides, stresses=lambda problem: Derived.compared(honest, problem))


def compared_with_itself(sides: Any) -> Any:
    """Deliberate defect: the stress that the law gives for Problem 3.1 replaces the solutions of both problems."""
    derived = Derived.compared(sides.stresses(sides.displacements), sides.displacements)
    return replace(sides, stresses=lambda problem: derived)


def stresses(change: Function) -> Replacement:
    """Deliberate defect: Problem 3.2 is changed."""

    def changed(sides: Any) -> Any:
        wrong = change(sides.stresses(sides.displacements))
        return replace(sides, stresses=lambda problem: wrong)

    return changed


def stress_march(change: Callable[[Iterator[Any], int], Iterator[Any]]) -> Replacement:
    """Deliberate defect: the states of Problem 3.2 are changed.

    Args:
        change: function of the states and the number of steps.
    """
    return stresses(lambda right: overridden(copy(right), march=lambda steps: change(right.march(steps), steps)))


def step_times(which: str, **factors: float) -> Replacement:
    """Deliberate defect: parts of the state of Problem 3.2 are multiplied by factors in one step."""
    return stress_march(
        lambda states, steps: (_times_parts(s, factors) if n == node(which, steps) else s for n, s in enumerate(states))
    )


def _displacement_late(states: Iterator[Any], steps: int) -> Iterator[Any]:
    before = None
    for state in states:
        yield state if before is None else replace(state, u=before)
        before = state.u


stress_gaps = stresses(lambda problem: replace(problem, N=problem.N[::2]))
displacement_late = stress_march(_displacement_late)
stress_load_late = stresses(
    lambda problem: replaced(problem, "load", lambda load: lambda t: load(max(t - problem.space.body.T / 8, 0.0)))
)


# Defects of Theorem 4.2 with a separate stress space.


def law_swapped(setup: Any) -> Any:
    """Deliberate defect: A and G are swapped in Problem 3.2."""
    law = setup.data.law
    return replaced(setup, "data.law", replaced_by(replace(law, A=law.G, G=law.A)))


def no_surface_load(part: Any, x: Any) -> Function:
    """Return f_2 = 0, at one time or at several."""
    return lambda time: np.zeros((*x.shape, *np.shape(time)))


def surface_load_late(setup: Any) -> Any:
    """Deliberate defect: f_2(t − k) instead of f_2(t)."""
    k = setup.data.body.T / setup.steps
    late = lambda right: lambda part, x: lambda time: right(part, x)(np.maximum(time - k, 0.0))  # noqa: E731
    return replaced(setup, "data.surface_load", late)


def without_viscosity(make: Function) -> Function:
    """Deliberate defect: Gε(u^h) instead of Aε(δu^h) + Gε(u^h)."""

    def made(primal: Any, *given: Any) -> None:
        make(primal, *given)
        primal.viscous = 0 * primal.viscous

    return made


def companion_off(companion: Function) -> Function:
    """Deliberate defect: the stress with half as many steps is wrong in one of them."""
    five = lambda state: replaced(state, "stress.values", lambda values: 5 * values)  # noqa: E731
    return lambda setup: (_when(n == 2, five, state) for n, state in enumerate(companion(setup)))


def inadmissible_once(kind: str, call: int) -> Replacement:
    """Deliberate defect: in one step a stress is inadmissible by some thousandths of its size.

    Args:
        kind: "jumps" between cells, "misses f_2", is "tangential" on Γ3, or "pulls" on Γ3.
        call: number of the step.
    """

    def spoiled(space: Any, state: Any) -> Any:
        tractions = state.stress.tractions.copy()
        where = {"misses f_2": Kind.LOADED, "tangential": Kind.CONTACT, "pulls": Kind.CONTACT}
        on = np.flatnonzero(space.mesh.f2t[1] >= 0) if kind == "jumps" else space.on(where[kind])[0][1]
        cell, side = np.argwhere(space.edges == on[len(on) // 2])[0]
        little = 1e-3 * call * abs(tractions).max()
        if kind == "pulls":
            tractions[cell, side, :, 0] = little
        else:
            tractions[cell, side, :, 1] += little
        return replaced(state, "stress.tractions", replaced_by(tractions))

    def wrong(inadmissible: Function) -> Function:
        calls = count()
        return lambda space, state: inadmissible(space, spoiled(space, state) if next(calls) == call else state)

    return wrong


# Defects of the spaces and meshes of other statements.


def space(change: Callable[[Space], dict[str, Any]]) -> Replacement:
    """Deliberate defect: V^h has other attributes.

    Args:
        change: function that returns the names and values of the new attributes, given the correct space.
    """
    return result(lambda right: overridden(Space(right.mesh, right.body), **change(right)))


def pinned(right: Space) -> dict[str, Any]:
    """Return the attributes of a space with Γ1 reduced to two of its points."""
    corners = np.array([end for part in right.body.of(Kind.CLAMPED) for end in part.corners.T[:2]])[:2]
    fixed = [_nearest(right, corner) for corner in corners]
    return {"free": np.flatnonzero(np.repeat(~np.isin(np.arange(right.mesh.p.shape[1]), fixed), right.dim))}


def inward(right: Space) -> dict[str, Any]:
    """Return the attributes of a space whose normals on Γ3 point inwards."""
    return {"N": -right.N}


def off_contact(right: Space) -> dict[str, Any]:
    """Return the attributes of a space with a constraint at a vertex inside the body instead of the last one of Γ3."""
    inside = np.flatnonzero((abs(right.mesh.p - right.mesh.p.mean(axis=1)[:, None]) < 0.2).all(axis=0))[0]
    row = sps.csr_array(([1.0], ([0], [2 * inside + 1])), shape=(1, 2 * right.mesh.p.shape[1]))[:, right.free]
    return {"N": sps.csr_array(sps.vstack([right.N[:-1], row]))}


def ungraded(graded: Function) -> Function:
    """Deliberate defect: meshes are not refined at a corner."""
    return lambda family, body, n: Unstructured()(body, n)


def over_vertices(h1_product: Function) -> Function:
    """Deliberate defect: Σ v·w over the vertices instead of (v, w)_H, without areas as weights."""
    return lambda space: sps.csc_array(h1_product(space) - mass(space) + sps.eye_array(space.dofs))


# Defects of laws.


class Misstated:
    """A changed operator with the stated constants of the correct one."""

    def __init__(self, right: Any, change: Replacement) -> None:
        self.right, self.change = right, change

    def __getattr__(self, name: str) -> Any:
        return getattr(self.right, name)

    def at(self, x: Any) -> Misstated:
        return Misstated(self.right.at(x), self.change)

    def __call__(self, strain: Any) -> Any:
        return self.change(self.right)(strain)


def law(tensor: str, change: Replacement) -> Replacement:
    """Deliberate defect: A or G of a case is changed, and its stated constants are those of the correct operator.

    Args:
        tensor: "A" or "G".
        change: the replacement of the operator.
    """

    def misstated(case: Any) -> Any:
        right = case.solution.law
        parts = {"A": right.A, "G": right.G, tensor: Misstated(getattr(right, tensor), change)}
        return SimpleNamespace(solution=SimpleNamespace(law=SimpleNamespace(**parts)))

    return result(misstated)


def engineering_shear(right: Function) -> Function:
    """Deliberate defect: the shear component is ε_12 instead of √2 ε_12 in Mandel's vectors."""

    def operator(strain: Any) -> Any:
        shear = np.ones((len(strain), *[1] * (strain.ndim - 1)))
        shear[-1] = math.sqrt(0.5)
        return shear * right(shear * strain)

    return operator


def returning(radius: float = 1.0, share: float = 1.0) -> Replacement:
    """Deliberate defect: the law (3.3) has a wrong elastic set K, or its projection onto K is wrong.

    Args:
        radius: factor of the radius of K.
        share: factor of the result.
    """

    class Returning(Yield):
        def __call__(self, strain: Any) -> Any:
            ball: Any = self.convex
            return share * Yield(self.beta, replace(ball, radius=radius * ball.radius))(strain)

    return lambda projection: lambda G, count: projection(Returning(G.beta, G.convex), count)


# Defects of terms and of exact solutions.


def without(*names: str) -> Replacement:
    """Deliberate defect: the named terms of R are left out."""
    return result(lambda terms: replace(terms, **{name: 0 * getattr(terms, name) for name in names}))


def no_body_force(terms: Any) -> Any:
    """Return the terms without (f_0, v)."""
    return replace(terms, body=0 * terms.body)


def no_work_on_loaded(work_on: Function) -> Function:
    """Deliberate defect: (f_2, v)_{L²(Γ2)} is left out."""
    return lambda kind, *given: (0.0 if kind is Kind.LOADED else 1.0) * work_on(kind, *given)


def no_rate(on_cells: Function) -> Function:
    """Deliberate defect: G ε(u^h) instead of A ε(u̇^h) + G ε(u^h)."""

    def found(*given: Any) -> Any:
        right = on_cells(*given)
        return SimpleNamespace(stress=lambda rate, strain: right.stress(0 * rate, strain))

    return found


def half_a_step_late(discrete_stresses: Function) -> Function:
    """Deliberate defect: σ^h is compared with σ half a step later."""
    return lambda setup: (
        (time + setup.problem.T / setup.steps / 2, stress) for time, stress in discrete_stresses(setup)
    )


def stress_off_at_an_instant(discrete_stresses: Function) -> Function:
    """Deliberate defect: σ^h is ten times too large at the fifth of the instants."""
    return lambda setup: (
        (time, (10 if n == 4 else 1) * stress) for n, (time, stress) in enumerate(discrete_stresses(setup))
    )


def exact_displacement(change: Function, time: float | None = None) -> Replacement:
    """Deliberate defect: the exact displacement is changed, at all times or at ``time`` times T only."""
    return lambda over_time: lambda trace, solution: over_time(trace, _changed(solution, "displacement", time, change))


def exact_solution(method: str, time: float, change: Function) -> Replacement:
    """Deliberate defect: the exact solution of every case is changed at the time ``time`` · T."""
    return result(lambda case: SimpleNamespace(solution=_changed(case.solution, method, time, change)))


def _changed(solution: Any, method: str, time: float | None, change: Function) -> Any:
    def at(x: Any) -> Any:
        right = getattr(solution.at(x), method)

        def evaluated(*given: Any) -> Any:
            return _when(time is None or np.isclose(given[-1], time * solution.body.T), change, right(*given))

        return SimpleNamespace(**{method: evaluated})

    return SimpleNamespace(body=solution.body, at=at)


def interpolant_late(sample: Function) -> Function:
    """Deliberate defect: the interpolant is Π^h u(0.9 t) instead of Π^h u(t)."""
    return lambda v_norm, time: replace(sample(v_norm, time), interpolant=sample(v_norm, 0.9 * time).interpolant)


def times_width(right: Function) -> Function:
    """Deliberate defect: the result is multiplied by the extent of the mesh along the first axis."""
    return lambda self, *given: float(np.ptp(self.space.mesh.p[0])) * right(self, *given)


def times_h(power: int) -> Replacement:
    """Deliberate defect: errors are multiplied by a power of h."""
    return lambda right: (
        lambda solution, space, face: {n: e * space.h**power for n, e in right(solution, space, face).items()}
    )


def opposite_work(compare: Function) -> Function:
    """Deliberate defect: (B(u + d) − B(u), −d)_V without division by ‖d‖_V²."""

    def found(operator: Any, base: Any, step: Any) -> tuple[float, float, Any]:
        quotient, product, image = compare(operator, base, step)
        return quotient, -product * float(step @ (operator.problem.M @ step)), image

    return found


def random_only(quotients: Function) -> Function:
    """Deliberate defect: only the first pairs are used, which are random; the worst pair is not searched."""
    return lambda *given: islice(quotients(*given), 10)


def cut_off(projected: Function) -> Function:
    """Deliberate defect: the projection on K^h sets positive v_ν at vertices to 0 instead of minimising ‖·‖_V."""
    products: Function = lambda N: (N @ N.T).toarray()  # noqa: E731
    return lambda problem, u: u - problem.N.T @ np.linalg.solve(products(problem.N), np.maximum(problem.N @ u, 0.0))


def law_alone(pair: Any) -> Any:
    """Deliberate defect: σ^h = Cε(u^h), which does not balance the loads."""
    return lambda *given: overridden(pair(*given), bound=0.0, distance=0.0)


def rival(name: str, solver: Any) -> Replacement:
    """Deliberate defect: the given solver replaces the named one of the solvers with which results are compared."""
    return lambda rivals: {**rivals, name: solver}


def same_problem(name: str) -> Replacement:
    """Deliberate defect: the problem is compared with itself instead of with the named other problem."""
    return lambda rivals: lambda problem: {**rivals(problem), name: problem}


def rival_stress_off(stresses: Function) -> Function:
    """Deliberate defect: all solvers but ``Signorini`` return a stress that is wrong by a thousandth in one step."""
    return lambda setup: [
        (1.001 if n == 6 and setup.solver is not Signorini else 1.0) * stress
        for n, stress in enumerate(stresses(setup))
    ]


def unweighted(facet_rule: Function) -> Function:
    """Deliberate defect: sums over quadrature points without the lengths as weights."""
    return result(lambda rule: replace(rule, weights=1 + 0 * rule.weights))(facet_rule)  # type: ignore[no-any-return]


def body_load_off(right: Function) -> Function:
    """Deliberate defect: the load by the coarse rule is wrong at one time."""
    off: Function = lambda solution, time, degree: degree < 3 and np.isclose(time, 0.375 * solution.body.T)  # noqa: E731
    return lambda solution, space, time, degree: (
        (1.1 if off(solution, time, degree) else 1.0) * right(solution, space, time, degree)
    )


def known_error(call: int, factor: float) -> Replacement:
    """Deliberate defect: the known error is multiplied by a factor at one of the times."""
    return result(lambda error: in_one_call(call, lambda value: factor * value)(error))


def larger(*names: str) -> Function:
    """Return a function that makes the named squares of norms at one instant far too large."""
    return lambda course: _times_parts(course, dict.fromkeys(names, 1e6))


def load_of_before(euler: Function) -> Function:
    """Deliberate defect: backward Euler uses the load at the time t − T/8."""
    return lambda problem, times: euler(
        replace(problem, load=lambda t: problem.load(max(t - problem.T / 8, 0.0))), times
    )


def norm_of_nodal_values(furthest: Function) -> Function:
    """Deliberate defect: the largest Euclidean norm of differences of nodal values instead of the norm of V."""
    return lambda problem, one, other: float(np.linalg.norm(one - other, axis=1).max())


def constant_halved(bounds: Function) -> Function:
    """Deliberate defect: error bounds of backward Euler use half of the Lipschitz constant κ."""
    return lambda flow, kappa, growth: bounds(flow, kappa / 2, growth)


def always_steps(most: int) -> Replacement:
    """Deliberate defect: trajectories with half as many steps are every second state of the one with ``most`` steps."""
    return lambda path: (
        lambda problem, scheme, steps: (
            path(problem, scheme, most)[::2] if 2 * steps == most else path(problem, scheme, steps)
        )
    )


def near_vertices(spikes: Function) -> Function:
    """Deliberate defect: the field is shifted by an eighth of the radius of its narrowest spikes."""
    return lambda x, last: spikes(x + 4.0**-last / 8, last)
