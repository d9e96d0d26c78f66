"""Checks of the conditions inside the body: strain (2.10), velocity (2.6), law (2.1) and equilibrium (2.2)."""

from collections.abc import Callable

import numpy as np
import sympy as sp

from manufactured.exact import ExactSolution, Fields
from manufactured.self_proof.complex_step import STEP, gradient, shifted_fields
from manufactured.self_proof.finding import Finding, at_times, norms, worst
from manufactured.symbols import pos
from manufactured.symbols import t as clock
from manufactured.tensors import Array, Points, basis, mandel

INTEGRATION = 1e-5
"""Largest accepted relative difference between the change of u and ∫u̇ dt.

It is much larger than rounding, because u̇ has kinks in time where a front passes.
"""
PANELS, FINER, MOST = 8, 4, 512
"""Numbers of panels of Gauss's rule in each eighth of [0, T]: the first, the factor to the next one, and the largest.

If T is long, it may contain many periods of a motion, and more panels are needed to resolve them.
"""


def kinematics(solution: ExactSolution, x: Points, instants: Array) -> list[Finding]:
    """Check that strains, velocities and stresses of the solution agree with derivatives of u by the complex step."""
    fields, shifted, at_points = solution.at(x), shifted_fields(solution, x), solution.law.at(x[..., None])

    def found(of: Callable[[Array], Array]) -> Array:
        return at_times(of, instants, x.shape[1])

    def law(t: Array) -> Array:
        """Return the stress from derivatives of u by the complex step."""
        rate, strain = (mandel(gradient(shifted, of, t)) for of in (Fields.velocity, Fields.displacement))
        return at_points.stress(rate, strain)

    strain, rate, velocity, stress = map(found, (fields.strain, fields.strain_rate, fields.velocity, fields.stress))
    by_step = found(lambda t: mandel(gradient(shifted, Fields.displacement, t)))
    rate_by_step = found(lambda t: mandel(gradient(shifted, Fields.velocity, t)))
    velocity_by_step = found(lambda t: fields.displacement(t + 1j * STEP).imag / STEP)
    return [
        worst("(2.10) ε(u) = sym ∇u", x, instants, norms(strain - by_step), norms(strain)),
        worst("(2.10) ε(u̇) = sym ∇u̇", x, instants, norms(rate - rate_by_step), norms(rate)),
        worst("(2.6) u̇ = ∂u/∂t", x, instants, norms(velocity - velocity_by_step), norms(velocity)),
        worst("(2.1) σ = Aε(u̇) + Gε(u)", x, instants, norms(stress - found(law)), norms(stress)),
    ]


def history(solution: ExactSolution, x: Points) -> Finding:
    """Check that u does not jump in time: over each eighth of [0, T] it must change by the integral of u̇.

    The number of panels of the integral is increased as long as the defect is too large and decreases. If u jumps, the
    defect does not decrease.
    """
    found, panels = _history(solution, x, PANELS), PANELS
    while not found.passes and panels < MOST:
        panels *= FINER
        before, found = found, _history(solution, x, panels)
        if not found.defect < before.defect / 2:
            break
    return found


def _history(solution: ExactSolution, x: Points, count: int) -> Finding:
    """Compare the change of u with the integral of u̇, for a number of panels in each eighth of [0, T]."""
    fields, T = solution.at(x), solution.body.T
    nodes, weights = np.polynomial.legendre.leggauss(4)
    ends = np.linspace(0, T, 9)
    u = at_times(fields.displacement, ends, x.shape[1])
    switches, defects = _switches(solution), []
    for start, stop, before, after in zip(ends[:-1], ends[1:], u[:-1], u[1:], strict=True):
        inner = [time for time in switches if start < time < stop]
        panels = np.unique([*np.linspace(start, stop, count + 1), *inner])
        half = np.diff(panels)[:, None] / 2
        instants = (panels[:-1, None] + half * (1 + nodes)).ravel()
        velocity = at_times(fields.velocity, instants, x.shape[1])
        defects.append(after - before - np.tensordot((half * weights).ravel(), velocity, axes=1))
    return worst("(2.6) u(t) = u_0 + ∫u̇ dt", x, ends[1:], norms(defects), norms(u), INTEGRATION)


def _switches(solution: ExactSolution) -> list[float]:
    """Return the times at which u̇ may jump: zeros of the arguments of truncated powers that depend on t only."""
    formulas = [f for face in solution.faces for f in (face.gap, face.exponents_in)]
    switches = {front.args[0] for f in formulas for front in f.atoms(pos) if front.args[0].free_symbols == {clock}}
    return [float(root) for switch in switches for root in sp.real_roots(switch, clock)]


def equilibrium(solution: ExactSolution, x: Points, instants: Array) -> Finding:
    """Check that the stress balances the body force, Div σ + f_0 = 0."""
    fields, shifted = solution.at(x), shifted_fields(solution, x)
    force = at_times(fields.body_force, instants, x.shape[1])
    slopes = at_times(lambda t: gradient(shifted, Fields.stress, t), instants, x.shape[1])
    divergence = [np.tensordot(basis(solution.law.dim), g, axes=([0, 2], [0, 1])) for g in slopes]
    scale = np.linalg.norm(slopes, axis=(1, 2))
    return worst("(2.2) Div σ + f_0 = 0", x, instants, norms(np.add(divergence, force)), scale)
