"""The data of Problem 2.1: body, law, forces f_0 and f_2, and initial displacement u_0, without a solution.

A computation that uses only ``Data`` works for problems with unknown solutions. ``Data.of`` makes the data of an
exact solution, ``Data.formulas`` makes data from formulas of x1, x2 and t.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import reduce
from typing import Annotated, Any, ClassVar

import numpy as np
import sympy as sp
from sympy.core.relational import Relational

from manufactured.arguments import checked
from manufactured.body import Body, Kind, Part
from manufactured.compiled import function
from manufactured.exact import ExactSolution, ForceModes
from manufactured.factor import COORDINATES, x1, x2, x3
from manufactured.law import KelvinVoigt, Linear
from manufactured.symbols import FormulaError, Symbols, extreme_numbers, t
from manufactured.tensors import Array, Hyperplane, Points, Tensors, Vectors, mandel

# Turns formulas of x1, x2, x3 and t into functions of points and time.


@dataclass(frozen=True)
@checked(FormulaError)
class Expressions:
    """Formulas of the body force f_0, the tractions f_2 and the initial displacement u_0 in x1, x2 (x3) and t.

    Two instances are equal if their formulas are equal.

    Attributes:
        force: the components of f_0.
        loads: pairs of the number of a part in ``body.parts`` and the components of f_2 on it, sorted by number. On
            other parts there is no load.
        start: the components of u_0.
    """

    force: tuple[sp.Expr, ...]
    loads: tuple[tuple[int, tuple[sp.Expr, ...]], ...]
    start: tuple[sp.Expr, ...]


SYMBOLS_BY_NAME = {str(symbol): symbol for symbol in (x1, x2, x3, t)}
"""The symbols that formulas may contain, by their names."""


def compiled(
    formulas: Sequence[sp.Expr | float], count: int, name: str, symbols: tuple[sp.Symbol, ...]
) -> Callable[..., Vectors]:
    """Return a function that evaluates formulas at points, (d, ...) → (count, ...).

    Args:
        formulas: the formulas.
        count: the number of formulas that is expected.
        name: the name of the quantity, for messages.
        symbols: the symbols that the formulas may contain: the coordinates, and the time t if the function shall have
            the time as its second argument.

    Raises:
        FormulaError: there are other symbols, a wrong number of formulas, numbers that overflow or underflow in double
            precision, or functions that NumPy does not have.
    """
    expressions = [own_formula(formula) for formula in formulas]
    if len(expressions) != count:
        raise FormulaError(f"{name} has {len(expressions)} components, expected {count}")
    strange = sorted({str(a) for e in expressions for a in e.free_symbols - {*symbols}})
    if strange:
        raise FormulaError(f"{name} has the symbols {', '.join(strange)}; use {', '.join(map(str, symbols))}")
    for expression in expressions:
        _require_numbers(expression, name)
    call = _function(symbols, expressions, name)

    # NumPy can evaluate a Piecewise only if all of its conditions have the same shape, so all arguments get one shape.
    spread = any(expression.has(sp.Piecewise) for expression in expressions)

    def values(x: Points, *time: float) -> Vectors:
        times = [np.full(x.shape[1:], each) for each in time] if spread else time
        return np.array([np.broadcast_to(value, x.shape[1:]) for value in call(*x, *times)])

    return values


PIECEWISE: dict[type, Callable[..., sp.Expr]] = {
    sp.Max: lambda *args: reduce(lambda a, b: sp.Piecewise((a, a > b), (b, True)), args),
    sp.Min: lambda *args: reduce(lambda a, b: sp.Piecewise((a, a < b), (b, True)), args),
    sp.Abs: lambda x: sp.Piecewise((x, x > 0), (-x, True)),
    sp.sign: lambda x: sp.Piecewise((1, x > 0), (-1, x < 0), (0, True)),
    sp.Heaviside: lambda x, at_0: sp.Piecewise((1, x > 0), (0, x < 0), (at_0, True)),
}
"""Functions of SymPy with kinks or jumps, written as Piecewise functions."""


def own_formula(formula: sp.Expr | float) -> sp.Expr:
    """Return a formula of the user with the symbols of this package.

    SymPy distinguishes symbols of the same name by their assumptions, so x1, x2, x3 and t of the user are replaced. A
    condition a < b becomes a − b < 0, so that SymPy removes numbers that occur on both sides: x1 + 1 < 1 becomes
    x1 < 0. Otherwise rounding would decide, because 1 + x1 is rounded to 1 for a tiny x1.
    """
    expression = sp.sympify(formula)
    expression = expression.subs(
        {a: SYMBOLS_BY_NAME[a.name] for a in expression.free_symbols if a.name in SYMBOLS_BY_NAME}
    )
    logical = sp.Xor, sp.ITE, sp.Implies, sp.Equivalent
    expression = expression.replace(
        lambda part: isinstance(part, logical), lambda part: sp.to_nnf(part, simplify=False)
    )
    return expression.replace(
        lambda part: isinstance(part, Relational) and isinstance(part.lhs, sp.Expr),
        lambda part: part.func(part.lhs - part.rhs, 0),
    )


def gradient(formulas: Sequence[sp.Expr], symbols: Sequence[sp.Symbol]) -> list[sp.Expr]:
    """Return the derivatives of continuous formulas with respect to all symbols; the symbols change fastest.

    Kinks are first written as Piecewise functions, because SymPy's derivative of a Max with three arguments that are
    equal on a set is wrong there.
    """
    pieces = [formula.replace(lambda part: type(part) in PIECEWISE, _as_pieces) for formula in formulas]
    return [sp.diff(formula, symbol) for formula in pieces for symbol in symbols]


def _as_pieces(part: sp.Expr) -> sp.Expr:
    return PIECEWISE[type(part)](*part.args)


def _require_numbers(expression: sp.Expr, name: str) -> None:
    """Raise FormulaError if a formula contains NaN, infinity or a number that overflows or underflows in a double."""
    if expression.has(sp.nan, sp.zoo, sp.oo) or extreme_numbers(expression):
        raise FormulaError(
            f"{name} is {sp.N(expression, 3)} in SymPy, and has no value in double precision somewhere; write it as a "
            "Piecewise, and use units in which its numbers have moderate size"
        )


def _function(symbols: tuple[sp.Symbol, ...], expressions: Sequence[sp.Expr], name: str) -> Callable[..., Any]:
    """Return a NumPy function that evaluates formulas; raise FormulaError if NumPy does not have their functions."""
    try:
        call = function(symbols, expressions)
        with np.errstate(all="ignore"):
            call(*np.zeros((len(symbols), 2)))  # functions of ``math`` accept one point
    except (NameError, AttributeError, NotImplementedError, TypeError, ValueError) as error:
        formula = ", ".join(map(str, expressions))
        raise FormulaError(
            f"{name} = {formula} cannot be evaluated: {error}; write it with functions that NumPy has, and steps with "
            "Heaviside or pos(x, 0)"
        ) from error
    return call


# The data of a problem, made from an exact solution or from formulas.

ForceInTime = Callable[[float], Vectors]
Formulas = Annotated[
    Sequence[sp.Expr], "one number or formula of SymPy for each direction, such as (0, -1) or (0, -x2)"
]
Tractions = Annotated[
    Mapping[int, Formulas], "a dict from the number of a LOADED side to the traction on it, such as {2: (0, -4)}"
]
Displacements = Annotated[
    Mapping[int, Formulas], "a dict from the number of a CLAMPED or ROLLER side to its displacement, as {0: (0, 0.1)}"
]


class LoadError(ValueError):
    """Raised for data for which no solution can exist."""


def no_fronts(time: float) -> tuple[Hyperplane, ...]:
    """Return no lines, the default of ``Data.fronts``, for a body force that has no moving fronts."""
    return ()


@dataclass(frozen=True, eq=False)
@checked(LoadError)
class Data:
    """The data of Problem 2.1: body, law, loads and initial displacement.

    There is no initial gap, except for data of an exact solution that has one (``has_initial_gap``).

    Attributes:
        body: the body with its boundary parts and the final time.
        law: the material law.
        body_force: a function from points (d, ...) to the function t ↦ f_0 at these points, (d, ...).
        surface_load: a function from a part of Γ2 and points on it to the function t ↦ f_2 at these points, (d, ...).
            Loads of an exact solution also accept an array of n times and then return values with n as a last axis.
        start: a function from points to the initial displacement u_0, (d, ...), with u_0 = 0 on Γ1 and u_0ν ≤ 0 on Γ3.
        initial: a function from points to the strain ε(u_0) of ``start``, (D, ...).
        lines: lines (direction, offset) across which f_0 or ε(u_0) is never smooth, for quadrature.
        points: vertices of the body at which f_0 or ε(u_0) is singular.
        formulas_of: what the functions were made from, by which equal data are recognised: an ``ExactSolution`` if
            ``of`` made the data, ``Expressions`` if ``formulas`` did, otherwise None. It is also None after
            ``dataclasses.replace``, because it may not belong to the new functions.
        fronts: a function from a time to lines across which f_0 jumps or has kinks at this time only.
        force_modes: a function from points to f_0 as a sum of products of functions of x and of t; None if no such sum
            is known.
        in_time: whether the loads may depend on time.
    """

    in_time: ClassVar[bool] = True

    body: Body
    law: KelvinVoigt
    body_force: Callable[[Points], ForceInTime]
    surface_load: Callable[[Part, Points], ForceInTime]
    start: Callable[[Points], Vectors]
    initial: Callable[[Points], Tensors]
    lines: tuple[Hyperplane, ...] = ()
    points: tuple[tuple[float, float], ...] = ()
    formulas_of: object = field(default=None, init=False)
    fronts: Callable[[float], tuple[Hyperplane, ...]] = no_fronts
    force_modes: Callable[[Points], ForceModes] | None = None

    @property
    def functions(self) -> tuple[object, ...]:
        """The functions body_force, surface_load, start, initial, fronts and force_modes (or None) of the data."""
        return self.body_force, self.surface_load, self.start, self.initial, self.fronts, self.force_modes

    @property
    def has_initial_gap(self) -> bool:
        """Whether the data belong to an exact solution with an initial gap. Data from formulas have no initial gap."""
        return isinstance(self.formulas_of, ExactSolution) and self.formulas_of.has_initial_gap

    @classmethod
    @checked(LoadError)
    def of(cls, solution: ExactSolution) -> Data:
        """Return the data of an exact solution.

        >>> from manufactured import named
        >>> data = Data.of(named("full-contact").solution)
        >>> data.body_force(np.array([[0.5], [0.5]]))(1.0).shape
        (2, 1)
        """

        def surface_load(part: Part, x: Points) -> ForceInTime:
            fields = solution.at(x)
            return lambda time: fields.surface_load(part, time)

        data = cls(
            solution.body,
            solution.law,
            lambda x: solution.at(x).body_force,
            surface_load,
            lambda x: solution.at(x).displacement(0.0),
            lambda x: solution.at(x).strain(0.0),
            solution.rough,
            solution.singular,
            solution.fronts,
            (lambda x: solution.at(x).force_modes()) if isinstance(solution.law.G, Linear) else None,
        )
        object.__setattr__(data, "formulas_of", solution)
        return data

    @classmethod
    @checked(FormulaError)
    def formulas(
        cls,
        body: Body,
        law: KelvinVoigt,
        f0: Formulas,
        f2: Tractions | None = None,
        u0: Formulas | None = None,
        lines: tuple[Hyperplane, ...] = (),
        **others: object,
    ) -> Data:
        """Return data from formulas of x1, x2 (x3) and t. There is no initial gap: Γ3 touches the foundation if u = 0.

        Args:
            body, law: the body and its material law.
            f0: the components of f_0.
            f2: a dict from numbers of parts in ``body.parts`` to the components of f_2 on them; f_2 = 0 on other parts.
            u0: the components of u_0; by default 0.
            lines: the lines (direction, offset) at which the formulas have kinks.
            others: other arguments are refused, with a hint.

        Raises:
            LawError: body and law have different dimensions.
            FormulaError: a formula has other symbols, the number of components is wrong, f_2 is given on a part that
                does not belong to Γ2, or there is another argument.
        """
        if others:
            raise FormulaError(
                f"Data.formulas takes f0, f2, u0 and lines, got {', '.join(others)}; there is no initial gap in data, "
                "as the undeformed body touches the foundation along Γ3; only an exact solution can have one, the "
                "`initial_gap` of ContactFace.linear"
            )
        dim, place = body.dim, COORDINATES[: body.dim]
        law.require_dimension(dim)
        body_force, displacement = (tuple(map(own_formula, each)) for each in (f0, [0] * dim if u0 is None else u0))
        loads = {number: tuple(map(own_formula, load)) for number, load in sorted((f2 or {}).items())}
        force = compiled(body_force, dim, "f0", (*place, t))
        surface_load = _surface_load(body, loads, (*place, t))
        start = compiled(displacement, dim, "u0", place)
        slopes = compiled(gradient(displacement, place), dim * dim, "∇u0", place)
        data = cls(
            body,
            law,
            lambda x: lambda time: force(x, time),
            surface_load,
            start,
            lambda x: mandel(slopes(x).reshape(dim, dim, *x.shape[1:])),
            (*lines, *law.steps),
        )
        object.__setattr__(data, "formulas_of", Expressions(body_force, tuple(loads.items()), displacement))
        return data

    def check(self) -> None:
        """Refuse data for which no solution can exist, by a check at random points and times.

        Any finite load can be balanced, because Γ1 or rollers exclude rigid motions of every ``Body``.

        Raises:
            LoadError: f_0, f_2, u_0 or ε(u_0) is not finite or has a wrong shape, u_0 does not vanish on Γ1 or is not
                in K, or a factor of the law is outside its stated bounds.
        """
        rng = np.random.default_rng(0)
        inside = self.body.sample(rng, RANDOM_POINTS)
        with np.errstate(all="ignore"):  # values that are not finite are refused
            _check_factors(self.law, inside)
            _check_forces(self, inside, rng)
            _check_start(self, inside, rng)


def _surface_load(body: Body, f2: Mapping[int, Formulas], symbols: Symbols) -> Callable[[Part, Points], ForceInTime]:
    """Return the function ``Data.surface_load`` for given formulas of f_2; on parts without a formula, f_2 is zero."""
    loads = {}
    loaded = [i for i, part in enumerate(body.parts) if part.kind is Kind.LOADED]
    for number, load in f2.items():
        if number not in loaded:
            raise FormulaError(f"f2 is given on part {number}, but the LOADED parts have the numbers {loaded}")
        loads[body.parts[number]] = compiled(load, body.dim, f"f2 on part {number}", symbols)
    none = compiled([0] * body.dim, body.dim, "f2", symbols)

    def surface_load(part: Part, x: Points) -> ForceInTime:
        load = loads.get(part, none)
        return lambda time: load(x, time)

    return surface_load


RANDOM_POINTS, RANDOM_TIMES = 64, 5
"""Numbers of random points in the body and on each part, and of times, at which the data are checked."""
START_ROUNDING = 1e-12
"""Relative size up to which u_0 on Γ1, and penetration of u_0 on Γ3, count as round-off."""
LARGEST_DATUM = 1e100
"""Largest permitted value of f_0, f_2, u_0 and ε(u_0): their squares must not overflow."""


def _check_factors(law: KelvinVoigt, x: Points) -> None:
    for name, tensor in (("A", law.A), ("G", law.G)):
        values, factor = tensor.factor(x), tensor.factor
        if values.min() < factor.low * (1 - START_ROUNDING) or values.max() > factor.high * (1 + START_ROUNDING):
            raise LoadError(
                f"the factor of {name} takes values from {values.min():.4g} to {values.max():.4g}, outside its stated "
                f"bounds {factor.low:g} and {factor.high:g}; correct the bounds, from which constants are computed"
            )


def _check_forces(data: Data, inside: Points, rng: np.random.Generator) -> None:
    body = data.body
    for time in np.linspace(0.0, body.T, RANDOM_TIMES if data.in_time else 1):
        when = f" at t = {time:.4g}" if data.in_time else ""
        _finite("f_0", data.body_force(inside)(time), inside, body.dim, when)
        for part in body.of(Kind.LOADED):
            x = part.sample(rng, RANDOM_POINTS)
            _finite("f_2", data.surface_load(part, x)(time), x, body.dim, when)


def _check_start(data: Data, inside: Points, rng: np.random.Generator) -> None:
    dim = data.body.dim
    _finite("ε(u_0)", data.initial(inside), inside, dim * (dim + 1) // 2, "")
    size = max(abs(_finite("u_0", data.start(inside), inside, dim, "")).max(), np.finfo(float).tiny)
    for part in data.body.parts:
        x = part.sample(rng, RANDOM_POINTS)
        u = _finite("u_0", data.start(x), x, dim, "")
        held = abs(u if part.kind is Kind.CLAMPED else part.normal @ u).max()
        if part.kind in (Kind.CLAMPED, Kind.ROLLER) and held > START_ROUNDING * size:
            raise LoadError(f"u_0 is {held:.3g} on a {part.kind.name} part, where it has to be 0; change u_0")
        beyond = part.normal @ u - _initial_gap(data, part, x)
        if part.kind is Kind.CONTACT and beyond.max() > START_ROUNDING * size:
            raise LoadError(f"u_0ν is {beyond.max():.3g} > 0 on a CONTACT part, where it may not penetrate; change u_0")


def _initial_gap(data: Data, part: Part, x: Points) -> Array | float:
    """Return the initial gap at points of a boundary part; 0 outside Γ3 and for data without an initial gap."""
    if not data.has_initial_gap or part.kind is not Kind.CONTACT:
        return 0.0
    solution = data.formulas_of
    assert isinstance(solution, ExactSolution)
    (face,) = (face for face in solution.faces if face.part is part)
    return solution.on(face, part.coordinates(x)[0]).initial_gap()


def _finite(name: str, values: Vectors, x: Points, components: int, when: str) -> Vectors:
    """Return values of data, or raise LoadError: wrong shape, not finite, or larger than ``LARGEST_DATUM``."""
    if np.shape(values) != (components, *x.shape[1:]):
        raise LoadError(
            f"{name} has the shape {np.shape(values)} at points {x.shape}{when}, expected {(components, *x.shape[1:])}"
        )
    wrong = ~np.isfinite(values).all(axis=0)
    if wrong.any():
        raise LoadError(
            f"{name} is not finite at x = {np.round(x[:, wrong][:, 0], 4).tolist()}{when}, so no stress can "
            "balance it; give loads in L²"
        )
    if values.size and abs(values).max() > LARGEST_DATUM:
        raise LoadError(
            f"{name} reaches {abs(values).max():.3g}{when}, and squares of such numbers overflow: use units in which "
            f"the data stay below {LARGEST_DATUM:g}"
        )
    return values
