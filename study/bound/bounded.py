"""What ``study bound`` computes on each level: a displacement with guaranteed bounds of its error."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

from manufactured.case import Case
from manufactured.data import Data
from manufactured.tensors import Array
from study.bound.discrete_solution import DiscreteSolution, compute
from study.bound.discretisation import Discretisation
from study.bound.enclosing import Enclosure, enclose
from study.bound.refusal import BoundError, refuse_solids
from study.bound.trajectory import Refined, SmoothedInTime
from study.fem.gauge import Gauge
from study.fem.mesh import FAMILIES, MeshFamily, boundary_parts
from study.solve.evolution import Scheme


@dataclass(frozen=True, eq=False)
class BoundedSolution:
    """u_h, the bound of its error from u_h alone, and the two-sided one by a trajectory closer to u."""

    computed: DiscreteSolution
    plain: Enclosure
    enclosure: Enclosure


def check_bound(data: Data, family: MeshFamily, levels: Sequence[int], steps: int | None, refined: Refined) -> None:
    """Refuse what cannot be bounded before time is spent.

    Raises:
        BoundError: levels, steps or refinements that make no sense, a family that does not serve the body, a body in
            3D or a law without a usable monotonicity constant.
        LoadError: data that no solution can belong to.
        MeshError: a mesh does not fit the parts of the body.
    """
    if not levels or min(levels) < 2 or any(b <= a for a, b in pairwise(levels)):
        raise BoundError(f"levels must be 2 or more and increase, got {' '.join(map(str, levels)) or 'none'}")
    if steps is not None and steps < 1:
        raise BoundError(f"--steps must be 1 or more, got {steps}")
    if refined.refinements < 0 or refined.shorter < 1:
        raise BoundError(
            "ũ needs 0 or more refinements and 1 or more steps in one of u_h, "
            f"got {refined.refinements} and {refined.shorter}"
        )
    refuse_solids(data)
    data.check()
    if not family.serves(data.body):
        served = ", ".join(known.name for known in FAMILIES if known.serves(data.body))
        raise BoundError(f"the family {family.name} does not mesh this body; take one of {served or 'none'}")
    for level in levels:
        boundary_parts(Discretisation(data, family(data.body, level)).mesh, data.body)


def known_error(case: Case | None, computed: DiscreteSolution) -> Callable[[float, Array], float] | None:
    """(t, u_h(t)) ↦ ‖u(t) − u_h(t)‖_V, where there is an exact solution."""
    if case is None:
        return None
    gauge = Gauge(case.solution, computed.space)
    return lambda time, u: gauge.distance(gauge.sample(time), u)


def bounded_solution(
    data: Data,
    case: Case | None,
    family: MeshFamily,
    level: int,
    scheme: Scheme,
    steps: int,
    refined: Refined,
    progress: Callable[[float], object] = lambda time: None,
) -> BoundedSolution:
    """Compute u_h and both bounds; ``progress`` is told the times of the enclosure that are done."""
    discretisation = Discretisation(data, family(data.body, level))
    computed = compute(discretisation, scheme, steps)
    error = known_error(case, computed)
    return BoundedSolution(
        computed,
        enclose(discretisation, computed, SmoothedInTime(), error),
        enclose(discretisation, computed, refined, error, progress),
    )
