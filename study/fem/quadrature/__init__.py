"""Quadrature on the cells and facets of a mesh, adapted to where the solution is not smooth.

Cells crossed by a line along which the exact strain is singular or kinked for all times are cut along it, and the
rule is graded towards it; cells with a vertex at a singular point carry Duffy's rule, graded towards the point; all
other cells a standard rule. Cells that the fronts of one time meet can be cut along these (``sliced_rules``).
"""

from study.fem.quadrature.cells import cell_rules
from study.fem.quadrature.rough_cells import Line, rough_cells, sliced_rules
from study.fem.quadrature.rules import CellRule, FacetRule, facet_rule, simplex_rule

__all__ = [
    "CellRule",
    "FacetRule",
    "Line",
    "cell_rules",
    "facet_rule",
    "rough_cells",
    "simplex_rule",
    "sliced_rules",
]
