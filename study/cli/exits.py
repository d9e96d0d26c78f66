"""The exit codes of ``study``."""

OK, FAILED, USAGE, INTERRUPTED, CLOSED = 0, 1, 2, 130, 141
"""All that was asked for; a claim that does not hold, or an error; usage, also where what a command needs is not there;
Ctrl-C; the reader of the output has gone."""
