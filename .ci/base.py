"""The pins of what the package needs without extras, for example: python .ci/base.py requirements/runtime.txt"""

import re
import sys
from pathlib import Path

BASE = ("numpy", "sympy", "mpmath")
"""With what SymPy needs itself."""

text = Path(sys.argv[1]).read_text(encoding="utf-8")
pins = {name: re.search(rf"^{name}==(?:.*\\\n)*.*\n", text, re.MULTILINE) for name in BASE}
for name, pin in pins.items():
    if pin is None:
        sys.exit(f"{sys.argv[1]} has no pin of {name}")
    print(pin[0], end="")
