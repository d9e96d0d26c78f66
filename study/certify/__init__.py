"""Certificates: bounds of errors that hold as a theorem, floating point included; the command ``study certify``.

``statement`` writes a problem and its meshes in rational numbers. ``constants`` solves for the stresses of the element
and for the constants of the body, which certificates state and the checker verifies. ``witnesses`` rounds what
``study.bound`` computes. ``certified`` makes the certificate of one level. ``checker`` is a stand-alone program that
computes the bounds from the certificate alone: a proof depends on no other file.
"""
