"""(5.27): a bound of the residual R in V, with a term that is missing in the paper.

The bound is |R(s; v)| ≤ (‖u̇‖_{L∞(V)} + L ‖u‖_{L∞(V)} + ‖G(·, 0)‖_Q/√m_A + ‖f‖_{L∞(V)}) ‖v‖_V with L = L_G/m_A. It
follows from (5.13) term by term: |G ε(u)| ≤ |G(·, 0)| + L_G |ε(u)| and √m_A ‖ε(v)‖_Q ≤ ‖v‖_V. The paper prints the
bound without G(·, 0), although (3.2) allows any G(·, 0) ∈ Q. **Measured and judged** are two cases:

* *Exact solutions.* R(s; ·) is computed from its definition as a functional on V^h, with ‖R(s)‖² = RᵀM⁻¹R. Its largest
  norm over the times is divided by the bound. Predicted quotients are 1/20 to 1/2: the four norms are not attained
  together, and R is the work of the contact force, which is as large as the load where contact carries the load. In
  ``advance-recede`` the quotient is only 0.009, because nearly all of the load bends the body away from the foundation.
  So the window has no lower end. ``double-well`` has a G(·, 0) that is not zero.
* *A body at rest with a stress.* G is replaced by G(x, ε) − G(x, 0) + A ε(z) with z = −M⁻¹Nᵀμ and random μ > 0. There
  is no load and no initial displacement. Then u^h ≡ 0 solves Problem 5.1 if R(s; v) = (A ε(z), ε(v))_Q ≥ 0 on K^h, that
  is, if −R lies in the cone {Nᵀλ : λ ≥ 0}. R is not zero, but the printed bound is zero for every c, so it is wrong.
  With the term of G(·, 0) the bound holds: the quotient of ‖R‖ = ‖z‖_V and ‖A ε(z)‖_Q/√m_A is at most 1. It is at least
  √(m_A/‖A‖), because ‖A ε‖_Q ≤ √‖A‖ ‖ε‖_V.
"""

import math

import numpy as np

from manufactured.law import KelvinVoigt
from manufactured.tensors import Tensors
from study.fem.error_norm import ErrorNorm
from study.fem.space import Space, on_cells
from study.ledger.check import ROUNDING, identity, paper_claim
from study.ledger.quantities import values
from study.ledger.window import Window, at_most, positive_at_most
from study.solve.evolution import SemiDiscrete
from study.solve.factorisation import Cholesky
from study.statements.shared.base import EVOLVING, SEED, SOFTENING, ListedNumbers, Numbers, Setting, grid, with_h
from study.statements.shared.eigen import unloaded
from study.statements.shared.meshes import posed
from study.statements.shared.norms import Energies, dual_norm, midpoints
from study.statements.thm_4_2 import beyond

INSTANTS = 32
"""Number of times over which maxima of norms are taken."""
AT_REST = positive_at_most(1e-10, "0 up to rounding: u^h ≡ 0 is the solution, although the printed bound is 0")


class ResidualBound(ListedNumbers):
    """Compares the norm of the residual R with its bound.

    This is done for exact solutions, and for a body at rest with G(·, 0) ≠ 0, for which the printed bound is 0.
    """

    label = "(5.27)"
    claim = "|R(s; v)| ≤ c (‖u‖_{W^{1,∞}(0,T;V)} + ‖f‖_{L∞(0,T;V)} + ‖G(·, 0)‖_Q) ‖v‖_V, c and G(·, 0) explicit"
    checks = (
        paper_claim(
            "bound", "max_s ‖R(s)‖ / the bound, exact solution", values("bound"), positive_at_most(1.0, "proved")
        ),
        identity(
            "rest", "G(·, 0) = A ε(z): distance of −R from the contact forces / its size", values("rest"), AT_REST
        ),
        identity(
            "prestress",
            "G(·, 0) = A ε(z): ‖R‖ / (‖G(·, 0)‖_Q / √m_A)",
            values("prestress"),
            at_most(1 + ROUNDING, "proved"),
        ),
        identity(
            "attained",
            "‖R‖ / (‖G(·, 0)‖_Q / √m_A) over √(m_A/‖A‖), its least possible value",
            values("attained"),
            Window(1 - ROUNDING, np.inf, "over √(m_A/‖A‖)"),
        ),
    )
    quick = grid(("full-contact",), ("unstructured",), (8,))
    full = grid((*EVOLVING, "anisotropic", "hexagon", *SOFTENING), ("unstructured",), (8, 16))

    def measure(self, setting: Setting) -> Numbers:
        space, solution = posed(setting)
        problem = unloaded(space, solution.law)
        law = solution.law
        share = share_of_bound(Energies(solution, space), ErrorNorm(solution, space), problem, law)
        # The body at rest with the stress G(·, 0) = A ε(z).
        stress = prestress(space, problem, law)
        R = space.functional(stress)
        bound = np.sqrt(np.sum(space.volumes * stress**2) / law.A.ellipticity)
        of_bound = dual_norm(R, Cholesky(problem.M)) / bound
        least = np.sqrt(law.A.ellipticity / law.A.lipschitz)
        rest = beyond(-R, problem.N) / math.sqrt(R @ R)
        return with_h(space.h, {"bound": share, "rest": rest, "prestress": of_bound, "attained": of_bound / least})


def share_of_bound(energies: Energies, v_norm: ErrorNorm, problem: SemiDiscrete, law: KelvinVoigt) -> float:
    """Return the largest norm of the residual over time divided by its bound, for an exact solution.

    The residual is a functional on V^h.
    """
    riesz = Cholesky(problem.M)
    exact = energies.exact
    rows = []
    for time in midpoints(v_norm.space.body.T, INSTANTS):
        strain = exact.strain(time)
        rate = exact.strain_rate(time)
        load = v_norm.load(time)
        residual = energies.functional(exact.law.stress(rate, strain)) - load
        norms = [energies.product(field, field) ** 0.5 for field in (rate, strain)]
        rows.append((dual_norm(residual, riesz), *norms, dual_norm(load, riesz)))
    R, velocity, displacement, force = np.max(rows, axis=0)
    stress_at_zero = exact.law.G(0 * exact.strain(0.0))
    at_zero = np.sqrt(energies.work(stress_at_zero, stress_at_zero) / law.A.ellipticity)
    return float(R / (velocity + law.kappa * displacement + at_zero + force))


def prestress(space: Space, problem: SemiDiscrete, law: KelvinVoigt) -> Tensors:
    """Return the stress A ε(z) of random contact forces on the cells: z = −M⁻¹Nᵀμ with random μ > 0."""
    multipliers = np.random.default_rng(SEED).uniform(size=problem.N.shape[0])
    return on_cells(space, law).A(space.strain(-Cholesky(problem.M)(problem.N.T @ multipliers)))
