"""How the documentation site is built: pages in Markdown, formulas as MathML, the gallery from the catalogue."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "extensions"))

project = html_title = "Signorini study"
author = "the authors of the Signorini study"
extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "sphinx_design",
    "mathml",
    "api",
    "gallery",
]
myst_enable_extensions = ["dollarmath", "colon_fence"]
myst_heading_anchors = 3
napoleon_use_ivar = True
nb_execution_mode = "force"  # the stored outputs are for readers of the repository
nb_execution_timeout = 300
nb_execution_raise_on_error = True
exclude_patterns = ["generated", "reference/columns.md"]  # included by gallery.md; a download
html_theme = "furo"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_js_files = ["gallery.js"]
html_math_renderer = "mathml"
html_show_sphinx = False
html_show_copyright = False  # LICENSE has it
html_copy_source = False
html_theme_options = {"navigation_with_keys": True}
