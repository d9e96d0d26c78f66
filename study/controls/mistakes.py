"""Mistakes in how statements are measured: each takes what is right and gives what stands in its place."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np
import scipy.sparse as sps

from manufactured.body import Kind
from manufactured.law import Yield
from manufactured.tensors import Array, Points, Tensors
from study.fem.mesh import Unstructured
from study.fem.space import Space
from study.solve.signorini import Signorini
from study.solve.tableau import BACKWARD_EULER, Tableau
from study.statements.shared.base import Setting
from study.statements.shared.eigen import mass

Function = Callable[..., Any]


def times(factor: float) -> Callable[[Function], Function]:
    """A result that is wrong by a factor."""
    return partial(_times, factor)


def _times(factor: float, right: Function) -> Function:
    return lambda *given, **options: factor * right(*given, **options)


def by_backward_euler(right: Tableau) -> Tableau:
    """Another scheme, of the first order."""
    return BACKWARD_EULER


def times_width(right: Function) -> Function:
    """A method of what has a space, wrong by the extent of its mesh along the first axis."""
    return lambda self, *given: float(np.ptp(self.space.mesh.p[0])) * right(self, *given)


def squared(right: Function) -> Function:
    """A norm whose root was forgotten."""
    return lambda *given, **options: right(*given, **options) ** 2


def squared_each(right: Function) -> Function:
    """Norms whose roots were forgotten."""
    return lambda *given: {name: error**2 for name, error in right(*given).items()}


def interpolant_late(sample: Function) -> Function:
    """Π^h u of an earlier time."""
    return lambda gauge, time: replace(sample(gauge, time), interpolant=sample(gauge, 0.9 * time).interpolant)


def over_vertices(h1_product: Function) -> Function:
    """Σ v·w over the vertices in place of (v, w)_H, with no measure of what belongs to a vertex."""
    return lambda space: sps.csc_array(h1_product(space) - mass(space) + sps.eye_array(space.dofs))


# Spaces.


def pinned(right: Callable[[Setting], Space]) -> Callable[[Setting], Space]:
    """Γ1 shrunk to two of its points."""
    return _other_space(right, Pinned)


def outward(right: Callable[[Setting], Space]) -> Callable[[Setting], Space]:
    """The normals of Γ3 point inwards."""
    return _other_space(right, Inward)


def one_more(right: Callable[[Setting], Space]) -> Callable[[Setting], Space]:
    """The constraint of another vertex, inside the body, in place of the last one of Γ3."""
    return _other_space(right, Elsewhere)


def _other_space(right: Callable[[Setting], Space], kind: type[Space]) -> Callable[[Setting], Space]:
    def space_of(setting: Setting) -> Space:
        space = right(setting)
        return kind(space.mesh, space.body)

    return space_of


class Pinned(Space):
    """V^h whose functions vanish in two vertices."""

    @property
    def free(self) -> Array:  # type: ignore[override]
        ends = [part for kind in (Kind.CLAMPED,) for part in self.body.of(kind)]
        corners = np.array([end for part in ends for end in part.corners.T[:2]])
        fixed = [int(np.linalg.norm(self.mesh.p - corner[:, None], axis=0).argmin()) for corner in corners[:2]]
        return np.flatnonzero(np.repeat(~np.isin(np.arange(self.mesh.p.shape[1]), fixed), self.dim))


class Inward(Space):
    """K^h of the other side."""

    @property
    def N(self) -> sps.csr_array:  # type: ignore[override]
        return -Space.N.func(self)  # type: ignore[attr-defined]


class Elsewhere(Space):
    """K^h with a constraint off Γ3."""

    @property
    def N(self) -> sps.csr_array:  # type: ignore[override]
        right = Space.N.func(self)  # type: ignore[attr-defined]
        inside = np.flatnonzero((abs(self.mesh.p - self.mesh.p.mean(axis=1)[:, None]) < 0.2).all(axis=0))[0]
        row = sps.csr_array(([1.0], ([0], [2 * inside + 1])), shape=(1, 2 * self.mesh.p.shape[1]))[:, self.free]
        return sps.csr_array(sps.vstack([right[:-1], row]))


# Laws.


@dataclass(frozen=True)
class OtherLaw:
    """A case whose law does something else than it says.

    Attributes:
        tensor: "A" or "G".
        change: strains ↦ what the operator makes of them, from what it should.
    """

    tensor: str
    change: Callable[[Function], Function]

    def __call__(self, resolve: Callable[[str], Any]) -> Callable[[str], Any]:
        def resolved(name: str) -> Any:
            law = resolve(name).solution.law
            parts = {"A": law.A, "G": law.G, self.tensor: Misstated(getattr(law, self.tensor), self.change)}
            return SimpleNamespace(solution=SimpleNamespace(law=SimpleNamespace(**parts)))

        return resolved


class Misstated:
    """An operator with the constants of another one."""

    def __init__(self, right: Any, change: Callable[[Function], Function]) -> None:
        self.right, self.change = right, change

    def __getattr__(self, name: str) -> Any:
        return getattr(self.right, name)

    def at(self, x: Points) -> Misstated:
        return Misstated(self.right.at(x), self.change)

    def __call__(self, strain: Tensors) -> Tensors:
        found: Tensors = self.change(self.right)(strain)
        return found

    def derivative(self, strain: Tensors, along: Tensors) -> Tensors:
        found: Tensors = self.right.derivative(strain, along)
        return found


def engineering(right: Function) -> Function:
    """Half of the shear where Mandel's vectors have √½ of its double."""

    def operator(strain: Tensors) -> Tensors:
        shear = np.ones((len(strain), *[1] * (strain.ndim - 1)))
        shear[-1] = math.sqrt(0.5)
        found: Tensors = shear * right(shear * strain)
        return found

    return operator


