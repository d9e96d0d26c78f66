"""Changed objects for tests: attributes that are replaced, and bodies that are turned."""

from dataclasses import replace

import numpy as np

from manufactured import ExactSolution, Kind, polygon
from manufactured.contact import ContactFace
from study.solve.tableau import BACKWARD_EULER
from study.statements.shared.base import Experiment
from study.statements.thm_4_2 import stress_problem


def overridden(whole, **attributes):
    """Set attributes of an object, even of a frozen dataclass, and return the object."""
    vars(whole).update(attributes)
    return whole


def turned(solution, angle):
    """The solution on a plane body that is turned by an angle, for an isotropic law."""
    body = solution.body
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    corners = [(float(x), float(y)) for x, y in (turn @ body.vertices).T]
    moved = polygon(corners, [part.kind for part in body.parts], body.T)
    lifted = [face for face in solution.faces if isinstance(face, ContactFace)]
    faces = zip(lifted, moved.of(Kind.CONTACT), strict=True)
    return ExactSolution(moved, solution.law, tuple(replace(face, part=part) for face, part in faces))


def problems(solution, family, level):
    """Problems 3.1 and 3.2 of an exact solution on one mesh."""
    setup = Experiment.of(solution, family, level, BACKWARD_EULER, 1)
    return setup.problem, stress_problem(setup)
