"""Every inequality of the checker, on problems of one or two cells where the exact value is known in closed form."""

import math
from contextlib import nullcontext
from fractions import Fraction as Q
from itertools import product

import numpy as np
import pytest
from measures import gauss
from places import CERTIFICATES
from scipy.linalg import eigh
from skfem import Basis, ElementTriP2, ElementVector, Functional, MeshTri

from study.bound.trajectory import spline
from study.certify import checker
from study.certify.checker import Enclosure, Loads, Mesh, Piece, Problem, RefusedError, Stresses
from study.fem.quadrature import bernstein

GRID = Q(1, 1 << checker.GRID)
ROWS = [["4", "1", "1/2"], ["1", "3", "1/4"], ["1/2", "1/4", "2"]]
UNIT = [["1", "0", "0"], ["0", "1", "0"], ["0", "0", "1"]]
TRIANGLE = [[0, 0], [1, 0], [0, 1]]
SLANTED = [[0, 0], [4, 0], [0, 3]]
QUADRANGLE = [[0, 0], [2, 0], [Q(3, 2), 1], [0, Q(3, 2)]]
MIXED = "clamped loaded contact clamped"


def load(*components):
    """Two components of a load without kinks, from monomials."""
    return [[[monomials, [], 0]] if monomials else [] for monomials in components]


PUSHED = {"1": load([["1", 0, 0, 0]], [])}


def posed(corners, kinds, h=1, loads=PUSHED, A=UNIT, **more):
    """A problem on a polygon, and its mesh: a fan of triangles from the first vertex, with points over h."""
    data = {"T": "1", "G": A, "force": [[], []], "start": [[], []]}
    vertices = [[str(c) for c in corner] for corner in corners]
    problem = Problem(data | {"vertices": vertices, "kinds": kinds.split(), "loads": loads, "A": A} | more)
    return problem, Mesh.of(mesh_of(corners, h), problem)


def mesh_of(corners, h):
    n = len(corners)
    return {
        "denominator": h,
        "points": [[int(Q(c) * h) for c in corner] for corner in corners],
        "cells": [[0, i, i + 1] for i in range(1, n - 1)],
        "sides": [[i, (i + 1) % n] for i in range(n)],
    }


@pytest.fixture(scope="module")
def element():
    return checker.Element.of(checker.load(CERTIFICATES / "square-4.json.gz")["element"])


# The problem


@pytest.mark.parametrize(
    "corners", [[[0, 0], [2, 0], [1, 0], [1, 1]], [[0, 0], [2, 0], [2, 2], [1, 0]], [[0, 0], [2, 0], [1, 0]]], ids=str
)
def test_polygons_that_touch_themselves_or_have_no_area_are_refused(corners):
    for n in range(len(corners)):
        with pytest.raises(RefusedError, match=r"two sides of the polygon meet|counter-clockwise"):
            posed([*corners[n:], *corners[:n]], " ".join(["clamped"] * len(corners)), loads={})


@pytest.mark.parametrize(("a", "b"), [(1, -1), (4, -3), (-4, 3), (-1, 1), (5, -3), (4, -2)])
def test_the_start_does_not_enter_a_slanted_foundation(a, b):
    """u_0 = x y (a, b) on a foundation with the normal (3, 4)."""
    enters = pytest.raises(RefusedError, match="u_0ν ≤ 0 on Γ3 cannot be shown") if 3 * a + 4 * b > 0 else nullcontext()
    with enters:
        posed(SLANTED, "clamped contact clamped", loads={}, start=[[[str(c), 1, 1]] for c in (a, b)])


@pytest.mark.parametrize("start", [[[["1", 1, 0]], []], [[], [["1", 0, 1]]], [[["1", 0, 0], ["-1", 1, 0]], []]])
def test_the_start_vanishes_on_every_wall_in_both_components(start):
    with pytest.raises(RefusedError, match="u_0 does not vanish on Γ1"):
        posed(SLANTED, "clamped loaded clamped", loads={}, start=start)


# Constants of the body

