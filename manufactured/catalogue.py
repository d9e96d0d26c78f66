"""The explicit list of cases."""

from __future__ import annotations

from functools import lru_cache

from manufactured.case import Case
from manufactured.cases import (
    advance_recede,
    bodies,
    corners,
    fixed_front,
    full_contact,
    lift_and_land,
    loads,
    materials,
    merging_patches,
    moving_rough,
    no_contact,
    rough,
    singular_fronts,
    solids,
    travelling_patch,
    yielding,
)


@lru_cache
def catalogue() -> tuple[Case, ...]:
    """All cases: those of Prop. 5.4, simple zones first, then those too rough for it."""
    return (
        full_contact.case(),
        no_contact.case(),
        fixed_front.on_vertices(),
        fixed_front.off_vertices(),
        advance_recede.case(),
        travelling_patch.case(),
        merging_patches.case(),
        lift_and_land.case(),
        loads.case(),
        yielding.whole_face(),
        yielding.part_of_face(),
        materials.coupled(),
        materials.graded(),
        materials.met(),
        bodies.rotated(),
        bodies.corner(),
        bodies.hexagon(),
        solids.disc(),
        solids.two_faces(),
        singular_fronts.natural(),
        singular_fronts.rough_trace(),
        moving_rough.case(),
        materials.unmet(),
        *rough.family(),
        corners.reentrant(),
        corners.junction(),
    )
