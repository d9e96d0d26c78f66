"""The remark after (5.35) is false in the plane: for u_0 ∈ V ∩ C(Ω̄), Π^h u_0 need not converge to u_0 in V.

The paper says that (5.25), ‖u_0 − u_0^h‖_V → 0, holds for the nodal interpolant u_0^h = Π^h u_0 if u_0 is continuous.
The following function is a counterexample on the unit square, for grids with n = 8, 16, 32, … cells along a side (proof
in paper/false_remark.tex): u_0 = v e_2 with

    v = Σ_{j≥3} a_j Σ_{c ∈ A_j} λ_j(|x − c|),   a_j = 2^{−j/2},   A_j = {2^{−j}(p, q) : p, q odd} ∩ Ω,

and the spikes λ_j(r) = min{1, log(R_j/r)/4^j} for r < R_j = 4^{−j}, λ_j(r) = 0 for larger r. The sum converges
uniformly and in H¹, and u_0 = 0 on the boundary, so that u_0 ∈ K ∩ C(Ω̄). On the grid with n = 2^i every point of A_j,
j ≤ i, is a vertex, so the interpolant has the value a_j there, although the spike is much narrower than a cell. ‖u_0‖_V
has a bound in closed form and Π^h u_0 is known exactly, so ‖Π^h u_0‖_V − ‖u_0‖_V is a lower bound of ‖u_0 − Π^h u_0‖_V
without quadrature.

Predicted before measuring, with the Lamé constants μ, λ of A:

* ‖Π^h u_0‖_V = ((3μ + λ)(n − 4))^{1/2} up to 5 %: the 4^{j−1} spikes of level j ≤ i interpolate to hat functions of the
  energy 6μ + 2λ times a_j², which have disjoint supports for one j, and Σ_j 2^{−j} 4^{j−1} = (n − 4)/2. Hats of
  different levels do not share an edge of the grid; spikes wider than a cell change values by 1/64 of a_j at most.
* ‖Π^h u_0‖_V is at least (5 m_A n/16)^{1/2}, which is proved; the predicted value is about twice as large.
* The lower bound of ‖u_0 − Π^h u_0‖_V grows from every level to the next, with orders in h between −1.5 and −1/2, since
  the constant ‖u_0‖_V is subtracted from a multiple of (n − 4)^{1/2}.
* On the finest grid it is at least three times ‖u_0‖_V, the error of the start u_0^h = 0.
"""

import math

import numpy as np

from manufactured.law import Linear
from manufactured.tensors import Array, Points, dyad
from study.fem.naming import resolve
from study.ledger.check import ENOUGH, consequence, identity
from study.ledger.quantities import finest, level_by_level, values
from study.ledger.window import Window, around, at_least, positive_at_most
from study.statements.shared.base import ListedNumbers, Numbers, Setting, grid, with_h
from study.statements.shared.eigen import unloaded
from study.statements.shared.meshes import space_of

FIRST = 3
"""The smallest level j of the spikes: the radius 4^{−j} is small compared with the distance 2^{−j} for j ≥ 3."""
DIRECTION = np.array([0.0, 1.0])
"""The direction e_2 of the initial displacement."""


class NodalStart(ListedNumbers):
    """Measures the norm of the interpolant Π^h u_0, and a lower bound of its error, for the counterexample u_0."""

    label = "beyond: nodal start"
    claim = "the remark after (5.35) is false: ‖u_0 − Π^h u_0‖_V grows like h^{−1/2} for a u_0 ∈ K ∩ C(Ω̄)"
    checks = (
        consequence(
            "size",
            "‖Π^h u_0‖_V / ((3μ + λ)(n − 4))^{1/2}",
            values("size / predicted"),
            around(1, 0.05, "spikes of u_0 interpolate to hat functions of known norm"),
        ),
        identity(
            "proved", "(5 m_A n/16)^{1/2} / ‖Π^h u_0‖_V", values("proved / size"), positive_at_most(1.0, "proved")
        ),
        consequence(
            "growth",
            "order in h of ‖Π^h u_0‖_V − ‖u_0‖_V ≤ ‖u_0 − Π^h u_0‖_V",
            level_by_level("error from below"),
            Window(-1.5, -0.5, "the error grows at least like h^{−1/2}; every consecutive order"),
            levels=ENOUGH,
            finest=True,
        ),
        consequence(
            "worse",
            "(‖Π^h u_0‖_V − ‖u_0‖_V) / ‖u_0‖_V",
            finest("error / start at 0"),
            at_least(3.0, "Π^h u_0 is a worse start than u_0^h = 0; finest grid"),
        ),
    )
    quick = grid(("full-contact",), ("one-diagonal",), (8, 16, 32, 64))
    full = grid(("full-contact",), ("one-diagonal", "alternating"), (8, 16, 32, 64, 128))

    def measure(self, setting: Setting) -> Numbers:
        space = space_of(setting)
        A = resolve(setting.case).solution.law.A
        # The grid has 2^i cells along a side. Spikes with j > i vanish at its vertices and do not change Π^h u_0.
        start = space.interpolate(np.multiply.outer(DIRECTION, spikes(space.mesh.p, setting.level.bit_length() - 1)))
        energy = start @ (unloaded(space, resolve(setting.case).solution.law).M @ start)
        size = math.sqrt(energy)
        bound = norm_of_start(A)
        hats = 2 * mean_energy(A) * (setting.level - 4)
        least = math.sqrt(5 * A.ellipticity * setting.level / 16)
        found = {"size / predicted": size / math.sqrt(hats), "proved / size": least / size}
        errors = {"error from below": size - bound, "error / start at 0": (size - bound) / bound}
        return with_h(space.h, found | errors)


def spikes(x: Points, last: int) -> Array:
    """Return the function v of the module docstring, a sum of spikes, at the vertices of a grid.

    Spikes of levels j > last are left out. They vanish at all vertices, because their radius is smaller than the
    distance of their centres from the vertices.

    Args:
        x: the vertices, (2, ...), with one value of v for each in the result, (...).
        last: the level of the grid, which has 2^last cells along a side.
    """
    total = np.zeros(x.shape[1:])
    for j in range(FIRST, last + 1):
        spacing = 2.0**-j
        # The ball around a spike lies in a square with sides 2^{1−j}, so only the nearest spike is non-zero at x.
        centres = spacing * (2 * np.floor(x / (2 * spacing)) + 1)
        r = np.linalg.norm(x - centres, axis=0)
        with np.errstate(divide="ignore"):
            total += 2 ** (-j / 2) * np.clip(np.log(4.0**-j / r) / 4**j, 0, 1)
    return total


def mean_energy(A: Linear) -> float:
    """Return the energy ∫ A ε(v e_2)·ε(v e_2) of a field v e_2 with a radial function v and ∫ |∇v|² = 1.

    The energy is ½ Σ_i A d_i·d_i with d_i = sym(e_i ⊗ e_2), which is (3μ + λ)/2 for an isotropic A.
    """
    directions = np.array([dyad(axis, DIRECTION) for axis in np.eye(2)])
    return float(np.einsum("iI,IJ,iJ->", directions, A.matrix, directions)) / 2


def norm_of_start(A: Linear) -> float:
    """Return an upper bound of the norm ‖u_0‖_V of the counterexample.

    It is the geometric series Σ_j a_j (4^{j−1} · 2π/4^j · ``mean_energy``)^{1/2} over the levels of the spikes.
    """
    return math.sqrt(math.pi / 2 * mean_energy(A)) * 2 ** (-FIRST / 2) / (1 - math.sqrt(0.5))
