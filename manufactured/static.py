"""Problems of static linear elasticity with contact, without viscosity and time."""

from manufactured.arguments import checked
from manufactured.body import Body
from manufactured.data import Data
from manufactured.data.compiled_formulas import compiled
from manufactured.data.problem_data import Formulas, Tractions
from manufactured.factor import x1, x2, x3
from manufactured.law import Elasticity, Indefinite, KelvinVoigt, LawError, Linear, isotropic
from manufactured.symbols import FormulaError


class Static(Data):
    """The data of a static contact problem: find u ∈ K with (Gε(u), ε(v − u))_Q ≥ (f, v − u)_V for all v ∈ K.

    There is no viscosity. The law has A = G, so that ‖·‖_V is the energy norm (Gε(v), ε(v))_Q^½. Instances are made by
    ``static``.
    """

    in_time = False


@checked(FormulaError)
def static(body: Body, G: Elasticity, f0: Formulas | None = None, f2: Tractions | None = None) -> Static:
    """Return the data of a static contact problem, from formulas of x1, x2 (x3).

    Args:
        body: the body with its boundary parts; its final time is not used.
        G: the elasticity: ``plane_strain`` or ``plane_stress`` of Young's modulus and Poisson's ratio,
            ``isotropic(mu, lam)``, or any ``Linear``.
        f0: the components of the body force; by default 0.
        f2: a dict from numbers of parts in ``body.parts`` to the components of the traction on them.

    Raises:
        FormulaError: a load has a wrong number of components or other symbols (also t), or f_2 is not on Γ2.
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
        compiled(load, body.dim, name, (x1, x2, x3)[: body.dim])  # refuses t, which ``formulas`` accepts
    data = Static.formulas(body, KelvinVoigt(G, G, "static"), f0, f2)
    assert isinstance(data, Static)
    return data


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
