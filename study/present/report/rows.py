"""A table on the page: numbers are texts here, as in ``results/tables``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from study.present.tables import Column, Table


@dataclass(frozen=True)
class Rows:
    """A table of texts."""

    caption: str
    columns: list[Column]
    cells: list[list[str]]

    @classmethod
    def of(cls, table: Table, caption: str, case: str | None = None, without: Sequence[str] = ()) -> Rows:
        """The rows of a table of the study, of one case or of all, without some columns."""
        shown = table.cells if case is None else table.cells[table.cells["case"] == case]
        columns = [column for column in table.columns if column.name not in without]
        return cls(caption, columns, shown[[column.name for column in columns]].to_numpy().tolist())
