"""Formulas as MathML, which browsers draw without a script and without a connection.

Three errors of ``docutils`` are corrected: the digits of a fraction without braces become numerator and denominator,
the index of a letter with an accent is a subscript, and bars are as tall as letters.
"""

import html
import re
from xml.etree import ElementTree

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.writers.html5 import HTML5Translator

NAMESPACE = "http://www.w3.org/1998/Math/MathML"
BARS = "|‖"


def mathml(formula: str, as_block: bool = False) -> str:
    """Returns the MathML of a formula in LaTeX."""
    braced = re.sub(r"(\\[td]?frac)(\d)(\d)", r"\1{\2}{\3}", formula)
    ElementTree.register_namespace("", NAMESPACE)
    # XML does not know the HTML names of characters.
    found = re.sub(r"&(?!lt;|gt;|amp;)\w+;", lambda name: html.unescape(name[0]), tex2mathml(braced, as_block=as_block))
    tree = ElementTree.fromstring(found)
    for node in tree.iter():
        name = node.tag.removeprefix(f"{{{NAMESPACE}}}")
        if name == "mo" and node.text and node.text in BARS:
            node.set("stretchy", "false")
        elif name == "munderover" and node[0].tag != f"{{{NAMESPACE}}}mo":
            letter, index, accent = node
            accented = ElementTree.Element(f"{{{NAMESPACE}}}mover")
            accented.extend([letter, accent])
            node.tag, node[:] = f"{{{NAMESPACE}}}msub", [accented, index]
    return ElementTree.tostring(tree, encoding="unicode")


def inline(self: HTML5Translator, node: nodes.math) -> None:
    self.body.append(mathml(node.astext()))
    raise nodes.SkipNode


def display(self: HTML5Translator, node: nodes.math_block) -> None:
    self.body.append(f'<div class="formula">{mathml(node.astext(), as_block=True)}</div>')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_html_math_renderer("mathml", (inline, None), (display, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
