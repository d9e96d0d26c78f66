"""Prints how large the code is, next to the size that one person can maintain. Information only: exits with 0.

Usage: .venv/bin/python .ci/budget.py
"""

import ast
import io
import sys
import tokenize
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
NO_CODE = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER}


def code_lines(text: str) -> int:
    """The number of lines without blank lines, comments and docstrings."""
    strings = (node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Expr))
    docstrings = [node for node in strings if isinstance(getattr(node.value, "value", None), str)]
    tokens = [token for token in tokenize.generate_tokens(io.StringIO(text).readline) if token.type not in NO_CODE]
    lines = {line for token in tokens for line in range(token.start[0], token.end[0] + 1)}
    return len(lines - {line for node in docstrings for line in range(node.lineno, node.end_lineno + 1)})


def call_depth() -> int:
    """The largest number of nested calls in study/ and manufactured/ while one error at n = 8 is measured.

    Lambdas and comprehensions count as calls; formulas have been compiled before.
    """
    sys.path.insert(0, str(ROOT))
    from study.fem.mesh import OneDiagonal
    from study.fem.naming import resolve
    from study.solve.tableau import MIDPOINT
    from study.statements.prop_5_4 import measure_case

    project, depth, deepest = (f"{ROOT}/study/", f"{ROOT}/manufactured/"), 0, 0

    def count(frame, event, _):
        nonlocal depth, deepest
        if event in ("call", "return") and frame.f_code.co_filename.startswith(project):
            depth += 1 if event == "call" else -1
            deepest = max(deepest, depth)

    case = resolve("advance-recede")
    for profile in (None, count):
        sys.setprofile(profile)
        measure_case(case, OneDiagonal(), 8, MIDPOINT, 32)
    sys.setprofile(None)
    return deepest


def main() -> None:
    study = [path.read_text("utf-8") for path in ROOT.glob("study/**/*.py") if path.name != "checker.py"]
    tests = [path.read_text("utf-8") for path in ROOT.glob("tests/**/*.py")]
    nodes = [node for text in study for node in ast.walk(ast.parse(text))]
    try:
        depth = call_depth()
    except Exception as error:  # A renamed function must not fail the check of the style.
        depth = f"not measured: {error}"
    rows = [
        ("code lines in study/", sum(map(code_lines, study)), 16_000, 18_500),
        ("functions in study/", sum(isinstance(node, ast.FunctionDef) for node in nodes), 1600, 1800),
        ("files in study/", len(study), 170, 190),
        ("call depth of one error at n = 8", depth, 16, 16),
        ("lines in tests/", sum(len(text.splitlines()) for text in tests), 16_000, 18_000),
    ]
    print(f"{'':34}{'today':>8}{'goal':>8}{'at most':>9}   (study/ without certify/checker.py)")
    for name, today, goal, most in rows:
        print(f"{name:34}{today:>8}{goal:>8}{most:>9}")


if __name__ == "__main__":
    main()
