"""Docstrings for Sphinx: they are plain text with ``code``, in which * and | are letters."""

import re

from sphinx.application import Sphinx


def plain(app: Sphinx, what: str, name: str, obj: object, options: object, lines: list[str]) -> None:
    """Escape what reStructuredText would read as emphasis or as a substitution, except in code."""
    lines[:] = [re.sub(r"(``.*?``)|([*|])", lambda match: match[1] or f"\\{match[2]}", line) for line in lines]


def setup(app: Sphinx) -> dict[str, bool]:
    # Before napoleon, which turns Google's sections into fields and escapes nothing.
    app.connect("autodoc-process-docstring", plain, priority=100)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
