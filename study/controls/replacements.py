"""The functions that make deliberate defects; ``study.controls.table`` lists the defects that use them.

Each defect replaces one object of the study by a wrong one. The object is a function, a solver or a number. A
replacement is a function that takes the correct object and returns the wrong one. Some functions in this file are
replacements themselves. Others take parameters, such as a factor, and return a replacement.

A docstring "Deliberate defect: ..." describes the study after the replacement.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from copy import copy
from dataclasses import dataclass, replace
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
    """Return a replacement that ignores the correct object and returns ``other``."""
    return lambda right: other


def returns(value: Any) -> Replacement:
    """Deliberate defect: a function returns ``value``, whatever its arguments are."""
    return lambda right: lambda *given, **options: value


def result(change: Function) -> Replacement:
    """Deliberate defect: a function returns its correct result after ``change`` was applied to it."""
    return lambda right: lambda *given, **options: change(right(*given, **options))


def times(factor: float) -> Replacement:
    """Deliberate defect: the result of a function is multiplied by ``factor``."""
    return result(lambda value: factor * value)


def column_times(column: str, factor: float) -> Replacement:
    """Deliberate defect: one number in the table row that a function returns is multiplied by ``factor``."""
    return result(lambda row: {**row, column: factor * row[column]})


def zeroed(*quantities: str) -> Replacement:
    """Deliberate defect: a measurement, which returns quantities by name, returns 0 for the given names."""
    return result(lambda found: {**found, **dict.fromkeys(quantities, 0.0)})


def arguments(change: Function) -> Replacement:
    """Deliberate defect: a function is called with other arguments; ``change`` returns them, given the correct ones."""
    return lambda right: lambda *given: right(*change(*given))


def items(change: Function) -> Replacement:
    """Deliberate defect: the items that a function of an experiment returns are changed.

    Args:
        change: function that returns the wrong item, given its number, the correct item and the experiment.
    """
    return lambda right: lambda setup: (change(n, item, setup) for n, item in enumerate(right(setup)))


def depending(place: str, wrong: Callable[[Any], Replacement]) -> Replacement:
    """Deliberate defect: one attribute of an experiment is replaced in a way that depends on the experiment.

    Args:
        place: name of the attribute, as in ``study.controls.control.replaced``.
        wrong: function that returns the replacement of the attribute, given the experiment.
    """
    return lambda setup: replaced(setup, place, wrong(setup))


def where(defective: Callable[..., Any], wrong: Replacement) -> Replacement:
    """Deliberate defect: a function is replaced in the calls whose arguments satisfy a condition.

    Args:
        defective: function of the arguments of a call, which tells whether the call is wrong.
        wrong: replacement of the function.
    """

    def change(right: Function) -> Function:
        other = wrong(right)
        return lambda *given: (other if defective(*given) else right)(*given)

    return change


def in_calls(wrong: Replacement, *calls: int) -> Replacement:
    """Deliberate defect: a function is replaced in some of its calls.

    Args:
        wrong: replacement of the function.
        calls: numbers of the wrong calls, counted from 0.
    """

    def change(right: Function) -> Function:
        numbers = count()
        return where(lambda *given: next(numbers) in calls, wrong)(right)  # type: ignore[no-any-return]

    return change


def at_time(time: float, change: Function) -> Replacement:
    """Deliberate defect: a method that is called with a time returns a changed result at one time.

    Args:
        time: the time at which the result is changed.
        change: function that returns the wrong result, given the correct one.
    """
    return where(lambda of, now, *given: np.isclose(now, time), result(change))


def row_times(calls: tuple[int, ...], row: int, factor: float) -> Replacement:
    """Deliberate defect: displacements that a function returns for all times are multiplied by a factor at one time.

    Args:
        calls: numbers of the calls of the function that have this defect, counted from 0; () for all calls.
        row: index of the time.
        factor: the factor.
    """
    in_row = result(lambda values: values * np.where(np.arange(len(values)) == row, factor, 1.0)[:, None])
    return in_calls(in_row, *calls) if calls else in_row


def scaled(**factors: float) -> Function:
    """Return a function that multiplies attributes of a dataclass by factors: name of an attribute ↦ its factor."""
    return lambda whole: replace(whole, **{name: factor * getattr(whole, name) for name, factor in factors.items()})


def late(right: Function, delay: float) -> Function:
    """Return a function of time with the correct value at t − delay for the time t, or at 0 if this is negative."""
    return lambda time: right(np.maximum(time - delay, 0.0))


energy = result(lambda norm: norm**2 / 2)
squared = result(lambda value: value**2)
squared_each = result(lambda errors: {name: error**2 for name, error in errors.items()})


# Wrong contact solvers. A contact solver is made from the stiffness matrix S, the matrix N of normals and, for some
# solvers, the coordinates of the unknowns. It is a function that returns the displacement u and the contact forces for
# a right-hand side b.


def contact(rule: Callable[[Signorini, Any], Any]) -> Replacement:
    """Deliberate defect: the contact solver computes the contact forces by another rule.

    Args:
        rule: function that returns the contact forces. Its arguments are the solver and the gaps that would exist
            without contact forces.
    """
    solver = type("WrongSolver", (Signorini,), {"complementarity": rule})
    return replaced_by(lambda S, N, *points: solver(S, N))


def solution(change: Callable[[Signorini, Any], Any]) -> Replacement:
    """Deliberate defect: the contact solver returns another displacement and other contact forces.

    Args:
        change: function that returns both, given the correct solver and the right-hand side b.
    """
    return replaced_by(lambda S, N, *points: partial(change, Signorini(S, N)))


def shifted_gap(by: float) -> Replacement:
    """Deliberate defect: normal displacements on the contact boundary may be up to ``by`` instead of up to 0."""
    return contact(lambda solver, gap: Signorini.complementarity(solver, gap - by))


def forces_times(factor: float) -> Replacement:
    """Deliberate defect: the contact forces are multiplied by ``factor``; the displacement is correct."""
    return result(result(lambda found: (found[0], factor * found[1])))


held = contact(lambda solver, gap: solver.multipliers_on(np.ones_like(solver.active), gap))
one_iteration = contact(lambda solver, gap: solver.multipliers_on(gap > 0, gap))
freed = solution(lambda solver, b: (solver.factor(b), np.zeros(solver.N.shape[0])))
no_multipliers = solution(lambda solver, b: (solver.factor(b), np.zeros(0)))


def in_places(right: Any) -> Any:
    """Deliberate defect: contact is only imposed at every other vertex of the contact boundary."""

    def solver(S: Any, N: Any, *points: Any, gap: Any = 0.0) -> Any:
        chosen = sps.eye_array(N.shape[0], format="csr")[::2]
        kept = chosen @ np.broadcast_to(gap, N.shape[0])
        return result(lambda found: (found[0], chosen.T @ found[1]))(Signorini(S, chosen @ N, gap=kept))

    return solver


springs = replaced_by(lambda S, N: freed(Signorini)(sps.csc_array(S + 100.0 / N.shape[0] * (N.T @ N)), N))
"""Deliberate defect: the foundation consists of elastic springs instead of being rigid.

