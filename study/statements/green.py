"""Green's formula (2.14) for the exact stress, tested with all P1 displacements v ∈ V^h.

With (2.2), (2.4), σ_τ = 0 on Γ3 and v = 0 on Γ1, Green's formula says that two functionals on V^h are equal:

    (σ, ε(v))_Q − ∫_{Γ3} σ_ν v_ν = (f_0, v)_H + (f_2, v)_{L²(Γ2)}.

The left side is ``ErrorNorm.load``, which needs no derivative of σ. The right side is computed from the forces, term by
term. The *defect* is the distance of both sides in the dual norm of V^h, ‖F‖² = FᵀM⁻¹F, divided by the **smallest**
non-zero term of the four. So the defect is at least 1 if a term is missing, and at least 2 if its sign is wrong,
however large the other terms are.

The defect may only consist of quadrature error. It is at round-off level if f_0 is smooth except on known straight
lines, along which cells are cut. Otherwise f_0 jumps inside cells: on the curve where the material begins to yield, on
the cylinder below a front in 3D, or where a front turned. A rule on cells of size η then has an error of about η^d in
each cell that the jump crosses. Two criteria are used for such cases, with a **composite** rule: degree 4 on cells
halved several times.

* After all halvings the defect is at most a tenth of the smallest term, so no term can be missing.
* For a fixed space V^h the defect falls when cells are halved. After k halvings the support of a basis function
  contains 2^{k(d−1)} crossed cells, with errors of size 2^{−kd}. The sum falls like 2^{−k} if all errors have one sign,
  and like 2^{−k(d+1)/2} if signs are random. The window is for all halvings together, with a factor of two for scatter.
  With a coefficient that is wrong by a few per cent the defect would stop falling.

Functions of V^h are also P1 functions on the halved cells. So a functional on the finer space is restricted to V^h by
means of the values of these functions at the new vertices.
"""

from collections.abc import Sequence
from dataclasses import replace

import scipy.sparse as sps

from manufactured.body import Kind
from manufactured.case import Case
from manufactured.catalogue import catalogue
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.factor import UNIFORM
from manufactured.law import Linear
from study.fem.error_norm import DEGREE, SOLID_DEGREE, ErrorNorm
from study.fem.independent import work_of_body_force, work_on
from study.fem.mesh import with_midpoints
from study.fem.naming import resolve
from study.fem.space import Space
from study.ledger.criterion import Groups, Rule, finest, largest
from study.ledger.window import positive_at_most
from study.solve.factorisation import Cholesky
from study.statements.shared.base import ListedNumbers, Setting, with_h
from study.statements.shared.eigen import unloaded
from study.statements.shared.meshes import named, place, space_of
from study.statements.shared.norms import dual_norm, maximum, minimum
from study.statements.shared.scope import REGULAR

TIMES = (0.23, 0.61, 0.79)
"""Times at which both sides of Green's formula are compared, as fractions of the final time T.

They lie before, between and after all events of the cases, such as the beginning of contact. At these times the work of
contact is 0 or at least 1/300 of the largest term."""
FINE, COARSE = {2: 16, 3: 8}, 4
"""Degrees of quadrature rules: on whole cells, by dimension, and on halved cells."""
HALVINGS = {2: 3, 3: 2}
"""How many times cells are halved for the composite rule, by dimension."""
SMOOTH = positive_at_most(1e-10, "with the fine quadrature rule: f_0 is smooth away from straight lines")
KINKED = positive_at_most(0.1, "quadrature error, as f_0 jumps along curves; a missing term would give 1")
SHRINKING = positive_at_most(2.0, "1 if the errors of all cells have one sign, up to 2 if their signs vary")
ROUND_OFF = 1e-12
"""Relative size below which defects and terms count as rounding."""

DEFECT = "defect of Green's formula on V^h / smallest term"
FOR_SMOOTH_FORCES = (finest("fine-rule", DEFECT, SMOOTH, "fine rule"),)
FOR_FORCES_WITH_JUMPS = (
    finest("halved", f"{DEFECT}, cells halved", KINKED, "halved cells"),
    largest("shrunk", "2^k · defect on cells halved k times / defect on whole cells, same V^h", SHRINKING, "shrunk"),
)


