"""FreeFEM: its mesh, matrix and solver, and a primal-dual active set as scripted in its documentation, by files alone.

Held displacements are set by ``tgv``; a face that is oblique to the axes takes a penalty along ν in place of it, so
this adapter states faces along the axes only.
"""

from __future__ import annotations

import re
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from common import CannotExpressError, debian_version, fixed, forces, voigt
from contact_judge import Task

CODE, VERSION = "FreeFEM", debian_version("freefem++")
SCRIPT = """
mesh Th = readmesh("task.msh");
fespace Vh(Th, [P1, P1]);
fespace Ch(Th, P0);
Ch c11, c12, c13, c22, c23, c33;
{ ifstream f("C.txt"); for (int k = 0; k < Th.nt; k++) {
  f >> c11[][k]; f >> c12[][k]; f >> c13[][k]; f >> c22[][k]; f >> c23[][k]; f >> c33[][k]; } }
macro g(u, v) (dy(u) + dx(v)) //
varf elastic([u, v], [p, q]) = int2d(Th)(
   (c11*dx(u) + c12*dy(v) + c13*g(u, v))*dx(p) + (c12*dx(u) + c22*dy(v) + c23*g(u, v))*dy(q)
 + (c13*dx(u) + c23*dy(v) + c33*g(u, v))*g(p, q));
matrix K = elastic(Vh, Vh);
// Which component of which vertex an unknown is, by interpolation of their numbers.
int n = Th.nv, steps;
fespace Ph(Th, P1);
Ph number;
for (int i = 0; i < n; i++) number[][i] = i;
Vh [vx, vy] = [number, number];
Vh [px, py] = [0, 1];
int[int] dof(2*n);
for (int i = 0; i < 2*n; i++) dof[2*lrint(vx[][i]) + lrint(px[][i])] = i;
real[int] mark(2*n), sign(2*n), b(2*n), u(2*n);
ifstream in("loads.txt");
in >> steps;
for (int i = 0; i < 2*n; i++) { in >> mark[dof[i]]; in >> sign[dof[i]]; }
ofstream out("u.txt");
out.precision(17);
real big = 1e30, scale = K.linfty;
u = 0;
for (int step = 0; step < steps; step++) {
  for (int i = 0; i < 2*n; i++) in >> b[dof[i]];
  real[int] held(2*n), lambda(2*n);
  held = 0; lambda = 0;
  int changed = 1, loops = 0;
  while (changed > 0 && loops < 60) {
    matrix S = K;
    real[int] d = K.diag, r = b;
    for (int i = 0; i < 2*n; i++) if (mark[i] == 1 || held[i] == 1) { d[i] = big; r[i] = 0; }
    S.diag = d;
    set(S, solver = sparsesolver);
    u = S^-1 * r;
    lambda = K * u; lambda -= b;
    changed = 0; loops++;
    for (int i = 0; i < 2*n; i++) if (mark[i] == 2) {
      real now = (-sign[i]*lambda[i]*held[i] + scale*sign[i]*u[i] > 0) ? 1 : 0;
      if (now != held[i]) { changed++; held[i] = now; } }
  }
  cout << "LOOPS " << loops << endl;
  for (int i = 0; i < 2*n; i++) out << u[dof[i]] << " ";
  out << endl;
}
"""


def run(task: Task, loads: list[np.ndarray]) -> tuple[np.ndarray, int]:
    """u for some nodal forces, (steps, n, d), and the active sets that it took."""
    if task.dim != 2:
        raise CannotExpressError("this adapter is for the plane")
    mark, sign = np.zeros(task.vertices.shape, int), np.zeros(task.vertices.shape)
    mark.ravel()[fixed(task)] = 1
    for normal, vertices, _ in task.pieces():
        axis = int(abs(normal).argmax())
        if abs(abs(normal[axis]) - 1) > 1e-12:
            raise CannotExpressError("this adapter holds displacements along the axes only")
        mark[vertices, axis], sign[vertices, axis] = 2, np.sign(normal[axis])
    C = voigt(task)
    with tempfile.TemporaryDirectory() as name:
        place = Path(name)
        lines = [f"{len(task.vertices)} {len(task.cells)} 0"]
        lines += [f"{x:.17g} {y:.17g} 0" for x, y in task.vertices]
        lines += [f"{a} {b} {c} 0" for a, b, c in task.cells + 1]
        (place / "task.msh").write_text("\n".join(lines) + "\n")
        np.savetxt(place / "C.txt", C[:, [0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2]], fmt="%.17g")
        head = [str(len(loads)), *(f"{a} {s:g}" for a, s in zip(mark.ravel(), sign.ravel(), strict=True))]
        (place / "loads.txt").write_text("\n".join([*head, *(f"{x:.17g}" for b in loads for x in b.ravel())]) + "\n")
        (place / "script.edp").write_text(SCRIPT)
        command = ["FreeFem++", "-nw", "-ne", "-v", "0", "script.edp"]
        done = subprocess.run(command, cwd=place, capture_output=True, text=True, check=False)
        if done.returncode:
            raise RuntimeError(done.stdout[-2000:] + done.stderr[-2000:])
        loops = sum(map(int, re.findall(r"LOOPS (\d+)", done.stdout)))
        return np.loadtxt(place / "u.txt", ndmin=2).reshape(-1, *task.vertices.shape), loops


def make(task: Task):
    """step(b, s0) ↦ u, one run of the program for each."""

    def step(load: np.ndarray, stress: np.ndarray) -> np.ndarray:
        found, loops = run(task, [forces(task, load, stress)])
        step.solves += loops
        return found[0]

    step.solves = 0
    return step


VARIANTS = {"scripted primal-dual active set": make}
