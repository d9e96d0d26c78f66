"""Names that cannot be part of a file name are refused wherever a user can give one."""

from dataclasses import replace
from pathlib import Path

import pytest
from matplotlib.figure import Figure

from manufactured import CaseError, named
from manufactured.file_names import file_name_fault
from study.cli.main import main
from study.fem.naming import family_named, resolve_data
from study.ledger.datafiles import DataError
from study.ledger.files import UsageError
from study.present.drawing import Drawing, draw_one

UNUSABLE = {
    "../evil": r"it contains '/'",
    "a\\b": r"it contains '\\\\'",
    "C:evil": r"it contains ':'",
    "a\x00b": r"it contains '\\x00'",
    "a\nb": r"it contains '\\n'",
    "a\x1b[2Jb": r"it contains '\\x1b'",
    "a\ud800b": r"it contains '\\ud800'",
    ".hidden": "it begins with a dot",
    "ends.": "ends with a dot",
    "ends ": "ends with a space",
    "x" * 101: "it takes 101 bytes, at most 100 are allowed",
    "ü" * 51: "it takes 102 bytes, at most 100 are allowed",
    "nul.txt": "Windows reserves it",
    "Com1": "Windows reserves it",
    "": "it is empty",
}


@pytest.mark.parametrize("name", ["front", "rough-1.75", "a b", "würfel", "_own", "console", "com10", "x" * 100])
def test_usable_names(name: str) -> None:
    assert file_name_fault(name) == ""


@pytest.mark.parametrize("name", UNUSABLE, ids=ascii)
def test_unusable_names_of_problems_and_cases_are_refused(name: str, tmp_path: Path) -> None:
    path = tmp_path / "own.py"
    head = "from dataclasses import replace\nfrom manufactured.problems import problems\n"
    path.write_text(head + f"mine = replace(problems()[0], name={name!a})", encoding="utf-8")
    with pytest.raises(UsageError, match=UNUSABLE[name]) as refused:
        resolve_data(f"{path}:mine")
    assert str(refused.value).isprintable()
    with pytest.raises(CaseError, match="case name"):
        replace(named("corner"), name=name)


@pytest.mark.parametrize("name", ["../evil", "/evil", ".hidden", "CON", "x" * 101])
@pytest.mark.parametrize("command", ["bound", "certify"])
def test_a_name_of_data_that_cannot_be_part_of_a_file_name_writes_nothing(
    command: str, name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "own.py"
    text = f"from manufactured.problems import problems\nglobals()[{name!r}] = problems()[0].data"
    path.write_text(text, encoding="utf-8")
    assert main([command, f"{path}:{name}", "--levels", "2", "--out", str(tmp_path / "out")]) == 2
    assert "cannot be part of a file name" in capsys.readouterr().err
    assert {*tmp_path.iterdir()} - {tmp_path / "__pycache__"} == {path}


def test_an_endless_name_of_a_mesh_family_is_refused() -> None:
    assert family_named("shaken-7").name == "shaken-7"
    with pytest.raises(UsageError, match="has 1000 digits, at most 20 are allowed"):
        family_named("shaken-" + "9" * 1000)


def test_a_figure_is_not_drawn_under_a_name_from_damaged_data(tmp_path: Path) -> None:
    with pytest.raises(DataError, match="contains a path separator or NUL: the data were edited"):
        draw_one(tmp_path, Drawing("zone-../../evil", Figure, "no figure", "none"))
    assert [*tmp_path.iterdir()] == []
