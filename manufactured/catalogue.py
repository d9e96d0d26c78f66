"""The explicit list of cases."""

from __future__ import annotations

from functools import lru_cache

from manufactured.case import Case
from manufactured.cases import (
    advance_recede,
    fixed_front,
    full_contact,
    no_contact,
    rough,
    travelling_patch,
    yielding,
)


@lru_cache
def catalogue() -> tuple[Case, ...]:
    """All cases, simple zones first."""
    return (
        full_contact.case(),
        no_contact.case(),
        fixed_front.on_vertices(),
        fixed_front.off_vertices(),
        advance_recede.case(),
        travelling_patch.case(),
        yielding.whole_face(),
        yielding.part_of_face(),
        *rough.family(),
    )