The springs have a fixed stiffness. They pull the body back where it leaves the foundation.
"""


class RandomSearch(Signorini):
    """Deliberate defect: the contact solver starts from a random active set and stops after its first iteration."""

    def __init__(self, S: sps.csc_array, N: sps.csr_array, *points: Any) -> None:
        super().__init__(S, N)
        self.rng = np.random.default_rng(0)

    def complementarity(self, gap: Any) -> Any:
        return self.multipliers_on((gap > 0) | (self.rng.uniform(size=len(gap)) < 0.5), gap)


def in_one_step(wrong: Replacement, which: str, part: float) -> Replacement:
    """Deliberate defect: in one time step the contact problem is solved by a wrong solver.

    Args:
        wrong: replacement that makes the wrong solver from the correct one.
        which: "first", "odd", "even" or "last", as for ``node``.
        part: the step is chosen among this fraction of all time steps of the experiment, from the first step on.
    """

    def solver(setup: Any) -> Replacement:
        call = node(which, int(part * setup.steps)) - 1
        return replaced_by(lambda S, N, *points: in_calls(replaced_by(wrong(Signorini)(S, N)), call)(Signorini(S, N)))

    return depending("problem.solver", solver)


# Time schemes that return wrong solutions.


def node(which: str, last: int) -> int:
    """Return the number of a time node.

    Args:
        which: "first" for node 1, "last" for the last node, "odd" or "even" for a node near the middle whose number is
            odd or even.
        last: number of the last node.
    """
    return {"first": 1, "odd": last // 2 | 1, "even": (last // 2 + 2) // 2 * 2, "last": last}[which]


def each_state(change: Function) -> Replacement:
    """Deliberate defect: all states that a function such as ``Tableau.march`` computes are changed by ``change``."""
    return result(partial(map, change))


def at_node(which: str, change: Function) -> Replacement:
    """Deliberate defect: the state at one time node is changed by ``change``.

    The replacement concerns a function whose last argument is the number of time steps, such as ``Tableau.march``.

    Args:
        which: "first", "odd", "even" or "last", as for ``node``.
        change: function that returns the wrong state, given the correct one.
    """
    return lambda march: (
        lambda *given: (
            change(state) if n == node(which, given[-1]) else state for n, state in enumerate(march(*given))
        )
    )


def marching(defective: Callable[[Any, Any, int], bool], wrong: Replacement) -> Replacement:
    """Deliberate defect: the time scheme of an experiment returns wrong states in some of its computations.

    Args:
        defective: function that tells whether a computation is wrong. Its arguments are the experiment, the problem
            that is solved and the number of time steps.
        wrong: replacement of ``Tableau.march``.
    """
    return depending("scheme.march", lambda setup: where(partial(defective, setup), wrong))


def solving(alter: Callable[[SemiDiscrete], SemiDiscrete]) -> Replacement:
    """Deliberate defect: the time scheme solves another problem than the one whose exact solution is known.

    Args:
        alter: function that returns the other problem, given the correct one.
    """
    return arguments(lambda problem, steps: (alter(problem), steps))


def state_off(which: str, halvings: int, **factors: float) -> Replacement:
    """Deliberate defect: parts of the computed state at one time node are multiplied by factors.

    Args:
        which: "first", "odd", "even" or "last", as for ``node``.
        halvings: the experiment also computes with shorter or longer time steps. Only the computation in which its time
            step is halved this many times has the defect.
        factors: name of an attribute of the state ↦ its factor.
    """
    return marching(lambda setup, _, steps: steps == int(setup.steps * 2**halvings), at_node(which, scaled(**factors)))


def rival_off(which: str) -> Replacement:
    """Deliberate defect: at one time node, solutions by other methods (for comparison) are wrong by a thousandth.

    Args:
        which: "first", "odd", "even" or "last", as for ``node``.
    """
    return marching(lambda setup, problem, _: problem is not setup.problem, at_node(which, scaled(u=1.001)))


def displacement_off(which: str, right_first: int) -> Replacement:
    """Deliberate defect: the time scheme returns ten times the displacement at one time node.

    Args:
        which: "first", "odd", "even" or "last", as for ``node``.
        right_first: number of first calls of the scheme that have no defect.
    """
    wrong = at_node(which, scaled(u=10.0))
    march: Replacement = lambda right: in_calls(replaced_by(right), *range(right_first))(wrong(right))  # noqa: E731
    return lambda scheme: replaced(scheme, "march", march)


def coarse_forces(change: Callable[[Any], Any]) -> Replacement:
    """Deliberate defect: the contact forces are changed in the computation with half as many time steps.

    Args:
        change: function that returns the wrong contact forces, given the correct ones.
    """
    return marching(
        lambda setup, _, steps: steps < setup.steps,
        each_state(lambda state: replace(state, multipliers=change(state.multipliers))),
    )


def off_in_turns(forces: Any) -> Any:
    """Return contact forces with an added error: a hundredth of the largest force, with alternating signs."""
    return forces + 0.01 * (-1.0) ** np.arange(len(forces)) * forces.max()


def one_step_behind(states: Iterator[Any]) -> Iterator[Any]:
    """Return states, each with the displacement of the state before; the first state is unchanged."""
    first, *others = states
    return iter([first, *(replace(state, u=before.u) for before, state in pairwise((first, *others)))])


last_state = result(lambda states: iter([*states][-1:]))
one_behind = result(one_step_behind)
without_residual = each_state(lambda state: replace(state, residual=lambda: 0.0))
no_viscosity = solving(lambda problem: replace(problem, M=0 * problem.M))
no_elasticity = solving(lambda problem: replace(problem, reference=0 * problem.reference))
swapped = solving(lambda problem: replace(problem, M=problem.reference, reference=problem.M))


companion_is_the_run = marching(
    lambda setup, _, steps: steps == setup.steps,
    lambda march: lambda problem, steps: islice(march(problem, 2 * steps), 0, None, 2),
)
"""Deliberate defect: the solution with time step k is copied from the solution with time step k/2.

