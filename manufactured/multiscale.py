"""Exact solutions with details of many sizes. Each detail reaches into the body in proportion to its size."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
import sympy as sp
from sympy import Expr, Rational, exp, pi, prod, sin, sqrt

from manufactured.arguments import Size, checked
from manufactured.body import Kind, polygon, unit_square
from manufactured.case import Case
from manufactured.cases.shared import not_proportional
from manufactured.compiled import Jet, function
from manufactured.contact import ContactFace, Lifting, StatedFace, distinct
from manufactured.exact import ExactSolution
from manufactured.law import KelvinVoigt, isotropic
from manufactured.modes import Modes, at_each, pointwise
from manufactured.profile import QUARTIC, cutoff
from manufactured.regularity import Regularity
from manufactured.symbols import FormulaError, Function, Index, Values, indices, pos, s, t
from manufactured.tensors import Array, Points, Tensors, Time, Vectors, mandel, rotation, size

y = sp.Symbol("y", real=True)
"""The symbol of the distance from the face into the body."""


@lru_cache
def _lifting(rate: bool, order: int) -> Function:
    """Return a function that computes the derivatives of u_s and u_n up to an order, or of their rates.

    Its arguments are y and the derivatives along the face of w (up to order + 1), q and D (up to the order). For rates,
    the time derivatives of these follow. All faces share these long formulas.
    """
    w, q, D = (sp.Function(name)(s, t) for name in "wqD")
    eta = y / D
    phi = 1 - (3 - 2 * eta) * eta**2
    fields = -y * w.diff(s) * phi, (w + y * q) * phi
    formulas = [field.diff(t, int(rate), s, i, y, j) for field in fields for i, j in indices(2, order)]
    values = [
        trace.diff(t, times, s, i)
        for times in range(rate + 1)
        for trace, more in ((w, 1), (q, 0), (D, 0))
        for i in range(order + more + 1)
    ]
    symbols = sp.symbols(f"v0:{len(values)}", real=True)
    # Higher derivatives are substituted first, because they contain the lower ones.
    stated = dict(reversed([*zip(values, symbols, strict=True)]))
    return function((y, *symbols), [formula.doit().subs(stated) for formula in formulas])


@dataclass(frozen=True, eq=False)
@checked(FormulaError)
class FadingFace(StatedFace):
    """A contact face whose displacement reaches to a variable depth; all data are formulas of s and t.

    For the gap w and the normal strain q on the face, the displacement reaches to the depth D(s, t) and has the
    tangential and normal components

        u_s = −y ∂_s w φ(y/D),   u_n = (w + y q) φ(y/D),   φ(η) = (1 − η)²(1 + 2η) for η < 1, zero beyond,

    where y is the distance into the body and n = −ν. Since φ'(0) = 0, the variation of D has no effect at y = 0. There
    u_n = w, u_s = 0, ε_ss = ε_sn = 0 and ε_nn = q, as for a constant depth (``manufactured.contact``).

    Attributes:
        part, gap, pressure, level: see ``StatedFace``. The gap is three times differentiable along the face almost
            everywhere.
        strain: the normal strain q(s, t) on the face, which causes the pressure.
        depth: the depth D(s, t) > 0.
        least_depth: the smallest value of D; quadrature meshes are refined in a strip of this depth.

    Raises:
        FormulaError: a kink of a formula is not written with ``pos``.
    """

    strain: sp.Expr
    depth: sp.Expr
    least_depth: Size

    rough = ()

    @cached_property
    def traces(self) -> tuple[Jet, Jet, Jet]:
        """The gap w, the normal strain q and the depth D, which determine the displacement.

        Each evaluates a formula of (s, t) with its derivatives along the face.
        """
        return self.gap_jet, Jet(self.strain), Jet(self.depth)

    @cached_property
    def trace_rates(self) -> tuple[Jet, ...]:
        """The time derivatives of the gap w, the normal strain q and the depth D.

        Each evaluates a formula of (s, t) with its derivatives along the face.
        """
        return tuple(jet.rate() for jet in self.traces)

    def traced(self, s: Array, time: complex, rate: bool, order: int) -> list[Array]:
        """Return the derivatives along the face that ``lifted`` needs, of gap w, normal strain q and depth D.

        Args:
            s: the coordinates of the n points along the face, (1, n).
            time: the time.
            rate: whether the same derivatives of the time derivatives ẇ, q̇ and Ḋ are appended.
            order: the highest order of the derivatives that ``lifted`` shall return.

        Returns:
            The derivatives of w of the orders 0 to order + 1, then those of q and those of D of the orders 0 to order,
            (n,) each. If ``rate`` is true, the same derivatives of ẇ, q̇ and Ḋ follow in the same order.
        """
        jets = (*self.traces, *self.trace_rates) if rate else self.traces
        traces = [jet(s, time, order + more) for jet, more in zip(jets, (1, 0, 0) * 2, strict=False)]
        return [trace[i,] for trace in traces for i in range(len(trace))]

    def lifted(self, traced: Sequence[Array], into: Array, rate: bool, order: int) -> tuple[Values, Values]:
        """Return the displacements u_s and u_n with their derivatives in (s, y), at points within the depth.

        Args:
            traced: the result of ``traced`` at the coordinates s of the n points, with the same ``rate`` and ``order``.
            into: the distances y of the points from the face, (n,).
            rate: whether to return the velocities with their derivatives instead.
            order: the highest order of the derivatives.

        Returns:
            u_s and u_n, each as a dict from the orders (i, j) of the derivative ∂_s^i ∂_y^j to its values, (n,).
        """
        keys, values = indices(2, order), _lifting(rate, order)(into, *traced)
        both = np.array([np.broadcast_to(value, into.shape) for value in values]).reshape(2, len(keys), -1)
        u_s, u_n = (dict(zip(keys, component, strict=True)) for component in both)
        return u_s, u_n

    def at(self, x: Points) -> Fading:
        """Return the displacement field at fixed points of the body, (2, ...)."""
        return Fading(self, x)


class Fading:
    """The displacement field of a ``FadingFace`` at fixed points.

    Formulas are evaluated only at points within the depth of the face.
    """

    def __init__(self, face: FadingFace, x: Points) -> None:
        self.face, self.frame = face, face.part.frame
        self.turned = rotation(self.frame)
        places, into = face.part.coordinates(x)
        self.shape, self.y = into.shape, into.ravel()
        self.s, where = distinct(places.reshape(1, -1))
        self.where = np.arange(len(self.y)) if where is None else where

    def displacement(self, time: Time, rate: bool = False) -> Vectors:
        """Return the displacement u, or the velocity u̇ if ``rate`` is true, (2, ...)."""
        return self._everywhere(lambda values: self.frame @ np.array([of[0, 0] for of in values]), time, rate, 0)

    def strain(self, time: Time, rate: bool = False) -> Tensors:
        """Return the strain ε(u), or its rate if ``rate`` is true, in Mandel form, (3, ...)."""
        return self._everywhere(lambda values: self.turned @ _strain(values, (0, 0)), time, rate, 1)

    def strain_gradient(self, time: Time, rate: bool = False) -> Array:
        """Return the derivatives ∂_j of the strain, or of its rate if ``rate`` is true, (3, 2, ...)."""

        def gradient(values: tuple[Values, Values]) -> Array:
            local = np.array([self.turned @ _strain(values, along) for along in ((1, 0), (0, 1))])
            return np.einsum("ji,iI...->Ij...", self.frame, local)

        return self._everywhere(gradient, time, rate, 2)

    def modes(self) -> Modes:
        # There is no shorter sum of products, because the depth changes with time.
        return pointwise(self.strain, size(2), len(self.y))

    def _everywhere(self, of: Callable[[tuple[Values, Values]], Array], time: Time, rate: bool, order: int) -> Array:
        """Return a quantity, such as the strain, at all points; it is 0 at points deeper than D.

        Args:
            of: computes the quantity from the derivatives of (u_s, u_n), or of their rates if ``rate`` is true.
            time: one time or several times.
            rate: whether rates are needed.
            order: the highest order of derivatives that is needed.
        """

        def at_one(moment: complex) -> Array:
            depth = np.real(self.face.traces[-1](self.s, moment)[(0,)])
            inside = np.flatnonzero(np.real(self.y) < depth[self.where])
            # Formulas of s and t are evaluated once for points with the same s.
            used, place = np.unique(self.where[inside], return_inverse=True)
            traced = [values[place] for values in self.face.traced(self.s[:, used], moment, rate, order)]
            values = of(self.face.lifted(traced, self.y[inside], rate, order))
            found = np.zeros((*values.shape[:-1], len(self.y)), dtype=values.dtype)
            found[..., inside] = values
            return found.reshape(*found.shape[:-1], *self.shape)

        # Times are treated one by one, because the set of points within the depth changes with time.
        return at_each(time, at_one)


def _strain(values: tuple[Values, Values], more: Index) -> Tensors:
    """Return a derivative of the strain in the axes (s, n), in Mandel form, (3, n).

    Args:
        values: the derivatives of u_s and of u_n.
        more: the multi-index of the derivative.
    """
    gradient = [[of[i + more[0], j + more[1]] for i, j in ((1, 0), (0, 1))] for of in values]
    return mandel(np.array(gradient))


TRAINS = 7
"""The number of trains of contact patches, one on each part of Γ3."""
LENGTH = Rational(1, 8)
"""The length L of every part of Γ3."""
GAP_FACTOR, PRESSURE_FACTOR = 2, 200
"""The constant factors ω and ϖ in the formulas of gap and pressure of the trains of contact patches."""


@lru_cache
def multiscale() -> tuple[Case, ...]:
    """Return the cases with trains of contact patches.

    The solutions lie in H² and have contact patches of many sizes. Γ3 has seven pieces of equal length. On each piece
    lies a train of contact patches, which are half as wide as the patches on the piece before.

    There are two cases, trains and breathing-trains. The gap w, the contact pressure p and the contact zone {ψ ≥ 0} are

        S = sin(π (s/ℓ + 29/100)),   E = 4 s(L − s)/L²,   L = 1/8,   ℓ = 2^{−j−3} on the piece j = 0, …, 6 of Γ3,
        trains:            w = ω ℓ^{3/2} t E³ S_+^4,          p = ϖ ℓ^{1/2} t E³ (−S)_+²,            ψ = −S,
        breathing-trains:  w = ω ℓ^{3/2} E³ (S − μ(t))_+^4,   p = ϖ ℓ^{1/2} E³ (μ(t) − S)_+²,        ψ = μ(t) − S,

    on the unit square. Γ3 is the first 7/8 of its bottom, divided into parts of the length L, with s measured along
    each part; μ = 4t(1 − t) − 1/2, ω = 2, ϖ = 200. The displacement of a part is zero beyond its ends and below the
    depth ℓ/4.

    The powers of ℓ have the following reason. A detail of width ℓ and height ℓ^{3/2} that reaches to a depth
    proportional to ℓ contributes about ℓ to |u|²_{H²} and to |σ_ν|_{1/2} |u_ν'|_{1/2} on Γ3. So every train, which has
    about 1/ℓ details, contributes equally. To |u_ν|²_{H²(Γ3)} a detail contributes about 1. With more and more trains
    of the same total length, u therefore stays bounded in H², but its trace on Γ3 does not. The phase 29/100 is such
    that no front of the case trains lies at a vertex of a mesh: on edges of the length ℓ, for example, every front
    divides its edge in the same ratio.

    The cases are made for the *work of contact*, the work R = ∫_{Γ3} σ_ν (Π^h u_ν − u_ν) of the contact force on the
    interpolation error, which the error estimate contains. The depth and ϖ/ω are such that R is large compared with the
    error.

    Predicted for the work of contact on meshes with n cells along a side, 32 ≤ n ≤ 128: its square root has the order
    1, like the root of the bound h² Σ_F |σ_ν|_{1/2,F} |u_ν'|_{1/2,F}, a sum over the edges F on Γ3. For every such h
    there are trains of the widths ℓ = h/2, …, 4h. On coarser meshes wider trains are missing, and the order is lower;
    on finer meshes narrower trains are missing, and it is higher. For one fixed u the order finally rises above 1. No
    order is predicted for the error in V, which is not asymptotic on these meshes.

    These cases are not in the catalogue, because the meshes on which the study computes the cases of the catalogue are
    too coarse for them.
    """
    return static(), breathing()


def static() -> Case:
    """Return the case trains of ``multiscale``: fixed contact patches under a growing pressure."""
    return _train_case("trains", "patches of contact of seven widths", t, 0, Regularity(gap=4, pressure=2))


def breathing() -> Case:
    """Return the case breathing-trains of ``multiscale``: contact patches that widen and narrow again."""
    mu = 4 * t * (1 - t) - Rational(1, 2)
    return _train_case(
        "breathing-trains",
        "patches of contact of seven widths that widen and narrow again",
        1,
        mu,
        Regularity(gap=4, pressure=2, moving=True),
    )


@dataclass(frozen=True, eq=False)
class StripFace(ContactFace):
    """A contact face in 2D whose displacement is zero beyond the ends s = 0 and s = |Γ3,i| of its part.

    It is used like ``ContactFace``. Its displacement is zero outside the strip {0 ≤ s ≤ |Γ3,i|} above its part, so that
    it does not overlap with the displacement of a neighbouring part on the same side of the body. The gap w with its
    first two derivatives and the normal strain q with its first derivative must vanish at both ends, so that no strain
    jumps there; this is not checked.
    """

    def at(self, x: Points) -> Lifting:
        along = np.real(self.part.coordinates(x)[0][0])
        outside = (along < 0) | (along > self.part.measure)
        # Points beyond the ends are moved away from the face, deeper than the displacement reaches.
        return Lifting(self, x - np.multiply.outer(self.part.normal, 2 * self.profile.depth * outside))


def _train_case(name: str, summary: str, growth: Expr, mu: Expr, regularity: Regularity) -> Case:
    """Return a case with trains of contact patches.

    Args:
        name, summary, regularity: attributes of the case.
        growth: a factor of gap and pressure, a formula of t.
        mu: μ in the level function ψ = μ − S, a formula of t.
    """
    # The bottom of the unit square is divided into parts, one for each train.
    bottom = [(float(k * LENGTH), 0.0) for k in range(TRAINS + 1)]
    kinds = [Kind.CONTACT] * TRAINS + [Kind.LOADED, Kind.LOADED, Kind.CLAMPED, Kind.LOADED]
    body, law = polygon([*bottom, (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)], kinds), not_proportional()
    fade = (4 * s * (LENGTH - s) / LENGTH**2) ** 3
    faces = []
    for j, part in enumerate(body.of(Kind.CONTACT)):
        width = Rational(1, 2 ** (j + 3))
        level = mu - sin(pi * (s / width + Rational(29, 100)))
        gap = GAP_FACTOR * growth * width * sqrt(width) * fade * pos(-level, 4)
        pressure = PRESSURE_FACTOR * growth * sqrt(width) * fade * pos(level, 2)
        profile = cutoff(float(width) / 4, QUARTIC)
        faces.append(StripFace.linear(part, law, body.T, gap, pressure, level, profile=profile))
    return Case(
        name=name,
        summary=summary,
        solution=ExactSolution(body, law, tuple(faces)),
        regularity=regularity,
        order=1,
        reason="α = 4 and m = 2 give (5.36), but the trace is large in H²(Γ3): order 1 where trains are resolved",
        pace=2,
    )


FINAL_TIME = 0.7
START = Rational(3, 20)
"""The position of the front of a roller at t = 0."""
MIDDLE = Rational(1, 2)
"""The position of the centre of a standing patch."""
LANDINGS = Rational(1, 10), Rational(2, 5)
"""The times t_j at which a standing patch comes into contact."""
SLOPE = Rational(1, 10)
"""The constant factor ω in the formula of the gap of roller cases, which gives the size of its slope."""
ROLLERS = "roller", "pushing-roller", "steep-roller", "standing"
"""The names of the roller cases; a case of level n has "-n" added."""
COARSEST_ROLLER = 5
"""The smallest level n of the roller cases. A standing patch of half-width 2/n must lie within the contact face."""
DEPTH = Rational(7, 10)
"""The depth of the displacement of roller cases, divided by (ℓ² + ξ²)^{1/2}.

