"""The notebooks of the documentation run from top to bottom, and are committed with the outputs of such a run."""

from pathlib import Path
from typing import Any

import pytest

NOTEBOOKS = sorted((Path(__file__).parents[2] / "docs" / "notebooks").glob("*.ipynb"))


def code_cells(notebook: Any) -> list[Any]:
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def printed(notebook: Any) -> list[str]:
    return [output.text for cell in code_cells(notebook) for output in cell.outputs if output.output_type == "stream"]


def has_figure(notebook: Any) -> bool:
    return any("image/png" in output.get("data", {}) for cell in code_cells(notebook) for output in cell.outputs)


def test_three_notebooks_are_stored_with_outputs_and_figures_in_less_than_300_kB() -> None:
    nbformat = pytest.importorskip("nbformat")
    assert len(NOTEBOOKS) == 3
    for path in NOTEBOOKS:
        notebook = nbformat.read(path, as_version=4)
        nbformat.validate(notebook)
        counts = [cell.execution_count for cell in code_cells(notebook)]
        assert counts == list(range(1, len(counts) + 1)), f"{path.name}: run all cells, from top to bottom"
        assert printed(notebook), path.name
        assert has_figure(notebook), path.name
    assert sum(path.stat().st_size for path in NOTEBOOKS) < 300_000


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_prints_what_is_stored_and_draws_a_figure(path: Path) -> None:
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    stored = nbformat.read(path, as_version=4)
    run = nbclient.NotebookClient(nbformat.read(path, as_version=4), timeout=300).execute()
    assert printed(run) == printed(stored), "run: .venv/bin/jupyter execute --inplace docs/notebooks/*.ipynb"
    assert has_figure(run)
