"""Checks whether a name can be part of a file name on every operating system."""

import re

MOST_BYTES = 100
"""Largest number of bytes of a name in UTF-8.

File systems allow 255 for a file name, which also contains the mesh family, the level and a suffix.
"""
RESERVED = re.compile(r"(con|prn|aux|nul|conin\$|conout\$|com[0-9¹²³]|lpt[0-9¹²³]) *(\..*)?", re.IGNORECASE | re.DOTALL)
"""Names of devices, with any suffix. Windows opens the device instead of a file of this name."""
FORBIDDEN = re.compile(r'[/\\:*?"<>|\x00-\x1f\x7f-\x9f\u2028\u2029\ud800-\udfff]')
"""Characters that must not be in file names.

They are path separators, control characters, characters that Windows refuses, and text that UTF-8 cannot encode.
"""


def file_name_fault(name: str) -> str:
    """Return the reason why a name cannot be part of a file name, as words for a message; "" if it can."""
    if not name:
        return "it is empty"
    if found := FORBIDDEN.search(name):
        return f"it contains {found[0]!r}"
    if name.startswith("."):
        return "it begins with a dot"
    if name.endswith((".", " ")) or name.startswith(" "):
        return "it begins or ends with a space, or ends with a dot"
    if (size := len(name.encode())) > MOST_BYTES:
        return f"it takes {size} bytes, at most {MOST_BYTES} are allowed"
    if RESERVED.fullmatch(name):
        return "Windows reserves it for a device"
    return ""
