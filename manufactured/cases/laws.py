"""Laws shared by several cases."""

from manufactured.law import KelvinVoigt, isotropic


def proportional() -> KelvinVoigt:
    """A = G: τ ↦ 2τ + (tr τ) I; a = g = 3."""
    return KelvinVoigt(isotropic(1, 1), isotropic(1, 1), "linear, A = G")


def not_proportional() -> KelvinVoigt:
    """A τ = 2τ + (tr τ)/2 I and G τ = 4τ + 3(tr τ) I; a = 5/2, g = 7.

    Norms, relaxation and the ratio of shear to compression differ between A and G, so a verdict
    notices when one takes the place of the other.
    """
    return KelvinVoigt(isotropic(1, 0.5), isotropic(2, 3), "linear, A and G not proportional")
