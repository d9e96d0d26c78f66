"""Arguments of another type: they are converted with the right meaning, or refused with a sentence."""

from collections.abc import Callable
from inspect import signature

import numpy as np
import pandas as pd
import pytest
import sympy as sp

from manufactured import (
    HERMITE,
    Body,
    Case,
    Combined,
    ContactFace,
    Data,
    DeviatoricBall,
    ExactSolution,
    Factor,
    FrobeniusBall,
    Indefinite,
    KelvinVoigt,
    Kind,
    Linear,
    Memory,
    Monomial,
    NonSymmetric,
    Part,
    Prescribed,
    Profile,
    Regularity,
    SingularFace,
    SingularField,
    TravellingField,
    Yield,
    box,
    cutoff,
    evaluate,
    examine,
    isotropic,
    isotropic_matrix,
    kolosov,
    layered,
    named,
    plane_strain,
    plane_stress,
    polygon,
    pos,
    prove,
    s,
    slab,
    static,
    t,
    unit_square,
    x1,
    x2,
)
from manufactured.cases.rough import natural_motion
from manufactured.multiscale import FadingFace, rollers
from manufactured.profile import Piecewise

CASE = named("full-contact")
BODY = CASE.solution.body
LAW = CASE.solution.law
(FACE,) = CASE.solution.faces
ROUND = Piecewise((1.0,), (HERMITE,))
STEP = (1.0, 0.0), 0.5
SIDE = (0.0, 0.5), (1.0, 0.5)
MATRIX = np.array([[3.0, 1.0, 0.0], [1.0, 3.0, 0.0], [0.0, 0.0, 2.0]])
HALF = sp.Rational(1, 2)
LINEAR = Linear(MATRIX)
BALL = FrobeniusBall(1.0)
FIELD = SingularField((0.0, 0.0), FACE.part.frame, *kolosov(2.0, 1j, -0.5j, 1.5), t, depth=ROUND)
PLAIN = Data.formulas(BODY, LAW, (0, 0))

