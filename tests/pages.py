"""The fenced blocks of the documents, and what runs them."""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGES = sorted(
    path.relative_to(ROOT).as_posix()
    for pattern in ("README.md", "CONTRIBUTING.md", "docs/**/*.md")
    for path in ROOT.glob(pattern)
)

_BLOCK = re.compile(
    r"(?:^<!-- (?P<mark>[^\n]*) -->\n)?^```(?P<language>\w*)\n(?P<text>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)
_SHELL_CHARACTERS = re.compile(r"[|&;<>$*?`()]")
_QUOTED = re.compile(r"'[^']*'")
_EXIT = re.compile(r"# exit code (\d+)")


@dataclass(frozen=True)
class Block:
    """A fenced block.

    Attributes:
        language: The word behind the fence; empty for none.
        text: Its lines.
        mark: What the comment in the line before says: ``not run: REASON``, ``ci: NAME``.
    """

    language: str
    text: str
    mark: str

    @property
    def is_run(self) -> bool:
        """Whether the tests are to run it."""
        return not self.mark.startswith(("not run: ", "ci: "))


@dataclass(frozen=True)
class Command:
    """A command line of a page.

    Attributes:
        line: As it stands there, continued lines joined.
        code: The exit code that the page tells; 0 if it tells none.
    """

    line: str
    code: int

    @property
    def arguments(self) -> list[str] | None:
        """The arguments of a plain ``hilc`` command; None for what needs a shell."""
        line = self.line.partition(" > ")[0]
        if _SHELL_CHARACTERS.search(_QUOTED.sub("", line)):
            return None
        program, *arguments = shlex.split(line)
        return arguments if program == "hilc" else None

    @property
    def output(self) -> str | None:
        """The file into which a plain command prints; None if there is none."""
        return self.line.partition(" > ")[2] or None


def blocks(page: str) -> list[Block]:
    """The fenced blocks of a page, by its path from the top of the checkout."""
    text = (ROOT / page).read_text(encoding="utf-8")
    return [
        Block(found["language"], found["text"], found["mark"] or "")
        for found in _BLOCK.finditer(text)
    ]


def commands(block: Block) -> list[Command]:
    """The command lines of a ``sh`` block."""
    found = []
    for line in block.text.replace("\\\n", " ").splitlines():
        command, _, _ = line.partition(" #")
        if command.strip() and not command.startswith("#"):
            told = _EXIT.search(line)
            found.append(Command(command.strip(), int(told[1]) if told else 0))
    return found