CORNER = 1 << 102
SCALE = 1 << 104
NEAR = int(checker.root(Q(2)) / 16 * SCALE)
"""The least integer above 2^104 √2/16."""
MU = Q(CORNER - NEAR, SCALE) - Q(CORNER, SCALE) ** 2


def constants(near, mu, kappa=Q(1, 16), kind="loaded"):
    """Φ with Φ_111 = Φ_222 from −CORNER at the origin to −near on the hypotenuse, others 0, over 2^104.

    −Φ(ν, v, v) = near/√2 |v|² on the hypotenuse, div Φ = CORNER − near, and A⁻¹(Φv)·(Φv) is at most CORNER².
    """
    field = [[-CORNER, 0, 0, -CORNER], [-near, 0, 0, -near], [-near, 0, 0, -near]]
    data = {"mesh": mesh_of(TRIANGLE, 1), "bits": 104, "field": field, "volume": str(mu), "surface": str(kappa)}
    problem, _ = posed(TRIANGLE, f"clamped {kind} clamped", loads=PUSHED if kind == "loaded" else {})
    return checker.load_constants(data, problem)


def test_constants_are_accepted_to_the_last_digit_and_refused_from_there_on():
    """√2 is rounded up: a load of κ √2 that Φ misses by less than 2^−104 is missed."""
    volume, surface = constants(NEAR, MU)
    assert volume**2 * MU > 1 > (volume - 2 * GRID) ** 2 * MU
    assert (surface - GRID) ** 2 / 16 <= 1 < surface**2 / 16
    with pytest.raises(RefusedError, match="constant of forces"):
        constants(NEAR, MU + Q(1, 2**200))
    with pytest.raises(RefusedError, match="constant of loads"):
        constants(NEAR - 1, MU)
    assert Q(NEAR - 1, SCALE) ** 2 < 2 * Q(1, 16) ** 2 < Q(NEAR, SCALE) ** 2


def test_on_the_foundation_a_field_must_not_pull_and_on_the_wall_nothing_is_required():
    mu = Q(1, 4) - Q(1, 16)
    volume, _ = constants(0, mu, Q(1), "contact")
    assert (volume - GRID) ** 2 * mu <= 1 < volume**2 * mu
    with pytest.raises(RefusedError, match="constant of loads"):
        constants(-1, mu, Q(1), "contact")


# Loads


def eigenvalues(field):
    """The largest μ and κ that a field proves on the quadrangle, by numpy from the tensor Φ_ijk itself."""
    points = np.array(QUADRANGLE, dtype=float)
    phi = np.array(field)[:, np.indices((2, 2, 2)).sum(axis=0)] / 64
    compliance = np.linalg.inv([[float(Q(x)) for x in row] for row in ROWS])
    inside = []
    for cell in ([0, 1, 2], [0, 2, 3]):
        slopes = np.linalg.inv(np.column_stack([np.ones(3), points[cell]]))[1:]  # ∂_i of the shape of vertex n
        divergence = np.einsum("in,nijk->jk", slopes, phi[cell])
        stresses = phi[cell][:, :, [0, 1, 0], [0, 1, 1]]
        squares = stresses @ compliance @ stresses.swapaxes(1, 2)
        inside.append(np.linalg.eigvalsh(divergence - squares).min())
    x, y = points[2] - points[1]
    outside = np.linalg.eigvalsh(-np.einsum("i,nijk->njk", [y, -x], phi[1:3]) / np.hypot(x, y))
    return min(inside), outside.min()


@pytest.mark.parametrize("seed", range(3))
def test_constants_of_tensor_fields_are_those_of_numpy(seed):
    rng = np.random.default_rng(seed)
    base = np.array([[-40 + 16 * x, 0, 0, -40 + 16 * y] for x, y in QUADRANGLE], dtype=float)
    field = np.round(base + rng.integers(-2, 3, (4, 4))).astype(int).tolist()
    largest = eigenvalues(field)
    assert min(largest) > 0.01
    problem, _ = posed(QUADRANGLE, MIXED, 2, A=ROWS)
    data = {"mesh": mesh_of(QUADRANGLE, 2), "bits": 6, "field": field}

    def proved(*beyond):
        volume, surface = (str(Q(x + off)) for x, off in zip(largest, beyond, strict=True))
        return checker.load_constants(data | {"volume": volume, "surface": surface}, problem)

    assert [float(x) for x in proved(-1e-9, -1e-9)] == pytest.approx([x**-0.5 for x in largest])
    for beyond, of in (((1e-9, -1e-9), "forces"), ((-1e-9, 1e-9), "loads")):
        with pytest.raises(RefusedError, match=f"constant of {of}"):
            proved(*beyond)


