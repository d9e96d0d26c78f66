"""(5.13), (5.40), (5.41): the residual R equals the work of the contact force, which has an explicit bound.

The definition of R is, by (5.13) with (3.12) and (3.7),

    R(t; v) = (σ(t), ε(v))_Q − (f_0(t), v)_H − (f_2(t), v)_{L²(Γ2)},   v ∈ V,

which does not contain σ_ν on Γ3. Prop. 5.4 uses R(t; v) = ∫_{Γ3} σ_ν v_ν, (5.40), and the bound of this integral by the
Cauchy–Schwarz inequality, (5.41). Here R is computed from its definition, so both statements can fail. They are
measured, at the same times as in ``green``, for two kinds of v:

* smooth fields v that vanish only on Γ1. They are not in V^h, and v_ν has any sign on Γ3;
* v = Π^h u − u, which (5.42) needs. All terms are small, and R is much smaller than each of them.

The defect |R(t; v) − ∫_{Γ3} σ_ν v_ν| is relative to the smallest non-zero term of both sides. For v = Π^h u − u it is
relative to the smallest term of the definition, because σ_ν v_ν is nearly zero. So a missing term gives at least 1, and
a wrong sign at least 2. The remaining defect is the quadrature error of the fine rules, so the windows are the same
as in ``green``: round-off if f_0 is smooth except on lines along which cells are cut, a tenth if f_0 jumps along
curves. For v = Π^h u − u round-off is larger by 1/h, because (σ, ε(v))_Q = O(h²) is a sum of terms O(h).

The quotient of |R| and its bound is 0/0 if σ_ν = 0, so only times with σ_ν ≠ 0 are used. A case without contact at any
time has no check of (5.41), which is then 0 ≤ 0. The check is undecided if a case with contact has no contact at these
times.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

# ``from study.statements import green`` would make results depend on all statements (``study.run.fingerprint``).
import study.statements.green as green
from manufactured.body import Kind, Part
from manufactured.catalogue import catalogue
from manufactured.exact import ExactSolution
from manufactured.tensors import Array, Tensors, Vectors
from study.fem.error_norm import rules
from study.fem.mesh import barycentric
from study.fem.naming import resolve
from study.fem.quadrature import CellRule, FacetRule, facet_rule
from study.fem.space import Space
from study.ledger.criterion import Criterion, Groups, Rule, finest, greatest
from study.ledger.window import positive_at_most
from study.statements.boundary import planes, strain, vanishing, waves
from study.statements.shared.base import SEED, ListedNumbers, Setting, with_h
from study.statements.shared.meshes import IRREGULAR, named, place, space_of
from study.statements.shared.norms import maximum, midpoints
from study.statements.shared.scope import REGULAR

FIELDS = 3
"""Number of smooth test fields v."""
POINTS = 20
"""Number of Gauss points on a facet, exact up to degree 39.

