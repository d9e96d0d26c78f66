"""(4.3) and (5.5): the elasticity operator B is Lipschitz with the constant L_G/m_A, on V and on every P1 space V^h.

B is defined by (Bu, v)_V = (G ε(u), ε(v))_Q, and B^h is its discrete form on V^h. **Measured** are the largest
quotients ‖B^h u − B^h v‖_V / ‖u − v‖_V. In matrices B^h = M⁻¹G, where M is the matrix of (·,·)_V. For linear G the
largest quotient is the largest absolute eigenvalue of G with respect to M. The most negative eigenvalue −c is used for
(4.4): B^h + ω I is monotone only for ω ≥ c. For nonlinear G large quotients are searched iteratively: after a step from
u in the direction d, the next direction is B^h(u + d) − B^h(u), scaled. For a linear G this search is the power method.

**Judged** are three quotients. L_G/m_A need not be the best constant, so the window of the quotient with it has no
lower end. Pointwise |G ε·ε| ≤ κ A ε·ε, where κ is the largest absolute eigenvalue of A⁻¹G (with the derivative of G at
zero strain or at large strains). So ‖B‖ ≤ κ ≤ L_G/m_A. There is also a lower bound of ‖B‖: a field v = a cos(n k·x) φ
that oscillates fast inside Ω has strains close to multiples of sym(a ⊗ k), a tensor of rank at most two, so

    ‖B‖ ≥ κ_1 = max {|G τ·τ| / (A τ·τ) : τ = sym(a ⊗ k)}.

A plane body with a free part of its boundary attains κ even if the eigenvector of κ is τ = I: ε(v) is a multiple of I
if v_1 + i v_2 is holomorphic, and e^{nz} decays arbitrarily fast away from the boundary. In 3D there are no such
fields, by Liouville's theorem.
"""

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
from study.statements.shared.meshes import EVERY, place, representing, space_of
from study.statements.shared.norms import maximum
from study.statements.shared.scope import REGULAR

STRAINS = (1e-2, 1.0, 1e2, 1e4)
"""Sizes of the strains of random functions, on both sides of the yield point of every law."""
PAIRS, CLIMBS = 10, 30
"""Number of random pairs of functions for each size of strains, and number of steps in each search."""
LARGE = 1e6
"""A size of strains beyond the yield point of every law."""
DIRECTIONS = 4000
"""Number of random tensors sym(a ⊗ k) over which the lower bound κ_1 of the norm of B is maximised."""
POINTWISE = at_most(1 + 1e-5, low=-math.inf)
"""Window of (largest Lipschitz quotient of B^h) / (its pointwise upper bound κ).

It ends a little above 1, because κ is computed from sample points and strains."""
NOT_VACUOUS = at_least(0.97, "on the finest level")
"""Window of (largest Lipschitz quotient of B^h) / (the lower bound κ_1 of the norm of B) on the finest level.

It begins at 0.97, because P1 functions at n = 16 resolve oscillating fields up to three per cent."""


QUOTIENT, KAPPA = "largest ‖B u − B v‖_V / ‖u − v‖_V", "the pointwise constant κ of A⁻¹G"


class Lipschitz(ListedNumbers):
    """Measures the Lipschitz constant of the discrete elasticity operator B^h, for pairs of a material law and a body.

    It is the largest quotient ‖B^h u − B^h v‖_V / ‖u − v‖_V that is found.
    """

    label = "(4.3), (5.5)"
    claim = "‖B u − B v‖_V ≤ L_G/m_A ‖u − v‖_V, on V^h with the same constant"
    rules = (
        largest_of("constant", f"{QUOTIENT}, over L_G/m_A", BOUND, "over the constant"),
        largest_of("pointwise", f"{QUOTIENT}, over {KAPPA}", POINTWISE, "over the pointwise constant"),
        finest("waves", f"{QUOTIENT}, over κ_1, the value for oscillating fields", NOT_VACUOUS, "over the waves"),
        largest_of("monotonicity", "−(B u − B v, u − v)_V / ‖u − v‖_V² over L_G/m_A, (4.4)", BOUND, "monotonicity"),
    )

    def places(self, full: bool) -> list[Setting]:
        cases = representing("body", "law", "body with law")
        return place(cases, EVERY, (8, 16, 32), (2, 4)) if full else place(cases, REGULAR, (8, 16), (2,))

    def measure(self, setting: Setting) -> dict[str, float]:
        space, law = space_of(setting), resolve(setting.case).solution.law
        problem = unloaded(space, law)
        found = np.array(list(quotients(space, problem)))
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


def compare(problem: SemiDiscrete, riesz: Cholesky, base: Array, step: Array) -> tuple[float, float, Array]:
    """Compare the values of the discrete elasticity operator B^h at u and at u + d, in the norm of V.

    Args:
        problem: the semi-discrete problem, which defines B^h and V.
        riesz: the factorisation of the matrix of (·,·)_V.
        base: u, (dofs,).
        step: d, (dofs,).

    Returns:
        The Lipschitz quotient ‖c‖_V / ‖d‖_V, the monotonicity quotient (c, d)_V / ‖d‖_V², and the change
        c = B^h(u + d) − B^h(u), (dofs,).
    """
    change = problem.elastic(base + step) - problem.elastic(base)
    image, square = riesz(change), step @ (problem.M @ step)
    return float(np.sqrt(max(change @ image, 0.0) / square)), float(change @ step / square), image


def random_function(space: Space, strain: float, rng: np.random.Generator) -> Array:
    """Return a random P1 function whose largest strain component has the given absolute value, (dofs,)."""
    v = rng.standard_normal(space.dofs)
    return v * (strain / abs(space.strain(v)).max())


def quotients(space: Space, problem: SemiDiscrete) -> Iterator[tuple[float, float]]:
    """Yield Lipschitz and monotonicity quotients of the discrete elasticity operator B^h.

    They come from random pairs of functions and from an iterative search for large quotients.
    """
    rng, riesz = np.random.default_rng(SEED), Cholesky(problem.M)
    for strain in STRAINS:
        for _ in range(PAIRS):
            base, step = random_function(space, strain, rng), random_function(space, strain, rng)
            yield compare(problem, riesz, base, step)[:2]
        for base in (np.zeros(space.dofs), random_function(space, strain, rng)):
            step = random_function(space, strain, rng)
            for _ in range(CLIMBS):
                quotient, product, image = compare(problem, riesz, base, step)
                yield quotient, product
                if quotient <= ROUNDING:
                    break
                step = image * (strain / abs(space.strain(image)).max())


def pointwise(space: Space, law: KelvinVoigt) -> tuple[float, float]:
    """Return the upper bound κ and the lower bound κ_1 of the norm of the elasticity operator B.

    Both are computed from the law at the vertices and cell centres of a mesh; the module docstring defines them.
    """
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
