"""Convergence test of a DOLFINx program: python -m pytest examples/dolfinx

It needs Python 3.12 or newer: python -m pip install dolfinx-solver-real mpich pytest ./convergence_orders

−Δu = f is solved on the unit square with u = sin πx sin πy. The errors in L² and H¹ must have the orders k + 1 and k.
"""

import math

import numpy as np
import pytest

# The wheel of DOLFINx finds the library of MPI if mpi4py has loaded it.
pytest.importorskip("mpi4py.MPI", reason="mpi4py is not installed")
pytest.importorskip("dolfinx", reason="DOLFINx is not installed")

import ufl
from dolfinx import fem, mesh
from dolfinx.fem.petsc import LinearProblem
from mpi4py import MPI

from convergence_orders import ConvergenceTable

DIRECT = {"ksp_type": "preonly", "pc_type": "lu"}


def errors(cells: int, degree: int) -> dict[str, float]:
    """Solve with elements of a degree on a mesh with ``cells`` cells along a side; return mesh size and errors."""
    domain = mesh.create_unit_square(MPI.COMM_WORLD, cells, cells)
    space = fem.functionspace(domain, ("Lagrange", degree))
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    x = ufl.SpatialCoordinate(domain)
    exact = ufl.sin(math.pi * x[0]) * ufl.sin(math.pi * x[1])
    stiffness = ufl.inner(ufl.grad(u), ufl.grad(v)) * ufl.dx
    load = 2 * math.pi**2 * exact * v * ufl.dx

    domain.topology.create_connectivity(1, 2)
    boundary = mesh.exterior_facet_indices(domain.topology)
    fixed = fem.locate_dofs_topological(space, 1, boundary)
    zero = fem.dirichletbc(0.0, fixed, space)
    problem = LinearProblem(stiffness, load, bcs=[zero], petsc_options_prefix="poisson_", petsc_options=DIRECT)
    solution = problem.solve()

    difference = solution - exact
    squares = {"L2": difference**2, "H1": ufl.inner(ufl.grad(difference), ufl.grad(difference))}
    row = {"h": 1 / cells}
    for name, square in squares.items():
        local = fem.assemble_scalar(fem.form(square * ufl.dx(degree=8)))
        row[name] = math.sqrt(domain.comm.allreduce(np.real(local), op=MPI.SUM))
    return row


@pytest.mark.parametrize("degree", [1, 2])
def test_the_errors_have_the_orders_of_theory(degree: int, convergence_orders) -> None:
    table = ConvergenceTable()
    for cells in (4, 8, 16, 32):
        table.add(**errors(cells, degree))
    print(table)
    convergence_orders.table(table, f"P{degree}", L2=degree + 1, H1=degree)
