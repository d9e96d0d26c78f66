"""The hypotheses on the material law: (3.1) on the viscosity A, (3.2) on the elasticity G, and the example (3.3).

The law (3.3), G(ε) = β (ε − P_K ε), satisfies (3.2). The paper requires the hypotheses almost everywhere in Ω. Each law
of the catalogue is tested at the vertices and at the centres of the cells of a mesh.

* (3.1): a law computes its constants m_A and ‖A‖ from the eigenvalues of its matrix. The test uses only values Aτ: the
  quotients Aτ·τ/|τ|² must lie between both constants, and the power method for A and for 2‖A‖ − A must come near them.
  A is symmetric by construction, because a law refuses other matrices.
* (3.2): the quotients |G(a) − G(b)|/|a − b| must be at most L_G. Some of the pairs a, b differ along eigenvectors of
  the derivative of G with extreme eigenvalues (``AtPoints.derivative``). They show whether L_G is the best constant.
"""

import math
from collections.abc import Callable

import numpy as np

from manufactured.law import AtPoints, Yield
from manufactured.tensors import Array, Points, Tensors, size
from study.fem.naming import resolve
from study.fem.space import Space
from study.ledger.criterion import BOUND, ROUNDING, SHARP, Observation, largest
from study.ledger.window import at_most
from study.statements.shared.base import SEED, ListedNumbers, Setting, with_h
from study.statements.shared.meshes import place, representing, space_of
from study.statements.shared.scope import REGULAR

SCALES = (-3.0, 3.0)
"""Smallest and largest decimal logarithm of the norms of random tensors.

The norms lie on both sides of the yield point of every law."""
POWER = 100
"""Number of steps of the power method.

If eigenvalues of 2‖A‖ − A differ by 5 %, the smaller one contributes at most 0.95^{2·100} = 4e-5 after these steps."""
SKEW = "|Aσ·τ − σ·Aτ| / (|A| |σ| |τ|)"
ZERO = at_most(1e-12, "0 up to rounding")
MONOTONICITY = "G is less monotone than its constant m states by (m − (G(a) − G(b))·(a − b) / |a − b|²) / L_G"
MONOTONE = at_most(ROUNDING, "not positive, up to rounding; m < 0 if the law softens", low=-math.inf)


def points(space: Space) -> Points:
    """Return the points at which laws are tested: the vertices and the centres of the cells, (d, n)."""
    return np.hstack([space.mesh.p, space.mesh.p[:, space.mesh.t].mean(axis=1)])


def tensors(rng: np.random.Generator, dim: int, count: int) -> Tensors:
    """Return random tensors with D components, whose norms differ by several orders of magnitude, (D, count)."""
    directions = rng.standard_normal((size(dim), count))
    return directions / np.linalg.norm(directions, axis=0) * 10 ** rng.uniform(*SCALES, count)


def derivative(operator: AtPoints, strain: Tensors) -> Array:
    """Return the derivative of an operator at n strain tensors, as one D × D matrix for each tensor, (n, D, D).

    Args:
        operator: the operator.
        strain: the strain tensors, with D components each, (D, n).
    """
    units = np.eye(len(strain))
    columns = [operator.derivative(strain, np.broadcast_to(unit[:, None], strain.shape)) for unit in units]
    return np.moveaxis(np.stack(columns, axis=1), 2, 0)


class OfLaws(ListedNumbers):
    """Base class of statements about material laws; every law of the catalogue is tested on one mesh."""

    def places(self, full: bool) -> list[Setting]:
        return place(representing("law"), REGULAR, (16,) if full else (8,), (4,) if full else (2,))


class Viscosity(OfLaws):
    """Measures whether the viscosity A is symmetric and elliptic with the constants that the law states.

    The extreme values of Aτ·τ/|τ|² are searched with random tensors τ and by the power method.
    """

    label = "(3.1)"
    claim = "A is symmetric, bounded and elliptic with the constant m_A"
    rules = (
        largest("ellipticity", "m_A / smallest Aτ·τ/|τ|²", SHARP, "ellipticity"),
        largest("bound", "largest Aτ·τ/|τ|² / ‖A‖", SHARP, "bound"),
        Observation(largest("symmetry", SKEW, ZERO, "asymmetry"), "every law is symmetric by construction"),
    )

    def measure(self, setting: Setting) -> dict[str, float]:
        space, A = space_of(setting), resolve(setting.case).solution.law.A
        x, rng = points(space), np.random.default_rng(SEED)
        at_points, count = A.at(x), x.shape[1]

        def power_method(operator: Callable[[Tensors], Tensors]) -> Array:
            """Return the quotients Aτ·τ/|τ|² at the iterates τ of the power method, (POWER, points)."""
            tensor, found = tensors(rng, space.dim, count), []
            for _ in range(POWER):
                tensor = tensor / np.linalg.norm(tensor, axis=0)
                found.append(np.sum(at_points(tensor) * tensor, axis=0))
                tensor = operator(tensor)
            return np.array(found)

        up = power_method(at_points)
        top = up.max(axis=0)
        down = power_method(lambda tensor: 2 * top * tensor - at_points(tensor))
        low, high = np.min([up, down]), np.max([up, down])
        a, b = (tensor / np.linalg.norm(tensor, axis=0) for tensor in (tensors(rng, space.dim, count) for _ in "ab"))
        skew = abs(np.sum(at_points(a) * b - at_points(b) * a, axis=0)).max()
        # A negative ratio would pass as small, although A is not elliptic if its smallest quotient is not positive.
        ratio = A.ellipticity / low if low > 0 else math.inf
        found = {"smallest": low, "largest": high, "asymmetry": skew / top.max()}
        return with_h(space.h, {**found, "ellipticity": ratio, "bound": high / A.lipschitz})


