"""The data of Problem 2.1: body, law, forces f_0 and f_2, initial displacement u_0, and no solution.

What is computed from ``Data`` alone can serve a problem whose solution nobody knows. An exact solution gives its data by
``Data.of``; formulas of x1, x2 and t by ``Data.formulas``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import sympy as sp

from manufactured.body import Body, Kind, Part
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.factor import x1, x2, x3
from manufactured.law import KelvinVoigt
from manufactured.symbols import FormulaError, function, t
from manufactured.tensors import Points, Tensors, Vectors, mandel

ForceInTime = Callable[[float], Vectors]
Line = tuple[tuple[float, ...], float]


@dataclass(frozen=True, eq=False)
class Data:
    """Problem 2.1 without its solution.

    Attributes:
        body: Ω, Γ1, Γ2, Γ3, T.
        law: A and G.
        body_force: points (d, ...) ↦ (t ↦ f_0 at the points, (d, ...)).
        surface_load: a piece of Γ2 and points on it ↦ (t ↦ f_2 at the points, (d, ...)).
        initial: points ↦ ε(u_0), (D, ...).
        start: points ↦ u_0, (d, ...), with u_0 = 0 on Γ1 and u_0ν ≤ 0 on Γ3.
        lines: lines (direction, offset) across which f_0 or ε(u_0) are rough for all times, for quadrature.
        points: vertices of Ω at which they are singular.
    """

    body: Body
    law: KelvinVoigt
    body_force: Callable[[Points], ForceInTime]
    surface_load: Callable[[Part, Points], ForceInTime]
    start: Callable[[Points], Vectors]
    initial: Callable[[Points], Tensors]
    lines: tuple[Line, ...] = ()
    points: tuple[tuple[float, ...], ...] = ()

    @classmethod
    def of(cls, solution: ExactSolution) -> Data:
        """The data that belong to an exact solution."""

        def surface_load(part: Part, x: Points) -> ForceInTime:
            fields = solution.at(x)
            return lambda time: fields.surface_load(part, time)

        return cls(
            solution.body,
            solution.law,
            lambda x: solution.at(x).body_force,
            surface_load,
            lambda x: solution.at(x).displacement(0.0),
            lambda x: solution.at(x).strain(0.0),
            (*_rough(solution), *solution.law.steps),
            solution.singular,
        )

    @classmethod
    def formulas(
        cls,
        body: Body,
        law: KelvinVoigt,
        f0: Sequence[sp.Expr | float],
        f2: Mapping[int, Sequence[sp.Expr | float]] | None = None,
        u0: Sequence[sp.Expr | float] | None = None,
        lines: tuple[Line, ...] = (),
    ) -> Data:
        """Data as formulas of x1, x2 (x3) and t.

        Args:
            body, law: as above.
            f0: the components of f_0.
            f2: number of a part of ``body.parts`` ↦ the components of f_2 on it; parts of Γ2 left out carry no load.
            u0: the components of u_0; 0 if left out.
            lines: where the formulas have kinks.

        Raises:
            FormulaError: a formula has the wrong number of components or other symbols, or f_2 is given on a part
                that is not of Γ2.
        """
        dim = body.dim
        zero = (sp.Integer(0),) * dim
        force = _compiled(f0, dim, "f0", (t,))
        loads = {}
        for number, load in (f2 or {}).items():
            if not 0 <= number < len(body.parts) or body.parts[number].kind is not Kind.LOADED:
                loaded = [i for i, part in enumerate(body.parts) if part.kind is Kind.LOADED]
                raise FormulaError(f"f2 is given on part {number}, but the parts of Γ2 have the numbers {loaded}")
            loads[body.parts[number]] = _compiled(load, dim, f"f2 on part {number}", (t,))
        none = _compiled(zero, dim, "f2", (t,))
        displacement = tuple(map(sp.sympify, u0 if u0 is not None else zero))
        start = _compiled(displacement, dim, "u0", ())
        gradient = _compiled(
            [sp.diff(u, x) for u, x in product(displacement, (x1, x2, x3)[:dim])], dim * dim, "∇u0", ()
        )

        def surface_load(part: Part, x: Points) -> ForceInTime:
            load = loads.get(part, none)
            return lambda time: load(x, time)

        return cls(
            body,
            law,
            lambda x: lambda time: force(x, time),
            surface_load,
            lambda x: start(x),
            lambda x: mandel(gradient(x).reshape(dim, dim, *x.shape[1:])),
            (*lines, *law.steps),
        )


def _compiled(
    formulas: Sequence[sp.Expr | float], count: int, name: str, more: tuple[sp.Symbol, ...]
) -> Callable[..., Vectors]:
    """(x, …) ↦ the values of some formulas, (count, ...)."""
    expressions = [sp.sympify(formula) for formula in formulas]
    if len(expressions) != count:
        raise FormulaError(f"{name} has {len(expressions)} components, expected {count}")
    strange = sorted({str(a) for e in expressions for a in e.free_symbols} - {"x1", "x2", "x3", *map(str, more)})
    if strange:
        raise FormulaError(f"{name} has the symbols {', '.join(strange)}; use x1, x2, x3" + " and t" * bool(more))
    call = function([x1, x2, x3, *more], expressions)

    def values(x: Points, *others: float) -> Vectors:
        coordinates = [*x, *[0.0] * (3 - len(x))]
        return np.array([np.broadcast_to(value, x.shape[1:]) for value in call(*coordinates, *others)])

    return values


def _rough(solution: ExactSolution) -> list[Line]:
    """{s = c} for the rough coordinates of every lifting."""
    found = []
    for face in solution.faces:
        if isinstance(face, ContactFace):
            tangent = face.part.tangent
            found += [(tuple(map(float, tangent)), float(tangent @ face.part.start) + c) for c in face.rough]
    return found
