"""The self-proof of an exact solution, which checks all conditions of Problem 2.1."""

import numpy as np

from manufactured.arguments import Count, Natural, checked
from manufactured.exact import ExactSolution
from manufactured.self_proof.boundary_conditions import clamped_and_loaded, contact
from manufactured.self_proof.coefficients import bounds_of_factors, traction_at_jumps
from manufactured.self_proof.contact_zone import continuity, signs
from manufactured.self_proof.finding import Finding, SelfProofError
from manufactured.self_proof.interior import equilibrium, history, kinematics


@checked(ValueError)
def prove(solution: ExactSolution, name: str, seed: Natural = 0) -> list[Finding]:
    """Check every condition of Problem 2.1 and return the largest violation of each; raise an error if one is too
    large.

    >>> from manufactured import named
    >>> all(finding.passes for finding in prove(named("full-contact").solution, "full-contact"))
    True

    Raises:
        SelfProofError: a condition is violated; the message lists all violated conditions with point and time.
    """
    findings = examine(solution, seed)
    failed = [finding for finding in findings if not finding.passes]
    if failed:
        raise SelfProofError(name, failed)
    return findings


@checked(ValueError)
def examine(solution: ExactSolution, seed: Natural = 0, points: Count = 40, times: Count = 8) -> list[Finding]:
    """Return the largest violation of every condition of Problem 2.1 at random points and times.

    Args:
        solution: the exact solution.
        seed: the seed of the random numbers.
        points: the number of points in the body and on each part of its boundary.
        times: the number of times.
    """
    rng = np.random.default_rng(seed)
    instants = np.sort(rng.uniform(0, solution.body.T, times))
    inside = solution.body.sample(rng, points)
    return [
        *kinematics(solution, inside, instants),
        history(solution, inside),
        equilibrium(solution, inside, instants),
        *clamped_and_loaded(solution, rng, points, instants),
        *contact(solution, rng, points, instants),
        *signs(solution),
        *continuity(solution, rng),
        *traction_at_jumps(solution, rng, points, instants),
        *bounds_of_factors(solution, rng, points),
    ]