The error of the time discretisation is estimated by the difference of the two solutions, which is now 0.
"""


every_other_state = replaced_by(lambda experiment: islice(experiment.march(), 1, None, 2))
"""Deliberate defect: the stress solution with half as many time steps is copied from the one with all time steps.

The error of the time discretisation is estimated by their difference, which is now 0.
"""


# Defects of the data of an experiment.


def an_eighth(steps: int) -> int:
    """Return an eighth of a number of time steps, but at least one step."""
    return max(steps // 8, 1)


def no_contact(problem: Any) -> Any:
    """Deliberate defect: the problem has no contact constraint, so the body may enter the foundation."""
    return replace(problem, N=problem.N[:0], gap=0.0, solver=freed(problem.solver))


constraint_relaxed = depending("problem.solver", lambda setup: shifted_gap(math.sqrt(setup.space.h)))
"""Deliberate defect: the body may enter the foundation by √h, where h is the mesh size."""


def nearest_axis(N: Any) -> Any:
    """Deliberate defect: normals of a plane contact boundary are replaced by the nearest coordinate axis."""
    N = N.copy()
    normals = N.data.reshape(-1, 2)
    nearest = np.arange(2) == abs(normals).argmax(axis=1)[:, None]
    N.data = np.where(nearest, np.sign(normals), 0.0).ravel()
    return N


load_late = depending("problem.load", lambda setup: partial(late, delay=setup.problem.T / setup.steps))
"""Deliberate defect: the load at time t is the load of the time step before, at t − k."""


def contact_work_times(factor: float) -> Replacement:
    """Deliberate defect: one term of the load, the work of the contact pressure, is multiplied by ``factor``.

    The load of a case follows from its exact solution, and this term is part of it. Errors are measured correctly.
    """
    v_norm = other_contact_work(factor)(ErrorNorm)
    return depending("problem.load", lambda setup: replaced_by(v_norm(setup.solution, setup.space).load))


def other_contact_work(factor: float) -> Replacement:
    """Deliberate defect: wherever a load is computed, the work of the contact pressure is multiplied by ``factor``.

    The replacement concerns the class ``ErrorNorm``, which measures errors and also computes loads.
    """
    return result(lambda v_norm: overridden(v_norm, _contact_work=times(factor)(v_norm._contact_work)))


start_at_the_end = depending("problem.u0", lambda setup: replaced_by(setup.v_norm.sample(setup.problem.T).interpolant))
"""Deliberate defect: the computation starts from the displacement at the final time instead of the initial one."""


start_outside = depending("u0", lambda problem: lambda u0: u0 + 10 * problem.N.T @ np.ones(problem.N.shape[0]))
"""Deliberate defect: the initial displacement moves parts of the contact boundary into the foundation."""


start_at_projection = depending("problem.u0", lambda setup: replaced_by(projection(setup, 0.0)))
"""Deliberate defect: the computation starts from the best approximation of the initial displacement.

