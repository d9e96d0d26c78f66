"""Writes the files that the README tells to save, under the names it gives them, into the working directory."""

import re
from pathlib import Path

README = Path(__file__).parents[1] / "README.md"

text = README.read_text(encoding="utf-8")
saved = re.findall(r"```python\n([^`]*)```\n\nSaved as `([^`]+)`", text)
saved += [(block, name) for name, block in re.findall(r"`([^`]+)`:\n\n```csv\n([^`]*)```", text)]
for block, name in saved:
    Path(name).write_text(block, encoding="utf-8")
    print(name)