ℓ is the width of the contact patch, and ξ the position along the face relative to the patch.
"""


@checked(FormulaError)
@lru_cache
def rollers(level: int) -> tuple[Case, ...]:
    """Return the four roller cases for a level n, with a narrow patch of contact whose size is ℓ = 2/n.

    In the cases roller-n, pushing-roller-n and steep-roller-n a patch of the width ℓ moves along Γ3. Its normal strain
    q, contact pressure p and gap w are

        q = −Q e^ξ H(−ξ/ℓ),   p = 3Q e^ξ H'(−ξ/ℓ)/ℓ,   w = ω ℓ W(ρ),   ξ = s − 3/20 − t,   ρ = dist(ξ, [−ℓ, 0])/ℓ

    with Q = 1 and ω = 1/10, but Q = 2 in pushing-roller-n and ω = 1/5 in steep-roller-n. In the case standing-n a patch
    of the width 2ℓ opens and closes in a fixed place, with Q = 1, ω = 1/10 and the sum and the product over j = 1, 2:

        q = −Q B(ξ/ℓ) Σ_j e^{t_j−t} H((t − t_j)/ℓ),   p = 3Q B(ξ/ℓ) Σ_j e^{t_j−t} H'((t − t_j)/ℓ)/ℓ,
        w = ω ℓ (W(ρ) + B(ξ/ℓ) Π_j C((t − t_j)/ℓ)),   ξ = s − 1/2,   ρ = dist(ξ, [−ℓ, ℓ])/ℓ,   t_1 = 1/10, t_2 = 2/5.

    The functions are

        H(z) = z³(10 − 15z + 6z²) on [0, 1], constant beyond,   B(z) = (1 − z²)_+^4,   W(ρ) = ρ³/(1 + ρ²)^{9/8},
        C(z) = H(−z) + H(z − 1), zero for 0 ≤ z ≤ 1.

    The body is the unit square, 0 ≤ t ≤ 7/10, and A = G: τ ↦ 2τ + (tr τ) I, so that p = −3(q̇ + q). The displacement
    reaches to the depth 7/10 (ℓ² + ξ²)^{1/2}: a detail of width r, at the distance r from the patch, reaches to a depth
    proportional to r.

    For a fixed ℓ, u lies in H². As ℓ → 0 its norm in H² grows, but only like |log ℓ|^{1/2}: W ~ ρ^{3/4} for large ρ
    keeps ∂_s w bounded in H^{1/2}(Γ3), but q has a step at the patch, because the strain that the pressure p ≥ 0 causes
    decays in a time ∼ 1, much later than the patch has passed. The velocity is not bounded in H² as ℓ → 0. W ~ ρ³ at ρ
    = 0, because with ρ² the strain ∂_s u_s = −y ∂_s² w would jump on lines into the body, and u would not lie in H².

    Predicted order 1 for a fixed ℓ and h → 0, because u ∈ H². But the cases of level n are meant for meshes of level n,
    on which ℓ = 2h shrinks with h. Then the part of the error that is due to contact is predicted to have the order 1,
    less a logarithm, or only 1/2, depending on the meshes (``study.statements.work_of_contact``).

    These cases are not in the catalogue, because each of them is meant for the meshes of one level.

    Raises:
        FormulaError: the level is less than ``COARSEST_ROLLER``.
    """
    if level < COARSEST_ROLLER:
        raise FormulaError(f"rollers: level has to be {COARSEST_ROLLER} or more, got {level}")
    width, (plain, pushing, steep, still) = Rational(2, level), (f"{kind}-{level}" for kind in ROLLERS)
    return (
        roller(plain, width),
        roller(pushing, width, push=2),
        roller(steep, width, slope=2 * SLOPE),
        standing(still, width),
    )


def roller(name: str, width: Expr, push: int = 1, slope: Expr = SLOPE) -> Case:
    """Return the case of a contact patch that moves along the face, with the formulas of ``rollers``.

    Args:
        name: the name of the case.
        width: the width ℓ of the patch.
        push: the factor Q of the strain and the pressure.
        slope: the factor ω of the gap.
    """
    xi = s - START - t
    place = -xi / width
    return _roller_case(
        name,
        "a narrow patch runs along the floor",
        xi,
        width,
        gap=slope * width * (away(-place) + away(place - 1)),
        strain=-push * exp(xi) * step(place),
        pressure=3 * push * exp(xi) * kick(place) / width,
        level=-xi * (xi + width),
        regularity=Regularity(gap=3, pressure=2, moving=True),
    )


def standing(name: str, width: Expr) -> Case:
    """Return the case of a contact patch that does not move and comes into contact twice.

    Args:
        name: the name of the case.
        width: half of the width of the patch, ℓ in the formulas of ``rollers``.
    """
    xi = s - MIDDLE
    place = xi / width
    bump = pos(1 - place**2, 4)
    since = [(t - start) / width for start in LANDINGS]
    pulses = [(exp(start - t), z) for start, z in zip(LANDINGS, since, strict=True)]
    lifted = prod([step(-z) + step(z - 1) for z in since])
    gap = SLOPE * width * (away(place - 1) + away(-place - 1) + bump * lifted)
    return _roller_case(
        name,
        "a narrow patch opens and closes in its place",
        xi,
        width,
        gap=gap,
        strain=-bump * sum(fading * step(z) for fading, z in pulses),
        pressure=3 * bump * sum(fading * kick(z) for fading, z in pulses) / width,
        level=-gap,
        regularity=Regularity(gap=3, pressure=4),
    )


def step(z: Expr) -> Expr:
    """Return the formula of the smooth step H(z) = z³(10 − 15z + 6z²) on [0, 1], which is constant beyond."""
    inside = pos(z, 1) - pos(z - 1, 1)
    return inside**3 * (10 - 15 * inside + 6 * inside**2)


def kick(z: Expr) -> Expr:
    """Return the formula of the derivative H'(z) = 30 z²(1 − z)² of the smooth step on [0, 1], which is zero beyond."""
    return 30 * pos(z, 2) * pos(1 - z, 2)


def away(rho: Expr) -> Expr:
    """Return the formula W(ρ_+) in the gap outside the patch, with W(ρ) = ρ³/(1 + ρ²)^{9/8} and ρ_+ = max(ρ, 0)."""
    return pos(rho, 3) / (1 + rho**2) ** Rational(9, 8)


def _roller_case(name: str, summary: str, xi: Expr, width: Expr, regularity: Regularity, **data: Expr) -> Case:
    body, law = unit_square(FINAL_TIME), KelvinVoigt(isotropic(1, 1), isotropic(1, 1), "linear, A = G")
    depth = DEPTH * sqrt(width**2 + xi**2)
    face = FadingFace(body.of(Kind.CONTACT)[0], depth=depth, least_depth=float(DEPTH * width), **data)
    return Case(
        name=name,
        summary=summary,
        solution=ExactSolution(body, law, (face,)),
        regularity=regularity,
        order=1,
        reason="α = 3 and m ≥ 2 give u ∈ H²: order 1 where the patch is resolved",
    )
