"""How many random examples a test takes if one of them takes more than a twentieth of a second."""

from hypothesis import settings

COSTLY = settings(max_examples=settings.default.max_examples // 4)
