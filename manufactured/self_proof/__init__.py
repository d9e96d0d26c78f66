"""The self-proof of an exact solution: before it is used, every condition of the contact problem is checked.

At random points and times, the solution must satisfy the equations and inequalities (2.1)–(2.6), be admissible and have
the stated contact zone, up to rounding. Derivatives are computed by the complex step, independently of the symbolic
derivatives in the solution.
"""

from manufactured.self_proof.finding import Finding, SelfProofError
from manufactured.self_proof.proof import examine, prove

__all__ = ["Finding", "SelfProofError", "examine", "prove"]
