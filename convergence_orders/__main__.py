"""``python -m convergence_orders`` is the command ``convergence-orders``."""

import sys

from .command import main

sys.exit(main())
