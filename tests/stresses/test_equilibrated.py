"""Composite equilibrium stresses: their conditions checked from values at points, and their use in Problem 3.2."""

from dataclasses import replace
from itertools import product

import numpy as np
import pandas as pd
import pytest
import sympy as sp
from bodies import LAW
from costly_cases import slow, slow_unless
from loads import loads, stress
from measures import close, gauss
from skfem import Basis, DiscreteField, ElementTriP4, ElementVector, FacetBasis, LinearForm
from skfem.helpers import ddot, dot, grad

from manufactured import t, unit_square, x2
from manufactured.body import Kind
from manufactured.data import Data, no_fronts
from manufactured.regularity import Regularity
from manufactured.tensors import full
from study.fem.mesh import FAMILIES, MeshError, OneDiagonal, Shaken, Unstructured, cell_volumes
from study.fem.naming import resolve
from study.fem.quadrature import Line, bernstein, cell_rules, simplex_rule
from study.ledger.verdict import FAILS, HOLDS, REPORTED, UNDECIDED
from study.solve.tableau import BACKWARD_EULER, BDF2, MIDPOINT
from study.statements.thm_4_2 import (
    ERROR_TEXTS,
    OwnSpace,
    checks_of,
    inadmissible,
    predicted,
)
from study.stresses import stress_space
from study.stresses.hybrid import (
    DualState,
    Equilibrium,
    EquilibriumError,
    StressEvolution,
    act,
    tensor_at,
)
from study.stresses.loads import ProjectedLoads, together
from study.stresses.stress_space import StressSpace, alfeld_split, composite

BODIES = ("advance-recede", "rotated", "layered", "corner", "hexagon", "re-entrant", "junction")
"""Cases on bodies of different shape: turned, with an interface, with several contact faces, re-entrant, refined."""
DEGREES = (1, 2)
SERVED = [(name, family) for name, family in product(BODIES, FAMILIES) if family.serves(resolve(name).solution.body)]
MESHED = [
    slow_unless(n % 5 == 0, *one, degree, id=f"{one[0]}-{one[1].name}-{degree}")
    for n, (one, degree) in enumerate(product(SERVED, DEGREES))
]
"""A fifth of all, with the degrees in turn; the nightly job takes both degrees everywhere."""


def stress_at(solution, family, degree):
    space = StressSpace(family(solution.body, 4), solution.body, degree)
    loads = ProjectedLoads(Data.of(solution), space)(0.4)
    equilibrium = Equilibrium(space, np.linalg.inv(solution.law.A.matrix))
    strain = solution.at(space.points).strain(0.4)
    return space, loads, equilibrium, equilibrium(loads, -strain)


EXACT_FOR_TESTS = 6
"""The degree of a quadrature rule for products of stresses of degree 2 and derivatives of polynomials of degree 4."""


@LinearForm
def balance(v, w):
    return ddot(w.stress, grad(v)) - dot(w.force, v)


@LinearForm
def load(v, w):
    return dot(w.traction, v)


