"""(5.20)–(5.21) and (5.42): the error of Problem 5.1 against its bounds, with v^h = Π^h u and u_0^h = Π^h u_0.

With e = u − u^h and η = u − Π^h u the right sides without their constants are

    (5.21):  ‖η_0‖_V + ‖η̇‖_{L²(0,T;V)} + ‖R(·; −η)‖_{L¹(0,T)}^{1/2} + ‖e_0‖_V,
    (5.42):  the same with (‖σ_ν‖_{L^∞(0,T;L²(Γ3))} ‖η_ν‖_{L¹(0,T;L²(Γ3))})^{1/2} for the third term,

where R(t; v) = ∫_{Γ3} σ_ν v_ν, (5.40). The source hides ‖σ_ν‖ in its c; here it is part of the bound, so that
(5.41) makes the second bound the larger one.

**The constant.** Integrating (5.12) and (5.15) as they stand, with ‖Bu − Bu^h‖_V ≤ L‖e‖_V, L = L_G/m_A, (4.3),
and (Bu − Bu^h, e)_V ≥ −ω‖e‖_V², gives for E = max_t ‖e(t)‖_V

    E² ≤ e^{2ωT} (2 E a + b),   a = max_t ‖η(t)‖_V + ∫_0^T (‖η̇‖_V + L‖η‖_V),
                                b = ‖e_0‖_V² + 2‖e_0‖_V ‖η_0‖_V + 2‖R‖_{L¹},

hence E ≤ e^{2ωT} (2a + √b), and with (5.17) and √b ≤ ‖e_0‖_V + ‖η_0‖_V + (2‖R‖_{L¹})^{1/2}

    E ≤ c · (right side),   c = e^{2ωT} max(3 + 2LT, 2√T (2 + LT), √2).

For monotone G there is ω = 0 and no exponential. ((5.14) as printed has L_G for L: its norm carries A.)
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pandas as pd

from manufactured.exact import Face
from manufactured.law import KelvinVoigt
from study.fem.gauge import FACET_POINTS
from study.fem.quadrature import facet_rule
from study.naming import family_named, resolve
from study.solve.evolution import Midpoint
from study.statements.base import Setting
from study.statements.instants import Velocity, midpoints
from study.statements.tally import Observation, change, grid, judge, largest, with_h
from study.sweep import Setup, steps_for
from study.verdict import Verdict, Window

INSTANTS = 64
"""Nodes of the midpoint rule for the norms in time."""

ROUND_OFF = 1e-11
"""Pressures below this part of the size of stresses are none."""

STEADY = Window(0.7, 1.4, "0.7 … 1.4 over two refinements: orders that differ by less than 1/4")
PROVED = Window(0.0, 1.0, "≤ 1 with the constant c of the proof")
LARGER = Window(0.0, 1 + 1e-9, "≤ 1 by the inequality of Cauchy and Schwarz")

CRITERIA = (
    change("right side of (5.21) / error: change under refinement", STEADY, "(5.21)"),
    largest("error / (c · right side of (5.21))", PROVED, "(5.21), c"),
    change("right side of (5.42) / error: change under refinement", STEADY, "(5.42)"),
    largest("error / (c · right side of (5.42))", PROVED, "(5.42), c"),
    Observation(
        largest("|R(t; Π^hu − u)| / (‖σ_ν‖_{L∞(0,T;L²(Γ3))} ‖u_ν − Π^hu_ν‖_{L²(Γ3)}), (5.41)", LARGER, "(5.41)")
    ),
)


@dataclass(frozen=True)
class ErrorBounds:
    """The right sides of (5.21) and (5.42) over the error, under refinement and with the constant of the proof."""

    label: str = "(5.20)–(5.21), (5.42)"
    claim: str = "‖u − u^h‖_{L∞(0,T;V)} ≤ c (‖u_0 − v_0^h‖_V + ‖u̇ − v̇^h‖_{L²(0,T;V)} + ‖R‖^{1/2}) + c ‖u_0 − u_0^h‖_V"

    def settings(self, full: bool) -> list[Setting]:
        if not full:
            return grid(("full-contact", "advance-recede", "rough-2"), ("shaken",), (6, 12, 24))
        smooth = "full-contact", "advance-recede", "travelling-patch", "yield-and-release", "yield-on-a-part"
        rough = "fixed-front-off-vertex", "rough-1.75", "rough-2", "rough-2.25"
        general = "heterogeneous", "corner", "natural-front", "rough-trace"
        return [
            *grid((*smooth, *rough), ("one-diagonal",), (8, 16, 32)),
            *grid((*smooth, *rough, *general), ("unstructured",), (8, 16, 32)),
        ]

    def measure(self, setting: Setting) -> dict[str, float]:
        case = resolve(setting.case)
        steps = steps_for(case, setting.level)
        setup = Setup.of(case.solution, family_named(setting.family), setting.level, Midpoint(), steps)
        return with_h(setup.space.h, sides(setup))

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        return judge(self, rows, CRITERIA)


def constant(law: KelvinVoigt, T: float) -> float:
    """c of the proof."""
    L, omega = law.G.lipschitz / law.A.ellipticity, max(-law.G.monotonicity, 0.0) / law.A.ellipticity
    return math.exp(2 * omega * T) * max(3 + 2 * L * T, 2 * math.sqrt(T) * (2 + L * T), math.sqrt(2))


def sides(setup: Setup) -> dict[str, float]:
    """Both sides of both bounds."""
    gauge, problem, T = setup.gauge, setup.problem, setup.problem.T
    error = max(gauge.distance(gauge.sample(state.time), state.u) for state in setup.scheme.march(problem, setup.steps))
    start = gauge.sample(0.0)
    velocity, contact = Velocity(setup.solution, setup.space), [Trace(setup, face) for face in setup.solution.faces]
    rates, works, traces, pressures = [], [], [], []
    for t in midpoints(T, INSTANTS):
        rates.append(velocity.interpolation_error(t))
        work, trace, pressure = np.sum([face(t) for face in contact], axis=0)
        works.append(abs(work))
        traces.append(math.sqrt(trace))
        pressures.append(math.sqrt(pressure))
    mean = T / INSTANTS
    common = (
        gauge.distance(start, start.interpolant)
        + math.sqrt(mean * np.sum(np.square(rates)))
        + gauge.distance(start, problem.u0)
    )
    right = {
        "(5.21)": common + math.sqrt(mean * np.sum(works)),
        "(5.42)": common + math.sqrt(mean * np.sum(traces) * max(pressures)),
    }
    c = constant(setup.solution.law, T)
    product = max(pressures) * np.array(traces)
    return {
        **{name: value / error for name, value in right.items()},
        **{f"{name}, c": error / (c * value) for name, value in right.items()},
        "(5.41)": np.max(np.array(works) / np.where(product > 0, product, 1.0)),
    }


class Trace:
    """σ_ν and η_ν = u_ν − Π^h u_ν on one piece of Γ3."""

    def __init__(self, setup: Setup, face: Face) -> None:
        mesh, facets = setup.space.mesh, setup.space.facets(face.part)
        self.rule = facet_rule(mesh, facets, face.part, face.rough, FACET_POINTS)
        self.exact = setup.solution.on(face, self.rule.s)
        self.tiny = ROUND_OFF * self.exact.stress_scale()
        self.nodes = setup.solution.at(mesh.p[:, mesh.facets[:, facets]])
        self.normal = face.part.normal

    def __call__(self, time: float) -> tuple[float, float, float]:
        """∫ σ_ν (Π^hu_ν − u_ν), ∫ |u_ν − Π^hu_ν|² and ∫ |σ_ν|²."""
        nodal = np.tensordot(self.normal, self.nodes.displacement(time), axes=1)
        eta = -self.exact.gap(time) - np.einsum("an,anq->nq", nodal, self.rule.shapes)
        pressure, weights = self.exact.pressure(time), self.rule.weights
        pressure = np.where(abs(pressure) > self.tiny, pressure, 0.0)
        return (
            float(np.sum(pressure * eta * weights)),
            float(np.sum(eta**2 * weights)),
            float(np.sum(pressure**2 * weights)),
        )
