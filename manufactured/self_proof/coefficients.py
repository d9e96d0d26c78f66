"""Checks for heterogeneous materials: continuous tractions where a factor jumps, and the bounds of the factors."""

import numpy as np

from manufactured.exact import ExactSolution
from manufactured.self_proof.finding import Finding, norms, worst
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
