"""Rows of the ledger without a measurement.

They list misprints in the paper, claims that no computation can test, and formulas that need no check of their own."""

from __future__ import annotations

import math
from collections.abc import Sequence

import pandas as pd

from study.ledger.datafiles import DataFile
from study.ledger.numbered import NO_ROW, NOT_TESTED
from study.ledger.verdict import REPORTED, Verdict, row
from study.ledger.window import Window
from study.statements.shared.base import LISTED, Statement


class Listed(Statement):
    """Base class of statements that are lists of texts without data.

    Attributes:
        lines: tuples of a key, a place in the paper, the text at this place, and a comment.
    """

    file: DataFile = LISTED
    lines: Sequence[tuple[str, str, str, str]] = ()

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        """Return one row for each entry of ``lines``. The rows are reported only, because nothing is measured."""
        none, nothing = Window(math.nan, math.nan), (math.nan, (math.nan, math.nan), REPORTED)
        return [
            row(self, key, quantity, none, nothing, place, expected=comment)
            for key, place, quantity, comment in self.lines
        ]


class Misprints(Listed):
    """Lists places where the printed text of the paper is wrong, and how to read them."""

    label = "slips"
    claim = "misprints in the paper"
    lines = (
        ("zero-on-clamped-part", "(5.23)", "for all v ∈ H²(Ω)²",
         "read: for v ∈ H²(Ω)² with v = 0 on Γ1: Π^h v ∈ V^h vanishes there, and ‖·‖_V is a norm on V; rows of (5.23) "
         "have such v"),
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
         "read: with ‖G(·, 0)‖_Q in the sum: (3.2) lets G(·, 0) be any element of Q, and rows of (5.27) have one for "
         "which the printed bound is 0 and R is not 0"),
        ("root-in-5.28", "(5.28)", "‖u − v^h‖_{L∞(0,T;V)} in the infimum",
         "read: its square root, as in (5.33): (5.21) takes R^{1/2}"),
        ("left-side-of-5.31", "(5.31), first line", "left side is ‖u_ε − Π^h u_ε‖_{L²(0,T;V)}",
         "read: in L^∞(0,T;V), as (5.28) has it and (5.33) uses it; (5.30) gives this for the same right side"),
        ("norm-in-5.31", "(5.31), second line", "right side has ‖u̇_ε‖_{L∞(0,T;H²)}",
         "read: ‖u̇_ε‖_{L²(0,T;H²)}, as in (5.33): u_ε ∈ W^{1,2}(0,T;K ∩ C^∞) gives no more"),
        ("nodal-start", "after (5.35)", "(5.25) is satisfied if u_0^h = Π^h u_0 when u_0 ∈ C(Ω̄)",
         "false in the plane: rows of beyond: nodal start have a u_0 ∈ K ∩ C(Ω̄) for which ‖u_0 − Π^h u_0‖_V grows; "
         "u_0 ∈ H^{1+s}(Ω)², s > 0, is enough"),
        ("class-of-uniqueness", "Thm 4.1, 4.3", "there is a unique solution",
         "read: in the class (4.1), for which the proofs show it: without it u need not be the integral of u̇, and a u "
         "that jumps to another element of K at some time and goes on as the solution from there satisfies "
         "(3.12)–(3.15) almost everywhere, too"),
        ("norm-in-5.43", "(5.43), last line", "right side has ‖u_ν‖_{L¹(0,T;L²(Γ3,i))}",
         "read: the norm of L¹(0,T;H²(Γ3,i)), of (5.36)"),
        ("norm-of-residual", "(5.20), (5.21)", "R is taken in L¹(0,T;V)", "read: in L¹(0,T): R(t; v) is a number"),
    )  # fmt: skip


class Untested(Listed):
    """Lists claims of the paper about infinitely many functions or data, which computations cannot test."""

    label = NOT_TESTED
    claim = "statements that finitely many computations cannot test"
    lines = (
        ("existence", "Thm 2.2, 4.1, 4.3, 5.2", "a solution exists for all data with (3.1), (3.2), (3.4), (3.5)",
         "not tested: exact solutions are constructed, and programmes solved, for the data of the cases alone; that "
         "those solutions are the only ones is tested by different starts and solvers. Thm 4.2 asserts no existence: "
         "its rows compare solutions of both problems"),
        ("stress-in-Q1", "(4.1)", "σ ∈ L^∞(0,T;Q_1)",
         "not tested separately: Div σ = −f_0 by (4.11), so this follows from (3.4) and u ∈ W^{1,∞}(0,T;V), which is "
         "judged. The balance of σ^h with P f_0 is judged as well"),
        ("density", "(5.29), (5.33)–(5.35)", "W^{1,2}(0,T;K ∩ C^∞(Ω̄)²) is dense in W^{1,2}(0,T;K), and an ε for each h",
         "not tested: a claim about infinitely many functions. (5.29) follows from the density of K ∩ C^∞(Ω̄)² in K, "
         "which the paper cites, as u may be replaced by its linear interpolant in time. (5.33)–(5.35) follow from "
         "(5.28)–(5.32). "
         "What they are used for, convergence for rough u, is judged on rough cases"),
        ("one-constant", "(5.21), (5.42)", "one constant c serves all solutions and meshes",
         "not tested: the ratios of both sides are judged on the solutions and meshes of the study"),
    )  # fmt: skip


