"""The data of a problem, from an exact solution or from formulas."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import sympy as sp

from manufactured.body import Body, Kind, Part
from manufactured.data.compiled_formulas import compiled, own_formula
from manufactured.data.data_checks import check
from manufactured.exact import ExactSolution
from manufactured.factor import x1, x2, x3
from manufactured.law import KelvinVoigt
from manufactured.symbols import FormulaError, t
from manufactured.tensors import Hyperplane, Points, Tensors, Vectors, mandel

ForceInTime = Callable[[float], Vectors]
Formulas = Sequence[sp.Expr | float]


@dataclass(frozen=True, eq=False)
class Data:
    """Problem 2.1 without its solution.

    ``check`` refuses what no solution can belong to.

    Attributes:
        body: Ω, Γ1, Γ2, Γ3, T.
        law: A and G.
        body_force: points (d, ...) ↦ (t ↦ f_0 at the points, (d, ...)).
        surface_load: a piece of Γ2 and points on it ↦ (t ↦ f_2 at the points, (d, ...)).
        initial: points ↦ ε(u_0), (D, ...).
        start: points ↦ u_0, (d, ...), with u_0 = 0 on Γ1 and u_0ν ≤ 0 on Γ3.
        lines: lines (direction, offset) across which f_0 or ε(u_0) are rough for all times, for quadrature.
        points: vertices of Ω at which they are singular.
        formulas_of: what the callables were made from, by which equal data are known as equal.
    """

    body: Body
    law: KelvinVoigt
    body_force: Callable[[Points], ForceInTime]
    surface_load: Callable[[Part, Points], ForceInTime]
    start: Callable[[Points], Vectors]
    initial: Callable[[Points], Tensors]
    lines: tuple[Hyperplane, ...] = ()
    points: tuple[tuple[float, ...], ...] = ()
    formulas_of: object = None

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
            solution.rough,
            solution.singular,
            solution,
        )

    @classmethod
    def formulas(
        cls,
        body: Body,
        law: KelvinVoigt,
        f0: Formulas,
        f2: Mapping[int, Formulas] | None = None,
        u0: Formulas | None = None,
        lines: tuple[Hyperplane, ...] = (),
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
        dim, place = body.dim, (x1, x2, x3)[: body.dim]
        force = compiled(f0, dim, "f0", (*place, t))
        surface_load = _surface_load(body, f2 or {}, (*place, t))
        displacement = tuple(map(own_formula, [0] * dim if u0 is None else u0))
        start = compiled(displacement, dim, "u0", place)
        gradient = compiled([sp.diff(u, x) for u, x in product(displacement, place)], dim * dim, "∇u0", place)
        loads = tuple((number, *map(own_formula, load)) for number, load in sorted((f2 or {}).items()))
        return cls(
            body,
            law,
            lambda x: lambda time: force(x, time),
            surface_load,
            start,
            lambda x: mandel(gradient(x).reshape(dim, dim, *x.shape[1:])),
            (*lines, *law.steps),
            formulas_of=(tuple(map(own_formula, f0)), loads, displacement),
        )

    def check(self) -> None:
        """Check at random points and times that the data are those of a problem.

        Any finite load can be balanced, because meas Γ1 > 0 for every ``Body``.

        Raises:
            LoadError: f_0, f_2, u_0 or ε(u_0) is not finite or has the wrong shape, u_0 does not vanish on Γ1, or
                u_0 is not in K.
        """
        with np.errstate(all="ignore"):  # what is not finite is refused below
            check(self)


def _surface_load(
    body: Body, f2: Mapping[int, Formulas], symbols: tuple[sp.Symbol, ...]
) -> Callable[[Part, Points], ForceInTime]:
    """f_2 as in ``Data``, zero on the parts that ``f2`` leaves out."""
    loads = {}
    for number, load in f2.items():
        if not 0 <= number < len(body.parts) or body.parts[number].kind is not Kind.LOADED:
            loaded = [i for i, part in enumerate(body.parts) if part.kind is Kind.LOADED]
            raise FormulaError(f"f2 is given on part {number}, but the parts of Γ2 have the numbers {loaded}")
        loads[body.parts[number]] = compiled(load, body.dim, f"f2 on part {number}", symbols)
    none = compiled([0] * body.dim, body.dim, "f2", symbols)

    def surface_load(part: Part, x: Points) -> ForceInTime:
        load = loads.get(part, none)
        return lambda time: load(x, time)

    return surface_load
