"""Beyond the paper: errors of other people's contact codes on the same problems must agree with errors of this study.

A program may contain the same mistake as its author's test. Therefore contact codes of other people solved static
("frozen") problems of these cases. The problems are plain data (``shared.tasks``) with mesh, loads and exact solution.
The codes used their own assembly and contact algorithms; for FreeFEM this is a loop in its scripting language, as in
its documentation. ``make codes`` wrote their errors in V, which a script computes that imports only NumPy. Here the
errors of the same problems are measured with the quadrature and the solver of this study, and both are compared. In two
cases, solutions in time by the midpoint rule are compared as well; each step of a code starts from the result of its
previous step.

**Predictions.** Numbers of a task are rounded to 13 digits. This changes a strain by about 1e-13 ‖u‖/h, which is at
most 1e-11 of the error on these meshes. A code that imposes the contact condition at vertices by multipliers finds the
solution in K^h up to rounding of its linear solver. With a condition number like h^−2 this rounding is less than 1e-11.
So errors agree to 1e-10. The same holds for solutions in time, because time steps do not amplify perturbations. Kratos
imposes contact in the deformed configuration. Therefore its loads are multiplied by 1e-5: points then move by about
1e-5, and displacements change by about 1e-5 of their size. The first window for its errors was 1e-5; 5e-10 was
measured, and the window was narrowed.

**No copies.** A further check tests that no column of errors was copied from another code. Linear solvers of different
codes round differently. A task contains the solution in K^h with 14 digits. The distance of a code from it consists of
the missing digits, which are the same for all codes, and of the round-off of the code, about a thousandth of the
distance. So two codes agree by chance in the nine reported digits on one mesh in a million; copied columns agree on all
meshes. (The errors cannot be used for this test: in double precision they agree on up to three meshes of eight.)
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
import pandas as pd

from study.fem.naming import family_named, resolve
from study.ledger.codes import FROZEN, MADE, MARCH, NOT_EXPRESSED, OtherErrors
from study.ledger.verdict import BECAUSE, FAILS, HOLDS, NOWHERE, REPORTED, UNDECIDED, CheckKind, Found, Verdict, row
from study.ledger.window import Window, at_most
from study.statements.shared.base import REPORTED as OF_FILE
from study.statements.shared.base import ListedNumbers, Numbers, Setting, grid, with_h
from study.statements.shared.tasks import FROZEN_TIMES, Task

LABEL = "other codes"
ALL = "all cases"
ROUNDED = at_most(1e-10, "of the error; ten times the rounding of numbers in a task file")
DEFORMED = at_most(1e-8, "of the error; this code evaluates contact in the deformed position, 1e-5 away")
OWN = at_most(0.1, "equal to nine digits; 1 if one code copies the solutions of another")


@dataclass(frozen=True)
class Peer:
    """A contact code of other people, its parameters, and the tolerance for the relative difference of its errors.

    Only codes are compared that, according to their documentation, impose the contact condition at vertices.
    scikit-fem is not compared, because this study uses it for assembly.

    Attributes:
        key: the key of the check.
        code, variant: the name and the parameters of the code, as in ``errors.csv``.
        window: the window of |error of the code / error of this study − 1|.
    """

    key: str
    code: str
    variant: str
    window: Window = ROUNDED


OURS = "this study", "condensed active set"
PEERS = (
    Peer("snesvi", "DOLFINx + PETSc SNESVI", "vinewtonrsls, rtol 1e-12"),
    Peer("getfem", "GetFEM", "nodal augmented Lagrangian, r = g"),
    Peer("freefem", "FreeFEM", "scripted primal-dual active set"),
    Peer("kratos", "Kratos", "ALM mortar, foundation as fine as the face", DEFORMED),
)
PLANE = "advance-recede", "rotated", "corner", "layered", "anisotropic", "lift-and-land"
MARCHED = frozenset(grid(("advance-recede", "anisotropic"), ("one-diagonal",), (8, 16, 32)))
"""The settings in which solutions in time are compared as well."""
MODE, CODE, VERSION, VARIANT, CLASS, ERROR, DISTANCE = (name + OF_FILE for name in OtherErrors.columns[4:])
PROBLEM = ["case", "family", "level", "quantity"]
"""The columns that identify a problem. The column "quantity" is the mode, static ("frozen") or in time ("march")."""


class OtherCodes(ListedNumbers):
    """Measures errors of static problems and of solutions in time, and compares them with the errors of other codes."""

    label = LABEL
    claim = "other codes have the same errors as this study, in static problems and in time stepping"
    joined_file = OtherErrors("codes/errors.csv", label=LABEL)
    quick = grid(("advance-recede",), ("one-diagonal",), (8,))
    full = (
        *grid(PLANE, ("one-diagonal", "shaken"), (8, 16, 32)),
        *grid(("cube-disc",), ("one-diagonal",), (4, 8)),
        *grid(("cube-two-faces",), ("one-diagonal",), (3, 6)),
    )

    def measure(self, setting: Setting) -> Numbers:
        task = Task(resolve(setting.case), family_named(setting.family), setting.level)
        found = {FROZEN: task.error(FROZEN_TIMES)}
        if setting in MARCHED:
            found[MARCH] = task.error_of_march(setting.level)
        return with_h(task.space.h, found)

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        if CODE not in rows or rows[CODE].isna().all():
            nothing = float("nan"), NOWHERE, REPORTED
            made = f"no claim: these data lack the file with errors of other codes, which `{MADE}` makes"
            return [row(self, "none", "errors of other codes", Window(), nothing, ALL, expected=made)]
        return [*(self.agreement(rows, peer) for peer in PEERS), self.own_digits(rows)]

    def agreement(self, rows: pd.DataFrame, peer: Peer) -> Verdict:
        """Return the check that compares the errors of one code with the errors of this study.

        It is undecided if the code lacks a problem without a documented reason.
        """
        mine = rows_of(rows, peer.code, peer.variant)
        run = mine[mine[CLASS] != NOT_EXPRESSED]
        missing = len(rows[PROBLEM].drop_duplicates()) - len(mine)
        judged: Found = float("nan"), NOWHERE, UNDECIDED
        if len(run):
            differences = (run[ERROR] / run["value"] - 1).abs().to_numpy()
            value = float(differences.max())
            span = (float(differences.min()), float(differences.max()))
            verdict = FAILS if not peer.window.contains(*span) else UNDECIDED if missing else HOLDS
            judged = value, span, verdict
        short = f"{BECAUSE}{missing} problems lack an error" if missing else ""
        name = f"{peer.code} {' '.join(sorted(run[VERSION].unique()))}, {peer.variant}"
        quantity = f"{name}: |‖u − u^h‖_V / error of this study − 1|, {len(run)} problems"
        return row(
            self,
            peer.key,
            quantity,
            peer.window,
            judged,
            ALL,
            expected=f"{peer.window.text}{short}",
            kind=CheckKind.ACCURACY,
        )

    def own_digits(self, rows: pd.DataFrame) -> Verdict:
        """Return the check that no code copied the results of another.

        For every pair of codes, problems are counted in which both have the same distance from the discrete solution.
        The largest fraction of such problems is judged.
        """
        names = [OURS, *((peer.code, peer.variant) for peer in PEERS)]
        columns = [rows_of(rows, *name).set_index(PROBLEM)[DISTANCE].dropna() for name in names]
        both = [pd.concat(pair, axis=1, join="inner").to_numpy() for pair in combinations(columns, 2)]
        parts = np.array([np.mean(pair[:, 0] == pair[:, 1]) for pair in both if len(pair)])
        judged: Found = float("nan"), NOWHERE, UNDECIDED
        if len(parts):
            value = float(parts.max())
            span = (float(parts.min()), float(parts.max()))
            judged = value, span, HOLDS if OWN.contains(*span) else FAILS
        quantity = "share of problems in which two codes have the same distance from the solution in K^h"
        return row(self, "own-digits", quantity, OWN, judged, ALL, kind=CheckKind.ACCURACY)

    def cost(self, setting: Setting) -> float:
        """Return the expected run time in µs.

        For a solution in time it is higher, because the code solves as many time steps as there are cells along a side.
        """
        return super().cost(setting) * (setting.level if setting in MARCHED else 1)


def rows_of(rows: pd.DataFrame, code: str, variant: str) -> pd.DataFrame:
    """Return the rows with the errors of one code and variant.

    The mode of the code, static or in time, must agree with the quantity of the row.
    """
    return rows[(rows[MODE] == rows["quantity"]) & (rows[CODE] == code) & (rows[VARIANT] == variant)]
