"""Certificates: bounds of errors that hold as a theorem, floating point included; the command ``study certify``.

``statement`` writes a problem in rational numbers, ``rational_mesh`` its meshes; ``witnesses`` rounds what is found by
``study.bound``; ``reference_element`` solves for stresses of the element, ``tensor_field`` for constants of the body,
both of which certificates state and the checker verifies. ``checker`` is a program of its own that computes the
bounds from the certificate alone; nothing that is trusted lies outside it.
"""
