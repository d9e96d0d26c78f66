"""Beyond the source: codes that share mesh, loads and exact solution with this one, and nothing else, have its errors.

What Proposition 5.4 bounds is the error of the solution in K^h, and a program may err where its author did when he
wrote the test. So contact codes of other people were given the frozen problems of these cases as plain data
(``tasks``). They solved them by their own assembly and contact algorithms (FreeFEM by a loop scripted in its language,
as in its documentation), and ``make codes`` wrote their errors in V, by a judge that imports NumPy alone. Here the
errors of the same problems are measured anew, by the quadrature and the solver of this study, and both are compared. So
are, in two cases, those of marches by the midpoint rule, in which a code carries its own history.

*Predicted.* Numbers of a task are rounded to 13 digits. This changes a strain by about 1e-13 ‖u‖/h, which is at most
1e-11 of the error on these meshes. A code that holds vertices by multipliers ends at the solution in K^h up to rounding
of its linear solver, whose condition is like h^−2: less than that. So errors agree to 1e-10; also those of marches,
whose steps do not enlarge what comes in. Kratos knows contact at deformed places only: loads are multiplied by 1e-5, so
that places move by 1e-5 and displacements change in this proportion, of which an error sees a part. 1e-5 was allowed at
first; 5e-10 was measured, and the window narrowed.

*Not a copy.* Linear solvers of different codes round differently. The distance from the solution in K^h, as the task
has it to 14 digits, is made of the digits that are missing there, which all codes see, and of the rounding of a code, a
thousandth of it or so: two codes agree in the nine digits that are kept on one mesh in a million by chance. A column
that was copied agrees on all. (Errors themselves agree in double precision on up to three meshes of eight: one step of
rounding is as large as what tells codes apart.)
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
import pandas as pd

from study.fem.naming import family_named, resolve
from study.ledger.codes import FROZEN, MADE, MARCH, NOT_EXPRESSED, OtherErrors
from study.ledger.measures import greatest
from study.ledger.verdict import BECAUSE, FAILS, HOLDS, NOWHERE, REPORTED, UNDECIDED, Found, Verdict, row
from study.ledger.window import Window, at_most
from study.statements.other_codes.tasks import INSTANTS, Task
from study.statements.shared import base
from study.statements.shared.base import LISTED, ListedNumbers, Setting, grid, with_h

LABEL, ALL = "other codes", "all cases"
ROUNDED = at_most(1e-10, "of the error, ten times what the digits of a task leave open")
DEFORMED = at_most(1e-8, "of the error: contact at deformed places, which are 1e-5 away")
OWN = at_most(0.1, "nine digits; 1 if one was copied from the other")


@dataclass(frozen=True)
class Peer:
    """A code with its parameters, as ``errors.csv`` names it, and how far its errors may be from those of this study.

    It solves the problem in K^h, by its documentation. scikit-fem is none of them, as this study assembles with it.
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
PLANE = (
    *("advance-recede", "merging-patches", "rotated", "corner"),
    *("layered", "anisotropic", "full-contact", "lift-and-land"),
)
MARCHED = frozenset(grid(("advance-recede", "anisotropic"), ("one-diagonal",), (8, 16, 32)))
"""The problems in which codes march, too."""
COLUMNS = ("label", "case", "family", "level", "mode", "code", "version", "variant", "class", "error", "distance")
MODE, CODE, VERSION, VARIANT, CLASS, ERROR, DISTANCE = (name + base.REPORTED for name in COLUMNS[4:])
PLACE = ["case", "family", "level", "quantity"]
"""What tells the problems apart; the quantity is the mode."""


class OtherCodes(ListedNumbers):
    """Errors of frozen problems and of marches, beside those of other people's codes where there are such data."""

    label = LABEL
    claim = "the errors of this study, frozen and through time, by codes of other people"
    beside = OtherErrors("codes/errors.csv", LISTED.key, COLUMNS, label=LABEL)
    quick = grid(("advance-recede",), ("one-diagonal",), (8,))
    full = (
        *grid(PLANE, ("one-diagonal", "shaken"), (8, 16, 32, 64)),
        *grid(("cube-disc",), ("one-diagonal",), (4, 8)),
        *grid(("cube-two-faces",), ("one-diagonal",), (3, 6)),
    )

    def measure(self, setting: Setting) -> dict[str, float]:
        task = Task(resolve(setting.case), family_named(setting.family), setting.level)
        found = {FROZEN: task.error(INSTANTS)}
        if setting in MARCHED:
            found[MARCH] = task.error_of_march(setting.level)
        return with_h(task.space.h, found)

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        if CODE not in rows or rows[CODE].isna().all():
            nothing = float("nan"), NOWHERE, REPORTED
            made = f"no claim: there are no errors of other codes beside these data, which `{MADE}` makes"
            return [row(self, "none", "errors of other codes", Window(), nothing, ALL, expected=made)]
        return [*(same(self, rows, peer) for peer in PEERS), own_digits(self, rows)]

    def cost(self, setting: Setting) -> float:
        """A march is as many steps as there are cells along a side."""
        return super().cost(setting) * (setting.level if setting in MARCHED else 1)


def same(of: OtherCodes, rows: pd.DataFrame, peer: Peer) -> Verdict:
    """How far the errors of a code are from those of this study; undecided if a mesh is left out without a reason."""
    mine = _of(rows, peer.code, peer.variant)
    run = mine[mine[CLASS] != NOT_EXPRESSED]
    missing = len(rows[PLACE].drop_duplicates()) - len(mine)
    judged: Found = float("nan"), NOWHERE, UNDECIDED
    if len(run):
        value, span = greatest((run[ERROR] / run["value"] - 1).abs().to_numpy())
        verdict = FAILS if not peer.window.contains(*span) else UNDECIDED if missing else HOLDS
        judged = value, span, verdict
    short = f"{BECAUSE}{missing} problems lack an error" if missing else ""
    versions = " ".join(sorted(run[VERSION].unique()))
    quantity = f"{peer.code} {versions}, {peer.variant}: |‖u − u^h‖_V / that of this study − 1|, {len(run)} problems"
    return row(of, peer.key, quantity, peer.window, judged, ALL, expected=f"{peer.window.text}{short}")


def own_digits(of: OtherCodes, rows: pd.DataFrame) -> Verdict:
    """The part of the problems in which two codes have the same distance from the solution in K^h, of all pairs."""
    names = [OURS, *((peer.code, peer.variant) for peer in PEERS)]
    columns = [_of(rows, *name).set_index(PLACE)[DISTANCE].dropna() for name in names]
    both = [pd.concat(pair, axis=1, join="inner").to_numpy() for pair in combinations(columns, 2)]
    parts = np.array([np.mean(pair[:, 0] == pair[:, 1]) for pair in both if len(pair)])
    judged: Found = float("nan"), NOWHERE, UNDECIDED
    if len(parts):
        value, span = greatest(parts)
        judged = value, span, HOLDS if OWN.contains(*span) else FAILS
    quantity = "part of the problems in which two codes have the same distance from the solution in K^h"
    return row(of, "own-digits", quantity, OWN, judged, ALL)


def _of(rows: pd.DataFrame, code: str, variant: str) -> pd.DataFrame:
    return rows[(rows[MODE] == rows["quantity"]) & (rows[CODE] == code) & (rows[VARIANT] == variant)]
