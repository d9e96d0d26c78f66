"""Seeds of random examples, and how many a test takes if one of them takes more than a twentieth of a second."""

from hypothesis import settings
from hypothesis import strategies as st

SEEDS = st.integers(0, 10**6)
COSTLY = settings(max_examples=settings.default.max_examples // 4)
