"""The adapters, the judge and the driver lie in `examples/codes`, as users copy them, and not in a package."""

import sys

from places import CODES

sys.path.insert(0, str(CODES))
