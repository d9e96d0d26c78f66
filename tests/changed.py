"""Changed objects for tests: attributes that are replaced, and Problems 3.1 and 3.2 of a case."""

from study.solve.tableau import BACKWARD_EULER
from study.statements.shared.base import Experiment
from study.statements.thm_4_2 import stress_problem


def overridden(whole, **attributes):
    """Set attributes of an object, even of a frozen dataclass, and return the object."""
    vars(whole).update(attributes)
    return whole


def problems(solution, family, level):
    """Problems 3.1 and 3.2 of an exact solution on one mesh."""
    setup = Experiment.of(solution, family, level, BACKWARD_EULER, 1)
    return setup.problem, stress_problem(setup)
