"""What is measured of rollers, and where."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
import sympy as sp

from manufactured.body import Kind
from manufactured.exact import ExactSolution
from manufactured.jet import Jet
from manufactured.multiscale import ROLLERS, FadingFace
from manufactured.multiscale.roller import START
from manufactured.tensors import Array
from study.fem.gauge import FACET_POINTS
from study.fem.naming import resolve
from study.fem.quadrature import facet_rule
from study.fem.seminorm import gram
from study.fem.space import Space
from study.statements.contact_work.resolved import Resolved
from study.statements.rollers.on_contact import OnContact, Trajectories
from study.statements.shared.base import ListedNumbers, Setting, with_h
from study.statements.shared.places import space_of
from study.statements.shared.scope import Scope

LEVELS = 16, 32, 64, 128
COARSE = LEVELS[:3]
"""For controls, meshes with twice the cells and half of the random ones: the finest level takes most time."""
HALVED = 32
"""The level at which halves of the time steps are taken, too."""
SEEDS = ("shaken", *(f"shaken-{seed}" for seed in range(1, 8)))
"""Random meshes over which means are taken, on the finest level over the first half of them."""
PLAIN = "one-diagonal", "criss-cross"
"""Meshes on which all vertices of Γ3 have equal neighbourhoods."""
ALTERNATING, UNSTRUCTURED = "alternating", "unstructured"
INSTANTS = 32
"""Parts of [0, T] at whose ends errors and E_h are measured."""
PER_H = 8
"""Time steps to the time in which a roller passes an edge."""
ROLLER, PUSHING, STEEP, STANDING = ROLLERS


def named(kind: str, families: Sequence[str], levels: Sequence[int]) -> list[Setting]:
    """A kind of roller on meshes to which its widths belong."""
    return [Setting(f"{kind}-{n}", family, n) for family in families for n in levels]


class MeasuredRollers(ListedNumbers):
    """The excess of contact over the linear problem for rollers of the width 2h, and the theorem's bound."""

    label = "beyond: rollers"
    claim = (
        "u ∈ L^∞(0,T;H²) ∩ W^{1,1}(0,T;V) gives O(h^{1/2}) up to a logarithm, and what contact costs beside the linear "
        "problem is of this order for rollers of the width 2h on irregular meshes"
    )
    # Orders show on fine meshes only: left to the full study.
    full = (
        *named(ROLLER, (PLAIN[0], ALTERNATING, UNSTRUCTURED, *SEEDS[:4]), LEVELS),
        *named(ROLLER, (PLAIN[1], *SEEDS[4:]), COARSE),
        *named(PUSHING, (ALTERNATING,), COARSE),
        *named(STEEP, (ALTERNATING,), COARSE),
        *named(STANDING, (PLAIN[0], ALTERNATING, SEEDS[0]), COARSE),
    )

    def settings(self, scope: Scope) -> Sequence[Setting]:
        """Those of a study of the whole catalogue, to which rollers do not belong."""
        return self.places(scope.full) if scope.whole else []

    def cost(self, setting: Setting) -> float:
        """Time steps are as many as cells along a side."""
        return 12.0 * setting.level**3

    def measure(self, setting: Setting) -> dict[str, float]:
        solution, space = resolve(setting.case).solution, space_of(setting)
        on, steps = OnContact(Resolved.of(solution, space)), passing(space, setting.level)
        found = Trajectories.of(on, steps)
        numbers = {"excess": found.excess(), "excess at T": found.excess_at_end(), **sides(found)}
        if setting.family == PLAIN[0]:
            numbers["|q|²"] = seminorm(solution, 4 * setting.level)
        if setting in named(ROLLER, PLAIN, [setting.level]):
            numbers["M_h beside"] = nodal_error_beside(found, 2 / setting.level)
        if setting.level == HALVED and setting.family not in SEEDS[1:]:
            numbers["excess, k/2"] = Trajectories.of(on, 2 * steps).excess()
        return with_h(space.h, numbers)


