"""Guaranteed bounds of the error ‖u(t) − u_h(t)‖_V for given data, without the exact solution: ``study bound``.

Each file uses only files that stand above it in this list:

* ``problem`` computes constants of law and body, and refuses problems for which no error bound can be computed;
* ``ranges`` bounds derivatives of formulas, and refuses initial displacements that jump;
* ``remainders`` bounds how much the data can change between the points at which they are sampled;
* ``discretisation`` makes the finite element spaces on one mesh;
* ``trajectory`` computes the displacement u_h and a more accurate displacement ũ;
* ``terms`` computes each term of the bound of ‖u − ũ‖_V, and its growth in one time step;
* ``enclosing`` bounds the error of u_h from both sides, also for static problems;
* ``bounded`` runs the computation on each level, and writes the results;
* ``fields`` reads displacements of other programs, and ``given`` checks and bounds them;
* ``adaptive`` refines the cells and time steps that contribute most to the bound.
"""
