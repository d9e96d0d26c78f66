"""The command on a table of errors."""

import pytest

from convergence_orders.command import main


@pytest.fixture
def rates(tmp_path, capsys):
    """Runs the command on a table that is given as text or bytes; returns what it prints, with single blanks."""

    def run(table, *options, code=0):
        (tmp_path / "table").write_bytes(table.encode() if isinstance(table, str) else table)
        assert main([str(tmp_path / "table"), *options]) == code
        printed = capsys.readouterr()
        return " ".join((printed.out + printed.err).split())

    return run
