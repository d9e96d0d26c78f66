"""The errors of Problem 3.2 in time on composite stresses, with BDF2 on both sides, k ~ h.

σ^h_n is found by ``study.stresses.dual`` from f_0, f_2 and ε(u_0) alone: no displacement, no V^h. It is compared with
the exact σ, with the stress of Problem 5.1 that has the same time steps, and its multipliers with displacements.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import islice
from typing import Any

import numpy as np

from manufactured.body import Kind
from manufactured.case import Case
from manufactured.data import Data
from manufactured.exact import ExactSolution
from manufactured.law import Linear
from manufactured.tensors import Array, Tensors, Vectors
from study.fem.gauge import DEGREE, FACET_POINTS, Gauge, rules
from study.fem.mesh import MeshFamily, size
from study.fem.naming import family_named, resolve
from study.fem.quadrature import facet_rule
from study.fem.space import Space
from study.solve.evolution import SemiDiscrete, velocities
from study.solve.signorini import Signorini
from study.solve.tableau import BDF2, Tableau
from study.statements.shared.base import Setting
from study.stresses.bernstein import bernstein
from study.stresses.composite import alfeld_split, barycentric
from study.stresses.dual import DualState, StressEvolution, tensor_at
from study.stresses.hybrid import act
from study.stresses.stress_space import StressSpace

EDGE_POINTS = 4
"""Gauss points on an edge for the moments of u."""
ERRORS = "stress", "stress_sup", "best", "strain", "pressure", "displacement", "primal_stress", "primal_displacement"
COLUMNS = ("case", "family", "level", "h", "steps", "unknowns", *ERRORS, "admissibility", "time_share")
"""``stresses.csv``: norms of L²(0,T), root mean squares over the steps 1, 2, …

All are relative to the same norm of the exact quantity, those of stresses and of the pressure to σ.

    unknowns: moments of the edges in one contact solve.
    stress: ‖σ − σ^h‖_Q.
    stress_sup: its maximum over the steps, relative to that of ‖σ‖_Q.
    best: ‖σ − τ‖_Q for the best τ that is linear on every third: no stress of this space can do better.
    strain: ‖ε(u) − ε_n‖_Q, ε_n the strains that the law attaches to the stresses.
    pressure: ‖σ_ν − σ^h_ν‖_{L²(Γ3)}.
    displacement: (Σ_T Σ_{e ⊂ ∂T} |T|/3 mean_e |u − m|²)^½ for the P1 functions m on the edges whose moments are the
        multipliers, u projected onto such functions.
    primal_stress: ‖σ^h − (Aε(δu^h) + Gε(u^h))‖_Q, u^h of Problem 5.1 with the same time steps.
    primal_displacement: as ``displacement`` with u^h for u.
    admissibility: max_n of what contradicts (2.4), (2.5) and continuity strongly: |σ^hν − P f_2| on Γ2, |σ^h_τ| and
        (σ^h_ν)_+ on Γ3, jumps of σ^hν, in Bernstein coefficients, relative to the largest |σ^hν|.
    time_share: ‖σ^h_k − σ^h_{2k}‖_Q at common nodes / ‖σ − σ^h_k‖_Q, with f_0 by a finer rule in σ^h_{2k}: what steps
        and quadrature contribute.
