"""Two experiments of paper/experiments.tex on finer meshes than the ledger has, up to n = 512.

Both measure single numbers for which a limit has been predicted:

* rollers on alternating diagonals: the largest excess ‖u^h − u^h_lin‖_V and the excess at T, divided by h^{1/2}, and
  the size of the displacements, divided by h, by which neighbouring vertices differ after the roller has passed;
* an advancing natural front: the largest nodal error |(P_hu − Π^hu)_ν| on Γ3 within the distance 1/5 from the front,
  divided by θ h^{3/2}, the largest nodal error farther away, divided by θ h², and the error ‖u − u^h‖_V, divided by h.

Predicted for n = 512 before the run, from what was seen up to n = 256: the numbers of the first experiment change by at
most 1/200 (excess) and 1/90 (neighbours) from n = 256, the nodal errors near the front by at most 1/30, and their sign
stays negative. All of this was seen at n = 512. The quotient ‖u − u^h‖_V / h was predicted to have a limit: nearly all
of the error is interpolation error, and u(t) ∈ H^{5/2−ε}. With the logarithm that the proof permits it would grow by a
quarter from n = 16 to 32 and by an eighth from n = 256 to 512.

Usage: .venv/bin/python -m benchmarks.fine_levels [LEVEL …]. Writes results/benchmarks/fine-levels.csv. Level 512 takes
about an hour on one core.
"""

from __future__ import annotations

import math
import sys
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd

from manufactured.catalogue import NATURAL_MOTION
from manufactured.modes import at_each
from manufactured.multiscale import START
from study.fem.error_norm import ErrorNorm
from study.fem.independent import load_from_forces
from study.fem.naming import resolve
from study.fem.space import form
from study.solve.evolution import SemiDiscrete
from study.solve.signorini import Signorini
from study.solve.tableau import MIDPOINT
from study.statements.moving_fronts import ERROR_INSTANTS, FORCE_DEGREE, means_from_edges
from study.statements.shared.base import Setting
from study.statements.shared.meshes import space_of
from study.statements.work_of_contact import PER_H, OnContact, Resolved, Trajectories

FILE = Path(__file__).parents[1] / "results" / "benchmarks" / "fine-levels.csv"
LEVELS = (16, 32, 64, 128, 256, 512)
PLACES = 8
"""Places of the front in its edge."""
EDGE_POINTS, NEAR = 40, 4.0
"""Number of Gauss points on each edge of the cells around the front, and their largest distance from it in edges.

Quadrature rules on cells are too coarse there, because the strain at the front is like r^{1/2}: they raised the largest
nodal errors by 0.4 to 0.7 %. On edges the displacement is integrated, which is like r^{3/2}.
"""


def rollers(n: int) -> dict[str, float]:
    """Return the excess and the difference of neighbours on alternating diagonals at level n."""
    solution = resolve(f"roller-{n}").solution
    space = space_of(Setting(f"roller-{n}", "alternating", n))
    T = solution.body.T
    found = Trajectories.of(OnContact(Resolved(solution, space)), round(PER_H * n * T))
    excess, (s,) = found.excess(), found.on.places
    order = np.argsort(s)
    kept, s = (found.contact - found.linear)[-1][order], s[order]
    # The roller passes the vertex at s at the time s − START; the displacement that remains there fades like e^{−t}.
    between = (kept[1:-1] - (kept[:-2] + kept[2:]) / 2) / 2 * np.exp(T + float(START) - s[1:-1])
    passed = (s[1:-1] > float(START) + 4 / n) & (s[1:-1] < float(START) + T - 4 / n)
    return {
        "largest excess / h^(1/2)": excess.max() * math.sqrt(n),
        "excess at T / h^(1/2)": excess[-1] * math.sqrt(n),
        "difference of neighbours / 2h": float(np.median(abs(between[passed]))) * n,
    }


def natural_front(n: int) -> dict[str, float]:
    """Return the largest nodal errors of P_hu near the front and farther away at level n, one diagonal."""
    solution = resolve(NATURAL_MOTION).solution
    space = space_of(Setting(NATURAL_MOTION, "one-diagonal", n))
    v_norm, (face,), (_, vertices) = ErrorNorm(solution, space), solution.faces, space.contact[0]
    front = face.field.place_at
    condensed = Signorini(form(space, solution.law.A), space.N)
    s = face.part.coordinates(space.mesh.p[:, vertices])[0][0]
    near = []
    far = []
    highest = []
    for place in range(PLACES):
        time = 0.5 + place / PLACES / n / (front(1.0) - front(0.0))  # the front has a constant speed
        theta = 0.25 + time
        strain = v_norm.sample(time).means
        from_front = space.mesh.p[:, space.mesh.t].mean(axis=1) - face.part.point(np.array([[front(time)]]))
        cells = np.flatnonzero(np.linalg.norm(from_front, axis=0) < NEAR / n)
        strain[:, cells] = means_from_edges(
            lambda x, time=time: solution.at(x).displacement(time), space, cells, EDGE_POINTS
        )
        projected = condensed.gap(space.functional(solution.law.A.matrix @ strain))
        error = (projected + face.gap_jet(s[None], time)[(0,)]) / theta
        close = abs(s - front(time)) <= 0.2
        near.append(abs(error[close]).max())
        far.append(abs(error[~close]).max())
        highest.append(error[close].max())
    return {
        "nodal error near the front / θ h^(3/2)": max(near) * n**1.5,
        "nodal error farther away / θ h^2": max(far) * n**2,
        "highest signed nodal error near the front / θ h^(3/2)": max(highest) * n**1.5,
    }


def front_error(n: int) -> dict[str, float]:
    """Return the error of u^h for the advancing front at level n, one diagonal; the time step is h/4."""
    solution = resolve(NATURAL_MOTION).solution
    space = space_of(Setting(NATURAL_MOTION, "one-diagonal", n))
    v_norm = ErrorNorm(solution, space)
    steps = round(4 * n * solution.body.T)
    problem = SemiDiscrete.of(
        space,
        solution.law,
        partial(at_each, of=partial(load_from_forces, solution, space, degree=FORCE_DEGREE)),
        v_norm.sample(0.0).interpolant,
    )
    every = steps // ERROR_INSTANTS
    errors = [
        v_norm.distance(v_norm.sample(step * problem.T / steps), state.u)
        for step, state in enumerate(MIDPOINT.march(problem, steps))
        if step % every == 0
    ]
    return {"error / h": max(errors) * n}


def main(levels: list[int]) -> None:
    """Measure the levels, coarsest first, and write the table after each of them."""
    known = pd.read_csv(FILE) if FILE.exists() else pd.DataFrame({"level": []})
    rows = {int(row["level"]): row for row in known.to_dict("records")}
    for n in levels:
        rows[n] = {"level": n, **natural_front(n), **rollers(n), **front_error(n)}
        print(rows[n], flush=True)
        pd.DataFrame([rows[n] for n in sorted(rows)]).to_csv(FILE, index=False, float_format="%.5g")


if __name__ == "__main__":
    main([int(level) for level in sys.argv[1:]] or list(LEVELS))
