"""The self-proof: a case must satisfy every condition of the contact problem before it is used.

At random points and times, the exact solution must satisfy (2.1)–(2.6), u(t) ∈ K and its stated contact zone up to
rounding. Derivatives are taken by the complex step, independently of the symbolic derivatives in the solution.
"""

from manufactured.self_proof.finding import Finding, SelfProofError
from manufactured.self_proof.proof import examine, prove

__all__ = ["Finding", "SelfProofError", "examine", "prove"]
