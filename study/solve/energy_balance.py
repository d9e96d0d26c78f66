"""The balance of energy of a computed motion: stored energy, dissipation, contact and load."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from manufactured.law import Combined, Elasticity, LawError, Linear, NonSymmetric
from manufactured.tensors import Array, Tensors


@dataclass(frozen=True, eq=False)
class Power:
    """The energy at one time and the powers that change it, integrals over Ω.

    Attributes:
        stored: the energy ∫ W(ε(u)) with W' = G.
        elastic: its rate (G ε(u), ε(δu))_Q.
        viscous: the dissipation (A ε(δu), ε(δu))_Q.
        contact: λ·N δu; zero but where a vertex changes between contact and release.
        load: F·δu, the sum of the last three.
    """

    stored: float
    elastic: float
    viscous: float
    contact: float
    load: float


def density(G: Elasticity, strain: Tensors, stress: Tensors) -> Array:
    """W(ε), (...), from ε and G(ε), (D, ...) each.

    ½ G ε·ε of a linear law; β/2 dist(ε, K)² = |G(ε)|²/(2β) of law (3.3), as ½ dist² has the gradient ε − P_K ε; both
    and S·ε where G is combined of them.

    Raises:
        LawError: G has no potential, so that no energy is stored.
    """
    if isinstance(G, NonSymmetric):
        raise LawError("G is not symmetric and has no potential W; an energy balance needs a symmetric G")
    if isinstance(G, Combined):
        return G.energy(strain)
    if isinstance(G, Linear):
        return np.asarray(0.5 * np.sum(strain * stress, axis=0))
    return np.asarray(np.sum(stress**2, axis=0) / (2 * G.lipschitz))


def balance(times: Array, powers: Sequence[Power]) -> dict[str, Array]:
    """Energies at the ``times``, (times,) each.

    ``stored``, and what dissipation, contact and load have done since the first one: ``dissipated``, ``contact``,
    ``work``. Powers are integrated by the trapezoidal rule, so ``defect``, stored − stored(0) + dissipated + contact −
    work, is of the second order in the time step, and not zero: it is not what the scheme solves.
    """

    def since_start(name: str) -> Array:
        values = np.array([getattr(power, name) for power in powers])
        return np.concatenate([[0.0], np.cumsum(np.diff(times) * (values[1:] + values[:-1]) / 2)])

    stored = np.array([power.stored for power in powers])
    dissipated, contact, work = since_start("viscous"), since_start("contact"), since_start("load")
    return {
        "times": times,
        "stored": stored,
        "dissipated": dissipated,
        "contact": contact,
        "work": work,
        "defect": stored - stored[0] + dissipated + contact - work,
    }
