"""Try the installed package where there are NumPy and SymPy only: python alone.py README.md"""

import doctest
import importlib
import pkgutil
import re
import subprocess
import sys
from importlib.metadata import distributions
from pathlib import Path

import manufactured

EXPECTED = {"signorini-study", "numpy", "sympy", "mpmath"}
TOOLS = {"pip", "setuptools", "wheel"}
"""What an environment begins with."""

assert "site-packages" in str(manufactured.__file__), f"{manufactured.__file__} is not the installed package"
found = {distribution.metadata["Name"].lower() for distribution in distributions()} - TOOLS
assert found == EXPECTED, f"installed are {sorted(found)}, expected {sorted(EXPECTED)}"

examples = 0
for module in pkgutil.walk_packages(manufactured.__path__, "manufactured."):
    tried = doctest.testmod(importlib.import_module(module.name))
    assert tried.failed == 0, module.name
    examples += tried.attempted
assert examples, "no docstring has an example"

(snippet,) = re.findall(r"```python\n(.*?)```", Path(sys.argv[1]).read_text(encoding="utf-8"), re.DOTALL)
exec(compile(snippet, sys.argv[1], "exec"))

command = [str(Path(sys.executable).with_name("study"))]
assert subprocess.run([*command, "--version"], check=True, capture_output=True).stdout.startswith(b"study ")
told = subprocess.run([*command, "tables"], check=False, capture_output=True, text=True)
assert told.returncode == 2
assert "python -m pip install '.[study]'" in told.stderr, told.stderr
print(f"{examples} lines of examples and the README run with {', '.join(sorted(found))}")
