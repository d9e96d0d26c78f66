"""(4.4), (4.5), (5.6): the operator ∂ψ_K + B + (L_G/m_A) I is maximal monotone, so Theorem 2.2 applies to it.

Here ψ_K is the indicator function of K, and B the elasticity operator of (4.2). The test is made on the P1 space V^h,
with L = L_G/m_A. The term L I is needed only if G is not monotone. Therefore each law of the catalogue is used with G
and with −G, which satisfies (3.2) as well.

* *Monotone.* For pairs of points (u, g) and (u', g') of the graph of ∂ψ_K

      −(g − g' ± Bu ∓ Bu', u − u')_V ≤ L ‖u − u'‖_V².

  The pairs are made without a contact solver: u ∈ K^h has v_ν = 0 at some vertices of Γ3, and by (4.8) g = M⁻¹Nᵀμ with
  random μ ≥ 0 at these vertices lies in ∂ψ_K(u). Without B the left side must not be positive. Predicted for the
  largest quotient of both sides:

  - 0.3 to 1 for homogeneous laws, because G ε·ε / ((L_G/m_A) A ε·ε) is 0.4 to 1 there;
  - less for other laws, because L_G and m_A belong to different points of the body: about a tenth where the moduli of
    two layers differ by a factor of ten;
  - 0.08 for ``softening``, because random pairs seldom find the directions in which G softens.

  If B were monotone for both signs, the quotient would be 0.
* *Maximal.* By Minty's theorem I + λ(∂ψ_K ± B) must map onto V^h for some λ < 1/L. For λ = 1/(2L) and random w the
  equation w ∈ u + λ(∂ψ_K(u) ± Bu) is solved by iterating u ↦ P(w ∓ λBu), where P is the projection onto K^h in ‖·‖_V.
  The map is a contraction with the factor 1/2. Nonnegative least squares then decides whether w − u ∓ λBu lies in
  ∂ψ_K(u). Predicted: yes, up to round-off.
* *Lipschitz resolvent.* Let J = (I + λ(∂ψ_K ± B))⁻¹ be the resolvent. If ∂ψ_K ± B + ωI is monotone, then

      ‖Jw − Jw'‖_V ≤ (1 − λω)⁻¹ ‖w − w'‖_V.

  For −G, ω = L, so the factor is 2. For G the law states the number ω, which is 0 for a monotone G. Large quotients are
  searched around a point w deep inside K^h, where J = (I ± λB)⁻¹, by a power iteration: the next step is
  J(w + d) − J(w). Predicted for the quotient over its bound:

  - for −G it is (1 − ‖B‖/(2L))⁻¹/2, which is 0.6 to 1 for homogeneous laws; without B it would be 1/2;
  - for a monotone G at least (1 + 1/2)⁻¹ = 2/3.
"""

from collections.abc import Iterator

import numpy as np

from manufactured.tensors import Array
from study.fem.naming import resolve
from study.fem.space import Space
from study.ledger.criterion import ROUNDING, every, largest
from study.ledger.window import Window, at_most, positive_at_most
from study.solve.evolution import SemiDiscrete
from study.solve.factorisation import Cholesky
from study.solve.fixed_point import fixed_point
from study.solve.signorini import Signorini
from study.statements.constraint import with_trace
from study.statements.lipschitz import STRAINS, random_function
from study.statements.shared.base import SEED, ListedNumbers, Setting, with_h
from study.statements.shared.eigen import unloaded
from study.statements.shared.meshes import IRREGULAR, named, place, representing, space_of
from study.statements.shared.norms import maximum, norm
from study.statements.shared.scope import REGULAR
from study.statements.thm_4_2 import beyond

