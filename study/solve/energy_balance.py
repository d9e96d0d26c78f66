"""The energy balance of a computed motion: stored energy, dissipation, and work of contact and load."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.integrate import cumulative_trapezoid

from manufactured.law import Combined, Elasticity, LawError, Linear, NonSymmetric
from manufactured.tensors import Array, Tensors


@dataclass(frozen=True, eq=False)
class Power:
    """The stored energy of a body and the powers of all forces at one time.

    δu is the velocity.

    Attributes:
        stored: the stored energy ∫ W(ε(u)) with W' = G.
        elastic: the rate of the stored energy, (G ε(u), ε(δu))_Q.
        viscous: the dissipation (A ε(δu), ε(δu))_Q.
        contact: the power λ·N δu of the contact forces. It is nonzero only if a vertex comes into contact or loses it.
        load: the power F·δu of the loads, which is the sum of ``elastic``, ``viscous`` and ``contact``.
    """

    stored: float
    elastic: float
    viscous: float
    contact: float
    load: float


def density(G: Elasticity, strain: Tensors, stress: Tensors) -> Array:
    """Return the density W(ε) of the stored energy at points, (...).

    For a linear law W = ½ G ε·ε. For law (3.3) W = β/2 dist(ε, K)² = |G(ε)|²/(2β), because ½ dist² has the gradient
    ε − P_K ε. For a ``Combined`` G, W is the sum of both and of S·ε with the stress at rest S.

    Args:
        G: the elasticity operator.
        strain: the strain ε, (D, ...).
        stress: the elastic stress G(ε), (D, ...).

    Raises:
        LawError: G has no potential, so there is no stored energy.
    """
    if isinstance(G, NonSymmetric):
        raise LawError("G is not symmetric, so it has no stored energy; an energy balance needs a symmetric G")
    if isinstance(G, Combined):
        return G.energy(strain)
    if isinstance(G, Linear):
        return np.asarray(0.5 * np.sum(strain * stress, axis=0))
    return np.asarray(np.sum(stress**2, axis=0) / (2 * G.lipschitz))


def balance(times: Array, powers: Sequence[Power]) -> dict[str, Array]:
    """Return the energy balance as a dict of arrays over time, (times,) each.

    Args:
        times: the times, (times,).
        powers: the stored energy and the powers of all forces at these times.

    Returns:
        ``times``; ``stored``, the stored energy; ``dissipated``, ``contact`` and ``work``, the integrals over time of
        the dissipation, of the power of contact and of the power of the loads; and
        ``defect`` = stored − stored(0) + dissipated + contact − work. The defect is of second order in the time step.
        It is not zero, because the time scheme does not conserve energy exactly and powers are integrated by the
        trapezoidal rule.
    """
    stored, *rates = np.array([(power.stored, power.viscous, power.contact, power.load) for power in powers]).T
    dissipated, contact, work = cumulative_trapezoid(rates, times, initial=0.0)
    return {
        "times": times,
        "stored": stored,
        "dissipated": dissipated,
        "contact": contact,
        "work": work,
        "defect": stored - stored[0] + dissipated + contact - work,
    }
