"""Certificates: bounds of errors that hold as a theorem, floating point included; the command ``study certify``.

``statement`` writes a problem in rational numbers, ``rational_mesh`` its meshes; ``witnesses`` rounds what is found by
``study.bound``; ``tensor_field`` proves constants of the body. ``checker`` is a program of its own that computes the
bounds from the certificate alone; nothing that is trusted lies outside it.
"""
