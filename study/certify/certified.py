"""Making the certificate of one level: u_h and ũ as ``study bound`` computes them, on rational meshes."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from manufactured.data import Data
from manufactured.tensors import Array
from study.bound.discretisation import Discretisation
from study.bound.problem import BoundError
from study.bound.trajectory import DiscreteSolution, Refined, compute, spline
from study.certify import checker
from study.certify.rational_mesh import Twins, in_doubles, rational_mesh
from study.certify.reference_element import columns
from study.certify.statement import statement
from study.certify.tensor_field import constants
from study.certify.witnesses import COARSE, DISPLACEMENT, FINE, AdmissibleRounding, Load, StressEncoder, bits_below
from study.fem.mesh import MeshFamily, Unstructured
from study.ledger.files import write_packed
from study.solve.evolution import Scheme

CONSTANTS_LEVEL = 12
"""Level of the mesh on which the constants of the body are proved."""
BELOW, DAMPING = 1e-9, 32
"""Relative distance of the m that is proved from the eigenvalue, and its bits after the point."""


@dataclass(frozen=True, eq=False)
class Making:
    """The problem and the parts of its certificates that all levels share."""

    data: Data
    family: MeshFamily
    scheme: Scheme
    refined: Refined

    def check(self) -> None:
        """Refuse a problem that the checker would refuse, before time is spent: BoundError."""
        stated = statement(self.data)
        try:
            checker.conform(stated, checker.PROBLEM, "problem")
            checker.Problem(stated)
        except checker.RefusedError as refusal:
            raise BoundError(f"no certificate can be made of this problem: {refusal}") from refusal

    def certificate(
        self, level: int, steps: int, progress: Callable[[float], object] = lambda time: None
    ) -> dict[str, Any]:
        """The certificate of one level."""
        stated = statement(self.data)
        problem = checker.Problem(stated)
        mesh = rational_mesh(self.family(self.data.body, level), self.data.body)
        exact = checker.Mesh.of(mesh, problem)
        coarse = Discretisation(self.data, in_doubles(exact))
        computed = compute(coarse, self.scheme, steps)
        fine = self.refined.discretisation(coarse)
        for _ in range(self.refined.refinements):
            exact = exact.refined()
        twins = Twins(fine.mesh, exact)
        least = rational_mesh(Unstructured()(self.data.body, CONSTANTS_LEVEL), self.data.body)
        nodes = [node for _, node in self.refined.nodes(fine, computed)]
        return {
            "format": checker.FORMAT,
            "level": level,
            "problem": stated,
            "constants": constants(least, problem),
            "m": str(_damping(fine)),
            "mesh": mesh,
            "refinements": self.refined.refinements,
            "computed": _nodal(computed),
            "element": columns(),
            **_rounded(problem, twins, fine, nodes, progress),
        }


def _damping(fine: Discretisation) -> Fraction:
    m = float(fine.moduli.values.min())
    return max(Fraction(math.floor(m * (1 - BELOW) * 2**DAMPING), 2**DAMPING), Fraction(0))


def _nodal(computed: DiscreteSolution) -> list[list[float]]:
    """The doubles of u_h, in the numbers of its mesh."""
    return [computed.space.nodal(u).T.ravel().tolist() for u in computed.nodes]


def _rounded(
    problem: checker.Problem,
    twins: Twins,
    fine: Discretisation,
    nodes: list[Array],
    progress: Callable[[float], object],
) -> dict[str, Any]:
    """ũ and σ̃."""
    V, exact = fine.displacements, twins.exact
    order = np.concatenate([twins.vertices, V.mesh.p.shape[1] + twins.edges])
    bits = bits_below(max(float(abs(u).max()) for u in nodes), DISPLACEMENT)
    rounding = AdmissibleRounding(exact, bits)
    displacement = {"bits": bits, "nodes": differences([rounding(V.coefficients(u)[order]) for u in nodes])}
    stress = _stresses(problem, twins, fine, nodes, progress)
    return {"displacement": displacement, "stress": stress}


def _stresses(
    problem: checker.Problem,
    twins: Twins,
    fine: Discretisation,
    nodes: list[Array],
    progress: Callable[[float], object],
) -> dict[str, Any]:
    """σ̃ at the knots and its control points between them, in turns."""
    encoder = StressEncoder(problem, twins, fine)
    # The unit is found when all stresses are known.
    kept = list(_found(encoder, fine, nodes, progress))
    largest = max(float(abs(encoder.tractions(stress)).max()) for stress, _ in kept)
    bits = bits_below(largest, FINE)
    coarse = FINE - COARSE
    numbers = [encoder.numbers(stress, load, bits, coarse) for stress, load in kept]
    return {
        "bits": bits,
        "coarse": coarse,
        "tractions": differences([tractions for tractions, _ in numbers]),
        "inner": differences([inner for _, inner in numbers]),
    }


def _found(
    encoder: StressEncoder, fine: Discretisation, nodes: list[Array], progress: Callable[[float], object]
) -> Iterator[tuple[Array, Load]]:
    """(σ̃ on cells, f̃) at knots and control points."""
    T = encoder.problem.T
    k = T / (len(nodes) - 1)
    knots = [Fraction(0), *(k * Fraction(2 * j + 1, 2) for j in range(len(nodes) - 1)), T]
    steps = [float(t) for t in np.linspace(0, float(T), len(nodes))]

    def one(load: Load, u: Array, rate: Array) -> tuple[Array, Load]:
        target = fine.viscous(rate) + fine.elastic(u)
        stress = fine.nearest_stress(encoder.study_loads(load), target, u).values + target
        return encoder.bernstein(stress), load

    for j, piece in enumerate(spline(zip(steps, nodes, strict=True))):
        first, last = piece.rate(end=False), piece.rate(end=True)
        start, control, end = encoder.loads(knots[j], knots[j + 1])
        if not j:
            yield one(start, piece.start, first)
        yield one(control, piece.control, (first + last) / 2)
        yield one(end, piece.end, last)
        progress(float(knots[j + 1]))


def differences(rows: list[list[int]]) -> list[list[int]]:
    """Second differences in time, which are shorter."""
    for _ in range(2):
        rows = [rows[0], *([y - x for x, y in zip(p, q, strict=True)] for p, q in pairwise(rows))]
    return rows


def write(path: Path, certificate: dict[str, Any]) -> Path:
    """Write a certificate; equal ones are equal files."""
    return write_packed(path, json.dumps(certificate, separators=(",", ":")))
