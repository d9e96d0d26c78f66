"""Pictures of problems: ``study show FILE.py:NAME`` for a problem, and the end of ``study bound``."""

from pathlib import Path

import numpy as np
from skfem import Mesh

from manufactured.body import Kind, Part
from manufactured.data import Data
from manufactured.tensors import Array
from study.fem.mesh import MeshedBody
from study.ledger.files import UsageError
from study.present.drawing import Output, draw_one
from study.present.problem import ProblemPicture, Side

MeshInTime = tuple[tuple[Array, Array], tuple[Array, Array]]
"""A mesh and a displacement over time, as ``draw_problem`` takes them."""
OUTPUT = Output(formats=("png", "svg"))
ARROWS = 7
"""Number of arrows of the traction on a side."""
SAMPLES = 200
"""Number of random points of the body; the one nearest to their mean is called its middle."""
TOUCHING = 1e-9
"""A vertex of the contact boundary Γ3 counts as in contact up to this gap, relative to the largest displacement."""
TIMES = 5
"""Number of times of which the one with the largest tractions is shown, if no displacement is given."""


def draw_problem(
    directory: Path,
    name: str,
    data: Data,
    solved: MeshInTime | None = None,
) -> list[Path]:
    """Draw a problem, and perhaps a mesh with its displacement; return the files.

    Parameters:
        directory: the directory of the files.
        name, data: the name and the data of the problem.
        solved: the mesh, by vertices (2, n) and triangles (3, cells); and times (k,) with displacements of the
            vertices, (k, 2, n). The largest displacement is drawn.

    Raises:
        UsageError: the body is not plane.
    """
    body = data.body
    if body.dim != 2:
        raise UsageError(f"{name} has a body in {body.dim} dimensions; pictures of problems show plane bodies")
    if solved is None:
        vertices, cells, displacement = body.vertices, np.zeros((3, 0), dtype=int), np.zeros_like(body.vertices)
        times = np.linspace(0.0, body.T, TIMES if data.in_time else 1)
        time = max(times, key=lambda time: max(abs(_traction(data, part, time)[1]).max() for part in body.parts))
    else:
        (vertices, cells), (times, displacements) = solved
        largest = int(abs(displacements).max(axis=(1, 2)).argmax())
        time, displacement = times[largest], displacements[largest]
    sides = []
    for part in body.parts:
        moved = float(np.linalg.norm(part.prescribed(part.corners), axis=0).max())
        sides.append(Side(part.kind.name, part.corners, *_traction(data, part, float(time)), moved))
    inside = body.sample(np.random.default_rng(0), SAMPLES)
    middle = inside[:, np.linalg.norm(inside - inside.mean(axis=1, keepdims=True), axis=0).argmin()]
    force = data.body_force(middle[:, None])(float(time))[:, 0]
    when = f", t = {time:.3g}" if data.in_time else ""
    picture = ProblemPicture(name, sides, middle, force, when, vertices, cells.T, displacement)
    return draw_one(directory, picture.drawing(), OUTPUT)


def _traction(data: Data, part: Part, time: float) -> tuple[Array, Array]:
    """Return points on a side, and the traction at these points, (2, n) each; it is 0 on a side that is not LOADED."""
    places = (np.arange(ARROWS) + 0.5) / ARROWS
    points = part.start[:, None] + places * (part.end - part.start)[:, None]
    loaded = part.kind is Kind.LOADED
    return points, np.asarray(data.surface_load(part, points)(time)) if loaded else np.zeros_like(points)


def contact_edges(data: Data, mesh: Mesh, displacement: Array) -> tuple[Array, Array]:
    """Find out which edges of the contact boundary Γ3 are in contact.

    Args:
        data: the problem.
        mesh: the mesh.
        displacement: the values of the displacement at the vertices, (2, vertices).

    Returns:
        The end points of the n edges on Γ3, (2, 2, n), and for each edge whether both end points are in contact, (n,).
    """
    # Bodies without contact have no array to concatenate, so each list starts with an empty array.
    ends, closed = [np.empty((2, 2, 0))], [np.empty(0, dtype=bool)]
    size = max(float(abs(displacement).max()), np.finfo(float).tiny)
    for part, facets in MeshedBody(mesh, data.body).on(Kind.CONTACT):
        vertices = mesh.facets[:, facets]
        ends.append(mesh.p[:, vertices])
        opening = -np.einsum("d,den->en", part.normal, displacement[:, vertices])
        closed.append((opening <= TOUCHING * size).all(axis=0))
    return np.concatenate(ends, axis=2), np.concatenate(closed)
