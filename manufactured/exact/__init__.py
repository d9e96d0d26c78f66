"""An exact solution {u, σ} of Problem 2.1, with the data f_0, f_2, u_0 that belong to it."""

from manufactured.exact.contribution import Contribution, ContributionAtPoints, Face
from manufactured.exact.forces import ForceModes
from manufactured.exact.solution import ExactSolution, FaceFields, Fields

__all__ = ["Contribution", "ContributionAtPoints", "ExactSolution", "Face", "FaceFields", "Fields", "ForceModes"]
