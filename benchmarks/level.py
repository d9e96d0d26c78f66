"""What is measured: one level of a case, from the mesh to the error at every step, and the contact solver inside."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from time import perf_counter
from typing import Any

import scipy.sparse as sps

from manufactured.tensors import Array, Points
from study.fem.naming import family_named, resolve
from study.fem.space import Space
from study.solve.multigrid import Multigrid, multigrid_tolerance
from study.solve.signorini import ContactSolver, Signorini
from study.solve.tableau import MIDPOINT
from study.statements.shared.base import Experiment

Make = Callable[[sps.csc_array, sps.csr_array], Any]

STEPS = 64
"""Time steps of a level, unless said otherwise."""


@dataclass(frozen=True)
class Solver:
    """A contact solver as data.

    Attributes:
        on: a space ↦ ((S, N) ↦ the contact solve).
        bare: a watched solver ↦ (b ↦ S⁻¹b with the same factorisation or preconditioner).
    """

    on: Callable[[Space], Make]
    bare: Callable[[Watched], Callable[[Array], Array]]


DIRECT = Solver(on=lambda space: partial(Signorini, x=space.free_points), bare=lambda watched: watched.contact.factor)
MULTIGRID = Solver(
    on=lambda space: partial(Multigrid, x=space.free_points, tolerance=multigrid_tolerance(space.dim, space.dofs)),
    # Without constraints: the same hierarchy, the same tolerance.
    bare=lambda watched: watched.make(watched.S, watched.N[:0]),
)
SOLVERS = {"direct": DIRECT, "multigrid": MULTIGRID}


class Watched:
    """A contact solver that keeps what it is given and how long it took to make.

    Attributes:
        made: how often a solver was made for a matrix.
        make: (S, N) ↦ the solver, on the space of the level.
        S, N: what it was last made for.
        points: those of the unknowns, (d, n/d).
        contact: the solver made.
        setup_seconds: what making it took.
        rights: the first ``keep`` right sides.
    """

    make: Make
    points: Points

    def __init__(self, solver: Solver, keep: int) -> None:
        self.solver, self.keep = solver, keep
        self.made = 0
        self.rights: list[Array] = []

    def on(self, space: Space) -> Make:
        self.make, self.points = self.solver.on(space), space.free_points
        return self._watch

    def _watch(self, S: sps.csc_array, N: sps.csr_array) -> ContactSolver:
        self.S, self.N, self.made = S, N, self.made + 1
        start = perf_counter()
        self.contact = self.make(S, N)
        self.setup_seconds = perf_counter() - start
        return self._solve

    def _solve(self, b: Array) -> tuple[Array, Array]:
        if len(self.rights) < self.keep:
            self.rights.append(b)
        return self.contact(b)


@dataclass(frozen=True)
class Place:
    """A case on one mesh."""

    case: str
    family: str
    n: int

    def setup(self, solver: Solver | Watched = DIRECT, steps: int = STEPS) -> Experiment:
        """Mesh, space, matrices and quadrature for the midpoint rule with a solver."""
        setup = Experiment.of(resolve(self.case).solution, family_named(self.family), self.n, MIDPOINT, steps)
        return replace(setup, problem=replace(setup.problem, solver=solver.on(setup.space)))


def errors(setup: Experiment) -> list[float]:
    """‖u(t_n) − u_n‖_V at every node: solves all steps."""
    v_norm = setup.v_norm
    states = setup.scheme.march(setup.problem, setup.steps)
    return [v_norm.distance(v_norm.sample(state.time), state.u) for state in states]


def compile_formulas(case: str) -> None:
    """Solve a tiny level, so that what is done once in a process is not counted as work of a level."""
    errors(Place(case, "one-diagonal", 4).setup(steps=2))
