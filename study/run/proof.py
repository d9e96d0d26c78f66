"""Self-proofs as jobs: before a case is measured, it is tested whether its solution is exact."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import cycle
from typing import Any

from manufactured.self_proof import SelfProofError, examine
from study.fem.naming import name_of, resolve
from study.run.executor import Pool, run_job, unfinished
from study.run.fingerprint import of_solution
from study.run.plan import Job
from study.run.store import Store
from study.statements.shared import estimates


@dataclass(frozen=True)
class Proof:
    """The self-proof of a case as a job; its result lists the violated equations and contact conditions.

    Attributes:
        case: the name of the case in the catalogue, or FILE.py:NAME.
    """

    case: str
    memory = estimates.BASE

    @property
    def key(self) -> str:
        """The name of the file in which the result is stored, without the ending."""
        return f"proof__{name_of(self.case)}"

    @property
    def cost(self) -> float:
        """The expected computing time in µs; solutions in 3D take longest."""
        return 10.0 ** (3 + resolve(self.case).solution.body.dim)

    def fingerprint(self) -> str:
        """Return the cache key of the result."""
        return of_solution(self.case)

    def run(self) -> Mapping[str, Any]:
        """Examine the solution; return the violated conditions under the key "violated"."""
        findings = examine(resolve(self.case).solution)
        return {"violated": [finding for finding in findings if not finding.passes]}


def prove(jobs: Iterable[Job], cases: Iterable[str], store: Store, pool: Pool) -> list[Proof]:
    """Test the solutions of the cases that occur in jobs, unless their proofs are stored.

    Returns:
        The new proofs. They are not stored yet, because the result directory may not be locked.

    Raises:
        SelfProofError: a solution violates an equation or a contact condition.
    """
    measured = {job.case for job in jobs}
    proofs = unfinished([Proof(case) for case in cases if case in measured], store)
    executors = cycle(pool.executors)
    futures = [next(executors).submit(run_job, proof) for proof in proofs]
    for proof, future in zip(proofs, futures, strict=True):
        if violated := future.result()["violated"]:
            raise SelfProofError(f"case {resolve(proof.case).name}", violated)
    return proofs


def save_proofs(proofs: Iterable[Proof], store: Store) -> None:
    """Store proofs that found no violation, so that later runs need not repeat them."""
    for proof in proofs:
        store.save(proof.key, proof.fingerprint(), {"violated": []})
