"""Reduced-space semismooth Newton of PETSc (SNESVI) with a direct solver for quadratic problems with bounds.

S. J. Benson, T. S. Munson, Flexible complementarity solvers for large-scale applications, Optim. Methods Softw. 21
(2006) 155–168.
"""

import numpy as np
from petsc4py import PETSc

TOLERANCE = 1e-10
"""Of the residual, relative to the right side, as this study asks of itself; no other criterion ends an iteration."""


def version():
    return "PETSc " + ".".join(map(str, PETSc.Sys.getVersion()))


class BoundedQuadratic:
    """b ↦ the minimiser of ½ vᵀSv − bᵀv within bounds; starts from the last one.

    Every active set is factorised anew by MUMPS: "cholesky" or "lu"; ``factorisations`` counts them.
    """

    def __init__(self, S, lower, upper, start, factorisation):
        self.S, self.b, self.x = S, S.createVecLeft(), S.createVecRight()
        self.factorisations = 0
        self.x.array[:] = start
        self.snes = PETSc.SNES().create(PETSc.COMM_SELF)
        self.snes.setFunction(self._residual, S.createVecLeft())
        self.snes.setJacobian(lambda snes, x, J, P: None, S, S)
        self.snes.setType("vinewtonrsls")
        limits = [S.createVecRight() for _ in range(2)]
        for vector, values in zip(limits, (lower, upper), strict=True):
            vector.array[:] = np.clip(values, PETSc.NINFINITY, PETSc.INFINITY)
        self.snes.setVariableBounds(*limits)
        PETSc.Options()["snes_linesearch_type"] = "basic"
        self.snes.setFromOptions()
        ksp = self.snes.getKSP()
        ksp.setType("preonly")
        ksp.getPC().setType(factorisation)
        ksp.getPC().setFactorSolverType("mumps")

    def _residual(self, snes, x, f):
        self.S.mult(x, f)
        f.axpy(-1, self.b)

    def __call__(self, b):
        self.b.array[:] = b
        self.snes.setTolerances(rtol=0, atol=TOLERANCE * self.b.norm(), stol=0, max_it=100)
        self.snes.solve(None, self.x)
        self.factorisations += self.snes.getIterationNumber()
        reason = self.snes.getConvergedReason()
        if reason < 0:
            raise RuntimeError(f"SNESVI stopped with reason {reason} after {self.snes.getIterationNumber()} iterations")
        return self.x.array.copy()


def matrix(csr):
    """A PETSc matrix from a SciPy one."""
    return PETSc.Mat().createAIJ(csr.shape, csr=(csr.indptr, csr.indices, csr.data), comm=PETSc.COMM_SELF)