A pressure p ~ (c − s)_+² on a facet whose points are graded towards c gives a polynomial of degree 31."""
INSTANTS = 64
"""Number of times at which a solution is examined for contact."""
CANCELLING = positive_at_most(1e-8, "with the fine quadrature rule: 1/h times 1e-10 for a smooth f_0")
BOUND = positive_at_most(1 + 1e-9, "by the Cauchy–Schwarz inequality")


class Residual(ListedNumbers):
    """Compares the residual R from its definition with the work of the contact force and with its bound.

    Only cases whose body force is square integrable, f_0(t) ∈ H, are measured.
    """

    label = "(5.40), (5.41)"
    claim = "R(t; v) = ∫_{Γ3} σ_ν v_ν for v ∈ V; then |R(t; v)| ≤ ‖σ_ν‖ ‖v_ν‖ by the Cauchy–Schwarz inequality"

    def places(self, full: bool) -> list[Setting]:
        if full:
            cases = [case for case in catalogue() if green.square_integrable(case)]
            # In 3D regular meshes are used, because the defect depends on where a front cuts cells; on random meshes of
            # twelve cells it varies by a factor of three.
            return place(cases, IRREGULAR, (8, 16)) + place(cases, REGULAR, (), (8, 15))
        return place(named("full-contact", "fixed-front-off-vertex", "yield-and-release"), IRREGULAR, (8,))

    def measure(self, setting: Setting) -> dict[str, float]:
        space, case = space_of(setting), resolve(setting.case)
        return with_h(space.h, {**defects(case.solution, space), "smooth": green.smooth_off_lines(case)})

    def rules_of(self, case: str, groups: Groups) -> Iterator[tuple[Rule, Groups]]:
        smooth_force = green.has_smooth_force(groups)
        window, cancelling = (green.SMOOTH, CANCELLING) if smooth_force else (green.KINKED, green.KINKED)
        yield finest("smooth", f"{DEFECT} / smallest term, smooth v", window, "smooth v"), groups
        # For v = Π^h u − u the terms nearly cancel.
        yield finest("remainder", f"{DEFECT} / smallest term of R, v = Π^hu − u", cancelling, "Π^hu − u"), groups
        if any("bound" in table for table in groups.values()):
            yield SHARE, groups


DEFECT = "|R(t; v) − ∫_{Γ3} σ_ν v_ν|"
SHARE = Criterion(
    "bound",
    "|R(t; v)| / (‖σ_ν‖_{L²(Γ3)} ‖v_ν‖_{L²(Γ3)})",
    BOUND,
    # The check is undecided if no time with contact was measured on some level.
    lambda group: greatest(group["bound"].to_numpy()) if group["bound"].notna().all() else None,
    ("bound",),
)


def defects(solution: ExactSolution, space: Space) -> dict[str, float]:
    """Return the largest defects of R(t; v) = ∫_{Γ3} σ_ν v_ν and the largest quotient |R| / bound, over several times.

    The times are the same as in ``green``. The quotient is computed for test fields whose bound is not zero up to
    round-off. It is NaN if there is no contact at these times.
    """
    found: dict[str, list[float]] = {"smooth v": [], "Π^hu − u": [], "bound": []}
    for time in (fraction * solution.body.T for fraction in green.TIMES):
        cut = green.cut_at_fronts(solution, time)
        R = terms(cut, space, time, [*smooth_fields(space), interpolation_error(cut, space, time)])
        pressed = ~(R.bound <= green.ROUND_OFF * np.linalg.norm(R.stress))
        found["bound"] += (abs(R.residual[pressed]) / R.bound[pressed]).tolist()
        for name, v, sizes in (
            ("smooth v", slice(FIELDS), (R.stress, R.body, R.loaded, R.contact)),
            ("Π^hu − u", slice(FIELDS, None), (R.stress, R.body, R.loaded)),
        ):
            defect = float(np.linalg.norm((R.residual - R.contact)[v]))
            found[name].append(defect / green.smallest_positive([float(np.linalg.norm(size[v])) for size in sizes]))
    instants, touching = midpoints(solution.body.T, INSTANTS).tolist(), False
    for face in solution.faces:
        exact = solution.on(face, on_facets(space, face.part, face.rough).s)
        least = green.ROUND_OFF * exact.stress_scale()
        touching |= any(np.any(abs(exact.pressure(time)) > least) for time in instants)
    if not touching:
        del found["bound"]
    return {name: maximum(values) if values else math.nan for name, values in found.items()}


FunctionOfV = tuple[Callable[[CellRule], tuple[Vectors, Tensors]], Callable[[Part, FacetRule], Vectors]]
"""A test field v at one time, given by its values in cells and on facets.

