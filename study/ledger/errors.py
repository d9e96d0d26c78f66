"""Errors of the commands that say what was given, what was expected and how to mend it."""

from __future__ import annotations


class UsageError(ValueError):
    """A command was given something it cannot use."""


class JobsError(RuntimeError):
    """Some jobs raised; the others are finished and kept."""
