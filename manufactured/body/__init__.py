"""The body Ω of the contact problem, with its boundary parts and the time interval [0, T].

The boundary consists of the clamped part Γ1, the loaded part Γ2 and the contact part Γ3, which may have several pieces
Γ3,i. In 2D a body is a polygon bounded by segments, in 3D a polyhedron bounded by flat convex polygons.
"""

from manufactured.body.constructors import box, polygon, unit_square
from manufactured.body.domain import Body
from manufactured.body.part import BodyError, Kind, Part

__all__ = ["Body", "BodyError", "Kind", "Part", "box", "polygon", "unit_square"]