The correct start is the interpolant. The best approximation is the projection in the energy norm, for a viscosity that
is constant in space.
"""


def clamp_one_cell_short(setup: Any) -> Any:
    """Deliberate defect: one end vertex of each clamped part of the boundary is free."""
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
    """Deliberate defect: backward Euler with a time step as large as the mesh size computes the solution.

    The correct solution has a negligible error in time. This one has an error of first order in time and in space.
    """
    return replace(setup, scheme=BACKWARD_EULER, steps=round(1 / setup.space.h))


# Defects of the measurement of errors.


def _l2_distance(setup: Any) -> Function:
    basis = Basis(setup.space.mesh, ElementTriP1(), intorder=DEGREE)
    exact = setup.solution.at(np.asarray(basis.global_coordinates()))

    def distance(sample: Any, v: Any) -> float:
        computed = np.array([np.asarray(basis.interpolate(component)) for component in setup.space.nodal(v)])
        return float(np.sqrt(np.sum((exact.displacement(sample.time) - computed) ** 2 * basis.dx)))

    return distance


norm_of_l2 = depending("v_norm.distance", lambda setup: replaced_by(_l2_distance(setup)))
"""Deliberate defect: errors are measured in the norm of L² instead of the energy norm."""


def norm_of_h1(setup: Any) -> Any:
    """Deliberate defect: errors are measured in the norm (‖v‖² + ‖ε(v)‖²)^½ instead of the energy norm."""
    of_values = _l2_distance(setup)
    of_strain = replaced(setup, "v_norm.A", replaced_by(isotropic(0.5, 0, setup.space.dim)))
    both: Replacement = lambda right: lambda sample, v: math.hypot(right(sample, v), of_values(sample, v))  # noqa: E731
    return replaced(of_strain, "v_norm.distance", both)


norm_with_elasticity = depending("v_norm.A", lambda setup: replaced_by(setup.solution.law.G))
"""Deliberate defect: the energy norm is computed with the elasticity tensor instead of the viscosity tensor."""


def one_point_quadrature(setup: Any) -> Any:
    """Deliberate defect: errors of the strain are measured at the centres of cells only.

    There the strain of the interpolant is nearly exact, so errors appear too small.
    """
    centres = setup.solution.at(setup.space.mesh.p[:, setup.space.mesh.t].mean(axis=1))
    at_centres = result(lambda found: replace(found, means=centres.strain(found.time), oscillation=0.0))
    return replaced(setup, "v_norm.sample", at_centres)


def sum_of_roots(setup: Any) -> Any:
    """Deliberate defect: the norm of an error is the sum over all cells of the norms on the cells.

    The correct norm is the square root of the sum of squares. The part of the error that is only known for the whole
    mesh is divided evenly among the cells.
    """

    def distance(sample: Any, v: Any) -> float:
        difference = sample.means - setup.space.strain(v)
        local = np.sum(setup.v_norm.A(difference) * difference, axis=0) * setup.space.volumes
        return float(np.sqrt(local + sample.oscillation / len(local)).sum())

    return replaced(setup, "v_norm.distance", replaced_by(distance))


def interpolant_off(which: str) -> Replacement:
    """Deliberate defect: the interpolant of the exact solution is multiplied by 5 at one time node.

    Args:
        which: "first", "odd", "even" or "last", as for ``node``.
    """
    return depending(
        "v_norm.sample",
        lambda setup: where(lambda time: np.isclose(time, _time(which, setup)), result(scaled(interpolant=5.0))),
    )


def interpolation_error_off(which: str, factor: float) -> Replacement:
    """Deliberate defect: the interpolation error is multiplied by a factor at one time node.

    Args:
        which: "first", "odd", "even" or "last", as for ``node``.
        factor: the factor.
    """

    def defective(setup: Any, sample: Any, v: Any) -> bool:
        return v is sample.interpolant and bool(np.isclose(sample.time, _time(which, setup)))

    return depending("v_norm.distance", lambda setup: where(partial(defective, setup), times(factor)))


def _time(which: str, setup: Any) -> float:
    """Return the time of one of the nodes at which errors are measured; ``which`` is described in ``node``."""
    return float(setup.problem.T * node(which, 2 * setup.steps) / (2 * setup.steps))


def load_off(amount: Callable[[float], float]) -> Replacement:
    """Deliberate defect: the load has a relative error, as if it were integrated too coarsely.

    Args:
        amount: the relative error as a function of t/T, where T is the final time.
    """

    def change(setup: Any) -> Any:
        right, T = setup.v_norm.load, setup.problem.T
        wrong = replaced_by(lambda time: (1 + amount(time / T)) * right(time))
        return replaced(replaced(setup, "problem.load", wrong), "v_norm.load", wrong)

    return change


# Defects that make diagnostics, such as a residual, too small.


balance_alone = replaced_by(
    lambda step, u, multipliers, b: float(
        np.linalg.norm(step.S @ u + step.forces @ multipliers - b) / np.linalg.norm(b)
    )
)
"""Deliberate defect: the residual of a contact problem only tests the balance of forces.

