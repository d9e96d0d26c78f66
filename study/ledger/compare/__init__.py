"""Which numbers, orders and verdicts of two result directories differ, and by how much: ``study compare``.

Files of the same bytes are not read further; in others rows are found by what identifies them, wherever they stand.
Nothing is solved or written here. What made the data (``provenance.json``) is not compared.
"""

from __future__ import annotations

from study.ledger.compare.closeness import Tolerance
from study.ledger.compare.directories import Comparison, compare
from study.ledger.compare.shown import as_json, as_text

__all__ = ["Comparison", "Tolerance", "as_json", "as_text", "compare"]
