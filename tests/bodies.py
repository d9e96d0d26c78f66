"""Bodies in the plane and laws, for tests that need any."""

from manufactured import FrobeniusBall, KelvinVoigt, Kind, Yield, isotropic, polygon

CONTACT = Kind.CONTACT
LOADED = Kind.LOADED
CLAMPED = Kind.CLAMPED
ROLLER = Kind.ROLLER
SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
SIDES = [CONTACT, LOADED, CLAMPED, LOADED]
ANGLE = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
"""Corners and sides of the unit square, and corners of three unit squares with a re-entrant corner."""
TURNED = polygon([(0, 0), (0.8, 0.6), (0.2, 1.4), (-0.6, 0.8)], [CONTACT, LOADED, CLAMPED, CONTACT])
"""A square with two slanted pieces of Γ3, which share a vertex and so the two unknowns there."""
LAW = KelvinVoigt(isotropic(1, 0.5), isotropic(2, 3), "linear")
YIELDS = KelvinVoigt(isotropic(1, 0.5), Yield(2.0, FrobeniusBall(0.1)), "yields")
