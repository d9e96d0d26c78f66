"""(4.4), (4.5), (5.6): ∂ψ_K + B + (L_G/m_A) I is maximal monotone, on V^h, for G and for −G.

Theorem 2.2 is applied to this operator. Only a law whose G is as little monotone as (3.2) allows needs (L_G/m_A) I, so
each law of the catalogue is taken with its G and with −G, which (3.2) allows as well. L = L_G/m_A.

* *Monotone.* Pairs of points of the graph are made without a solver: u ∈ K^h with some vertices of Γ3 at v_ν = 0, and
  g = M⁻¹Nᵀμ ∈ ∂ψ_K(u), (4.8), with random μ ≥ 0 at these. By itself ∂ψ_K is monotone, and with B or −B

      −(g − g' ± Bu ∓ Bu', u − u')_V ≤ L ‖u − u'‖_V².

  Predicted: of this bound 0.3 … 1 is used, as G ε·ε over L_G/m_A A ε·ε is 0.4 … 1 for the homogeneous laws of the
  catalogue, and as much less for others as L_G and m_A belong to different points: a tenth where layers differ by that
  factor. With a monotone B alone nothing would be used. Random pairs hardly use a G with both signs: 0.08 in
  ``softening``.
* *Maximal.* By Minty's theorem I + λ(∂ψ_K ± B) has to be onto V^h for a λ < 1/L. With λ = 1/(2L) the equation for any
  w is solved by u ↦ P(w ∓ λBu), a contraction with the factor 1/2, P the projection on K^h in ‖·‖_V. That
  w − u ∓ λBu lies in ∂ψ_K(u) is asked by nonnegative least squares. Predicted: round-off.
* *Its inverse J.* Monotonicity with ω is ‖Jw − Jw'‖_V ≤ (1 − λω)⁻¹ ‖w − w'‖_V: ω = L for −G, twice, and for G the
  ω that its law states, 0 where it is monotone. Large quotients are looked for with a w inside K^h, from d to the next
  one along J(w + d) − J(w). There J is (I ± λB)⁻¹. So with ‖B‖ = κ the part (1 − κ/2L)⁻¹/2 of the bound for −G is used,
  a half without B and 0.6 … 1 for homogeneous laws; for a monotone G at least (1 + 1/2)⁻¹ = 2/3.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from manufactured.tensors import Array
from study.fem.naming import resolve
from study.fem.space import Space
from study.ledger.measures import ROUNDING, every, largest
from study.ledger.window import Window, above_nothing, at_most
from study.solve.evolution import SemiDiscrete
from study.solve.factorisation import Cholesky
from study.solve.fixed_point import fixed_point
from study.solve.signorini import Signorini
from study.statements.constraint import with_trace
from study.statements.lipschitz import STRAINS
from study.statements.shared.base import SEED, ListedNumbers, Setting, with_h
from study.statements.shared.eigen import unloaded
from study.statements.shared.meshes import IRREGULAR, LAWS, named, place, space_of
from study.statements.shared.scope import REGULAR
from study.statements.thm_4_2 import beyond

PAIRS, CLIMBS = 8, 20
"""Random pairs of each size of strains, and steps of the search for large quotients of J."""
SETTLED, MOST = 1e-12, 80
"""Relative distance at which the iteration for J stops, and images it may take: 2⁻⁴⁰ = 1e-12."""
INSIDE = 1e3
"""How far, over the size of a step, a w lies inside K^h where quotients of J are looked for."""
NEVER = at_most(1e-12, "never positive but for rounding", low=-np.inf)
USED = Window(0.02, 1 + ROUNDING, "G or −G; where nothing was used (L_G/m_A) I would not be needed")
ONTO = above_nothing(1e-10, f"an iteration stopped at {SETTLED:g}")
GROWING = Window(0.5, 1 + ROUNDING, "a half is used without B")
SHRINKING = Window(0.6, 1 + ROUNDING, "B ≤ L leaves 2/3 at least")


class Resolvent(ListedNumbers):
    """The operator for G and −G, once for each law."""

    label = "(4.4), (4.5), (5.6)"
    claim = "∂ψ_K + B + (L_G/m_A) I is a maximal monotone operator"
    rules = (
        largest("normal-cone", "−(g − g', u − u')_V / sizes, g ∈ ∂ψ_K(u)", NEVER, "normal cone"),
        every("monotone", "largest −(g − g' ± (B u − B u'), u − u')_V / (L ‖u − u'‖_V²)", USED, "monotone"),
        largest("onto", "distance of w − u − λ (± B u) from ∂ψ_K(u), random w", ONTO, "onto, G", "onto, −G"),
        every("resolvent", "largest ‖J w − J w'‖_V / ‖w − w'‖_V over 1/(1 − λ L), −G", GROWING, "resolvent, −G"),
        every(
            "resolvent-monotone", "largest ‖J w − J w'‖_V / ‖w − w'‖_V over 1/(1 − λ ω), G", SHRINKING, "resolvent, G"
        ),
    )

    def places(self, full: bool) -> list[Setting]:
        laws = named(*LAWS)
        return (
            place(laws, IRREGULAR, (8,)) + place(laws, REGULAR, (), (2,)) if full else place(laws[:1], IRREGULAR, (8,))
        )

    def measure(self, setting: Setting) -> dict[str, float]:
        space, law = space_of(setting), resolve(setting.case).solution.law
        problem, L = unloaded(space, law), law.kappa
        normal, used = monotone(space, problem, L)
        found = {"normal cone": normal, "monotone": used}
        for name, sign in (("G", 1.0), ("−G", -1.0)):
            J = Inverse(problem, sign / (2 * L))
            found[f"onto, {name}"] = max(J.defect(w) for w in functions(space, np.random.default_rng(SEED)))
            omega = L if sign < 0 else law.growth
            found[f"resolvent, {name}"] = max(quotients(space, J)) * (1 - omega / (2 * L))
        return with_h(space.h, found)


def functions(space: Space, rng: np.random.Generator) -> Iterator[Array]:
    """Random functions with strains on both sides of any yield point."""
    for strain in STRAINS:
        for _ in range(PAIRS):
            v = rng.standard_normal(space.dofs)
            yield v * (strain / abs(space.strain(v)).max())


# Monotone.


def monotone(space: Space, problem: SemiDiscrete, L: float) -> tuple[float, float]:
    """The largest −(g − g', u − u')_V over its sizes, and of −(g − g' ± Bu ∓ Bu', u − u')_V over L ‖u − u'‖_V²."""
    rng, normal, used = np.random.default_rng(SEED), [], []
    points = zip(functions(space, rng), functions(space, rng), strict=True)
    for one, other in points:
        (u, force), (v, reaction) = in_graph(space, one, rng), in_graph(space, other, rng)
        step, change = u - v, force - reaction
        # A function has a representer in ‖·‖_V: products with it are those of the functional.
        normal.append(-(change @ step) / (np.linalg.norm(change) * np.linalg.norm(step)))
        elastic = problem.elastic(u) - problem.elastic(v)
        square = L * (step @ (problem.M @ step))
        used += [-((part + image) @ step) / square for part in (change, 0 * change) for image in (elastic, -elastic)]
    return max(normal), max(used)


def in_graph(space: Space, v: Array, rng: np.random.Generator) -> tuple[Array, Array]:
    """u ∈ K^h near v, and Nᵀμ of a g ∈ ∂ψ_K(u): μ ≥ 0 where v_ν would be positive, in the size of v."""
    normal = space.N @ v
    u = with_trace(space, v, np.minimum(normal, 0.0))
    return u, space.N.T @ np.where(normal > 0, rng.uniform(size=len(normal)) * abs(normal).max(), 0.0)


# Maximal, and the inverse.


@dataclass(frozen=True, eq=False)
class Inverse:
    """J = (I + λ(∂ψ_K + B))⁻¹.

    Attributes:
        problem: B, K^h and (·,·)_V.
        scale: λ, negative for −G.
    """

    problem: SemiDiscrete
    scale: float

    @cached_property
    def _project(self) -> Signorini:
        return Signorini(self.problem.M, self.problem.N)

    def __call__(self, w: Array) -> Array:
        """J w, by u ↦ P(w − λBu)."""
        M, given = self.problem.M, self.problem.M @ w

        def image(v: Array) -> Array:
            return self._project(given - self.scale * self.problem.elastic(v))[0]

        return fixed_point(image, w, lambda v: M @ v, SETTLED, MOST)[0]

    def defect(self, w: Array) -> float:
        """How far w − u − λBu is from ∂ψ_K(u) for u = Jw, relative to its terms: the cone, u ∈ K^h, complementarity."""
        problem, u = self.problem, self(w)
        terms = problem.M @ w, -problem.M @ u, -self.scale * problem.elastic(u)
        rest, size, length = np.sum(terms, axis=0), max(map(np.linalg.norm, terms)), np.linalg.norm(u)
        outside = (problem.N @ u).max() / length
        return float(max(beyond(rest, problem.N) / size, outside, abs(rest @ u) / (size * length)))


def quotients(space: Space, J: Inverse) -> Iterator[float]:
    """‖Jw − Jw'‖_V / ‖w − w'‖_V of random pairs, and of pairs inside K^h that are improved step by step."""
    rng, M = np.random.default_rng(SEED), J.problem.M

    def norm(v: Array) -> float:
        return float(np.sqrt(v @ (M @ v)))

    pairs = list(functions(space, rng))
    for one, other in zip(pairs[::2], pairs[1::2], strict=True):
        yield norm(J(one) - J(other)) / norm(one - other)
    free = -Cholesky(M)(J.problem.N.T @ np.ones(J.problem.N.shape[0]))
    for step in pairs[::PAIRS]:
        base = free * (INSIDE * norm(step) / norm(free))
        origin = J(base)
        for _ in range(CLIMBS):
            change = J(base + step) - origin
            yield norm(change) / norm(step)
            step = change * (norm(step) / norm(change))