VALUES = {
    **{name: 2.0 for name in ("T", "mu", "lam", "radius", "beta", "low", "depth", "E", "ratio", "kappa")},
    **{name: s * t for name in ("gap", "pressure")},
    **{name: s for name in ("initial", "initial_gap", "level")},
    **{name: Kind.CONTACT for name in ("kind", "left", "right", "front", "back")},
    **{name: "words" for name in ("name", "summary", "reason")},
    **{name: (0.5,) for name in ("rough", "kinks")},
    **{name: ((0.0, 1.0),) for name in ("refine", "points", "singular")},
    **{name: (STEP,) for name in ("steps", "lines")},
    **{name: 1.5 for name in ("exponent", "corner", "on_contact")},
    **{name: True for name in ("moving", "kink")},
    "nu": 0.25,
    "dim": 3,
    "seed": 1,
    "matrix": MATRIX,
    "factor": Factor(2 + x1, 2.0, 3.0),
    "body": BODY,
    "law": LAW,
    "part": FACE.part,
    "profile": slab(),
    "slip": (s * t,),
    "strain": Prescribed(((1.0, s * t),)),
    "phi": HERMITE,
    "solution": CASE.solution,
    "field": FIELD,
    "G": LINEAR,
    "f0": (sp.Integer(0), x1),
    "f2": {1: (x2, sp.Integer(1))},
    "place": HALF + t / 4,
}
"""Correct arguments by their names, each in the form in which it is stored."""
CALLS = {
    Part: {"corners": np.array([[0.0, 1.0], [0.0, 0.0]])},
    Body: {"parts": BODY.parts, "interfaces": ()},
    polygon: {
        "vertices": ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)),
        "kinds": (Kind.CONTACT, Kind.LOADED, Kind.CLAMPED, Kind.LOADED),
        "interfaces": (SIDE,),
    },
    unit_square: {},
    box: {"lengths": (1.0, 2.0, 1.0)},
    Linear: {},
    Indefinite: {"matrix": -MATRIX},
    NonSymmetric: {},
    isotropic: {},
    isotropic_matrix: {},
    FrobeniusBall: {},
    DeviatoricBall: {},
    Yield: {"convex": BALL},
    Combined: {"prestress": np.array([1.0, 0.0, 2.0]), "linear": LINEAR, "yielding": Yield(1.0, BALL)},
    KelvinVoigt: {"A": LINEAR, "G": Yield(1.0, BALL)},
    Factor: {"formula": 2 + x1, "high": 3.0},
    Piecewise: {"ends": (0.5, 1.0), "pieces": ((1.0, 0.5), (2.0,))},
    Profile: vars(cutoff(2.0)),
    cutoff: {},
    slab: {},
    layered: {"interface": 0.25, "depth": 0.5},
    Memory: {"viscosity": 2 + s, "elasticity": 4 + 2 * s},
    Prescribed: {"phases": ((0.5, s * t), (1.0, s / 2 + t - t))},
    ContactFace: {},
    ContactFace.linear: {"gap": t * pos(s - HALF, 4), "pressure": t * pos(HALF - s, 2), "level": HALF - s},
    Monomial: {"m": 1, "c": 1.0 + 1j, "beta": 0.5},
    kolosov: {"a": 1j, "b": -0.5j},
    SingularField: {name: getattr(FIELD, name) for name in ("centre", "frame", "x", "y", "theta", "depth")},
    TravellingField: {"steady": FIELD},
    SingularFace: {"gap": s},
    ExactSolution: {"faces": (FACE,), "others": (FIELD,)},
    Regularity: {"gap": 4.0, "pressure": 2.0},
    Case: {"regularity": CASE.regularity, "order": 1.0, "pace": 4.0, "families": ("one-diagonal",)},
    Data: {name: getattr(PLAIN, name) for name in ("body_force", "surface_load", "start", "initial")},
    Data.of: {},
    Data.formulas: {"u0": (0, x2 - x2)},
    static: {},
    plane_strain: {},
    plane_stress: {},
    FadingFace: {"strain": s, "depth": 1 + s, "least_depth": 0.5},
    rollers: {"level": 8},
    natural_motion: {},
    pos: {"x": s - HALF, "a": HALF},
    named: {"name": "full-contact"},
    evaluate: {"of": CASE, "x": np.array([[0.5], [0.25]]), "time": 0.5},
    prove: {},
    examine: {"points": 2, "times": 2},
}
"""The public constructors and functions, with the correct arguments that differ from those above."""


def arguments(target):
    """Return correct arguments of a function, without those whose default is not replaced here."""
    names = signature(target).parameters
    given = {**VALUES, **CALLS[target]}
    return {name: given[name] for name in names if name in given}


OTHERS = {
    "a number": 3,
    "a text": "x y z",
    "a boolean": True,
    "a NumPy boolean": np.True_,
    "a complex number": 1 + 1j,
    "NaN": float("nan"),
    "infinity": np.inf,
    "None": None,
    "a dict": {1: 2},
    "a set": {1, 2},
    "a list of texts": ["1", "2"],
    "a list of booleans": [True, False],
    "nested lists of NaN": [[np.nan, 1.0], [1.0, 2.0]],
    "a type": float,
    "a function": abs,
    "a relation": s < 1,
    "a symbol": sp.Symbol("foreign"),
    "a time difference": np.timedelta64(1, "s"),
    "a masked number": np.ma.masked,
    "a boolean as an object": np.array(True, dtype=object),
}
EXCEPTIONS = {
    "None": {
        Memory: ("initial",),
        ContactFace.linear: ("initial",),
        SingularField: ("depth",),
        Data.formulas: ("f2", "u0"),
        static: ("f0", "f2"),
    },
    "a list of texts": {Case: ("families",)},
    "infinity": {Regularity: ("gap", "pressure", "corner", "on_contact")},
}
"""Kind of value ↦ the arguments of functions that may have it."""
ACCEPTED = {
    sp.Expr: {"a number", "a symbol"},
    bool: {"a boolean", "a NumPy boolean"},
    complex: {"a number", "a complex number"},
    str: {"a text"},
    int | float: {"a number"},
    Callable: {"a function"},
}
"""Type of a correct value ↦ kinds of values that are correct in its place; the first type counts."""
SPEAKING = {pos: "pos.*: give a formula", named: "no case is called", evaluate: "points of the body|has to be"}
"""Messages that do not have the name of the argument."""


