"""Exact solutions with contact: the displacement in the body is made from gap, pressure and slip on a contact face.

This construction is called lifting. Near a flat part of the contact boundary Γ3 let s be coordinates along the face, y
the distance from it into the body, and n = −ν. Given are an initial gap g(s) ≥ 0, the remaining gap
w(s, t) = g − u_ν ≥ 0, a pressure p(s, t) = −σ_ν ≥ 0 with w p = 0, and a slip z(s, t) = u_τ, which is 0 by default.
Let q = ε_nn and r = 2ε_sn be the strain on the face that p and z produce (``manufactured.face_strain``). The
displacement is

    u_s = z φ(y/ℓ) − y ∇_s (w − g) φ(y/ℓ) + y r φ(y/ℓ),     u_n = (w − g + y q) φ(y/ℓ),

with a depth ℓ and a polynomial φ on [0, 1] that satisfies φ(0) = 1, φ'(0) = 0 and φ(1) = 0; φ = 0 beyond 1. Other
functions of y with the same values and slopes at y = 0 may be used (``manufactured.profile``).

On the face y = 0, u_n = w − g, u_s = z, ε_ss = sym ∇_s z, ε_nn = q, and 2ε_sn = −∇_s (w − g) + r + ∇_s (w − g) = r.
By the choice of (q, r), σ_τ = 0 and σ_ν = −p. So the contact conditions hold exactly, for every contact zone. The
displacement vanishes for y ≥ ℓ, so (2.3) holds if Γ1 has at least this distance from the face.

Without slip, u also solves the problem of a perfectly rough foundation, to which the body is glued where it touches. So
only a case that slips while it is in contact shows whether a method has friction.

In the paper g = 0, and the contact conditions are (2.5). For g ≠ 0, which the paper does not treat, they are u_ν ≤ g,
σ_ν ≤ 0, σ_ν (u_ν − g) = 0 and σ_τ = 0.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple, Protocol

import numpy as np
import sympy as sp

from manufactured.arguments import Size, checked
from manufactured.body import Part
from manufactured.compiled import Jet
from manufactured.face_strain import Coupled, FaceStrain, Memory, relaxation_rate
from manufactured.law import KelvinVoigt, LawError, Linear, NonSymmetric, face_moduli
from manufactured.modes import Modes
from manufactured.profile import ZERO, Profile, cutoff
from manufactured.symbols import FormulaError, Index, Values, refuse_kinks, s, s1, s2, t
from manufactured.tensors import Array, Points, Tensors, Time, Vectors, mapped, pairs, rotation, with_time_axis

# The displacement of a contact face and its strain, as sums of terms.
#
# Each term is a derivative of w, q, r or z along the face times a function of the depth y. If there is an initial gap
# g, w − g replaces w.

ProfileSum = tuple[tuple[str, int], ...]
"""A function of the depth y: a sum of functions of ``Profile`` or their derivatives.

