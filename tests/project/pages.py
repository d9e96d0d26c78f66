"""The pages that people read, and the blocks of code on them."""

import re
import shlex
from dataclasses import dataclass
from functools import cached_property
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

    @property
    def files(self):
        """Name ↦ content of what the page tells to save."""
        named = {block["language"].partition(" ")[2]: block["text"] for block in BLOCK.finditer(self.text)}
        python = {name: text for name, text in named.items() if name.endswith(".py")}
        return python | {block["name"]: block["text"] for block in BLOCK.finditer(self.text) if block["name"]}

    @property
    def downloads(self):
        return [self.path.with_name(name) for name in re.findall(r"{download}`([^`]+)`", self.text)]

    @property
    def session(self):
        return "\n".join(self._blocks(self.text, "python"))

    def printed(self, by):
        """What the page says that its Python, or its shell, prints: blocks of text after one of these."""
        found, last = [], ""
        for block in BLOCK.finditer(self.text):
            language = block["language"].strip()
            if language == "text" and last == by:
                found.append(block["text"])
            elif language in ("python", "sh") and not block["name"]:
                last = language
        return found

    @property
    def prepared(self):
        """The commands of the study that are typed before the Python is run."""
        before = self.text.partition("\n```python\n")[0]
        return [line for line in self._lines(before) if words(line)[0] == "study"]

    @property
    def typed(self):
        return self._lines(self.text)

    @classmethod
    def _lines(cls, text):
        return [
            line
            for block in cls._blocks(text, "sh")
            for line in block.replace("\\\n", " ").splitlines()
            if line.strip()
        ]

    @staticmethod
    def _blocks(text, language):
        found = BLOCK.finditer(text)
        return [block["text"] for block in found if block["language"].strip() == language and not block["name"]]


def words(line):
    """A line for the shell without its comment, the program by its plain name."""
    return shlex.split(line.removeprefix(".venv/bin/"), comments=True)


SITE = [Page(path) for path in sorted((ROOT / "docs").rglob("*.md")) if "generated" not in path.parts]
README = Page(ROOT / "README.md")
PAGES = [README, Page(ROOT / "examples/README.md"), *SITE]
