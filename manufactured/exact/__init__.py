"""Exact solutions {u, σ} of Problem 2.1, and the data f_0, f_2 and u_0 that belong to them."""

from manufactured.exact.domain import Contribution, ContributionAtPoints, Face
from manufactured.exact.forces import ForceModes
from manufactured.exact.solution import ExactSolution, FaceFields, Fields

__all__ = ["Contribution", "ContributionAtPoints", "ExactSolution", "Face", "FaceFields", "Fields", "ForceModes"]
