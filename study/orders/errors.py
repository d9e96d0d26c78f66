"""The one exception of this package."""


class OrderError(ValueError):
    """A table or a sequence of errors cannot be used; the message says what was seen and the smallest edit."""
