"""Laws, bodies and contact faces that several cases share.

In descriptions of laws, a = A_nnnn and g = G_nnnn are the moduli of viscosity and elasticity for the normal strain on a
contact face.
"""

from typing import Any

import numpy as np
from sympy import Expr, Rational, sin

from manufactured.body import Body, Kind, polygon
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.factor import UNIFORM, Factor, layers
from manufactured.law import KelvinVoigt, Linear, isotropic
from manufactured.symbols import s, t
from manufactured.tensors import Array

SLIP: Expr = t * (1 + t) * sin(2 * s + 1)
"""The formula of a slip z(s, t), a tangential displacement on the contact face, that cases use with a factor."""
GROWING_SLIP: Expr = 4 * t * sin(3 * s + Rational(1, 2))
"""The formula of a slip z(s, t) that grows in proportion to time."""
BULGE: Expr = 1 + 4 * s * (1 - s)
"""The formula of a factor of gap or pressure: a parabola, 1 at the ends and 2 in the middle of a face of length 1."""


def proportional(ratio: float = 1.0) -> KelvinVoigt:
    """Return an isotropic law whose elasticity is proportional to its viscosity.

    A τ = 2τ + (tr τ)/2 I and G = ``ratio`` · A.

    Args:
        ratio: the ratio G/A.
    """
    name = "linear, A = G" if ratio == 1 else f"linear, G = {ratio:g} A"
    return KelvinVoigt(isotropic(1, 0.5), isotropic(ratio, ratio / 2), name)


def not_proportional(dim: int = 2, viscous: Factor = UNIFORM, elastic: Factor = UNIFORM) -> KelvinVoigt:
    """Return an isotropic law whose viscosity and elasticity are not proportional.

    A τ = α (2τ + (tr τ)/2 I) and G τ = γ (4τ + 3 (tr τ) I); for α = γ = 1 the normal moduli are a = 5/2 and g = 7. A
    and G differ in size and in the ratio of shear to compression. A program that confuses A and G therefore gives wrong
    results for this law.

    Args:
        dim: 2 or 3.
        viscous, elastic: α and γ, scalar functions of the point.
    """
    name = "linear, A and G not proportional"
    return KelvinVoigt(
        isotropic(1, 0.5, dim, viscous),
        isotropic(2, 3, dim, elastic),
        name if viscous is UNIFORM and elastic is UNIFORM else f"{name}, heterogeneous",
    )


def two_layers(interface: float, ratio: float) -> KelvinVoigt:
    """Return the law of a body of two layers: A and G of ``not_proportional``, in the upper layer times a factor.

    Args:
        interface: the upper layer is {x_2 > interface}.
        ratio: the factor of A and of G in the upper layer.
    """
    factor = layers((0.0, 1.0), interface, ratio)
    return not_proportional(2, factor, factor)


def without_contraction(dim: int = 2) -> KelvinVoigt:
    """Return a law that does not couple normal strains in different directions; A and G are orthotropic along the axes.

    The displacement of one contact face then does not change the pressure on a face at right angles, so two faces under
    pressure may meet at a corner.
    """
    shear = dim * (dim - 1) // 2
    A = np.diag([2.0, 3.0, 2.5][:dim] + [1.5, 2.0, 1.8][:shear])
    G = np.diag([5.0, 4.0, 6.0][:dim] + [3.0, 2.5, 4.0][:shear])
    return KelvinVoigt(Linear(A), Linear(G), "linear, orthotropic without contraction")


def with_faces(body: Body, law: KelvinVoigt, *faces: dict[str, Any]) -> ExactSolution:
    """Return the exact solution with contact on every flat piece of the contact boundary, for a linear law.

    Args:
        body: the body.
        law: the material law.
        faces: for each flat piece of the contact boundary Γ3, in the order of ``body.of(Kind.CONTACT)``, its gap,
            pressure, level and other contact data, as a dict of keyword arguments of ``ContactFace.linear``.
    """
    pieces = zip(body.of(Kind.CONTACT), faces, strict=True)
    return ExactSolution(body, law, tuple(ContactFace.linear(part, law, body.T, **data) for part, data in pieces))


def with_one_face(body: Body, law: KelvinVoigt, **data: Any) -> ExactSolution:
    """Return the exact solution on a body whose contact boundary is one flat piece, for a linear law.

    Args:
        body: the body.
        law: the material law.
        data: the contact data, such as gap, pressure and level, as keyword arguments of ``ContactFace.linear``.
    """
    return with_faces(body, law, data)


def turn(angle: float) -> Array:
    """Return the matrix of a rotation in the plane, counter-clockwise by an angle."""
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def l_shape(refine: tuple[tuple[float, float], ...]) -> Body:
    """Return the L-shaped body [0, 2]² without (1, 2]², clamped on the top x_2 = 2, with contact on the bottom.

    Args:
        refine: the vertices towards which graded meshes are refined.
    """
    kinds = [Kind.CONTACT, Kind.LOADED, Kind.LOADED, Kind.LOADED, Kind.CLAMPED, Kind.LOADED]
    return polygon([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)], kinds, refine=refine)