PAIRS, CLIMBS = 8, 20
"""Number of random pairs of functions for each size of strains.

The second number is how many steps the search for large difference quotients of the resolvent makes."""
SETTLED, MOST = 1e-12, 80
"""Relative distance at which the iteration for the resolvent stops, and its largest number of steps.

Each step halves the distance, and 2⁻⁴⁰ = 1e-12."""
INSIDE = 1e3
"""Distance from the boundary of K^h at which large quotients of the resolvent are searched.

The unit is the length of a step of the search."""
NEVER = at_most(1e-12, "never positive, up to rounding", low=-np.inf)
USED = Window(0.02, 1 + ROUNDING, "G or −G; a value of 0 would mean that the term (L_G/m_A) I is not needed")
ONTO = positive_at_most(1e-10, f"an iteration stops at {SETTLED:g}")
GROWING = Window(0.5, 1 + ROUNDING, "half of the bound is reached even without B")
SHRINKING = Window(0.6, 1 + ROUNDING, "at least 2/3 of the bound is reached, because B ≤ L")
QUOTIENT = "largest ‖J w − J w'‖_V / ‖w − w'‖_V"


class Resolvent(ListedNumbers):
    """Tests whether the operator of the evolution problem is maximal monotone, up to a multiple of the identity.

    It is ∂ψ_K + B + (L_G/m_A) I, and is tested for each material law, with its elasticity G and with −G.
    """

    label = "(4.4), (4.5), (5.6)"
    claim = "∂ψ_K + B + (L_G/m_A) I is a maximal monotone operator"
    rules = (
        largest("normal-cone", "−(g − g', u − u')_V / sizes, g ∈ ∂ψ_K(u)", NEVER, "normal cone"),
        every("monotone", "largest −(g − g' ± (B u − B u'), u − u')_V / (L ‖u − u'‖_V²)", USED, "monotone"),
        largest("onto", "distance of w − u − λ (± B u) from ∂ψ_K(u), random w", ONTO, "onto, G", "onto, −G"),
        every("resolvent", f"{QUOTIENT} over 1/(1 − λ L), −G", GROWING, "resolvent, −G"),
        every("resolvent-monotone", f"{QUOTIENT} over 1/(1 − λ ω), G", SHRINKING, "resolvent, G"),
    )

    def places(self, full: bool) -> list[Setting]:
        if full:
            laws = representing("law")
            return place(laws, IRREGULAR, (8,)) + place(laws, REGULAR, (), (2,))
        return place(named("full-contact"), IRREGULAR, (8,))

    def measure(self, setting: Setting) -> dict[str, float]:
        space, law = space_of(setting), resolve(setting.case).solution.law
        problem, L = unloaded(space, law), law.kappa
        normal, used = monotonicity(space, problem, L)
        found = {"normal cone": normal, "monotone": used}
        for name, sign in (("G", 1.0), ("−G", -1.0)):
            J = Inverse(problem, sign / (2 * L))
            found[f"onto, {name}"] = maximum(J.defect(w) for w in random_functions(space, np.random.default_rng(SEED)))
            omega = L if sign < 0 else law.growth
            found[f"resolvent, {name}"] = maximum(lipschitz_quotients(space, J)) * (1 - omega / (2 * L))
        return with_h(space.h, found)


def random_functions(space: Space, rng: np.random.Generator) -> Iterator[Array]:
    """Return random P1 functions with strains on both sides of the yield point of every law."""
    return (random_function(space, strain, rng) for strain in STRAINS for _ in range(PAIRS))


def monotonicity(space: Space, problem: SemiDiscrete, L: float) -> tuple[float, float]:
    """Return how far ∂ψ_K and ∂ψ_K ± B are from monotone, over random pairs of points of their graphs.

    Let (u, g) and (u', g') be points of the graph of ∂ψ_K. For ∂ψ_K alone the violation is the largest
    −(g − g', u − u')_V, relative to the norms. For ∂ψ_K ± B it is the largest quotient of
    −(g − g' ± Bu ∓ Bu', u − u')_V and L ‖u − u'‖_V².
    """
    rng, normal, used = np.random.default_rng(SEED), [], []
    points = zip(random_functions(space, rng), random_functions(space, rng), strict=True)
    for one, other in points:
        (u, force), (v, reaction) = in_graph(space, one, rng), in_graph(space, other, rng)
        step, change = u - v, force - reaction
        # Functionals are applied to functions here, which saves the computation of Riesz representatives in V^h.
        normal.append(-(change @ step) / (np.linalg.norm(change) * np.linalg.norm(step)))
        elastic = problem.elastic(u) - problem.elastic(v)
        square = L * (step @ (problem.M @ step))
        used += [-((part + image) @ step) / square for part in (change, 0 * change) for image in (elastic, -elastic)]
    return maximum(normal), maximum(used)


