"""Deliberate faults, which checks must notice (``study faults``), and fresh random meshes (``study seeds``)."""
