"""A case proves itself before it is used.

At random points and times, with derivatives taken by the complex step (independent of the symbolic
ones the solution is made of), the exact solution must satisfy (2.1)–(2.6), u(t) ∈ K and its stated
contact zone to round-off.
"""

from manufactured.self_proof.finding import Finding, SelfProofError
from manufactured.self_proof.proof import examine, prove

__all__ = ["Finding", "SelfProofError", "examine", "prove"]