Each is given by its name and the order of its derivative, such as (("a", 1), ("b", 0)) for a' + b.
"""


class Term(NamedTuple):
    """One term of a component of a displacement u that is made from the data of a contact face, or of its strain ε(u).

    On the face there are the normal displacement u_n = w − g (gap w, initial gap g), the normal strain q, the shear
    strain r and the slip z; y is the distance into the body. The term is the product of a number, a derivative along
    the face of u_n, q, r or z, and a function of y.

    Attributes:
        row: the number of the component of u, or of the Mandel vector of ε(u), in the axes (s, n) of the face.
        factor: the number, √½ for off-diagonal components of ε(u), otherwise 1.
        source: the number of the function that is differentiated: 0 for u_n, 1 for q, and from 2 on the components of
            r, if there is shear, and then of z.
        along: the multi-index of the derivative along the face.
        profile: the function of y.
    """

    row: int
    factor: float
    source: int
    along: tuple[int, ...]
    profile: ProfileSum


@lru_cache
def displacement_terms(n: int, deep: bool, tangential: tuple[str, ...]) -> tuple[Term, ...]:
    """Return all terms of a displacement that is made from the data of a contact face, by the formula of ``Profile``.

    Args:
        n: the number of coordinates along the face, 1 or 2.
        deep: whether the profile has a function e, so that the displacement contains first derivatives of q.
        tangential: the names of the profile functions of those tangential fields that are not zero: "c" for r, "f" for
            z. Each field has n components.
    """
    zero, first = first_indices(n)
    sources = ((0, "a"), (1, "e")) if deep else ((0, "a"),)
    terms = [(i, source, first[i], name) for i in range(n) for source, name in sources]
    terms += [(i, 2 + n * number + i, zero, name) for i in range(n) for number, name in enumerate(tangential)]
    terms += [(n, 0, zero, "b"), (n, 1, zero, "d")]
    return tuple(Term(row, 1.0, source, along, ((name, 0),)) for row, source, along, name in terms)


@lru_cache
def strain_terms(n: int, deep: bool, tangential: tuple[str, ...]) -> tuple[Term, ...]:
    """Return all terms of the strain of the displacement that ``displacement_terms`` returns for the same arguments.

    Terms of a component with the same derivative along the face are one term.
    """
    _, first = first_indices(n)
    profiles: dict[tuple[int, float, int, tuple[int, ...]], ProfileSum] = {}
    for row, (i, j) in enumerate(pairs(n + 1)):
        factor = 1.0 if i == j else math.sqrt(0.5)
        # ε_ij contains ∂_j u_i and ∂_i u_j, the same derivative if i = j. The last axis points into the body.
        for component, axis in sorted({(i, j), (j, i)}):
            for term in displacement_terms(n, deep, tangential):
                if term.row == component:
                    into = int(axis == n)
                    along = term.along if into else plus(term.along, first[axis])
                    key = row, factor, term.source, along
                    ((name, _),) = term.profile
                    profiles[key] = (*profiles.get(key, ()), (name, into))
    return tuple(Term(*key, profile) for key, profile in profiles.items())


def plus(*indices: tuple[int, ...]) -> tuple[int, ...]:
    """Return the sum of multi-indices of the same length, component by component."""
    return tuple(map(sum, zip(*indices, strict=True)))


def first_indices(variables: int) -> tuple[tuple[int, ...], list[tuple[int, ...]]]:
    """Return the multi-index (0, …, 0) of a function itself, and the multi-indices of its first derivatives.

    Args:
        variables: the number of variables of the function.
    """
    unit = np.eye(variables, dtype=int)
    return (0,) * variables, [tuple(int(i) for i in row) for row in unit]


# The contact data on one part of the contact boundary, and the displacement that is made from them (lifting).

VARIABLES = {2: (s,), 3: (s1, s2)}
"""The symbols of the coordinates along a contact face, by the dimension of the body."""


class ContributionAtPoints(Protocol):
    """The interface of a displacement field at fixed points of the body, as a function of time.

    The displacement u of an exact solution is a sum of such fields. The methods return the field, (d, ...), its strain,
    (D, ...), or the gradient ∂_j of its strain, (D, d, ...), at a time; if ``rate`` is true, they return time
    derivatives. For n times, (n,), the results have n as an additional last axis. ``modes`` returns the strain for all
    times, as a sum of products of functions of the point and of time.
    """

    def displacement(self, time: Time, rate: bool = False) -> Vectors: ...
    def strain(self, time: Time, rate: bool = False) -> Tensors: ...
    def strain_gradient(self, time: Time, rate: bool = False) -> Array: ...
    def modes(self) -> Modes: ...


class Contribution(Protocol):
    """The interface of a displacement field on the body; the displacement of an exact solution is a sum of such fields.

    ``at`` returns the field at fixed points, (d, ...), as a function of time.
    """

    def at(self, x: Points) -> ContributionAtPoints: ...


class Face:
    """A displacement field with contact on one part of the contact boundary Γ3.

    Derived classes define the displacement (``at``) and the data below, which are formulas of the coordinates s along
    the part and of the time t.

    Attributes:
        part: the part of Γ3.
        gap, initial_gap: the formulas of the gap w(s, t) and of the initial gap g(s), which is 0 in the paper.
        level: the formula of the level function ψ(s, t); the contact zone is {ψ ≥ 0}.
        rough: the coordinates s at which the strain is singular or has a kink at all times.
        exponents_in: the formula from whose truncated powers the exponents of the strain at contact fronts are read
            off, for example the formula of the pressure.
    """

    part: Part
    gap: sp.Expr
    level: sp.Expr
    initial_gap: sp.Expr
    rough: tuple[float, ...]
    exponents_in: sp.Expr

    @property
    def variables(self) -> tuple[sp.Symbol, ...]:
        """The symbols of the coordinates along the face."""
        return VARIABLES[len(self.part.frame)]

    @cached_property
    def gap_jet(self) -> Jet:
        """The gap w(s, t) as an object that evaluates its formula and the derivatives along the face."""
        return Jet(self.gap, self.variables)

    @cached_property
    def initial_gap_jet(self) -> Jet:
        """The initial gap g(s) as an object that evaluates its formula and the derivatives along the face."""
        return Jet(self.initial_gap, self.variables)

    @cached_property
    def level_jet(self) -> Jet:
        """The level function ψ(s, t) as an object that evaluates its formula and the derivatives along the face."""
        return Jet(self.level, self.variables)

    @cached_property
    def pressure_jet(self) -> Jet | None:
        """The prescribed pressure p as a formula with its derivatives; None if p follows from a prescribed strain."""
        raise NotImplementedError

    def at(self, x: Points) -> ContributionAtPoints:
        """Return the part of the exact displacement that belongs to this face, at fixed points of the body, (d, ...).

        The result is a function of time. The exact displacement is the sum of the fields of all faces, and of further
        fields without contact.
        """
        raise NotImplementedError


DEFAULT_PROFILE = cutoff()
"""The default profile: the displacement is continued by the polynomial ``HERMITE`` down to the depth 1."""
ZERO_GAP = sp.Integer(0)
SIGNS, GAP_ROUNDING = {1: 1001, 2: 101}, 1e-12
"""The test that an initial gap is nowhere negative.

