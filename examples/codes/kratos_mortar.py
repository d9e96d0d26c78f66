"""Kratos Multiphysics: mortar contact with a meshed foundation, augmented Lagrangian (ALM) and penalty.

Its kinematics of contact are those of large displacements, so loads are made small (SMALL). Tolerances are 1e-10,
tighter than by default. The foundation is a held slab below each face, of as many segments as the face has edges, or of
a stated number; the condensation of multipliers by its mixed linear solver is off.
"""

from __future__ import annotations

import json
import os
import tempfile
from functools import partial
from importlib.metadata import version
from pathlib import Path

import KratosMultiphysics as kratos  # noqa: N813
import numpy as np
from common import MARGIN, CannotExpressError, forces, slab, young
from contact_judge import Task
from KratosMultiphysics import StructuralMechanicsApplication as structural  # noqa: N813
from KratosMultiphysics.StructuralMechanicsApplication.structural_mechanics_analysis import StructuralMechanicsAnalysis

CODE, VERSION = "Kratos", version("KratosContactStructuralMechanicsApplication")
SMALL = 1e-5
kratos.Logger.GetDefaultOutput().SetSeverity(kratos.Logger.Severity.WARNING)


def mdpa(task: Task, segments: int | None) -> str:
    """The model: body, slabs and their parts, in Kratos's format."""
    points, cells, lines = [task.vertices], [(1, task.cells)], []
    parts = {"clamped": (task.clamped, []), "body": (np.arange(len(task.vertices)), [])}
    oriented = {frozenset(e): e for c in task.cells.tolist() for e in zip(c, [*c[1:], c[0]], strict=True)}
    for i, piece in enumerate(task.data["contact"]):
        edges = [oriented[frozenset(facet)] for facet in piece["facets"]]
        corners = np.unique(edges)
        start = sum(map(len, points))
        per = segments or int(len(edges) * (1 + 2 * MARGIN))
        vertices, triangles = slab(task.vertices[corners], np.array(piece["normal"]), per)
        touching = triangles[:per, :2]
        points.append(vertices)
        cells.append((2, triangles + start))
        parts[f"slave{i}"] = corners, range(len(lines), len(lines) + len(edges))
        lines += edges
        parts[f"master{i}"] = np.unique(touching) + start, range(len(lines), len(lines) + len(touching))
        lines += (touching + start).tolist()
        parts[f"slab{i}"] = np.arange(len(vertices)) + start, []
    text = [
        "Begin Properties 0",
        "End Properties",
        "Begin Properties 1",
        "End Properties",
        "Begin Properties 2",
        "End Properties",
        "Begin Nodes",
    ]
    text += [f"{i} {x:.17g} {y:.17g} 0" for i, (x, y) in enumerate(np.concatenate(points), start=1)]
    text += ["End Nodes", "Begin Elements SmallDisplacementElement2D3N"]
    number, of = 0, {1: [], 2: []}
    for material, group in cells:
        for cell in group + 1:
            number += 1
            of[material].append(number)
            text.append(f"{number} {material} {' '.join(map(str, cell))}")
    text += ["End Elements", "Begin Conditions LineCondition2D2N"]
    text += [f"{i} 0 {a + 1} {b + 1}" for i, (a, b) in enumerate(lines, start=1)]
    loads = len(lines)
    text += ["End Conditions", "Begin Conditions PointLoadCondition2D1N"]
    text += [f"{loads + i} 0 {i}" for i in range(1, len(task.vertices) + 1)]
    text += ["End Conditions"]
    everything = {name: (nodes + 1, [], [c + 1 for c in conditions]) for name, (nodes, conditions) in parts.items()}
    everything["body"] = everything["body"][0], of[1], range(loads + 1, loads + len(task.vertices) + 1)
    held = np.concatenate([nodes + 1 for name, (nodes, _) in parts.items() if name.startswith("slab")])
    everything["foundation"] = held, of[2], []
    for name, (nodes, elements, conditions) in everything.items():
        if name.startswith("slab"):
            continue
        text.append(f"Begin SubModelPart {name}")
        for kind, numbers in (("Nodes", nodes), ("Elements", elements), ("Conditions", conditions)):
            text += [f"Begin SubModelPart{kind}", *map(str, numbers), f"End SubModelPart{kind}"]
        text.append("End SubModelPart")
    return "\n".join(text) + "\n"


