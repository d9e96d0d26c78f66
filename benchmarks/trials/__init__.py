"""Bounds of errors tried on problems whose solutions are known: random ones, and stiff and incompressible ones."""