It ignores whether contact forces press or pull, whether they act only where the gap is closed, and whether the gap
is negative.
"""


def every_second_time(measure: Function) -> Function:
    """Deliberate defect: diagnostics skip times.

    Errors are measured at every second time only. The residual of the contact problems and the estimated error of the
    time discretisation are measured at the last time only.
    """

    def found(setup: Any) -> Any:
        right = measure(setup)
        (*_, coarse), (*_, fine) = (setup.scheme.march(setup.problem, steps * setup.steps) for steps in (1, 2))
        drift = float(np.sqrt((coarse.u - fine.u) @ (setup.problem.M @ (coarse.u - fine.u))))
        return replace(right, history=right.history[:, ::2], drift=drift, residual=fine.residual())

    return found


at_the_last_time = arguments(lambda found: (replace(found, history=found.history[:, -1:]),))
"""Deliberate defect: the parallelogram law, which tests computed norms, is tested at the last time only."""


# Defects of the comparison of the displacement formulation with the stress formulation on the same mesh.


def stresses(change: Function) -> Replacement:
    """Deliberate defect: the stress formulation of the contact problem is changed.

    Args:
        change: function that returns the wrong problem, given the correct one.
    """
    return depending("stresses", lambda sides: returns(change(sides.stresses(sides.displacements))))


stress_from_displacement = depending(
    "stresses", lambda sides: replaced_by(partial(Derived.compared, sides.stresses(sides.displacements)))
)
"""Deliberate defect: the stress of the displacement formulation replaces the stress of the stress formulation.

The two stresses then agree perfectly, which proves nothing.
"""


compared_with_itself = depending(
    "stresses",
    lambda sides: returns(Derived.compared(sides.stresses(sides.displacements), sides.displacements)),
)
"""Deliberate defect: the displacement and the stress formulation are both given the same stress.

