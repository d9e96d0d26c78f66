"""The command on a table of errors."""

from collections.abc import Callable
from pathlib import Path

import pytest

from convergence_orders.command import main


@pytest.fixture
def rates(tmp_path: Path, capsys) -> Callable[..., str]:
    """Runs the command on a table that is given as text or bytes; returns what it prints, with single blanks."""

    def run(table: str | bytes, *options: str, code: int = 0) -> str:
        (tmp_path / "table").write_bytes(table.encode() if isinstance(table, str) else table)
        assert main([str(tmp_path / "table"), *options]) == code
        printed = capsys.readouterr()
        return " ".join((printed.out + printed.err).split())

    return run
