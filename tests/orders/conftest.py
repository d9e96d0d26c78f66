"""The command on a table of errors."""

import shlex
from pathlib import Path

import pytest

from convergence_orders.command import main


@pytest.fixture
def rates(tmp_path, capsys):
    """Runs the command on a table: a file, text or bytes; returns what it prints, with single blanks.

    The command must end with one of the given exit codes, 0 unless told otherwise.
    """

    def run(table, options="", *codes):
        path = table if isinstance(table, Path) else tmp_path / "table"
        if path is not table:
            path.write_bytes(table.encode() if isinstance(table, str) else table)
        code = main([str(path), *shlex.split(options)])
        printed = capsys.readouterr()
        assert code in (codes or [0]), printed
        return " ".join((printed.out + printed.err).split())

    return run
