"""Lists the checks of proved relations: relations that hold between computed numbers on every mesh.

Such a check can only fail if the program is wrong, so it is no evidence for a claim about convergence. Some tolerance
windows have a proved upper end and a predicted lower end. Their checks are not listed here, because they also fail if
the prediction is wrong.
"""

THEOREMS: dict[str, tuple[str, ...]] = {
    "Thm 2.2": ("bound", "monotone"),
    "Thm 2.2, (4.4)": ("bound",),
    "(3.3)": ("expansion", "membership"),
    "(3.6)": ("lower", "upper"),
    "Thm 4.2": ("displacement", "stress"),
    "(4.3), (5.5)": ("constant", "pointwise", "monotonicity"),
    "(5.20)–(5.21), (5.42)": ("constant-5.21", "constant-5.42"),
    "(5.21), T and L_G/m_A": ("bound", "time"),
    "(5.27)": ("bound", "prestress", "attained"),
    "Prop. 5.3": ("parallelogram",),
    "Prop. 5.4": ("parallelogram",),
    "(5.40), (5.41)": ("bound",),
    "beyond: nodal start": ("proved",),
    "beyond: work on edges": ("solution", "all", "constant"),
    "beyond: rollers": ("bound",),
    "beyond: O(h + k)": ("data", "solution", "constant", "midpoint"),
    "beyond: O(h + k), no potential": ("data-equal", "data-unequal", "solution-equal", "solution-unequal"),
    "beyond: landings": ("backward-euler-two", "midpoint-two"),
    "bound": ("above",),
    "enclosure": ("above", "below"),
}
"""Label ↦ keys of the checks that test proved inequalities or the parallelogram law."""
EXACT_QUOTIENTS: dict[str, tuple[str, ...]] = {
    "(3.1)": ("ellipticity", "bound"),
    "(3.2)": ("lipschitz",),
    "Thm 4.2": ("alone-displacement", "alone-stress"),
    "(4.12)": ("bounded", "unbounded"),
}
"""Label ↦ keys of the checks of quotients that are exactly 1 without any discretisation error: by linear algebra, or by
integrals of the exact solution alone. Their tolerance windows are wider than rounding errors."""
