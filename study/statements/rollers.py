"""Beyond the paper: without u̇(t) ∈ H² and σ_ν ∈ L^p, p > 1, order 1/2 is proved, and rollers suggest that it is sharp.

A *roller* is an exact solution in which a contact patch of width ℓ moves along Γ3 (``manufactured.multiscale.roller``).
On every mesh ℓ = 2h, so the patch is two cells wide, however fine the mesh is.

Proposition 5.4 assumes u̇(t) ∈ H². A theorem of this study (proof in paper/velocity.tex) proves the order s/2 for
u ∈ L¹(0,T;H^{1+s}), without a logarithm. Measured is another bound, proved in paper/companion.tex, for
u ∈ L^∞(0,T;H^{1+s}) ∩ W^{1,1}(0,T;V):

    ‖u − u^h‖_V ≤ e^{κT} (E_h + ‖u_0 − Π^hu_0‖_V + 2ΘM_h + (2D_h‖ϑ‖_{L¹(0,T)})^{1/2}).

The symbols are

* κ = L_G/m_A;
* E_h = sup_t ‖u − P_hu‖_V, the error of the best approximation; P_h is the projection onto V^h in (·,·)_V;
* M_h, the largest nodal error |(P_hu − Π^hu)_ν| at vertices of Γ3, over all times;
* J_h = sup_{Γ3} |u − Π^hu|, the largest interpolation error on Γ3 over all times, and D_h = 2M_h + J_h;
* ϑ = ∫_{Γ3} p, the total contact force;
* Θ = ‖Π^hθ‖_V, where θ is the normal ν times the distance from Γ1.

For s = 1, M_h is of order h. So this bound is of order 1/2, up to a logarithm.

**Measured** are

* both sides of the bound, with all constants. E_h, J_h and the error are evaluated at 33 times, M_h at all time nodes.
* the *excess*, the largest ‖u^h − u^h_lin‖_V over time. Here u^h_lin solves the linear problem in which the exact
  pressure p is given as a traction. The error of u^h_lin is of the order of E_h, so the excess is the part of the error
  that is due to contact. The midpoint rule with k = h/8 is used. With k/2 the excess must change by less than 1/50.
* the orders of E_h. A logarithm lowers them, because |u|_{H²} grows like |log ℓ|^{1/2}. This growth is measured on Γ3
  by the squared seminorm |q|²_{1/2} of the normal strain q. A step of height 1 in q adds 2 log 2 whenever ℓ is halved.

**Predictions** were made before the programs of this file existed. Prototypes had shown the order 1 with one diagonal,
and 1/2 with alternating diagonals and on shaken meshes (reasons in paper/experiments.tex). When the roller has passed a
vertex, a displacement of the size h remains there. If it is the same at all vertices, the excess is ~ h |log h|^{1/2}.
If neighbouring vertices keep different displacements, the excess is ~ h^{1/2}. So the predicted orders of the excess
are

* 1 less a logarithm, within [¾, 1.1], with one and with two diagonals, because all vertices of Γ3 have equal
  neighbourhoods;
* ½ ± 0.15 with alternating diagonals, where vertices are of two kinds. The meshes are not random;
* ½ ± 0.15 on shaken meshes for the mean over eight meshes, for n = 128 over four. The roller passes N ~ 0.7n vertices,
  whose contributions are nearly independent. So the excess has the relative standard deviation ~ ½ N^{-1/2}, and single
  orders scatter;
* ½ ± 0.3 on unstructured meshes;
* ½ with alternating diagonals also if the pressure (Q) or the gap (ω) is doubled;
* 1 ± 0.25 for patches that do not move, because displacements remain at few vertices only. The bound does not show
  this.

**Where the prediction was wrong.**

A patch that does not move showed the orders 0.9 and 2.3 on single shaken meshes. Its excess depends on the cells around
few vertices. Over eight shaken meshes the excess has a relative standard deviation of a third to a half on every level,
and its mean has the orders 0.97 and 1.06. The order on single shaken meshes is reported and not judged.

On unstructured meshes 0.75 is observed, at the edge of the prediction. Over six random meshes the mean has the orders
1.05 and 0.59 up to n = 64. The mesh generator moves points to the middle of their cells eight times, which makes
neighbourhoods on Γ3 nearly equal. The excess is then about as large as with one diagonal, and differences between
neighbours show from n = 64 on. With one such sweep instead of eight, the excess is twice as large at n = 64, and its
orders are 0.61 and 0.46. The prediction ignored both effects, so the order is reported and not judged. The orders of
E_h are 0.6 to 0.8 on these levels, where the logarithm still matters.

With one diagonal the orders of the excess from level to level are 0.84, 1.00 and 1.16, and the orders of M_h are 0.9,
1.4 and 1.8. Both quantities are maxima, whose places change from level to level:

* M_h occurs at the end s = 0 of Γ3, near which the roller starts, and falls like h² from the second level on. Near the
  patch and far from the ends of Γ3, nodal errors over h are 0.076, 0.076, 0.074 and 0.073, because for ℓ = 2h the
  solution near the patch looks the same on every level.
* The largest excess occurs at the start, at t ~ h, for n = 16, 32 and 64, but at T, behind the roller, for n = 128. At
  T the excess over h is 0.104, 0.093, 0.109 and 0.136. From the second level on this rises faster than |log h|^{1/2}.

So orders below 1 are expected on finer meshes; n = 256 would take minutes. The order over all levels is judged. The
orders at T and near the patch are reported.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
import scipy.sparse as sps
import sympy as sp

from manufactured.body import Kind
from manufactured.exact import ExactSolution
from manufactured.jet import Jet
from manufactured.multiscale import ROLLERS, FadingFace
from manufactured.multiscale.roller import START
from manufactured.tensors import Array
from study.fem.error_norm import FACET_POINTS
from study.fem.quadrature import facet_rule
from study.fem.seminorm import gram
from study.fem.space import Space, form
from study.ledger.check import ENOUGH, Check, Groups, accuracy, consequence, identity
from study.ledger.quantities import fitted, quotients
from study.ledger.window import Window, around, at_most
from study.solve.evolution import SemiDiscrete
from study.solve.paths import path
from study.solve.signorini import Signorini
from study.solve.steps import step_size
from study.solve.tableau import MIDPOINT
from study.statements.contact_work import Resolved, pressing_on
from study.statements.shared.base import Judged, ListedNumbers, Numbers, Setting, with_h
from study.statements.shared.meshes import posed
from study.statements.shared.norms import maximum

# Cases and meshes, chosen to separate meshes with equal neighbourhoods of contact vertices from all others.
ROLLER, PUSHING, STEEP, STANDING = ROLLERS
PLAIN = "one-diagonal", "criss-cross"
"""Mesh families on which the cells around all vertices of Γ3 are arranged alike."""
ALTERNATING = "alternating"
UNSTRUCTURED = "unstructured"
SEEDS = ("shaken", *(f"shaken-{seed}" for seed in range(1, 8)))
"""Random mesh families over which the measured excess is averaged. The finest level uses the first half of them."""
LEVELS = 16, 32, 64, 128
COARSE = LEVELS[:3]
"""Levels without the finest one, to save time.

