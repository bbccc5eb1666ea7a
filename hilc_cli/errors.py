"""Every expected failure of hilc: one base class, each with the exit code it leads to."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from hilc_cli.wording import near_name, printable, shortened

MOST_PROBLEMS = 100
"""So many problems are told one by one."""


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

    @classmethod
    def of(cls, where: object, path: str, message: str) -> InvalidInputError:
        """Returns the error of a single `Problem`."""
        return cls([Problem(str(where), path, message)])


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


def needed(option: str, package: str, extra: str) -> Any:
    """The package that an option needs.

    Raises:
        MissingPackageError: It is not installed.
    """
    try:
        return import_module(package)
    except ImportError:
        raise MissingPackageError(option, package.partition(".")[0], extra) from None


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


class PlantError(HilcError):
    """A robot that is simulated cannot go on.

    Args:
        plant: What the scenario calls it.
        problem: What has happened, and what to do about it.
    """

    def __init__(self, plant: str, problem: str) -> None:
        super().__init__(printable(f"plant {shortened(plant, 60)}: {problem}"))
