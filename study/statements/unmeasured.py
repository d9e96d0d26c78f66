"""Rows of the ledger about which nothing is measured: slips in the printed text, and what no computation can test."""

from __future__ import annotations

import math
from collections.abc import Sequence

import pandas as pd

from study.ledger.datafiles import DataFile
from study.ledger.verdict import REPORTED, Verdict, row
from study.ledger.window import Window
from study.statements.shared.base import LISTED, Statement


class Listed(Statement):
    """Rows of the ledger by themselves: (key, place in the source, quantity, what was made of it)."""

    file: DataFile = LISTED
    lines: Sequence[tuple[str, str, str, str]] = ()

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        """The rows, whatever was measured."""
        none, nothing = Window(math.nan, math.nan), (math.nan, (math.nan, math.nan), REPORTED)
        return [row(self, key, what, none, nothing, place, expected=made) for key, place, what, made in self.lines]


class Slips(Listed):
    """Places where the printed text of the source cannot be meant, and how they have to be read."""

    label = "slips"
    claim = "slips in the printed text"
    lines = (
        ("order-of-trace", "(5.24)", "right side reads c h |v|_{H²}",
         "read: c h² |v|_{H²}: the proof of Prop. 5.4 uses h², and h² is measured"),
        ("assumption", "Thm 5.2", "assumes (3.3)",
         "read: (3.1), (3.2), (3.4) and (3.5): (3.3) is an example of (3.2)"),
        ("name-of-solution", "Thm 5.2", "the semi-discrete solution is called u", "read: u^h"),
        ("boundary", "after (5.22)", "∂Ω is the intersection of Γ1, Γ2 and Γ3", "read: their union"),
        ("load-in-5.11", "(5.11)", "last term reads (f, v^h − u^h)_V",
         "read: (f, v^h − u)_V: the loads (f, u^h − u)_V of (5.1) and (f, v^h − u^h)_V of (5.3) add up to it, and "
         "(5.12), (5.13) use it; as printed, u = t f, u^h = t P f in V = R², V^h = R × {0} contradict it"),
        ("constant-in-5.14", "(5.14)", "𝓛_G ‖u − u^h‖_V ‖u − v^h‖_V ds and 𝓛_G ‖u − u^h‖_V² dt",
         "read: 𝓛_G/m_A for 𝓛_G in both, as ‖·‖_V carries A, and ds for dt"),
        ("residual-at-zero", "(5.27)", "|R(s; v)| ≤ c (‖u‖_{W^{1,∞}(0,T;V)} + ‖f‖_{L∞(0,T;V)}) ‖v‖_V",
         "read: with ‖G(·, 0)‖_Q in the sum: (3.2) lets G(·, 0) be any element of Q"),
        ("root-in-5.28", "(5.28)", "‖u − v^h‖_{L∞(0,T;V)} in the infimum",
         "read: its square root, as in (5.33): (5.21) takes R^{1/2}"),
        ("norm-in-5.31", "(5.31)", "right side has ‖u̇_ε‖_{L∞(0,T;H²)}",
         "read: ‖u̇_ε‖_{L²(0,T;H²)}, as in (5.33): u_ε ∈ W^{1,2}(0,T;K ∩ C^∞) gives no more"),
        ("norm-in-5.43", "(5.43), last line", "right side has ‖u_ν‖_{L¹(0,T;L²(Γ3,i))}",
         "read: the norm of L¹(0,T;H²(Γ3,i)), of (5.36)"),
        ("norm-of-residual", "(5.20), (5.21)", "R is taken in L¹(0,T;V)", "read: in L¹(0,T): R(t; v) is a number"),
    )  # fmt: skip


class Untested(Listed):
    """What the source says of infinitely many functions or data: it stands in the ledger without passing."""

    label = "not tested"
    claim = "statements that no finite number of computations can test"
    lines = (
        ("existence", "Thm 4.1, 4.3, 5.2", "a solution exists for all data with (3.1), (3.2), (3.4), (3.5)",
         "not tested: exact solutions are constructed, and programmes solved, for the data of the cases alone; that "
         "those solutions are the only ones is tested by different starts and solvers"),
        ("stress-in-Q1", "(4.1)", "σ ∈ L^∞(0,T;Q_1)",
         "not tested by itself: Div σ = −f_0 by (4.11), so it is (3.4) once u ∈ W^{1,∞}(0,T;V), which is judged, as is "
         "the balance of σ^h with P f_0"),
        ("density", "Prop. 5.3", "W^{1,2}(0,T;K ∩ C^∞(Ω̄)²) is dense in W^{1,2}(0,T;K)",
         "not tested: about infinitely many functions, cited in the source; what it is used for, convergence for rough "
         "u, is judged on rough cases"),
        ("one-constant", "(5.21), (5.42)", "one constant c serves all solutions and meshes",
         "not tested: the ratios of both sides are judged on the solutions and meshes of the study"),
    )  # fmt: skip
