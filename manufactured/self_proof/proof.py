"""The self-proof of an exact solution, which checks all conditions of Problem 2.1.

The checks for heterogeneous materials stand here: continuous tractions where a factor jumps, and the bounds of the
factors.
"""

import numpy as np

from manufactured.arguments import Count, Natural, checked
from manufactured.exact import ExactSolution
from manufactured.self_proof.boundary_conditions import clamped_and_loaded, contact
from manufactured.self_proof.contact_zone import continuity, signs
from manufactured.self_proof.finding import Finding, SelfProofError, norms, worst
from manufactured.self_proof.interior import equilibrium, history, kinematics
from manufactured.tensors import Array, traction


def traction_at_jumps(solution: ExactSolution, rng: np.random.Generator, count: int, instants: Array) -> list[Finding]:
    """Check that the traction is continuous where a material factor jumps; otherwise Div σ would not be a function.

    This is checked at random points of each line or plane with a jump and at the times ``instants``.
    """
    findings = []
    inside = solution.body.sample(rng, 50 * count)
    size = solution.body.extent
    for direction, offset in solution.law.steps:
        normal = np.array(direction)
        onto = inside - np.multiply.outer(normal, normal @ inside - offset)
        x = onto[:, solution.body.contains(onto)][:, :count]
        sides = [solution.at(x + side * 1e-12 * size * normal[:, None]) for side in (-1, 1)]
        forces = [[traction(fields.stress(t), normal) for t in instants] for fields in sides]
        scale = norms([sides[0].stress(t) for t in instants])
        defect = norms(np.subtract(forces[0], forces[1]))
        findings.append(worst(f"(2.2) σν continuous on {direction}·x = {offset:g}", x, instants, defect, scale))
    return findings


def bounds_of_factors(solution: ExactSolution, rng: np.random.Generator, count: int) -> list[Finding]:
    """Check at random points that the factors of A and G lie between their stated bounds.

    The constants m_A and L_G are computed from these bounds.
    """
    x = solution.body.sample(rng, 50 * count)
    findings = []
    for number, name, factor in (("(3.1)", "A", solution.law.A.factor), ("(3.2)", "G", solution.law.G.factor)):
        value = factor(x)
        outside = np.maximum(np.maximum(factor.low - value, value - factor.high), 0)
        findings.append(worst(f"{number} bounds of the factor of {name}", x, np.zeros(1), outside[None], value[None]))
    return findings


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
