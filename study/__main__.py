"""Runs the ``study`` command as ``python -m study``."""

from __future__ import annotations

import sys

from study.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
