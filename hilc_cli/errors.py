"""Every expected failure of hilc: one base class, each with the exit code it leads to."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches

MOST_PROBLEMS = 100
"""So many problems are told one by one."""
_SHORT = 6


@dataclass(frozen=True, slots=True)
class Problem:
    """One thing that is wrong with what the user wrote, and where.

    Attributes:
        where: ``FILE:LINE:COLUMN``, or the command-line option that holds the value.
        path: Dotted path of the key, such as ``robot.wheel_radius``; empty for the whole file.
        message: What is wrong, the value that was found, and what is allowed.
    """

    where: str
    path: str
    message: str

    def __str__(self) -> str:
        parts = (shortened(self.where), shortened(self.path), self.message)
        return printable(": ".join(part for part in parts if part))


class HilcError(Exception):
    """Base of all failures that end in one line on stderr instead of a traceback."""

    exit_code = 1


class InvalidInputError(HilcError):
    """A file or an override is not valid; carries every problem that was found."""

    exit_code = 2

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems = tuple(problems)
        lines = [str(problem) for problem in self.problems[:MOST_PROBLEMS]]
        if len(self.problems) > MOST_PROBLEMS:
            lines.append(f"... and {len(self.problems) - MOST_PROBLEMS} more problems")
        super().__init__("\n".join(lines))


class UsageError(HilcError):
    """The command line, or a call of the Python interface, asks for something that is not there."""

    exit_code = 2


class UnknownNameError(UsageError, KeyError):
    """A mapping has no such key; says which it has."""

    def __init__(self, what: str, name: object, known: Iterable[object]) -> None:
        """Words the message.

        Args:
            what: What the keys are, such as ``metric``.
            name: What was asked for.
            known: All keys.
        """
        keys = [str(key) for key in known]
        near = near_name(name, keys) if isinstance(name, str) else None
        meant = f"did you mean '{near}'? " if near else ""
        super().__init__(f"there is no {what} {name!r}; {meant}known: {', '.join(keys) or 'none'}")

    def __str__(self) -> str:
        """The message; a plain KeyError would put quotes around it."""
        return str(self.args[0])


class MissingPackageError(UsageError):
    """An option needs a package that is not installed.

    Args:
        option: What was asked for.
        package: The package that it needs.
        extra: The extra of hilc that brings it; it is told as for a checkout, which hilc comes as.
    """

    def __init__(self, option: str, package: str, extra: str) -> None:
        super().__init__(
            f"{option} needs the package {package}; pip install '.[{extra}]' in a checkout of hilc"
        )


class MissingFileError(UsageError):
    """There is no such file."""


class FileAccessError(HilcError):
    """A file or folder could not be read or written."""


class ExistingResultsError(HilcError):
    """The output folder holds something that must not be overwritten."""


class DivergedError(HilcError):
    """A simulation left the finite numbers.

    Attributes:
        iteration: The iteration that could not be completed.
    """

    exit_code = 3

    def __init__(self, iteration: int) -> None:
        self.iteration = iteration
        super().__init__(f"the simulation diverged to non-finite values in iteration {iteration}")


def suggestion(word: str, known: Iterable[str]) -> str:
    """The nearest known word as ``did you mean 'x'?``, or the list of all known words."""
    known = list(known)
    near = near_name(word, known)
    return f"did you mean '{near}'?" if near else f"known: {', '.join(sorted(known))}"


def near_name(word: str, known: Sequence[str]) -> str | None:
    """The nearest known name; if none is near, the first that has all words of what was written.

    So ``max_position_error_m`` is meant by ``max_error``.
    """
    near = near_word(word, known)
    words = set(_words(word))
    if near is None and len(words) > 1:
        near = next((each for each in known if words <= set(_words(each))), None)
    return near


def _words(name: str) -> list[str]:
    return name.lower().replace("-", "_").split("_")


def near_word(word: str, known: Iterable[str], alike: float = 0.7) -> str | None:
    """The nearest known word, if one is near.

    Case is ignored, digits are not: whoever writes ``fig2`` or ``l5`` has not mistyped ``fig8``
    or ``l1``.

    Args:
        word: What was written.
        known: The words that it may stand for.
        alike: How alike they must be, from 0 to 1, the ratio of `difflib`.
    """
    spellings = {each.lower(): each for each in sorted(known) if _digits(each) == _digits(word)}
    near = get_close_matches(word.lower(), spellings, n=1, cutoff=alike)
    if not near and len(word) <= _SHORT:  # a letter more or less makes a short word another
        close = get_close_matches(word.lower(), spellings, n=1, cutoff=0.6)
        near = [each for each in close if each[:3] == word.lower()[:3]]
    return spellings[near[0]] if near else None


def _digits(word: str) -> list[str]:
    return [letter for letter in word if letter.isdigit()]


def printable(text: str) -> str:
    """The text on one line, without characters that would steer a terminal."""
    return "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in text)


def shortened(text: str, most: int = 200) -> str:
    """The text, its end left out where it is long."""
    return text if len(text) <= most else f"{text[:most]}..."
