"""What the README and the documentation tell people to type works; notebooks."""

import importlib.util
import io
import re
import runpy
import shutil
import sys
import warnings
from contextlib import redirect_stdout
from functools import cache

import pytest
from costly_cases import slow_unless
from pages import PAGES, README, SITE, words
from places import EXAMPLES, RESULTS, ROOT

from manufactured import catalogue
from study.cli.main import main, parser
from study.fem.naming import resolve, resolve_data
from study.statements.enclosure import resolve_problem

CI = re.findall(r"^(?:make|\.venv/bin/study) .*$", (ROOT / ".ci/run").read_text(encoding="utf-8"), re.MULTILINE)
LONG_PYTHON = {"docs/how-to/verify-a-contact-code.md", "docs/tutorials/own-case.md"}
"""Pages whose Python takes longer than three seconds."""
LONG = {"README.md", "docs/how-to/figures.md", "docs/tutorials/bound.md", *LONG_PYTHON}
"""Pages whose commands take longer than three seconds, for the slow tests, which `make tutorials` runs. The case of
``own-case.md`` is what the tests of most commands start from (``cli/conftest.py``)."""
NEEDS = {"docs/tutorials/dolfinx.md": "dolfinx"}
"""Pages that need a program that may not be installed."""


def is_one_of(line, commands):
    """Whether a line to type is the beginning of a command; words in capitals stand for any other."""
    mine, *others = (words(text) for text in (line, *commands))
    starts = [other[: len(mine)] for other in others if len(other) >= len(mine)]
    return any(all(word.isupper() or word == same for word, same in zip(mine, other, strict=True)) for other in starts)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Run a command of a page once, in the directory of the page's files; its Python is ``session.py``.

    Returns what is printed. Everything runs in this process: an interpreter for each command takes four seconds.
    """

    @cache
    def directory(page):
        place = tmp_path_factory.mktemp("page")
        for name, text in {**page.files, "session.py": page.session}.items():
            (place / name).write_text(text, encoding="utf-8")
        for path in page.downloads:
            shutil.copy(path, place)
        (place / "examples").symlink_to(EXAMPLES)
        (place / "results").mkdir()
        for name in ("data", "codes"):  # committed results, for pages that draw them again
            (place / "results" / name).symlink_to(RESULTS / name)
        return place

    @cache
    def printed(page, line):
        # Pages have files of the same name.
        for known in (resolve, resolve_data, resolve_problem):
            known.cache_clear()
        output = io.StringIO()
        before = set(sys.modules)
        with pytest.MonkeyPatch.context() as patch, redirect_stdout(output), warnings.catch_warnings():
            warnings.simplefilter("default")
            patch.chdir(directory(page))
            # The judge, which a page tells to copy beside one's own program.
            patch.setattr(sys, "path", [str(directory(page)), str(EXAMPLES / "codes"), *sys.path])
            program, *arguments = words(line)
            if program == "study":
                assert main(arguments) == 0, output.getvalue()
            else:
                patch.setattr(sys, "argv", arguments)
                runpy.run_path(arguments[0], run_name="__main__")
        for name in set(sys.modules) - before:
            if str(getattr(sys.modules[name], "__file__", "")).startswith(str(directory(page))):
                del sys.modules[name]
        return output.getvalue()

    return printed


def expect(said, output):
    assert [text for text in said if text.rstrip() not in output] == [], output


def marked(pages, long):
    items = [slow_unless(page.name not in long, page, id=page.name) for page in pages]
    return pytest.mark.parametrize("page", items)


@marked((page for page in PAGES if page.session), LONG_PYTHON)
def test_the_python_of_a_page_runs_from_top_to_bottom(page, run):
    needed = NEEDS.get(page.name)
    if needed and importlib.util.find_spec(needed) is None:
        pytest.skip(f"{needed} is not installed")
    for line in page.prepared:
        run(page, line)
    expect(page.printed("python"), run(page, "python session.py"))


TYPED = [page for page in [README, *SITE] if any(words(line)[0] == "study" for line in page.typed)]


@marked(TYPED, LONG)
def test_the_commands_of_a_page_end_with_success(page, run):
    programs = [f"python {name}" for name in page.files]
    programs += [line for line in page.typed if line.startswith("python examples/")]
    studies = [line for line in page.typed if words(line)[0] == "study" and not is_one_of(line, CI)]
    expect(page.printed("sh"), "".join(run(page, line) for line in page.typed if line in (*programs, *studies)))


def test_the_commands_of_the_table_are_those_of_the_program():
    (page,) = [page for page in SITE if page.name == "docs/reference/commands.md"]
    (commands,) = [action for action in parser()._actions if action.choices]
    assert set(re.findall(r"`study ([a-z]+)", page.text)) == set(commands.choices)


@pytest.mark.parametrize(
    ("part", "pattern"),
    [
        ("prose", r"\]\((?![a-z]+:)([^)#\s]+)(?:#[^)]*)?\)|^\[[^]]+\]: (?![a-z]+:)([^#\s]+)"),
        ("text", r"`((?:study|manufactured|tests|paper|results|examples)/(?!quick)[\w./-]*)`"),
    ],
)
def test_files_that_a_page_links_to_or_names_are_there(part, pattern):
    found = [(page, match) for page in PAGES for match in re.finditer(pattern, getattr(page, part), re.MULTILINE)]
    named = [(page.path.parent if part == "prose" else ROOT, "".join(match.groups(""))) for page, match in found]
    assert len(named) > 30
    assert [(str(folder), name) for folder, name in named if not (folder / name).exists()] == []


def test_the_readme_can_be_read_in_a_few_minutes():
    assert len(README.text.split()) <= 900


def test_the_page_on_exact_solutions_says_why_each_case_is_there():
    rows = re.findall(r"^\| ([a-z0-9.,\- ]+) \|", (ROOT / "docs/gallery.md").read_text("utf-8"), re.MULTILINE)
    listed = ", ".join(rows[1:]).split(", ")
    assert sorted(listed) == sorted(case.name for case in catalogue())


# Notebooks are committed with the outputs of a run from top to bottom.


NOTEBOOKS = sorted((ROOT / "docs/notebooks").glob("*.ipynb"))


def code_cells(notebook):
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def printed(notebook):
    return [output.text for cell in code_cells(notebook) for output in cell.outputs if output.output_type == "stream"]


def has_figure(notebook):
    return any("image/png" in output.get("data", {}) for cell in code_cells(notebook) for output in cell.outputs)


def test_the_notebooks_are_stored_with_outputs_and_figures_in_less_than_300_kB():
    nbformat = pytest.importorskip("nbformat")
    assert len(NOTEBOOKS) == 2
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
def test_a_notebook_prints_what_is_stored_and_draws_a_figure(path):
    nbformat = pytest.importorskip("nbformat")
    nbclient = pytest.importorskip("nbclient")
    stored = nbformat.read(path, as_version=4)
    run = nbclient.NotebookClient(nbformat.read(path, as_version=4), timeout=300).execute()
    assert printed(run) == printed(stored), "run: .venv/bin/jupyter execute --inplace docs/notebooks/*.ipynb"
    assert has_figure(run)
