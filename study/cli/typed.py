"""Commands as they would be typed, to be given back in messages."""

from __future__ import annotations

import argparse
import shlex
from collections.abc import Sequence
from pathlib import Path


def run_line(options: argparse.Namespace, levels: Sequence[int] | None = None, out: Path | None = None) -> str:
    """``study run`` with what was asked for, on other levels and into another directory where they are given."""
    words = ["study", "run", *(["--full"] if options.plan == "full" else [])]
    words += ["--case", *options.case] if options.case else []
    chosen = levels or options.levels
    words += ["--levels", *map(str, chosen)] if chosen else []
    words += ["--scheme", options.scheme] if options.scheme != "midpoint" else []
    words += ["--step", f"{options.step:g}"] if options.step is not None else []
    words += ["--out", str(out)] if out else []
    return shlex.join(words)
