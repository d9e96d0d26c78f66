"""Problems of static linear elasticity with contact, without viscosity and time."""

from collections.abc import Mapping
from dataclasses import replace
from itertools import combinations

import sympy as sp

from manufactured.arguments import checked
from manufactured.body import CORNER_ROUNDING, Body, Kind
from manufactured.data import Data, Displacements, Formulas, Tractions, compiled, own_formula
from manufactured.factor import COORDINATES, x1, x2
from manufactured.law import Elasticity, Indefinite, KelvinVoigt, LawError, Linear, isotropic
from manufactured.symbols import FormulaError
from manufactured.tensors import Points


class Static(Data):
    """The data of a static contact problem: find u ∈ K with (Gε(u), ε(v − u))_Q ≥ (f, v − u)_V for all v ∈ K.

    G is the elasticity, f the load, and K the set of admissible displacements, with v_ν ≤ 0 on the contact boundary.
    Where a displacement is prescribed on parts of ``body``, K contains only displacements with these values.

    There is no viscosity. The law has A = G, so that ‖·‖_V is the energy norm (Gε(v), ε(v))_Q^½. Instances are made by
    ``static``.
    """

    in_time = False


@checked(FormulaError)
def static(
    body: Body,
    G: Elasticity,
    f0: Formulas | None = None,
    f2: Tractions | None = None,
    u: Displacements | None = None,
) -> Static:
    """Return the data of a static contact problem, from formulas of x1, x2 (x3).

    Args:
        body: the body with its boundary parts; its final time is not used.
        G: the elasticity: ``plane_strain`` or ``plane_stress`` of Young's modulus and Poisson's ratio,
            ``isotropic(mu, lam)``, or any ``Linear``.
        f0: the components of the body force; by default 0.
        f2: a dict from numbers of parts in ``body.parts`` to the components of the traction on them.
        u: in 2D, a dict from numbers of CLAMPED or ROLLER parts to the components of the displacement prescribed there,
            which have to be linear in x1 and x2. On a ROLLER only the normal component is prescribed. By default 0.

    Raises:
        FormulaError: a load has a wrong number of components or other symbols (also t), f_2 is not on Γ2, or u is not
            on Γ1 or on a roller, is not linear, or jumps between two parts.
        LawError: G is not linear and elliptic, or G and the body have different dimensions.

    >>> from manufactured import unit_square
    >>> static(unit_square(), plane_stress(E=200.0, nu=0.3), f2={1: (0, -1)}).law.name
    'static'
    """
    if not isinstance(G, Linear) or isinstance(G, Indefinite):
        raise LawError(
            f"a static problem needs a linear, elliptic G such as plane_stress(E, nu), got {type(G).__name__}"
        )
    f0 = (0,) * body.dim if f0 is None else f0
    for name, load in (("f0", f0), *((f"f2 on part {number}", load) for number, load in (f2 or {}).items())):
        compiled(load, body.dim, name, COORDINATES[: body.dim])  # refuses t, which ``formulas`` accepts
    data = Static.formulas(_moved(body, u or {}), KelvinVoigt(G, G, "static"), f0, f2)
    assert isinstance(data, Static)
    return data


def _moved(body: Body, u: Mapping[int, Formulas]) -> Body:
    """Return the body with displacements that are prescribed on some of its parts.

    Raises:
        FormulaError: as in ``static``.
    """
    if not u:
        return body
    parts = list(body.parts)
    held = [i for i, part in enumerate(parts) if part.kind in (Kind.CLAMPED, Kind.ROLLER)]
    for number, formulas in u.items():
        if number not in held or body.dim != 2:
            raise FormulaError(f"u is given on part {number}, but the CLAMPED and ROLLER parts of the plane are {held}")
        at = compiled(formulas, 2, f"u on part {number}", (x1, x2))
        for formula in map(own_formula, formulas):
            if not formula.is_polynomial(x1, x2) or sp.Poly(formula, x1, x2).total_degree() > 1:
                raise FormulaError(
                    f"u on part {number} is {formula}, and only linear displacements can be prescribed: divide the side"
                    " by vertices, and give a linear formula such as 0.1*x1 on each"
                )
        parts[number] = replace(parts[number], displacement=at(parts[number].corners))
    body = replace(body, parts=tuple(parts))
    for corner in body.vertices.T:
        _check_corner(body, corner[:, None])
    return body


def _check_corner(body: Body, corner: Points) -> None:
    """Refuse displacements that differ at a common corner of two parts, or that press a contact side there."""
    reach = CORNER_ROUNDING * body.extent
    supports = [part for part in body.parts if part.kind is not Kind.LOADED]
    size = max(abs(part.prescribed(part.corners)).max() for part in supports)
    here = [part for part in supports if part.contains(corner, reach).all()]
    for part, other in combinations(here, 2):
        there = part.prescribed(corner) - other.prescribed(corner)
        jump = there[:, 0]
        # Sides that are not clamped prescribe the normal component only.
        for side in (part, other):
            if side.kind is not Kind.CLAMPED:
                jump = (side.normal @ jump) * side.normal
        if abs(jump).max() > CORNER_ROUNDING * size:
            raise FormulaError(
                f"the displacements prescribed on two sides differ by {abs(jump).max():.3g} at their common corner "
                f"{corner[:, 0].tolist()}: let them agree there; a CONTACT side counts as 0 along its normal"
            )


@checked(LawError)
def plane_strain(E: float, nu: float) -> Linear:
    """Return the elasticity tensor for Young's modulus E and Poisson's ratio ν in plane strain.

    Raises:
        LawError: E ≤ 0, or ν is not between −1 and 1/2.
    """
    _require_moduli(E, nu, 0.5)
    return isotropic(E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu)))


@checked(LawError)
def plane_stress(E: float, nu: float) -> Linear:
    """Return the elasticity tensor for Young's modulus E and Poisson's ratio ν in plane stress.

    Raises:
        LawError: E ≤ 0, or ν is not between −1 and 1.
    """
    _require_moduli(E, nu, 1.0)
    return isotropic(E / (2 * (1 + nu)), E * nu / (1 - nu**2))


def _require_moduli(E: float, nu: float, most: float) -> None:
    if not (E > 0 and -1 < nu < most):
        raise LawError(
            f"Young's modulus has to be positive and Poisson's ratio between -1 and {most:g}, got {E:g}, {nu:g}"
        )