@pytest.mark.parametrize(("name", "family", "degree"), MESHED)
def test_a_stress_is_admissible_on_every_mesh_and_body(name, family, degree, monkeypatch):
    """All conditions of Σ^h(t) follow from values of the stress at points; nothing of the element is used.

    Div σ + P f_0 = 0, tractions are continuous, those on Γ2 are the loads, and those on Γ3 are the pressure p, as
    (σ, ε(v)) = (P f_0, v) + ∫_Γ2 f_2·v − ∫_Γ3 p v_ν for all continuous v of degree 4 on the subtriangles with v = 0 on
    Γ1: they include the products of residuals and bubble functions.
    """
    monkeypatch.setattr(stress_space, "LEAST_DEGREE", EXACT_FOR_TESTS)
    space, loads, equilibrium, stress = stress_at(resolve(name).solution, family, degree)
    mesh, _ = alfeld_split(space.mesh)
    outer = np.flatnonzero(mesh.facets.max(axis=0) < space.mesh.p.shape[1])
    assert np.array_equal(mesh.facets[:, outer], space.mesh.facets)
    _, weights = simplex_rule(2, EXACT_FOR_TESTS)
    at_points = (-1, mesh.nelements, len(weights))
    in_reference = mesh.mapping().invF(space.points.reshape(at_points))
    tested = Basis(mesh, ElementVector(ElementTriP4()), quadrature=(in_reference, weights / 2))
    force = np.einsum("ctad,aq->dctq", loads.force, space.force_shapes)
    fields = {"stress": full(stress.values.reshape(at_points)), "force": force.reshape(at_points)}
    work = balance.assemble(tested, **{name: DiscreteField(values) for name, values in fields.items()})

    s, weights = gauss(4)
    shapes = bernstein(degree, np.array([1 - s, s]))
    pressure = equilibrium.pressure(stress)
    pressures = iter(np.split(pressure, np.cumsum([len(edges) for _, edges in space.on(Kind.CONTACT)])))
    held = np.empty(0, dtype=int)
    for part, edges in zip(space.body.parts, space.parts, strict=True):
        side = FacetBasis(mesh, tested.elem, facets=outer[edges], quadrature=(s[None], weights))
        if part.kind is Kind.CLAMPED:
            held = np.append(held, tested.get_dofs(outer[edges]))
            continue
        traction = loads.surface[edges] if part.kind is Kind.LOADED else -next(pressures)[..., None] * part.normal
        work -= load.assemble(side, traction=DiscreteField(np.einsum("nad,aq->dnq", traction, shapes)))
    size = abs(stress.values).max()
    assert abs(np.delete(work, held)).max() <= 1e-9 * size
    assert (pressure @ shapes).min() >= -1e-8 * size
    assert pressure.max() > 1e-3 * size


def moments_of(space, displacement):
    """∫_e v B_i in the axes of the edges, (edges, n, 2)."""
    x, weights = gauss(6)
    along = np.array([1 - x, x])
    v = displacement(np.einsum("den,eq->dnq", space.mesh.p[:, space.mesh.facets], along))
    shapes = bernstein(space.degree, along) * weights
    return np.einsum("nij,jnq,aq,n->nai", space.frames, v, shapes, space.lengths)


def pressed_square():
    """f_0 and f_2 of u = t v with v = (0, −y(1 − y)), pressed on y = 0, clamped at y = 1: σ is linear in x and in t."""
    v = sp.Matrix([0, -x2 * (1 - x2)])
    body = unit_square()
    return Data.formulas(body, LAW, *loads(stress(LAW.A, v) + stress(LAW.G, t * v), body))


@pytest.mark.parametrize("degree", DEGREES)
@pytest.mark.parametrize("scheme", [BACKWARD_EULER, BDF2])
@pytest.mark.parametrize("family", [f for f in FAMILIES if f.serves(unit_square())])
def test_a_linear_stress_with_contact_and_memory_is_reproduced(family, scheme, degree):
    """Stress, strains, multipliers and pressure at every time, to round-off: nothing is approximated."""
    data = pressed_square()
    space = StressSpace(family(data.body, 3), data.body, degree)
    v = moments_of(space, lambda x: np.array([0 * x[0], -x[1] * (1 - x[1])]))
    edges = np.concatenate([edges for _, edges in space.on(Kind.CONTACT)])
    slope = -(1 - 2 * space.points[1])
    zero = 0 * slope
    first, *states = scheme.march(StressEvolution(data, space), 4)
    assert np.isnan(first.stress.values).all()
    assert abs(first.strain).max() <= 1e-14
    for state in states:
        across, along, _ = (LAW.A.matrix + state.time * LAW.G.matrix)[1]
        pressure = -space.boundary_tractions(edges, state.stress.tractions)[..., 0]
        assert abs(state.stress.values - np.array([across * slope, along * slope, zero])).max() <= 1e-10
        assert abs(state.strain - np.array([zero, state.time * slope, zero])).max() <= 1e-11
        assert abs(state.stress.moments - state.time * v).max() <= 1e-11
        assert pressure == pytest.approx(along)


