"""The theorem of Prager and Synge: a displacement u^h and a stress σ^h bound each other's errors in static contact.

The paper has no such statement. If gap and pressure of a case are frozen at one time, then u̇ = 0. This gives a problem
of elastic contact with the tensor C = G, whose exact displacement u and stress σ are known. Let u^h ∈ K^h be piecewise
linear. Let P be the L² projection of the loads onto polynomials, and let the stress σ^h be in equilibrium with P f_0
and P f_2, with σ^h_τ = 0 and σ^h_ν ≤ 0 on Γ3. Then Green's formula gives

    ‖σ^h − Cε(u^h)‖²_{C⁻¹} = ‖e‖²_C + ‖σ − σ^h‖²_{C⁻¹} − 2(f_0 − P f_0, e) − 2(f_2 − P f_2, e)_{Γ2}
                             + 2∫_{Γ3} (σ^h_ν − σ_ν) e_ν,     e = u − u^h,

which is the theorem of Prager and Synge with additional terms. On Γ3, (σ^h_ν − σ_ν) e_ν ≥ −σ^h_ν u^h_ν. The two terms
with f_0 − P f_0 and f_2 − P f_2 are together at most 2Ω ‖e‖_C, with the constants Ω of ``study.stresses.oscillation``.
So with η² = ‖σ^h − Cε(u^h)‖² + 2∫_{Γ3} σ^h_ν u^h_ν

    (‖u − u^h‖² + ‖σ − σ^h‖²)^½ ≤ Ω + (Ω² + η²)^½.

The right side is a bound that does not contain the exact solution.

**Predicted**: the bound is never below the left side, the norm of both errors together. The bound is η (1 + O(Ω/η)),
and η tends to the left side, because only the cells at the fronts contribute to ∫ σ^h_ν u^h_ν. For stresses of degree 3
and smooth f_0, Ω ~ h⁴ while errors are ~ h. If f_0 jumps at a front (m = 2), Ω ~ h^{3/2}, and at
best bound/errors − 1 ~ h^{1/2} can be expected. Raising the degree by one halves Ω. With degree 3 the bound exceeds
both errors together by at most 5 % from n = 16 on. The ratio without Ω and without the contact term may be below 1, so
it is reported and not judged. For stresses of degree 1, f_0 − P f_0 is orthogonal to constants only. Then there is no
such Ω, and only this ratio is available.

Sources: W. Prager, J. L. Synge, Approximations in elasticity based on the concept of function space, Quart. Appl. Math.
5 (1947) 241–269; for contact A. Weiss, B. I. Wohlmuth, A posteriori error estimator and error control for contact
problems, Math. Comp. 78 (2009) 1237–1267.
"""

import numpy as np
from sympy import Rational, sympify

from manufactured.body import Kind
from manufactured.contact import ContactFace
from manufactured.data import Data
from manufactured.exact import ExactSolution
from manufactured.law import Linear
from manufactured.symbols import t
from manufactured.tensors import Array, Tensors
from study.fem.error_norm import ErrorNorm
from study.fem.naming import family_named, resolve
from study.fem.space import Space
from study.ledger.criterion import Observation, every
from study.ledger.window import Window, around
from study.solve.signorini import Signorini
from study.statements.shared.base import ListedNumbers, Setting, grid, with_h
from study.stresses.composite import interval_mass
from study.stresses.hybrid import Equilibrium
from study.stresses.loads import ProjectedLoads
from study.stresses.oscillation import Oscillation
from study.stresses.stress_space import StressSpace

FROZEN = Rational(1, 3)
"""Time at which gap and pressure of a case are frozen."""
CASES = ("full-contact", "fixed-front-off-vertex", "advance-recede", "merging-patches", "corner")
LOW, HIGH = 1, 3
"""Polynomial degrees of the stresses."""
TIGHT = Window(1.0, 1.05, "for n ≥ 16; a value below 1 would refute the bound")
NEAR = around(1, 0.05, "for n ≥ 16")
DISTANCE = "‖σ^h − Cε(u^h)‖ / both errors together, stresses of degree"
NO_BOUND = "without the oscillation of the forces this is no bound"


