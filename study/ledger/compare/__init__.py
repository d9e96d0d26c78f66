"""Which numbers, orders and verdicts of two result directories differ, and by how much: ``study compare``."""

from __future__ import annotations

from study.ledger.compare.difference import Comparison, Tolerance, compare
from study.ledger.compare.shown import as_json, as_text

__all__ = ["Comparison", "Tolerance", "as_json", "as_text", "compare"]
