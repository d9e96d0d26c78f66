"""The explicit list of cases. What they are made of is imported with them: listing their names needs no SymPy."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from manufactured.case import Case


@lru_cache
def catalogue() -> tuple[Case, ...]:
    """All cases: those of Prop. 5.4, simple zones first, then those too rough for it, then laws that soften."""
    from manufactured.cases import (
        advance_recede,
        anisotropic,
        corner,
        cube_disc,
        cube_two_faces,
        double_well,
        fixed_front_off_vertex,
        fixed_front_on_vertex,
        full_contact,
        heterogeneous,
        hexagon,
        junction,
        layered,
        layered_unmet,
        lift_and_land,
        load_w11,
        merging_patches,
        moving_rough,
        natural_front,
        no_contact,
        re_entrant,
        rotated,
        rough_1_75,
        rough_2,
        rough_2_25,
        rough_trace,
        softening,
        travelling_patch,
        yield_and_release,
        yield_on_a_part,
    )

    return (
        full_contact.case(),
        no_contact.case(),
        fixed_front_on_vertex.case(),
        fixed_front_off_vertex.case(),
        advance_recede.case(),
        travelling_patch.case(),
        merging_patches.case(),
        lift_and_land.case(),
        load_w11.case(),
        yield_and_release.case(),
        yield_on_a_part.case(),
        anisotropic.case(),
        heterogeneous.case(),
        layered.case(),
        rotated.case(),
        corner.case(),
        hexagon.case(),
        cube_disc.case(),
        cube_two_faces.case(),
        natural_front.case(),
        rough_trace.case(),
        moving_rough.case(),
        layered_unmet.case(),
        rough_1_75.case(),
        rough_2.case(),
        rough_2_25.case(),
        re_entrant.case(),
        junction.case(),
        softening.case(),
        double_well.case(),
    )


def named(name: str) -> Case:
    """The case of the catalogue with a name.

    >>> case = named("rotated")
    >>> case.order, case.solution.body.dim, case.solution.law.dim
    (1, 2, 2)

    Raises:
        CaseError: there is none; the message lists those there are.
    """
    from manufactured.case import CaseError

    for case in catalogue():
        if case.name == name:
            return case
    raise CaseError(f"no case is called {name!r}; there are {', '.join(case.name for case in catalogue())}")
