"""The same levels solved by others: `make bench-peers`.

    python -m benchmarks.compare [--levels N ...] [--rounds N] [--limit SECONDS] [--python PYTHON] [--out DIRECTORY]

Matrices, loads and start of every level are written to a temporary file; each peer is a script of ``peers/`` that
reads it, run by the Python that has its libraries, in a process and with one thread of its own. This study and all
peers take turns, so that a machine that is slower for some minutes is slower for all. All trajectories are compared in
the norm of V with the one of this study.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pandas as pd
import scipy.sparse as sps

from benchmarks.peers.problem import save
from benchmarks.report import RESULTS, single_thread, write
from manufactured.tensors import Array
from study.fem.error_norm import ErrorNorm
from study.fem.mesh import Shaken
from study.fem.naming import resolve
from study.fem.space import Space
from study.solve.evolution import SemiDiscrete

CASE, FAMILY, STEPS = "advance-recede", Shaken(), 50
AGREEMENT = 1e-6
"""Largest distance over all steps, relative to the size of the solution, at which times are compared."""
HERE = Path(__file__).parent / "peers"
COLUMNS = [
    "peer",
    "version",
    "blas",
    "n",
    "dofs",
    "steps",
    "factorisations",
    "assembly_seconds",
    "seconds",
    "slowest",
    "ratio",
    "agreement",
    "remark",
]


@dataclass(frozen=True)
class Peer:
    """Another program.

    Attributes:
        name: as in the table.
        script: of ``peers/``.
        modules: what has to be installed.
        system: whether in the Python of the system, not in this one.
        patience: time limits it gets; one for QP solvers, which come to levels they can do in it.
        options: given to the script.
    """

    name: str
    script: str
    modules: tuple[str, ...]
    system: bool = False
    patience: int = 1
    options: tuple[str, ...] = ()

    def command(self, python: str) -> list[str]:
        # Python's own variables are of this environment.
        return [python, "-E"] if self.system else [sys.executable]

    def installed(self, python: str) -> bool:
        command = [*self.command(python), "-c", f"import {', '.join(self.modules)}"]
        try:
            return subprocess.run(command, capture_output=True).returncode == 0
        except OSError:
            return False


OURS = Peer("this study", "ours.py", ("study",))
PEERS = (
    Peer("PETSc SNESVI, Cholesky", "snesvi.py", ("petsc4py", "scipy"), True, 4, ("cholesky",)),
    Peer("PETSc SNESVI, LU", "snesvi.py", ("petsc4py", "scipy"), True, 4, ("lu",)),
    Peer("DOLFINx, SNESVI, Cholesky", "native_dolfinx.py", ("dolfinx", "petsc4py", "scipy"), True, 4),
    Peer("scikit-fem, naive active set", "naive_skfem.py", ("skfem",), False, 4),
    Peer("SciPy, condensed once", "condensed.py", ("scipy",), False, 4, ("superlu",)),
    Peer("CHOLMOD by AMD, condensed once", "condensed.py", ("sksparse.cholmod",), False, 4, ("cholmod-amd",)),
    Peer("CHOLMOD by METIS, condensed once", "condensed.py", ("sksparse.cholmod",), False, 4, ("cholmod-metis",)),
    Peer("Clarabel", "qp_clarabel.py", ("clarabel",)),
    Peer("OSQP", "qp_osqp.py", ("osqp",)),
)


@dataclass(frozen=True, eq=False)
class Run:
    """What one peer did on one level: its trajectory and what it printed, or why there is none."""

    u: Array | None
    printed: dict[str, Any]
    remark: str = ""


def rotation(N: sps.csr_array) -> tuple[sps.csc_array, Array]:
    """R orthogonal with N R = rows of the identity, and the places of their ones, (m,).

    Householder reflections of the unknowns of each row.

    Raises:
        ValueError: rows of N share an unknown or are not of length one, so they are not bounds in such a basis.
    """
    N = sps.csr_array(N, copy=True)
    N.eliminate_zeros()
    rows = np.split(N.indices, N.indptr[1:-1])
    if abs(sps.eye_array(N.shape[0]) - N @ N.T).max() > 1e-12 or len(np.unique(N.indices)) < len(N.indices):
        raise ValueError(
            "the rows of N must have length one and no unknown in common; take a body with one contact face"
        )
    R = sps.lil_array(sps.eye_array(N.shape[1]))
    bounded = []
    for unknowns, normal in zip(rows, np.split(N.data, N.indptr[1:-1]), strict=True):
        largest = int(abs(normal).argmax())
        v = normal - np.eye(len(normal))[largest]
        if v.any():
            R[np.ix_(unknowns, unknowns)] = np.eye(len(v)) - 2 * np.outer(v, v) / (v @ v)
        bounded.append(unknowns[largest])
    return sps.csc_array(R), np.array(bounded)


def export(n: int, path: Path) -> SemiDiscrete:
    """Write one level for all peers, and return it."""
    solution = resolve(CASE).solution
    space = Space(FAMILY(solution.body, n), solution.body)
    v_norm = ErrorNorm(solution, space)
    problem = SemiDiscrete.of(space, solution.law, v_norm.load, v_norm.sample(0.0).interpolant)
    k = problem.T / STEPS
    R, bounded = rotation(problem.N)
    S = problem.M / k + problem.reference
    save(
        path,
        {"S": S, "M": problem.M, "G": problem.reference, "N": problem.N, "R": R},
        bounded=bounded,
        loads=np.array([v_norm.load(step * k) for step in range(1, STEPS + 1)]),
        u0=problem.u0,
        k=k,
        p=space.mesh.p,
        t=space.mesh.t,
        free=space.free,
        viscous=solution.law.A.matrix,
        elastic=solution.law.G.reference,
    )
    return problem


def run(peer: Peer, source: Path, limit: float, python: str) -> Run:
    """Let a peer solve the problem in a file."""
    target = source.with_name("answer.npy")
    command = [*peer.command(python), str(HERE / peer.script), str(source), str(target), *peer.options]
    limit *= peer.patience
    try:
        done = subprocess.run(command, capture_output=True, text=True, env=single_thread(os.environ), timeout=limit)
    except subprocess.TimeoutExpired:
        return Run(None, {}, f"stopped after {limit:.0f} s")
    if done.returncode:
        last = (done.stderr.strip().splitlines() or [f"signal {-done.returncode}"])[-1]
        return Run(None, {}, f"failed: {last}")
    return Run(np.load(target), json.loads(done.stdout.splitlines()[-1]))


def distance(M: sps.csc_array, u: Array, v: Array) -> float:
    """max_n ‖u_n − v_n‖_V/‖u_n‖_V of two trajectories, (steps, dofs)."""

    def norms(w: Array) -> Array:
        return np.sqrt(np.einsum("nd,nd->n", w, (M @ w.T).T))

    return float((norms(u - v) / norms(u)).max())


def row(peer: Peer, runs: Sequence[Run], ours: Sequence[Run], problem: SemiDiscrete, n: int) -> dict[str, Any]:
    """A line of the table: medians over the rounds; a time is compared only where the solutions agree."""
    done = runs[-1]
    line = {"peer": peer.name, "n": n, "dofs": len(problem.u0), "steps": STEPS, "remark": done.remark, **done.printed}
    if done.u is None or ours[-1].u is None:
        return line
    seconds, own = ([of.printed["seconds"] for of in which] for which in (runs, ours))
    line |= {"seconds": median(seconds), "slowest": max(seconds), "agreement": distance(problem.M, ours[-1].u, done.u)}
    if not line["agreement"] <= AGREEMENT:
        return line | {"remark": "disagrees: not compared"}
    return line | {"ratio": median(theirs / mine for theirs, mine in zip(seconds, own, strict=True))}


def compare(levels: Sequence[int], limit: float, python: str, rounds: int) -> Iterator[dict[str, Any]]:
    """The lines of the table, level by level; who was too slow on one is asked neither again nor for finer ones."""
    present = [peer for peer in PEERS if peer.installed(python)]
    slow: dict[Peer, str] = {}
    for n in sorted(levels):
        with TemporaryDirectory() as directory:
            source = Path(directory) / "problem.npz"
            problem = export(n, source)
            asked = [OURS, *(peer for peer in present if peer not in slow)]
            runs: dict[Peer, list[Run]] = {peer: [] for peer in asked}
            for _ in range(rounds):
                for peer in asked:
                    if not any(done.remark for done in runs[peer]):
                        runs[peer].append(run(peer, source, limit, python))
            for peer in (OURS, *PEERS):
                absent = Run(None, {}, slow.get(peer, "not installed"))
                found = runs.get(peer, [absent])
                if found[-1].remark.startswith("stopped after"):
                    slow.setdefault(peer, f"{found[-1].remark} at n = {n}")
                yield row(peer, found, runs[OURS], problem, n)


def main(arguments: list[str]) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--levels", type=int, nargs="+", default=[64, 128, 256])
    parser.add_argument("--rounds", type=int, default=3, help="turns of each program; medians are shown (default 3)")
    parser.add_argument(
        "--limit", type=float, default=75.0, help="seconds for a peer on a level (four times that but for QP solvers)"
    )
    parser.add_argument("--python", default="/usr/bin/python3", help="the Python that has petsc4py and dolfinx")
    parser.add_argument("--out", type=Path, default=RESULTS)
    options = parser.parse_args(arguments)
    lines = []
    for line in compare(options.levels, options.limit, options.python, options.rounds):
        print(line, flush=True)
        lines.append(line)
    notes = [
        f"{CASE} on {FAMILY.name} meshes, {STEPS} backward Euler steps, each run in a process of its own, after the "
        f"first step alone, so that all code is loaded; rounds in which all programs take turns: {options.rounds}. "
        "*seconds*: every set-up and all steps, without assembly (only DOLFINx and scikit-fem assemble themselves; "
        "load vectors are given to them, too), the median of the rounds; *slowest*: the largest. *factorisations*: of "
        "all steps, of matrices with about as many unknowns. *ratio*: seconds over those of this study in the same "
        "round, the median. *agreement*: the largest ‖u − v‖_V/‖u‖_V of all steps; beyond "
        f"{AGREEMENT:g} times are not compared. *blas*: what the process "
        "has loaded, all with one thread.",
        "Most of the ratio to programs that factorise for every guess of the contact zone is due to factorising once: "
        "those *condensed once* do so, too; what is left of their ratios is due to order, factorisation and passes.",
    ]
    write(options.out, "peers", pd.DataFrame(lines, columns=COLUMNS), "Peers", notes)
    print((options.out / "peers.md").read_text(encoding="utf-8"))


if __name__ == "__main__":
    main(sys.argv[1:])
