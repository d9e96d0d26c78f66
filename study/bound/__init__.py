"""Guaranteed bounds of ‖u(t) − u_h(t)‖_V for anybody's data, without the exact solution: the command ``study bound``.

From the bottom to the top, each file uses files above it in this list only:

``problem`` has constants of law and body and refuses problems that cannot be bounded; ``ranges`` bounds derivatives of
formulas; ``remainders`` bounds what samples of the data do not see; ``discretisation`` has the spaces on one mesh;
``trajectory`` computes u_h and a better displacement ũ; ``growth`` is the growth of the bound over one time step;
``terms`` has each term of the bound of ‖u − ũ‖_V; ``enclosing`` bounds the error of u_h from both sides; ``static``
does so without viscosity and time; ``bounded`` does this on each level, prints and writes; ``fields`` reads and
``given`` checks and bounds displacements of other programs; ``adaptive`` refines where the bound comes from.
"""