def prestressed(right: Function) -> Function:
    """G(ε) + 1."""
    return lambda strain: right(strain) + 1


def returning(radius: float = 1.0, share: float = 1.0) -> Callable[[Function], Function]:
    """A law (3.3) for a set of another size, or whose return to K stops before it or goes beyond."""
    return partial(_returning, radius, share)


def _returning(radius: float, share: float, projection: Function) -> Function:
    kind = type("Other", (Returning,), {"radius": radius, "share": share})
    return lambda G, count: projection(kind(G.beta, G.convex), count)


class Returning(Yield):
    """ε ↦ share · β (ε − P_r ε) for another radius r than that of K."""

    radius, share = 1.0, 1.0

    def __call__(self, strain: Tensors) -> Tensors:
        ball: Any = self.convex
        inner = Yield(self.beta, replace(ball, radius=self.radius * ball.radius))
        return self.share * inner(strain)


# Terms.


def without_surface_load(work_on: Function) -> Function:
    """(f_2, v)_{L²(Γ2)} left out."""
    return lambda kind, *given: (0.0 if kind is Kind.LOADED else 1.0) * work_on(kind, *given)


def without(*names: str) -> Callable[[Function], Function]:
    """Terms of R left out."""
    return partial(_without, names)


def _without(names: tuple[str, ...], terms: Function) -> Function:
    def found(*given: Any) -> Any:
        right = terms(*given)
        return replace(right, **{name: 0 * getattr(right, name) for name in names})

    return found


def rate_left_out(on_cells: Function) -> Function:
    """G ε(u^h) in place of A ε(u̇^h) + G ε(u^h)."""

    def found(space: Space, law: Any) -> Any:
        right = on_cells(space, law)
        return SimpleNamespace(stress=lambda rate, strain: right.stress(0 * rate, strain))

    return found


def at_the_end_of_the_step(stresses: Function) -> Function:
    """σ^h compared with σ half a step later."""

    def found(setup: Any) -> Iterator[tuple[float, Tensors]]:
        k = setup.problem.T / setup.steps
        return ((time + k / 2, stress) for time, stress in stresses(setup))

    return found


class OneSearch(Signorini):
    """The contact solve from a random active set, which stops after the first step."""

    def __init__(self, S: sps.csc_array, N: sps.csr_array, x: Points | None = None) -> None:
        super().__init__(S, N, x)
        self.rng = np.random.default_rng(0)

    def complementarity(self, gap: Array) -> Array:
        return self.multipliers_on((gap > 0) | (self.rng.uniform(size=len(gap)) < 0.5), gap)


def opposite_work(compare: Function) -> Function:
    """(B(u + d) − B(u), −d)_V, not over ‖d‖_V²."""

    def found(operator: Any, base: Array, step: Array) -> tuple[float, float, Array]:
        quotient, product, image = compare(operator, base, step)
        return quotient, -product * float(step @ (operator.problem.M @ step)), image

    return found


