"""What is refused before time is spent."""

from __future__ import annotations


class UsageError(ValueError):
    """A command was given something it cannot use."""
