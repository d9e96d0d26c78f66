"""Places in the repository: the committed results, examples, certificates and adapters of contact codes."""

from pathlib import Path

ROOT = Path(__file__).parents[1]
RESULTS = ROOT / "results"
DATA = RESULTS / "data"
EXAMPLES = ROOT / "examples"
CERTIFICATES = EXAMPLES / "certificates"
CODES = EXAMPLES / "codes"
