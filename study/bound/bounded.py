"""One computed displacement with guaranteed bounds of its error, and what has to be refused before it is computed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

from manufactured.case import Case
from manufactured.data import Data
from manufactured.tensors import Array
from study.bound.discretisation import BoundError, Setting, refuse_solids
from study.bound.enclosure import Better, Computed, Enclosure, Itself, compute, enclose
from study.fem.gauge import Gauge
from study.fem.mesh import FAMILIES, MeshFamily, boundary_parts
from study.solve.evolution import Scheme


@dataclass(frozen=True, eq=False)
class Bounded:
    """A computed displacement with the plain bound and the enclosure of its error."""

    setting: Setting
    computed: Computed
    plain: Enclosure
    enclosure: Enclosure


def check_bound(data: Data, family: MeshFamily, levels: Sequence[int], steps: int | None, better: Better) -> None:
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
    if better.refinements < 0 or better.shorter < 1:
        raise BoundError(
            "ũ needs 0 or more refinements and 1 or more steps in one of u_h, "
            f"got {better.refinements} and {better.shorter}"
        )
    refuse_solids(data)
    data.check()
    if not family.serves(data.body):
        served = ", ".join(known.name for known in FAMILIES if known.serves(data.body))
        raise BoundError(f"the family {family.name} does not mesh this body; take one of {served or 'none'}")
    for level in levels:
        boundary_parts(Setting(data, family(data.body, level)).mesh, data.body)


def check_force(case: Case | None) -> None:
    """Refuse a case with f_0 ∉ L²(Ω)², whose oscillation is infinite and whose load no composite stress balances.

    Raises:
        BoundError: it is one.
    """
    if case is not None and not case.regularity.force_in_L2:
        raise BoundError(
            f"case {case.name}: {case.regularity} has f_0 ∉ L²(Ω)², and the bound needs stresses with Div σ = −P f_0; "
            "take a case with f_0 in L²"
        )


def known_error(case: Case | None, computed: Computed) -> Callable[[float, Array], float] | None:
    """(t, u_h(t)) ↦ ‖u(t) − u_h(t)‖_V, where there is an exact solution."""
    if case is None:
        return None
    gauge = Gauge(case.solution, computed.space)
    return lambda time, u: gauge.distance(gauge.sample(time), u)


def bounded(
    data: Data,
    case: Case | None,
    family: MeshFamily,
    level: int,
    scheme: Scheme,
    steps: int,
    better: Better,
    progress: Callable[[float], object] = lambda time: None,
) -> Bounded:
    """Compute u_h and both bounds."""
    setting = Setting(data, family(data.body, level))
    computed = compute(setting, scheme, steps)
    error = known_error(case, computed)
    return Bounded(
        setting,
        computed,
        enclose(setting, computed, Itself(), error),
        enclose(setting, computed, better, error, progress),
    )
