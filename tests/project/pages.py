"""The pages that people read, and the blocks of code on them."""

import re
import shlex
from dataclasses import dataclass
from functools import cached_property
from itertools import takewhile
from pathlib import Path

from places import ROOT

BLOCK = re.compile(
    r"^(?P<fence>`{3,})(?P<language>[^\n]*)\n(?::caption: (?P<name>\S+)\n\n)?(?P<text>.*?)^(?P=fence)$",
    re.DOTALL | re.MULTILINE,
)


@dataclass(frozen=True)
class Page:
    """A page in Markdown.

    Its blocks with a caption, or with a name after ``python``, are files to save under that name. Other Python blocks
    are run in one session, from top to bottom. Blocks of the shell are typed in the directory of the files. Blocks of
    text are printed by the block before them.
    """

    path: Path

    @property
    def name(self):
        return str(self.path.relative_to(ROOT))

    @cached_property
    def text(self):
        return self.path.read_text(encoding="utf-8")

    @cached_property
    def prose(self):
        return re.sub(r"^\|.*?$", "", BLOCK.sub("", self.text), flags=re.MULTILINE)

    @cached_property
    def blocks(self):
        """Language, name and text of all blocks; those with a name are files to save."""
        found = []
        for block in BLOCK.finditer(self.text):
            language, _, name = block["language"].strip().partition(" ")
            saved = block["name"] or (name if language == "python" else "")
            found.append((language, saved, block["text"]))
        return found

    @property
    def files(self):
        """Name ↦ content of what the page tells to save."""
        return {name: text for _, name, text in self.blocks if name}

    @property
    def downloads(self):
        return [self.path.with_name(name) for name in re.findall(r"{download}`([^`]+)`", self.text)]

    @property
    def session(self):
        return "\n".join(text for language, name, text in self.blocks if language == "python" and not name)

    def printed(self, by):
        """What the page says that its Python, or its shell, prints: blocks of text after one of these."""
        found = []
        last = ""
        for language, name, text in self.blocks:
            if language == "text" and last == by:
                found.append(text)
            elif language in ("python", "sh") and not name:
                last = language
        return found

    @property
    def prepared(self):
        """The commands of the study that are typed before the Python is run."""
        before = takewhile(lambda block: block[:2] != ("python", ""), self.blocks)
        return [line for line in typed_in(before) if words(line)[0] == "study"]

    @property
    def typed(self):
        return typed_in(self.blocks)


def typed_in(blocks):
    """The lines of the blocks of the shell."""
    shell = "".join(text for language, _, text in blocks if language == "sh").replace("\\\n", " ")
    return [line for line in shell.splitlines() if line.strip()]


def words(line):
    """A line for the shell without its comment, the program by its plain name."""
    return shlex.split(line.removeprefix(".venv/bin/"), comments=True)


SITE = [Page(path) for path in sorted((ROOT / "docs").rglob("*.md")) if "generated" not in path.parts]
README = Page(ROOT / "README.md")
PAGES = [README, Page(ROOT / "examples/README.md"), *SITE]