def loads_on(corners, h, bits, **more):
    return Loads(*posed(corners, " ".join(["clamped", "loaded", *["clamped"] * (len(corners) - 2)]), h, **more), bits)


def test_the_force_on_a_cell_is_rounded_to_the_nearest_integers():
    """The coefficients are those of twice the area times the force, over 2^bits."""
    loads = loads_on(QUADRANGLE, 4, 10, force=load([["1/3", 2, 0, 0]], [["1/5", 1, 1, 0]]))
    control = loads.controls(Q(0), Q(1))[0]
    for (cell, images), numbers in zip(loads.cells, loads.on_cells(control), strict=True):
        for d in (0, 1):
            exact = control[d](*images) * Q(cell.det << 10, 16)
            rest = [abs(exact.get(key, 0) - x) for key, x in zip(checker.SQUARE, numbers[d::2], strict=True)]
            assert max(rest) <= Q(1, 2)


K = Q(1, 2**12)
BEGIN = Q(1, 4)
END = Q(1, 4) + K


@pytest.mark.parametrize(
    ("force", "square"),
    [
        (load([["1", 0, 0, 3]], [["2", 0, 0, 3]]), 5 * K**6 / 840 / 2),
        (load([["1/4096", 3, 0, 0]], []), Q(1, 4096) ** 2 / 56),
        (load([], [["1", 0, 2, 0], ["1", 1, 1, 0], ["1/4096", 1, 2, 0]]), Q(1, 4096) ** 2 * Q(48, 40320)),
        # ∫ x⁴ y² = 4! 2!/8!, times the mean of t⁴.
        (load([["1", 2, 1, 2]], []), Q(48, 40320) * (END**5 - BEGIN**5) / (5 * K)),
    ],
    ids=str,
)
def test_what_a_force_has_beyond_is_missed(force, square):
    """Mean squares in closed form: (t − a)(t − m)(t − b) has k^6/840, X^i Y^j has (2i)!(2j)!/(2i + 2j + 2)!."""
    missed, rough = (loads_on(TRIANGLE, 1, bits, force=force).missed_inside(BEGIN, END) for bits in (300, 3))
    assert square <= missed**2 <= square * (1 + Q(1, 2**15))
    assert 0 <= rough - missed - Q(3, 8) < 2 * GRID  # six coefficients of both components are rounded to eighths


def test_lengths_are_rounded_down():
    """A load 1 and, across it, a traction t have the mean square (2 + t²)/√2 on a side of length √2."""
    t = 10**6
    missed = loads_on(TRIANGLE, 1, 100).missed_outside(Q(0), Q(1), [{(1, 2): [(0, t << 100)] * 4}] * 3)
    assert (2 + t * t) ** 2 <= missed**4 * 2 <= (2 + t * t) ** 2 * (1 + Q(1, 2**60))


def test_a_load_that_is_taken_up_is_not_missed_and_every_coefficient_counts():
    """f_2 = (t² x, y) on a side of length 5, from its Bernstein coefficients; then one of these is moved."""
    a = Q(1, 2)
    b = Q(1)
    h = 2
    bits = 10
    loads = loads_on(SLANTED, h, bits, loads={"1": load([["1", 1, 0, 2]], [["1", 0, 1, 0]])})
    unit = 5 * h << bits
    exact = np.array([[[unit * t * 4 * Q(3 - p, 3), Q(unit * p)] for p in range(4)] for t in (a * a, a * b, b * b)])

    def missed(tractions):
        return loads.missed_outside(a, b, [{(1, 2): one.tolist()} for one in tractions])

    assert missed(exact) ** 2 <= 3 * GRID  # squares are rounded up to the grid, in each component
    assert 0 < float(missed(exact.astype(int).astype(object))) < 5 / 2**bits
    for s, p, d in product(range(3), range(4), (0, 1)):
        moved = exact.copy()
        moved[s, p, d] += unit
        # ∫ B_s² = C(2, s)²/C(4, 2s)/5, ∫ B_p² = C(3, p)²/C(6, 2p)/7, times the length.
        square = 5 * Q(math.comb(2, s) ** 2, 5 * math.comb(4, 2 * s)) * Q(math.comb(3, p) ** 2, 7 * math.comb(6, 2 * p))
        assert square <= missed(moved) ** 2 <= square * (1 + Q(1, 2**80))


