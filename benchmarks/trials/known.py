"""Problems whose data are formulas, as rough as one likes, and whose solution is known."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
import sympy as sp
from skfem import Mesh
from skfem.quadrature import get_quadrature
from skfem.refdom import RefTri
from sympy import Expr, Rational, cos, exp, pi

from manufactured import KelvinVoigt, Kind, Linear, polygon, pos, t
from manufactured.body import Body
from manufactured.compiled import function
from manufactured.data import Data
from manufactured.factor import x1, x2
from manufactured.tensors import Array
from study.bound.bounded import BoundedSolution, bounded_solution
from study.bound.trajectory import Computed, Refined
from study.fem.mesh import MeshFamily, OneDiagonal, Shaken, Unstructured
from study.fem.refining import refined
from study.solve.tableau import MIDPOINT

DEGREE = 8
"""Degree of the rule for errors, on cells as small as the details of the solution."""
REACH, SHARE, PLAIN = 5, 2.0, 12
"""Cells are at most 1/PLAIN long, and width/SHARE up to REACH widths from the centre of a bump."""


@dataclass(frozen=True)
class Feature:
    """A bump strength · exp(−|X − centre|²/width²) cos(2π frequency t) in one component."""

    centre: tuple[float, float]
    width: float
    frequency: float
    strength: float
    component: int

    @property
    def formula(self) -> Expr:
        a, b = map(sp.Float, self.centre)
        bump = exp(-((x1 - a) ** 2 + (x2 - b) ** 2) / sp.Float(self.width) ** 2)
        return sp.Float(self.strength) * bump * cos(2 * pi * sp.Float(self.frequency) * t)


@dataclass(frozen=True)
class Band:
    """strength · t (x − a)_+² (b − x)_+² in one component, for x = x1 or x2: loads have jumps and kinks at a and b."""

    direction: int
    ends: tuple[Rational, Rational]
    strength: float
    component: int

    @property
    def formula(self) -> Expr:
        x, (a, b) = (x1, x2)[self.direction], self.ends
        height = sp.Float(self.strength) / ((b - a) / 2) ** 4
        return height * t * pos(x - a, 2) * pos(b - x, 2)


def written_with_conditions(formula: Expr, rng: np.random.Generator) -> Expr:
    """Write each truncated power x_+^q of a formula in a random other way, equal to it for x ≠ 0.

    Many of the conditions compare terms that are equal wherever x < 0.
    """

    def written(x: Expr, q: Expr) -> Expr:
        power, larger, smaller = x**q, sp.Max(x, 0), sp.Min(x, 0)
        ways = [
            power * sp.Heaviside(x),
            power * sp.Heaviside(larger, 0),
            power * (1 + sp.sign(x)) / 2,
            sp.Piecewise((power, x > 0), (0, True)),
            sp.Piecewise((0, larger <= 0), (power, True)),
            sp.Piecewise((power, smaller >= 0), (0, True)),
            sp.Piecewise((0, sp.Eq(pos(x, 1), 0)), (power, True)),
            sp.Piecewise((power, sp.Ne(abs(x), -x)), (0, True)),
            sp.Piecewise((power, ~((larger <= 0) & (x < 1))), (0, True)),
            sp.Piecewise((0, (larger < 0) | sp.Eq(larger, 0)), (power, True)),
            sp.Piecewise((sp.Piecewise((power, x >= 0), (7, True)), larger > 0), (0, True)),
        ]
        if q > 0:
            ways += [larger**q, (-sp.Min(-x, 0)) ** q, ((x + abs(x)) / 2) ** q]
        return ways[int(rng.integers(len(ways)))]

    return formula.replace(pos, written)


@dataclass(frozen=True)
class Zone:
    """Contact in X1 < s, s = first + speed · t, that grows: on Γ3, X2 = 0, with ψ = press (s − X1)_+^4,

        u_2 = gap (1 + t) (X1 − s)_+^5,    ε_22 = −ψ,    ε_12 = ε_11 = 0,

    so that σ_22 = −(A_22 ψ̇ + G_22 ψ) ≤ 0 where u_2 = 0, and σ_22 = 0 elsewhere.
    """

    first: Rational
    speed: Rational
    gap: float
    press: float

    @property
    def front(self) -> Expr:
        return self.first + self.speed * t

    @property
    def displacement(self) -> tuple[Expr, Expr]:
        # The factor is 1 with its derivative 0 on Γ3, and 0 on Γ1.
        opening = sp.Float(self.gap) * (1 + t) * pos(x1 - self.front, 5)
        pressed = sp.Float(self.press) * pos(self.front - x1, 4)
        down = 1 - x2**2
        return -x2 * sp.diff(opening, x1) * down, (opening - x2 * pressed) * down


@dataclass(frozen=True, eq=False)
class Known:
    """u = that of a zone + X2² (1 − X2) g on the unit square, turned by an angle with sine and cosine in ℚ.

    The second part has u = 0 and σν = 0 on Γ3, and u = 0 on Γ1; so the sum solves the contact problem if A and G have
    no entry 23 in the directions of Γ3. f_0 and f_2 follow by SymPy.

    Attributes:
        local: A and G before the turn.
        g: two formulas of x1 and x2, which stand for X1 and X2, and t.
        features: the bumps in g.
        conditions: seed of the random ways in which truncated powers in the data are written; None for ``pos``.
    """

    local: KelvinVoigt
    g: tuple[Expr, Expr]
    features: tuple[Feature, ...] = ()
    zone: Zone | None = None
    turn: tuple[Rational, Rational] = (sp.Integer(1), sp.Integer(0))
    conditions: int | None = None

    @property
    def rotation(self) -> sp.Matrix:
        c, s = self.turn
        return sp.Matrix([[c, -s], [s, c]])

    @cached_property
    def body(self) -> Body:
        corners = np.array(self.rotation.tolist(), dtype=float) @ [[0, 1, 1, 0], [0, 0, 1, 1]]
        return polygon(list(zip(*corners, strict=True)), [Kind.CONTACT, Kind.LOADED, Kind.CLAMPED, Kind.LOADED])

    @cached_property
    def law(self) -> KelvinVoigt:
        c, s = map(float, self.turn)
        r = math.sqrt(2)
        # ε ↦ R ε Rᵀ in Mandel's components.
        Q = np.array([[c * c, s * s, -r * c * s], [s * s, c * c, r * c * s], [r * c * s, -r * c * s, c * c - s * s]])
        turned = (Q @ tensor.matrix @ Q.T for tensor in (self.local.A, self.local.G))
        return KelvinVoigt(*(Linear((matrix + matrix.T) / 2) for matrix in turned), self.local.name)

    @cached_property
    def u(self) -> list[Expr]:
        base = self.zone.displacement if self.zone else (sp.Integer(0), sp.Integer(0))
        before = sp.Matrix([b + x2**2 * (1 - x2) * g for b, g in zip(base, self.g, strict=True)])
        place = self.rotation.T * sp.Matrix([x1, x2])
        turned = self.rotation * before.subs({x1: place[0], x2: place[1]}, simultaneous=True)
        return list(turned)

    @cached_property
    def strain(self) -> list[Expr]:
        u = self.u
        return [sp.diff(u[0], x1), sp.diff(u[1], x2), (sp.diff(u[0], x2) + sp.diff(u[1], x1)) / sp.sqrt(2)]

    @cached_property
    def data(self) -> Data:
        A, G = (sp.Matrix(tensor.matrix.tolist()) for tensor in (self.law.A, self.law.G))
        strain = sp.Matrix(self.strain)
        a, b, c = A * sp.diff(strain, t) + G * strain
        stress = sp.Matrix([[a, c / sp.sqrt(2)], [c / sp.sqrt(2), b]])
        force = [-sp.diff(stress[i, 0], x1) - sp.diff(stress[i, 1], x2) for i in (0, 1)]
        loads = {number: list(stress * self.rotation * sp.Matrix([side, 0])) for number, side in ((1, 1), (3, -1))}
        start = [u.subs(t, 0) for u in self.u]
        if self.conditions is not None:
            written = partial(written_with_conditions, rng=np.random.default_rng(self.conditions))
            force, start = map(written, force), map(written, start)
            loads = {number: map(written, load) for number, load in loads.items()}
        return Data.formulas(self.body, self.law, [*force], {n: [*load] for n, load in loads.items()}, u0=[*start])

    @cached_property
    def _compiled(self):
        return function((x1, x2, t), self.strain)

    def error(self, computed: Computed, time: float) -> float:
        """‖u(t) − u_h(t)‖_V, on a refinement of the mesh of u_h with cells as small as the details of u."""
        mesh, inclusion = self._fine(computed.mesh)
        nodal = (inclusion @ computed.at(time).reshape(-1, 2)).T
        corners, values = mesh.p[:, mesh.t], nodal[:, mesh.t]
        F = np.moveaxis(corners[:, 1:] - corners[:, :1], 2, 0)
        gradient = np.moveaxis(values[:, 1:] - values[:, :1], 2, 0) @ np.linalg.inv(F)
        discrete = np.array(
            [gradient[:, 0, 0], gradient[:, 1, 1], (gradient[:, 0, 1] + gradient[:, 1, 0]) / math.sqrt(2)]
        )[..., None]
        points, weights = get_quadrature(RefTri, DEGREE)
        x = corners[:, 0, :, None] + np.einsum("nij,jq->inq", F, points)
        exact = np.array([np.broadcast_to(value, x.shape[1:]) for value in self._compiled(*x, time)])
        difference = exact - discrete
        scaled = np.einsum("n,q->nq", abs(np.linalg.det(F)), weights)
        return math.sqrt(float(np.einsum("Inq,IJ,Jnq,nq->", difference, self.law.A.matrix, difference, scaled)))

    def _fine(self, mesh: Mesh):
        R = np.array(self.rotation.tolist(), dtype=float)

        def wanted(corners: Array) -> Array:
            found = np.full(corners.shape[2], 1 / PLAIN)
            middles, sizes = corners.mean(axis=1), np.ptp(corners, axis=1).max(axis=0)
            for feature in self.features:
                away = np.linalg.norm(middles - (R @ feature.centre)[:, None], axis=0) - sizes
                near = away < REACH * feature.width
                found[near] = np.minimum(found[near], feature.width / SHARE)
            return found

        return refined(mesh, wanted)


@dataclass(frozen=True, eq=False)
class Trial:
    """A known problem, and how it is bounded."""

    known: Known
    level: int
    steps: int
    family: MeshFamily

    def bounded(self, data: Data | None = None) -> BoundedSolution:
        """u_h and its bounds; ``data`` are the same in another form."""
        found = data or self.known.data
        return bounded_solution(found, None, self.family, self.level, MIDPOINT, self.steps, Refined(0, 1))


def random_trial(seed: int, conditions: bool = False) -> Trial:
    """Laws, meshes, slopes of Γ3, zones, bumps down to a hundredth of a cell, up to a hundred periods a step.

    A and G are anisotropic, G from 0.01 to 100 times as large. One trial in three has no zone of contact. With
    ``conditions`` there is a band instead of bumps, kinks and jumps are written in many ways, and Γ3 is horizontal.
    """
    rng = np.random.default_rng(seed)
    level, steps = int(rng.integers(2, 5)), int(rng.integers(2, 5))
    A, G = _tensor(rng), Linear(10 ** rng.uniform(-2, 2) * _tensor(rng).matrix)
    plain = [sp.Float(round(float(rng.normal()), 3)) * (1 + x1 * t), sp.Float(round(float(rng.normal()), 3)) * t]
    features = tuple(_feature(rng, level, steps) for _ in range(0 if conditions else int(rng.integers(0, 3))))
    bands = tuple(_band(rng) for _ in range(1 if conditions else 0))
    for feature in (*features, *bands):
        plain[feature.component] += feature.formula
    zone = None if rng.random() < 1 / 3 else _zone(rng)
    turn = [(1, 0), (Rational(4, 5), Rational(3, 5)), (Rational(12, 13), Rational(-5, 13))][int(rng.integers(3))]
    family = (OneDiagonal(), Shaken(seed=seed), Unstructured(seed=seed))[int(rng.integers(3))]
    law = KelvinVoigt(A, G, "random")
    turn = (sp.Integer(1), sp.Integer(0)) if conditions else tuple(map(sp.sympify, turn))
    known = Known(law, tuple(plain), features, zone, turn, seed if conditions else None)
    return Trial(known, level, steps, family)


def _tensor(rng: np.random.Generator) -> Linear:
    """Symmetric and positive definite, without an entry 23."""
    B = rng.normal(size=(3, 3))
    C = B @ B.T + 0.3 * np.eye(3)
    C[[1, 2], [1, 2]] += abs(C[1, 2])
    C[1, 2] = C[2, 1] = 0.0
    return Linear(C)


def _feature(rng: np.random.Generator, level: int, steps: int) -> Feature:
    a, b = rng.uniform(0.15, 0.85, 2)
    return Feature(
        centre=(float(a), float(b)),
        width=float(10 ** rng.uniform(-2, 0)) / level,
        frequency=float(10 ** rng.uniform(-1, 2)) * steps,
        strength=float(rng.uniform(0.1, 2)),
        component=int(rng.integers(2)),
    )


def _band(rng: np.random.Generator) -> Band:
    first, width = int(rng.integers(0, 20)), int(rng.integers(10, 21))
    ends = Rational(first, 40), Rational(first + width, 40)
    return Band(int(rng.integers(2)), ends, float(rng.uniform(-1, 1)), int(rng.integers(2)))


def _zone(rng: np.random.Generator) -> Zone:
    first, speed = (Rational(int(rng.integers(1, 40)), 101) for _ in range(2))
    return Zone(first, speed, float(rng.uniform(0.5, 5)), float(rng.uniform(0.5, 5)))