NEAREST = "P_K a is the point of K nearest to a: cosine of the angle between a − P_K a and k − P_K a, k ∈ K"
NEAR = 1e-4
"""Relative distance |a − b|/|a| of the pairs of tensors whose difference quotients approximate the derivative of G."""


class ElasticityOperator(OfLaws):
    """Measures whether the elasticity G has the Lipschitz and monotonicity constants that the law states.

    The quotients |G(a) − G(b)| / |a − b| and (G(a) − G(b))·(a − b) / |a − b|² are computed for random tensors a and b.

    (3.2) requires G(·, 0) ∈ Q. This holds if G(·, 0) equals the stress at zero strain that the law states.
    """

    label = "(3.2)"
    claim = "|G(x, a) − G(x, b)| ≤ L_G |a − b|, G(·, 0) ∈ Q"
    rules = (
        largest("lipschitz", "elasticity G: |G(a) − G(b)| / (L_G |a − b|) for strains a, b", SHARP, "quotient"),
        largest("monotonicity", MONOTONICITY, MONOTONE, "monotonicity"),
        largest("at-zero", "elasticity G: |G(x, 0) − stated stress at zero strain| / L_G", ZERO, "at zero"),
    )

    def measure(self, setting: Setting) -> dict[str, float]:
        space, G = space_of(setting), resolve(setting.case).solution.law.G
        x = points(space)
        operator, rng, slopes, products = G.at(x), np.random.default_rng(SEED), [], []
        a, distant, direction = (tensors(rng, space.dim, x.shape[1]) for _ in range(3))
        matrices = derivative(operator, a)
        _, vectors = np.linalg.eigh((matrices + matrices.swapaxes(1, 2)) / 2)
        # The quotients of near pairs are extreme along eigenvectors of the extreme eigenvalues of the derivative.
        directions = direction, vectors[:, :, -1].T, vectors[:, :, 0].T
        steps = [NEAR * np.linalg.norm(a, axis=0) * d / np.linalg.norm(d, axis=0) for d in directions]
        for b in (distant, *(a + step for step in steps)):
            change, difference = operator(a) - operator(b), a - b
            square = np.sum(difference**2, axis=0)
            slopes.append(np.linalg.norm(change, axis=0) / np.sqrt(square))
            products.append(np.sum(change * difference, axis=0) / square)
        zero = abs(operator(np.zeros((size(space.dim), x.shape[1]))) - G.at_rest[:, None]).max()
        found = {"quotient": np.max(slopes), "monotonicity": G.monotonicity - np.min(products), "at zero": zero}
        return with_h(space.h, {name: value / G.lipschitz for name, value in found.items()})


class Projection(OfLaws):
    """Measures whether P_K ε = ε − G(ε)/β is the projection on the convex set K.

    P_K ε must lie in K and be the point of K nearest to ε, and P_K must not increase distances.
    """

    label = "(3.3)"
    claim = "G(ε) = β (ε − P_K ε) with the projection P_K on a closed convex K ∋ 0"
    rules = (
        largest("expansion", "projection P_K increases no distance: |P_K a − P_K b| / |a − b|", BOUND, "expansion"),
        largest("membership", "P_K a lies in K = {τ : |Pτ| ≤ r}: |P P_K a| / r", BOUND, "membership"),
        largest("nearest", NEAREST, ZERO, "nearest"),
        largest("identity", "P_K leaves strains k ∈ K unchanged: |P_K k − k| / |k|", ZERO, "identity"),
    )

    def places(self, full: bool) -> list[Setting]:
        return [place for place in super().places(full) if isinstance(resolve(place.case).solution.law.G, Yield)]

    def measure(self, setting: Setting) -> dict[str, float]:
        space, G = space_of(setting), resolve(setting.case).solution.law.G
        assert isinstance(G, Yield)
        return with_h(space.h, projection(G, points(space).shape[1]))


def projection(G: Yield, count: int) -> dict[str, float]:
    """Return for each property of a projection its largest violation over random tensors.

    Args:
        G: the elasticity operator of the law (3.3).
        count: number of random tensors of each kind.
    """
    rng = np.random.default_rng(SEED)
    a = np.hstack([tensors(rng, G.dim, count), G.convex.radius * tensors(rng, G.dim, count)])
    b, k = rng.permutation(a, axis=1), rng.permutation(a, axis=1)
    # Random tensors k are scaled into K so that many of them lie on its boundary, where equality may hold.
    k = k / np.maximum(gauge(G, k), 1.0) * np.minimum(rng.uniform(0, 2, k.shape[1]), 1.0)
    nearest_a, nearest_b, nearest_k = (strain - G(strain) / G.beta for strain in (a, b, k))
    distance, outward, along = np.linalg.norm(a - b, axis=0), a - nearest_a, k - nearest_a
    moved, sizes = distance > 0, np.linalg.norm(outward, axis=0) * np.linalg.norm(along, axis=0)
    return {
        "expansion": (np.linalg.norm(nearest_a - nearest_b, axis=0)[moved] / distance[moved]).max(),
        "membership": gauge(G, nearest_a).max(),
        "nearest": (np.sum(outward * along, axis=0) / np.maximum(sizes, np.finfo(float).tiny)).max(),
        "identity": (np.linalg.norm(nearest_k - k, axis=0) / np.linalg.norm(k, axis=0)).max(),
    }


def gauge(G: Yield, strain: Tensors) -> Array:
    """Return the gauge function |Pτ|/r of the set K at n strain tensors τ, (n,).

    The set is K = {τ : |Pτ| ≤ r} with a linear projector P and a radius r. So τ lies in K if and only if the gauge
    function is at most 1.
    """
    return np.linalg.norm(G.convex.projector @ strain, axis=0) / G.convex.radius
