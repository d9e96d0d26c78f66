"""Links from a page of the site to the pages of the Python interface, which lie beside it in ``api/``."""

from docutils import nodes
from docutils.parsers.rst.states import Inliner
from sphinx.application import Sphinx
from sphinx.util.nodes import split_explicit_title


def api(
    name: str, rawtext: str, text: str, lineno: int, inliner: Inliner, options: object = None, content: object = None
) -> tuple[list[nodes.Node], list[nodes.system_message]]:
    """``{api}`named```: a public name of ``manufactured``; with a title, ``{api}`title <study.bound>```, a module."""
    has_title, title, target = split_explicit_title(text)
    page = target.replace(".", "/") + ".html" if has_title else f"manufactured.html#{target}"
    up = "../" * inliner.document.settings.env.docname.count("/")
    link = nodes.reference("", "", nodes.literal("", title), refuri=f"{up}api/{page}", internal=False)
    return [link], []


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_role("api", api)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
