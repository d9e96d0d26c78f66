"""Solve the problem of clip.py in README.md with scikit-fem and write the displacement into mine.npz."""

import numpy as np
from scipy.optimize import lsq_linear
from skfem import Basis, ElementTriP1, ElementVector, FacetBasis, LinearForm, MeshTri
from skfem.models.elasticity import lame_parameters, linear_elasticity

corners = np.array([(0, 0), (1, 0), (2, 0), (2, 1), (1, 1), (0, 1), (1, 2), (0, 2)], dtype=float).T
mesh = MeshTri(corners, np.array([(0, 1, 4), (0, 4, 5), (1, 2, 3), (1, 3, 4), (5, 4, 6), (5, 6, 7)]).T).refined(3)
basis = Basis(mesh, ElementVector(ElementTriP1()), intorder=2)
foot = FacetBasis(mesh, basis.elem, facets=mesh.facets_satisfying(lambda x: (x[1] == 1) & (x[0] > 1)))
E, nu = 200.0, 0.3
lam, mu = lame_parameters(E, nu)
K = linear_elasticity(2 * mu * lam / (lam + 2 * mu), mu).assemble(basis)  # plane stress
b = LinearForm(lambda v, w: -v[1]).assemble(basis) + LinearForm(lambda v, w: -4 * v[1]).assemble(foot)
lower = np.full(basis.N, -np.inf)
lower[basis.nodal_dofs[1, mesh.p[1] == 0]] = 0
free = np.setdiff1d(np.arange(basis.N), basis.get_dofs(lambda x: x[1] == 2).all())
L = np.linalg.cholesky(K[free][:, free].toarray())
u = np.zeros(basis.N)
u[free] = lsq_linear(L.T, np.linalg.solve(L, b[free]), (lower[free], np.inf), "bvls").x
np.savez("mine.npz", points=mesh.p.T, triangles=mesh.t.T, u=u[basis.nodal_dofs].T)
