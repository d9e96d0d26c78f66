"""The result of checking one condition of the contact problem, and the error that lists all violated conditions."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from manufactured.tensors import Array, Points

TOGETHER = 1 << 13
"""Number of values that are evaluated at a time, so that they fit into the processor's cache."""
ROUND_OFF = 1e-9
"""Largest defect, relative to the size of the terms of a condition, that counts as round-off."""


OPEN_IN_CONTACT = "w = 0, so σ_ν w = 0, on the stated zone"
"""Name of the condition that is violated if the gap is positive somewhere in the contact zone."""
INITIAL_GAP_ADVICE = (
    "`gap` is the distance that is left at the time t, 0 where there is contact. If your formula is the distance of "
    "the undeformed body from the foundation, give it as `initial_gap` of ContactFace.linear, and give `gap` a formula "
    "that vanishes in contact, such as pos(-zone, 4)"
)
CLAMPED = "(2.3) u = 0 on Γ1"
"""Name of the condition that is violated if the displacement reaches the clamped boundary."""
CLAMPED_ADVICE = (
    "by default the displacement of a contact face ends at the depth 1; `profile=cutoff(depth)` of ContactFace lets it "
    "end above Γ1"
)
ADVICE = {OPEN_IN_CONTACT: INITIAL_GAP_ADVICE, CLAMPED: CLAMPED_ADVICE}
"""Condition, or the beginning of its name ↦ what to change if it is violated."""


@dataclass(frozen=True)
class Finding:
    """The largest violation of one condition that was found.

    Attributes:
        condition: the number of the condition in the paper, and its formula.
        defect: the size of the violation, relative to the size of the terms of the condition.
        tolerance: the largest defect that passes.
        x, time: the point and the time of the largest defect.
    """

    condition: str
    defect: float
    tolerance: float
    x: tuple[float, ...]
    time: float

    @property
    def passes(self) -> bool:
        # ``not defect > tolerance`` would let a NaN pass.
        return self.defect <= self.tolerance

    def __str__(self) -> str:
        place = ", ".join(f"{c:.6g}" for c in self.x)
        word = "holds" if self.passes else "violated"
        return (
            f"{self.condition}: {word}, relative defect {self.defect:.3g} (allowed {self.tolerance:g}) "
            f"at x = ({place}), t = {self.time:.6g}"
        )


class SelfProofError(ValueError):
    """Raised if an exact solution violates a condition of Problem 2.1."""

    def __init__(self, name: str, findings: list[Finding]) -> None:
        self.findings = findings
        lines = "\n  ".join(str(finding) for finding in findings)
        advice = "".join(
            f"\n  {words}" for condition, words in ADVICE.items() if any(condition in one.condition for one in findings)
        )
        super().__init__(
            f"{name} does not prove itself an exact solution:\n  {lines}\n"
            f"  change the gap, the pressure, the zone or the law until it does{advice}"
        )


def worst(
    condition: str, x: Points, instants: Array, defect: Array, scale: Array, tolerance: float = ROUND_OFF
) -> Finding:
    """Return the largest violation of a condition, relative to the largest entry of ``scale``.

    Args:
        condition: the number and formula of the condition.
        x: the points, (d, points).
        instants: the times, (times,).
        defect: the size of the violation, (times, points).
        scale: the size of the terms of the condition.
        tolerance: the largest relative violation that passes.
    """
    defect = np.where(np.isfinite(defect), defect, np.inf)
    when, where = np.unravel_index(np.argmax(defect), defect.shape)
    size = max(float(np.max(np.where(np.isfinite(scale), scale, 0.0))), np.finfo(float).tiny)
    largest = float(defect[when, where])
    relative = largest / size if largest > 0 else 0.0
    return Finding(condition, relative, tolerance, tuple(map(float, x[:, where])), float(instants[when]))


def at_times(of: Callable[[Array], Array], instants: Array, points: int) -> Array:
    """Evaluate a field at many times, which become the first axis, in blocks that fit into the processor's cache.

    Args:
        of: a function from times (n,) to values whose last axis has the length n.
        instants: the times.
        points: the number of points at which the field is evaluated.
    """
    together = max(1, TOGETHER // points)
    blocks = (instants[first : first + together] for first in range(0, len(instants), together))
    return np.concatenate([np.moveaxis(of(block), -1, 0) for block in blocks])


def norms(values: list[Array] | Array) -> Array:
    """Return the Euclidean norms of vectors with the axes (times, components, points)."""
    return np.linalg.norm(np.asarray(values), axis=1)