class WithoutRow(Listed):
    """Lists formulas of the paper that need no check, such as definitions and assumptions, each with the reason."""

    label = NO_ROW
    claim = "formulas that need no row: definitions, restatements, and steps towards other statements"
    lines = (
        ("problem", "Problem 2.1, (2.1)–(2.6)", "the mechanical problem",
         "a problem, not a claim: every exact solution is checked against it before it is used"),
        ("linear-law", "(2.7)", "the law with linear A and G",
         "an example, which most cases have; (3.1) and (3.2) are judged for each of their laws"),
        ("notation", "(2.8)–(2.13)", "products, spaces, strains, normal and tangential components",
         "definitions; a wrong product and a wrong strain are among the deliberate defects of (3.6)"),
        ("sets", "(2.15), (2.16)", "V and K", "definitions; the checks of K^h judge K^h = V^h ∩ K in the code"),
        ("inclusion", "(2.18)", "u̇ + Au ∋ f",
         "the inclusion of Thm 2.2; the checks of Thm 2.2 measure its solution for A = ∂ψ_K + B"),
        ("data", "(3.4)", "f_0 ∈ W^{1,1}(0,T;H) and f_2 ∈ W^{1,1}(0,T;L²(Γ2)^d)",
         "an assumption, used through (3.8), which is judged; literally it asks for smoothness in space that few "
         "moving fronts have"),
        ("start", "(3.5)", "u_0 ∈ K",
         "an assumption; exact solutions are checked for u(t) ∈ K, and Π^h u(t) ∈ K^h is judged from t = 0 on"),
        ("load", "(3.7)", "f(t) from f_0 and f_2", "a definition; (2.14) compares it with the load that is solved for"),
        ("variational", "Problem 3.1, Problem 3.2, (3.12)–(3.15)", "both variational problems",
         "problems, not claims: both are solved, and compared, under Thm 4.2"),
        ("operator", "(4.2), (5.4)", "B and B^h", "definitions of what is measured under (4.3) and (4.5)"),
        ("inequality", "(4.6)–(4.10), (5.1)", "Problem 3.1 as an inclusion and as an inequality",
         "one problem in other words by (4.8), which defines ∂ψ_K; nothing more is claimed than of Problem 3.1"),
        ("balance", "(4.11)", "Div σ + f_0 = 0",
         "(2.2): exact solutions are checked against it, (2.14) compares its sides, and Thm 4.2 judges it for σ^h on "
         "its own space"),
        ("work", "(4.28)–(4.30)", "(σ, ε(u))_Q = (f, u)_V from both sides",
         "the same equation as (4.14), judged there together with (3.11) for random stresses"),
        ("scheme", "Problem 5.1, (5.2), (5.3)", "the semi-discrete scheme",
         "a problem, not a claim: it is solved in several ways, (3.10) is asked of its solutions with random v^h, and "
         "they are computed again"),
        ("indicator", "(5.7), (5.8)", "the indicator of K^h and its subdifferential", "definitions, like (4.8) on V^h"),
        ("scheme-inclusion", "(5.10)", "the scheme as an inclusion", "(5.3) rewritten by (5.8)"),
        ("velocity", "(5.17)", "u − v^h as the integral of its velocity",
         "the fundamental theorem of calculus; its consequence (5.18) is judged"),
        ("segments", "(5.22)", "Γ3 as a union of segments", "notation; cases have up to three of them"),
        ("start-of-scheme", "(5.25)", "‖u_0 − u_0^h‖_V → 0",
         "an assumption: u_0^h = Π^h u_0 throughout, for which it is (5.23), as all u_0 are smooth enough; that the "
         "scheme starts there is among what is computed again. Rows of beyond: nodal start have a continuous u_0 for "
         "which this start violates it"),
        ("convergence", "(5.26)", "the error tends to 0", "the claim of Prop. 5.3, judged there"),
        ("both", "(5.28)", "(5.21) with (5.27) for R",
         "follows from (5.21) and (5.27), which are judged; the printed formula lacks a root"),
        ("smooth-interpolants", "(5.30)–(5.32)", "interpolation of a smooth u_ε",
         "a special case of (5.23), which is also judged for smooth fields"),
        ("first-order", "(5.37)", "the error is O(h)", "the claim of Prop. 5.4, judged there"),
        ("residual", "(5.38), (5.39)", "R from σ, and after Green's formula",
         "R is measured by (5.38) in the checks of (5.40); (5.39) is Green's formula (2.14) applied to (5.38)"),
        ("interpolation", "(5.43)", "interpolation in L²(0,T) and L¹(0,T)",
         "(5.23) and (5.24), judged at single times; their norms in time are terms in the rows of (5.21) and (5.42)"),
    )  # fmt: skip
