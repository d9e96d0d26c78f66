"""Bodies without contact: linear elasticity and viscoelasticity as engineers compute them, with known solutions.

The solution is a polynomial w with w = 0 on the clamped side; the loads follow from it. In the static case its
stress has degree 2 and so lies in the space of stresses of degree 3. The theorem of Prager and Synge says

    ‖σ̃ − Gε(u_h)‖² = ‖σ − Gε(u_h)‖² + ‖σ̃ − σ‖²

in the norm of G⁻¹, so that the smallest left side belongs to σ̃ = σ: the upper bound has to equal the error.
"""

from __future__ import annotations

import math
from pathlib import Path

import meshio
import numpy as np
import pandas as pd
import pytest
import sympy as sp

from manufactured import BodyError, Data, ExactSolution, KelvinVoigt, Kind, isotropic, plane_stress, polygon, static
from manufactured.factor import x1, x2
from manufactured.law import Linear
from manufactured.symbols import t
from study.bound.bounded import BoundedSolution, bounded_solution
from study.bound.discretisation import Discretisation
from study.bound.enclosing import enclose, squared_distances
from study.bound.given import bound_displacement
from study.bound.trajectory import Refined, SmoothedInTime, compute
from study.cli.main import main
from study.fem.mesh import Shaken
from study.solve.tableau import MIDPOINT

LOADED, CLAMPED = Kind.LOADED, Kind.CLAMPED
CORNERS = {"upright": [(0, 0), (1, 0), (1, 1), (0, 1)], "slanted": [(0.2, -0.1), (1.3, 0.2), (1, 1), (0, 1)]}
W = ((1 - x2) * (x1 * x2 + x1), (1 - x2) * (x1**2 - 2 * x2))
"""The displacement, cubic and 0 on the side x2 = 1."""


def body(shape: str):
    """Return a quadrilateral that is clamped on top and touches nothing."""
    return polygon(CORNERS[shape], [LOADED, LOADED, CLAMPED, LOADED])


def strain(w) -> list[sp.Expr]:
    """Return ε(w) in Mandel's order."""
    return [sp.diff(w[0], x1), sp.diff(w[1], x2), (sp.diff(w[0], x2) + sp.diff(w[1], x1)) / sp.sqrt(2)]


def stress(C: Linear, w) -> sp.Matrix:
    s = sp.Matrix(C.matrix) * sp.Matrix(strain(w))
    return sp.Matrix([[s[0], s[2] / sp.sqrt(2)], [s[2] / sp.sqrt(2), s[1]]])


def loads(sigma: sp.Matrix, shape: str):
    """Return f_0 = −Div σ and f_2 = σν on all sides but the clamped one."""
    f0 = [-sp.diff(sigma[i, 0], x1) - sp.diff(sigma[i, 1], x2) for i in range(2)]
    parts = enumerate(body(shape).parts)
    return f0, {i: list(sigma * sp.Matrix(part.normal)) for i, part in parts if part.kind is LOADED}


def strain_at(w, factor: float = 1.0):
    """Return the function from points (2, ...) to ε(w), (3, ...)."""
    function = sp.lambdify((x1, x2), strain(w), "numpy")
    return lambda x: factor * np.array([np.broadcast_to(one, x.shape[1:]) for one in function(*x)], dtype=float)


def elastic(shape: str):
    G = plane_stress(E=2.0, nu=0.3)
    return static(body(shape), G, *loads(stress(G, W), shape))


def check_static(data: Data, found: BoundedSolution, least: float) -> None:
    """Assert that the error is the upper bound from u_h alone, and above the lower bound, which has a least part."""
    coarse = Discretisation(data, Shaken()(data.body, 2))
    error = math.sqrt(squared_distances(coarse, strain_at(W), found.computed.on(coarse)(0.0), ()).sum())
    assert found.plain.highest == pytest.approx(error, rel=1e-8)
    assert least * error <= found.enclosure.lowest <= error <= found.enclosure.highest
    assert found.enclosure.evidence.kind == "guaranteed"


