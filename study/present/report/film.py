"""What the page needs to show a case in motion, from ``pictures/CASE.json``."""

from __future__ import annotations

import json
from base64 import b64encode
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from study.ledger.datafiles import DataError, made_by
from study.ledger.packing import short
from study.present.picture.faces import FaceHistory, Polygon, Segment
from study.present.picture.picture import Picture, over_time
from study.present.picture.view import ARROW, FOUNDATION, View, end_of_colours, magnification, shade

SHADES = 255


def read_film(directory: Path, case: str) -> dict[str, Any]:
    """The picture of a case in the form that the script of the page reads.

    ``displacement``: multiples of ``unit``, 16 bit, time by time all x, then all y, then all z; ``shades``: of the
    stress τ of each cell, 8 bit, 255 (τ/brightest)^½; both in base64. ``magnification`` is the factor of displacements,
    ``arrow`` and ``foundation`` are fractions of the body's longest side, ``view`` has the rows of the projection, two
    in the plane and three in space.

    Raises:
        DataError: there is no such file, it is no picture, or an older one without motion.
    """
    path = directory / "data" / "pictures" / f"{case}.json"
    if not path.is_file():
        raise DataError(f"{path} is missing: make it with `{made_by(directory)}`")
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
        (displacement, von_mises), picture = over_time(record), Picture.of(record)
    except (KeyError, TypeError, ValueError) as error:
        raise DataError(
            f"{path} holds no displacement and von_mises over time ({error!r}), which the report shows: if an older "
            "version wrote it, make it anew with the same `study run`"
        ) from error
    stress = von_mises.values
    brightest = end_of_colours(stress)
    return {
        "times": picture.times.tolist(),
        "vertices": picture.vertices.tolist(),
        "cells": picture.cells.T.ravel().tolist(),
        "unit": displacement.unit,
        "displacement": _base64(displacement.multiples.astype("<i2")),
        "shades": _base64(np.round(SHADES * shade(stress / brightest)).astype(np.uint8)),
        "brightest": brightest,
        "magnification": magnification(picture.vertices, displacement.values),
        "arrow": ARROW,
        "foundation": FOUNDATION,
        "view": View.of(picture).axes.tolist(),
        "faces": [*map(_segment, picture.segments), *map(_polygon, picture.polygons)],
    }


def _base64(values: NDArray[Any]) -> str:
    return b64encode(values.tobytes()).decode("ascii")


def _segment(face: Segment) -> dict[str, Any]:
    return _values(face) | {
        "zone": {"times": face.zone_times.tolist(), "intervals": face.zone},
        "line": {"s": short(face.line), "gap": short(face.line_gap), "pressure": short(face.line_pressure)},
    }


def _polygon(face: Polygon) -> dict[str, Any]:
    """Facets, edges and quarters: the points at the corners of each, one after the other."""
    facets = face.facets
    return _values(face) | {
        "gap_exact": short(face.gap_exact),
        "pressure_exact": short(face.pressure_exact),
        "nodes": face.nodes.tolist(),
        "cells": facets.cells.tolist(),
        "facets": facets.corners.T.ravel().tolist(),
        "edges": facets.edges.T.ravel().tolist(),
        "quarters": facets.quarters.T.ravel().tolist(),
        "level": short(face.level),
    }


def _values(face: FaceHistory) -> dict[str, Any]:
    series = {name: short(getattr(face, name)) for name in ("s", "x", "gap", "pressure")}
    return {"face": face.number, "normal": face.normal.tolist(), **series, "touches": face.contact_threshold}