def passing(space: Space, level: int) -> int:
    """Steps of about h/8."""
    return round(PER_H * level * space.body.T)


def sides(found: Trajectories) -> dict[str, float]:
    """Both sides of the theorem, with θ = dist(·, Γ1) ν and so Λ = 1, and what the right one is made of."""
    on, at, T = found.on, found.on.at, found.on.at.space.body.T
    times = {n: n * found.k for n in range(0, found.steps + 1, max(1, found.steps // INSTANTS))}
    samples = {n: at.gauge.sample(time) for n, time in times.items()}

    def furthest(v: Callable[[int], Array]) -> float:
        return max(at.gauge.distance(sample, at.inclusion @ v(n)) for n, sample in samples.items())

    best, error = furthest(lambda n: on.projected(times[n])), furthest(found.displacement)
    nodal = max(float(abs(g + gap(at, n * found.k)).max()) for n, g in enumerate(found.projected))
    between = max(interpolation(at.solution, at.space, time) for time in times.values())
    force, start = found.k * float(found.forces.sum()), at.gauge.distance(samples[0], at.inclusion @ on.start)
    law, field = at.solution.law, size_of_field(on)
    growth, work = math.exp(law.kappa * T), math.sqrt(2 * (2 * nodal + between) * force)
    right = growth * (best + start + 2 * field * nodal + work)
    return {"error": error, "right side": right, "E_h": best, "M_h": nodal, "J_h": between, "force": force}


def nodal_error_beside(found: Trajectories, width: float) -> float:
    """The part of M_h at vertices no further than 2ℓ from the middle of the patch for t ≥ T/2, far from all corners."""
    at, half = found.on.at, found.steps // 2
    (face,), (_, vertices) = at.solution.faces, at.space.contact[0]
    s = face.part.coordinates(at.space.mesh.p[:, vertices])[0][0]
    errors = [
        abs(found.projected[n] + gap(at, n * found.k))[abs(s - float(START) - n * found.k + width / 2) <= 2 * width]
        for n in range(half, found.steps + 1)
    ]
    return float(np.concatenate(errors).max())


def gap(at: Resolved, time: float) -> Array:
    """w at the vertices of Γ3 in the order of the rows of N, (m,)."""
    (face,), (_, vertices) = at.solution.faces, at.space.contact[0]
    return face.gap_jet(face.part.coordinates(at.space.mesh.p[:, vertices])[0], time)[(0,)]


def size_of_field(on: OnContact) -> float:
    """‖Π^h θ‖_V."""
    space = on.at.space
    (part,) = space.body.of(Kind.CONTACT)
    (top,) = space.body.of(Kind.CLAMPED)
    depth = top.coordinates(space.mesh.p)[1]
    theta = space.interpolate(np.multiply.outer(part.normal, depth))
    return math.sqrt(theta @ (on.M @ theta))


def interpolation(solution: ExactSolution, space: Space, time: float) -> float:
    """max_{Γ3} |u − Π^h u| = max |w − Π^h w|, as u_s = 0 there."""
    (face,) = solution.faces
    rule = facet_rule(space.mesh, space.facets(face.part), face.part, (), FACET_POINTS)
    ends = face.part.coordinates(space.mesh.p[:, space.mesh.facets[:, rule.facets]])[0][0]
    nodal = face.gap_jet(ends[None], time)[(0,)]
    return float(abs(np.einsum("an,anq->nq", nodal, rule.shapes) - face.gap_jet(rule.s, time)[(0,)]).max())


def seminorm(solution: ExactSolution, panels: int) -> float:
    """|q|²_{1/2} on Γ3 at T/2, of the interpolant on equal panels."""
    (face,) = solution.faces
    assert isinstance(face, FadingFace)
    nodes = np.linspace(0, face.part.measure, panels + 1)
    q: Array = Jet(sp.sympify(face.strain))(nodes[None], solution.body.T / 2)[(0,)]
    return float(q @ gram(panels, 0.5) @ q)