def permitted(value, other, target, name):
    """Return whether a value of another kind is correct in place of a value."""
    if other in EXCEPTIONS:
        return name in EXCEPTIONS[other].get(target, ())
    return next((other in kinds for accepted, kinds in ACCEPTED.items() if isinstance(value, accepted)), False)


def first_entry(value):
    """Return the first entry of nested tuples and dicts."""
    if isinstance(value, tuple | dict) and value:
        return first_entry(next(iter(value.values() if isinstance(value, dict) else value)))
    return value


def with_first_entry(value, wrong):
    if isinstance(value, dict):
        return {key: with_first_entry(entry, wrong) for key, entry in value.items()}
    return (with_first_entry(value[0], wrong), *value[1:]) if isinstance(value, tuple) and value else wrong


def call(target, given):
    return target(*given.values()) if target is pos else target(**given)


@pytest.mark.parametrize("target", CALLS, ids=lambda target: target.__qualname__)
def test_an_argument_of_another_type_is_refused_with_its_name(target):
    correct = arguments(target)
    call(target, correct)
    for name, value in correct.items():
        for other, wrong in OTHERS.items():
            places = [(value, wrong), (first_entry(value), with_first_entry(value, wrong))]
            for given, changed in places:
                if not permitted(given, other, target, name):
                    with pytest.raises(ValueError, match=SPEAKING.get(target, name)):
                        print(f"{other} for {name} gives", call(target, correct | {name: changed}))


SENSELESS = {
    FrobeniusBall: {"radius": (0.0, 1e308), "dim": (1, 4)},
    DeviatoricBall: {"radius": (0.0,), "dim": (1, 4)},
    isotropic: {"dim": (1, 4)},
    isotropic_matrix: {"dim": (1, 4)},
    Piecewise: {"ends": ((0.0, 1.0),)},
    cutoff: {"depth": (0.0, 5e-324, 1e308)},
    slab: {"depth": (0.0, 5e-324, 1e308)},
    layered: {"interface": (1e-200,), "ratio": (0, 1e308), "depth": (0.0, 1e308)},
    Memory: {"T": (0.0,), "pressure": (10**400,)},
    Prescribed: {"phases": ((), ((1.0, s), (0.5, s)), ((0.0, s),))},
    ContactFace: {"initial_gap": (10**400, 5e-324), "rough": (bytearray(b"12"), memoryview(b"12"))},
    ContactFace.linear: {"T": (0.0,)},
    Monomial: {"m": (-1, 2)},
    kolosov: {"kappa": (0.0,)},
    SingularField: {"frame": (np.eye(3), np.ones(5), np.ones((2, 2)), 2 * np.eye(2), bytearray(b"1234"))},
    FadingFace: {"least_depth": (0.0,)},
    # The entries of a table are the names of its columns.
    Data.formulas: {"f0": (bytearray(b"12"), (5e-324, 0), pd.DataFrame([[1.0, 2.0]]))},
    Linear: {"matrix": (np.ma.array(MATRIX, mask=MATRIX > 2),)},
    rollers: {"level": (0, 4)},
    prove: {"seed": (-1,)},
    examine: {"seed": (-1,), "points": (0, 1e308), "times": (0,)},
}
"""Values of the right type that make no sense."""


@pytest.mark.parametrize("target", SENSELESS, ids=lambda target: target.__qualname__)
def test_a_value_that_makes_no_sense_is_refused_with_its_name(target):
    for name, values in SENSELESS[target].items():
        for value in values:
            with pytest.raises(ValueError, match=rf"{name}(\[\d\])* (has|have|need)"):
                print(f"{value!r} for {name} gives", call(target, arguments(target) | {name: value}))
