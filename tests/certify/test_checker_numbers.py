"""Numbers and polynomials of the checker: every value is compared with a known one, every rounding with its direction.

A bound must be on the safe side of the exact value, and so near to it that a value rounded the other way would not be.
"""

import math
from decimal import Context, Decimal
from fractions import Fraction as Q
from itertools import pairwise, product

import pytest

from study.certify import checker
from study.certify.checker import ONE, Poly, RefusedError, S, Side, Term, X, Y

GRID = Q(1, 1 << checker.GRID)
DIGITS = Context(prec=80)


def decimal(x):
    """A fraction to 80 digits, far more than the grid."""
    return DIGITS.divide(Decimal(x.numerator), Decimal(x.denominator))


@pytest.mark.parametrize("x", [Q(1, 3), Q(7, 8)], ids=str)
def test_numbers_are_rounded_to_the_neighbours_on_the_grid(x):
    assert checker.down(x) == math.floor(x / GRID) * GRID
    assert checker.up(x) == math.ceil(x / GRID) * GRID


def test_a_root_lies_between_neighbours_on_the_grid_and_roots_of_squares_are_found():
    for x in (Q(0), Q(9, 4), Q(2), Q(1, 3), Q(10**40, 7), Q(1, 3**60), Q(1, 2**300)):
        low = checker.root(x, above=False)
        high = checker.root(x)
        assert low**2 <= x < high**2
        assert high - low == GRID
    with pytest.raises(RefusedError, match="a square is negative"):
        checker.root(Q(-1, 10**9))


@pytest.mark.parametrize("x", [Q(2, 3), Q(10**9, 7), Q(1, 10**6), 1 - Q(1, 2**70)], ids=str)
def test_a_logarithm_lies_in_a_narrow_interval(x):
    low, high = checker.logarithm(x)
    assert low <= Q(DIGITS.ln(decimal(x))) <= high
    assert high - low < Q(1, 2**60)


@pytest.mark.parametrize("x", [Q(3, 10), Q(20)], ids=str)
def test_decay_is_rounded_up(x):
    wanted = Q(DIGITS.exp(decimal(-x)))
    assert wanted <= checker.decay(x) <= wanted * (1 + Q(1, 10**12)) + GRID
    # The series has so many terms that e^{−100} is far away, on the safe side.
    assert checker.decay(Q(100)) > Q(DIGITS.exp(-100))


CLOSE = {Q(0): 0, Q(1, 10**6): 1e-25, Q(3, 10): 1e-25, Q(2): 1e-17, Q(8): 1e-2, Q(47, 2): 99, Q(24): 99}


@pytest.mark.parametrize("x", [*CLOSE, Q(10**9)], ids=str)
def test_the_mean_of_a_decay_is_rounded_up_and_at_most_1_and_1_over_x(x):
    wanted = (1 - Q(DIGITS.exp(decimal(-x)))) / x if x else Q(1)
    assert wanted <= checker.mean_decay(x) <= min(Q(1), 1 / x if x else Q(1)) + GRID
    assert checker.mean_decay(x) <= wanted * (1 + Q(CLOSE.get(x, 99))) + GRID


# Matrices

SEMIDEFINITE = [
    [[2, -1, -1], [-1, 2, -1], [-1, -1, 2]],
]
INDEFINITE = [
    [[0, 0], [0, -1]],
    [[1, 1 + GRID], [1 + GRID, 1]],
    [[2, 1], [0, 2]],
    [[5, -3, -3], [-3, 5, -3], [-3, -3, 5]],
]


@pytest.mark.parametrize("matrix", SEMIDEFINITE + INDEFINITE, ids=str)
def test_semidefinite_matrices_are_known(matrix):
    """Leading minors are not enough: those of [[0, 0], [0, −1]] are 0."""
    assert checker.semidefinite([[Q(x) for x in row] for row in matrix]) is (matrix in SEMIDEFINITE)


# Polynomials


def test_sums_products_images_and_slopes_of_polynomials_have_the_values_of_numbers():
    def value(p, x, y, s):
        return sum(c * x**i * y**j * s**k for (i, j, k), c in p.items())

    p = X * X * 3 - Y * S + ONE * 2
    q = X * Y - S * Q(1, 2)
    x, y, s = place = Q(2, 3), Q(-5, 7), Q(11, 13)
    a = 3 * x**2 - y * s + 2
    b = x * y - s / 2
    found = p, q, p + q, p - q, p * q, p.slope(0), (p * Y).slope(1), p(q), p(q, X), p(q, X, Y)
    numbers = [a, b, a + b, a - b, a * b, 6 * x, a - y * s]
    assert [value(r, *place) for r in found] == numbers + [value(p, b, *rest) for rest in ((y, s), (x, s), (x, y))]
    assert p - p == Poly()
    assert p.size() == 6


