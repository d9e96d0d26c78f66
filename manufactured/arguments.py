"""Converts the arguments of public functions and classes to the types of their annotations, or refuses them.

NumPy scalars, numbers of SymPy, lists for tuples and names of the members of an ``Enum`` are converted. A text, a
boolean, a complex number, NaN or infinity is no number, and a number is no vector.
"""

import inspect
import reprlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from enum import EnumMeta
from functools import cache, wraps
from types import NoneType, UnionType
from typing import Annotated, Any, Protocol, TypeVar, Union, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import ArrayLike, NDArray

Decorated = TypeVar("Decorated")

Extended = Annotated[float, "may be infinite"]
"""The type of a real number that may be infinite."""
Size = Annotated[float, 1e-30, 1e30]
"""The type of a positive number, such as a length, that is neither extremely small nor extremely large.

Powers of such a number neither overflow nor underflow.
"""
Dimension = Annotated[int, 2, 3]
"""The type of the number of directions in space."""
Degree = Annotated[int, 0, 1]
"""The type of an exponent that is 0 or 1, of a factor that may be missing."""
Count = Annotated[int, 1, 1e6]
"""The type of a whole number from 1 to a million, such as a number of points or time steps."""
Natural = Annotated[int, 0, 1e18]
"""The type of a whole number that is not negative."""
BYTES = str, bytes, bytearray, memoryview
"""Types with entries that are no numbers and no formulas."""
ARRAY_ORIGINS: tuple[Any, ...] = (np.ndarray, NDArray)
"""What an annotation of an array is made of: ``ndarray``, and since NumPy 2.5 also ``NDArray`` itself."""

_hints = cache(lambda target: get_type_hints(target, include_extras=True))


class _ReasonError(ValueError):
    """Raised with a reason, which the message repeats."""


class _MismatchError(Exception):
    """Raised if a value has another type; the arguments are its place, the value and the annotation."""


def checked(error: type[Exception]) -> Callable[[Decorated], Decorated]:
    """Return a decorator that converts the arguments of a function or dataclass to the types of their annotations.

    Args:
        error: the exception that a call raises if an argument cannot be converted or is not finite.

    >>> @checked(ValueError)
    ... def double(x: float) -> float:
    ...     return 2 * x
    >>> double(np.float32(1.5))
    3.0
    >>> double("3")
    Traceback (most recent call last):
    ValueError: double: x has to be a finite real number, got '3' of the type str
    """

    def decorate(target: Any) -> Any:
        return _checked_class(target, error) if isinstance(target, type) else _checked_function(target, error)

    return decorate


def _checked_class(cls: Any, error: type[Exception]) -> Any:
    further = getattr(cls, "__post_init__", None)

    def convert_fields(self: Any) -> None:
        for field in fields(cls):
            value = getattr(self, field.name)
            if value is not field.default:
                place = f"{type(self).__name__}: {field.name}"
                object.__setattr__(self, field.name, _accepted(value, _hints(cls)[field.name], place, error))
        if further:
            further(self)

    cls.__post_init__ = convert_fields
    return cls


def _checked_function(function: Callable[..., Any], error: type[Exception]) -> Callable[..., Any]:
    signature = inspect.signature(function)

    @wraps(function)
    def call(*args: Any, **others: Any) -> Any:
        bound = signature.bind(*args, **others)
        hints = _hints(function)
        for name, value in bound.arguments.items():
            if name in hints and value is not signature.parameters[name].default:
                place = f"{function.__name__}: {name}"
                bound.arguments[name] = _accepted(value, hints[name], place, error)
        return function(*bound.args, **bound.kwargs)

    return call


def _accepted(value: Any, hint: Any, place: str, error: type[Exception]) -> Any:
    """Return a value converted to an annotated type, or raise the error with a sentence."""
    try:
        return _converted(value, hint, place)
    except _MismatchError as mismatch:
        where, given, expected = mismatch.args
        message = f"{where} has to be {_phrase(expected)}, got {reprlib.repr(given)} of the type {type(given).__name__}"
        cause = mismatch.__cause__
        raise error(f"{message}: {cause}" if isinstance(cause, _ReasonError) else message) from cause


def _converted(value: Any, hint: Any, place: str) -> Any:
    options = _options(hint)
    if value is None and NoneType in get_args(hint):
        return None
    for option in options[:-1]:
        try:
            return _converted(value, option, place)
        except _MismatchError:
            continue
    try:
        return _as_type(value, options[-1], place)
    except (TypeError, ValueError, OverflowError) as cause:
        raise _MismatchError(place, value, hint) from cause


def _options(hint: Any) -> list[Any]:
    """Return the alternatives of an annotation, without None."""
    if hint in SCALARS or get_origin(hint) not in (Union, UnionType):
        return [hint]
    return [option for option in get_args(hint) if option is not NoneType]


def _is_formula(hint: Any) -> bool:
    """Return whether an annotation is ``sympy.Expr``; SymPy is not imported, because bodies do not need it."""
    return getattr(hint, "__name__", "") == "Expr"


