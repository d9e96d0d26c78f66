"""The timings behind the table of ratios, by pytest-benchmark: `make bench`. Collected only when named."""

from __future__ import annotations

import os
from dataclasses import asdict
from itertools import cycle, islice
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sps
from scipy.sparse.linalg import LaplacianNd, SuperLU, splu

from benchmarks.level import DIRECT, Place, Watched, compile_formulas, errors
from benchmarks.parallel import run
from manufactured.tensors import Array
from study.fem.naming import resolve
from study.solve.factorisation import Cholesky
from study.solve.steps import rate_steps

LEVELS = [int(n) for n in os.environ.get("BENCH_LEVELS", "256 512").split()]
PLACES = [Place("advance-recede", family, n) for n in LEVELS for family in ("one-diagonal", "shaken")]
SOLIDS = [Place("cube-disc", "one-diagonal", 18)]
NONLINEAR = [Place(case, "shaken", n) for case in ("yield-and-release", "yield-on-a-part") for n in (8, 16, 32, 64)]
WHOLE = Place("all cases of the quick study", "all", 0)
RIGHTS = 12
"""Right sides of consecutive steps on which solves are timed."""
REPEATED = 256
"""Largest n at which whole levels are done three times, and not twice."""


@pytest.fixture(scope="module", params=PLACES + SOLIDS, ids=lambda place: f"{place.case}-{place.family}-{place.n}")
def watched(request: pytest.FixtureRequest) -> tuple[Place, Watched]:
    """A place and its contact solver after the first RIGHTS steps."""
    watched = Watched(DIRECT, RIGHTS)
    setup = request.param.setup(watched)
    for _ in islice(setup.scheme.march(setup.problem, setup.steps), RIGHTS + 1):
        pass
    return request.param, watched


def describe(benchmark: Any, quantity: str, place: Place, dofs: int, **counts: float) -> None:
    """What the table of ratios needs to know."""
    benchmark.extra_info.update(quantity=quantity, **asdict(place), dofs=dofs, **counts)


def bench_factorisation(benchmark: Any, watched: tuple[Place, Watched]) -> None:
    place, seen = watched
    last = seen.contact.factor.order[seen.contact.contact]
    describe(benchmark, "factorisation", place, seen.S.shape[0])
    benchmark.pedantic(Cholesky, args=(seen.S, last, seen.points), rounds=3)


def bench_solve(benchmark: Any, watched: tuple[Place, Watched]) -> None:
    place, seen = watched
    rights = cycle(seen.rights)
    describe(benchmark, "solve", place, seen.S.shape[0])
    bare = DIRECT.bare(seen)
    benchmark.pedantic(bare, setup=lambda: ((next(rights),), {}), rounds=2 * RIGHTS, warmup_rounds=1)


def bench_step(benchmark: Any, watched: tuple[Place, Watched]) -> None:
    """Consecutive steps, so that the active set starts from that of the step before, as in a march.

    Each comes after a bare solve with its right side: a machine that is slower for a moment is slower for both.
    """
    place, seen = watched
    rights, bare = cycle(seen.rights), DIRECT.bare(seen)
    between: list[float] = []

    def after_a_solve() -> tuple[tuple[Array], dict[str, Any]]:
        b = next(rights)
        start = perf_counter()
        bare(b)
        between.append(perf_counter() - start)
        return (b,), {}

    rounds = 4 * RIGHTS
    describe(benchmark, "step", place, seen.S.shape[0])
    benchmark.pedantic(seen.contact, setup=after_a_solve, rounds=rounds, warmup_rounds=1)
    q1, median, q3 = (float(q) for q in np.quantile(between[-rounds:], (0.25, 0.5, 0.75)))
    benchmark.extra_info["beside"] = {"solve between steps": {"q1": q1, "median": median, "q3": q3}}


def bench_library_factorisation(benchmark: Any, watched: tuple[Place, Watched]) -> None:
    """SuperLU on the same matrix in an order of its own, as a measure from outside: a slow factorisation of ours would
    flatter ratios to it."""
    place, seen = watched
    describe(benchmark, "library factorisation", place, seen.S.shape[0])
    benchmark.pedantic(library, args=(seen.S,), rounds=2)


def bench_library_solve(benchmark: Any, watched: tuple[Place, Watched]) -> None:
    place, seen = watched
    rights, factor = cycle(seen.rights), library(seen.S)
    describe(benchmark, "library solve", place, seen.S.shape[0])
    benchmark.pedantic(factor.solve, setup=lambda: ((next(rights),), {}), rounds=RIGHTS, warmup_rounds=1)


def library(S: sps.csc_array) -> SuperLU:
    """The Cholesky-like setting of SciPy's SuperLU."""
    options = {"SymmetricMode": True}
    return splu(sps.csc_matrix(S), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)


@pytest.mark.parametrize("place", PLACES + SOLIDS, ids=lambda place: f"{place.case}-{place.family}-{place.n}")
def bench_level(benchmark: Any, place: Place) -> None:
    """Mesh, assembly, factorisation, condensation, and load, solve and error at every step."""

    def level() -> None:
        setup = place.setup()
        errors(setup)
        describe(benchmark, "level", place, setup.space.dofs)

    compile_formulas(place.case)
    benchmark.pedantic(level, rounds=3 if place.n <= REPEATED else 2)


@pytest.mark.parametrize("place", NONLINEAR, ids=lambda place: f"{place.case}-{place.family}-{place.n}")
def bench_nonlinear_law(benchmark: Any, place: Place) -> None:
    """With the step size that the study itself takes at this level."""
    watched = Watched(DIRECT, 0)
    case = resolve(place.case)
    steps = rate_steps(case.solution.body.T, place.n, case.pace)
    setup = place.setup(watched, steps)

    def march() -> None:
        # The start is no step.
        spent = [state.iterations for state in setup.scheme.march(setup.problem, steps)][1:]
        counts = {"most_solves": max(spent), "factorisations": watched.made}
        describe(benchmark, "nonlinear", place, setup.space.dofs, **counts)

    benchmark.pedantic(march, rounds=1)


def bench_quick_study(benchmark: Any, tmp_path: Path) -> None:
    """All jobs in one process, from an empty directory; Python is started, too."""
    describe(benchmark, "quick study", WHOLE, 0)
    benchmark.pedantic(run, (tmp_path / "quick", 1, ["--quick"]), rounds=1)


def bench_fixed_work(benchmark: Any) -> None:
    """Work of NumPy and SciPy that no change of this study makes slower: small arrays, a factorisation and solves."""
    describe(benchmark, "fixed work", WHOLE, 0)
    S = sps.csc_array(-LaplacianNd((150, 150)).tosparse() + sps.eye_array(150**2))
    x = np.linspace(0.0, 1.0, 1000)
    right = np.ones(150**2)

    def work() -> None:
        factor = library(S)
        for _ in range(200):
            factor.solve(right)
        for _ in range(300_000):
            np.exp(x)

    benchmark.pedantic(work, rounds=5)