class Hypercircle(ListedNumbers):
    """Measures the guaranteed bound of the errors of u^h and σ^h, divided by the norm of both errors together.

    The main part of the bound, ‖σ^h − Cε(u^h)‖, is measured as well. Laws are linear with constant tensors.
    """

    label = "Prager–Synge"
    claim = "u^h and σ^h bound each other's errors at a fixed time"
    rules = (
        every("guaranteed", "guaranteed bound / both errors together", TIGHT, "guaranteed"),
        Observation(every("plain-1", f"{DISTANCE} {LOW}", NEAR, "plain_1"), NO_BOUND),
        Observation(every("plain-3", f"{DISTANCE} {HIGH}", NEAR, "plain_3"), NO_BOUND),
    )
    quick = grid(("full-contact", "advance-recede"), ("shaken",), (16,))
    full = grid(CASES, ("shaken",), (16, 32))

    def measure(self, setting: Setting) -> dict[str, float]:
        solution = frozen(resolve(setting.case).solution)
        mesh = family_named(setting.family)(solution.body, setting.level)
        displacements = Space(mesh, solution.body)
        G = solution.law.G
        assert isinstance(G, Linear)
        u, _ = Signorini(displacements.form(G.matrix), displacements.N)(ErrorNorm(solution, displacements).load(0.0))
        low, high = (Pair(solution, StressSpace(mesh, solution.body, p), displacements, u) for p in (LOW, HIGH))
        found = {"plain_1": low.distance / low.error, "plain_3": high.distance / high.error}
        found |= {"guaranteed": high.bound / high.error, "oscillation": high.oscillation / high.error}
        return with_h(displacements.h, found)


def frozen(solution: ExactSolution) -> ExactSolution:
    """Return the static solution with the gap and the pressure of a given solution at the time ``FROZEN``."""
    faces = []
    for face in solution.faces:
        assert isinstance(face, ContactFace)
        formulas = (face.gap, face.strain.pressure, face.level)  # type: ignore[attr-defined]
        w, p, level = (sympify(formula).subs(t, FROZEN) for formula in formulas)
        data = face.part, solution.law, solution.body.T, w, p, level
        faces.append(ContactFace.linear(*data, profile=face.profile, rough=face.rough))
    return ExactSolution(solution.body, solution.law, tuple(faces))


class Pair:
    """A displacement u^h and a stress σ^h on one mesh, with the norm of both errors together and its bound.

    Attributes:
        error: both errors together, (‖u − u^h‖²_C + ‖σ − σ^h‖²_{C⁻¹})^½.
        distance: the distance of both stresses, ‖σ^h − Cε(u^h)‖_{C⁻¹}.
        oscillation: the bound Ω of the effect of projecting the loads; NaN for stresses of degree 1.
        bound: the bound Ω + (Ω² + η²)^½ of ``error``, with η² = ``distance``² + 2∫_{Γ3} σ^h_ν u^h_ν.
    """

    def __init__(self, solution: ExactSolution, space: StressSpace, displacements: Space, u: Array) -> None:
        G = solution.law.G
        assert isinstance(G, Linear)
        self.space, self.compliance = space, np.linalg.inv(G.matrix)
        equilibrium = Equilibrium(space, self.compliance)
        snapshot = ProjectedLoads(Data.of(solution), space).at(0.0)
        stress = equilibrium(snapshot.loads, np.zeros((3, *space.weights.shape)))
        mine = (G.matrix @ displacements.strain(u))[..., None]
        self.distance = self._norm(stress.values - mine)
        # The solution is static, so its stress has no viscous part and does not depend on the time.
        sigma = solution.at(space.points).stress(0.0)
        self.error = float(np.hypot(self._norm(sigma - mine), self._norm(sigma - stress.values)))
        nodal, work = displacements.nodal(u), 0.0
        for part, edges in space.on(Kind.CONTACT):
            ends = np.einsum("d,dan->na", part.normal, nodal[:, space.mesh.facets[:, edges]])
            pressed = space.boundary_tractions(edges, stress.tractions)[..., 0]
            mass = interval_mass(1, space.degree)
            work += float(np.einsum("na,nb,ab,n->", ends, pressed, mass, space.lengths[edges]))
        # For degree 1 no Ω is known, because f_0 − P f_0 is not orthogonal to P1 functions.
        cells = Oscillation(space, self.compliance)(snapshot.left_out) if space.degree > 1 else np.nan
        self.oscillation = float(np.linalg.norm(cells))
        self.bound = self.oscillation + float(np.sqrt(self.oscillation**2 + self.distance**2 + 2 * max(work, 0.0)))

    def _norm(self, stress: Tensors) -> float:
        weights = self.space.weights
        return float(np.sqrt(np.einsum("Icq,IJ,Jcq,cq->", stress, self.compliance, stress, weights, optimize=True)))
