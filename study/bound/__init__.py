"""Guaranteed bounds of ‖u(t) − u_h(t)‖_V for given data, without the exact solution: the command ``study bound``.

Each file uses only files that stand above it in this list:

``problem`` has constants of law and body and refuses problems that cannot be bounded; ``ranges`` bounds derivatives of
formulas; ``remainders`` bounds how much the data can differ from their samples; ``discretisation`` has the spaces on
one mesh; ``trajectory`` computes u_h and a more accurate displacement ũ; ``growth`` bounds the growth of ‖u − ũ‖_V over
one time step; ``terms`` computes each term of that bound; ``enclosing`` bounds the error of u_h from both sides;
``static`` does so without viscosity and time; ``bounded`` does this on each level, prints and writes; ``fields`` reads
and ``given`` checks and bounds displacements of other programs; ``adaptive`` refines the mesh cells and time steps that
contribute most to the bound.
"""
