"""The self-proof of an exact solution: a check of every condition of the contact problem before it is used.

At random points and times, the solution must satisfy (2.1)–(2.6), lie in K and have the stated contact zone, up to
rounding. Derivatives are computed by the complex step, independently of the symbolic derivatives in the solution.
"""

from manufactured.self_proof.finding import Finding, SelfProofError
from manufactured.self_proof.proof import examine, prove

__all__ = ["Finding", "SelfProofError", "examine", "prove"]
