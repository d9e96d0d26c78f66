"""Weighs the code, and fails if it is heavier than `.ci/limits.toml` records: limits only go down.

Usage: `.venv/bin/python .ci/weight.py [--record]`. With `--record`, limits that are larger than today's weights are
lowered to them.

Code is weighed by the expressions of its syntax tree, because shorter or denser lines do not make it easier to read.
"""

import ast
import math
import re
import subprocess
import sys
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LIMITS = ROOT / ".ci" / "limits.toml"
PRODUCT = ("study", "manufactured", "convergence_orders", "pytest_convergence_orders.py")
WEB = (".toml", ".html", ".css", ".js", ".j2")
JUDGE = "contact_judge.py"
DENSE = ("checker.py", JUDGE)
"""Programs in one file that others copy: their density is not limited."""
MOST_PER_LINE = 5.5
"""The limit of a room that `.ci/limits.toml` does not list, in expressions for each line."""


@dataclass(frozen=True)
class Weight:
    """The weight of a Python file: expressions and lines without docstrings, comments and blank lines; constants."""

    expressions: int
    lines: int
    constants: frozenset[str]


def weigh(text: str) -> Weight:
    """Return the weight of the text of a Python file."""
    tree = ast.parse(text)
    expressions, docstrings = 0, set()
    for node in ast.walk(tree):
        expressions += isinstance(node, ast.expr)
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            expressions -= 1
            docstrings.update(range(node.lineno, node.end_lineno + 1))
    lines = 0
    for number, line in enumerate(text.splitlines(), start=1):
        code = line.strip()
        if code and not code.startswith("#") and number not in docstrings:
            lines += 1
    return Weight(expressions, lines, frozenset(constants(tree)))


def constants(tree: ast.Module) -> set[str]:
    """Return the upper-case names that a module assigns."""
    names = set()
    for statement in tree.body:
        if isinstance(statement, ast.Assign | ast.AnnAssign):
            for node in ast.walk(statement):
                if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store) and node.id.isupper():
                    names.add(node.id)
    return names


def room(path: str) -> str:
    """Return the room of a file: a folder of the repository or a package of `study`."""
    folders = path.split("/")[:-1]
    if not folders:
        return "other files"
    deep = folders[0] == "study"
    return "/".join(folders[: 2 if deep else 1])


def part(path: str) -> str:
    """Return the part of the repository to which a file belongs: product, tests or rest."""
    first, name = path.split("/")[0], Path(path).name
    if first in PRODUCT and name != JUDGE:
        return "product"
    return "tests" if first == "tests" else "rest"


def measured(texts: dict[str, str]) -> dict[str, float]:
    """Return the weights that are limited.

    Parameters:
        texts: path relative to the root ↦ text, for all Python files and all files with the suffixes `WEB`.
    """
    weights = dict.fromkeys(("product", "tests", "rest", "files", "web_lines"), 0.0)
    expressions, lines, meanings = Counter(), Counter(), Counter()
    for path, text in texts.items():
        if path.endswith(WEB):
            weights["web_lines"] += len(text.splitlines())
            continue
        weight = weigh(text)
        weights[part(path)] += weight.expressions
        if part(path) == "product":
            weights["files"] += 1
            meanings.update(weight.constants)
        if Path(path).name not in DENSE:
            expressions[room(path)] += weight.expressions
            lines[room(path)] += weight.lines
    repeated = sorted(name for name, count in meanings.items() if count > 1)
    print("upper-case names that several modules define:", *repeated)
    weights["repeated_constants"] = len(repeated)
    for name in sorted(expressions):
        density = expressions[name] / max(lines[name], 1)
        weights[f"{name} per line"] = math.ceil(10 * density) / 10
    return weights


def compare(weights: dict[str, float], path: Path, record: bool) -> int:
    """Print weights with their limits, and return the exit code: 1 if a weight exceeds its limit.

    Parameters:
        weights: name ↦ today's weight.
        path: the file with the limits.
        record: whether larger limits are lowered to today's weights.
    """
    text = path.read_text("utf-8")
    code = 0
    for name, weight in weights.items():
        entry = re.compile(rf'^("?{re.escape(name)}"? = )([\d.]+)', re.MULTILINE)
        found = entry.search(text)
        limit = float(found[2]) if found else MOST_PER_LINE
        print(f"{name:32}{weight:>10g}  of at most {limit:g}")
        if weight > limit:
            code = 1
            print(f"{name} is too heavy: delete, merge or use a library ({path})", file=sys.stderr)
        elif record:
            text = entry.sub(rf"\g<1>{weight:g}", text)
    if record:
        path.write_text(text, encoding="utf-8")
    return code


def main() -> int:
    """Weigh all files of the repository, with new ones that git does not ignore."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout.splitlines()
    texts = {}
    for path in sorted(set(listed)):
        file = ROOT / path
        if file.suffix in (".py", *WEB) and file.is_file():
            texts[path] = file.read_text("utf-8")
    return compare(measured(texts), LIMITS, "--record" in sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
