"""Regularity in time of the load and of the traction, (3.8), (5.9) and (4.12), and the traction conditions (4.13)."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pandas as pd

from manufactured.body import Body, Kind, Part
from manufactured.catalogue import catalogue
from manufactured.tensors import Array, Points, Tensors, Vectors, mandel, traction
from study.fem.error_norm import FACET_POINTS, ErrorNorm
from study.fem.quadrature import facet_rule
from study.fem.space import on_cells
from study.ledger.check import MIN_LEVELS, ROUNDING_ROOM, Groups, consequence, paper_claim
from study.ledger.quantities import change
from study.ledger.window import Window, around, between
from study.solve.factorisation import Cholesky
from study.solve.tableau import MIDPOINT
from study.statements.shared.base import (
    EVOLVING,
    SEED,
    SOFTENING,
    Experiment,
    Judged,
    ListedNumbers,
    Numbers,
    Setting,
    check_of_order,
    grid,
    with_h,
)
from study.statements.shared.meshes import CELL_POWER, named, place, posed
from study.statements.shared.norms import Energies, dual_norm, unloaded
from study.statements.shared.scope import REGULAR

# The load, f ∈ W^{1,1}(0,T;V).

LOAD_INTERVALS = 512
COARSER = 16
"""Quotient of the lengths of long and short time intervals, over which increments of the load are compared."""


UNBOUNDED_VARIATION = "ε(ü) ~ (s − c)^{α−4} with α = 13/4 is not square integrable and f has no bounded variation in V"


class LoadInTime(ListedNumbers):
    """Measures the variation in time, the largest increment and the norm of the discrete load f^h.

    Norms in time that must be finite: of the load, (3.8) and (5.9), and of the traction, (4.12).

    The statements are f ∈ W^{1,1}(0,T;V) for the load f, and σν ∈ L^∞(0,T;L²(Γ)) for the traction on the whole
    boundary. They are tested by computing the norm on finer and finer grids: a finite norm converges, an infinite norm
    grows.

    **(3.8).** By (5.9) f^h(t) = M⁻¹F(t) is the projection of the load f(t) onto V^h. Its *variation* on a time grid is
    Σ_i ‖f^h(t_i) − f^h(t_{i−1})‖_V. The variation grows if the grid is refined, by the triangle inequality. Predicted:

    * The variation grows by at most 1 % from a grid to the next finer one, if the load changes its direction finitely
      often. If the variation were not bounded, it would grow by a power of 2.
    * Four halvings of the intervals reduce the largest increment to 1/16 where ḟ is bounded. They reduce it to 1/2 for
      ``load-w11``, whose load behaves like (t − t_0)^{1/4}. If f jumped in time, the largest increment would not fall;
      bounded variation alone would permit such a jump. In ``lift-and-land`` u̇ and σ_ν jump, but the two jumps cancel
      in f.
    * On finer meshes ‖f^h‖_{W^{1,1}} tends to the norm of f. The energy that the projection loses is of order h². Where
      a contact patch is three cells wide (n = 8), this is some per cent, and a quarter of that on each finer mesh.
      Therefore n = 8 is not judged for moving fronts. From n = 16 on the norms agree within 5 %. If f were not in V,
      the norm would grow.

    (3.8) does not hold for ``moving-rough``. There ε(u̇) ~ (s − c)^{1/4} near the front c, which moves. So u̇ has
    increments of the size k^{3/4} in V, whose sum is not bounded, and so has f, which contains u̇. The case was judged
    at first: its variation grew by 0.8, 1 and 1.3 % at n = 8, 16 and 32. Now it is only reported. Theorem 4.1 does not
    apply to this load; u ∈ W^{1,∞}(0,T;V) is known because u was constructed.

    **(4.12).** The norm of the exact traction on Γ is computed on finer and finer meshes, by quadrature rules that are
    not adapted to singularities. Its maximum is taken over twice as many times as there are cells along a side.
    Predicted:

    * The maximum converges for every case of Proposition 5.4.
    * In ``junction`` the traction behaves like r^{−1/2} at the point where Γ1 meets Γ3. There the square of the norm
      grows like log 1/h, that is, by the same amount from mesh to mesh. (4.12) does not hold, and the paper does not
      claim it.
    """

    label = "(3.8), (5.9)"
    claim = "f ∈ W^{1,1}(0,T;V), and f^h ∈ W^{1,1}(0,T;V^h) uniformly in h"
    checks = (
        paper_claim(
            "variation",
            f"variation of f^h on {LOAD_INTERVALS} intervals / on {LOAD_INTERVALS // 2} intervals",
            "variation",
            Window(1 - ROUNDING_ROOM, 1.01, "the variation cannot fall; without a bound it grows by a power of 2"),
        ),
        consequence(
            "increments",
            f"largest increment of f^h / largest increment over {COARSER} times as long intervals",
            "increments",
            Window(1 / 32, 0.6, f"1/{COARSER} where ḟ is bounded, 1/2 for (t − t_0)^{{1/4}}, 1 for a jump"),
        ),
        paper_claim(
            "uniform",
            "‖f^h‖_{W^{1,1}(0,T;V)}, finest mesh / coarsest mesh",
            change("norm"),
            around(1, 0.05, "f^h tends to f"),
            levels=2,
        ),
    )
    quick = grid(("load-w11",), ("unstructured",), (8, 16))
    full = grid(
        (*EVOLVING, "lift-and-land", "load-w11", "moving-rough", "hexagon", *SOFTENING), ("unstructured",), (16, 32)
    )

    def measure(self, setting: Setting) -> Numbers:
        space, solution = posed(setting)
        v_norm = ErrorNorm(solution, space)
        riesz = Cholesky(unloaded(space, solution.law).M)
        times = np.linspace(0, solution.body.T, LOAD_INTERVALS + 1)
        loads = v_norm.load(times).T
        # A finite norm shows in increments ‖f^h(t_i) − f^h(t_{i−1})‖_V that do not grow from grid to grid.
        fine, half, coarse = (
            np.array([dual_norm(increment, riesz) for increment in np.diff(loads[::step], axis=0)])
            for step in (1, 2, COARSER)
        )
        size = np.mean([dual_norm(F, riesz) for F in loads]) * solution.body.T
        numbers = {"variation": fine.sum() / half.sum(), "increments": fine.max() / coarse.max()}
        return with_h(space.h, {**numbers, "norm": size + fine.sum()})

    def checks_of(self, case: str, groups: Groups) -> Judged:
        reason = UNBOUNDED_VARIATION if case == "moving-rough" else ""
        return [(replace(check, if_missed=reason), groups) for check in self.checks]


# The traction, σν ∈ L^∞(0,T;L²(Γ)).

UNBOUNDED = "junction"
"""The case whose traction σν is not square integrable on the boundary."""


def last_increments(levels: pd.DataFrame) -> float:
    """Return the last over the previous increment of max_t ‖σν‖² under refinement."""
    increments = np.diff(levels["norm"].to_numpy() ** 2)
    return float(increments[-1] / increments[-2])


class TractionInTime(ListedNumbers):
    """Measures the largest norm of the traction, max_t ‖σν‖_{L²(Γ)}.

    It must converge for the cases of Proposition 5.4, and must grow for one case with an unbounded traction.
    """

    label = "(4.12)"
    claim = "σν ∈ L^∞(0,T;L²(Γ)^d) for the solutions of Prop. 5.4"

    def places(self, full: bool) -> list[Setting]:
        cases = [case for case in catalogue() if case.proposition == "Prop. 5.4"] if full else named("advance-recede")
        return place([*cases, *named(UNBOUNDED)], REGULAR, (8, 16, 32), (2, 4, 8))

    def measure(self, setting: Setting) -> Numbers:
        space, solution = posed(setting)
        times = np.linspace(0, solution.body.T, 2 * setting.level + 1)
        squares = np.zeros(len(times))
        for part in space.body.parts:
            rule = facet_rule(space.mesh, space.facets(part), part, (), FACET_POINTS if space.dim == 2 else 2)
            exact = solution.at(part.point(rule.s))
            squares += [np.sum(exact.surface_load(part, time) ** 2 * rule.weights) for time in times.tolist()]
        return with_h(space.h, {"norm": math.sqrt(squares.max())})

    def checks_of(self, case: str, groups: Groups) -> Judged:
        if case == UNBOUNDED:
            check = consequence(
                "unbounded",
                "σν ∉ L²(Γ): last / previous increment of max_t ‖σν‖²_{L²(Γ)} under refinement",
                last_increments,
                around(1, 0.1, "logarithmic growth: the increments of the square do not fall"),
                levels=MIN_LEVELS,
            )
        else:
            check = paper_claim(
                "bounded",
                "max_t ‖σν‖_{L²(Γ)}, finest mesh / next coarser mesh",
                change("norm", since=-2),
                around(1, 0.02, "the maximum has converged in space and time, which are refined together"),
                levels=MIN_LEVELS,
            )
        return [(check, groups)]


STRESS_INSTANTS = 8
"""Number of nodes of the midpoint rule that approximates norms in time."""
Field = Callable[[Points], Vectors]
"""A smooth displacement field, analytic in x."""
TEST_FIELDS = 3
"""Number of smooth test fields for each of the two traction conditions."""
TRACTION_FAMILIES = "one-diagonal", "criss-cross", "shaken", "unstructured"
STRONG = around(1, 0.25, "if the stress error is spread evenly; ‖σ − σ^h‖_Q = O(h) alone gives 1/2")
WEAK = around(2, 0.3, "product of two errors O(h), σ − σ^h and v − Π^h v")


WEAKLY = "loaded, weakly", "tangential, weakly"
"""Columns with the violations of the traction conditions on Γ2 and on Γ3, tested with smooth fields."""


class NaturalConditions(ListedNumbers):
    """Measures how far the discrete stress violates the traction conditions on Γ2 and Γ3.

    Stresses are evaluated at STRESS_INSTANTS evenly spaced times, each of which is the midpoint of a time step.

    (4.13): the tractions σν = f_2 on Γ2 and σ_τ = 0 on Γ3, which discrete stresses satisfy only in the limit h → 0.

    The discrete stress σ^h = A ε(u̇^h) + G ε(u^h) is constant on cells, so its tractions do not satisfy (4.13) exactly.
    The error of the tractions tends to 0 in two senses. Its orders are predicted for solutions with σ ∈ W^{1,∞}.

    * In L²(Γ) order 1 is predicted. ‖σ − σ^h‖_Q = O(h) alone gives order 1/2: by the scaled trace inequality the error
      on Γ is at most h^{−1/2} times the error in the cells along Γ, which might contain the whole error. But W^{1,∞}
      estimates for smooth solutions on quasi-uniform meshes say that the error is spread evenly. The cells along Γ then
      contain an error of h^{3/2}. The order of ‖σ^hν − σν‖ cannot exceed 1, because σ^h is constant on a cell. For
      σ^h_τ alone, which ‖σ^hν − σν‖ bounds, the first-order term depends on the arrangement of the triangles along Γ3.
    * Weakly, tested with smooth v that have v = 0 on Γ1 and v_ν = 0 on Γ3. Then (4.13) reads (σ, ε(v))_Q = (f, v)_V.
      The scheme satisfies this equation for the interpolant Π^h v, so

          (σ^h, ε(v))_Q − (f, v)_V = (σ^h − σ, ε(v − Π^h v))_Q = O(h) · O(h).

    This gives order 2, also if σ^h − σ contains an error of the time steps.
    """

    label = "(4.13)"
    claim = "σν = f_2 on Γ2 and σ_τ = 0 on Γ3"
    checks = (
        check_of_order("loaded", "order of ‖σ^hν − f_2‖ in L²(0,T;L²(Γ2))", "loaded", STRONG),
        check_of_order("contact", "order of ‖σ^hν − σ_ν ν‖ ≥ ‖σ^h_τ‖ in L²(0,T;L²(Γ3))", "contact", STRONG),
        check_of_order(
            "tangential",
            "order of ‖σ^h_τ‖ in L²(0,T;L²(Γ3))",
            "tangential",
            between(1, 2, 0.25, 0, "order 2 where the triangles along Γ3 are symmetric"),
            if_missed=(
                "the check of σ^hν − σ_ν ν bounds ‖σ^h_τ‖, whose first-order part depends on the triangles along Γ3"
            ),
        ),
        check_of_order(
            "loaded-weakly", "order of σν − f_2 on Γ2, tested with smooth v", WEAKLY[0], WEAK, power=CELL_POWER
        ),
        check_of_order(
            "tangential-weakly", "order of σ_τ on Γ3, tested with smooth v", WEAKLY[1], WEAK, power=CELL_POWER
        ),
    )
    quick = grid(("advance-recede",), ("shaken",), (12, 24, 48))
    full = grid(("advance-recede", "travelling-patch", "yield-and-release"), TRACTION_FAMILIES, (12, 24, 48))

    def setup(self, setting: Setting) -> Experiment:
        # [0, T] is split into STRESS_INSTANTS equal parts. Each part has an odd number of time steps, so that its
        # midpoint is the midpoint of a time step.
        steps = STRESS_INSTANTS * (2 * (setting.level // 8) + 3)
        return Experiment.at(setting, MIDPOINT, steps)

    def measure(self, setup: Experiment) -> Numbers:
        return with_h(setup.space.h, tractions(setup))


def tractions(setup: Experiment) -> Numbers:
    """Return norms of the violations of the traction conditions, relative to the norm of σν on Γ2 ∪ Γ3.

    The violations are measured in L² on the boundary and, weakly, with smooth test fields v of norm ‖v‖_V = 1. All
    norms are root mean squares over several times. The work (f, v)_V is computed as (σ, ε(v))_Q with the exact stress
    σ. Both are equal by Green's formula (2.14) with (2.2), (2.4) and (2.5).
    """
    space = setup.space
    mesh = setup.space.mesh
    sides = []
    for kind in (Kind.LOADED, Kind.CONTACT):
        for part, facets in space.on(kind):
            rule = facet_rule(mesh, facets, part, (), FACET_POINTS)
            sides.append((kind, part, mesh.f2t[0, facets], rule.weights, setup.solution.at(part.point(rule.s))))
    energies = Energies(setup.solution, space, along=())
    tests = []
    for fields in smooth_fields(space.body):
        strains = [strain(v, energies.exact.x) for v in fields]
        tests.append([e / energies.norm(e) for e in strains])
    squares: Numbers = dict.fromkeys(("tangential", "contact", "loaded", *WEAKLY), 0.0)
    size = 0.0
    for time, stress in discrete_stresses(setup):
        for kind, part, cells, weights, exact in sides:
            forces = traction(stress[:, cells], part.normal)
            load = exact.surface_load(part, time)
            if kind is Kind.CONTACT:
                tangential = forces - np.multiply.outer(part.normal, part.normal @ forces)
                squares["tangential"] += np.sum(tangential**2 * weights.sum(axis=1))
            name = "contact" if kind is Kind.CONTACT else "loaded"
            squares[name] += np.sum((forces[..., None] - load) ** 2 * weights)
            size += np.sum(load**2 * weights)
        stress_error = stress[:, energies.cells] - energies.exact.stress(time)
        for name, strains in zip(WEAKLY, tests, strict=True):
            squares[name] += sum(energies.work(stress_error, e) ** 2 for e in strains)
    return {name: math.sqrt(square / size) for name, square in squares.items()}


def discrete_stresses(setup: Experiment) -> Iterator[tuple[float, Tensors]]:
    """Yield pairs of a time t and the discrete stress σ^h(t), for STRESS_INSTANTS times t.

    The times are the midpoints of STRESS_INSTANTS equal parts of [0, T], each with an odd number of time steps. So t
    is the
    midpoint of a step from t_{n−1} to t_n, and σ^h(t) = A ε((u_n − u_{n−1})/k) + G ε((u_n + u_{n−1})/2).
    """
    space = setup.space
    cells = on_cells(setup.space, setup.solution.law)
    k = setup.problem.T / setup.steps
    each = setup.steps // STRESS_INSTANTS
    for n, (before, after) in enumerate(pairwise(setup.march(setup.steps))):
        if n % each == each // 2:
            old = space.strain(before.u)
            new = space.strain(after.u)
            yield (before.time + after.time) / 2, cells.stress((new - old) / k, (new + old) / 2)


def smooth_fields(body: Body) -> tuple[list[Field], list[Field]]:
    """Return random smooth fields that test the traction condition on Γ2, and fields that test the condition on Γ3.

    Returns:
        Fields that vanish on Γ1 and Γ3; and fields that vanish on Γ1, are tangential on one plane of Γ3 and vanish on
        the other planes of Γ3.
    """
    clamped = planes(body, Kind.CLAMPED)
    contact = planes(body, Kind.CONTACT)
    rng = np.random.default_rng(SEED)
    on_loaded = [vanishing(waves(body, rng), clamped + contact) for _ in range(TEST_FIELDS)]

    def tangential(part: Part) -> Field:
        others = [other for other in contact if other is not part]
        tangents = part.frame[:, :-1]
        along = waves(body, rng)
        inside = waves(body, rng)

        def field(x: Points) -> Vectors:
            return np.tensordot(tangents @ tangents.T, along(x), axes=1) + part.coordinates(x)[1] * inside(x)

        return vanishing(field, clamped + others)

    rng = np.random.default_rng(SEED)
    return on_loaded, [tangential(part) for part in contact for _ in range(TEST_FIELDS)]


# Smooth fields are defined here and not in ``study.fem``, because only statements use them.


def planes(body: Body, kind: Kind) -> list[Part]:
    """Return one boundary part of the given kind for each line (in 3D: plane) that contains such parts."""
    distinct: list[Part] = []
    for part in body.of(kind):
        lines = [np.append(other.normal, other.normal @ other.start) for other in (*distinct, part)]
        if not any(np.allclose(line, lines[-1]) for line in lines[:-1]):
            distinct.append(part)
    return distinct


def distances(x: Points, parts: list[Part]) -> Array:
    """Return for each point the product of its distances from the planes that contain the given boundary parts.

    Args:
        x: the points, (d, ...).
        parts: the boundary parts.

    Returns:
        One product for each point, (...).
    """
    return np.prod([np.ones(x.shape[1:]), *(part.coordinates(x)[1] for part in parts)], axis=0)


def vanishing(field: Field, parts: list[Part]) -> Field:
    """Return a field multiplied by the distances from the planes of the given parts, so that it vanishes on them."""
    return lambda x: field(x) * distances(x, parts)


def waves(body: Body, rng: np.random.Generator) -> Field:
    """Return a random vector field cos(κ·x + c) with about half a wave across the body in each direction."""
    extent = body.vertices.max(axis=1) - body.vertices.min(axis=1)
    directions = rng.uniform(-np.pi, np.pi, (body.dim, body.dim)) / extent
    phases = rng.uniform(0, 2 * np.pi, body.dim)

    return lambda x: np.cos((x.T @ directions.T + phases).T)


def strain(field: Field, x: Points) -> Tensors:
    """Return the strain ε(v) of a field v at given points, by complex-step differentiation.

    Args:
        field: the field v, analytic in x.
        x: the points, (d, ...).

    Returns:
        The D components of the strain at each point, (D, ...).
    """
    tiny = 1e-30
    derivatives = [field((x.T + 1j * tiny * unit).T).imag / tiny for unit in np.eye(len(x))]
    return mandel(np.stack(derivatives, axis=1))
