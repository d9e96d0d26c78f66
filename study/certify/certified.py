"""Makes the certificate of one level, from the solution u_h and the more accurate displacement ũ of ``study bound``."""

import json
import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from manufactured.data import Data
from manufactured.tensors import Array
from study.bound.discretisation import Discretisation
from study.bound.problem import BoundError
from study.bound.trajectory import Refined, compute, spline
from study.certify import checker
from study.certify.constants import constants, reference_element
from study.certify.statement import Twins, in_doubles, rational_mesh, statement
from study.certify.witnesses import COARSE, DISPLACEMENT, FINE, StressEncoder, bits_below, rounded
from study.fem.mesh import MeshFamily, Unstructured
from study.ledger.files import write_packed
from study.solve.evolution import Scheme

CONSTANTS_LEVEL = 12
"""Level of the mesh on which the constants C_Ω and C_Γ of the body are proved."""
BELOW, DAMPING = 1e-9, 32
"""How the monotonicity constant m that a certificate states is rounded.

It is reduced by the relative distance ``BELOW`` and then rounded down to ``DAMPING`` binary digits, so that round-off
does not make it larger than the true constant.
"""


def check_certifiable(data: Data) -> None:
    """Refuse a problem that the checker would refuse, before its certificate is computed.

    Raises:
        BoundError: the checker refuses the problem; the message gives its reason.
    """
    stated = statement(data)
    try:
        checker.conform(stated, checker.PROBLEM, "problem")
        checker.Problem(stated)
    except checker.RefusedError as refusal:
        raise BoundError(f"no certificate can be made of this problem: {refusal}") from refusal


def make_certificate(
    data: Data,
    family: MeshFamily,
    level: int,
    scheme: Scheme,
    steps: int,
    refined: Refined,
    progress: Callable[[float], object] = lambda time: None,
) -> dict[str, Any]:
    """Return the certificate of a problem on one level, as data that JSON can write.

    Args:
        data: the problem.
        family, level: the mesh family and the level of the mesh of u_h.
        scheme, steps: the time scheme of u_h, and the number of its time steps.
        refined: how the more accurate displacement ũ is computed.
        progress: a function that is called with each time for which the stress is finished.
    """
    stated = statement(data)
    problem = checker.Problem(stated)
    mesh = rational_mesh(family(data.body, level), data.body)
    exact = checker.Mesh.of(mesh, problem)
    coarse = Discretisation(data, in_doubles(exact))
    u_h, fine = compute(coarse, scheme, steps), refined.discretisation(coarse)
    for _ in range(refined.refinements):
        exact = exact.refined()
    twins, V = Twins(fine.mesh, exact), fine.displacements
    nodes = [node for _, node in refined.nodes(fine, u_h)]
    u = np.array([V.coefficients(node)[twins.nodes] for node in nodes])
    bits = bits_below(float(abs(u).max()), DISPLACEMENT)
    m = float(fine.moduli.values.min())
    damping = max(Fraction(math.floor(m * (1 - BELOW) * 2**DAMPING), 2**DAMPING), Fraction(0))
    mesh_of_constants = rational_mesh(Unstructured()(data.body, CONSTANTS_LEVEL), data.body)
    return {
        "format": checker.FORMAT,
        "level": level,
        "problem": stated,
        "constants": constants(mesh_of_constants, problem),
        "m": str(damping),
        "mesh": mesh,
        "refinements": refined.refinements,
        "computed": u_h.nodes.tolist(),
        "element": reference_element()[0],
        "displacement": {"bits": bits, "nodes": differences(rounded(exact, u, bits))},
        "stress": _rounded_stresses(StressEncoder(problem, twins, fine), fine, nodes, progress),
    }


def _rounded_stresses(
    encoder: StressEncoder, fine: Discretisation, nodes: list[Array], progress: Callable[[float], object]
) -> dict[str, Any]:
    """Compute the stress σ̃ of a certificate at all times and round it to integers.

    Between two knots of the spline ũ, σ̃ is a parabola in time. It is stored at every knot, and by one control point
    between any two knots. The result is the entry "stress" of the certificate.
    """
    T = Fraction(encoder.problem.T)
    k = T / (len(nodes) - 1)
    knots = [Fraction(0), *(k * Fraction(2 * j + 1, 2) for j in range(len(nodes) - 1)), T]
    times = np.linspace(0, float(T), len(nodes)).tolist()
    stresses: list[tuple[Array, Array]] = []
    for piece, (a, b) in zip(spline(zip(times, nodes, strict=True)), pairwise(knots), strict=True):
        first, last = piece.rate(end=False), piece.rate(end=True)
        controls = (piece.start, first), (piece.control, (first + last) / 2), (piece.end, last)
        for j, (load, (u, rate)) in enumerate(zip(encoder.loads(a, b), controls, strict=True)):
            if j or not stresses:  # the start of a piece is the end of the piece before
                target = fine.viscous(rate) + fine.elastic(u)
                stress = fine.nearest_stress(load, target, u)
                stresses.append((encoder.tractions(stress), encoder.inner(stress.values + target)))
        progress(float(b))
    # All stresses are computed before any is rounded, because the unit of rounding depends on the largest one.
    bits = bits_below(max(float(abs(tractions).max()) for tractions, _ in stresses), FINE)
    coarse = FINE - COARSE
    tractions, inner = zip(*(encoder.integers(*stress, bits, coarse) for stress in stresses), strict=True)
    return {"bits": bits, "coarse": coarse, "tractions": differences(tractions), "inner": differences(inner)}


def differences(rows: Sequence[list[int]]) -> list[list[int]]:
    """Return second differences in time of rows of integers, which have fewer digits and so make the file smaller."""
    for _ in range(2):
        rows = [rows[0], *([y - x for x, y in zip(p, q, strict=True)] for p, q in pairwise(rows))]
    return list(rows)


def write(path: Path, certificate: dict[str, Any]) -> Path:
    """Write a certificate to a file and return its path; equal certificates give identical files."""
    return write_packed(path, json.dumps(certificate, separators=(",", ":")))
