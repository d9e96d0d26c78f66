"""The discrete error ‖Π^h u − u^h‖_V is superclose: of order 3/2 to 2 on one-diagonal meshes.

The paper claims nothing about this error. Proposition 5.4 is measured with time steps k ~ h^{2/3}, which are short
enough for errors of order h. The discrete error is smaller, so on fine meshes the error in time of these steps would
dominate it. Therefore k ~ h is used here. Judged is the *time share*, the error in time divided by the discrete error.
If the midpoint rule is of order 2, the time share is the same on every mesh. Jumps of u̇ may reduce the order in k to 1
(``landings``). So the growth of the time share is judged: an order 3/2 in k would double it over two refinements. One
case was judged at first and is now only reported, because its ü is not square integrable in time; its time share is
between 1 % and 40 %.
"""

from types import MappingProxyType

from manufactured.catalogue import catalogue
from study.ledger.criterion import ENOUGH, change, largest, order
from study.ledger.window import between, positive_at_most
from study.solve.tableau import MIDPOINT
from study.statements.shared.base import EVOLVING, ListedNumbers, Setting, grid, steps_like_h, with_h
from study.statements.shared.experiment import Experiment
from study.statements.shared.meshes import families
from study.statements.shared.norms import maximum, norm

TIME = positive_at_most(0.3, "of the discrete error, as in Prop. 5.4")
FAMILY = "one-diagonal"
ORDER = between(1.5, 2, 0.2, 0.2, "k ~ h, neighbouring triangles form parallelograms")
STEADY = positive_at_most(2.0, "k^{3/2}/h² with k ~ h doubles over two refinements")
"""Window of (time share on the finest level) / (time share on the coarsest level).

With time steps k ~ h^{2/3}, errors of order 2 in k would make the quotient 2.5."""

BY_CHANCE = "ü ~ (t − t_0)^{−3/4}, so that the order in k is below 3/2 and depends on the position of t_0 in a step"


class Superclose(ListedNumbers):
    """Measures the discrete error ‖Π^h u − u^h‖_V for the plane cases of Proposition 5.4, and its time share.

    The time share is the error of the time discretisation divided by the discrete error.
    """

    label = "superclose"
    claim = (
        "‖Π^h u − u^h‖_{L∞(0,T;V)} is of order 3/2 to 2 on one-diagonal meshes, with k ~ h, if u̇ is Lipschitz except "
        "for jumps"
    )
    rules = (
        order("order", "order of ‖Π^h u − u^h‖_V, k ~ h", ORDER, "discrete error", last=ENOUGH),
        largest("time-share", "time share of ‖Π^h u − u^h‖_V: error in time / discrete error", TIME, "time share"),
        change("share-growth", "time share, finest level / coarsest level", STEADY, "time share"),
    )
    not_judged = MappingProxyType({"load-w11": BY_CHANCE})

    def places(self, full: bool) -> list[Setting]:
        plane = [case for case in catalogue() if case.proposition == "Prop. 5.4" and case.solution.body.dim == 2]
        cases = [case.name for case in plane if FAMILY in families(case)]
        return grid(cases, (FAMILY,), (16, 32, 64)) if full else grid(EVOLVING[:2], (FAMILY,), (8, 16, 32))

    def measure(self, setting: Setting) -> dict[str, float]:
        setup = Experiment.at(setting, MIDPOINT, self.steps(setting))
        coarse = setup.scheme.march(setup.problem, setup.steps // 2)
        discrete, drift = [], []
        for n, state in enumerate(setup.scheme.march(setup.problem, setup.steps)):
            discrete.append(norm(setup.problem, setup.v_norm.sample(state.time).interpolant - state.u))
            if n % 2 == 0:
                drift.append(norm(setup.problem, next(coarse).u - state.u))
        found = {"discrete error": maximum(discrete), "time share": maximum(drift) / maximum(discrete)}
        return with_h(setup.space.h, found)

    def cost(self, setting: Setting) -> float:
        return 2.0 * setting.level**2 * self.steps(setting)

    def steps(self, setting: Setting) -> int:
        return steps_like_h(setting)