It is a pair of functions. The first returns the values of v (d, cells, points) and the strains (D, cells, points) at
the points of a cell rule. The second returns the values of v at the points of a facet rule on a part of the boundary,
(d, facets, points).
"""


def smooth_fields(space: Space) -> list[FunctionOfV]:
    """Return smooth test fields: random waves that vanish on the clamped boundary Γ1."""
    rng, clamped = np.random.default_rng(SEED), planes(space.body, Kind.CLAMPED)

    def wave() -> FunctionOfV:
        v = vanishing(waves(space.body, rng), clamped)
        return lambda rule: (v(rule.points), strain(v, rule.points)), lambda part, rule: v(part.point(rule.s))

    return [wave() for _ in range(FIELDS)]


def interpolation_error(solution: ExactSolution, space: Space, time: float) -> FunctionOfV:
    """Return the interpolation error of the exact solution as a test field, v = Π^h u(t) − u(t)."""
    mesh, nodal = space.mesh, solution.at(space.mesh.p).displacement(time)
    strains = space.strain(space.interpolate(nodal))

    def inside(rule: CellRule) -> tuple[Vectors, Tensors]:
        exact, corners = solution.at(rule.points), nodal[:, mesh.t[:, rule.cells]]
        values = np.einsum("din,inq->dnq", corners, barycentric(mesh, rule.cells, rule.points))
        return values - exact.displacement(time), strains[:, rule.cells, None] - exact.strain(time)

    def on(part: Part, rule: FacetRule) -> Vectors:
        exact = solution.at(part.point(rule.s)).displacement(time)
        return np.einsum("dan,anq->dnq", nodal[:, mesh.facets[:, rule.facets]], rule.shapes) - exact

    return inside, on


@dataclass(frozen=True, eq=False)
class Terms:
    """The terms of the residual R(t; v) at one time, each for several test fields v, (fields,).

    Attributes:
        stress: the work of the stress, (σ, ε(v))_Q.
        body: the work of the body force, (f_0, v)_H.
        loaded: the work of the surface load, (f_2, v)_{L²(Γ2)}.
        contact: the work of the contact force, ∫_{Γ3} σ_ν v_ν.
        bound: the bound of the work of the contact force, ‖σ_ν‖_{L²(Γ3)} ‖v_ν‖_{L²(Γ3)}.
    """

    stress: Array
    body: Array
    loaded: Array
    contact: Array
    bound: Array

    @property
    def residual(self) -> Array:
        """The residual R(t; v) by its definition: the work of the stress minus the work of both loads."""
        return self.stress - self.body - self.loaded


def terms(solution: ExactSolution, space: Space, time: float, functions: Sequence[FunctionOfV]) -> Terms:
    """Return the terms of the residual for several test fields at one time, by fine quadrature rules."""
    stress, body, loaded, contact, square, pressed = np.zeros((6, len(functions)))
    for rule in rules(solution, space.mesh, green.FINE[space.dim]):
        exact = solution.at(rule.points)
        sigma, force = exact.stress(time) * rule.weights, exact.body_force(time) * rule.weights
        values = [inside(rule) for inside, _ in functions]
        stress += [np.vdot(sigma, strain_of_v) for _, strain_of_v in values]
        body += [np.vdot(force, v) for v, _ in values]
    for part in space.body.of(Kind.LOADED):
        edge = on_facets(space, part)
        load = solution.at(part.point(edge.s)).surface_load(part, time) * edge.weights
        loaded += [np.vdot(load, on(part, edge)) for _, on in functions]
    for face in solution.faces:
        edge = on_facets(space, face.part, face.rough)
        normal_stress = -solution.on(face, edge.s).pressure(time)
        traces = [np.tensordot(face.part.normal, on(face.part, edge), axes=1) for _, on in functions]
        contact += [np.sum(normal_stress * trace * edge.weights) for trace in traces]
        square += [np.sum(trace**2 * edge.weights) for trace in traces]
        pressed += np.sum(normal_stress**2 * edge.weights)
    return Terms(stress, body, loaded, contact, np.sqrt(square * pressed))


def on_facets(space: Space, part: Part, rough: tuple[float, ...] = ()) -> FacetRule:
    """Return a fine quadrature rule on a part of the boundary.

    Args:
        space: the P1 space with the mesh.
        part: the part of the boundary.
        rough: coordinates on the part at which the integrand is not smooth.
    """
    return facet_rule(space.mesh, space.facets(part), part, rough, POINTS)
