"""The readings of the paper: its law as printed, and one under which other claims hold."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from hilc_cli.errors import UsageError
from hilc_cli.wording import suggestion

TAU = 0.1
"""tau [s] of the derivative reading; "above 20 unstable" of Section 4.2.1 is about 2 / tau."""


@dataclass(frozen=True, slots=True)
class StartHeading:
    """The heading of a wrong start that a reading takes for a misprint.

    Attributes:
        printed: As the paper has it.
        read: As it is read.
    """

    printed: str
    read: str

    def __str__(self) -> str:
        """Both, such as ``7π/15, printed: 14π/15``."""
        return f"{self.read}, printed: {self.printed}".replace("*pi", "π")


@dataclass(frozen=True, slots=True, eq=False)
class Reading:
    """What the paper's experiments are taken to be.

    Attributes:
        name: As on the command line, in names of files and in tables.
        law: What the law is, for the heading of a figure.
        explanation: What is read as printed and what is not, in a sentence.
        derivative: tau [s], see `HybridLaw.derivative`.
        starts: Headings that are not taken as printed, by the names of the examples.
    """

    name: str
    law: str
    explanation: str
    derivative: float = 0.0
    starts: Mapping[str, StartHeading] = field(default_factory=lambda: MappingProxyType({}))

    def values(self, example: str) -> dict[str, object]:
        """What an example has otherwise than it is shipped, by dotted key."""
        values: dict[str, object] = {}
        if self.derivative:
            values["controller.gains.derivative"] = self.derivative
        if example in self.starts:
            values["initial_pose.heading"] = self.starts[example].read
        return values

    def overrides(self, example: str) -> list[str]:
        """The same as texts ``KEY=VALUE``, as they follow ``--set``."""
        return [f"{key}={value}" for key, value in self.values(example).items()]


LITERAL = Reading(
    "literal",
    "law as printed",
    "the law and all starts as printed",
)
DERIVATIVE = Reading(
    "derivative",
    f"l₁ acts on e + τ de/dt, τ = {TAU:g} s",
    "l1 acts on e_i(k+1) + tau [e_i(k+1) - e_i(k)] / d_k instead of e_i(k+1), the compensation is "
    f"taken times tau, tau = {TAU:g} s, and two wrong starts are taken for misprints: headings of "
    "7 pi/15 (cardioid) and 31 pi/60 (spiral) for the printed 14 pi/15 and 31 pi/30",
    TAU,
    MappingProxyType(
        {
            "fig5-cardioid": StartHeading("14*pi/15", "7*pi/15"),
            "fig5-spiral": StartHeading("31*pi/30", "31*pi/60"),
        }
    ),
)
READINGS = (LITERAL, DERIVATIVE)
BOTH = "both"
CHOICES = (*(reading.name for reading in READINGS), BOTH)
NEITHER_IS_THE_AUTHORS = (
    "Which of the two the authors ran, if either, is not known: the second was found by trying "
    "what else may have been meant, and its tau was chosen for what comes of it."
)


def readings_named(choice: str) -> tuple[Reading, ...]:
    """The readings of a choice, in their order.

    Args:
        choice: The name of one, or ``both``.

    Raises:
        UsageError: There is no such reading.
    """
    if choice not in CHOICES:
        raise UsageError(f"{choice}: is no reading of the paper; {suggestion(choice, CHOICES)}")
    return tuple(reading for reading in READINGS if choice in (reading.name, BOTH))