They are used for rollers other than ROLLER, for meshes with two diagonals, and for half of the random meshes."""
HALVED = 32
"""The level at which the excess is also computed with half the time step."""
PER_H = 8
"""Number of time steps in which a roller moves by the length of one edge."""
SAMPLED_PARTS = 32
"""Number of time intervals at whose ends the error and the error of the best approximation, E_h, are measured."""


class OnContact:
    """The semi-discrete problem (Problem 5.1) for A = G, reduced to the normal displacements at the contact vertices.

    For A = G the operator B in (4.2) is the identity. Let P_h be the projection onto V^h in (·,·)_V and π the nodal
    forces of the pressure p. Then Problem 5.1 reads M(u̇^h + u^h) + Nᵀλ = M(P_hu̇ + P_hu) + Nᵀπ. With y = N u^h,
    g = N P_hu and S = (N M⁻¹ Nᵀ)⁻¹ it becomes

        S(ẏ + y) + λ = S(ġ + g) + π,     y ≤ 0,   λ ≥ 0,   λ·y = 0.

    This is again Problem 5.1, with as many unknowns as Γ3 has vertices, so the same time schemes solve it.

    Attributes:
        at: the P1 space V^h, with integrals on a finer mesh.
        M: the matrix of the inner product (·,·)_V, (dofs, dofs).
        condensed: the contact solver with a factorisation of M.
        S: the Schur complement (N M⁻¹ Nᵀ)⁻¹, (m, m).
        start: the interpolant Π^h u_0 of the initial displacement, (dofs,).
        places: the coordinates s of the m contact vertices along Γ3, (1, m).
    """

    def __init__(self, at: Resolved) -> None:
        space = at.space
        solution = at.solution
        self.at = at
        self.M = form(space, solution.law.A)
        self.condensed = Signorini(self.M, space.N)
        inverse = np.linalg.inv(self.condensed.W)
        self.S = (inverse + inverse.T) / 2
        self.start = space.interpolate(solution.at(space.mesh.p).displacement(0.0))
        (self._face,) = solution.faces
        (_, vertices) = space.contact[0]
        self.places = self._face.part.coordinates(space.mesh.p[:, vertices])[0]

    def functional(self, time: float) -> Array:
        """Return the functional (u(t), ·)_V of the exact displacement on V^h, (dofs,)."""
        v_norm = self.at.v_norm
        law = self.at.solution.law
        return np.asarray(self.at.inclusion.T @ v_norm.space.functional(law.A.matrix @ v_norm.means(time)))

    def projected(self, time: float) -> Array:
        """Return the projection P_hu(t) of the exact displacement onto V^h, (dofs,)."""
        return self.condensed.factor(self.functional(time))

    def gap(self, time: float) -> Array:
        """Return the exact gap w at the contact vertices, in the order of the rows of N, (m,)."""
        return self._face.gap_jet(self.places, time)[(0,)]


@dataclass(frozen=True, eq=False)
class Trajectories:
    """Normal displacements at the contact vertices over time, with contact (y) and without contact (y_lin).

    Both are computed by the midpoint rule. Without contact, the forces λ are the forces π of the exact pressure p, so
    that u^h_lin = P_hu + e^{−t}(Π^h u_0 − P_hu_0). Contact adds the displacement z = M⁻¹Nᵀc with c = S(y − y_lin), and

        ‖u^h − u^h_lin‖_V² = cᵀ N z = (y − y_lin)ᵀ S (y − y_lin).

    Attributes:
        on: the reduced problem.
        steps: the number of time steps.
        k: the time step.
        projected: the normal displacements g = N P_hu of the projection at the time nodes, (steps + 1, m).
        forces: the exact contact forces π in the middle of each step, (steps, m).
        contact, linear: y and y_lin at the time nodes, (steps + 1, m).
    """

    on: OnContact
    steps: int
    k: float
    projected: Array
    forces: Array
    contact: Array
    linear: Array

    @classmethod
    def of(cls, on: OnContact, steps: int) -> Trajectories:
        """Solve the reduced problem with and without contact.

        The values of ġ and g in the middle of a step are computed from g at its ends.
        """
        T = on.at.space.body.T
        k = step_size(on.at.space.body.T, steps)
        N = on.at.space.N
        pressing = pressing_on(on.at)
        projected = np.array([on.condensed.gap(on.functional(n * k)) for n in range(steps + 1)])
        forces = np.array([N @ pressing((n + 0.5) * k) for n in range(steps)])
        moved = (np.diff(projected, axis=0) / k + (projected[1:] + projected[:-1]) / 2) @ on.S

        def during(values: Array) -> Callable[[float], Array]:
            return lambda time: values[round(time / k - 0.5)]

        S = sps.csc_array(on.S)
        start = N @ on.start
        contact = SemiDiscrete(S, S, None, sps.csr_array(np.eye(len(start))), during(moved + forces), start, T)
        linear = replace(contact, N=contact.N[:0], load=during(moved))
        return cls(on, steps, k, projected, forces, path(contact, MIDPOINT, steps), path(linear, MIDPOINT, steps))

    def excess(self) -> Array:
        """Return the excess ‖u^h − u^h_lin‖_V, the distance of both discrete solutions, at time nodes, (steps + 1,)."""
        z = self.contact - self.linear
        return np.sqrt(np.maximum(np.einsum("ni,ij,nj->n", z, self.on.S, z, optimize=True), 0.0))

    def displacement(self, n: int) -> Array:
        """Return the discrete displacement at the n-th time node, (dofs,).

        It is u^h(t_n) = P_hu(t_n) + ((1 − k/2)/(1 + k/2))^n (Π^h u_0 − P_hu_0) + M⁻¹Nᵀc, where c = S(y − y_lin).
        """
        on = self.on
        left = ((1 - self.k / 2) / (1 + self.k / 2)) ** n * (on.start - on.projected(0.0))
        forces = on.S @ (self.contact[n] - self.linear[n])
        return on.projected(n * self.k) + left + on.condensed.factor(on.at.space.N.T @ forces)


def sides(found: Trajectories) -> Numbers:
    """Return the error, its bound, and the terms E_h, M_h, J_h of the bound, which the module docstring defines."""
    on = found.on
    at = found.on.at
    space = found.on.at.space
    distance = at.v_norm.distance
    finer = at.inclusion
    measured = []
    for n in range(0, found.steps + 1, max(1, found.steps // SAMPLED_PARTS)):
        time = n * found.k
        sample = at.v_norm.sample(time)
        projected = finer @ on.projected(time)
        error = distance(sample, finer @ found.displacement(n))
        measured.append((error, distance(sample, projected), interpolation_error(at.solution, space, time)))
    error, best, between = np.max(measured, axis=0)
    nodal = maximum(abs(g + on.gap(n * found.k)).max() for n, g in enumerate(found.projected))
    (part,) = space.body.of(Kind.CONTACT)
    (top,) = space.body.of(Kind.CLAMPED)
    theta = space.interpolate(np.multiply.outer(part.normal, top.coordinates(space.mesh.p)[1]))
    field = math.sqrt(theta @ (on.M @ theta))
    start = distance(at.v_norm.sample(0.0), finer @ on.start)
    force = found.k * found.forces.sum()
    right = best + start + 2 * field * nodal + math.sqrt(2 * (2 * nodal + between) * force)
    right *= math.exp(at.solution.law.kappa * space.body.T)
    return {"error": error, "right side": right, "E_h": best, "M_h": nodal, "J_h": between, "force": force}


def nodal_error_near_patch(found: Trajectories, width: float) -> float:
    """Return the largest nodal error |(P_hu − u)_ν| at vertices near the roller, for t ≥ T/2.

    Near means within 2ℓ of the middle of the contact patch. At these times the patch is far from all corners.

    Args:
        found: the solutions over time.
        width: the width ℓ of the roller.
    """
    (s,) = found.on.places
    errors = []
    for n in range(found.steps // 2, found.steps + 1):
        near = abs(s - float(START) - n * found.k + width / 2) <= 2 * width
        errors.append(abs(found.projected[n] + found.on.gap(n * found.k))[near])
    return float(np.concatenate(errors).max())


def interpolation_error(solution: ExactSolution, space: Space, time: float) -> float:
    """Return the largest interpolation error on Γ3 at one time, max |u − Π^h u|.

    It equals max |w − Π^h w| for the gap w, because u has no tangential component on Γ3.
    """
    (face,) = solution.faces
    rule = facet_rule(space.mesh, space.facets(face.part), face.part, (), FACET_POINTS)
    ends = face.part.coordinates(space.mesh.p[:, space.mesh.facets[:, rule.facets]])[0][0]
    nodal = face.gap_jet(ends[None], time)[(0,)]
    return float(abs(np.einsum("an,anq->nq", nodal, rule.shapes) - face.gap_jet(rule.s, time)[(0,)]).max())


# Criteria. Windows below and above 1 differ, because a logarithm can only lower an order.
EXCESS = "order of the excess ‖u^h − u^h_lin‖_V"
EQUAL = Window(0.75, 1.1, "1 up to a logarithm, as all vertices of Γ3 have equal neighbourhoods")
HALF = around(0.5, 0.15, "the roller leaves different displacements at neighbouring vertices; equal ones give 1")
ONE = around(1, 0.25, "displacements remain at few vertices only")
STEPS = at_most(0.02, "of the excess, so the excess does not come from time steps")
AT_THE_START = (
    "this quantity was chosen after the maximum over time had shown orders above 1: with one diagonal that maximum "
    "occurs at the start, on all meshes except the finest"
)
AT_AN_END = "this quantity was chosen after M_h had shown orders above 1: with one diagonal M_h occurs at an end of Γ3"
SMOOTHED = "the generator makes neighbourhoods nearly equal, and the order on a single mesh depends on chance"
NEAR_PATCH = "order of the nodal errors of P_hu next to the patch, one or two diagonals"
FEW_VERTICES = "the order depends on the cells around few vertices"
HALF_STEPS = "excess, k/2"
"""Name of the column with the excess for half the time step."""
FEW_MESHES = "eight meshes determine a standard deviation only up to a quarter"


def change_by_half_steps(levels: pd.DataFrame) -> Array:
    """Return the relative change of the excess ‖u^h − u^h_lin‖_V when the time step is halved.

    The excess is the distance of u^h from the solution of the linear problem with the exact pressure as a traction. The
    result is empty if no level was measured with half the time step.
    """
    both = levels.dropna()
    return abs(both[HALF_STEPS] / both["excess"] - 1).to_numpy()


def over_seeds(groups: Groups) -> pd.DataFrame:
    """Return mean and relative standard deviation of the excess ‖u^h − u^h_lin‖_V over random meshes, for each level.

    The random meshes are the mesh families ``SEEDS``. The table is empty if one of them was not measured.
    """
    if not set(SEEDS) <= set(groups):
        return pd.DataFrame()
    levels = pd.concat([groups[name] for name in SEEDS]).groupby("level")
    mean = levels["excess"].mean()
    spread = levels["excess"].std()
    table = pd.DataFrame({"h": levels["h"].mean(), "excess": mean, "scatter": spread / mean}).reset_index()
    return table.sort_values("h", ascending=False)


class Rollers(ListedNumbers):
    """Measures the error, its bound, and the distance to the solution of the linear problem, for moving rollers."""

    label = "beyond: rollers"
    claim = (
        "the error is O(h^{s/2}) if u ∈ L¹(0,T;H^{1+s}); for rollers of width 2h on irregular meshes the error that "
        "contact adds to the linear problem has the order 1/2"
    )
    outside_catalogue = True
    # The quick study leaves rollers out, because the orders only show on fine meshes. In the case ROLLER-n the roller
    # has the width 2h on level n.
    full = tuple(
        Setting(f"{kind}-{n}", family, n)
        for kind, families, levels in (
            (ROLLER, (PLAIN[0], ALTERNATING, UNSTRUCTURED, *SEEDS[:4]), LEVELS),
            (ROLLER, (PLAIN[1], *SEEDS[4:]), COARSE),
            (PUSHING, (ALTERNATING,), COARSE),
            (STEEP, (ALTERNATING,), COARSE),
            (STANDING, (PLAIN[0], ALTERNATING, SEEDS[0]), COARSE),
        )
        for family in families
        for n in levels
    )

    def cost(self, setting: Setting) -> float:
        """Return the expected run time in µs.

        The run time grows like n³ with the level n: there are about n² cells, and the number of time steps is
        proportional to n.
        """
        return 12.0 * setting.level**3

    def measure(self, setting: Setting) -> Numbers:
        space, solution = posed(setting)
        on = OnContact(Resolved(solution, space))
        steps = round(PER_H * setting.level * space.body.T)
        found = Trajectories.of(on, steps)
        excess = found.excess()
        numbers = {"excess": excess.max(), "excess at T": excess[-1], **sides(found)}
        if setting.family == PLAIN[0]:
            # The squared seminorm |q|²_{1/2} at the time T/2, for the linear interpolant of q on equal panels of Γ3.
            (face,) = solution.faces
            panels = 4 * setting.level
            assert isinstance(face, FadingFace)
            nodes = np.linspace(0, face.part.measure, panels + 1)
            q = Jet(sp.sympify(face.strain))(nodes[None], space.body.T / 2)[(0,)]
            numbers["|q|²"] = q @ gram(panels, 0.5) @ q
        if setting.case == f"{ROLLER}-{setting.level}" and setting.family in PLAIN:
            numbers["M_h beside"] = nodal_error_near_patch(found, 2 / setting.level)
        if setting.level == HALVED and setting.family not in SEEDS[1:]:
            numbers[HALF_STEPS] = Trajectories.of(on, 2 * steps).excess().max()
        return with_h(space.h, numbers)

    def by_case(self, rows: pd.DataFrame) -> Iterable[tuple[str, Groups]]:
        """Divide measured rows by kinds of rollers, which are the names of the cases without the level."""
        return super().by_case(rows.assign(case=rows["case"].str.rpartition("-")[0]))

    def checks_of(self, kind: str, groups: Groups) -> Judged:
        """Yield the criteria for a kind of roller, each with the measurements on the mesh families that it judges.

        The excess is the distance of u^h from the solution of the linear problem with the exact pressure as a traction.
        """

        def on(*families: str) -> Groups:
            # A missing family gets an empty table, so that the check is undecided.
            return {name: groups.get(name, pd.DataFrame()) for name in families}

        yield BOUND, groups
        if kind == STANDING:
            # The excess on a single shaken mesh depends on the cells around few vertices.
            still = f"{EXCESS}, patches that do not move"
            yield order("order-standing", still, ONE), {k: v for k, v in groups.items() if k not in SEEDS}
            single = f"{still}, single shaken meshes"
            yield order("order-standing-shaken", single, ONE, "excess", FEW_VERTICES), on(SEEDS[0])
            return
        yield order("order-alternating", f"{EXCESS}, alternating diagonals", HALF), on(ALTERNATING)
        if kind != ROLLER:
            return
        plain = on(*PLAIN)
        shaken = {SEEDS[0]: over_seeds(groups)}
        yield order("order-equal", f"{EXCESS}, one or two diagonals", EQUAL), plain
        at_end = f"{EXCESS} at T, one or two diagonals"
        yield order("order-end", at_end, EQUAL, "excess at T", AT_THE_START), plain
        yield (
            order(
                "nodal-beside",
                NEAR_PATCH,
                around(1, 0.1, "the solution near the patch looks alike for every ℓ = 2h"),
                "M_h beside",
                AT_AN_END,
            ),
            plain,
        )
        yield order("order-shaken", f"{EXCESS}, mean over shaken meshes", HALF), shaken
        unstructured = f"{EXCESS}, unstructured meshes"
        yield (
            order(
                "order-unstructured",
                unstructured,
                around(0.5, 0.3, "a single random mesh on every level"),
                "excess",
                SMOOTHED,
            ),
            on(UNSTRUCTURED),
        )
        yield (
            order(
                "scatter",
                "order of the relative standard deviation over shaken meshes",
                around(0.5, 0.35, "the vertices contribute like independent random numbers"),
                "scatter",
                FEW_MESHES,
            ),
            shaken,
        )
        yield (
            order(
                "best",
                "order of E_h = ‖u − P_hu‖_V, the error of the linear problem",
                Window(0.75, 1.1, "1 less a logarithm, as |u|_{H²} grows like |log ℓ|^{1/2}"),
                "E_h",
                "a logarithm changes the order from level to level",
            ),
            groups,
        )
        yield SHARE, groups
        yield TIME, {name: table for name, table in groups.items() if HALF_STEPS in table}
        yield GROWTH, on(PLAIN[0])


BOUND = identity("bound", "error / right side of the bound", quotients("error", "right side"), at_most(1.0, "proved"))
SHARE = consequence(
    "share",
    "largest excess / error",
    quotients("excess", "error"),
    Window(),
    if_missed="the study has no bound of this excess in V",
)
TIME = accuracy("time", "change of the excess with half the step", change_by_half_steps, STEPS)
# The growth from every level to the next must lie in the window; the last one is displayed.
GROWTH = accuracy(
    "step",
    "growth of |q|²_{1/2,Γ3} with every halving of ℓ",
    lambda table: np.diff(table["|q|²"].to_numpy()),
    around(2 * math.log(2), 0.15, "2 log 2 for a step of height 1; other powers of ℓ tend to 0 or infinity"),
    levels=ENOUGH,
    finest=True,
)


def order(key: str, quantity: str, window: Window, column: str = "excess", if_missed: str = "") -> Check:
    """Return the check of the fitted order of a column; with a reason ``if_missed`` nothing is claimed."""
    return consequence(key, quantity, fitted(column), window, levels=ENOUGH, if_missed=if_missed)
