"""``study cases``: lists the exact solutions.

The list is read from the docstrings of the cases, because making all solutions takes seconds; ``--json`` makes them.
"""

import ast
import re
from argparse import Namespace
from functools import cache
from importlib.resources import files
from json import dumps
from textwrap import fill

from manufactured.catalogue import MODULES, NAMES, OTHER_NAMES, catalogue, function_of
from study.cli.options import OK

LINE_WIDTH = 100
"""Characters in a printed line."""
INDENT = "    "


def do_cases(options: Namespace) -> int:
    """Print the exact solutions of the catalogue; return 0."""
    if options.json:
        # Imported here, because SymPy takes a second.
        from study.fem.naming import describe

        print(dumps([describe(case) for case in catalogue()], indent=2))
        return OK
    for name in NAMES:
        summary, order = summary_and_order(name)
        print(f"{name:<24}order {order}")
        print(fill(summary, LINE_WIDTH, initial_indent=INDENT, subsequent_indent=INDENT))
    print(f"Further cases, which only single statements use: {', '.join(OTHER_NAMES)}")
    return OK


def summary_and_order(name: str) -> tuple[str, str]:
    """Return the first sentence and the predicted order in the docstring of a case, without making the case."""
    text = docstrings(MODULES[name])[function_of(name)]
    order = re.search(r"^Predicted order (\d+(?:[./]\d+)?)", text, re.MULTILINE)
    return text.partition("\n\n")[0].replace("\n", " ").replace("``", ""), order[1] if order else "unknown"


@cache
def docstrings(module: str) -> dict[str, str]:
    """Return the docstrings of the functions in a module of cases, by the names of the functions, without importing it.

    Parameters:
        module: the name of the module in ``manufactured.cases``.
    """
    tree = ast.parse((files("manufactured.cases") / f"{module}.py").read_text(encoding="utf-8"))
    functions = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
    return {node.name: ast.get_docstring(node) or "" for node in functions}