def settings(task: Task, kind: str, options: dict) -> dict:
    """The parameters of the analysis."""
    pairs = {str(i): [f"slave{i}", f"master{i}"] for i in range(len(task.data["contact"]))}
    held = [
        {
            "python_module": "assign_vector_variable_process",
            "kratos_module": "KratosMultiphysics",
            "Parameters": {
                "model_part_name": f"Structure.{name}",
                "variable_name": "DISPLACEMENT",
                "value": [0.0, 0.0, 0.0],
                "constrained": [True, True, True],
            },
        }
        for name in ("clamped", "foundation")
    ]
    contact = {
        "python_module": "alm_contact_process" if kind.startswith("ALM") else "penalty_contact_process",
        "kratos_module": "KratosMultiphysics.ContactStructuralMechanicsApplication",
        "Parameters": {
            "model_part_name": "Structure",
            "contact_model_part": pairs,
            "assume_master_slave": {key: value[:1] for key, value in pairs.items()},
            "contact_type": "Frictionless",
            **options,
        },
    }
    tight = {"relative": 1e-10, "absolute": 1e-30}
    return {
        "problem_data": {
            "problem_name": "task",
            "parallel_type": "OpenMP",
            "start_time": 0.0,
            "end_time": 1.0,
            "echo_level": 0,
        },
        "solver_settings": {
            "solver_type": "Static",
            "model_part_name": "Structure",
            "domain_size": 2,
            "echo_level": 0,
            "analysis_type": "non_linear",
            "model_import_settings": {"input_type": "mdpa", "input_filename": "task"},
            "material_import_settings": {"materials_filename": "materials.json"},
            "contact_settings": {
                "mortar_type": f"{kind}ContactFrictionless",
                "contact_displacement_relative_tolerance": tight["relative"],
                "contact_displacement_absolute_tolerance": tight["absolute"],
                "contact_residual_relative_tolerance": tight["relative"],
                "contact_residual_absolute_tolerance": tight["absolute"],
                "use_mixed_ulm_solver": False,
                "fancy_convergence_criterion": False,
            },
            "time_stepping": {"time_step": 1.1},
            "line_search": False,
            "rotation_dofs": False,
            "convergence_criterion": "contact_residual_criterion",
            "residual_relative_tolerance": tight["relative"],
            "residual_absolute_tolerance": tight["absolute"],
            "displacement_relative_tolerance": tight["relative"],
            "displacement_absolute_tolerance": tight["absolute"],
            "max_iteration": 60,
            "linear_solver_settings": {"solver_type": "LinearSolversApplication.sparse_lu"},
        },
        "processes": {"constraints_process_list": held, "contact_process_list": [contact]},
    }


def materials(task: Task) -> dict:
    """The body's law; the slab's, which is held, is the same."""
    E, nu = young(task)
    law = {
        "constitutive_law": {"name": "LinearElasticPlaneStrain2DLaw"},
        "Variables": {"YOUNG_MODULUS": E, "POISSON_RATIO": nu, "DENSITY": 1.0, "THICKNESS": 1.0},
        "Tables": {},
    }
    parts = (("Structure.body", 1), ("Structure.foundation", 2))
    return {"properties": [{"model_part_name": part, "properties_id": i, "Material": law} for part, i in parts]}


def solve(task: Task, load: np.ndarray, kind: str, options: dict, segments: int | None) -> tuple[np.ndarray, int]:
    """u and the iterations, in a directory of its own."""
    before = os.getcwd()
    with tempfile.TemporaryDirectory() as name:
        os.chdir(name)
        try:
            Path("task.mdpa").write_text(mdpa(task, segments))
            Path("materials.json").write_text(json.dumps(materials(task)))
            analysis = StructuralMechanicsAnalysis(
                kratos.Model(), kratos.Parameters(json.dumps(settings(task, kind, options)))
            )
            analysis.Initialize()
            part = analysis.model["Structure"]
            for i, (x, y) in enumerate(load, start=1):
                part.Nodes[i].SetSolutionStepValue(structural.POINT_LOAD, [x, y, 0.0])
            analysis.RunSolutionLoop()
            u = [part.Nodes[i].GetSolutionStepValue(kratos.DISPLACEMENT) for i in range(1, len(load) + 1)]
            count = part.ProcessInfo[kratos.NL_ITERATION_NUMBER]
            analysis.Finalize()
        finally:
            os.chdir(before)
    return np.array([[v[0], v[1]] for v in u]), int(count)


def make(kind: str, options: dict, segments: int | None, task: Task):
    """step(b, s0) ↦ u, a new model for each."""
    if task.dim != 2:
        raise CannotExpressError("this adapter is for the plane")
    young(task)

    def step(load: np.ndarray, stress: np.ndarray) -> np.ndarray:
        u, count = solve(task, SMALL * forces(task, load, stress), kind, options, segments)
        step.solves += count
        return u / SMALL

    step.solves = 0
    return step


VARIANTS = {
    "ALM mortar, foundation as fine as the face": partial(make, "ALM", {}, None),
    "ALM mortar, foundation of 3 segments": partial(make, "ALM", {}, 3),
    "ALM mortar, foundation of 3 segments, search factor 50": partial(
        make, "ALM", {"search_parameters": {"search_factor": 50.0}}, 3
    ),
    "penalty mortar, default": partial(make, "Penalty", {}, None),
}