def _as_type(value: Any, hint: Any, place: str) -> Any:
    origin, inner = get_origin(hint), get_args(hint)
    if hint in SCALARS:
        return SCALARS[hint][1](value)
    if origin is Annotated:
        converted = _as_type(value, inner[0], place)
        _require(len(inner) < 3 or inner[1] <= converted <= inner[2])
        return converted
    if origin in ARRAY_ORIGINS:
        return _array(value)
    if origin in (tuple, Sequence):
        entries = _entries(value)
        types = inner if origin is tuple and Ellipsis not in inner else inner[:1] * len(entries)
        each = zip(entries, types, strict=True)
        return tuple(_converted(entry, type_, f"{place}[{i}]") for i, (entry, type_) in enumerate(each))
    if origin is Mapping:
        _require(isinstance(value, Mapping))
        return {
            _converted(key, inner[0], f"the key {key!r} of {place}"): _converted(entry, inner[1], f"{place}[{key!r}]")
            for key, entry in value.items()
        }
    if origin is Callable:
        _require(callable(value) and not isinstance(value, type))
    elif _is_formula(hint):
        return _formula(value)
    elif isinstance(hint, EnumMeta):
        return _member(value, hint)
    elif Protocol in getattr(hint, "__bases__", ()):
        missing = object()
        names = [name for name in dir(hint) if not name.startswith("_")]
        _require(not isinstance(value, type))
        _require(all(inspect.getattr_static(value, name, missing) is not missing for name in names))
    elif hint is not Any:
        _require(isinstance(value, hint))
    return value


def _require(condition: bool) -> None:
    if not condition:
        raise TypeError


def _entries(value: Any) -> list[Any]:
    """Return the entries of a tuple, list or array; other iterables have no order or are texts."""
    _require(hasattr(value, "__getitem__") and not hasattr(value, "keys") and not isinstance(value, BYTES))
    return list(value)


def _scalar(value: Any, kinds: str = "iufO") -> Any:
    """Return a value whose NumPy type is one of the given kinds and that is no array."""
    entry = _unmasked(value)
    _require(entry.ndim == 0 and entry.dtype.kind in kinds and not isinstance(entry.item(), bool))
    return entry.item()


def _unmasked(value: Any) -> Any:
    """Return a value as an array without masked entries, which NumPy would replace by the numbers behind the mask."""
    _require(not np.ma.is_masked(value))
    return np.asarray(value)


def _extended(value: Any) -> float:
    number = float(_scalar(value))
    _require(not np.isnan(number))
    return number


def _number(value: Any) -> float:
    """Return a finite number as an ``int`` of Python, if it is one, and otherwise as a ``float``."""
    number = float(_scalar(value))
    _require(bool(np.isfinite(number)))
    return value if type(value) is int else number


def _complex(value: Any) -> complex:
    number = complex(_scalar(value, "iufcO"))
    _require(bool(np.isfinite(number)))
    return number


def _whole(value: Any) -> int:
    _require(float(_number(value)).is_integer())
    return int(value)


def _flag(value: Any) -> bool:
    _require(isinstance(value, bool | np.bool_))
    return bool(value)


def _text(value: Any) -> str:
    _require(isinstance(value, str))
    return str(value)


def _array(value: Any) -> Any:
    _require(not isinstance(value, BYTES))
    given = _unmasked(value) if isinstance(value, np.ndarray) else np.array(value, dtype=object)
    _require(given.ndim > 0)
    exact = given if given.dtype.kind in "iuf" else np.vectorize(_number, otypes=[float])(given)
    numbers = np.asarray(exact, dtype=float)
    _require(bool(np.isfinite(numbers).all()))
    return numbers


def _numbers(value: Any) -> Any:
    """Return a number or an array of numbers. Rows of different lengths are left to the function, which knows more."""
    try:
        shape = np.shape(value)
    except ValueError:
        return value
    return _array(value) if shape else _number(value)


def _formula(value: Any) -> Any:
    import sympy as sp

    from manufactured.symbols import NOT_REAL, extreme_numbers

    formula = sp.sympify(value if isinstance(value, sp.Basic) else _scalar(value), strict=True)
    _require(isinstance(formula, sp.Expr) and not formula.is_Matrix)
    if formula.has(*NOT_REAL):
        raise _ReasonError("it is not a real number everywhere, as it has a number that is complex or not finite")
    for number in extreme_numbers(formula):
        raise _ReasonError(f"double precision cannot represent its number {sp.N(number, 3)}")
    return formula


def _member(value: Any, kind: Any) -> Any:
    if isinstance(value, kind):
        return value
    members = {text.casefold(): member for member in kind for text in (member.name, member.value)}
    _require(isinstance(value, str) and value.casefold() in members)
    return members[value.casefold()]


def _phrase(hint: Any) -> str:
    """Return words for an annotation, for messages."""
    origin, inner = get_origin(hint), get_args(hint)
    if hint in SCALARS:
        return SCALARS[hint][0]
    if origin is Annotated:
        return str(inner[1]) if len(inner) < 3 else f"{_phrase(inner[0])} from {inner[1]:g} to {inner[2]:g}"
    if origin in (Union, UnionType):
        return " or ".join(map(_phrase, _options(hint)))
    if origin in ARRAY_ORIGINS:
        return "an array of finite real numbers"
    if origin is tuple and Ellipsis not in inner:
        return f"a tuple or list of {len(inner)} entries"
    if origin in (tuple, Sequence):
        return f"a tuple or list, each entry {_phrase(inner[0])}"
    if origin is Mapping:
        return f"a dict from {_phrase(inner[0])} to {_phrase(inner[1])}"
    if origin is Callable:
        return "a function"
    if _is_formula(hint):
        return "a number or a formula of SymPy"
    if isinstance(hint, EnumMeta):
        names = ", ".join(repr(member.name.lower()) for member in hint)  # type: ignore[var-annotated]
        return f"a member of {hint.__name__} or one of the names {names}"
    return f"an instance of {hint.__name__}"


SCALARS: dict[Any, tuple[str, Callable[[Any], Any]]] = {
    float: ("a finite real number", _number),
    Extended: ("a real number, which may be infinite", _extended),
    complex: ("a finite number", _complex),
    int: ("a whole number", _whole),
    bool: ("True or False", _flag),
    str: ("a text", _text),
    ArrayLike: ("an array of finite real numbers", _numbers),
    object: ("anything", lambda value: value),
}
"""Words for a type and the function that converts a value to it, for types that are not recognised by a rule."""
