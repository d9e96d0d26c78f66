"""The body Ω, its boundary parts Γ1, Γ2, Γ3 = ∪ Γ3,i and the time interval [0, T].

The dimension d ∈ {2, 3} is that of the corners: a polygon bounded by segments, or a polyhedron bounded by flat
convex polygons.
"""

from manufactured.body.constructors import box, polygon, unit_square
from manufactured.body.domain import Body
from manufactured.body.part import BodyError, Kind, Part

__all__ = ["Body", "BodyError", "Kind", "Part", "box", "polygon", "unit_square"]