@pytest.mark.parametrize("shape", CORNERS)
def test_the_upper_bound_of_a_static_displacement_equals_its_error(shape: str) -> None:
    data = elastic(shape)
    found = bounded_solution(data, None, Shaken(), 2, MIDPOINT, 1, Refined(1, 1))
    check_static(data, found, 0.3)
    assert found.remarks == ()


@pytest.mark.parametrize("factor", [1.0, 0.9, -1.0])
def test_any_displacement_of_a_static_body_without_contact_is_enclosed(factor: float) -> None:
    """The nodal values of W on linear triangles, and wrong ones: too small by a tenth, and of the wrong sign."""
    data = elastic("slanted")
    mesh = Shaken()(data.body, 2)
    nodal = factor * np.array([sp.lambdify((x1, x2), one, "numpy")(*mesh.p) for one in W]).T
    check_static(data, bound_displacement(data, mesh.p.T, mesh.t.T, None, nodal, refine=0), 0.0)


@pytest.mark.parametrize("shape", ["upright", pytest.param("slanted", marks=pytest.mark.slow)])
def test_viscoelastic_errors_are_enclosed_at_all_times(shape: str) -> None:
    A, G = isotropic(1.0, 0.5), isotropic(2.0, 3.0)
    grown = t + t**2
    sigma = sp.diff(grown, t) * stress(A, W) + grown * stress(G, W)
    data = Data.formulas(body(shape), KelvinVoigt(A, G, "linear"), *loads(sigma, shape))
    coarse = Discretisation(data, Shaken()(data.body, 2))
    u_h = compute(coarse, MIDPOINT, 2)

    def error(time: float, _: np.ndarray) -> float:
        exact = strain_at(W, time + time**2)
        return math.sqrt(squared_distances(coarse, exact, u_h.on(coarse)(time), ()).sum())

    alone, found = (enclose(coarse, u_h, way, error) for way in (SmoothedInTime(), Refined(1, 2)))
    assert alone.contains
    assert found.contains
    assert found.lower[-1] > 0.3 * found.error[-1]
    assert found.evidence.kind == "guaranteed"


def test_an_exact_solution_of_the_contact_problem_needs_a_contact_side() -> None:
    with pytest.raises(BodyError, match="no part Γ3"):
        ExactSolution(body("upright"), KelvinVoigt(isotropic(1.0, 0.5), isotropic(2.0, 3.0), "linear"), ())


PLATE = """
from manufactured import Kind, plane_stress, polygon, static, x2

body = polygon([(0, 0), (1, 0), (1, 1), (0, 1)], [Kind.LOADED, Kind.LOADED, Kind.CLAMPED, Kind.LOADED])
plate = static(body, plane_stress(E=2.0, nu=0.3), f0=(0, -1), f2={1: (x2, 0)})
"""


def test_the_command_bounds_a_vtu_file_without_times_and_adapts(tmp_path: Path, capsys) -> None:
    (tmp_path / "plate.py").write_text(PLATE)
    plate, out = f"{tmp_path}/plate.py:plate", tmp_path / "out"
    assert main(["bound", plate, "--levels", "2", "--adapt", "40%", "--out", str(out)]) == 0
    assert "the tolerance is reached" in " ".join(capsys.readouterr().out.split())
    with np.load(out / "plate" / "adapted-0.npz") as found:
        p, cells, u = found["p"].T, found["t"].T, found["u"][0].T
    file = tmp_path / "mine.vtu"
    meshio.Mesh(p, [("triangle", cells)], point_data={"displacement": np.pad(u, ((0, 0), (0, 1)))}).write(file)
    assert main(["bound", plate, "--displacement", str(file), "--out", str(out)]) == 0
    printed = capsys.readouterr().out
    assert "weighted by the elasticity G" in printed
    assert "no figure" in printed
    told = printed.split("\n\n", 1)[1]
    assert "level" not in told
    assert "t = " not in told
    assert max(map(len, told.splitlines())) <= 110
    assert max(map(len, told.strip().split("\n\n")[-1].splitlines())) <= 80
    row, adapted = pd.read_csv(out / "plate-mine" / "levels.csv").iloc[0], pd.read_csv(out / "plate" / "adaptive.csv")
    assert row["plain"] == pytest.approx(adapted["bound"].iloc[0], rel=1e-6)
