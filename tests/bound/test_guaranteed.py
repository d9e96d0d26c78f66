"""A guaranteed bound holds for data that no sample sees; what cannot be enclosed is called estimated."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pytest
import sympy as sp
from scipy.sparse.linalg import eigsh
from skfem import BilinearForm, ElementTriP2, ElementVector, FacetBasis, InteriorBasis
from skfem.helpers import dot
from sympy import Expr, Rational, cos, exp, log, pi, sin, sqrt, tanh

from manufactured import FrobeniusBall, KelvinVoigt, Kind, Linear, Yield, catalogue, isotropic, pos, t, unit_square
from manufactured.body import Body
from manufactured.data import Data
from manufactured.factor import layers, x1, x2
from manufactured.problems import problems
from manufactured.tensors import Array
from study.bound import sampling
from study.bound.bounded import BoundedSolution, bounded_solution
from study.bound.discretisation import Discretisation
from study.bound.enclosing import Enclosure
from study.bound.load_constants import load_constants
from study.bound.ranges import Boxes
from study.bound.remainders import Regions
from study.bound.sampling import ESTIMATED, GUARANTEED
from study.bound.trajectory import DiscreteSolution, Refined
from study.bound.univariate import RangeError
from study.fem.mesh import MeshFamily, OneDiagonal, Shaken, Unstructured
from study.solve.tableau import MIDPOINT

LAW = KelvinVoigt(isotropic(1, 0.5), isotropic(2, 3), "linear")
BALLISTIC = [{"pos": lambda x, a: np.where(x > 0, np.maximum(x, 1e-300) ** a, 0.0)}, "numpy"]


# ---- ranges


FORMULAS = [
    t * exp(-4 * (x1 - 0.3) ** 2 - 4 * (x2 - 0.4) ** 2),
    sin(3 * x1 * t) * cos(x2) / (1 + x1**2),
    pos(x1 - t, 3) * x2,
    pos(x1 - x2, Rational(5, 2)) - pos(t - x2, 0),
    sqrt(1 + x1 * x2) + (1 + x2) ** Rational(-3, 2),
    tanh(x1 - 2 * t) + x1 ** (1 + x2),
    x2**5 * log(2 + x1) + (x1 - Rational(1, 2)) ** 4,
    (1 - (x1 - t) ** 2) ** 3 / (2 + sin(9 * x2)) ** 2,
]


@pytest.mark.parametrize("formula", FORMULAS, ids=str)
@pytest.mark.parametrize("variables", [(x1, x2), (t,)], ids=["space", "time"])
def test_taylor_coefficients_lie_in_their_ranges(formula: Expr, variables: tuple[sp.Symbol, ...]) -> None:
    rng, count = np.random.default_rng(0), 40
    low = rng.random((3, count))
    high = low + np.geomspace(1e-3, 0.3, count)
    found = (boxes := Boxes(dict(zip((x1, x2, t), zip(low, high, strict=True), strict=True)), variables, 4))(formula)
    for term, key in enumerate(boxes.keys):
        derivative = formula
        for variable, times in zip(variables, key, strict=True):
            derivative = sp.diff(derivative, variable, times) / sp.factorial(times)
        values = sp.lambdify((x1, x2, t), derivative, modules=BALLISTIC)
        for _ in range(10):
            with np.errstate(over="ignore"):
                value = values(*(low + rng.random((3, count)) * (high - low))) * np.ones(count)
            slack = 1e-9 * abs(value) + 1e-12
            assert (found.low[term] - slack <= value).all()
            assert (value <= found.high[term] + slack).all()


def test_ranges_of_small_boxes_are_tight() -> None:
    low, high = np.array([0.4]), np.array([0.4 + 1e-6])
    found = Boxes({x1: (low, high), t: (low, high)}, (x1,), 4)(sin(3 * x1 * t) * exp(x1) / (1 + x1**2))
    assert (found.high - found.low).max() < 1e-3


def test_no_derivative_is_known_beyond_the_order_of_a_kink() -> None:
    low, high = np.array([0.0, 0.6]), np.array([1.0, 0.9])
    found = Boxes({x1: (low, high)}, (x1,), 4)(pos(x1 - Rational(1, 2), 2))
    assert np.isfinite(found.high[:3]).all()
    assert np.isinf(found.high[3:, 0]).all()
    assert np.isfinite(found.high[:, 1]).all()


def test_functions_without_ranges_are_named() -> None:
    low, high = np.zeros(1), np.ones(1)
    with pytest.raises(RangeError, match="gamma"):
        Boxes({x1: (low, high)}, (x1,), 2)(sp.gamma(1 + x1))


def test_polynomials_of_degree_three_have_no_remainder_and_others_have_that_of_taylor() -> None:
    sides = {x1: (np.array([0.2]), np.array([0.4])), x2: (np.array([0.1]), np.array([0.3]))}
    region = Regions(sides)
    assert region.in_space([x1**3 - x1 * x2**2 + t**5], 0.0, 1.0) == 0
    assert region.in_space([x1**4], 0.0, 1.0) == pytest.approx(0.1**4)
    assert region.in_space([pos(x1 - Rational(3, 10), 1)], 0.0, 1.0) <= 0.1
    parabola, cubic = region.in_time([t**2 * x1, t**2], 0.0, 1.0)
    assert parabola == cubic == 0
    assert region.in_time([t**3], 0.0, 1.0)[0] > 0 == region.in_time([t**3], 0.0, 1.0)[1]


# ---- constants


@pytest.mark.parametrize("body", [unit_square(), *(problem.data.body for problem in problems())])
def test_constants_of_loads_are_above_those_of_any_displacements_and_close(body: Body) -> None:
    constants = load_constants(body, isotropic(1, 0.5))
    data = Data.formulas(body, LAW, f0=(0, 0))
    fine = Discretisation(data, Unstructured()(body, 8))
    V = fine.displacements
    for part, bound in ((None, constants.volume), (Kind.LOADED, constants.surface)):
        mass = squares(V, part)
        largest = math.sqrt(float(eigsh(mass, 1, fine.M, which="LA", return_eigenvectors=False)[0]))
        assert largest <= bound <= 1.5 * largest


def squares(V, part: Kind | None):
    """The matrix of (u, v)_H, or of (u, v)_{L²} on parts, in the free unknowns."""
    element = ElementVector(ElementTriP2())
    if part is None:
        basis = InteriorBasis(V.mesh, element)
    else:
        facets = np.concatenate([V.facets(one) for one in V.body.of(part)])
        basis = FacetBasis(V.mesh, element, facets=facets)
    full = BilinearForm(lambda u, v, w: dot(u, v)).assemble(basis)
    clamped = basis.get_dofs(np.concatenate([V.facets(one) for one in V.body.of(Kind.CLAMPED)])).all()
    free = np.setdiff1d(np.arange(full.shape[0]), clamped)
    return full[free][:, free]


# ---- a problem whose solution is known and whose data are as rough as one likes


@dataclass(frozen=True, eq=False)
class Known:
    """u = x2² (1 − x2) g on the unit square: u = 0 and σν = 0 on Γ3, u = 0 on Γ1; f_0 and f_2 follow by SymPy.

    ``sharp`` are centres and widths of what g has of small features.
    """

    law: KelvinVoigt
    g: tuple[Expr, Expr]
    sharp: tuple[tuple[float, float, float], ...] = ()

    @property
    def u(self) -> list[Expr]:
        return [x2**2 * (1 - x2) * g for g in self.g]

    @cached_property
    def strain(self) -> list[Expr]:
        u = self.u
        return [sp.diff(u[0], x1), sp.diff(u[1], x2), (sp.diff(u[0], x2) + sp.diff(u[1], x1)) / sp.sqrt(2)]

    @cached_property
    def data(self) -> Data:
        body = unit_square()
        A, G = (sp.Matrix(tensor.matrix.tolist()) for tensor in (self.law.A, self.law.G))
        strain = sp.Matrix(self.strain)
        a, b, c = A * sp.diff(strain, t) + G * strain
        stress = sp.Matrix([[a, c / sp.sqrt(2)], [c / sp.sqrt(2), b]])
        force = [-sp.diff(stress[i, 0], x1) - sp.diff(stress[i, 1], x2) for i in (0, 1)]
        loads = {
            number: list(stress * sp.Matrix([sp.nsimplify(float(c)) for c in part.normal]))
            for number, part in enumerate(body.parts)
            if part.kind is Kind.LOADED
        }
        return Data.formulas(body, self.law, force, loads, u0=[u.subs(t, 0) for u in self.u])

    @cached_property
    def _compiled(self):
        return sp.lambdify((x1, x2, t), self.strain, "numpy", cse=True)

    @cached_property
    def points(self) -> tuple[Array, Array]:
        """Gauss points of a grid that is fine where something is sharp."""
        rules = []
        for axis in (0, 1):
            places = [*np.linspace(0, 1, 25)]
            for feature in self.sharp:
                places += list(feature[axis] + feature[2] * np.linspace(-6, 6, 49))
            nodes = np.unique(np.clip(places, 0, 1))
            x, w = np.polynomial.legendre.leggauss(4)
            half, middle = np.diff(nodes) / 2, (nodes[1:] + nodes[:-1]) / 2
            rules.append(((middle[:, None] + half[:, None] * x).ravel(), (half[:, None] * w).ravel()))
        (x, wx), (y, wy) = rules
        return np.array(np.meshgrid(x, y, indexing="ij")).reshape(2, -1), np.outer(wx, wy).ravel()

    def error(self, computed: DiscreteSolution, time: float) -> float:
        """‖u(t) − u_h(t)‖_V."""
        x, weights = self.points
        nodal = computed.space.nodal(computed.at(time))
        mesh = computed.space.mesh
        cells = mesh.element_finder()(*x)
        corners, values = mesh.p[:, mesh.t], nodal[:, mesh.t]
        F = np.moveaxis(corners[:, 1:] - corners[:, :1], 2, 0)
        gradient = np.moveaxis(values[:, 1:] - values[:, :1], 2, 0) @ np.linalg.inv(F)
        discrete = np.array(
            [gradient[:, 0, 0], gradient[:, 1, 1], (gradient[:, 0, 1] + gradient[:, 1, 0]) / math.sqrt(2)]
        )[:, cells]
        exact = np.array([np.broadcast_to(value, cells.shape) for value in self._compiled(*x, time)])
        difference = exact - discrete
        return math.sqrt(float(np.einsum("In,IJ,Jn,n->", difference, self.law.A.matrix, difference, weights)))


GRID = OneDiagonal()


def enclosed(problem: Data, level: int, steps: int, family: MeshFamily = GRID) -> tuple[BoundedSolution, Enclosure]:
    found = bounded_solution(problem, None, family, level, MIDPOINT, steps, Refined(0, 1))
    return found, found.enclosure


def assert_inside(known: Known, level: int, steps: int, family: MeshFamily, rng: np.random.Generator) -> Enclosure:
    found, enclosure = enclosed(known.data, level, steps, family)
    assert enclosure.evidence.kind == GUARANTEED
    for time, lower, upper in zip(enclosure.times, enclosure.lower, enclosure.upper, strict=True):
        error = known.error(found.computed, time)
        assert lower * (1 - 1e-6) <= error <= upper * (1 + 1e-6)
    for time in rng.random(3):
        assert known.error(found.computed, time) <= min(enclosure.highest, found.plain.highest) * (1 + 1e-6)
    return enclosure


def random_problem(seed: int) -> tuple[Known, int, int, MeshFamily]:
    """Laws, meshes, bumps down to a hundredth of a cell, frequencies up to a hundred periods a step."""
    rng = np.random.default_rng(seed)
    level, steps = int(rng.integers(2, 5)), int(rng.integers(2, 5))
    tensors = []
    for _ in range(2):
        B = rng.normal(size=(3, 3))
        tensors.append(Linear(B @ B.T + 0.3 * np.eye(3)))
    law = KelvinVoigt(*tensors, "random")
    sharp, g = [], [sp.Float(round(float(rng.normal()), 3)) * (1 + x1 * t), sp.Float(round(float(rng.normal()), 3)) * t]
    for _ in range(int(rng.integers(0, 3))):
        width = float(10 ** rng.uniform(-2, 0)) / level
        a, b = rng.uniform(0.15, 0.85, 2)
        bump = exp(-((x1 - sp.Float(a)) ** 2 + (x2 - sp.Float(b)) ** 2) / sp.Float(width) ** 2)
        frequency = sp.Float(float(10 ** rng.uniform(-1, 2)) * steps)
        direction = int(rng.integers(2))
        g[direction] += sp.Float(float(rng.uniform(0.1, 2))) * bump * cos(2 * pi * frequency * t)
        sharp.append((float(a), float(b), width))
    family = (OneDiagonal(), Shaken(seed=seed), Unstructured(seed=seed))[int(rng.integers(3))]
    return Known(law, tuple(g), tuple(sharp)), level, steps, family


@pytest.mark.parametrize("seed", range(4))
def test_no_error_lies_outside_for_random_data_that_samples_do_not_see(seed: int) -> None:
    known, level, steps, family = random_problem(seed)
    assert_inside(known, level, steps, family, np.random.default_rng(seed))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4, 200))
def test_no_error_lies_outside_for_many_random_data_that_samples_do_not_see(seed: int) -> None:
    known, level, steps, family = random_problem(seed)
    assert_inside(known, level, steps, family, np.random.default_rng(seed))


def test_bounds_without_remainders_put_such_errors_outside(monkeypatch: pytest.MonkeyPatch) -> None:
    width = Rational(1, 200)
    bump = exp(-((x1 - Rational(37, 100)) ** 2 + (x2 - Rational(41, 100)) ** 2) / width**2)
    known = Known(LAW, (sp.Integer(0), t * bump / 10), ((0.37, 0.41, 0.005),))
    assert_inside(known, 4, 2, OneDiagonal(), np.random.default_rng(0))
    monkeypatch.setattr(sampling.Sampling, "reasons", ("blind",))
    found, enclosure = enclosed(known.data, 4, 2)
    assert known.error(found.computed, 1.0) > 1000 * enclosure.highest


# ---- the two examples that a bound from samples got wrong


def spike(width: Expr) -> Data:
    """A load that is concentrated at one point."""
    force = -10 / (pi * width**2) * t * exp(-((x1 - 0.37) ** 2 + (x2 - 0.41) ** 2) / width**2)
    return Data.formulas(unit_square(), LAW, f0=(0, force))


@pytest.mark.parametrize(("width", "least"), [(Rational(5, 1000), 1.4), (Rational(1, 100), 1.64)])
def test_a_load_within_a_hundredth_of_a_cell_is_enclosed_and_its_place_is_named(width: Expr, least: float) -> None:
    _, enclosure = enclosed(spike(width), 4, 4)
    assert enclosure.evidence.kind == GUARANTEED
    assert enclosure.highest > least
    assert "f_0 is seen poorly near x = (0.4" in enclosure.evidence.poorly_seen


def test_a_load_that_vanishes_at_all_nodes_in_time_is_enclosed() -> None:
    _, enclosure = enclosed(Data.formulas(unit_square(), LAW, f0=(0, -100 * sin(64 * pi * t) ** 2)), 4, 8)
    assert enclosure.highest > 3.2
    assert "f_0 is seen poorly" in enclosure.evidence.poorly_seen


def test_remainders_of_smooth_data_fall_faster_than_the_error() -> None:
    data = Data.formulas(unit_square(), LAW, f0=(0, -10 * t * sin(2 * pi * x1) * x2))
    unseen = [sum(one.unseen for one in enclosed(data, n, n)[1].intervals) for n in (3, 6, 12)]
    assert unseen[0] / unseen[1] > 8
    assert unseen[1] / unseen[2] > 8
    assert enclosed(data, 12, 12)[1].evidence.poorly_seen == ""


# ---- what is not guaranteed says so


CASES = {case.name: case for case in catalogue()}
SQUARE = unit_square()


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (Data.of(CASES["full-contact"].solution), "known at points and times only"),
        (Data.formulas(SQUARE, LAW, f0=(sp.gamma(1 + x1), 0)), "gamma"),
        (
            Data.formulas(SQUARE, KelvinVoigt(isotropic(1, 1), Yield(1.0, FrobeniusBall(1.0)), "(3.3)"), f0=(0, 0)),
            "nonlinear G",
        ),
        (
            Data.formulas(
                SQUARE,
                KelvinVoigt(Linear(isotropic(1, 1).matrix, layers((1.0, 0.0), 0.5, 2.0)), isotropic(1, 1), "layers"),
                f0=(0, 0),
            ),
            "varies in x",
        ),
        (Data.formulas(SQUARE, LAW, f0=(0, pos(x1 - 0.4, 1)), lines=(((1.0, 0.0), 0.4),)), "graded rules"),
    ],
    ids=["values", "gamma", "nonlinear", "layers", "lines"],
)
def test_what_is_sampled_is_called_estimated_with_the_reason(data: Data, reason: str) -> None:
    evidence = Discretisation(data, OneDiagonal()(data.body, 4)).sampling
    assert any(reason in one for one in evidence.reasons)


def test_a_kink_without_lines_is_guaranteed_by_a_lower_order() -> None:
    data = Data.formulas(SQUARE, LAW, f0=(0, -5 * pos(x1 - x2 - t / 3, 1)))
    _, enclosure = enclosed(data, 4, 4)
    assert enclosure.evidence.kind == GUARANTEED != ESTIMATED
    assert sum(one.unseen for one in enclosure.intervals) > 0


def test_a_wedge_with_a_rolling_load_is_guaranteed() -> None:
    (wedge,) = (problem.data for problem in problems() if problem.name == "ramp")
    sampled = Discretisation(wedge, Unstructured()(wedge.body, 2)).sampling
    assert sampled.reasons == ()
