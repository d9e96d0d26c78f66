"""The body force f_0 for a linear law, as a sum of products of a fixed field and a function of s and time.

−Div(α C ε(u)) is linear in u, and the lifting of a contact face is linear in the derivatives along the face of w and of
(q, r): each of these has a field of its own. Other contributions to u are taken at every point for itself.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from manufactured.contact.contact_face import Lifting
from manufactured.contact.lifting_terms import COMBINATIONS, first_indices, plus, strain_terms
from manufactured.exact.contribution import ContributionAtPoints
from manufactured.law import AtPoints, LawError, Scaled
from manufactured.modes import Modes, at_each
from manufactured.symbols import Index
from manufactured.tensors import Array, basis, rotation


@dataclass(frozen=True, eq=False)
class ForceModes:
    """f_0 = −Div(A ε(u̇)) − Div(G ε(u)), each as sums of products, one for each contribution to u.

    Attributes:
        viscous: −Div(A ε(u)), whose rate is that of f_0.
        elastic: −Div(G ε(u)).
    """

    viscous: list[Modes]
    elastic: list[Modes]


Trace = tuple[int, Index]
"""Whether of w (0), q (1) or r_i (2 + i), and its derivatives along the face."""


def force_modes(of: AtPoints, part: ContributionAtPoints, count: int) -> Modes:
    """−Div(α C ε) of a contribution at ``count`` points as a sum of products, with vectors (K, d) for tensors.

    Raises:
        LawError: an operator that is not linear.
    """
    if not isinstance(of, Scaled):
        raise LawError("f_0 is a sum of products for linear A and G only; take body_force")
    return _of_lifting(of, part) if isinstance(part, Lifting) else _of_points(of, part, count)


def _of_points(of: Scaled, part: ContributionAtPoints, count: int) -> Modes:
    """Every point is a place of its own."""
    dim = 2 if len(of.matrix) == 3 else 3

    def amplitudes(time: Array | float, rate: bool) -> Array:
        def one(moment: complex) -> Array:
            slope = of.gradient(lambda: part.strain(moment, rate), part.strain_gradient(moment, rate))
            return -np.einsum("Iij,Ij...->i...", basis(dim), slope)

        return at_each(time, one).reshape(dim, count, *np.shape(time))

    return Modes(np.eye(dim), np.arange(count), np.ones((dim, count)), np.arange(count), count, amplitudes)


@dataclass
class _Fields:
    """−Div(α C ε) for every trace that is 1 with all others 0, (d, n) each."""

    of: Scaled
    reach: Array
    found: dict[Trace, Array] = field(default_factory=dict)

    def add(self, trace: Trace, vector: Array, values: Array) -> None:
        """Adds −v(x) values(x) to the field of a trace, v (d,) or (d, n)."""
        product = -(vector if vector.ndim == 2 else vector[:, None]) * values
        self.found[trace] = self.found.get(trace, 0.0) + product

    @property
    def factor(self) -> Array | float:
        """α at the points within reach, (n,)."""
        return self.of.factor if isinstance(self.of.factor, float) else self.of.factor[self.reach]

    @property
    def slopes(self) -> Array | None:
        """∂_j α there, (d, n)."""
        return None if self.of.slopes is None else self.of.slopes[:, self.reach]


def _of_lifting(of: Scaled, lifting: Lifting) -> Modes:
    """One mode for each trace and component of its field that is not 0."""
    fields = _fields_of(of, lifting)
    dim = len(lifting.frame)
    chosen = [(trace, i) for trace, values in fields.items() for i in range(dim) if values[i].any()]
    # The amplitudes keep what they need, not the points.
    on_face, count = lifting.on_face, lifting.s[0].size
    order = 2 + lifting.deep

    def amplitudes(time: Array | float, rate: bool) -> Array:
        w, strain = on_face(time, rate, order)
        found = np.array([(w, *strain)[source][along] for (source, along), _ in chosen])
        return found.reshape(len(chosen), count, *np.shape(time))

    return Modes(
        tensors=np.eye(dim)[[i for _, i in chosen]],
        points=np.flatnonzero(lifting.reach),
        shapes=np.array([fields[trace][i] for trace, i in chosen]),
        places=np.arange(lifting.y.size) if lifting.where is None else lifting.where.ravel(),
        count=count,
        amplitudes=amplitudes,
    )


def _fields_of(of: Scaled, lifting: Lifting) -> dict[Trace, Array]:
    """The fields of all traces at the points within reach."""
    profile, frame, y = lifting.face.profile, lifting.frame, lifting.y.ravel()
    axes, (_, first) = rotation(frame), first_indices(len(lifting.s))
    shear = len(lifting.on_face(0.0, False, 0)[1]) - 1
    fields = _Fields(of, lifting.reach)
    for term in strain_terms(len(lifting.s), lifting.deep, shear):
        stress = np.einsum("Iij,I->ij", basis(len(frame)), of.matrix @ axes[:, term.row])
        value, slope = (
            term.factor * sum(getattr(profile, f)(y, k + into) for f, k in COMBINATIONS[term.profile])
            for into in range(2)
        )
        for unit, direction in zip(first, frame.T, strict=False):
            fields.add((term.source, plus(term.along, unit)), stress @ direction, fields.factor * value)
        fields.add((term.source, term.along), stress @ frame[:, -1], fields.factor * slope)
        if fields.slopes is not None:
            fields.add((term.source, term.along), stress @ fields.slopes, value)
    return fields.found
