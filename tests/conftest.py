"""Shared by all tests."""

from hypothesis import settings

# Machines differ in speed: a deadline would test the machine, not the mathematics.
settings.register_profile("study", deadline=None, max_examples=25, derandomize=True)
settings.load_profile("study")