"""
RAISED = 2
"""Added to the degree of the rule for f_0 in the companion with half as many steps."""


@dataclass(frozen=True, eq=False)
class StressExperiment:
    """Everything one row is measured with. Controls replace single pieces by wrong ones.

    Attributes:
        solution: the exact solution.
        data: what Problem 3.2 is told of it.
        space: the stresses.
        scheme, steps: BDF2 and the number of its steps.
        solver: (S, N) ↦ the contact solve.
    """

    solution: ExactSolution
    data: Data
    space: StressSpace
    scheme: Tableau
    steps: int
    solver: type[Signorini] = Signorini

    @classmethod
    def of(cls, solution: ExactSolution, family: MeshFamily, level: int, steps: int) -> StressExperiment:
        """The experiment as Problem 3.2 has it."""
        return cls(solution, Data.of(solution), StressSpace(family(solution.body, level), solution.body), BDF2, steps)

    @classmethod
    def at(cls, setting: Setting, steps: int) -> StressExperiment:
        """The experiment on a case by its name."""
        return cls.of(resolve(setting.case).solution, family_named(setting.family), setting.level, steps)

    @cached_property
    def problem(self) -> StressEvolution:
        """Problem 3.2."""
        return StressEvolution(self.data, self.space, self.solver)

    def march(self) -> Iterator[DualState]:
        """Problem 3.2: the states at t_1, …, t_steps."""
        return islice(self.scheme.march(self.problem, self.steps), 1, None)

    def companion(self) -> Iterator[DualState]:
        """The same with half as many steps and f_0 by a finer rule."""
        return islice(self.scheme.march(replace(self.problem, raised=RAISED), self.steps // 2), 1, None)


class Exact:
    """An exact solution seen by composite stresses; cells are cut where it is rough, as in ``study.fem.gauge``."""

    def __init__(self, solution: ExactSolution, space: StressSpace) -> None:
        self.space = space
        mesh, corners = alfeld_split(space.mesh)
        self._blocks = []
        for rule in rules(solution, mesh, max(DEGREE, 2 * space.degree)):
            shapes = bernstein(space.degree, barycentric(corners[:, :, rule.cells], rule.points))
            weighted = np.moveaxis(shapes * rule.weights, 1, 0)
            best = np.linalg.solve(weighted @ np.moveaxis(shapes, 0, -1), weighted)
            self._blocks.append((rule.cells, rule.weights, shapes, best, solution.at(rule.points)))
        self._inside, self._faces = solution.at(space.points), []
        for face in solution.faces:
            edges = space.parts[space.body.parts.index(face.part)]
            on = facet_rule(space.mesh, edges, face.part, face.rough, FACET_POINTS)
            self._faces.append((edges, bernstein(space.degree, on.shapes), on.weights, solution.on(face, on.s)))
        x, weights = np.polynomial.legendre.leggauss(EDGE_POINTS)
        self._along = np.array([1 - x, 1 + x]) / 2
        self._shapes = bernstein(space.degree, self._along)
        self._moments = self._shapes * weights / 2
        self._edges = solution.at(np.einsum("den,eq->dnq", space.mesh.p[:, space.mesh.facets], self._along))
        self._share = np.bincount(space.edges.ravel(), np.repeat(space.volumes / 3, 3), len(space.lengths))

    def stress(self, time: float, values: Tensors) -> tuple[float, float, float]:
        """‖σ − σ^h‖, ‖σ − the best polynomials on the thirds‖ and ‖σ‖ in Q."""
        coefficients, squares = self.space.coefficients(values), np.zeros(3)
        for cells, weights, shapes, best, fields in self._blocks:
            exact = fields.stress(time)
            mine = np.einsum("Ina,anq->Inq", coefficients[:, cells], shapes, optimize=True)
            nearest = np.einsum("naq,Inq,anp->Inp", best, exact, shapes, optimize=True)
            squares += [np.einsum("Inq,Inq,nq->", d, d, weights) for d in (exact - mine, exact - nearest, exact)]
        error, least, size = np.sqrt(squares)
        return float(error), float(least), float(size)

    def strain(self, time: float, strain: Tensors) -> tuple[float, float]:
        """‖ε(u) − strain‖ and ‖ε(u)‖ in Q, with the rule of the stresses."""
        exact = self._inside.strain(time)
        return self.norm(exact - strain), self.norm(exact)

    def norm(self, values: Tensors) -> float:
        """‖·‖_Q of values at the points of the stresses."""
        return float(np.sqrt(np.einsum("Icq,Icq,cq->", values, values, self.space.weights)))

    def pressure(self, time: float, tractions: Array) -> float:
        """‖σ_ν − σ^h_ν‖ in L²(Γ3)."""
        square = 0.0
        for edges, shapes, weights, fields in self._faces:
            exact = fields.pressure(time)
            mine = -np.einsum("na,anq->nq", self.space.boundary_tractions(edges, tractions)[..., 0], shapes)
            square += float(np.vdot((exact - mine) ** 2, weights))
        return float(np.sqrt(square))

    def moments(self, time: float) -> Array:
        """∫_e u B_i, in the axes of the edges, (edges, n, 2)."""
        return self._tested(self._edges.displacement(time))

    def moments_of(self, nodal: Vectors) -> Array:
        """∫_e v B_i for the nodal values of a P1 displacement, (2, vertices) → (edges, n, 2)."""
        return self._tested(np.einsum("den,eq->dnq", nodal[:, self.space.mesh.facets], self._along))

    def errors(self, state: DualState, nodal: Vectors, primal_stress: Tensors) -> tuple[float, ...]:
        """Norms of errors and of what they are relative to, in the order in which ``measure`` names them."""
        stress, time, moments = state.stress, state.time, self.moments(state.time)
        return (
            *self.stress(time, stress.values),
            *self.strain(time, state.strain),
            self.pressure(time, stress.tractions),
            self.norm(stress.values - primal_stress),
            self.mean_square(stress.moments - moments),
            self.mean_square(stress.moments - self.moments_of(nodal)),
            self.mean_square(moments),
        )

    def _tested(self, u: Vectors) -> Array:
        turned = np.einsum("nij,jnq->inq", self.space.frames, u)
        return np.einsum("inq,aq,n->nai", turned, self._moments, self.space.lengths, optimize=True)

    def mean_square(self, moments: Array) -> float:
        """(Σ_T Σ_{e ⊂ ∂T} |T|/3 mean_e |m|²)^½ for the functions m on the edges with these moments."""
        means = moments / self.space.lengths[:, None, None]
        inverse = np.linalg.inv(self._moments @ self._shapes.T)
        return float(np.sqrt(np.einsum("nad,ab,nbd,n->", means, inverse, means, self._share)))


class Primal:
    """Problem 5.1 on the same mesh with the same time steps."""

    def __init__(self, solution: ExactSolution, space: StressSpace, steps: int) -> None:
        law, self.displacements = solution.law, Space(space.mesh, solution.body)
        assert isinstance(law.G, Linear)
        self.viscous, self.elastic = tensor_at(law.A, space.points), tensor_at(law.G, space.points)
        gauge = Gauge(solution, self.displacements)
        problem = SemiDiscrete.of(self.displacements, law, gauge.load, gauge.sample(0.0).interpolant)
        self.states = islice(velocities(problem, BDF2, steps), 1, None)

    def __next__(self) -> tuple[Vectors, Tensors]:
        """The next displacement at the vertices, and Aε(δu^h) + Gε(u^h) at the points of the stresses.

        (2, vertices) and (3, cells, Q), or (3, cells, 1) where the material is homogeneous.
        """
        state, velocity = next(self.states)
        rate, strain = (self.displacements.strain(u)[..., None] for u in (velocity, state.u))
        return self.displacements.nodal(state.u), act(self.viscous, rate) + act(self.elastic, strain)


def measure(experiment: StressExperiment) -> dict[str, float]:
    """The quantities of a row but for those of the mesh."""
    exact = Exact(experiment.solution, experiment.space)
    primal = Primal(experiment.solution, experiment.space, experiment.steps)
    coarse, found, drift = experiment.companion(), [], []
    for n, state in enumerate(experiment.march(), start=1):
        if n % 2 == 0:
            drift.append(exact.norm(next(coarse).stress.values - state.stress.values))
        found.append((*exact.errors(state, *next(primal)), inadmissible(experiment.space, state)))
    history = np.array(found).T
    error, best, size, strain, strained, pressure, gap, moved, beside, displaced, _ = root_mean_square(history)
    return {
        "stress": error / size,
        "stress_sup": history[0].max() / history[2].max(),
        "best": best / size,
        "strain": strain / strained,
        "pressure": pressure / size,
        "displacement": moved / displaced,
        "primal_stress": gap / size,
        "primal_displacement": beside / displaced,
        "admissibility": history[-1].max(),
        "time_share": float(root_mean_square(np.array(drift))) / error,
    }


def inadmissible(space: StressSpace, state: DualState) -> float:
    """What contradicts (2.4), (2.5) and continuity, over the largest traction."""
    tractions = state.stress.tractions
    total = np.zeros((len(space.lengths), *tractions.shape[2:]))
    np.add.at(total, space.edges, tractions)
    for _, edges in space.on(Kind.CLAMPED):
        total[edges] = 0.0
    for _, edges in space.on(Kind.LOADED):
        total[edges] -= state.loads.surface[edges]
    for _, edges in space.on(Kind.CONTACT):
        total[edges, :, 0] = np.maximum(total[edges, :, 0], 0.0)
    return float(abs(total).max() / abs(tractions).max())


def root_mean_square(history: Array) -> Array:
    """Over the last axis."""
    return np.sqrt(np.mean(history**2, axis=-1))


def row(experiment: StressExperiment, case: str, family: str, level: int) -> dict[str, Any]:
    """The row of an experiment."""
    space, steps = experiment.space, experiment.steps
    unknowns = 2 * (space.degree + 1) * (len(space.lengths) - sum(len(edges) for _, edges in space.on(Kind.CLAMPED)))
    place = {"case": case, "family": family, "level": level, "h": size(space.mesh), "steps": steps}
    return {**place, "unknowns": unknowns, **{name: float(value) for name, value in measure(experiment).items()}}


def measure_stresses(case: Case, family: MeshFamily, level: int, steps: int) -> dict[str, Any]:
    """The row of one (case, family, level)."""
    return row(StressExperiment.of(case.solution, family, level, steps), case.name, family.name, level)