class Green(ListedNumbers):
    """Measures the defect of Green's formula on V^h, for the cases whose Div σ is square integrable."""

    label = "(2.14)"
    effort = 15
    claim = "(σ, ε(v))_Q + (Div σ, v)_H = ∫_Γ σν·v"

    def places(self, full: bool) -> list[Setting]:
        if full:
            return place([case for case in catalogue() if square_integrable(case)], REGULAR, (8, 16), (6,))
        cases = named("full-contact", "no-contact", "fixed-front-off-vertex", "advance-recede", "yield-and-release")
        return place(cases, REGULAR, (4, 8))

    def measure(self, setting: Setting) -> dict[str, float]:
        space, case = space_of(setting), resolve(setting.case)
        if smooth_off_lines(case):
            return with_h(space.h, {"fine rule": defect(case.solution, space, FINE[space.dim]), "smooth": 1.0})
        halvings = HALVINGS[space.dim]
        whole, halved = (defect(case.solution, space, COARSE, k) for k in (0, halvings))
        # Defects below ROUND_OFF are replaced by it, because round-off does not fall when cells are halved.
        shrunk = 2**halvings * (max(halved, ROUND_OFF) / max(whole, ROUND_OFF))
        return with_h(space.h, {"whole cells": whole, "halved cells": halved, "shrunk": shrunk, "smooth": 0.0})

    def rules_of(self, case: str, groups: Groups) -> list[tuple[Rule, Groups]]:
        rules = FOR_SMOOTH_FORCES if has_smooth_force(groups) else FOR_FORCES_WITH_JUMPS
        return [(rule, groups) for rule in rules]


def has_smooth_force(groups: Groups) -> bool:
    """Return whether measurements belong to a case with a smooth body force, in the sense of ``smooth_off_lines``."""
    return any("smooth" in table and (table["smooth"] == 1).any() for table in groups.values())


def defect(solution: ExactSolution, space: Space, degree: int, halvings: int = 0) -> float:
    """Return the largest defect of Green's formula over the times ``TIMES``.

    The defect is the distance of both sides of the formula in the dual norm of V^h, divided by the smallest non-zero
    term of the formula.

    Args:
        solution: the exact solution.
        space: the P1 space V^h.
        degree: the degree of the quadrature rules on cells.
        halvings: how many times cells are halved before the rules are used.
    """
    riesz = Cholesky(unloaded(space, solution.law).M)
    fine, prolong = refined(space, halvings)
    raised = degree - (DEGREE if space.dim == 2 else SOLID_DEGREE)
    defects: list[float] = []
    v_norm = None
    for time in (fraction * solution.body.T for fraction in TIMES):
        cut = cut_at_fronts(solution, time)
        if v_norm is None or cut is not solution:
            v_norm = ErrorNorm(cut, fine, raised)
        load, body = v_norm.load(time), work_of_body_force(cut, fine, time, degree)
        contact, loaded = (work_on(kind, cut, fine, time) for kind in (Kind.CONTACT, Kind.LOADED))
        functionals = load - body - loaded, load + contact, contact, body, loaded
        on_space = [space.interpolate((prolong.T @ fine.nodal(F).T).T) for F in functionals]
        distance, *sizes = [dual_norm(F, riesz) for F in on_space]
        defects.append(distance / smallest_positive(sizes))
    return maximum(defects)


def refined(space: Space, halvings: int) -> tuple[Space, sps.csr_array]:
    """Return the P1 space on a mesh whose cells are halved several times, and the prolongation to it.

    Returns:
        The space on the halved cells, and the matrix that maps vertex values on the given mesh to vertex values on the
        halved cells, (fine vertices, vertices).
    """
    mesh, prolong = space.mesh, sps.csr_array(sps.eye_array(space.mesh.p.shape[1]))
    for _ in range(halvings):
        prolong = sps.csr_array(with_midpoints(mesh) @ prolong)
        mesh = mesh.refined()
    return Space(mesh, space.body), prolong


def smallest_positive(sizes: Sequence[float]) -> float:
    """Return the smallest of the given norms, without those that are zero up to round-off."""
    negligible = ROUND_OFF * maximum(sizes)
    return minimum(size for size in sizes if not size <= negligible)


def square_integrable(case: Case) -> bool:
    """Return whether the divergence of the exact stress is square integrable, Div σ(t) ∈ H.

    This follows from ε(u̇(t)) ∈ H¹.
    """
    return case.regularity.rate_smoothness > 1


def smooth_off_lines(case: Case) -> bool:
    """Return whether the body force of a case is smooth at all times, except on known straight lines.

    This is false for moving contact fronts, which leave kinks where they turned, and for a nonlinear elasticity G,
    which has kinks where the material begins to yield.
    """
    law, faces = case.solution.law, case.solution.faces
    homogeneous = law.A.factor is UNIFORM and isinstance(law.G, Linear) and law.G.factor is UNIFORM
    return homogeneous and not case.regularity.moving and all(isinstance(face, ContactFace) for face in faces)


def cut_at_fronts(solution: ExactSolution, time: float) -> ExactSolution:
    """Return the exact solution with quadrature rules that also cut cells along the contact fronts at one time.

    Rules can cut a cell along one line only. So the solution is returned unchanged if it is in 3D, has several contact
    faces, or has other cuts already.
    """
    face, *others = solution.faces
    if solution.body.dim > 2 or others or solution.rough or not isinstance(face, ContactFace):
        return solution
    return replace(solution, faces=(replace(face, rough=face.fronts(time)),))
