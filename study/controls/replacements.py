"""The wrong pieces of ``study.controls.table``: each function gives the wrong piece from the correct one."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from copy import copy
from dataclasses import replace
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

# Of any function or number.


def instead(other: Any) -> Replacement:
    """Something else."""
    return lambda right: other


def returns(value: Any) -> Replacement:
    """A function that always returns one value."""
    return lambda right: lambda *given, **options: value


def result(change: Function) -> Replacement:
    """A function whose result is changed."""
    return lambda right: lambda *given, **options: change(right(*given, **options))


def times(factor: float) -> Replacement:
    """A function whose result is wrong by a factor."""
    return result(lambda value: factor * value)


def column_times(column: str, factor: float) -> Replacement:
    """A function that returns a row of a table with one wrong number."""
    return result(lambda row: {**row, column: factor * row[column]})


def zeroed(*quantities: str) -> Replacement:
    """A measurement that returns 0 for some quantities."""
    return result(lambda found: {**found, **dict.fromkeys(quantities, 0.0)})


def in_one_call(call: int, change: Function) -> Replacement:
    """A function whose result is changed in one of its calls, counted from 0."""

    def wrong(right: Function) -> Function:
        calls = count()
        return lambda *given: (change if next(calls) == call else lambda value: value)(right(*given))

    return wrong


def at_time(time: float, change: Function) -> Replacement:
    """A method with the time as its first argument whose result is changed at one time."""
    return lambda method: lambda of, now, *given: _when(np.isclose(now, time), change, method(of, now, *given))


def row_times(calls: tuple[int, ...], row: int, factor: float) -> Replacement:
    """A function whose result, displacements at all times, is wrong at one time; in some calls, () for all."""

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


# Contact solvers: functions of (S, N), and of the points of the unknowns if these are given, with b ↦ (u, λ).


def contact(rule: Callable[[Signorini, Any], Any]) -> Replacement:
    """The forces come from ``rule``, a function of the solver and of the gaps without contact forces."""

    def solver(S: Any, N: Any, *points: Any) -> Any:
        made = Signorini(S, N)
        return overridden(made, complementarity=lambda gap: rule(made, gap))

    return instead(solver)


def solution(change: Callable[[Signorini, Any], Any]) -> Replacement:
    """Displacement and forces come from ``change``, a function of the correct solver and of b."""

    def solver(S: Any, N: Any, *points: Any) -> Any:
        made = Signorini(S, N)
        return lambda b: change(made, b)

    return instead(solver)


def shifted_gap(by: float) -> Replacement:
    """v_ν ≤ by instead of v_ν ≤ 0."""
    return contact(lambda solver, gap: Signorini.complementarity(solver, gap - by))


def forces_times(factor: float) -> Replacement:
    """The correct displacement with forces that are wrong by a factor."""

    def change(solver: Signorini, b: Any) -> Any:
        u, forces = solver(b)
        return u, factor * forces

    return solution(change)


def unconstrained(solver: Signorini, b: Any) -> Any:
    """V^h instead of K^h."""
    return solver.factor(b), np.zeros(solver.N.shape[0])


held = contact(lambda solver, gap: solver.multipliers_on(np.ones_like(solver.active), gap))
one_iteration = contact(lambda solver, gap: solver.multipliers_on(gap > 0, gap))
freed = solution(unconstrained)
no_multipliers = solution(lambda solver, b: (solver.factor(b), np.zeros(0)))


def in_places(right: Any) -> Any:
    """v_ν ≤ 0 at every other vertex of Γ3 only."""

    def solver(S: Any, N: Any, *points: Any) -> Any:
        made, forces = Signorini(S, N[::2]), np.zeros(N.shape[0])

        def solve(b: Any) -> Any:
            u, forces[::2] = made(b)
            return u, forces.copy()

        return solve

    return solver


def springs(right: Any) -> Any:
    """Springs instead of v_ν ≤ 0, in pressure and tension, whose stiffness does not grow with n."""
    return lambda S, N: freed(right)(sps.csc_array(S + 100.0 / N.shape[0] * (N.T @ N)), N)


class RandomSearch(Signorini):
    """The contact solve from a random active set, which stops after the first iteration."""

    def __init__(self, S: sps.csc_array, N: sps.csr_array, *points: Any) -> None:
        super().__init__(S, N)
        self.rng = np.random.default_rng(0)

    def complementarity(self, gap: Any) -> Any:
        return self.multipliers_on((gap > 0) | (self.rng.uniform(size=len(gap)) < 0.5), gap)


def in_one_step(wrong: Replacement, which: str, part: float) -> Replacement:
    """Solve one of ``part`` times the experiment's steps by another contact solver, all others correctly."""

    def change(setup: Any) -> Any:
        call = node(which, int(part * setup.steps))

        def solver(S: Any, N: Any, *points: Any) -> Any:
            solve, other, calls = Signorini(S, N), wrong(Signorini)(S, N), count(1)
            return lambda b: (other if next(calls) == call else solve)(b)

        return replaced(setup, "problem.solver", instead(solver))

    return change


