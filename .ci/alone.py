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
from manufactured import named, prove

EXPECTED = {"convergence-orders", "signorini-study", "numpy", "sympy", "mpmath"}
TOOLS = {"pip", "setuptools", "wheel"}
"""What an environment begins with."""
PROVED = ("rotated", "yield-and-release", "rough-trace", "cube-disc")
"""Cases that prove themselves: a moving front, law (3.3), a field that is singular, and one in space."""

assert "site-packages" in str(manufactured.__file__), f"{manufactured.__file__} is not the installed package"
versions = {distribution.metadata["Name"].lower(): distribution.version for distribution in distributions()}
found = set(versions) - TOOLS
assert found == EXPECTED, f"installed are {sorted(found)}, expected {sorted(EXPECTED)}"

examples = 0
for module in pkgutil.walk_packages(manufactured.__path__, "manufactured."):
    tried = doctest.testmod(importlib.import_module(module.name))
    assert tried.failed == 0, module.name
    examples += tried.attempted
assert examples, "no docstring has an example"

(snippet,) = re.findall(r"```python\n(.*?)```", Path(sys.argv[1]).read_text(encoding="utf-8"), re.DOTALL)
exec(compile(snippet, sys.argv[1], "exec"))

for name in PROVED:
    prove(named(name).solution, name)

command = [str(Path(sys.executable).with_name("study"))]
assert subprocess.run([*command, "--version"], check=True, capture_output=True).stdout.startswith(b"study ")
errors = "h,L2\n0.4,0.16\n0.2,0.04\n0.1,0.01\n"
for judge in ([*command, "rates"], [str(Path(sys.executable).with_name("convergence-orders"))]):
    judged = subprocess.run([*judge, "-", "--expected", "2"], input=errors, check=True, capture_output=True, text=True)
    assert judged.stdout.startswith("L2: holds"), judged.stdout
told = subprocess.run([*command, "tables"], check=False, capture_output=True, text=True)
assert told.returncode == 2
assert "python -m pip install '.[study]'" in told.stderr, told.stderr
said = ", ".join(f"{name} {versions[name]}" for name in sorted(found))
print(f"{examples} lines of examples, the README and the proofs of {len(PROVED)} cases run with {said}")
