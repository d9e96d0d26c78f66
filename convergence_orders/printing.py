"""Makes texts of users printable: names of columns, cases and files may contain terminal escapes."""

import json
import re

INVISIBLE = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\xad\u061c\u180e\u200b-\u200f\u2028-\u202e\u2060-\u206f\ud800-\udfff\ufeff"
    "\ufff9-\uffff\U000e0000-\U000e007f]"
)
"""Control characters except line feed and tabulator, characters that change the direction of text, and surrogates.

They could command a terminal, or show a text that differs from its content. XML permits few of them.
"""


def printable(text: str, permitted: str = "") -> str:
    r"""Return a text with every control character written as in JSON, such as \u001b for Escape.

    Parameters:
        text: the text. Line feeds and tabulators remain.
        permitted: further characters that remain.

    >>> printable("L2\x1b[31m")
    'L2\\u001b[31m'
    """

    def escaped(match: re.Match[str]) -> str:
        sign = match[0]
        return sign if sign in permitted else json.dumps(sign)[1:-1]

    return INVISIBLE.sub(escaped, text)