# Time schemes: wrong reports of a trajectory.


def node(which: str, last: int) -> int:
    """The number of a time node: 1, an odd or even one in the middle, or the last."""
    return {"first": 1, "odd": last // 2 | 1, "even": (last // 2 + 2) // 2 * 2, "last": last}[which]


def marching(march: Callable[[Any, Any, int], Iterator[Any]]) -> Replacement:
    """A time scheme whose states come from ``march``, a function of the scheme, a problem and a number of steps."""
    return lambda scheme: SimpleNamespace(
        name=scheme.name,
        order=scheme.order,
        march=lambda problem, steps: march(scheme, problem, steps),
    )


def solving(alter: Callable[[SemiDiscrete], SemiDiscrete]) -> Replacement:
    """A scheme that solves another problem than the one that errors are measured for."""
    return marching(lambda scheme, problem, steps: scheme.march(alter(problem), steps))


def state_off(which: str, halvings: int, **factors: float) -> Replacement:
    """Multiply parts of the state at one node of the trajectory with 2^halvings times the steps of the experiment."""

    def change(setup: Any) -> Any:
        def march(scheme: Any, problem: Any, steps: int) -> Iterator[Any]:
            wrong = node(which, steps) if steps == int(setup.steps * 2**halvings) else None
            return (
                _times_parts(state, factors) if n == wrong else state for n, state in _numbered(scheme, problem, steps)
            )

        return replaced(setup, "scheme", marching(march))

    return change


def _numbered(scheme: Any, problem: Any, steps: int) -> Iterator[tuple[int, Any]]:
    return enumerate(scheme.march(problem, steps))


def _times_parts(state: Any, factors: dict[str, float]) -> Any:
    return replace(state, **{name: factor * getattr(state, name) for name, factor in factors.items()})


def rival_off(which: str) -> Replacement:
    """Return a rival with a displacement wrong by a thousandth at one node, in all problems except the experiment's."""

    def change(setup: Any) -> Any:
        def march(scheme: Any, problem: Any, steps: int) -> Iterator[Any]:
            wrong = None if problem is setup.problem else node(which, steps)
            return (
                _times_parts(state, {"u": 1.001}) if n == wrong else state
                for n, state in _numbered(scheme, problem, steps)
            )

        return replaced(setup, "scheme", marching(march))

    return change


def displacement_off(which: str, right_first: int) -> Replacement:
    """A scheme that reports ten times the displacement at one node, except in its first calls."""

    def change(scheme: Any) -> Any:
        calls = count()

        def march(scheme: Any, problem: Any, steps: int) -> Iterator[Any]:
            wrong = node(which, steps) if next(calls) >= right_first else None
            return (
                _times_parts(state, {"u": 10.0}) if n == wrong else state
                for n, state in _numbered(scheme, problem, steps)
            )

        return marching(march)(scheme)

    return change


def coarse_forces(change: Callable[[Any], Any]) -> Replacement:
    """Contact forces of the run with half as many steps are changed."""

    def changed(setup: Any) -> Any:
        def march(scheme: Any, problem: Any, steps: int) -> Iterator[Any]:
            coarse = steps < setup.steps
            for state in scheme.march(problem, steps):
                yield replace(state, multipliers=change(state.multipliers)) if coarse else state

        return replaced(setup, "scheme", marching(march))

    return changed


def off_in_turns(forces: Any) -> Any:
    """Contact forces that are off by a hundredth of the largest one, with alternating signs."""
    return forces + 0.01 * (-1.0) ** np.arange(len(forces)) * forces.max()


def _last_state(scheme: Any, problem: Any, steps: int) -> Iterator[Any]:
    *_, last = scheme.march(problem, steps)
    yield last


def _one_behind(scheme: Any, problem: Any, steps: int) -> Iterator[Any]:
    first, *states = scheme.march(problem, steps)
    yield first
    for before, state in pairwise((first, *states)):
        yield replace(state, u=before.u)


def _without_residual(scheme: Any, problem: Any, steps: int) -> Iterator[Any]:
    return (replace(state, residual=lambda: 0.0) for state in scheme.march(problem, steps))


last_state, one_behind, without_residual = map(marching, (_last_state, _one_behind, _without_residual))
no_viscosity = solving(lambda problem: replace(problem, M=0 * problem.M))
no_elasticity = solving(lambda problem: replace(problem, reference=0 * problem.reference))
swapped = solving(lambda problem: replace(problem, M=problem.reference, reference=problem.M))


def companion_is_the_run(setup: Any) -> Any:
    """The trajectory with k is every other state of the one with k/2, whose distance should show the time share."""

    def march(scheme: Any, problem: Any, steps: int) -> Iterator[Any]:
        halved = steps == setup.steps
        return islice(scheme.march(problem, 2 * steps), 0, None, 2) if halved else scheme.march(problem, steps)

    return replaced(setup, "scheme", marching(march))


def every_other_state(companion: Function) -> Function:
    """Problem 3.2 with half as many steps is every other state of the one with all steps."""
    return lambda experiment: islice(experiment.march(), 1, None, 2)


# Data of an experiment.


def an_eighth(steps: int) -> int:
    """An eighth of the time steps."""
    return max(steps // 8, 1)


def no_contact(problem: Any) -> Any:
    """V^h instead of K^h, without constraints."""
    return replace(problem, N=problem.N[:0], gap=0.0, solver=freed(problem.solver))


def constraint_relaxed(setup: Any) -> Any:
    """v_ν ≤ √h instead of v_ν ≤ 0."""
    return replaced(setup, "problem.solver", shifted_gap(math.sqrt(setup.space.h)))


def nearest_axis(N: Any) -> Any:
    """The nearest axis instead of ν, in the plane."""
    N = N.copy()
    normals = N.data.reshape(-1, 2)
    nearest = np.arange(2) == abs(normals).argmax(axis=1)[:, None]
    N.data = np.where(nearest, np.sign(normals), 0.0).ravel()
    return N


def load_late(setup: Any) -> Any:
    """F(t − k) instead of F(t)."""
    k = setup.problem.T / setup.steps
    return replaced(setup, "problem.load", lambda load: lambda t: load(max(t - k, 0.0)))


def contact_work_times(factor: float) -> Replacement:
    """The work of contact in the load (3.7) is wrong by a factor."""

    def change(setup: Any) -> Any:
        load = other_contact_work(factor)(ErrorNorm)(setup.solution, setup.space).load
        return replaced(setup, "problem.load", instead(load))

    return change


def other_contact_work(factor: float) -> Replacement:
    """A class that measures errors whose work of contact is wrong by a factor."""

    def make(v_norm: type[ErrorNorm]) -> Function:
        def made(*given: Any) -> Any:
            found = v_norm(*given)
            right = found._contact_work
            return overridden(found, _contact_work=lambda *amplitudes: factor * right(*amplitudes))

        return made

    return make


def start_at_the_end(setup: Any) -> Any:
    """u_0^h = Π^h u(T)."""
    return replaced(setup, "problem.u0", instead(setup.v_norm.sample(setup.problem.T).interpolant))


def start_outside(problem: Any) -> Any:
    """u_0^h ∉ K^h."""
    return replace(problem, u0=problem.u0 + 10 * problem.N.T @ np.ones(problem.N.shape[0]))


def start_at_projection(setup: Any) -> Any:
    """u_0^h = P_h u_0, the projection in (·,·)_V, for a homogeneous A."""
    return replaced(setup, "problem.u0", instead(projection(setup, 0.0)))


def clamp_one_cell_short(setup: Any) -> Any:
    """V^h whose functions need not vanish at the first vertex of every piece of Γ1."""
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
    """A fully discrete solution, first order in k ~ h, instead of u^h."""
    return replace(setup, scheme=BACKWARD_EULER, steps=round(1 / setup.space.h))


# How errors are measured.


def _v_norm(setup: Any, **methods: Any) -> Any:
    """The experiment with a new object that measures errors, some of whose methods are other ones."""
    return replace(setup, v_norm=overridden(ErrorNorm(setup.solution, setup.space), **methods))


def norm_of_l2(setup: Any) -> Any:
    """‖v‖_{L²} instead of (A ε(v), ε(v))^½."""
    return _v_norm(setup, distance=_l2_distance(setup))


def _l2_distance(setup: Any) -> Function:
    basis = Basis(setup.space.mesh, ElementTriP1(), intorder=DEGREE)
    exact = setup.solution.at(np.asarray(basis.global_coordinates()))

    def distance(sample: Any, v: Any) -> float:
        computed = np.array([np.asarray(basis.interpolate(component)) for component in setup.space.nodal(v)])
        return float(np.sqrt(np.sum((exact.displacement(sample.time) - computed) ** 2 * basis.dx)))

    return distance


def norm_of_h1(setup: Any) -> Any:
    """(‖v‖² + ‖ε(v)‖²)^½ instead of (A ε(v), ε(v))^½."""
    found, of_values = _v_norm(setup, A=isotropic(0.5, 0, setup.space.dim)), _l2_distance(setup)
    of_strain = found.v_norm.distance
    overridden(found.v_norm, distance=lambda sample, v: math.hypot(of_strain(sample, v), of_values(sample, v)))
    return found


def norm_with_elasticity(setup: Any) -> Any:
    """(G ε(v), ε(v))^½ instead of (A ε(v), ε(v))^½."""
    return _v_norm(setup, A=setup.solution.law.G)


def one_point_quadrature(setup: Any) -> Any:
    """ε(u) at the centres of cells, where the interpolant's strain is nearly exact, instead of all of ε(u)."""
    centres = setup.solution.at(setup.space.mesh.p[:, setup.space.mesh.t].mean(axis=1))
    sample = setup.v_norm.sample
    return _v_norm(setup, sample=lambda t: replace(sample(t), means=centres.strain(t), oscillation=0.0))


def sum_of_roots(setup: Any) -> Any:
    """Σ_T ‖·‖_T instead of (Σ_T ‖·‖_T²)^½, the oscillation spread evenly over the cells."""

    def distance(sample: Any, v: Any) -> float:
        difference = sample.means - setup.space.strain(v)
        local = np.sum(setup.v_norm.A(difference) * difference, axis=0) * setup.space.volumes
        return float(np.sqrt(local + sample.oscillation / len(local)).sum())

    return _v_norm(setup, distance=distance)


def interpolant_off(which: str) -> Replacement:
    """5 Π^h u instead of Π^h u at one node."""

    def change(setup: Any) -> Any:
        def sample(right: Function) -> Function:
            five = lambda found: replace(found, interpolant=5.0 * found.interpolant)  # noqa: E731
            return lambda time: _when(np.isclose(time, _time(which, setup)), five, right(time))

        return replaced(setup, "v_norm.sample", sample)

    return change


def interpolation_error_off(which: str, factor: float) -> Replacement:
    """‖u − Π^h u‖_V is wrong by a factor at one node."""

    def change(setup: Any) -> Any:
        def distance(right: Function) -> Function:
            def measured(sample: Any, v: Any) -> float:
                off = v is sample.interpolant and np.isclose(sample.time, _time(which, setup))
                return float((factor if off else 1.0) * right(sample, v))

            return measured

        return replaced(setup, "v_norm.distance", distance)

    return change


def _time(which: str, setup: Any) -> float:
    """The time of a node of the trajectory that is measured."""
    return float(setup.problem.T * node(which, 2 * setup.steps) / (2 * setup.steps))


def load_off(amount: Callable[[float], float]) -> Replacement:
    """A load that is wrong by a relative amount, a function of t/T, as if its quadrature were coarse."""

    def change(setup: Any) -> Any:
        right, T = setup.v_norm.load, setup.problem.T
        wrong = instead(lambda time: (1 + amount(time / T)) * right(time))
        return replaced(replaced(setup, "problem.load", wrong), "v_norm.load", wrong)

    return change


# Evidence that is too small.


def balance_alone(residual: Function) -> Function:
    """A residual without the sign of the contact forces, complementarity and the gap."""

    def found(step: Any, u: Any, multipliers: Any, b: Any) -> float:
        return float(np.linalg.norm(step.S @ u + step.forces @ multipliers - b) / np.linalg.norm(b))

    return found


def hastily(measure: Function) -> Function:
    """Look at every second time, and at the residual and the time share of the last time only."""

    def found(setup: Any) -> Any:
        right = measure(setup)
        (*_, coarse), (*_, fine) = (setup.scheme.march(setup.problem, steps * setup.steps) for steps in (1, 2))
        drift = float(np.sqrt((coarse.u - fine.u) @ (setup.problem.M @ (coarse.u - fine.u))))
        return replace(right, history=right.history[:, ::2], drift=drift, residual=fine.residual())

    return found


def at_the_last_time(parallelogram: Function) -> Function:
    """The parallelogram law at the last time only."""
    return lambda found: parallelogram(replace(found, history=found.history[:, -1:]))


# Theorem 4.2: both problems on one mesh.


def stress_from_displacement(sides: Any) -> Any:
    """Replace the stress of Problem 3.2 by the stress of Problem 3.1: the agreement is perfect and proves nothing."""
    honest = sides.stresses(sides.displacements)
    return replace(sides, stresses=lambda problem: Derived.compared(honest, problem))


def compared_with_itself(sides: Any) -> Any:
    """The stress that the law gives for the correct Problem 3.1, as if both had been solved."""
    derived = Derived.compared(sides.stresses(sides.displacements), sides.displacements)
    return replace(sides, stresses=lambda problem: derived)


def stresses(change: Function) -> Replacement:
    """Problem 3.2 is changed."""

    def changed(sides: Any) -> Any:
        wrong = change(sides.stresses(sides.displacements))
        return replace(sides, stresses=lambda problem: wrong)

    return changed


def stress_march(change: Callable[[Iterator[Any], int], Iterator[Any]]) -> Replacement:
    """The states of Problem 3.2 are changed; ``change`` is a function of the states and the number of steps."""
    return stresses(lambda right: overridden(copy(right), march=lambda steps: change(right.march(steps), steps)))


def step_times(which: str, **factors: float) -> Replacement:
    """Parts of the state of Problem 3.2 are wrong by factors in one step."""
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


# Theorem 4.2 on its own stress space.


def law_swapped(setup: Any) -> Any:
    """A and G in each other's place in Problem 3.2."""
    law = setup.data.law
    return replaced(setup, "data.law", instead(replace(law, A=law.G, G=law.A)))


def no_surface_load(part: Any, x: Any) -> Function:
    """f_2 = 0, at one time or at several."""
    return lambda time: np.zeros((*x.shape, *np.shape(time)))


def surface_load_late(setup: Any) -> Any:
    """f_2(t − k) instead of f_2(t)."""
    k = setup.data.body.T / setup.steps

    def late(right: Function) -> Function:
        return lambda part, x: lambda time: right(part, x)(np.maximum(time - k, 0.0))

    return replaced(setup, "data.surface_load", late)


def without_viscosity(make: Function) -> Function:
    """Gε(u^h) instead of Aε(δu^h) + Gε(u^h)."""

    def made(primal: Any, *given: Any) -> None:
        make(primal, *given)
        primal.viscous = 0 * primal.viscous

    return made


def companion_off(companion: Function) -> Function:
    """The stress with half as many steps is wrong in one of them."""
    five = lambda state: replaced(state, "stress.values", lambda values: 5 * values)  # noqa: E731
    return lambda setup: (_when(n == 2, five, state) for n, state in enumerate(companion(setup)))


def inadmissible_once(kind: str, call: int) -> Replacement:
    """In one step a stress jumps between cells, misses f_2, is tangential or pulls: by some thousandths of its size."""

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
        return replaced(state, "stress.tractions", instead(tractions))

    def wrong(inadmissible: Function) -> Function:
        calls = count()
        return lambda space, state: inadmissible(space, spoiled(space, state) if next(calls) == call else state)

    return wrong


# Spaces and meshes of other statements.


def space(change: Callable[[Space], dict[str, Any]]) -> Replacement:
    """V^h with other attributes, which ``change`` gives."""
    return result(lambda right: overridden(Space(right.mesh, right.body), **change(right)))


def pinned(right: Space) -> dict[str, Any]:
    """Γ1 shrunk to two of its points."""
    corners = np.array([end for part in right.body.of(Kind.CLAMPED) for end in part.corners.T[:2]])[:2]
    fixed = [_nearest(right, corner) for corner in corners]
    return {"free": np.flatnonzero(np.repeat(~np.isin(np.arange(right.mesh.p.shape[1]), fixed), right.dim))}


def inward(right: Space) -> dict[str, Any]:
    """The normals of Γ3 point inwards."""
    return {"N": -right.N}


def off_contact(right: Space) -> dict[str, Any]:
    """The constraint of a vertex inside the body instead of the last one of Γ3."""
    inside = np.flatnonzero((abs(right.mesh.p - right.mesh.p.mean(axis=1)[:, None]) < 0.2).all(axis=0))[0]
    row = sps.csr_array(([1.0], ([0], [2 * inside + 1])), shape=(1, 2 * right.mesh.p.shape[1]))[:, right.free]
    return {"N": sps.csr_array(sps.vstack([right.N[:-1], row]))}


def ungraded(graded: Function) -> Function:
    """Meshes that are no finer at a corner."""
    return lambda family, body, n: Unstructured()(body, n)


def over_vertices(h1_product: Function) -> Function:
    """Σ v·w over the vertices instead of (v, w)_H, with no measure of what belongs to a vertex."""
    return lambda space: sps.csc_array(h1_product(space) - mass(space) + sps.eye_array(space.dofs))


# Laws.


class Misstated:
    """An operator with the constants of another one."""

    def __init__(self, right: Any, change: Replacement) -> None:
        self.right, self.change = right, change

    def __getattr__(self, name: str) -> Any:
        return getattr(self.right, name)

    def at(self, x: Any) -> Misstated:
        return Misstated(self.right.at(x), self.change)

    def __call__(self, strain: Any) -> Any:
        return self.change(self.right)(strain)


def law(tensor: str, change: Replacement) -> Replacement:
    """Cases whose A or G does something else than it says."""

    def misstated(case: Any) -> Any:
        right = case.solution.law
        parts = {"A": right.A, "G": right.G, tensor: Misstated(getattr(right, tensor), change)}
        return SimpleNamespace(solution=SimpleNamespace(law=SimpleNamespace(**parts)))

    return result(misstated)


def engineering_shear(right: Function) -> Function:
    """Half of the shear where Mandel's vectors have √½ of its double."""

    def operator(strain: Any) -> Any:
        shear = np.ones((len(strain), *[1] * (strain.ndim - 1)))
        shear[-1] = math.sqrt(0.5)
        return shear * right(shear * strain)

    return operator


def returning(radius: float = 1.0, share: float = 1.0) -> Replacement:
    """A law (3.3) for a set of another size, or whose return to K stops before it or goes beyond."""

    class Returning(Yield):
        def __call__(self, strain: Any) -> Any:
            ball: Any = self.convex
            return share * Yield(self.beta, replace(ball, radius=radius * ball.radius))(strain)

    return lambda projection: lambda G, count: projection(Returning(G.beta, G.convex), count)


# Terms and exact solutions.


def without(*names: str) -> Replacement:
    """Terms of R left out."""
    return result(lambda terms: replace(terms, **{name: 0 * getattr(terms, name) for name in names}))


def no_body_force(terms: Any) -> Any:
    """(f_0, v) left out."""
    return replace(terms, body=0 * terms.body)


def no_work_on_loaded(work_on: Function) -> Function:
    """(f_2, v)_{L²(Γ2)} left out."""
    return lambda kind, *given: (0.0 if kind is Kind.LOADED else 1.0) * work_on(kind, *given)


def no_rate(on_cells: Function) -> Function:
    """G ε(u^h) instead of A ε(u̇^h) + G ε(u^h)."""

    def found(*given: Any) -> Any:
        right = on_cells(*given)
        return SimpleNamespace(stress=lambda rate, strain: right.stress(0 * rate, strain))

    return found


def half_a_step_late(discrete_stresses: Function) -> Function:
    """σ^h compared with σ half a step later."""
    return lambda setup: (
        (time + setup.problem.T / setup.steps / 2, stress) for time, stress in discrete_stresses(setup)
    )


def stress_off_at_an_instant(discrete_stresses: Function) -> Function:
    """σ^h is ten times too large at the fifth of the instants."""
    return lambda setup: (
        (time, (10 if n == 4 else 1) * stress) for n, (time, stress) in enumerate(discrete_stresses(setup))
    )


def exact_displacement(change: Function, time: float | None = None) -> Replacement:
    """The exact displacement is changed, at one time alone if a part of T is given."""
    return lambda over_time: lambda trace, solution: over_time(trace, _changed(solution, "displacement", time, change))


def exact_solution(method: str, time: float, change: Function) -> Replacement:
    """Cases whose exact solution is changed at one time, a part of T."""
    return result(lambda case: SimpleNamespace(solution=_changed(case.solution, method, time, change)))


def _changed(solution: Any, method: str, time: float | None, change: Function) -> Any:
    def at(x: Any) -> Any:
        right = getattr(solution.at(x), method)

        def evaluated(*given: Any) -> Any:
            return _when(time is None or np.isclose(given[-1], time * solution.body.T), change, right(*given))

        return SimpleNamespace(**{method: evaluated})

    return SimpleNamespace(body=solution.body, at=at)


def interpolant_late(sample: Function) -> Function:
    """Π^h u of an earlier time."""
    return lambda v_norm, time: replace(sample(v_norm, time), interpolant=sample(v_norm, 0.9 * time).interpolant)


def times_width(right: Function) -> Function:
    """Multiply the value of a method by the extent of the mesh along the first axis."""
    return lambda self, *given: float(np.ptp(self.space.mesh.p[0])) * right(self, *given)


def times_h(power: int) -> Replacement:
    """Errors times a power of h."""
    return lambda right: (
        lambda solution, space, face: {n: e * space.h**power for n, e in right(solution, space, face).items()}
    )


def opposite_work(compare: Function) -> Function:
    """(B(u + d) − B(u), −d)_V, not over ‖d‖_V²."""

    def found(operator: Any, base: Any, step: Any) -> tuple[float, float, Any]:
        quotient, product, image = compare(operator, base, step)
        return quotient, -product * float(step @ (operator.problem.M @ step)), image

    return found


def random_only(quotients: Function) -> Function:
    """The first pairs alone, which are random: nothing is looked for."""
    return lambda *given: islice(quotients(*given), 10)


def cut_off(projected: Function) -> Function:
    """Project on K^h in the Euclidean norm of nodal values instead of ‖·‖_V: positive v_ν become 0."""

    def found(problem: Any, u: Any) -> Any:
        N = problem.N
        return u - N.T @ np.linalg.solve((N @ N.T).toarray(), np.maximum(N @ u, 0.0))

    return found


def law_alone(pair: Any) -> Any:
    """σ^h = Cε(u^h), which balances nothing."""
    return lambda *given: overridden(pair(*given), bound=0.0, distance=0.0)


def rival(name: str, solver: Any) -> Replacement:
    """Another solver in the place of one of the rivals."""
    return lambda rivals: {**rivals, name: solver}


def same_problem(name: str) -> Replacement:
    """The problem itself in the place of one of its rivals."""
    return lambda rivals: lambda problem: {**rivals(problem), name: problem}


def rival_stress_off(stresses: Function) -> Function:
    """A stress that is off by a thousandth in one step, by all solvers but the usual one."""
    return lambda setup: [
        (1.001 if n == 6 and setup.solver is not Signorini else 1.0) * stress
        for n, stress in enumerate(stresses(setup))
    ]


def unweighted(facet_rule: Function) -> Function:
    """Sums over points of quadrature with no measure of what belongs to them."""
    return result(lambda rule: replace(rule, weights=1 + 0 * rule.weights))(facet_rule)  # type: ignore[no-any-return]


def body_load_off(right: Function) -> Function:
    """A load by the coarse rule that is wrong at one time."""

    def load(solution: Any, space: Any, time: float, degree: int) -> Any:
        off = degree < 3 and np.isclose(time, 0.375 * solution.body.T)
        return (1.1 if off else 1.0) * right(solution, space, time, degree)

    return load


def known_error(call: int, factor: float) -> Replacement:
    """The known error is wrong by a factor at one of the times."""
    return result(lambda error: in_one_call(call, lambda value: factor * value)(error))


def larger(*names: str) -> Function:
    """Squares of norms at one instant that are far too large."""
    return lambda course: _times_parts(course, dict.fromkeys(names, 1e6))


def load_of_before(euler: Function) -> Function:
    """Backward Euler with the load of an eighth of T before, whatever the step."""
    return lambda problem, times: euler(
        replace(problem, load=lambda t: problem.load(max(t - problem.T / 8, 0.0))), times
    )


def norm_of_nodal_values(furthest: Function) -> Function:
    """The largest Euclidean norm of differences of nodal values, instead of the norm of V."""
    return lambda problem, one, other: float(np.linalg.norm(one - other, axis=1).max())


def constant_halved(bounds: Function) -> Function:
    """Error bounds of backward Euler with half of the Lipschitz constant κ."""
    return lambda flow, kappa, growth: bounds(flow, kappa / 2, growth)


def always_steps(most: int) -> Replacement:
    """Trajectories with half as many steps are every second state of the one with ``most`` steps."""
    return lambda path: (
        lambda problem, scheme, steps: (
            path(problem, scheme, most)[::2] if 2 * steps == most else path(problem, scheme, steps)
        )
    )


def near_vertices(spikes: Function) -> Function:
    """A field near the vertices of a grid, at an eighth of the radius of its narrowest spikes."""
    return lambda x, last: spikes(x + 4.0**-last / 8, last)
