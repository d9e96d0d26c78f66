"""The loads a stress of Σ^h balances, P f_0 and P f_2, and what the projection P leaves out of the data.

P is the L² projection: of f_0 onto polynomials of degree k − 1 on the thirds of cells, of f_2 onto polynomials of
degree k on the edges of Γ2, for stresses of degree k.
"""

from __future__ import annotations

from dataclasses import dataclass

from manufactured.tensors import Array


@dataclass(frozen=True, eq=False)
class Loads:
    """The loads of one time in Bernstein form.

    Attributes:
        force: coefficients of P f_0, (cells, 3 thirds, lower, 2).
        surface: coefficients of P f_2 on Γ2, zero on other edges, (edges, n, 2).
    """

    force: Array
    surface: Array

    def __add__(self, other: Loads) -> Loads:
        return Loads(self.force + other.force, self.surface + other.surface)

    def __rmul__(self, factor: float) -> Loads:
        return Loads(factor * self.force, factor * self.surface)


@dataclass(frozen=True, eq=False)
class Snapshot:
    """The data at one time, projected, with g = f_0 − P f_0 and Π the L² projection onto P_k(T)².

    Attributes:
        loads: P f_0 and P f_2.
        low_order: ‖Π g‖_T, (cells,).
        high_order: ‖g − Π g‖_T, (cells,).
        on_edges: ‖f_2 − P f_2‖_e, (edges,), zero off Γ2.
    """

    loads: Loads
    low_order: Array
    high_order: Array
    on_edges: Array
