"""The body force f_0 of a linear law as a sum of fixed fields times functions of time and of the face coordinate s.

For a linear operator C, −Div(α C ε(u)) is linear in u. The displacement of a contact face is linear in the derivatives
of w, q, r and z (gap, normal and shear strain, slip) along the face. So f_0 is a sum over these derivatives, each
multiplied by a field that does not depend on time. Other displacement fields are evaluated point by point.
"""

from dataclasses import dataclass, field

import numpy as np

from manufactured.contact.contact_face import Lifting
from manufactured.contact.lifting_terms import COMBINATIONS, first_indices, plus
from manufactured.exact.domain import ContributionAtPoints
from manufactured.law import AtPoints, LawError, Scaled
from manufactured.modes import Modes, at_each, pointwise
from manufactured.symbols import Index
from manufactured.tensors import Array, Time, basis, rotation


@dataclass(frozen=True, eq=False)
class ForceModes:
    """The body force f_0 = −Div(A ε(u̇)) − Div(G ε(u)) as sums of products, one sum for each displacement field of u.

    Attributes:
        viscous: −Div(A ε(u)); its time derivative is the viscous part of f_0.
        elastic: −Div(G ε(u)), the elastic part of f_0.
    """

    viscous: list[Modes]
    elastic: list[Modes]


Trace = tuple[int, Index]
"""A derivative along the face of the gap, the strain or the slip.

It is a pair of the number of the function (``StrainTerm.source``) and the multi-index of the derivative.
"""


def force_modes(of: AtPoints, part: ContributionAtPoints, count: int) -> Modes:
    """Return the force −Div(α C ε) of a displacement field at ``count`` points, as a sum of products.

    In the result, ``Modes.tensors`` are the K constant vectors of the products, (K, d).

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


@dataclass
class _Fields:
    """Collects the force fields −Div(α C ε), (d, n), that belong to single derivatives of w, q, r and z along the face.

    The field of a derivative (``Trace``) is the force if this derivative is 1 and all others are 0.
    """

    of: Scaled
    reach: Array
    found: dict[Trace, Array] = field(default_factory=dict)

    def add(self, trace: Trace, vector: Array, values: Array) -> None:
        """Add the vector field −v(x) f(x) to the field of a derivative of w, q, r or z.

        Args:
            trace: the derivative.
            vector: v, (d,) or (d, n).
            values: the scalar f at the points, (n,).
        """
        product = -(vector if vector.ndim == 2 else vector[:, None]) * values
        self.found[trace] = self.found.get(trace, 0.0) + product

    @property
    def factor(self) -> Array | float:
        """The material factor α at the points within the depth of the displacement, (n,)."""
        return self.of.factor if isinstance(self.of.factor, float) else self.of.factor[self.reach]

    @property
    def slopes(self) -> Array | None:
        """The derivatives ∂_j α of the material factor at the points within the depth of the displacement, (d, n)."""
        return None if self.of.slopes is None else self.of.slopes[:, self.reach]


def _of_lifting(of: Scaled, lifting: Lifting) -> Modes:
    """Return the force of a contact face as a sum of products.

    There is one product for each derivative of w, q and r, and each component of its field that is not zero.
    """
    fields = _fields_of(of, lifting)
    dim = len(lifting.frame)
    chosen = [(trace, i) for trace, values in fields.items() for i in range(dim) if values[i].any()]
    # The function below uses local variables. A reference to the lifting would keep the arrays of all points in memory.
    on_face = lifting.on_face
    count = lifting.s[0].size
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
    """Return the force fields of all derivatives of w, q, r and z, at the points that the displacement reaches."""
    profile, frame, y = lifting.face.profile, lifting.frame, lifting.y.ravel()
    axes, (_, first) = rotation(frame), first_indices(len(lifting.s))
    fields = _Fields(of, lifting.reach)
    for term in lifting.terms:
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