# Stresses


def stresses_on(corners, kinds, element, h, **more):
    return Stresses(posed(corners, kinds, h, **more)[1], {"bits": 1, "coarse": 2}, element)


def test_a_stress_that_pulls_on_the_foundation_in_one_coefficient_is_refused(element):
    stresses = stresses_on(TRIANGLE, "clamped contact clamped", element, 1, loads={})
    assert stresses.tractions([-2] * 4 + [0] * 16)[1] == [[-2] * 4]
    for place in range(4):
        numbers = [-2] * 4 + [0] * 16
        numbers[place] = 1  # the mean of the four is a pressure
        with pytest.raises(RefusedError, match="σ̃_ν > 0"):
            stresses.tractions(numbers)


def no_stress(stresses, force):
    zero = {e: [(0, 0)] * 4 for e in [*stresses.mesh.edges, *stresses.nothing]}
    return stresses.field(zero, [0] * 9 * len(stresses.mesh.cells), force)


def test_a_force_that_no_traction_balances_is_left(element):
    """Without tractions Div σ̃ is orthogonal to rigid motions, so that of f̃ = (6, −8) nothing is balanced."""
    stresses = stresses_on(QUADRANGLE, MIXED, element, 2)
    field, unbalanced = no_stress(stresses, [[3 * c.det, -4 * c.det, *[0] * 10] for c in stresses.mesh.cells])
    area = sum(Q(cell.det, 8) for cell in stresses.mesh.cells)
    assert 100 * area <= unbalanced**2 <= 100 * area * (1 + Q(1, 2**60))
    assert not any(any(one) for one in field)
    assert no_stress(stresses, []) == no_stress(stresses, [[0] * 12] * 2)


def test_the_losses_of_all_cells_are_made_up_for(element, monkeypatch):
    """Squares of 0.9 and 0.6 units of the grid, which are rounded down to 0 in both cells."""
    stresses = stresses_on(QUADRANGLE, MIXED, element, 1 << 20)
    cells = stresses.mesh.cells
    scale = Q(1 << 20, stresses.unit) ** 2
    square = int(Q(9, 10) * 12 * min(cell.det for cell in cells) ** 3 * GRID)
    monkeypatch.setattr(checker, "linear_square", lambda _: square)
    exact = sum(Q(2 * square, 24 * cell.det**3) for cell in cells) * scale
    assert exact > Q(3, 2) * GRID * scale
    assert no_stress(stresses, [[1, *[0] * 11]] * 2)[1] ** 2 >= exact


# Displacements


def test_u_h_has_the_size_of_its_mesh_and_vanishes_on_the_wall():
    problem, mesh = posed(TRIANGLE, "clamped contact loaded", loads={})
    for place in range(4):
        moved = [[0.0] * 6, [float(n == place) for n in range(6)]]
        with pytest.raises(RefusedError, match="does not vanish on Γ1"):
            checker.Computed(moved, mesh, 0, problem)
    with pytest.raises(RefusedError, match="another size"):
        checker.Computed([[0.0] * 5, [0.0] * 6], mesh, 0, problem)


