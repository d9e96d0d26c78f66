"""What no finite number of computations can test."""

from __future__ import annotations

from study.statements.shared.base import Listed


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
