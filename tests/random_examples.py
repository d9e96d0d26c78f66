"""Generators of random examples, and how many a test takes if one of them takes more than a twentieth of a second."""

import numpy as np
from hypothesis import settings
from hypothesis import strategies as st

RANDOM = st.integers(0, 10**6).map(np.random.default_rng)
COSTLY = settings(max_examples=settings.default.max_examples // 4)