@pytest.mark.parametrize(
    ("name", "family", "degree"),
    [
        *(("layered", Shaken(), 2), ("advance-recede", Shaken(), 2)),
        *(slow(*one) for one in (("corner", Shaken(), 1), ("hexagon", Unstructured(), 1))),
    ],
)
def test_a_stress_of_least_energy_satisfies_the_variational_inequality(name, family, degree, rng):
    """(C⁻¹σ + ε*, τ − σ)_Q ≥ 0 for random admissible stresses τ, which are stresses of least energy for other ε*.

    And σ is the admissible stress that is nearest to −C ε*.
    """
    solution = resolve(name).solution
    space, loads, _, _ = stress_at(solution, family, degree)
    C = tensor_at(solution.law.A, space.points)
    compliance = np.linalg.inv(C)
    strain = -solution.at(space.points).strain(0.4)
    equilibrium = Equilibrium(space, compliance)
    stress = equilibrium(loads, strain)
    target = act(C, -strain)
    nearest = equilibrium.nearest(loads, target, np.zeros((len(equilibrium.contact), degree + 1)))
    assert close(nearest.values + target, stress.values, 1e-10)
    others = strain[:, None] + abs(strain).max() * rng.normal(size=(3, 40, *space.weights.shape))
    differences = equilibrium(together([loads] * 40), others).values - stress.values[:, None]
    slope = act(compliance, stress.values) + strain
    complementary = act(compliance, differences)
    work = np.einsum("Icq,Iicq,cq->i", slope, differences, space.weights)
    size = np.einsum("Iicq,Iicq,cq->i", complementary, differences, space.weights)
    assert (work >= -1e-9 * size).all()
    pressure = equilibrium.pressure(stress)
    assert np.unique(pressure > 1e-6 * pressure.max()).tolist() == [False, True]


def test_what_cannot_be_posed_is_refused():
    with pytest.raises(ValueError, match="needs a degree of 1 or more, got 0"):
        composite(0)
    data = pressed_square()
    space = StressSpace(OneDiagonal()(data.body, 2), data.body)
    with pytest.raises(EquilibriumError, match="midpoint balances forces between time nodes"):
        list(MIDPOINT.march(StressEvolution(data, space), 2))
    yielding = resolve("yield-and-release").solution
    with pytest.raises(EquilibriumError, match="linear G"):
        list(BDF2.march(StressEvolution(Data.of(yielding), space), 2))
    solid = resolve("cube-disc").solution
    with pytest.raises(MeshError, match="made for triangles"):
        StressSpace(OneDiagonal()(solid.body, 2), solid.body)


SMOOTH = {"stress": 2, "strain": 2, "pressure": 2, "displacement": 2, "primal_stress": 1, "primal_displacement": 2}


def judged(orders, levels=3, **changed):
    """Verdicts about errors 2 h^p on one-diagonal meshes, for a smooth solution."""
    n = 2 ** np.arange(3, 3 + levels)
    family = "one-diagonal"
    h = 1 / n
    row = {"case": "a", "family": family, "level": n, "h": h, "best": h**2, "stress_sup": h**2}
    row |= {"admissibility": 1e-13, "time_share": 0.1} | {name: 2 * h**p for name, p in orders.items()}
    rows = pd.DataFrame(row | changed)
    groups = {family: rows.assign(ratio=rows["stress"] / rows["best"])}
    found = [rule.verdict(OwnSpace(), "a", groups, family) for rule in checks_of(Regularity(), family)]
    return {v.key: v.verdict for v in found if v.verdict != REPORTED}


