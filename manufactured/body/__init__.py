"""The body Ω, its boundary parts Γ1, Γ2, Γ3 = ∪ Γ3,i and the time interval [0, T].

A body is a polygon bounded by segments (d = 2) or a polyhedron bounded by flat convex polygons (d = 3).
"""

from manufactured.body.constructors import box, polygon, unit_square
from manufactured.body.domain import Body
from manufactured.body.part import BodyError, Kind, Part

__all__ = ["Body", "BodyError", "Kind", "Part", "box", "polygon", "unit_square"]