``SIGNS`` is the number of points along each axis of the face, in 2D and in 3D; ``GAP_ROUNDING`` is the permitted
relative round-off.
"""
PLACES, DIVISIONS, PARTS = 1000, 11, 16
"""Numbers for the search of contact fronts, where the level function ψ changes its sign along a face.

The sign of ψ is tested at ``PLACES`` points of the face. An interval in which it changes is divided into ``PARTS``
parts, and then the part with the change again, ``DIVISIONS`` times, down to 1e-16 of the face.
"""


@dataclass(frozen=True, eq=False)
@checked(FormulaError)
class ContactFace(Face):
    """The contact data on one part of the contact boundary Γ3, from which the displacement in the body is made.

    Attributes:
        part: the part of Γ3.
        gap: the formula of the gap w(s, t) = g − u_ν, where g is the initial gap, with the symbols ``s`` (``s1`` and
            ``s2`` in 3D) and ``t``.
        strain: the normal strain q and the shear strain r on the face, as functions of s and t.
        level: the formula of a function ψ(s, t); the contact zone is {ψ ≥ 0}.
        profile: the functions of the depth y that continue the data into the body.
        rough: the coordinates s at which the strain is singular or has a kink at all times; quadrature cuts cells
            there.
        initial_gap: the formula of g(s), the distance of the undeformed body from the foundation; 0 in the paper.
        slip: the formulas of the components of the slip z(s, t) = u_τ along the coordinates of the face, one in 2D and
            two in 3D; () if the face does not slip. ``strain`` must be such that the stress has the wanted contact
            pressure and σ_τ = 0, as ``ContactFace.linear`` computes it.

    Raises:
        FormulaError: a kink is not written with ``pos``; a formula has symbols other than s, s1, s2 and t; an entry of
            ``rough`` is not a finite number; the initial gap depends on t or is negative somewhere; or the number of
            components of the slip is wrong.
    """

    part: Part
    gap: sp.Expr
    strain: FaceStrain
    level: sp.Expr
    profile: Profile = DEFAULT_PROFILE
    rough: tuple[float, ...] = ()
    initial_gap: sp.Expr = ZERO_GAP
    slip: tuple[sp.Expr, ...] = ()

    def __post_init__(self) -> None:
        refuse_kinks(self.gap, self.strain.formula, self.level, self.initial_gap)
        _require_components(self.slip, self.variables)
        # Computed now, so that an invalid formula raises an error when the face is made and not when it is used.
        self.gap_jet, self.level_jet, self.jets  # noqa: B018
        self._refuse_wrong_initial_gap()

    @classmethod
    @checked(FormulaError)
    def linear(
        cls,
        part: Part,
        law: KelvinVoigt,
        T: Size,
        gap: sp.Expr,
        pressure: sp.Expr,
        level: sp.Expr,
        initial: sp.Expr | None = None,
        profile: Profile = DEFAULT_PROFILE,
        rough: tuple[float, ...] = (),
        initial_gap: sp.Expr = ZERO_GAP,
        slip: tuple[sp.Expr, ...] = (),
    ) -> ContactFace:
        """Return the contact face for a linear law; the strain on the face is computed from pressure and slip.

        Args:
            part: the part of the contact boundary.
            law: the material law, with linear G.
            T: the final time.
            gap: the formula of the gap w(s, t).
            pressure: the formula of the contact pressure p(s, t).
            level: the formula of the level function ψ(s, t); the contact zone is {ψ ≥ 0}.
            initial: the formula of the normal strain q(s, 0); there is no shear strain at t = 0. By default the strain
                starts at rest, q̇(s, 0) = 0; without slip, the body then starts in elastic equilibrium.
            profile, rough, initial_gap, slip: see ``ContactFace``.

        In this example the left half of the bottom of the unit square is always in contact, with p = t(½ − s)²₊:

        >>> from sympy import Rational
        >>> from manufactured import ContactFace, ExactSolution, Kind, KelvinVoigt, isotropic, pos, s, t, unit_square
        >>> body, law, c = unit_square(), KelvinVoigt(isotropic(1, 1), isotropic(1, 2), "linear"), Rational(1, 2)
        >>> (floor,) = body.of(Kind.CONTACT)
        >>> face = ContactFace.linear(floor, law, body.T, t * pos(s - c, 4), t * pos(c - s, 2), c - s)
        >>> on = ExactSolution(body, law, (face,)).on(face, [[0.1, 0.9]])
        >>> abs(on.pressure(1.0)).round(4).tolist(), on.gap(1.0).round(4).tolist()
        ([0.16, 0.0], [0.0, 0.0256])

        Raises:
            LawError: the dimensions of law and part differ; G is not linear (prescribe q with
                ``face_strain.Prescribed`` instead); or it couples the normal strain nn and the shear strain sn not
                symmetrically.
            FormulaError: a kink is not written with ``pos``, the slip has a wrong number of components, or the ratio
                of the normal moduli of G and A varies along the face. If a part of the pressure may not be smooth in t,
                the method ``at`` of the result raises it.
        """
        refuse_kinks(gap, pressure, level, initial, initial_gap, *slip)
        law.require_dimension(part.dim)
        if not isinstance(law.G, Linear | NonSymmetric):
            raise LawError(f"{law.name}: only a linear G turns a pressure into a strain; prescribe the strain")
        variables = VARIABLES[law.dim]
        _require_components(slip, variables)
        viscous, elastic = face_moduli(law.A, part.frame), face_moduli(law.G, part.frame)
        scale, stiffness = (tensor.factor.along(part.start, part.frame[:, :-1], variables) for tensor in (law.A, law.G))
        # The normal and tangential stresses that the slip causes, l = A_·ss ∂_s ż + G_·ss ∂_s z, (d,).
        slope = np.array([z.diff(x) for z in slip for x in variables], dtype=object)
        rate = np.array([change.diff(t) for change in slope], dtype=object)
        of_slip = slice(law.dim, law.dim + len(slope))
        stress = viscous[:, of_slip] @ (scale * rate) + elastic[:, of_slip] @ (stiffness * slope)
        viscous, elastic = viscous[:, : law.dim], elastic[:, : law.dim]
        rest = level, profile, rough, initial_gap, slip
        if not (viscous[0, 1:].any() or elastic[0, 1:].any() or elastic[1:, 0].any() or stress[1:].any()):
            a, g = float(viscous[0, 0]) * scale, float(elastic[0, 0]) * stiffness
            return cls(part, gap, Memory(pressure, a, g, T, initial, variables, stress[0]), *rest)
        if not np.allclose(elastic, elastic.T, rtol=1e-12, atol=0):
            raise LawError(
                f"{law.name}: G is not symmetric and couples nn with sn, for which the strain on a face is not known; "
                "prescribe the strain, or take a G whose nn–sn moduli are equal to its sn–nn moduli"
            )
        elastic = relaxation_rate(stiffness, scale) * elastic
        return cls(
            part, gap, Coupled.of(pressure, tuple(stress), viscous, elastic, scale, T, initial, variables), *rest
        )

    @cached_property
    def jets(self) -> tuple[Jet, ...]:
        """The displacement of the face, u_n = −u_ν = w − g and then the components of the slip, with their derivatives.

        w is the gap and g the initial gap. Each entry evaluates a formula of (s, t) and its derivatives along the face.
        """
        return tuple(Jet(u, self.variables) for u in (self.gap - self.initial_gap, *self.slip))

    @cached_property
    def rate_jets(self) -> tuple[Jet, ...]:
        """The velocity of the face, ∂_t u_n = ∂_t w and then the components of ∂_t z, with their derivatives.

        Each entry evaluates a formula of (s, t) and its derivatives along the face.
        """
        return tuple(jet.rate() for jet in self.jets)

    @property
    def tangential(self) -> tuple[str, ...]:
        """The names of the profile functions that belong to tangential fields on the face that are not zero.

        The name is "c" for the shear strain r and "f" for the slip z.
        """
        return ("c",) * isinstance(self.strain, Coupled) + ("f",) * bool(self.slip)

    @cached_property
    def pressure_jet(self) -> Jet | None:
        """The prescribed pressure p as a formula with its derivatives; None if p follows from a prescribed strain."""
        stated = getattr(self.strain, "pressure", None)
        return None if stated is None else Jet(stated, self.variables)

    @property
    def exponents_in(self) -> sp.Expr:
        """The formula from whose truncated powers the exponents of the strain at contact fronts are read off.

        It is the sum of ``strain.formula``, which contains the pressure if the strain follows from it, and of the
        components of the slip.
        """
        return self.strain.formula + sum(self.slip)

    def fronts(self, time: float) -> tuple[float, ...]:
        """Return the contact fronts at a time for a body in 2D: the coordinates s at which ψ(·, t) changes its sign.

        Two fronts whose distance is less than a thousandth of the face may be missed.
        """

        def contact(s: Array) -> Array:
            return np.broadcast_to(self.level_jet(s[None], time)[(0,)] > 0, s.shape)

        # Fronts often lie at simple fractions of the face. The grid is not uniform, so that they do not coincide with
        # its points.
        grid = self.part.measure * np.linspace(0, 1, PLACES) ** 1.01
        inside = contact(grid)
        here = np.flatnonzero(inside[:-1] != inside[1:])
        low, high, left = grid[here], grid[here + 1], inside[here]
        parts = np.arange(1, PARTS)[:, None] / PARTS
        for _ in range(DIVISIONS if here.size else 0):
            # Many parts instead of bisection, because evaluating a formula takes about as long for many points as for
            # one.
            places = np.vstack([low, low + (high - low) * parts, high])
            before = (contact(places[1:-1]) == left).cumprod(axis=0).sum(axis=0)
            low, high = np.take_along_axis(places, before + np.array([[0], [1]]), axis=0)
        return tuple(map(float, (low + high) / 2))

    def _refuse_wrong_initial_gap(self) -> None:
        """Raise FormulaError if the initial gap depends on t or is negative somewhere on the face."""
        if self.initial_gap.has(t):
            raise FormulaError(
                f"the initial gap {self.initial_gap} depends on t, but it is the distance of the undeformed body from "
                "a foundation that rests: give a formula of the coordinates along the face alone"
            )
        places = self.part.grid(np.linspace(0, 1, SIGNS[self.part.dim - 1]))
        values = np.broadcast_to(self.initial_gap_jet(places, 0.0)[(0,) * len(places)], places.shape[1:])
        if not (worst := values.min(initial=0.0)) >= -GAP_ROUNDING * abs(values).max(initial=0.0):
            where = ", ".join(f"{coordinate:.4g}" for coordinate in places[:, np.argmin(values)])
            raise FormulaError(
                f"the initial gap {self.initial_gap} is {worst:.4g} at s = {where}, where the undeformed body would "
                "penetrate the foundation: give a gap that is 0 or more on the whole face"
            )

    def at(self, x: Points) -> Lifting:
        """Return the field that continues the displacement on this face into the body, at fixed points, (d, ...).

        The result is a function of time.
        """
        return Lifting(self, x)


Trace = tuple[int, Index]
"""A derivative along the contact face of the gap, the normal or shear strain, or the slip on the face.