def test_pieces_are_those_of_the_quadratic_spline_of_the_bound(rng):
    nodes = rng.integers(-99, 99, (5, 3))
    splines = spline(zip(np.linspace(0, 2, 5), nodes, strict=True))
    for piece, wanted in zip(checker.pieces(nodes.tolist(), Q(2)), splines, strict=True):
        assert piece.a == wanted.a
        assert piece.b == wanted.b
        assert np.array_equal(np.array(piece.values) / 4, [wanted.start, wanted.control, wanted.end])
        first, _, last = np.array(piece.steps) / 4 / float(piece.b - piece.a)
        assert np.array_equal([first, last], [wanted.rate(end=False), wanted.rate(end=True)])


@pytest.mark.parametrize("time", range(3))
def test_displacements_that_are_not_admissible_are_refused(time):
    """ũ on Γ1 (sides 0 and 3), and on Γ3 with the normal (1, 3), by each Bernstein coefficient."""
    certificate = object.__new__(checker.Certificate)
    mesh = certificate.mesh = posed(QUADRANGLE, MIXED, 2)[1]
    walls = {n for edge in ((0, 1), (3, 0)) for n in mesh.nodes_of(edge)}
    slide = set(mesh.nodes_of((2, 3))) - walls
    for n, (x, y) in product(range(mesh.nodes), product(range(-4, 5), (-1, 0, 1))):
        certificate.nodes = [[0] * 2 * mesh.nodes for _ in range(3)]
        certificate.nodes[time][2 * n : 2 * n + 2] = [x, y]
        if (n in walls and (x or y)) or (n in slide and x + 3 * y > 0):
            with pytest.raises(RefusedError, match=r"Γ1|Γ3" if n in walls else "ũ_ν > 0 on Γ3"):
                certificate._check_membership()
        else:
            certificate._check_membership()


# The growth of the bound


def exact_growth(A, G, m, y, k, M, contact, loads):
    """The least bounds of all θ and β, in floating point from eigenvalues."""
    beta = np.geomspace(1e-8, 1e8, 4001)[:, None]
    found = []
    for theta in (0.0, m):
        h, v = eigh(G - theta * A, A)
        weighted = np.einsum("ij,ik,kj->j", v, M, v) / (h + beta) ** 2
        decay = math.exp(-2 * theta * k)
        mean = (1 - decay) / (2 * theta) if theta else k
        taken = 2 * contact + (h * weighted).sum(axis=1) / 2
        second = np.sqrt(mean * (beta**2 * weighted).sum(axis=1)) + loads
        found.append([(np.sqrt(factor * y * y + taken) + second).min() for factor in (decay, 1)])
    return np.min(found, axis=0)


def fractions(matrix):
    return [list(map(Q, row)) for row in matrix.tolist()]


def growth(m):
    problem, _ = posed(TRIANGLE, "clamped loaded clamped", A=fractions(VISCOSITY), G=fractions(ELASTICITY))
    return checker.Growth(problem, m)


VISCOSITY = np.array([[2.5, 0.5, 0], [0.5, 2.5, 0], [0, 0, 1]])
ELASTICITY = np.array([[7.5, 1.5, 0], [1.5, 8.5, 0], [0, 0, 4.0]])
"""G − 3A is positive semidefinite, and no G − mA with m > 3."""


@pytest.mark.parametrize("grid", [3, 6, 30])
def test_bounds_are_no_less_than_the_best_ones_on_any_grid(grid, monkeypatch):
    """On coarse grids a sum, a root or a square that is rounded down would be seen."""
    monkeypatch.setattr(checker, "GRID", grid)
    rng = np.random.default_rng(grid)
    for _ in range(10):
        rho = rng.integers(-8, 9, (3, 2)) * 2.0 ** rng.integers(-4, 2)
        y, contact, loads = (rng.integers(0, 128, 3) / 64).tolist()
        k = float(rng.choice([0.125, 1.0, 4.0]))
        M = rho @ rho.T
        found = growth(Q(3, 2))(Q(y), Q(k), fractions(M), Q(contact), Q(loads))
        least = exact_growth(VISCOSITY, ELASTICITY, 1.5, y, k, M, contact, loads)
        found = np.array(found, dtype=float)
        assert (least * (1 - 1e-6) - 1e-12 <= found).all()
        assert grid < 30 or (found <= least * (1 + 1e-2) + 8 * 2.0**-15).all()


