"""Convergence tests of the elements of scikit-fem: python -m pytest examples/elements

−Δu = f is solved on refined meshes, with u = sin πx, or sin πx sin πy, or sin πx sin πy sin πz. The errors in L² and H¹
must have the orders k + 1 and k, where k is the degree of the element.
"""

import math

import numpy as np
import pytest
import skfem as fem
from skfem.helpers import dot, grad

from convergence_orders import ConvergenceTable

ELEMENTS = {
    "ElementLineP1": (fem.MeshLine, 1, [8, 16, 32, 64]),
    "ElementLineP2": (fem.MeshLine, 2, [4, 8, 16, 32]),
    "ElementTriP1": (fem.MeshTri, 1, [4, 8, 16, 32]),
    "ElementTriP2": (fem.MeshTri, 2, [4, 8, 16, 32]),
    "ElementTriP3": (fem.MeshTri, 3, [2, 4, 8, 16]),
    "ElementTriCR": (fem.MeshTri, 1, [4, 8, 16, 32]),
    "ElementTriP1B": (fem.MeshTri, 1, [4, 8, 16, 32]),
    "ElementQuad1": (fem.MeshQuad, 1, [4, 8, 16, 32]),
    "ElementQuad2": (fem.MeshQuad, 2, [2, 4, 8, 16]),
    "ElementTetP1": (fem.MeshTet, 1, [4, 6, 8, 12]),
    "ElementHex1": (fem.MeshHex, 1, [2, 4, 8, 16]),
}
"""Name of an element ↦ type of the mesh, degree of the polynomials, and numbers of cells along a side."""


def exact(x: np.ndarray) -> np.ndarray:
    return np.prod(np.sin(math.pi * x), axis=0)


def exact_gradient(x: np.ndarray) -> np.ndarray:
    def factors(i: int) -> list[np.ndarray]:
        return [math.pi * np.cos(math.pi * x[j]) if i == j else np.sin(math.pi * x[j]) for j in range(len(x))]

    return np.array([np.prod(factors(i), axis=0) for i in range(len(x))])


@fem.BilinearForm
def stiffness(u, v, w):
    return dot(grad(u), grad(v))


@fem.LinearForm
def load(v, w):
    return len(w.x) * math.pi**2 * exact(w.x) * v


@fem.Functional
def squared_error(w):
    return (w.u - exact(w.x)) ** 2


@fem.Functional
def squared_error_of_gradient(w):
    difference = grad(w.u) - exact_gradient(w.x)
    return dot(difference, difference)


def errors(mesh: fem.Mesh, element: fem.Element) -> dict[str, float]:
    """Solve on a mesh; return the mesh size and the errors."""
    basis = fem.Basis(mesh, element, intorder=7)
    solution = fem.solve(*fem.condense(stiffness.assemble(basis), load.assemble(basis), D=basis.get_dofs()))
    u = basis.interpolate(solution)
    return {
        "h": float(mesh.param()),
        "dofs": basis.N,
        "L2": math.sqrt(squared_error.assemble(basis, u=u)),
        "H1": math.sqrt(squared_error_of_gradient.assemble(basis, u=u)),
    }


@pytest.mark.parametrize("name", ELEMENTS)
def test_the_errors_of_an_element_have_the_orders_of_theory(name: str, convergence_orders) -> None:
    family, degree, cells = ELEMENTS[name]
    table = ConvergenceTable()
    for n in cells:
        points = np.linspace(0, 1, n + 1)
        mesh = family(points) if family is fem.MeshLine else family.init_tensor(*[points] * family.elem.refdom.dim())
        table.add(**errors(mesh, getattr(fem, name)()))
    print(table)
    convergence_orders.table(table, name, L2=degree + 1, H1=degree)