def test_means_and_integrals_are_those_of_monomials():
    for i, j, k in product(range(5), repeat=3):
        p = math.prod([X] * i + [Y] * j + [S] * k, start=ONE)
        over_s = Q(1 + (-1) ** k, 2 * (k + 1))
        assert j or checker.mean(p) == Q(1 + (-1) ** i, 2 * (i + 1)) * over_s
        assert checker.on_triangle(p) == Q(math.factorial(i) * math.factorial(j), math.factorial(i + j + 2)) * over_s


def test_bernstein_polynomials_are_those_of_textbooks():
    assert checker.bernstein(2, X) == [ONE - X * 2 + X * X, X * 2 - X * X * 2, X * X]
    # Modes are orthogonal, and have resultants and moments only where they may.
    modes = [checker.combination(checker.bernstein(3, checker.UNIT_X), mode) for mode in checker.MODES]
    assert all((checker.mean(modes[a] * modes[b]) == 0) == (a != b) for a, b in product(range(4), repeat=2))
    assert [checker.mean(p) for p in modes] == [1, 0, 0, 0]
    assert [checker.mean(p * X) != 0 for p in modes] == [False, True, False, False]


HALF = Q(1, 2)


@pytest.mark.parametrize(
    ("g", "q", "wanted"),
    [
        (ONE + X, 2, (ONE + X) * (ONE + X)),
        ((ONE + X) * -1, 2, Poly()),
        (X, 1, None),
        (X + ONE * (1 - GRID), 1, None),
        (ONE * 2 + X - S, 1, ONE * 2 + X - S),
        (X, 0, ONE),
    ],
    ids=str,
)
def test_a_kink_is_seen_where_its_sign_may_change(g, q, wanted):
    p = X * 3 + ONE
    assert Term(p, g, q).plain() == (None if wanted is None else p * wanted)


def test_the_size_of_a_term_is_its_supremum_for_these_and_its_degree_counts_the_power():
    sizes = [(X + ONE * HALF, 2, 4 * Q(9, 4)), (X - ONE * HALF, 2, 4 * Q(1, 4)), (X * S * 2 - ONE, 1, 4), (X, 0, 4)]
    for g, q, size in sizes:
        assert Term(X * 3 + ONE, g, q).size() == size
    terms = Term(X * Y, S * S + X, 3), Term(X * Y, Poly(), 0), Term(Poly(), Poly(), 0)
    assert [term.degree() for term in terms] == [8, 2, 0]


@pytest.mark.parametrize("scale", [Q(1), Q(1, 3 * 2**45)], ids=str)
def test_the_mean_square_of_a_kink_is_bounded(scale):
    """∫ of (X_+)² over |X| ≤ 1 has the mean 1/6; the boxes with the kink get fewer with each halving."""
    found = [checker.missed([Term(ONE * scale, X, 1)], n) for n in range(5)]
    assert found[0] == checker.up(scale**2)
    # The boxes from X = 0 on are exact: the kink lies on their ends.
    assert all(scale**2 / 6 <= bound <= scale**2 / 6 + 2 * GRID for bound in found[1:])
    kinked = [checker.missed([Term(ONE * scale, X + S, 1), Term(ONE * -scale, Poly(), 0)], n) for n in range(5)]
    wanted = scale**2 * Q(2, 3)  # of ((X + S)_+ − 1)²
    assert all(fine < coarse for coarse, fine in pairwise(kinked))
    assert kinked[0] == checker.up((3 * scale) ** 2)
    assert wanted <= kinked[4] < wanted * Q(3, 2)


def test_signs_on_a_segment_are_seen():
    for p in (Poly(), ONE * -1, X - ONE, X * -1, X * X - X):
        assert checker.never_positive(p)
    for p in (ONE, X, X - ONE * (1 - GRID), X * -1 + ONE * GRID, X * X * -4 + X * 4 - ONE * Q(99, 100)):
        assert not checker.never_positive(p)


APART = [
    ((0, 0, 1, 0), (2, 0, 3, 0)),
    ((0, 0, 1, 0), (HALF, GRID, 1, 1)),
    ((0, 0, 4, 4), (0, 3, 1, 2)),
]
TOUCHING = [
    ((0, 0, 1, 0), (HALF, 0, 1, 1)),
]


@pytest.mark.parametrize("segments", APART + TOUCHING, ids=str)
def test_segments_that_touch_are_not_apart(segments):
    one, other = (Side((Q(a), Q(b)), (Q(c), Q(d)), "loaded", []) for a, b, c, d in segments)
    assert one.is_apart(other) is other.is_apart(one) is (segments in APART)
    assert one.normal == (one.end[1] - one.start[1], one.start[0] - one.end[0])
