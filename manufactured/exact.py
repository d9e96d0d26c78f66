"""Exact solutions {u, σ} of Problem 2.1, and the data f_0, f_2 and u_0 that belong to them."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from functools import cached_property, reduce
from operator import methodcaller
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from manufactured.arguments import checked
from manufactured.body import Body, BodyError, Kind, Part
from manufactured.compiled import Jet
from manufactured.contact import (
    ContactFace,
    Contribution,
    ContributionAtPoints,
    Face,
    Lifting,
    Trace,
    first_indices,
    plus,
)
from manufactured.law import AtPoints, KelvinVoigt, LawError, PointLaw, Scaled
from manufactured.modes import Modes, at_each, pointwise
from manufactured.symbols import Index, Values
from manufactured.tensors import (
    Array,
    Hyperplane,
    Points,
    Tensors,
    Time,
    Vectors,
    basis,
    rotation,
    traction,
    with_time_axis,
)

# Checks that points lie in the body and times in [0, T].
#
# This is necessary because the formulas of exact solutions can also be evaluated elsewhere, where they are no solution.


DOMAIN_ROUNDING = 1e-9
"""Distance that counts as round-off: of a point from the body, relative to its extent, and of a time from [0, T]."""


def coordinates(values: ArrayLike, count: int, what: str) -> Array:
    """Return the coordinates of points as an array, (count, ...), after a check.

    Args:
        values: the coordinates, an array or lists of numbers.
        count: the number of coordinates of a point.
        what: the name of the points in the message of an error.

    Raises:
        ValueError: the array has another shape. The message names the points by ``what``.
    """
    wanted = f"{what} need the shape ({count}, n), one row for each coordinate"
    try:
        found = np.asarray(values)
    except ValueError as error:
        raise ValueError(f"{wanted}; got rows of different lengths") from error
    if found.dtype.kind not in "iufc":
        raise ValueError(f"{wanted}, of numbers; got entries of the type {found.dtype}")
    if found.ndim >= 2 and len(found) == count:
        return found
    if found.shape == (count,):
        hint = f"; write one point as [{', '.join(f'[{value:g}]' for value in np.real(found))}]"
    elif found.ndim == 2 and found.shape[1] == count:
        hint = "; transpose it"
    else:
        hint = ""
    raise ValueError(f"{wanted}; got the shape {found.shape}{hint}")


def require_inside(body: Body, x: Points) -> None:
    """Raise ValueError if a point of x, (d, ...), lies outside the body by more than round-off."""
    points = np.real(x).reshape(body.dim, -1)
    reach = DOMAIN_ROUNDING * body.extent
    # Comparisons with NaN are false, so the condition is written such that NaN coordinates are refused.
    with np.errstate(invalid="ignore"):
        within = [part.normal @ points <= part.normal @ part.start + reach for part in body.parts]
        left = points[:, ~np.all(within, axis=0)]
        left = left[:, ~body.contains(left)]
        left = left[:, ~np.any([part.contains(left, reach) for part in body.parts], axis=0)]
    if left.size:
        low, high = body.vertices.min(axis=1), body.vertices.max(axis=1)
        box = " × ".join(f"[{a:g}, {b:g}]" for a, b in zip(low, high, strict=True))
        raise ValueError(
            f"the point ({', '.join(f'{value:g}' for value in left[:, 0])}) lies outside the body, where there is no "
            f"exact solution ({left.shape[1]} of {points.shape[1]} points); the body lies in {box}, and "
            "body.contains(x) says which points it has"
        )


def require_times(T: float, time: Time) -> None:
    """Raise ValueError if a time lies outside [0, T] by more than round-off."""
    times = np.asarray(time).real.reshape(-1)
    # Comparisons with NaN are false, so the condition is written such that NaN is refused.
    outside = ~(abs(times - T / 2) <= (0.5 + DOMAIN_ROUNDING) * T)
    if outside.any():
        first = times[outside][0]
        raise ValueError(f"the time {first:g} lies outside [0, {T:g}], where there is no exact solution; T is body.T")


# The body force f_0 of a linear law as a sum of fixed fields times functions of time and of the face coordinate s.
#
# For a linear operator C, −Div(α C ε(u)) is linear in u. The displacement of a contact face is linear in the
# derivatives of w, q, r and z (gap, normal and shear strain, slip) along the face. So f_0 is a sum over these
# derivatives, each multiplied by a field that does not depend on time. Other displacement fields are evaluated point by
# point.


@dataclass(frozen=True, eq=False)
class ForceModes:
    """The body force f_0 = −Div(A ε(u̇)) − Div(G ε(u)) as sums of products of functions of the point and of time.

    Attributes:
        viscous: −Div(A ε(u)), with one sum for each of the displacement fields that add up to u. Its time derivative is
            the viscous part of f_0.
        elastic: −Div(G ε(u)), the elastic part of f_0, with one sum for each field.
    """

    viscous: list[Modes]
    elastic: list[Modes]


def force_modes(of: AtPoints, part: ContributionAtPoints, count: int) -> Modes:
    """Return the force −Div(α C ε) of a displacement field at ``count`` points, as a sum of products.

    A product has a function of the point and a function of time. In the result, ``Modes.tensors`` are the constant
    vectors of the K products, (K, d).

    Args:
        of: the linear operator ε ↦ α C ε at the points.
        part: the displacement field with the strain ε at the points.
        count: the number of points.

    Raises:
        LawError: the operator is not linear.
    """
    if not isinstance(of, Scaled):
        raise LawError("f_0 is a sum of products for linear A and G only; take body_force")
    return _of_lifting(of, part) if isinstance(part, Lifting) else _of_points(of, part, count)


def _of_points(of: Scaled, part: ContributionAtPoints, count: int) -> Modes:
    """Return the force of any displacement field, with one time-dependent value for each point and component."""
    dim = 2 if len(of.matrix) == 3 else 3

    def force(time: Time, rate: bool) -> Array:
        def one(moment: complex) -> Array:
            slope = of.gradient(lambda: part.strain(moment, rate), part.strain_gradient(moment, rate))
            return -np.einsum("Iij,Ij...->i...", basis(dim), slope)

        return at_each(time, one)

    return pointwise(force, dim, count)


def _of_lifting(of: Scaled, lifting: Lifting) -> Modes:
    """Return the force of a contact face as a sum of products.

    There is one product for each derivative of w, q and r, and each component of its field that is not zero.
    """
    fields = _fields_of(of, lifting)
    dim = len(lifting.frame)
    chosen = [(trace, i) for trace, values in fields.items() for i in range(dim) if values[i].any()]
    directions = np.eye(dim)[[i for _, i in chosen]]
    shapes = np.array([fields[trace][i] for trace, i in chosen])
    return lifting.products(directions, shapes, [trace for trace, _ in chosen], 2 + lifting.deep)


def _fields_of(of: Scaled, lifting: Lifting) -> dict[Trace, Array]:
    """Return the force fields −Div(α C ε) that belong to single derivatives of w, q, r and z along the face.

    The field of a derivative is the force if this derivative is 1 and all others are 0. It is given at the n points
    that the displacement reaches, (d, n).
    """
    frame, reach = lifting.frame, lifting.reach
    axes, (_, first) = rotation(frame), first_indices(len(lifting.s))
    factor = of.factor if isinstance(of.factor, float) else of.factor[reach]
    fields: defaultdict[Trace, Any] = defaultdict(float)
    for term in lifting.strain_terms:
        stress = np.einsum("Iij,I->ij", basis(len(frame)), of.matrix @ axes[:, term.row])
        value, slope = (term.factor * lifting.profile(term.profile, into).ravel() for into in range(2))
        for unit, direction in zip(first, frame.T, strict=False):
            fields[term.source, plus(term.along, unit)] -= np.multiply.outer(stress @ direction, factor * value)
        fields[term.source, term.along] -= np.multiply.outer(stress @ frame[:, -1], factor * slope)
        if of.slopes is not None:
            fields[term.source, term.along] -= stress @ of.slopes[:, reach] * value
    return fields


# The class of exact solutions, and their fields at fixed points.


@dataclass(frozen=True, eq=False)
@checked(ValueError)
class ExactSolution:
    """An exact solution of Problem 2.1, and the loads that belong to it.

    The displacement u is the sum of displacement fields. The stress is σ = A ε(u̇) + G ε(u), and the loads are
    f_0 = −Div σ and f_2 = σν.

    Attributes:
        body: the body with its boundary parts and the final time T.
        law: the material law, with viscosity A and elasticity G.
        faces: one displacement field for each part of Γ3, in the order of ``body.of(Kind.CONTACT)``. The field of one
            face must vanish on Γ1 and must not change the contact data of other faces.
        others: displacement fields without contact, such as the singularity of a corner.
        singular: vertices of the body at which the strain is singular.

    Raises:
        LawError: law and body have different dimensions.
        BodyError: the body has no Γ3.
        ValueError: the faces do not belong to the parts of Γ3, or a displacement field ends with a kink inside the
            body.
    """

    body: Body
    law: KelvinVoigt
    faces: tuple[Face, ...]
    others: tuple[Contribution, ...] = ()
    singular: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        self.law.require_dimension(self.body.dim)
        pieces = self.body.of(Kind.CONTACT)
        if not pieces:
            raise BodyError("the body has no part Γ3, which the Signorini condition (2.5) needs: give a side this kind")
        if self.body.of(Kind.ROLLER):
            raise BodyError("the body has a ROLLER side, which exact solutions do not serve: give it another kind")
        if [face.part for face in self.faces] != list(pieces):
            got = f"{len(self.faces)} contact faces"
            strange = [str(k) for k, face in enumerate(self.faces, start=1) if face.part not in pieces]
            if strange:
                got += f", of which face {', '.join(strange)} is on no part Γ3 of this body"
            raise ValueError(
                f"expected {len(pieces)} contact faces, one for each part Γ3 of the body in the order of "
                f"body.of(Kind.CONTACT), got {got}"
            )
        for face in self.faces:
            if not isinstance(face, ContactFace):
                continue
            deepest = float(face.part.coordinates(self.body.vertices)[1].max())
            if deepest > face.profile.depth * (1 + 1e-12) and face.profile.ends_with_kink:
                raise ValueError(
                    f"the body is {deepest:g} deep, but the lifting ends with a kink at the depth "
                    f"{face.profile.depth:g}: let it end at Γ1, or take a cut-off with φ(1) = φ'(1) = 0 such as HERMITE"
                )

    @property
    def rough(self) -> tuple[Hyperplane, ...]:
        """The lines or planes across which the strain is never smooth.

        They are the lines perpendicular to a contact face through its points ``rough``, and the lines or planes across
        which A or G jumps.
        """
        fronts = (face.part.line(c) for face in self.faces if isinstance(face, ContactFace) for c in face.rough)
        return (*fronts, *self.law.steps)

    @property
    def has_initial_gap(self) -> bool:
        """Whether a contact face has an initial gap, which the paper does not treat."""
        return any(face.initial_gap != 0 for face in self.faces)

    def fronts(self, time: float) -> tuple[Hyperplane, ...]:
        """Return the lines {s = c} through the fronts c of one time, at which f_0 jumps or has kinks; none in 3D."""
        faces = [face for face in self.faces if isinstance(face, ContactFace)] if self.body.dim == 2 else []
        return tuple(face.part.line(c) for face in faces for c in face.fronts(time))

    def at(self, x: ArrayLike) -> Fields:
        """Return the fields of the solution at fixed points of the body, (d, ...), as functions of t ∈ [0, T].

        Points may lie outside the body by round-off.

        >>> from manufactured import named
        >>> solution = named("full-contact").solution
        >>> solution.at([[0.5], [1.0]]).displacement(1.0).ravel().tolist()  # clamped on top
        [0.0, 0.0]
        >>> solution.at([[5], [5]])  # doctest: +ELLIPSIS
        Traceback (most recent call last):
        ValueError: the point (5, 5) lies outside the body, where there is no exact solution (1 of 1 points); ...

        Raises:
            ValueError: x has another shape, or a point lies outside the body; the methods of the result raise it for
                times outside [0, T].
        """
        points = coordinates(x, self.body.dim, "points of the body")
        require_inside(self.body, points)
        return Fields(self, points)

    def on(self, face: Face, s: ArrayLike) -> FaceFields:
        """Return the contact data at fixed points s of a contact face, (d − 1, ...), as functions of t ∈ [0, T].

        These data are the gap, the contact pressure and the level function of the contact zone.

        Args:
            face: one of ``faces``.
            s: the coordinates of the points along the face, (d − 1, ...): in 2D a list with one list, [[s, ...]].

        Raises:
            ValueError: s has another shape, or a point lies outside the body. The methods of the result raise it for
                times outside [0, T].
        """
        return FaceFields(self, face, coordinates(s, self.body.dim - 1, "points of a face"))


class Fields:
    """The fields of an exact solution at fixed points, (d, ...), as functions of time.

    For n times, (n,), the results have n as an additional last axis.
    """

    def __init__(self, solution: ExactSolution, x: Points) -> None:
        self.solution, self.x = solution, x
        self._parts: list[ContributionAtPoints] = [*map(methodcaller("at", x), (*solution.faces, *solution.others))]

    @cached_property
    def law(self) -> PointLaw:
        """The material law at the points."""
        return self.solution.law.at(self.x)

    @cached_property
    def _law_at_times(self) -> PointLaw:
        return self.solution.law.at(self.x[..., None])

    def _law(self, time: Time) -> PointLaw:
        return self._law_at_times if np.ndim(time) else self.law

    def _total(self, quantity: str, time: Time, rate: bool = False) -> Array:
        """Return the sum of a quantity, such as "strain", or of its rate, over all displacement fields."""
        require_times(self.solution.body.T, time)
        return reduce(np.add, map(methodcaller(quantity, time, rate=rate), self._parts))

    def displacement(self, time: Time) -> Vectors:
        """Return the displacement u, (d, ...)."""
        return self._total("displacement", time)

    def velocity(self, time: Time) -> Vectors:
        """Return the velocity u̇, (d, ...)."""
        return self._total("displacement", time, rate=True)

    def strain(self, time: Time) -> Tensors:
        """Return the strain ε(u), (D, ...)."""
        return self._total("strain", time)

    def strain_rate(self, time: Time) -> Tensors:
        """Return the strain rate ε(u̇), (D, ...)."""
        return self._total("strain", time, rate=True)

    def modes(self) -> list[Modes]:
        """Return the strain of each displacement field as a sum of products of functions of the point and of time.

        The displacement of the exact solution is the sum of these fields. Points are numbered in the order of the array
        of points for which this object was made.
        """
        return [part.modes() for part in self._parts]

    def strain_gradient(self, time: Time) -> Array:
        """Return the derivatives ∂_j of the strain ε(u), (D, d, ...)."""
        return self._total("strain_gradient", time)

    def stress(self, time: Time) -> Tensors:
        """Return the stress σ = A ε(u̇) + G ε(u) of (2.1), (D, ...)."""
        return self._law(time).stress(self.strain_rate(time), self.strain(time))

    def body_force(self, time: Time) -> Vectors:
        """Return the body force f_0 = −Div σ of (2.2), (d, ...).

        It is computed by ∂_j σ = A ∂_j ε̇ + G'(ε)[∂_j ε], plus the derivatives of the material factors.
        """
        rate_gradient = self._total("strain_gradient", time, rate=True)
        law = self._law(time)
        slope = law.A.gradient(lambda: self.strain_rate(time), rate_gradient)
        slope = slope + law.G.gradient(lambda: self.strain(time), self.strain_gradient(time))
        return -np.einsum("Iij,Ij...->i...", basis(slope.shape[1]), slope)

    def force_modes(self) -> ForceModes:
        """Return the body force f_0 as sums of products of functions of the point and of time; G must be linear.

        Points are numbered in the order of the array of points for which this object was made.
        """
        viscous, elastic = (
            [force_modes(tensor, part, self.x[0].size) for part in self._parts] for tensor in (self.law.A, self.law.G)
        )
        return ForceModes(viscous, elastic)

    def surface_load(self, part: Part, time: Time) -> Vectors:
        """Return the traction f_2 = σν of (2.4) at the points, which must lie on ``part``, (d, ...)."""
        return traction(self.stress(time), part.normal)


class FaceFields:
    """Gap, pressure and contact zone at fixed points of one contact face, (d − 1, ...), as functions of time.

    For n times, (n,), the results have n as an additional last axis.
    """

    def __init__(self, solution: ExactSolution, face: Face, s: Array) -> None:
        self.solution, self.face, self.s = solution, face, s
        self._fields = solution.at(face.part.point(s))

    def _value(self, jet: Jet, time: Time) -> Array:
        """Return the value of a formula at the points and a time."""
        require_times(self.solution.body.T, time)
        return jet(with_time_axis(self.s, time), time)[(0,) * len(self.s)]

    def pressure(self, time: Time) -> Array:
        """Return the pressure p = −σ_ν, computed from the stress of the whole solution, (...)."""
        normal = self.face.part.normal
        return -np.tensordot(normal, traction(self._fields.stress(time), normal), axes=1)

    def stated_pressure(self, time: Time) -> Array:
        """Return the prescribed contact pressure; if none was prescribed, the pressure from the stress, (...)."""
        jet = self.face.pressure_jet
        return self.pressure(time) if jet is None else self._value(jet, time)

    def stress_scale(self) -> float:
        """Return a typical size of stresses on the face, for tolerances.

        It is (L_A + L_G) max(|ε|, |w|) with the Lipschitz constants of A and G and the largest strain component and gap
        at the points, at nine times. The gap counts like a strain, as for a body of size 1.
        """
        instants = np.linspace(0, self.solution.body.T, 9)
        sizes = [abs(part).max() for t in instants for part in (self._fields.strain(t), self.gap(t))]
        return (self.solution.law.A.lipschitz + self.solution.law.G.lipschitz) * float(max(sizes))

    def traces(self, time: float, axis: int = 0) -> dict[str, tuple[Array, Array]]:
        """Return the functions that must be continuous along the contact face, each with its derivative along an axis.

        They are the gap w, and for a ``ContactFace`` also its gradient ∇_s w along the face, the normal strain q, the
        shear strain r, the slip z, and the initial gap g with ∇_s g if there is one.

        Args:
            time: the time.
            axis: the number of the coordinate s of the face with respect to which the derivatives are taken, 0 or 1.

        Returns:
            A dict from the name of a function to its values and the values of its derivative, (...) each. The names
            are "w", "∂_i w", "g", "∂_i g", "(q, r)_0" for q, "(q, r)_i" for the components of r, and "z_i" for those of
            z, where i = 1, …, d − 1.
        """
        zero, first = first_indices(len(self.s))

        def pair(values: Values, index: Index = zero) -> tuple[Array, Array]:
            return values[index], values[plus(index, first[axis])]

        if not isinstance(self.face, ContactFace):
            return {"w": pair(self.face.gap_jet(self.s, time, 1))}
        gaps = {"w": self.face.gap_jet} | ({"g": self.face.initial_gap_jet} if self.face.initial_gap else {})
        found = {}
        for name, jet in gaps.items():
            values = jet(self.s, time, 2)
            found[name] = pair(values)
            found |= {f"∂_{i} {name}": pair(values, along) for i, along in enumerate(first, start=1)}
        strain = self.face.strain.at(self.s)(time, False, 1)
        found |= {f"(q, r)_{i}": pair(values) for i, values in enumerate(strain)}
        found |= {f"z_{i}": pair(jet(self.s, time, 1)) for i, jet in enumerate(self.face.jets) if i}
        return found

    def gap(self, time: Time) -> Array:
        """Return the gap w = g − u_ν, the distance from the foundation, (...)."""
        return self._value(self.face.gap_jet, time)

    def initial_gap(self) -> Array:
        """Return the initial gap g, the distance of the undeformed body from the foundation, (...)."""
        return self._value(self.face.initial_gap_jet, 0.0)

    def level(self, time: Time) -> Array:
        """Return the level function ψ, (...); the contact zone is {ψ ≥ 0}."""
        return self._value(self.face.level_jet, time)
