"""``study rates``: another name of the command ``convergence-orders``."""

import argparse

from convergence_orders.command import main


def do_rates(options: argparse.Namespace) -> int:
    """Run the command ``convergence-orders`` with the words behind ``study rates``, and return its exit code."""
    return main(options.words, "study rates")