def test_damping_that_the_law_has_not_is_refused():
    for m, message in ((-GRID, "m is negative"), (3 + GRID, "not positive semidefinite")):
        with pytest.raises(RefusedError, match=message):
            growth(m)
    growth(Q(3))


# The whole


@pytest.fixture(scope="module")
def bracket():
    return checker.Certificate(checker.load(CERTIFICATES / "bracket-4.json.gz"))


def on_grid(grid, call):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(checker, "GRID", grid)
        return call()


def piece_of(certificate):
    return list(checker.pieces(certificate.nodes, certificate.problem.T))[3]


def test_the_largest_loss_by_rounding_is_made_up_for(bracket, monkeypatch):
    """Entries that all lose nearly 1 to the floor lose a matrix whose eigenvalue is 3 for each cell."""
    monkeypatch.setattr(checker, "GRID", 0)
    losses = iter([cell.det**5 - 1 for cell in bracket.mesh.cells])
    monkeypatch.setattr(checker, "congruent", lambda *_: [[next(losses)] * 3] * 3)
    monkeypatch.setattr(bracket, "_products", lambda _: None)
    rows = bracket._residual(piece_of(bracket), [[[0] * 90 for _ in bracket.mesh.cells]] * 3)
    unit = rows[0][0] / (3 * len(bracket.mesh.cells))
    assert unit > 0
    lost = sum(1 - Q(1, cell.det**5) for cell in bracket.mesh.cells) * unit
    assert checker.semidefinite([[rows[i][j] - lost for j in range(3)] for i in range(3)])


def energy(problem, mesh, coefficients, known=None):
    """∫ Aε·ε of a displacement of degree 2 by its Bernstein coefficients, less other strains ε_11, ε_22, 2ε_12."""
    plane = MeshTri(np.transpose(mesh.points) / mesh.h, np.transpose([cell.v for cell in mesh.cells]))
    assert plane.facets.T.tolist() == list(map(list, mesh.edges))
    basis = Basis(plane, ElementVector(ElementTriP2()))
    nodal = np.reshape(coefficients, (-1, 2)).astype(float)
    on_edges = nodal[len(mesh.points) :]
    on_edges += nodal[plane.facets].mean(axis=0)
    on_edges /= 2

    @Functional
    def density(w):
        (xx, xy), (yx, yy) = w.u.grad
        strain = np.array([xx, yy, xy + yx]) - (known(*w.x) if known else 0)
        return np.einsum("ij,icq,jcq->cq", np.array(problem.A, dtype=float), strain, strain)

    return density.assemble(basis, u=basis.interpolate(nodal.ravel()))


@pytest.mark.parametrize("name", ["bracket", "wedge", "bracket with few bits"])
def test_distances_are_integrals_rounded_outward(name):
    """‖v − u_h(t)‖²_V with v = ũ's control point, u_h(t) from the doubles in the file; the wedge refines its mesh."""
    data = checker.load(CERTIFICATES / f"{name.split()[0]}-4.json.gz")
    if "few" in name:
        data["computed"] = [[round(64 * x) / 64 for x in row] for row in data["computed"]]
    certificate = checker.Certificate(data)
    mesh = certificate.mesh
    piece = piece_of(certificate)
    n = len(data["computed"]) // 3
    time = Q(4 * n + 1, 4 * (len(data["computed"]) - 1))
    u = np.array([0.75, 0.25]) @ data["computed"][n : n + 2]
    coarse = Mesh.of(data["mesh"], certificate.problem)
    for one in [coarse, coarse.refined()][: data["refinements"] + 1]:
        nodal = u.reshape(-1, 2)
        u = np.vstack([nodal, nodal[one.edges].mean(axis=1)])
    w = np.array([x / (4 << certificate.bits) for x in piece.values[1]]).reshape(-1, 2) - u
    exact = energy(certificate.problem, mesh, w)
    (low, high), (floor, ceiling) = (
        on_grid(grid, lambda: certificate._distance(piece.values[1], 2, time * certificate.problem.T))
        for grid in (100, 0)
    )
    assert float(low) == pytest.approx(exact, rel=1e-9)
    assert floor <= low <= high <= low + Q(1, 2**80)
    assert high <= ceiling <= floor + 1


