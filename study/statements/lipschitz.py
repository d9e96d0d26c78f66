"""(4.3) and (5.5): ‖B^h u − B^h v‖_V ≤ L_G/m_A ‖u − v‖_V for (B^h u, v)_V = (G ε(u), ε(v))_Q, on every mesh.

On V^h, B^h = M⁻¹G with the matrix M of (·,·)_V. For linear G the largest quotient is the largest absolute eigenvalue
of G against M. The most negative eigenvalue belongs to (4.4): B^h + ω I is monotone for no ω below its size. In
general large quotients are searched: from u along a direction d, the next direction is B^h(u + d) − B^h(u), scaled.
For a linear G this is the power method, and quotients rise.

L_G/m_A need not be the best constant, so that the row about it has no lower end for any law. Pointwise
|G ε·ε| ≤ κ A ε·ε, where κ is the largest absolute eigenvalue of A⁻¹G (with the derivative of G at no strain or at large
strains), and so ‖B‖ ≤ κ ≤ L_G/m_A. From below: a field that
oscillates fast inside Ω, v = a cos(n k·x) φ, has nearly the strains sym(a ⊗ k) of rank at most two, so that

    ‖B‖ ≥ κ_1 = max {|G τ·τ| / (A τ·τ) : τ = sym(a ⊗ k)}.

A plane body that is free on a part of Γ reaches κ also where κ belongs to τ = I: ε(v) is a multiple of I if v_1 + i v_2
is holomorphic, and e^{nz} decays from the boundary as fast as one likes. Space has no such fields, by Liouville's
theorem.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from manufactured.law import Indefinite, KelvinVoigt, Linear
from manufactured.tensors import Array, mandel, size
from study.fem.naming import resolve
from study.fem.space import Space
from study.ledger.criterion import BOUND, ROUNDING, finest
from study.ledger.criterion import largest as largest_of
from study.ledger.window import at_least, at_most
from study.solve.evolution import SemiDiscrete
from study.solve.factorisation import Cholesky
from study.statements.constitutive_law import derivative, points, tensors
from study.statements.shared.base import SEED, ListedNumbers, Setting, with_h
from study.statements.shared.eigen import largest, unloaded
from study.statements.shared.meshes import BODIES_WITH_LAWS, EVERY, named, place, space_of
from study.statements.shared.norms import maximum
from study.statements.shared.scope import REGULAR

STRAINS = (1e-2, 1.0, 1e2, 1e4)
"""Sizes of the strains of generated functions, on both sides of any yield point."""
PAIRS, CLIMBS = 10, 30
"""Random pairs of each size, and steps of the search for large quotients."""
LARGE = 1e6
"""Size of strains beyond any yield point."""
DIRECTIONS = 4000
"""Tensors sym(a ⊗ k) for κ_1."""
POINTWISE = at_most(1 + 1e-5, low=-math.inf)
"""With room, since κ comes from samples of x and of strains."""
NOT_VACUOUS = at_least(0.97, "on the finest level")
"""V^h resolves fields that oscillate over some cells, at n = 16 to three per cent."""


class Lipschitz(ListedNumbers):
    """The largest quotients of B^h, once for each law and body."""

    label = "(4.3), (5.5)"
    claim = "‖B u − B v‖_V ≤ L_G/m_A ‖u − v‖_V, on V^h with the same constant"
    rules = (
        largest_of("constant", "largest quotient / (L_G/m_A)", BOUND, "over the constant"),
        largest_of("pointwise", "largest quotient / κ", POINTWISE, "over the pointwise constant"),
        finest("waves", "largest quotient / κ_1", NOT_VACUOUS, "over the waves"),
        largest_of("monotonicity", "−(B u − B v, u − v)_V / ‖u − v‖_V² over L_G/m_A, (4.4)", BOUND, "monotonicity"),
    )

    def places(self, full: bool) -> list[Setting]:
        cases = named(*BODIES_WITH_LAWS)
        return place(cases, EVERY, (8, 16, 32), (2, 4)) if full else place(cases, REGULAR, (8, 16), (2,))

    def measure(self, setting: Setting) -> dict[str, float]:
        space, law = space_of(setting), resolve(setting.case).solution.law
        problem = unloaded(space, law)
        found = np.array(list(quotients(space, Operator(problem))))
        steepest, falling = found[:, 0].max(), -found[:, 1].min()
        if isinstance(law.G, Linear):
            steepest = maximum((steepest, largest(problem.reference, problem.M)))
        if isinstance(law.G, Indefinite):
            falling = maximum((falling, largest(-problem.reference, problem.M)))
            steepest = maximum((steepest, falling))
        bound, (kappa, waves) = law.kappa, pointwise(space, law)
        over = {"constant": bound, "pointwise constant": kappa, "waves": waves}
        values = {f"over the {name}": steepest / value for name, value in over.items()}
        return with_h(space.h, {**values, "monotonicity": falling / bound})


class Operator:
    """Computes quotients of B^h in ‖·‖_V."""

    def __init__(self, problem: SemiDiscrete) -> None:
        self.problem, self.riesz = problem, Cholesky(problem.M)

    def compare(self, base: Array, step: Array) -> tuple[float, float, Array]:
        """Return ‖B(u + d) − B(u)‖_V / ‖d‖_V, (B(u + d) − B(u), d)_V / ‖d‖_V² and B(u + d) − B(u)."""
        change = self.problem.elastic(base + step) - self.problem.elastic(base)
        image, square = self.riesz(change), step @ (self.problem.M @ step)
        return float(np.sqrt(max(change @ image, 0.0) / square)), float(change @ step / square), image


def quotients(space: Space, operator: Operator) -> Iterator[tuple[float, float]]:
    """Yield Lipschitz and monotonicity quotients of random pairs, and of pairs that are improved step by step."""
    rng = np.random.default_rng(SEED)

    def function(strain: float) -> Array:
        v = rng.standard_normal(space.dofs)
        return v * (strain / abs(space.strain(v)).max())

    for strain in STRAINS:
        for _ in range(PAIRS):
            yield operator.compare(function(strain), function(strain))[:2]
        for base in (np.zeros(space.dofs), function(strain)):
            step = function(strain)
            for _ in range(CLIMBS):
                quotient, product, image = operator.compare(base, step)
                yield quotient, product
                if quotient <= ROUNDING:
                    break
                step = image * (strain / abs(space.strain(image)).max())


def pointwise(space: Space, law: KelvinVoigt) -> tuple[float, float]:
    """Return (κ, κ_1) over the points of a mesh."""
    x, D, rng = points(space), size(space.dim), np.random.default_rng(SEED)
    large = tensors(rng, space.dim, x.shape[1])
    large *= LARGE / np.linalg.norm(large, axis=0)
    none = np.zeros((D, x.shape[1]))
    viscous = derivative(law.A.at(x), none)
    elastic = np.concatenate([derivative(law.G.at(x), strain) for strain in (large, none)])
    viscous = np.concatenate([viscous, viscous])
    root = np.linalg.inv(np.linalg.cholesky(viscous))
    stiffest = abs(np.linalg.eigvalsh(root @ elastic @ root.swapaxes(1, 2))).max(axis=1)
    there = int(stiffest.argmax())
    waves = mandel(np.einsum("in,jn->ijn", *rng.standard_normal((2, space.dim, DIRECTIONS))))
    energies = [np.sum(waves * (matrix[there] @ waves), axis=0) for matrix in (elastic, viscous)]
    return float(stiffest[there]), float(abs(energies[0] / energies[1]).max())
