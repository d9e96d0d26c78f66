"""Beyond the paper: second-order time schemes have only order 1 if a vertex that comes into contact lifts a neighbour.

A vertex of Γ3 *lands* when it comes into contact. At a landing the velocity u̇^h jumps. There is no inertia, so the
neighbours of the vertex react at once. If the landing unloads a neighbour that is in contact, this neighbour lifts off
at the same time. Until the landing the exact solution has a force at the neighbour, and from then on a gap. A time
scheme imposes complementarity at the end of each step, so in the step of the landing its solution has either a force or
a gap at the neighbour, not both. This causes an error proportional to k, which does not decay.

**A problem with two unknowns** shows the effect:

    S u̇ + N_K(u) ∋ F,   K = {u ≥ 0},   S = [[2, −1], [−1, 2]],   F = (3/20, −2),   u(0) = (0, 2/5).

The first unknown u_1 is in contact until the second unknown lands at t = 2/5. Then u_1 increases with the velocity
3/40. Let the landing be at the time (n + θ)k. If θ ≥ 3/20, a step of backward Euler or of the midpoint rule leaves
u_1 = 0, while the exact value is (1 − θ)·3k/40. The error √2·(1 − θ)·3k/40 in ‖·‖_S remains. For k = 2^{−j} the values
of θ are cyclically 4/5, 3/5, 1/5 and 2/5. So errors at the time nodes are between √2·3/200 and √2·6/100 times k, and
both bounds are attained. The order is at most 1, although two successive values of k need not show it. For BDF2 the
error at the end is at least √2·17k/600 for every θ. paper/landings.tex has the proofs. The errors of backward Euler
and of the midpoint rule are judged.

**Linear finite elements.** A load moves along Γ3 in such a way that the pressure does not vanish at the front. Landings
then cause an error C_1 k, and the times between landings cause an error C_2 k². C_2 hardly depends on the mesh. C_1
depends on the jumps of velocities at landings, which may be smaller on finer meshes. The order 1 shows only for k below
C_1/C_2. So an order that is fitted to a fixed range of k may tend to 2 on finer meshes: over all six halvings of k the
midpoint rule has the order 1.1 for n = 8 and 1.4 for n = 16. (The first prediction was 1 to 3/2, without a theory.)
Therefore the order over the last three halvings is reported on every level. The expected order is 1 ± 0.4, which
excludes 3/2 and 2; the range is wide, because the positions θ of the landings matter. It was set after the data had
been seen, so nothing is claimed.

Under the load of the case itself, gap and pressure vanish to high order at the fronts. Landings then hardly change
velocities, and the order is 2 over all halvings.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import scipy.sparse as sps

from manufactured.tensors import Array
from study.fem.space import Space
from study.ledger.check import Check, consequence, identity
from study.ledger.quantities import values
from study.ledger.window import Window, around
from study.solve.evolution import Scheme, SemiDiscrete
from study.solve.paths import furthest, path
from study.solve.tableau import BACKWARD_EULER, BDF2, MIDPOINT
from study.statements.backward_euler import orders_in_k
from study.statements.shared.base import ListedNumbers, Numbers, Setting, grid, with_h
from study.statements.shared.experiment import Experiment

COUNTS = (16, 32, 64, 128, 256, 512, 1024)
"""Numbers of time steps, so that the step k is halved six times."""
FINEST = 8192
"""Number of steps of the midpoint rule whose solution is used as the semi-discrete solution u^h."""
LANDING, RISE = 0.4, 0.075
"""Data of the problem with two unknowns: the time at which u_2 comes into contact, and then the velocity of u_1."""
LAST = COUNTS[3:]
"""Numbers of time steps in the last three halvings, where the order 1 is expected."""
LEFT = around(1, 0.4, "excludes 3/2 and 2")
SECOND = around(2, 0.3)
LOADS = {"own": "load of the case", "rolling": "load that moves along Γ3"}
"""Descriptions of the two loads, by their names in columns."""
TWO_UNKNOWNS = "error / k for a problem with two unknowns"


def two_unknowns() -> SemiDiscrete:
    """Return the problem with two unknowns of the module docstring, on the time interval [0, 1]."""
    S = sps.csc_array([[2.0, -1.0], [-1.0, 2.0]])
    none = sps.csc_array((2, 2))
    force = np.array([0.15, -2.0])
    start = np.array([0.0, LANDING])
    return SemiDiscrete(S, none, None, sps.csr_array(-np.eye(2)), lambda t: force, start, 1.0)


def solution_of_two_unknowns(t: Array) -> Array:
    """Return the exact solution of the problem with two unknowns at given times, (times, 2)."""
    return np.stack([RISE * np.maximum(t - LANDING, 0), np.maximum(LANDING - t, 0)], axis=1)


def rolling(space: Space) -> Callable[[float], Array]:
    """Return a load that moves along the first contact face, as a function of time with values (dofs,).

    It is the normal traction (1 − 5 sin 2π(2s − 4t))ν with the coordinate 0 ≤ s ≤ 1 on the face.
    """
    part, vertices = space.contact[0]
    along = space.mesh.p[:, vertices] - part.corners[:, :1]
    s = np.linalg.norm(along, axis=0) / part.measure
    normal = sps.csr_array(space.N[: len(vertices)].T) * (np.gradient(s) * part.measure)

    return lambda t: np.asarray(normal @ (1 - 5 * np.sin(2 * np.pi * (2 * s - 4 * t))))


def order_of(scheme: Scheme, load: str, counts: Sequence[int], window: Window) -> Check:
    """Return the criterion for the order of a time scheme in the step k under a load.

    The orders on all levels must lie in the window; the order farthest from its middle is displayed.

    Args:
        scheme: the time scheme.
        load: the name of the load.
        counts: the numbers of time steps to which the order is fitted.
        window: the predicted order with its tolerance.
    """
    in_k = orders_in_k(counts, [f"{load} {scheme.name} {count}" for count in counts])
    quantity = f"{scheme.name}: order in k from {counts[0]} to {counts[-1]} steps, {LOADS[load]}"
    return consequence(
        f"{scheme.name}-{load}", quantity, in_k, window, if_missed="no theory gives this order for P1 elements"
    )


class Landings(ListedNumbers):
    """Measures errors of time schemes for problems in which many vertices come into contact.

    Errors for the problem with two unknowns are judged. Orders for finite elements are only reported.
    """

    label = "beyond: landings"
    effort = 300
    claim = "if a vertex that lands lifts a loaded neighbour, second-order schemes have only order 1 in k"
    checks = (
        *(
            identity(
                f"{name}-two",
                f"{name}: {TWO_UNKNOWNS}",
                values(*(f"two {name} {count}" for count in COUNTS)),
                Window(
                    math.sqrt(2) * 0.2 * RISE * (1 - 1e-9),
                    math.sqrt(2) * 0.8 * RISE * (1 + 1e-9),
                    "proved, both ends attained",
                ),
            )
            for name in (BACKWARD_EULER.name, MIDPOINT.name)
        ),
        order_of(BDF2, "rolling", LAST, LEFT),
        order_of(BDF2, "own", COUNTS, SECOND),
        order_of(MIDPOINT, "rolling", LAST, LEFT),
        order_of(MIDPOINT, "own", COUNTS, SECOND),
    )
    full = grid(("travelling-patch",), ("one-diagonal", "shaken"), (8, 16))

    def measure(self, setting: Setting) -> Numbers:
        found: Numbers = {}
        for scheme in (BACKWARD_EULER, MIDPOINT):
            for count in COUNTS:
                exact = solution_of_two_unknowns(np.arange(count + 1) / count)
                error = furthest(two_unknowns(), path(two_unknowns(), scheme, count), exact)
                found[f"two {scheme.name} {count}"] = count * error
        setup = Experiment.at(setting, MIDPOINT, FINEST)
        rolled = replace(setup.problem, load=rolling(setup.space), u0=np.zeros(setup.space.dofs))
        loads = {"own": setup.problem, "rolling": rolled}
        for load, problem in loads.items():
            exact = path(problem, MIDPOINT, FINEST)
            for scheme in (BDF2, MIDPOINT):
                for count in COUNTS:
                    error = furthest(problem, exact[:: FINEST // count], path(problem, scheme, count))
                    found[f"{load} {scheme.name} {count}"] = error
            found[f"{load} landings"] = float(landings(problem, exact))
        return with_h(setup.space.h, found)


def landings(problem: SemiDiscrete, states: Array) -> int:
    """Return how many times a vertex of Γ3 comes into contact, counted over all vertices and time steps."""
    touching = -1e-12 * abs(states).max() <= (problem.N @ states[1:].T).T
    return int((touching[1:] & ~touching[:-1]).sum())