def test_predicted_orders_hold_and_every_other_one_fails():
    assert set(judged(SMOOTH).values()) == {HOLDS}
    for name in ERROR_TEXTS:
        for order in (0.5 * SMOOTH[name], SMOOTH[name] + 1.3):
            assert judged(SMOOTH | {name: order})[f"order-{name}"] == FAILS, (name, order)
    for orders, changed, key in [
        (SMOOTH, {"admissibility": 1e-6}, "admissible"),
        (SMOOTH, {"time_share": 2.0}, "time-share"),
        (SMOOTH | {"stress": 1.8}, {}, "growth"),
    ]:
        found = judged(orders, **changed)
        assert [failed for failed, verdict in found.items() if verdict == FAILS] == [key]
    alone = judged(SMOOTH, levels=1)
    assert {verdict for key, verdict in alone.items() if key.startswith("order")} == {UNDECIDED}


FRONT = {"gap": 4, "pressure": 2, "moving": True}
CORNER = {"corner": 0.5445}


@pytest.mark.parametrize(
    ("regularity", "family", "quantity", "low"),
    [
        (FRONT, "shaken", "stress", 1.5),
        (FRONT, "shaken", "displacement", 1.5),
        (CORNER, "unstructured", "stress", 0.5445),
        (CORNER, "unstructured", "displacement", 1.089),
        (CORNER, "graded", "stress", 2.5 * 0.5445),
        (CORNER, "graded", "primal_stress", 1.0),
        (FRONT | CORNER, "unstructured", "pressure", 0.5445),
        (FRONT | CORNER, "graded", "pressure", 1.0),
    ],
)
def test_predicted_orders_follow_the_regularity(regularity, family, quantity, low):
    """A corner off Γ3 costs the pressure no half order."""
    assert predicted(Regularity(**regularity), family)[quantity].low == pytest.approx(low)


@pytest.mark.parametrize(
    ("kind", "traction", "violation"),
    [
        (Kind.CONTACT, (10.0, 0.0), 1.0),  # pulls
        (Kind.CONTACT, (0.0, 10.0), 1.0),  # along the foundation
        (Kind.CONTACT, (-10.0, 0.0), 0.0),  # presses
        (Kind.CLAMPED, (10.0, 10.0), 0.0),
        (Kind.LOADED, (-10.0, 0.0), 1.0),
    ],
)
def test_a_traction_that_no_admissible_stress_has_is_measured(kind, traction, violation):
    """All other tractions are at most 1."""
    space, loads, _, stress = stress_at(resolve("full-contact").solution, OneDiagonal(), 1)
    scale = abs(stress.tractions).max()
    edge = next(edges for _, edges in space.on(kind))[0]
    changed = stress.tractions / scale
    changed[space.edges == edge] = traction
    state = DualState(0.4, replace(stress, tractions=changed), np.empty(0), (1 / scale) * loads)
    assert inadmissible(space, state) == pytest.approx(violation, abs=0.11)


# P f_0 where f_0 jumps along fronts that move.


@pytest.mark.parametrize(
    ("family", "time", "count"),
    [(OneDiagonal(), 0.1, 4), (Shaken(seed=3), 0.28, 2), (Shaken(seed=3), 0.1, 4), (OneDiagonal(), 0.5, 2)],
)
def test_the_mean_of_f0_is_exact_on_cells_that_moving_fronts_cross(family, time, count):
    """By a rule of high degree on quarters of the thirds of cells, which is divided at the fronts."""
    solution = resolve("merging-patches").solution
    space = StressSpace(family(solution.body, 6), solution.body)
    data = Data.of(solution)
    thirds, _ = alfeld_split(space.mesh)
    fronts = [Line(*front) for front in solution.fronts(time)]
    assert len(fronts) == count
    integrals = np.zeros((2, 4 * 3 * space.cells))
    for rule in cell_rules(thirds.refined(), 12, fronts):
        integrals[:, rule.cells] = (solution.at(rule.points).body_force(time) * rule.weights).sum(axis=-1)
    expected = integrals.reshape(2, 4, -1).sum(axis=1)

    def error(data):
        means = ProjectedLoads(data, space, raised=10)(time).force.reshape(-1, 2).T
        return abs(means * cell_volumes(thirds) - expected).max() / abs(expected).max()

    assert error(data) < 1e-4
    assert error(replace(data, fronts=no_fronts)) > 100 * error(data)
