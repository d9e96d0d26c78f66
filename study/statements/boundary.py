"""(4.13): σν = f_2 on Γ2 and σ_τ = 0 on Γ3, which the discrete solution satisfies only in the limit h → 0.

The discrete stress σ^h = A ε(u̇^h) + G ε(u^h) is constant on cells, so its tractions do not satisfy (4.13). They do for
h → 0 in two senses. The orders are predicted for solutions with σ ∈ W^{1,∞}:

* In L²(Γ). ‖σ − σ^h‖_Q = O(h) alone gives order 1/2: by the scaled trace inequality the error on Γ is h^{−1/2} times
  the error in the cells along Γ, which may contain all of it. If the error is spread evenly, as W^{1,∞} estimates say
  for smooth solutions on quasi-uniform meshes, these cells hold h^{3/2}, and ‖σ^hν − σν‖ is of order 1, no more: σ^h is
  constant on the cell. For σ_τ alone, which ‖σ^hν − σν‖ bounds, the first-order term depends on how the triangles along
  Γ3 lie.
* Against smooth v with v = 0 on Γ1 and v_ν = 0 on Γ3. Then (4.13) reads (σ, ε(v))_Q = (f, v)_V, and since the scheme
  satisfies this for Π^h v,

      (σ^h, ε(v))_Q − (f, v)_V = (σ^h − σ, ε(v − Π^h v))_Q = O(h) · O(h):

  order 2, whatever the time step leaves in σ^h − σ.

The second half of the file makes the smooth fields v; other statements use them as well.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise

import numpy as np
import pandas as pd

from manufactured.body import Body, Kind, Part
from manufactured.exact.solution import Fields
from manufactured.tensors import Array, Points, Tensors, Vectors, mandel, traction
from study.fem.error_norm import DEGREE, FACET_POINTS, rules
from study.fem.quadrature import facet_rule
from study.fem.space import on_cells
from study.ledger.criterion import Observation, order, weighted
from study.ledger.window import around, between
from study.solve.tableau import MIDPOINT
from study.statements.shared.base import SEED, ListedNumbers, Setting, grid, with_h
from study.statements.shared.experiment import Experiment
from study.statements.shared.meshes import CELLS

INSTANTS = 8
"""Nodes of the midpoint rule for the norms in time."""
Field = Callable[[Points], Vectors]
"""A smooth field of displacements, analytic in x."""
FIELDS = 3
"""Number of smooth fields for each of the two conditions."""
STRONG = around(1, 0.25, "if the error is distributed evenly (‖σ − σ^h‖_Q = O(h) alone gives 1/2)")
SUPERCLOSE = between(1, 2, 0.25, 0, "2 where triangles along Γ3 are symmetric")
WEAK = around(2, 0.3, "O(h) in σ − σ^h times O(h) in v − Π^h v")


class NaturalConditions(ListedNumbers):
    """Measures how far the discrete stress violates both conditions at the midpoints of time steps."""

    label = "(4.13)"
    claim = "σν = f_2 on Γ2 and σ_τ = 0 on Γ3"
    rules = (
        order("loaded", "order of ‖σ^hν − f_2‖ in L²(0,T;L²(Γ2))", STRONG, "loaded"),
        order("contact", "order of ‖σ^hν − σ_ν ν‖ ≥ ‖σ^h_τ‖ in L²(0,T;L²(Γ3))", STRONG, "contact"),
        Observation(
            order("tangential", "order of ‖σ^h_τ‖ in L²(0,T;L²(Γ3))", SUPERCLOSE, "tangential"),
            "the row above bounds it, and its part of first order depends on the arrangement of the triangles along Γ3",
        ),
        weighted("loaded-weakly", "order of σν = f_2 on Γ2 against smooth v", WEAK, "loaded, weakly", CELLS),
        weighted("tangential-weakly", "order of σ_τ = 0 on Γ3 against smooth v", WEAK, "tangential, weakly", CELLS),
    )
    quick = grid(("advance-recede",), ("shaken",), (12, 24, 48))
    full = grid(
        ("advance-recede", "travelling-patch", "yield-and-release"),
        ("one-diagonal", "criss-cross", "shaken", "unstructured"),
        (12, 24, 48),
    )

    def measure(self, setting: Setting) -> dict[str, float]:
        # Each instant is then the midpoint of a step, because there is an odd number of steps for each instant.
        steps = INSTANTS * (2 * (setting.level // 8) + 3)
        setup = Experiment.at(setting, MIDPOINT, steps)
        return with_h(setup.space.h, tractions(setup))


def tractions(setup: Experiment) -> dict[str, float]:
    """Return the norms of the violations, relative to ‖σν‖ on Γ2 ∪ Γ3; the smooth fields have ‖v‖_V = 1."""
    body = setup.space.body
    loaded, contact = ([Side(setup, part) for part in body.of(kind)] for kind in (Kind.LOADED, Kind.CONTACT))
    against_load, against_contact = (weighted_strains(setup, f(body)) for f in (fields_on_loaded, fields_on_contact))
    squares = []
    for time, stress in discrete_stresses(setup):
        squares.append(
            {
                "tangential": sum(side.tangential(stress) for side in contact),
                "contact": sum(side.difference(stress, time) for side in contact),
                "loaded": sum(side.difference(stress, time) for side in loaded),
                "size": sum(side.size(time) for side in loaded + contact),
                "loaded, weakly": weak_defect(against_load, stress, time),
                "tangential, weakly": weak_defect(against_contact, stress, time),
            }
        )
    total = pd.DataFrame(squares).sum()
    return {name: float(np.sqrt(total[name] / total["size"])) for name in total.index if name != "size"}


def discrete_stresses(setup: Experiment) -> Iterator[tuple[float, Tensors]]:
    """Yield the instants t and σ^h(t) = A ε(δu_n) + G ε((u_n + u_{n−1})/2); each t is the midpoint of a step."""
    space, cells, k = setup.space, on_cells(setup.space, setup.solution.law), setup.problem.T / setup.steps
    each = setup.steps // INSTANTS
    for n, (before, after) in enumerate(pairwise(setup.scheme.march(setup.problem, setup.steps))):
        if n % each == each // 2:
            old, new = space.strain(before.u), space.strain(after.u)
            yield (before.time + after.time) / 2, cells.stress((new - old) / k, (new + old) / 2)


class Side:
    """One part of the boundary with quadrature points, the exact solution at them, and the cells next to the part."""

    def __init__(self, setup: Experiment, part: Part) -> None:
        mesh, facets = setup.space.mesh, setup.space.facets(part)
        self.part, self.cells = part, mesh.f2t[0, facets]
        self.rule = facet_rule(mesh, facets, part, (), FACET_POINTS)
        self.exact = setup.solution.at(part.point(self.rule.s))

    def tangential(self, stress: Tensors) -> float:
        """Return ∫ |σ^h_τ|² over the part."""
        forces = traction(stress[:, self.cells], self.part.normal)
        tangential = forces - np.multiply.outer(self.part.normal, self.part.normal @ forces)
        return float(np.sum(tangential**2 * self.rule.weights.sum(axis=1)))

    def difference(self, stress: Tensors, time: float) -> float:
        """Return ∫ |σ^hν − σν|² over the part."""
        forces = traction(stress[:, self.cells], self.part.normal)[..., None]
        return float(np.sum((forces - self.exact.surface_load(self.part, time)) ** 2 * self.rule.weights))

    def size(self, time: float) -> float:
        """Return ∫ |σν|² over the part."""
        return float(np.sum(self.exact.surface_load(self.part, time) ** 2 * self.rule.weights))


WeightedStrains = list[tuple[Array, Fields, Array]]
"""For each cell rule: its cells, the exact solution at its points, and w ε(v)/‖v‖_V for several fields v with the
quadrature weights w, (fields, D, cells, points)."""


def weighted_strains(setup: Experiment, fields: list[Field]) -> WeightedStrains:
    """Return the strains of smooth fields v, scaled to ‖v‖_V = 1, at the points of the cell rules."""
    found, squares = [], np.zeros(len(fields))
    for rule in rules(setup.solution, setup.space.mesh, DEGREE):
        exact, strains = setup.solution.at(rule.points), np.array([strain(v, rule.points) for v in fields])
        squares += [float(np.sum(exact.law.A(e) * e * rule.weights)) for e in strains]
        found.append((rule.cells, exact, strains * rule.weights))
    return [(cells, exact, strains / np.sqrt(squares)[:, None, None, None]) for cells, exact, strains in found]


def weak_defect(strains: WeightedStrains, stress: Tensors, time: float) -> float:
    """Return the sum of ((σ^h, ε(v))_Q − (f, v)_V)² over smooth fields v at one time.

    (f, v)_V is computed as (σ, ε(v))_Q, which is equal by Green's formula (2.14) with (2.2), (2.4) and (2.5).
    """
    works = [np.einsum("Icq,vIcq->v", stress[:, c, None] - exact.stress(time), e) for c, exact, e in strains]
    return float(np.sum(np.sum(works, axis=0) ** 2))


def fields_on_loaded(body: Body) -> list[Field]:
    """Return fields that vanish on Γ1 and Γ3."""
    rng, fixed = np.random.default_rng(SEED), planes(body, Kind.CLAMPED) + planes(body, Kind.CONTACT)
    return [vanishing(waves(body, rng), fixed) for _ in range(FIELDS)]


def fields_on_contact(body: Body) -> list[Field]:
    """Return fields that vanish on Γ1 and are tangential on one plane of Γ3 and zero on its other planes."""
    rng, clamped, contact = np.random.default_rng(SEED), planes(body, Kind.CLAMPED), planes(body, Kind.CONTACT)

    def field(part: Part, along: Field, inside: Field) -> Field:
        others, tangents = [other for other in contact if other is not part], part.frame[:, :-1]

        def tangential(x: Points) -> Vectors:
            return np.tensordot(tangents @ tangents.T, along(x), axes=1) + part.coordinates(x)[1] * inside(x)

        return vanishing(tangential, clamped + others)

    return [field(part, waves(body, rng), waves(body, rng)) for part in contact for _ in range(FIELDS)]


# Smooth fields.


def planes(body: Body, kind: Kind) -> list[Part]:
    """Return one part of the given kind for each line or plane in which such parts lie."""

    def same(a: Part, b: Part) -> bool:
        return np.allclose(a.normal, b.normal) and np.allclose(a.normal @ (a.start - b.start), 0)

    parts = body.of(kind)
    return [part for i, part in enumerate(parts) if not any(same(part, other) for other in parts[:i])]


def distances(x: Points, parts: list[Part]) -> Array:
    """Return the product of the distances of the points to the planes of the given parts, (...)."""
    product: Array = np.ones(x.shape[1:])
    for part in parts:
        product = product * part.coordinates(x)[1]
    return product


def vanishing(field: Field, parts: list[Part]) -> Field:
    """Return the field times the distances to the planes of the given parts; it vanishes on these parts."""
    return lambda x: field(x) * distances(x, parts)


def waves(body: Body, rng: np.random.Generator) -> Field:
    """Return a random vector field cos(κ·x + c) with about half a wave across the body in each direction."""
    extent = body.vertices.max(axis=1) - body.vertices.min(axis=1)
    directions = rng.uniform(-np.pi, np.pi, (body.dim, body.dim)) / extent
    phases = rng.uniform(0, 2 * np.pi, body.dim)

    return lambda x: np.cos(np.tensordot(directions, x, axes=1) + phases.reshape((-1,) + (1,) * (x.ndim - 1)))


def strain(field: Field, x: Points, tiny: float = 1e-30) -> Tensors:
    """Return ε(v) at points x (d, ...), by the complex step, (D, ...)."""
    steps = [1j * tiny * unit.reshape((-1,) + (1,) * (x.ndim - 1)) for unit in np.eye(len(x))]
    return mandel(np.stack([field(x + step).imag / tiny for step in steps], axis=1))