def test_the_distance_of_the_start_is_an_integral_rounded_up(monkeypatch):
    """u_0 = (x² y + 3 y, 2 x y − y²) and any ũ(0) on two cells."""
    certificate = object.__new__(checker.Certificate)
    problem, mesh = posed(QUADRANGLE, "loaded loaded clamped loaded", 2, loads={}, A=ROWS)
    problem.start = [checker.polynomial(p) for p in ([["1", 2, 1], ["3", 0, 1]], [["2", 1, 1], ["-1", 0, 2]])]
    certificate.problem = problem
    certificate.mesh = mesh
    certificate.bits = 4
    certificate.nodes = [[n * n % 13 for n in range(2 * mesh.nodes)]]

    def strain(x, y):
        return np.array([2 * x * y, 2 * x - 2 * y, x**2 + 3 + 2 * y])

    square = energy(problem, mesh, np.array(certificate.nodes[0]) / 16, strain)
    fine, coarse = (on_grid(grid, certificate._start) for grid in (100, 12))
    assert float(fine) ** 2 == pytest.approx(square, rel=1e-12)
    assert fine < coarse < fine + Q(1, 2**8)
    monkeypatch.setattr(checker, "root", lambda x: x)
    fine, coarse = (on_grid(grid, certificate._start) for grid in (100, 2))
    assert fine < coarse <= fine + Q(len(mesh.cells), 4)


def test_the_work_of_contact_is_the_integral_of_its_bernstein_polynomials_and_not_negative(rng):
    """∫∫ σ̃_ν ũ_ν on a slanted foundation, by Gauss's rule."""
    wedge = checker.Certificate(checker.load(CERTIFICATES / "wedge-4.json.gz"))
    edges = wedge.stresses.contact
    mesh = wedge.mesh
    x, y = mesh.along(edges[0])
    depths, slides = rng.integers(0, 2**20, (2, 3, mesh.nodes, 1))
    values = slides * [x, y] - depths * [y, -x]
    normals = -rng.integers(0, 2**30, (3, len(edges), 4))
    piece = Piece(Q(1, 4), Q(3, 4), values.reshape(3, -1).tolist())
    points, weights = gauss(6)
    squares, cubes = (bernstein(n, np.array([1 - points, points])) for n in (2, 3))
    nodes = np.array([mesh.nodes_of(edge) for edge in edges])
    outward = np.einsum("reqd,ed->req", values[:, nodes], [[b, -a] for a, b in map(mesh.along, edges)])
    factors = 1.0 * outward, normals, squares, squares, squares, cubes, weights, weights
    work = np.einsum("req,sep,rt,st,qx,px,t,x->", *factors, optimize=True)
    scale = (piece.b - piece.a) / (mesh.h << wedge.stresses.bits + wedge.bits + 2)
    assert float(wedge._contact(piece, normals.tolist()) / scale) == pytest.approx(work, rel=1e-12)
    with pytest.raises(RefusedError, match="work of contact is negative"):
        wedge._contact(piece, [[[1] * 4 for _ in edges]] * 3)


@pytest.mark.parametrize("name", ["f_0 that is not balanced", "f_0 that is not taken up", "f_2"])
def test_loads_that_are_missed_are_added_with_their_constant(name, certificate, monkeypatch):
    """The load t on a body of area 1 or a side of length 1 is added, which the stresses in the file do not balance."""
    one = checker.Certificate(certificate)
    problem = certificate["problem"]
    pieces = [(p.a, p.b) for p in checker.pieces(one.nodes, one.problem.T)]
    if name == "f_2":
        problem["loads"]["1"][0].append([[["1", 0, 0, 1]], [], 0])
        wanted = float(one.surface) * sum(float(b - a) * float((a * a + a * b + b * b) / 3) ** 0.5 for a, b in pieces)
    else:
        problem["force"][0].append([[["1", 0, 0, 1]], [], 0])
        wanted = float(one.volume) * float(one.problem.T**2) / 2
    other = checker.Certificate(certificate)
    found = []
    for each in (one, other):
        each.growth = lambda y, k, M, contact, loads: (y + loads, Q(0))  # type: ignore[assignment,method-assign]
        found.append(float(each.check().last))
    if name == "f_0 that is not taken up":
        monkeypatch.setattr(Loads, "missed_inside", lambda self, a, b: (a + b) / 2)
        found = [found[1], float(other.check().last)]
    assert found[1] - found[0] == pytest.approx(wanted, rel=1e-3)