This stress follows from the computed displacement by the material law.
"""


def step_times(which: str, **factors: float) -> Replacement:
    """Deliberate defect: in one time step, parts of the solution of the stress formulation are multiplied by factors.

    Args:
        which: "first", "odd", "even" or "last", as for ``node``.
        factors: name of a part, such as ``stress`` ↦ its factor.
    """
    return stresses(lambda right: replaced(right, "march", at_node(which, scaled(**factors))))


stress_gaps = stresses(lambda problem: replace(problem, N=problem.N[::2]))
displacement_late = stresses(lambda right: replaced(right, "march", one_behind))
stress_load_late = stresses(lambda right: replaced(right, "load", partial(late, delay=right.space.body.T / 8)))


# Defects of the stress formulation when it is solved without displacements, on a stress space of equilibrium elements.


law_swapped = depending("data.law", lambda setup: lambda law: replace(law, A=law.G, G=law.A))
"""Deliberate defect: the viscosity and the elasticity tensor are swapped in the stress formulation."""


surface_load_late = depending(
    "data.surface_load",
    lambda setup: lambda right: lambda part, x: late(right(part, x), setup.data.body.T / setup.steps),
)
"""Deliberate defect: the traction at time t is the traction of the time step before, at t − k."""


def without_viscosity(velocities: Function) -> Function:
    """Deliberate defect: the stress of a computed displacement lacks its viscous part, because its velocity is 0."""
    return lambda *given: ((state, 0 * velocity) for state, velocity in velocities(*given))


companion_off = items(
    lambda n, state, _: replaced(state, "stress.values", lambda stress: (5 if n == 2 else 1) * stress)
)
"""Deliberate defect: in the computation with half as many time steps, one stress is five times too large."""


def inadmissible_once(kind: str, call: int) -> Replacement:
    """Deliberate defect: in one time step a stress slightly violates an equilibrium or contact condition.

    Args:
        kind: the violated condition. "jumps": the stress jumps between two cells. "misses f_2": it differs from the
            given traction. "tangential": it has friction on the contact boundary. "pulls": it pulls there.
        call: number of the time step. The violation is this number of thousandths of the largest traction.
    """

    def spoiled(space: Any, state: Any) -> tuple[Any, Any]:
        tractions = state.stress.tractions.copy()
        where = {"misses f_2": Kind.LOADED, "tangential": Kind.CONTACT, "pulls": Kind.CONTACT}
        on = np.flatnonzero(space.mesh.f2t[1] >= 0) if kind == "jumps" else space.on(where[kind])[0][1]
        cell, side = np.argwhere(space.edges == on[len(on) // 2])[0]
        little = 1e-3 * call * abs(tractions).max()
        if kind == "pulls":
            tractions[cell, side, :, 0] = little
        else:
            tractions[cell, side, :, 1] += little
        return space, replaced(state, "stress.tractions", replaced_by(tractions))

    return in_calls(arguments(spoiled), call)


# Defects of finite-element spaces and meshes.


def space(change: Callable[[Space], dict[str, Any]]) -> Replacement:
    """Deliberate defect: the finite-element space has other attributes.

    Args:
        change: function that returns the names and values of the new attributes, given the correct space.
    """
    return result(lambda right: overridden(Space(right.mesh, right.body), **change(right)))


def pinned(right: Space) -> dict[str, Any]:
    """Return the attributes of a space whose clamped boundary is reduced to two points."""
    corners = np.array([end for part in right.body.of(Kind.CLAMPED) for end in part.corners.T[:2]])[:2]
    fixed = [_nearest(right, corner) for corner in corners]
    return {"free": np.flatnonzero(np.repeat(~np.isin(np.arange(right.mesh.p.shape[1]), fixed), right.dim))}


inward = space(lambda right: {"N": -right.N})
"""Deliberate defect: normals on the contact boundary point into the body."""


def off_contact(right: Space) -> dict[str, Any]:
    """Return the attributes of a space with one contact constraint moved from the boundary into the body."""
    inside = np.flatnonzero((abs(right.mesh.p - right.mesh.p.mean(axis=1)[:, None]) < 0.2).all(axis=0))[0]
    row = sps.csr_array(([1.0], ([0], [2 * inside + 1])), shape=(1, 2 * right.mesh.p.shape[1]))[:, right.free]
    return {"N": sps.csr_array(sps.vstack([right.N[:-1], row]))}


ungraded = replaced_by(lambda family, body, n: Unstructured()(body, n))
"""Deliberate defect: meshes that should be finer at a corner are not."""


def over_vertices(h1_product: Function) -> Function:
    """Deliberate defect: the inner product of L² is the sum of v·w over the vertices, without areas as weights."""
    return lambda space: sps.csc_array(h1_product(space) - mass(space) + sps.eye_array(space.dofs))


# Defects of material laws.


@dataclass(frozen=True)
class Misstated:
    """A changed operator of a material law that still states the constants of the correct operator.

    Such constants are for example the ellipticity constant and the Lipschitz constant.
    """

    right: Any
    change: Replacement

    def __getattr__(self, name: str) -> Any:
        return getattr(self.right, name)

    def at(self, x: Any) -> Misstated:
        return Misstated(self.right.at(x), self.change)

    def __call__(self, strain: Any) -> Any:
        return self.change(self.right)(strain)


def law(tensor: str, change: Replacement) -> Replacement:
    """Deliberate defect: one operator of a material law is changed, but not its stated constants.

    Args:
        tensor: "A" for the viscosity, "G" for the elasticity.
        change: replacement of the operator.
    """

    def misstated(case: Any) -> Any:
        right = case.solution.law
        wrong = overridden(copy(right), **{tensor: Misstated(getattr(right, tensor), change)})
        return SimpleNamespace(solution=SimpleNamespace(law=wrong))

    return result(misstated)


def engineering_shear(right: Function) -> Function:
    """Deliberate defect: the shear component of strains and stresses lacks the factor √2.

    Mandel's notation, in which symmetric tensors are vectors with the same inner product, needs this factor.
    """

    def operator(strain: Any) -> Any:
        shear = np.ones((len(strain), *[1] * (strain.ndim - 1)))
        shear[-1] = math.sqrt(0.5)
        return shear * right(shear * strain)

    return operator


def returning(radius: float = 1.0, share: float = 1.0) -> Replacement:
    """Deliberate defect: a material law with yield, which projects strains onto a ball, uses another ball or factor.

    Args:
        radius: factor of the radius of the ball.
        share: factor of the resulting stress.
    """

    def changed(G: Yield, count: int) -> tuple[Any, int]:
        ball: Any = G.convex
        other = Yield(G.beta, replace(ball, radius=radius * ball.radius))
        return Misstated(G, replaced_by(times(share)(other))), count

    return arguments(changed)


# Defects of terms of an estimate, of exact solutions, and of solvers that are compared.


def without(*names: str) -> Replacement:
    """Deliberate defect: terms of the residual functional are left out.

    Args:
        names: names of the terms.
    """
    return result(lambda terms: replace(terms, **{name: 0 * getattr(terms, name) for name in names}))


no_work_on_loaded = where(lambda kind, *given: kind is Kind.LOADED, times(0.0))
"""Deliberate defect: the work of the tractions on the loaded boundary is left out."""


no_rate = result(lambda cells: SimpleNamespace(stress=arguments(lambda rate, strain: (0 * rate, strain))(cells.stress)))
"""Deliberate defect: computed stresses lack the viscous part, which depends on the strain rate."""


half_a_step_late = items(lambda n, pair, setup: (pair[0] + setup.problem.T / setup.steps / 2, pair[1]))
"""Deliberate defect: computed stresses are compared with exact ones half a time step later."""


stress_off_at_an_instant = items(lambda n, pair, _: (pair[0], (10 if n == 4 else 1) * pair[1]))
"""Deliberate defect: the computed stress is ten times too large at the fifth of the times."""


def exact_displacement(change: Function, time: float | None = None) -> Replacement:
    """Deliberate defect: the exact displacement is changed.

    Args:
        change: function that returns the wrong displacement, given the correct one.
        time: the time at which it is changed, relative to the final time; None for all times.
    """
    return arguments(lambda trace, solution: (trace, _changed(solution, "displacement", change, time)))


def exact_solution(method: str, time: float, change: Function) -> Replacement:
    """Deliberate defect: one field of the exact solution of every case is changed at one time.

    Args:
        method: name of the field.
        time: the time, relative to the final time.
        change: function that returns the wrong field, given the correct one.
    """
    return result(lambda case: SimpleNamespace(solution=_changed(case.solution, method, change, time)))


def _changed(solution: Any, method: str, change: Function, time: float | None) -> Any:
    now = lambda *given: time is None or np.isclose(given[-1], time * solution.body.T)  # noqa: E731
    field = where(now, result(change))
    return overridden(copy(solution), at=lambda x: SimpleNamespace(**{method: field(getattr(solution.at(x), method))}))


def interpolant_late(sample: Function) -> Function:
    """Deliberate defect: the interpolant at time t interpolates the exact displacement at time 0.9 t."""
    return lambda v_norm, time: replace(sample(v_norm, time), interpolant=sample(v_norm, 0.9 * time).interpolant)


def times_width(right: Function) -> Function:
    """Deliberate defect: a result is multiplied by the width of the mesh along the first axis."""
    return lambda self, *given: float(np.ptp(self.space.mesh.p[0])) * right(self, *given)


def times_h(power: int) -> Replacement:
    """Deliberate defect: interpolation errors on the contact boundary are multiplied by a power of the mesh size h."""
    return lambda right: (
        lambda solution, space, face: {n: e * space.h**power for n, e in right(solution, space, face).items()}
    )


def opposite_work(compare: Function) -> Function:
    """Deliberate defect: the quotient that shows whether an operator is monotone has the wrong sign and no denominator.

    The correct quotient of an operator B is (B(u + d) − B(u), d) / ‖d‖² for a displacement u and a step d.
    """

    def found(problem: Any, riesz: Any, base: Any, step: Any) -> tuple[float, float, Any]:
        quotient, product, image = compare(problem, riesz, base, step)
        return quotient, -product * float(step @ (problem.M @ step)), image

    return found


random_only = result(lambda quotients: islice(quotients, 10))
"""Deliberate defect: a largest quotient is searched among random pairs only.

