"""What the symbols of the page mean, said where they stand: for each table, and for what is above charts."""

from __future__ import annotations

from study.ledger.verdict import FAILS, HOLDS, REPORTED, UNDECIDED

MEANINGS = {
    HOLDS: "the value lies in a window that was fixed beforehand",
    FAILS: "it lies outside of its window",
    UNDECIDED: "too little was measured to say; not a pass",
    REPORTED: "a number for which nothing is claimed: neither a pass nor a failure",
}
"""Of the verdicts, in a line each."""

_SOLUTION = {
    "u": "exact displacement",
    "u^h": "computed displacement",
    "h": "mesh size",
    "n": "cells along a unit length",
}
_ERROR = {
    "u, u^h": "exact and computed displacement",
    "h, n": "mesh size, cells along a unit length",
    "Π^h u": "u at the vertices, linear between them",
    "‖·‖_V": "(A ε(·), ε(·))^{1/2}, largest over time",
}
_STRESSES = {"σ": "exact stress", "σ^h": "computed stress", "‖·‖_Q": "L² norm of stresses"}

LETTERS = {
    "ledger": {
        "V^h, K^h, u^h": "displacements linear on each cell, those that do not enter the foundation, the solution",
        "Γ1, Γ2, Γ3": "where the body is clamped, loaded, may touch",
        "A, G": "viscosity and elasticity, σ = A ε(u̇) + G ε(u)",
        "(2.1) … (5.42)": "numbers of the paper",
    },
    "ends": {"low, high": "range of the value over mesh families and levels, or the interval of a fit"},
    "norms": _ERROR,
    "law": {
        "α, m": "exponents at a front c: gap (s − c)^α, pressure (c − s)^m",
        "H^{1+s}": "how smooth u is: s is then the order to expect",
        "A, G": "viscosity and elasticity, σ = A ε(u̇) + G ε(u)",
        "(3.3)": "a law with a yield limit",
    },
    "rates": _ERROR
    | {
        "dofs, steps": "unknowns, and steps in time",
        "order": "of the error before it: its logarithm over that of h, between two levels",
        "t": "when the error is largest",
        "time": "share of the error that halving the step in time would change",
    },
    "stresses": _STRESSES
    | {
        "u^h": "displacement from Problem 3.1 with the same steps",
        "σ(u^h)": "the stress of u^h",
        "t": "time",
        "order": "of σ^h, between two levels",
        "best possible": "error of the best stress that is linear on each cell",
        "multipliers": "displacement of the edges, which the stress problem finds",
        "time": "share that halving the step would change",
    },
    "equivalence": {
        "h": "mesh size",
        "displacements, stresses": "largest difference of Problems 3.1 and 3.2, relative",
        "allowed": "what the duality gap of the solver leaves open",
        "membership": "how far the displacement of Problem 3.2 enters the foundation",
    },
    "bounds": {
        "max error": "max_t ‖u − u_h‖_V, empty where u is not known",
        "≥, ≤": "ends of an interval that contains it",
        "upper / error, lower / error": "ends over the error, the worst of the second half of time",
        "∫ r": "residual of the law",
        "∫ η": "loads that the mesh cannot carry",
        "∫ c": "work of contact, each over time: the parts of the bound",
    },
}
"""Place on the page ↦ symbol ↦ meaning."""
