"""What a part of the analysis has to say to people."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Findings:
    """Sentences, each with its remedy.

    Attributes:
        failures: Why the experiment cannot work, the first one to be told first.
        warnings: What is possible, or not known to be impossible, but probably not meant.
    """

    failures: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


def joined(parts: Iterable[Findings]) -> Findings:
    """The findings of several parts, in their order."""
    found = list(parts)
    return Findings(
        tuple(text for part in found for text in part.failures),
        tuple(text for part in found for text in part.warnings),
    )
