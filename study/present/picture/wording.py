"""What headings and captions say of a picture."""

from __future__ import annotations

from study.present.picture.faces import Array, FaceHistory
from study.present.picture.picture import Picture

ROUND_OFF = 1e-9
"""Below this a gap or a pressure counts as zero; where they are not zero they are of order one."""
HARMLESS = "where gap and pressure vanish to high order at a front, this hardly changes the error in the norm of V"
"""What misplaced fronts mean for the error."""


def heading(picture: Picture) -> str:
    """The case and the mesh it was computed on."""
    return f"{picture.case} ({picture.family}, $n={picture.level}$)"


def place(picture: Picture) -> str:
    """Case and mesh for captions."""
    return f"{picture.case}, {picture.family} mesh with n = {picture.level}"


def face_symbol(face: FaceHistory, picture: Picture) -> str:
    """Γ3, or Γ3,i where there are several faces, as TeX mathematics."""
    return rf"\Gamma_{{3,{face.number}}}" if len(picture.faces) > 1 else r"\Gamma_3"


def face_name(face: FaceHistory, picture: Picture) -> str:
    """Γ3, or Γ3,i where there are several faces, for captions."""
    return f"Γ3,{face.number}" if len(picture.faces) > 1 else "Γ3"


def face_names(picture: Picture) -> str:
    """All faces, for captions."""
    return ", ".join(face_name(face, picture) for face in picture.faces)


def times_shown(picture: Picture) -> str:
    """The times of the shapes."""
    return ", ".join(f"{shape.time:.3g}" for shape in picture.shapes)


def largest_differences(picture: Picture) -> tuple[str, str]:
    """How far computed gaps and pressures are from the exact ones at the nodes, at the times of the shapes."""
    at = picture.instants
    gaps = [(face.gap[at], face.gap_exact[at]) for face in picture.faces]
    pressures = [(face.pressure[at], face.pressure_exact[at]) for face in picture.faces]
    return _largest_difference(gaps), _largest_difference(pressures)


def _largest_difference(pairs: list[tuple[Array, Array]]) -> str:
    """max |computed − exact|, in per cent of max |exact| where that is not round-off."""
    difference = max(float(abs(computed - exact).max()) for computed, exact in pairs)
    size = max(float(abs(exact).max()) for _, exact in pairs)
    return (
        f"{100 * difference / size:.2g} % of the largest"
        if size > ROUND_OFF
        else f"{difference:.1e}, the largest being 0"
    )