def in_graph(space: Space, v: Array, rng: np.random.Generator) -> tuple[Array, Array]:
    """Return a random point of the graph of ∂ψ_K: a displacement u ∈ K^h near v, and contact forces in ∂ψ_K(u).

    The contact forces Nᵀμ have random μ ≥ 0 at the vertices where v would penetrate; u has u_ν = 0 there.

    Returns:
        u and Nᵀμ, (dofs,) each.
    """
    normal = space.N @ v
    u = with_trace(space, v, np.minimum(normal, 0.0))
    return u, space.N.T @ np.where(normal > 0, rng.uniform(size=len(normal)) * abs(normal).max(), 0.0)


class Inverse:
    """The resolvent J = (I + λ(∂ψ_K + B))⁻¹, computed by a fixed-point iteration.

    Args:
        problem: the semi-discrete problem, which defines B, K^h and the inner product of V.
        scale: λ. If it is negative, the resolvent is computed for −G and |λ|.
    """

    def __init__(self, problem: SemiDiscrete, scale: float) -> None:
        self.problem, self.scale = problem, scale
        self._project = Signorini(problem.M, problem.N)

    def __call__(self, w: Array) -> Array:
        """Return Jw, the resolvent applied to w.

        It is the fixed point of u ↦ P(w − λBu), where P is the projection onto K^h.
        """
        M, given = self.problem.M, self.problem.M @ w
        step = lambda u: self._project(given - self.scale * self.problem.elastic(u))[0]  # noqa: E731
        return fixed_point(step, w, lambda v: M @ v, SETTLED, MOST)[0]

    def defect(self, w: Array) -> float:
        """Return how far u = Jw is from a solution of w ∈ u + λ(∂ψ_K(u) + Bu), relative to the terms.

        The residual w − u − λBu must be in ∂ψ_K(u). The result is the largest of three violations: the distance of the
        residual from the cone of contact forces, the penetration of u, and the violation of complementarity.
        """
        problem, u = self.problem, self(w)
        terms = problem.M @ w, -problem.M @ u, -self.scale * problem.elastic(u)
        rest, size, length = np.sum(terms, axis=0), maximum(np.linalg.norm(term) for term in terms), np.linalg.norm(u)
        outside = (problem.N @ u).max() / length
        return maximum((beyond(rest, problem.N) / size, outside, abs(rest @ u) / (size * length)))


def lipschitz_quotients(space: Space, J: Inverse) -> Iterator[float]:
    """Yield quotients ‖Jw − Jw'‖_V / ‖w − w'‖_V of the resolvent.

    They come from random pairs, and from a power iteration inside K^h that searches large quotients.
    """
    problem = J.problem
    functions = list(random_functions(space, np.random.default_rng(SEED)))
    for one, other in zip(functions[::2], functions[1::2], strict=True):
        yield norm(problem, J(one) - J(other)) / norm(problem, one - other)
    free = -Cholesky(problem.M)(problem.N.T @ np.ones(problem.N.shape[0]))
    for step in functions[::PAIRS]:
        base = free * (INSIDE * norm(problem, step) / norm(problem, free))
        origin = J(base)
        for _ in range(CLIMBS):
            change = J(base + step) - origin
            yield norm(problem, change) / norm(problem, step)
            step = change * (norm(problem, step) / norm(problem, change))
