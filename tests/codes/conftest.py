"""The adapters, the judge and the driver lie in `examples/codes`, as users copy them, and not in a package."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "examples" / "codes"))