The correct search continues from these pairs to the worst pair.
"""


cut_off = replaced_by(
    lambda problem, u: (
        u - problem.N.T @ np.linalg.solve((problem.N @ problem.N.T).toarray(), np.maximum(problem.N @ u, 0.0))
    )
)
"""Deliberate defect: the projection onto the admissible displacements does not minimise the energy norm.

Instead, it sets positive normal displacements at vertices of the contact boundary to 0.
"""


law_alone = result(lambda pair: overridden(pair, bound=0.0, distance=0.0))
"""Deliberate defect: the computed stress follows from the displacement by the material law alone.

This stress does not balance the loads, as it must in the tested identity.
"""


def rival(name: str, solver: Any) -> Replacement:
    """Deliberate defect: one of the solvers with which results are compared is replaced.

    Args:
        name: name of this solver.
        solver: the solver that replaces it.
    """
    return lambda rivals: {**rivals, name: solver}


def same_problem(name: str) -> Replacement:
    """Deliberate defect: the problem is compared with itself instead of with another problem.

    Args:
        name: name of the other problem.
    """
    return lambda rivals: lambda problem: {**rivals(problem), name: problem}


def rival_stress_off(stresses: Function) -> Function:
    """Deliberate defect: in one time step, stresses of other solvers are wrong by a thousandth.

    The other solvers are compared with the solver of the study, ``Signorini``.
    """
    off = items(lambda n, stress, setup: (1 + 0.001 * (n == 6 and setup.solver is not Signorini)) * stress)
    return result(list)(off(stresses))  # type: ignore[no-any-return]


unweighted = result(lambda rule: replace(rule, weights=1 + 0 * rule.weights))
"""Deliberate defect: integrals over boundary edges are sums over quadrature points without weights."""


body_load_off = where(
    lambda solution, space, time, degree: degree < 3 and np.isclose(time, 0.375 * solution.body.T), times(1.1)
)
"""Deliberate defect: the load that is integrated with the coarser rule is wrong by a tenth at one time."""


load_of_before = arguments(lambda problem, times: (replace(problem, load=late(problem.load, problem.T / 8)), times))
"""Deliberate defect: backward Euler at time t uses the load at time t − T/8, where T is the final time."""


norm_of_nodal_values = replaced_by(lambda problem, one, other: float(np.linalg.norm(one - other, axis=1).max()))
"""Deliberate defect: the distance of two solutions is measured in nodal values instead of the energy norm.

It is the largest Euclidean norm, over all times, of the differences of nodal values.
"""


constant_halved = arguments(lambda flow, kappa, growth: (flow, kappa / 2, growth))
"""Deliberate defect: error bounds of backward Euler use half of the Lipschitz constant ``kappa``."""


def always_steps(most: int) -> Replacement:
    """Deliberate defect: the solution with half as many time steps is copied from another solution.

    Both are compared in order to estimate the error in time, which then appears to be 0.

    Args:
        most: number of time steps of the other solution.
    """
    copied: Replacement = lambda path: lambda problem, scheme, _: path(problem, scheme, most)[::2]  # noqa: E731
    return where(lambda problem, scheme, steps: 2 * steps == most, copied)


near_vertices = arguments(lambda x, last: (x + 4.0**-last / 8, last))
"""Deliberate defect: a field with spikes at vertices is shifted by an eighth of the smallest spike radius."""