def test_an_interval_is_a_distance_more_or_less_a_bound(made, monkeypatch):
    """The largest bound inside a piece decides from above, the one at its end from below; the start counts, too."""
    certificate = checker.Certificate(made)
    for name, value in (("growth", (Q(1), Q(2))), ("_residual", None), ("_contact", None)):
        monkeypatch.setattr(certificate, name, lambda *_, value=value: value)
    monkeypatch.setattr(certificate, "_distances", lambda _: [(Q(4), Q(9)), (Q(16), Q(49)), (Q(16), Q(25))])
    for start, high in ((1, 7 + 2), (144, 12 + float(certificate._start()))):
        monkeypatch.setattr(certificate, "_distance", lambda *_, start=start: (Q(0), Q(start)))
        found = certificate.check()
        assert found.low == 4 - 1
        assert found.last == 1
        assert float(found.high) == pytest.approx(high, rel=1e-14)


def test_a_bound_without_end_is_refused(made):
    certificate = checker.Certificate(made)
    certificate.growth = lambda *_: (Q(0), Q(10**100))  # type: ignore[assignment,method-assign]
    with pytest.raises(RefusedError, match="too large to be printed"):
        certificate.check()


# Orders


def proved(cells, low, high):
    return Enclosure(cells, Q(1), Q(low), Q(high), Q(0))


@pytest.mark.parametrize(
    ("coarse", "fine", "low", "high"),
    [
        (proved(8, 1, 1), proved(32, "1/2", "1/2"), 1, 1),
        (proved(8, 1, 2), proved(32, "1/4", "1/2"), 1, 3),
        (proved(8, "1/4", "1/2"), proved(32, 1, 2), -3, -1),
        (proved(1, 3, 3), proved(81, 1, 1), Q(1, 2), Q(1, 2)),
    ],
    ids=str,
)
def test_orders_are_enclosed(coarse, fine, low, high):
    found_low, found_high = checker.order(coarse, fine)
    assert low - Q(1, 2**55) < found_low <= low
    assert high <= found_high < high + Q(1, 2**55)


@pytest.mark.parametrize(("low", "fine_low"), [(0, 1), (1, 0)])
def test_no_order_is_proved_if_one_of_the_errors_may_be_zero(low, fine_low):
    assert checker.order(proved(8, low, 1), proved(32, fine_low, 1)) is None


def test_results_are_printed_outward_and_orders_from_coarse_to_fine_whatever_comes_first(capsys, monkeypatch):
    """h is counted on the meshes; of equal meshes, or if an error may be 0, there is no order."""
    last = Enclosure(128, Q(2, 3), Q(-1, 3), Q(2, 3), Q(0))
    results = iter([proved(32, "1/2", "1/2"), proved(8, 1, 1), proved(8, 0, 1), last])
    path = str(CERTIFICATES / "square-4.json.gz")
    monkeypatch.setattr(checker, "load", lambda path: {"problem": {"T": "1"}})
    monkeypatch.setattr(checker, "verified", lambda data: next(results))
    assert checker.main([path] * 4) == 0
    assert capsys.readouterr().out.splitlines()[6:] == [
        f"{path}:",
        "    128 cells, h = 0.6666: max ‖u − u_h‖_V in [-0.33333334, 0.66666667]",
        "no order from 8 to 8 cells: h is the same",
        "order from 8 to 32 cells in [0.9999, 1.0001]",
        "no order from 8 to 128 cells: an error may be 0",
        "no order from 8 to 32 cells: an error may be 0",
        "no order from 8 to 128 cells: an error may be 0",
        "no order from 32 to 128 cells: an error may be 0",
        "the problem:",
        '    T: "1"',
    ]
