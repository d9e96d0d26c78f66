"""The condensed contact solve of this study."""

from functools import partial
from importlib.metadata import version
from time import perf_counter

import numpy as np
from problem import Answer, main
from scipy import sparse as sps

from study.solve.evolution import SemiDiscrete
from study.solve.signorini import Signorini
from study.solve.tableau import BACKWARD_EULER


def solve(given):
    steps = len(given.loads)
    problem = SemiDiscrete(
        M=sps.csc_array(given.M),
        reference=sps.csc_array(given.G),
        remainder=None,
        N=sps.csr_array(given.N),
        load=lambda times: np.array([given.loads[round(t / given.k) - 1] for t in times]).T,
        u0=given.u0,
        T=steps * given.k,
        solver=partial(Signorini, x=given.p[:, given.free[::2] // 2]),
    )
    start = perf_counter()
    states = list(BACKWARD_EULER.march(problem, steps))
    seconds = perf_counter() - start
    return Answer(np.array([state.u for state in states[1:]]), seconds, version("signorini-study"), 1)


if __name__ == "__main__":
    main(solve)