It is a pair of the number of the function (``Term.source``) and the multi-index of the derivative.
"""


def traces_at(face: ContactFace, s: Array) -> Callable[[Time, bool, int], tuple[Values, ...]]:
    """Return a function that evaluates the displacement u_n, the strain (q, r) and the slip z on a face at points s.

    A call with the time, ``rate`` and ``order`` returns u_n, q, the components of r if there is shear, and the
    components of z, in the order of ``Term.source``. Each has its derivatives along the face: u_n up to the order
    ``order`` + 1, the others up to ``order``. If ``rate`` is true, the time derivatives of all of them are returned.
    """
    strain = face.strain.at(s)

    def traces(time: Time, rate: bool, order: int) -> tuple[Values, ...]:
        jets = face.rate_jets if rate else face.jets
        u_n, *slip = (jet(with_time_axis(s, time), time, order + 1) for jet in jets)
        return u_n, *strain(time, rate, order), *slip

    return traces


class Lifting:
    """Evaluates the displacement field that continues the data of a contact face into the body, at fixed points.

    Its strain and the rates of both are evaluated as well. For n times, the results have n as an additional last axis.
    Factors that do not depend on time are computed once. Formulas are evaluated once for each distinct coordinate s,
    because many points have the same s on structured meshes. At points deeper than the profile reaches, all fields are
    zero.
    """

    def __init__(self, face: ContactFace, x: Points) -> None:
        self.face = face
        self.frame = face.part.frame
        turned = rotation(self.frame)
        self.rotation = None if np.array_equal(turned, np.eye(len(turned))) else turned
        places, self.y = face.part.coordinates(x)
        self.reach = np.real(self.y) < face.profile.depth
        if not self.reach.all():
            places, self.y = places[:, self.reach], self.y[self.reach]
        self.s, self.where = distinct(places)
        self.on_face = traces_at(face, self.s)
        kinds = len(self.s), self.deep, face.tangential
        self.displacement_terms, self.strain_terms = displacement_terms(*kinds), strain_terms(*kinds)
        self._profiles: dict[tuple[ProfileSum, int], Array] = {}

    def profile(self, profile: ProfileSum, derivative: int) -> Array:
        """Return a derivative in y of a sum of profile functions (``Term.profile``) at the points, cached."""
        if (profile, derivative) not in self._profiles:
            self._profiles[profile, derivative] = sum(
                getattr(self.face.profile, name)(self.y, derivative + order) for name, order in profile
            )
        return self._profiles[profile, derivative]

    def traces(self, time: Time, rate: bool, order: int) -> tuple[Values, ...]:
        """Return the data of the contact face at the coordinates s of every point, with derivatives along the face.

        The data are the normal displacement u_n, with derivatives up to ``order`` + 1, and the normal strain q, shear
        strain r and slip z, with derivatives up to ``order``.

        Args:
            time: a time, or n times (n,).
            rate: whether the time derivatives of the data are returned instead of the data.
            order: the highest order of the derivatives of q, r and z along the face.

        Returns:
            u_n, q, the components of r if there is shear, and the components of z. Each is a dict from multi-indices of
            derivatives to values at the points.
        """
        traces = self.on_face(time, rate, order)
        if self.where is None:
            return traces
        return tuple({index: values[self.where] for index, values in trace.items()} for trace in traces)

    def displacement(self, time: Time, rate: bool = False) -> Vectors:
        """Return the displacement u, or the velocity u̇ if ``rate`` is true, in global axes, (d, ...)."""
        traces = self.traces(time, rate, int(self.deep))
        local = self._local(self.displacement_terms, traces, (0,) * len(self.s), 0, time)
        return self._everywhere(mapped(self.frame, local), 1)

    def _everywhere(self, values: Array, inner: int) -> Array:
        """Return values at all points: the given values within the depth of the profile, and 0 at deeper points.

        The axes of the points follow the first ``inner`` axes.
        """
        if self.y.shape == self.reach.shape:
            return values
        shape = (*values.shape[:inner], *self.reach.shape, *values.shape[inner + self.y.ndim :])
        found = np.zeros(shape, dtype=values.dtype)
        found[(slice(None),) * inner + (self.reach,)] = values
        return found

    def strain(self, time: Time, rate: bool = False) -> Tensors:
        """Return the strain ε(u), or its rate if ``rate`` is true, in global axes, as Mandel vectors (D, ...)."""
        traces = self.traces(time, rate, 1 + self.deep)
        return self._everywhere(self._strain(traces, (0,) * len(self.s), 0, time), 1)

    def _strain(self, traces: tuple[Values, ...], along: Index, into: int, time: Time) -> Tensors:
        """Return the derivative ∂_s^along ∂_y^into of the strain in global axes; ``into`` is 0 or 1."""
        local = self._local(self.strain_terms, traces, along, into, time)
        return local if self.rotation is None else mapped(self.rotation, local)

    def strain_gradient(self, time: Time, rate: bool = False) -> Array:
        """Return the derivatives ∂_j of the strain, or of its rate if ``rate`` is true, in global axes, (D, d, ...).

        At fronts they may not exist; one-sided values are returned there.
        """
        traces = self.traces(time, rate, 2 + self.deep)
        zero, first = first_indices(len(self.s))
        places = [(i, 0) for i in first] + [(zero, 1)]
        local = np.array([self._strain(traces, along, into, time) for along, into in places])
        return self._everywhere(np.moveaxis(mapped(self.frame, local), 0, 1), 2)

    def modes(self) -> Modes:
        """Return the strain ε(u) as a sum of products, each of a function of the point and a function of (s, t).

        s is the coordinate of the point along the face.
        """
        axes = rotation(self.frame)
        terms = self.strain_terms
        tensors = np.array([axes[:, term.row] for term in terms])
        shapes = np.array([term.factor * self.profile(term.profile, 0).ravel() for term in terms])
        return self.products(tensors, shapes, [(term.source, term.along) for term in terms], 1 + self.deep)

    def products(self, tensors: Array, shapes: Array, traces: Sequence[Trace], order: int) -> Modes:
        """Return a sum of K products of a constant tensor, a function of the point, and a function of (s, t).

        The functions of (s, t) are derivatives along the face of the normal displacement u_n, the normal strain q, the
        shear strain r and the slip z.

        Args:
            tensors: the K constant tensors, (K, D), or vectors, (K, d).
            shapes: the K functions of the point, at the n points within the depth of the profile, (K, n).
            traces: the K derivatives, each as a pair: the number of the function (``Term.source``), and the
                multi-index of its derivative.
            order: the highest order of the derivatives of q, r and z.
        """
        # The function below uses local variables. A reference to ``self`` would keep the arrays of all points in
        # memory.
        on_face, count = self.on_face, self.s[0].size

        def amplitudes(time: Time, rate: bool) -> Array:
            data = on_face(time, rate, order)
            found = np.array([data[source][along] for source, along in traces])
            return found.reshape(len(traces), count, *np.shape(time))

        places = np.arange(self.y.size) if self.where is None else self.where.ravel()
        return Modes(tensors, np.flatnonzero(self.reach), shapes, places, count, amplitudes)

    @property
    def deep(self) -> bool:
        """Whether the profile has a function e ≠ 0, so that strains contain second derivatives along the face.

        They are the second derivatives of the normal strain q on the face.
        """
        return self.face.profile.e is not ZERO

    def _local(self, terms: tuple[Term, ...], traces: tuple[Values, ...], along: Index, into: int, time: Time) -> Array:
        """Return the derivative ∂_s^along ∂_y^into of a sum of terms in the axes (s, n) of the face; ``into`` ≤ 1."""
        dtype = np.result_type(*(trace[along] for trace in traces), self.y)
        components = np.empty((1 + terms[-1].row, *self.y.shape, *np.shape(time)), dtype=dtype)
        begun: set[int] = set()
        for term in terms:
            profile = with_time_axis(self.profile(term.profile, into), time)
            # The first term of each row initialises the row, so the array need not be filled with zeros.
            first = term.row not in begun
            trace = traces[term.source][plus(term.along, along)]
            part = np.multiply(trace, profile, out=components[term.row] if first else None)
            if term.factor != 1:
                part *= term.factor
            if not first:
                components[term.row] += part
            begun.add(term.row)
        return components


def _require_components(slip: tuple[sp.Expr, ...], variables: tuple[sp.Symbol, ...]) -> None:
    if len(slip) not in (0, len(variables)):
        raise FormulaError(
            f"the slip {slip} has {len(slip)} components; give a tuple with one formula for each coordinate along the "
            f"face ({', '.join(map(str, variables))}), or () for a face that does not slip"
        )


def distinct(places: Array) -> tuple[Array, Array | None]:
    """Find the distinct coordinates s along a contact face among the coordinates of many points.

    Coordinates that differ only by round-off count as equal. The argument ``places`` has the shape (d − 1, ...).

    Returns:
        The distinct coordinates, (d − 1, m), and for each point the index of its coordinates, (...). If few coordinates
        are equal, the result is (places, None).
    """
    if np.iscomplexobj(places) or places[0].size < 64:
        return places, None
    rounded = np.round(places.reshape(len(places), -1), 13)
    # To sort pairs of coordinates, each pair is stored as one complex number, which NumPy sorts by real, then imaginary
    # part.
    keys = rounded[0] if len(rounded) == 1 else rounded[0] + 1j * rounded[1]
    distinct = np.unique(keys)
    if 2 * len(distinct) > len(keys):
        return places, None
    where = np.searchsorted(distinct, keys).reshape(places.shape[1:])
    return np.array([distinct.real, distinct.imag])[: len(places)], where


# Contact faces in 2D on which all contact data are formulas, also the pressure.


@dataclass(frozen=True, eq=False)
class StatedFace(Face):
    """The contact data of a part of the contact boundary in 2D, all given by formulas of s and t.

    s is the coordinate along the part, and t the time. Derived classes add the displacement.

    Attributes:
        part: the part of the contact boundary.
        gap: the formula of the gap w(s, t).
        pressure: the formula of the contact pressure p(s, t). It must be the pressure that the law gives; the
            self-proof checks this.
        level: the formula of the level function ψ(s, t); the contact zone is {ψ ≥ 0}.

    Raises:
        FormulaError: a kink of a formula is not written with ``pos``.
    """

    part: Part
    gap: sp.Expr
    pressure: sp.Expr
    level: sp.Expr

    initial_gap = ZERO_GAP

    def __post_init__(self) -> None:
        refuse_kinks(*(value for value in vars(self).values() if isinstance(value, sp.Expr)))

    @cached_property
    def pressure_jet(self) -> Jet:
        return Jet(self.pressure)

    @property
    def exponents_in(self) -> sp.Expr:
        """The contact pressure, from whose truncated powers the exponents of the strain at fronts are read off."""
        return self.pressure
