"""Spaces, discretisations and bounds for a body or data on the mesh of a family."""

from manufactured import Data, named
from study.bound.bounded import bounded_solution
from study.bound.discretisation import Discretisation
from study.bound.trajectory import Refined
from study.fem.mesh import OneDiagonal
from study.fem.space import Space
from study.solve.tableau import MIDPOINT

GRID = OneDiagonal()
USUAL = Refined(1, 1)


def space_on(body, n, family=GRID):
    """The space V^h of displacements on the mesh of a family."""
    return Space(family(body, n), body)


def discretised_on(data, n, family=GRID):
    """The discretisation of data on the mesh of a family."""
    return Discretisation(data, family(data.body, n))


def bounded_on(data, n, family=GRID, steps=2, trajectory=USUAL):
    """The displacement on the mesh of a family, computed by the midpoint rule, and its bounds."""
    return bounded_solution(data, None, family, n, MIDPOINT, steps, trajectory)


def data_of(name):
    """The data of a case of the catalogue."""
    return Data.of(named(name).solution)
