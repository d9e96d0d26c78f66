"""SfePy: its term dw_contact_plane, a penalty, and an active set of our own on its matrix. g = C_νννν.

The term is offered for the facets of tetrahedra and hexahedra, where the plane is a polygon. Nothing in it asks for
three dimensions, so that it is registered here once more, for triangles and a line without ends.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import sfepy
from active_set import active_set
from common import CannotExpressError, forces, normal_modulus, voigt
from contact_judge import Task
from sfepy.base.base import output
from sfepy.discrete import Equation, Equations, FieldVariable, Integral, Material, Problem
from sfepy.discrete.conditions import Conditions, EssentialBC
from sfepy.discrete.fem import FEDomain, Field, Mesh
from sfepy.mechanics.contact_bodies import ContactPlane
from sfepy.solvers.ls import ScipyDirect
from sfepy.solvers.nls import Newton
from sfepy.terms import Term, register_term
from sfepy.terms.terms_surface import ContactPlaneTerm

CODE, VERSION = "SfePy", sfepy.__version__
output.set_output(quiet=True)
CELLS, FACETS = Integral("cells", order=0), Integral("facets", order=2)


class Line(ContactPlane):
    """A line without ends in place of a polygon in a plane."""

    def __init__(self, anchor, normal) -> None:
        self.normal, self.adotn = normal, np.dot(anchor, normal)

    def mask_points(self, points: np.ndarray) -> np.ndarray:
        return np.ones(len(points), bool)


class ContactLineTerm(ContactPlaneTerm):
    """dw_contact_plane for triangles."""

    name, geometries = "dw_contact_line", ["2_3"]

    def get_fargs(self, force_pars, normal, anchor, bounds, *args, **kwargs):
        if self.cp is None:
            self.cp = Line(anchor, normal)
        return super().get_fargs(force_pars, normal, anchor, bounds, *args, **kwargs)


register_term(ContactLineTerm)


class Body:
    """Mesh, regions and the displacement of a task."""

    def __init__(self, task: Task) -> None:
        if task.dim != 2:
            raise CannotExpressError("this adapter is for the plane")
        groups = np.zeros(len(task.cells), np.int32)
        mesh = Mesh.from_data("task", task.vertices, None, [task.cells], [groups], ["2_3"])
        self.domain = FEDomain("domain", mesh)
        self.omega = self.domain.create_region("Omega", "all")
        self.clamped = self.region("Clamped", task.clamped, "vertex")
        field = Field.from_args("displacement", np.float64, "vector", self.omega, approx_order=1)
        self.u = FieldVariable("u", "unknown", field)
        self.v = FieldVariable("v", "test", field, primary_var_name="u")
        self.solid = Material("solid", function=partial(_on_cells, voigt(task)))
        self.contact = [self._piece(i, task, piece) for i, piece in enumerate(task.data["contact"])]

    def region(self, name: str, vertices, kind: str):
        return self.domain.create_region(name, "vertex " + ", ".join(str(v) for v in np.unique(vertices)), kind)

    def _piece(self, i: int, task: Task, piece: dict):
        """A flat piece of Γ3: its region, its normal and a point of it."""
        place = task.vertices[piece["facets"][0][0]]
        return self.region(f"Contact{i}", piece["facets"], "facet"), np.array(piece["normal"]), place

    def elastic(self, load: np.ndarray):
        """Elasticity and nodal forces."""
        given = Material("given", values={".b": load})
        K = Term.new("dw_lin_elastic(solid.val, v, u)", CELLS, self.omega, solid=self.solid, v=self.v, u=self.u)
        return K - Term.new("dw_point_load(given.b, v)", CELLS, self.omega, given=given, v=self.v)

    def penalty(self, k: float):
        """k ∫ (u_ν)_+ v_ν over Γ3."""
        terms = []
        for i, (region, normal, place) in enumerate(self.contact):
            m = Material(f"m{i}", values={"f": [k, 0.0], ".n": normal, ".a": place, ".b": np.zeros((3, 2))})
            call = f"dw_contact_line(m{i}.f, m{i}.n, m{i}.a, m{i}.b, v, u)"
            terms.append(Term.new(call, FACETS, region, **{m.name: m}, v=self.v, u=self.u))
        return sum(terms[1:], terms[0])

    def problem(self, terms, *conditions: EssentialBC) -> Problem:
        found = Problem("contact", equations=Equations([Equation("balance", terms)]))
        found.set_bcs(ebcs=Conditions(list(conditions)))
        return found


def _on_cells(values: np.ndarray, ts, coors, mode=None, **kwargs):
    return {"val": np.repeat(values, len(coors) // len(values), axis=0)} if mode == "qp" else None


def contact_line(factor: float, scaled: bool, task: Task):
    """step(b, s0) ↦ u by SfePy's Newton method, started anew for each step."""
    body = Body(task)
    k = factor * normal_modulus(task) / (task.data["h"] if scaled else 1)

    def step(load: np.ndarray, stress: np.ndarray) -> np.ndarray:
        b, status = forces(task, load, stress), {}
        problem = body.problem(body.elastic(b) + body.penalty(k), EssentialBC("clamped", body.clamped, {"u.all": 0.0}))
        options = {"i_max": 60, "eps_a": 1e-12 * np.linalg.norm(b), "ls_on": 1e10}
        problem.set_solver(Newton(options, lin_solver=ScipyDirect({}), status=status))
        u = problem.solve(save_results=False, verbose=False).get_state_parts()["u"]
        if status["condition"]:
            raise RuntimeError(f"{task.name}: Newton's method stops at a residual of {status['err']:.1e}")
        step.solves += status["n_iter"]
        return u.reshape(-1, 2)

    step.solves = 0
    return step


def multipliers(task: Task):
    """Our active set on SfePy's matrix."""
    body = Body(task)
    problem = body.problem(body.elastic(np.zeros_like(task.vertices)))
    problem.time_update()
    problem.update_materials(verbose=False)
    problem.set_default_state()
    return active_set(task, problem.get_evaluator().eval_tangent_matrix(np.zeros(task.vertices.size)))


VARIANTS = {
    "own active set on its matrix": multipliers,
    "dw_contact_plane, penalty 10 g/h": partial(contact_line, 10, True),
    "dw_contact_plane, penalty 10 g": partial(contact_line, 10, False),
}
FINEST = dict.fromkeys(VARIANTS, 32)
