"""What differs between two pictures: JSON files in which numbers stand alone, in lists, or packed."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from study.ledger.compare.closeness import Cell, ComparedColumn, Row, Tolerance, numbers, words
from study.ledger.compare.differences import TableDifference
from study.ledger.compare.reading import again
from study.ledger.datafiles import DataError
from study.ledger.packing import Packed

PACKED = {"unit", "shape", "changes"}
"""What an object has that stands for many numbers."""

Place = tuple[str, tuple[int, ...] | None]
"""A place such as faces[0].gap, and the shape of the numbers there; None for a word."""


@dataclass(frozen=True)
class PictureNumbers:
    """The numbers at every place, and any other value as JSON."""

    arrays: dict[Place, NDArray[Any]]
    words: dict[Place, str]

    @property
    def places(self) -> dict[Place, object]:
        """All, in their order."""
        return {**self.arrays, **self.words}


def read_picture(path: Path, content: bytes) -> PictureNumbers:
    """The picture in the content of a JSON file, with its packed numbers unpacked.

    Raises:
        DataError: it is no JSON, or cannot be unpacked.
    """
    try:
        leaves = list(_leaves(json.loads(content), ""))
    # No JSON or no UTF-8, brackets nested too deeply, packed numbers that are none.
    except (ValueError, RecursionError, KeyError, TypeError) as error:
        raise DataError(f"{path} is not a picture ({error}): {again(path)}") from error
    return PictureNumbers(
        {(place, leaf.shape): leaf for place, leaf in leaves if isinstance(leaf, np.ndarray)},
        {(place, None): leaf for place, leaf in leaves if isinstance(leaf, str)},
    )


def compare_pictures(old: PictureNumbers, new: PictureNumbers, tolerance: Tolerance) -> TableDifference:
    """What differs between two pictures; a list of another length is in one of them only."""
    arrays = [place for place in old.arrays if place in new.arrays]
    texts = [place for place in old.words if place in new.words]
    changed = [
        Cell({"place": place[0]}, old.words[place], new.words[place], None)
        for place in texts
        if old.words[place] != new.words[place]
    ]
    columns = words("words", len(texts), changed), _numbers(old, new, arrays, tolerance)
    return TableDifference(
        rows=len(arrays) + len(texts),
        only_old=tuple(_row(place) for place in old.places if place not in new.places),
        only_new=tuple(_row(place) for place in new.places if place not in old.places),
        columns=tuple(column for column in columns if column),
    )


def _numbers(
    old: PictureNumbers, new: PictureNumbers, places: list[Place], tolerance: Tolerance
) -> ComparedColumn | None:
    """All numbers at places that both have, as one column."""
    first, second = [old.arrays[place] for place in places], [new.arrays[place] for place in places]
    whole = [np.full(a.size, a.dtype.kind == b.dtype.kind == "i") for a, b in zip(first, second, strict=True)]
    starts = np.cumsum([0, *(a.size for a in first)])

    def cell(n: int, relative: float) -> Cell:
        which = int(np.searchsorted(starts, n, side="right")) - 1
        index = np.unravel_index(n - starts[which], first[which].shape)
        before, after = (json.dumps(arrays[which][index].item()) for arrays in (first, second))
        return Cell({"place": places[which][0] + "".join(f"[{i}]" for i in index)}, before, after, relative)

    a, b = (np.concatenate([*map(np.ravel, arrays), []]).astype(float) for arrays in (first, second))
    return numbers("numbers", a, b, np.concatenate([*whole, np.empty(0, bool)]), tolerance, cell)


def _row(place: Place) -> Row:
    name, shape = place
    return {"place": name, "numbers": " × ".join(map(str, shape or ()))}


def _leaves(value: Any, place: str) -> Iterator[tuple[str, NDArray[Any] | str]]:
    """Arrays of numbers as large as they can be, and what else a JSON value holds, with their places."""
    if isinstance(value, dict) and value.keys() == PACKED:
        yield place, Packed.read(value).values
    elif isinstance(value, dict):
        for name, item in value.items():
            yield from _leaves(item, f"{place}.{name}" if place else name)
    elif (array := _array(value)) is not None:
        yield place, array
    elif isinstance(value, list):
        for i, item in enumerate(value):
            yield from _leaves(item, f"{place}[{i}]")
    else:
        yield place, json.dumps(value, ensure_ascii=False)


def _array(value: Any) -> NDArray[Any] | None:
    """The array that a number or lists of numbers are; None if they are ragged or hold anything else."""
    try:
        array = np.array(value)
    except ValueError:
        return None
    return array if array.dtype.kind in "if" else None
