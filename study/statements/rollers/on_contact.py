"""Problem 5.1 for A = G, condensed to the vertices of Γ3.

As B = I in (4.2), M(u̇^h + u^h) + Nᵀλ = M(P_hu̇ + P_hu) + Nᵀπ with the projection P_h onto V^h in (·,·)_V and the nodal
forces π of the pressure p. With y = N u^h, g = N P_hu and S = (N M⁻¹ Nᵀ)⁻¹

    S(ẏ + y) + λ = S(ġ + g) + π,     y ≤ 0,   λ ≥ 0,   λ·y = 0,

Problem 5.1 in as many unknowns as Γ3 has vertices; a time scheme for one is a time scheme for the other. The solution
with p as a traction has λ = π: u^h_lin = P_hu + e^{−t}(Π^h u_0 − P_hu_0). What contact adds to it is z = M⁻¹Nᵀc,
c = S(y − y_lin), and

    ‖u^h − u^h_lin‖_V² = cᵀ N z = (y − y_lin)ᵀ S (y − y_lin).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sps

from manufactured.tensors import Array
from study.fem.material import form
from study.solve.evolution import SemiDiscrete
from study.solve.paths import path
from study.solve.signorini import Signorini
from study.solve.steps import step_size
from study.solve.tableau import MIDPOINT
from study.statements.contact_work.resolved import Resolved, pressing_on


@dataclass(frozen=True, eq=False)
class OnContact:
    """V^h and an exact solution with A = G, seen from Γ3.

    Attributes:
        at: V^h with integrals on a finer mesh.
    """

    at: Resolved

    @cached_property
    def M(self) -> sps.csc_array:
        """Of (·,·)_V, (dofs, dofs)."""
        return form(self.at.space, self.at.solution.law.A)

    @cached_property
    def condensed(self) -> Signorini:
        """M and N."""
        return Signorini(self.M, self.at.space.N)

    @cached_property
    def S(self) -> Array:
        """(N M⁻¹ Nᵀ)⁻¹, (m, m)."""
        inverse = np.linalg.inv(self.condensed.W)
        return (inverse + inverse.T) / 2

    def strained(self, time: float) -> Array:
        """(u(t), ·)_V on V^h, (dofs,)."""
        gauge, law = self.at.gauge, self.at.solution.law
        return np.asarray(self.at.inclusion.T @ gauge.space.functional(law.A.matrix @ gauge.means(time)))

    def projected(self, time: float) -> Array:
        """P_hu(t), (dofs,)."""
        return self.condensed.factor(self.strained(time))

    def projected_gap(self, time: float) -> Array:
        """N P_hu(t), (m,)."""
        return self.condensed.gap(self.strained(time))

    @cached_property
    def start(self) -> Array:
        """Π^h u_0, (dofs,)."""
        space = self.at.space
        return space.interpolate(self.at.solution.at(space.mesh.p).displacement(0.0))

    @cached_property
    def press(self) -> Callable[[float], Array]:
        """t ↦ π, (m,)."""
        pressing = pressing_on(self.at)
        return lambda time: np.asarray(self.at.space.N @ pressing(time))


@dataclass(frozen=True, eq=False)
class Trajectories:
    """y and y_lin of the midpoint rule at t_0, …, t_steps, (steps + 1, m) each.

    Attributes:
        on: the problem.
        k: the time step.
        projected: g at the same times.
        forces: π in the middle of each step, (steps, m).
        contact, linear: y and y_lin.
    """

    on: OnContact
    k: float
    projected: Array
    forces: Array
    contact: Array
    linear: Array

    @classmethod
    def of(cls, on: OnContact, steps: int) -> Trajectories:
        """By the midpoint rule, which takes ġ and g in the middle of a step from its ends."""
        T, k = on.at.space.body.T, step_size(on.at.space.body.T, steps)
        projected = np.array([on.projected_gap(n * k) for n in range(steps + 1)])
        forces = np.array([on.press((n + 0.5) * k) for n in range(steps)])
        moved = (np.diff(projected, axis=0) / k + (projected[1:] + projected[:-1]) / 2) @ on.S

        def during(values: Array) -> Callable[[float], Array]:
            return lambda time: values[round(time / k - 0.5)]

        S, start = sps.csc_array(on.S), on.at.space.N @ on.start
        contact = SemiDiscrete(S, S, None, sps.csr_array(np.eye(len(start))), during(moved + forces), start, T)
        linear = replace(contact, N=contact.N[:0], load=during(moved))
        return cls(on, k, projected, forces, path(contact, MIDPOINT, steps), path(linear, MIDPOINT, steps))

    @property
    def steps(self) -> int:
        return len(self.forces)

    @cached_property
    def apart(self) -> Array:
        """‖u^h − u^h_lin‖_V² at all nodes, (steps + 1,)."""
        z = self.contact - self.linear
        return np.asarray(np.einsum("ni,ij,nj->n", z, self.on.S, z, optimize=True))

    def excess(self) -> float:
        """max_n ‖u^h − u^h_lin‖_V."""
        return math.sqrt(self.apart.max())

    def excess_at_end(self) -> float:
        """‖u^h − u^h_lin‖_V at T."""
        return math.sqrt(max(float(self.apart[-1]), 0.0))

    def displacement(self, n: int) -> Array:
        """u^h(t_n) = P_hu(t_n) + ((1 − k/2)/(1 + k/2))^n (Π^h u_0 − P_hu_0) + M⁻¹Nᵀc, (dofs,)."""
        on = self.on
        left = ((1 - self.k / 2) / (1 + self.k / 2)) ** n * (on.start - on.projected(0.0))
        forces = on.S @ (self.contact[n] - self.linear[n])
        return on.projected(n * self.k) + left + on.condensed.factor(on.at.space.N.T @ forces)
