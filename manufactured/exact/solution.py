"""An exact solution as a body, a law and displacement fields."""

from __future__ import annotations

from dataclasses import dataclass

from manufactured.body import Body, Kind
from manufactured.contact import ContactFace
from manufactured.exact.contribution import Contribution, Face
from manufactured.exact.fields import FaceFields, Fields
from manufactured.law import KelvinVoigt
from manufactured.tensors import Array, Hyperplane, Points


@dataclass(frozen=True, eq=False)
class ExactSolution:
    """u = Σ_i (field of Γ3,i) + others, σ = A ε(u̇) + G ε(u), f_0 = −Div σ, f_2 = σν.

    Attributes:
        body: Ω, Γ1, Γ2, Γ3, T.
        law: A and G.
        faces: one entry per piece of Γ3, in the order of ``body.of(Kind.CONTACT)``; the field of one
            face must not disturb the contact on the others and must vanish on Γ1.
        others: fields that make no contact, such as the singularity of a corner.
        singular: vertices of the body at which the strain is singular.

    Raises:
        ValueError: the law's dimension is not the body's, the faces are not the pieces of Γ3, or a
            lifting ends with a kink inside the body.
    """

    body: Body
    law: KelvinVoigt
    faces: tuple[Face, ...]
    others: tuple[Contribution, ...] = ()
    singular: tuple[tuple[float, ...], ...] = ()

    def __post_init__(self) -> None:
        if self.law.dim != self.body.dim:
            raise ValueError(f"the law acts in dimension {self.law.dim}, the body has dimension {self.body.dim}")
        pieces = self.body.of(Kind.CONTACT)
        if [face.part for face in self.faces] != list(pieces):
            raise ValueError(f"the body has {len(pieces)} piece(s) Γ3,i, so give one contact face for each, in order")
        for face in self.faces:
            if not isinstance(face, ContactFace):
                continue
            deepest = float(face.part.coordinates(self.body.vertices)[1].max())
            if deepest > face.profile.depth * (1 + 1e-12) and face.profile.ends_with_kink:
                raise ValueError(
                    f"the body is {deepest:g} deep, the lifting ends at {face.profile.depth:g} with a kink: "
                    "take the depth of Γ1 or a cut-off with φ(1) = φ'(1) = 0 such as HERMITE"
                )

    @property
    def rough(self) -> tuple[Hyperplane, ...]:
        """Where strains are rough for all times: {s = c} for the rough c of every lifting, and jumps of A and G."""
        fronts = (face.part.line(c) for face in self.faces if isinstance(face, ContactFace) for c in face.rough)
        return (*fronts, *self.law.steps)

    def at(self, x: Points) -> Fields:
        """The solution at fixed points of Ω̄, (d, ...): evaluate it at as many times as needed."""
        return Fields(self, x)

    def on(self, face: Face, s: Array) -> FaceFields:
        """The solution at fixed points of a contact face."""
        return FaceFields(self, face, s)
