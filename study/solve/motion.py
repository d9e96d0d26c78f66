"""One solved problem in time: velocity, stress, contact and energy at every time node of BDF2.

The scheme replaces u̇(t_n) by a difference quotient δu_n, so the stress it balances at t_n is

    σ_n = A ε(δu_n) + G ε(u_n),   (σ_n, ε(v))_Q + λ_n·Nv = F(t_n)·v  for all v ∈ V^h,

constant on every cell, and with v = δu_n the power of the load goes into stored energy, dissipation and contact.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from manufactured.exact import ExactSolution
from manufactured.law import AtPoints, Elasticity, KelvinVoigt, Linear
from manufactured.tensors import Array, Tensors, identity
from study.fem.gauge import Gauge
from study.fem.material import on_cells
from study.fem.mesh import MeshFamily
from study.fem.space import Space
from study.solve.evolution import BDF2, SemiDiscrete, State, step_size


@dataclass(frozen=True, eq=False)
class Power:
    """What a moment adds to the balance of energy, in integrals over Ω.

    Attributes:
        stored: the energy ∫ W(ε(u)) with W' = G.
        elastic: its rate (G ε(u), ε(δu))_Q.
        viscous: the dissipation (A ε(δu), ε(δu))_Q.
        contact: λ·N δu; zero but where a vertex changes between contact and release.
        load: F·δu, the sum of the last three.
    """

    stored: float
    elastic: float
    viscous: float
    contact: float
    load: float


@dataclass(frozen=True, eq=False)
class Frame:
    """One time node.

    Attributes:
        time: t_n.
        u, velocity: u_n and δu_n, (n_dofs,).
        stress: σ_n on the cells, (D, cells).
        normal: N u_n, minus the gap at the contact vertices, (m,).
        multipliers: λ_n, (m,).
        power: the balance at t_n.
    """

    time: float
    u: Array
    velocity: Array
    stress: Tensors
    normal: Array
    multipliers: Array
    power: Power


@dataclass(frozen=True, eq=False)
class Motion:
    """An exact solution's problem, solved on one mesh: all frames from t_0 to t_steps."""

    solution: ExactSolution
    family: str
    level: int
    space: Space
    frames: list[Frame]

    @classmethod
    def of(
        cls,
        solution: ExactSolution,
        family: MeshFamily,
        level: int,
        steps: int,
        notify: Callable[[], object] = lambda: None,
    ) -> Motion:
        """Solve it; ``notify`` is called after each of the steps + 1 frames.

        Raises:
            MeshError: the mesh does not fit the body at this level.
        """
        space = Space(family(solution.body, level), solution.body)
        gauge = Gauge(solution, space)
        problem = SemiDiscrete.of(space, solution.law, gauge.load, gauge.sample(0.0).interpolant)
        found = []
        for frame in frames(space, solution.law, problem, steps):
            found.append(frame)
            notify()
        return cls(solution, family.name, level, space, found)


def frames(space: Space, law: KelvinVoigt, problem: SemiDiscrete, steps: int) -> Iterator[Frame]:
    """The frames at t_0, …, t_steps.

    At t = 0, where the scheme has solved nothing, δu is the first forward difference and λ is 0.
    """
    k = step_size(problem, steps)
    cells = on_cells(space, law)
    past: list[State] = []
    for state in BDF2().march(problem, steps):
        if len(past) == 1:
            yield _frame(space, law.G, cells.A, cells.G, problem, past[0], (state.u - past[0].u) / k)
        past = [*past[-2:], state]
        if len(past) > 1:
            yield _frame(space, law.G, cells.A, cells.G, problem, state, _difference(past, k))


def _difference(past: Sequence[State], k: float) -> Array:
    """δu of the last state: the quotient of BDF2, of backward Euler in the first step."""
    if len(past) == 2:
        return (past[1].u - past[0].u) / k
    return (3 * past[2].u - 4 * past[1].u + past[0].u) / (2 * k)


def _frame(
    space: Space, law: Elasticity, A: AtPoints, G: AtPoints, problem: SemiDiscrete, state: State, velocity: Array
) -> Frame:
    strain, rate = space.strain(state.u), space.strain(velocity)
    viscous, elastic = A(rate), G(strain)
    power = Power(
        stored=float(space.volumes @ density(law, strain, elastic)),
        elastic=float(space.volumes @ np.sum(elastic * rate, axis=0)),
        viscous=float(space.volumes @ np.sum(viscous * rate, axis=0)),
        contact=float(state.multipliers @ (problem.N @ velocity)),
        load=float(problem.load(state.time) @ velocity),
    )
    return Frame(state.time, state.u, velocity, viscous + elastic, problem.N @ state.u, state.multipliers, power)


def density(G: Elasticity, strain: Tensors, stress: Tensors) -> Array:
    """W(ε), (...), from ε and G(ε), (D, ...) each.

    ½ G ε·ε of a linear law; β/2 dist(ε, K)² = |G(ε)|²/(2β) of law (3.3), as ½ dist² has the gradient ε − P_K ε.
    """
    if isinstance(G, Linear):
        return np.asarray(0.5 * np.sum(strain * stress, axis=0))
    return np.asarray(np.sum(stress**2, axis=0) / (2 * G.lipschitz))


def von_mises(stress: Tensors) -> Array:
    """√(3/2) |dev σ| with dev σ = σ − (tr σ/d) I, (D, ...) → (...).

    In the plane, where the problem has no σ_33, this takes it as (σ_11 + σ_22)/2: then the deviator is that of S²,
    as in the sets K of (3.3), and the value is (√3/2) ((σ_11 − σ_22)² + 4 σ_12²)^½, the smallest that any σ_33 gives.
    """
    dim = {3: 2, 6: 3}[len(stress)]
    unit = identity(dim)
    trace = np.tensordot(unit, stress, axes=1)
    deviator = stress - np.multiply.outer(unit / dim, trace)
    return np.asarray(np.sqrt(1.5 * np.sum(deviator**2, axis=0)))


def balance(found: Sequence[Frame]) -> dict[str, Array]:
    """Energies at the times of the frames, (times,) each, with these ``times``.

    ``stored``, and what dissipation, contact and load have done since the first one: ``dissipated``, ``contact``,
    ``work``. Powers are integrated by the trapezoidal rule, so ``defect``, stored − stored(0) + dissipated + contact −
    work, is of the second order in the time step, and not zero: it is not what the scheme solves.
    """
    times = np.array([frame.time for frame in found])

    def since_start(values: list[float]) -> Array:
        return np.concatenate([[0.0], np.cumsum(np.diff(times) * (np.array(values[1:]) + values[:-1]) / 2)])

    stored = np.array([frame.power.stored for frame in found])
    dissipated = since_start([frame.power.viscous for frame in found])
    contact = since_start([frame.power.contact for frame in found])
    work = since_start([frame.power.load for frame in found])
    defect = stored - stored[0] + dissipated + contact - work
    return {
        "times": times,
        "stored": stored,
        "dissipated": dissipated,
        "contact": contact,
        "work": work,
        "defect": defect,
    }