def moved(over_time: Function) -> Function:
    """u + (1, 1)/10⁶ in place of u, which is not 0 on Γ1."""
    return _with_displacement(over_time, lambda u: u + 1e-6)


def mirrored(over_time: Function) -> Function:
    """−u in place of u, which penetrates where a gap is open."""
    return _with_displacement(over_time, lambda u: -u)


def _with_displacement(over_time: Function, change: Callable[[Array], Array]) -> Function:
    def found(trace: Any, solution: Any) -> Any:
        def at(x: Points) -> Any:
            right = solution.at(x)
            return SimpleNamespace(displacement=lambda time: change(right.displacement(time)))

        return over_time(trace, SimpleNamespace(body=solution.body, at=at))

    return found


def cut_off(projected: Function) -> Function:
    """v_ν set to 0 at the vertices of Γ3 where it is positive, the nearest in nodal values and not in ‖·‖_V."""

    def found(problem: Any, u: Array) -> Array:
        N = problem.N
        return u - N.T @ np.linalg.solve((N @ N.T).toarray(), np.maximum(N @ u, 0.0))

    return found


def first_given(right: Function) -> Function:
    """What is given, in place of what is made of it."""
    return lambda *given: given[0]


def pulled(in_graph: Function) -> Function:
    """Forces that pull the body to the foundation."""

    def found(*given: Any) -> tuple[Array, Array]:
        u, force = in_graph(*given)
        return u, -force

    return found


def one_image(fixed_point: Function) -> Function:
    """An iteration that stops at once."""
    return lambda image, v, *how: (image(v), 1)


class NoRepresenter:
    """F itself in place of M⁻¹F."""

    def __init__(self, M: sps.csc_array) -> None:
        pass

    def __call__(self, F: Array) -> Array:
        return F


def unweighted(facet_rule: Function) -> Function:
    """Sums over points of quadrature with no measure of what belongs to them."""

    def found(*given: Any) -> Any:
        rule = facet_rule(*given)
        return replace(rule, weights=1 + 0 * rule.weights)

    return found


def law_alone(pair: Any) -> Any:
    """σ^h = Cε(u^h), which balances nothing."""

    class Following(pair):  # type: ignore[misc]
        def __init__(self, *given: Any) -> None:
            super().__init__(*given)
            self.bound = self.distance = 0.0

    return Following


def random_only(quotients: Function) -> Function:
    """The first pairs alone, which are random: nothing is looked for."""

    def found(space: Space, operator: Any) -> Iterator[tuple[float, float]]:
        for n, pair in enumerate(quotients(space, operator)):
            if n < 10:
                yield pair

    return found


def halved_first(pointwise: Function) -> Function:
    """½ κ for κ."""

    def found(*given: Any) -> tuple[float, float]:
        kappa, waves = pointwise(*given)
        return kappa / 2, waves

    return found


def rival_is_the_run(name: str) -> Callable[[Any], Any]:
    """Return the replacement of ``rivals`` in which the problem itself stands for one of its rivals."""
    return partial(_make_rivals, name)


def _make_rivals(name: str, rivals: Any) -> Any:
    return partial(_rivals_with_the_run, name, rivals)


def _rivals_with_the_run(name: str, rivals: Any, problem: Any) -> Any:
    return {**rivals(problem), name: problem}


def rival(name: str, solver: type[Signorini]) -> Callable[[Any], Any]:
    """Another solver in the place of one of the rivals."""
    return partial(_rival, name, solver)


def _rival(name: str, solver: type[Signorini], rivals: Any) -> Any:
    return {**rivals, name: solver}


def column_times(column: str, factor: float) -> Callable[[Function], Function]:
    """One number of a row is wrong by a factor."""
    return partial(_column_times, column, factor)


def _column_times(column: str, factor: float, row: Function) -> Function:
    def tampered(*given: Any) -> dict[str, Any]:
        found = row(*given)
        return {**found, column: factor * found[column]}

    return tampered


def ungraded(graded: Function) -> Function:
    """Meshes that are as fine everywhere as elsewhere."""
    return lambda family, body, n: Unstructured()(body, n)


def times_h(power: int) -> Callable[[Function], Function]:
    """Errors times a power of h."""
    return partial(_times_h, power)


def _times_h(power: int, right: Function) -> Function:
    return lambda solution, space, face: {n: e * space.h**power for n, e in right(solution, space, face).items()}


def as_many_steps(steps: Function) -> Function:
    """32 steps on every mesh."""
    return lambda statement, setting: 32
