"""A small contact solver in NumPy and its judgement; replace the body of ``make`` by your solver.

study export lift-and-land --family one-diagonal --levels 4 8 --out tasks
python examples/codes/my_code.py
"""

from pathlib import Path

import numpy as np
from contact_judge import answer, assess, read_tasks, table
from scipy.optimize import lsq_linear


def make(task):
    """Return a solver of one problem: (nodal forces, initial stress) ↦ displacements of the n vertices, (n, 2)."""
    n, free = len(task.vertices), np.ones(task.vertices.shape, bool)
    free[task.clamped] = False
    lower = np.full((n, 2), -np.inf)
    for _, vertices, _ in task.pieces():
        lower[vertices, 1] = 0  # the foundation of this case is the line x2 = 0
    # The forces that belong to a unit displacement of each free degree of freedom are the rows of the stiffness matrix.
    units = np.eye(2 * n).reshape(-1, n, 2)[free.ravel()]
    K = [task.internal(np.einsum("cij,cj->ci", task.stiffness, task.strain(v)))[free] for v in units]
    L = np.linalg.cholesky(K)

    def solve(load, stress):
        u, b = np.zeros((n, 2)), (load - task.internal(stress))[free]
        u[free] = lsq_linear(L.T, np.linalg.solve(L, b), (lower[free], np.inf), "bvls").x
        return u

    return solve


tasks = read_tasks(Path("tasks"))
print(table(assess(tasks, {task.name: answer(task, make) for task in tasks})))
