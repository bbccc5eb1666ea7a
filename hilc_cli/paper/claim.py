"""A claim of the paper, and what measuring it gave."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum

from hilc_cli.paper.reading import Reading
from hilc_cli.results.run import RunData


class Verdict(StrEnum):
    """What the measured figures say of a claim."""

    HOLDS = "holds"
    IN_PART = "holds in part"
    FAILS = "does not hold"


@dataclass(frozen=True, slots=True)
class Figure:
    """A measured figure that a verdict rests on.

    Attributes:
        name: What was measured, such as ``maximum error, circle``.
        value: The figure; None where there is none, such as an iteration that was never reached.
        unit: Its unit; empty for a plain number.
    """

    name: str
    value: float | None
    unit: str = ""


@dataclass(frozen=True, slots=True)
class Finding:
    """The verdict on a claim with what decides it.

    Attributes:
        verdict: Computed from the figures by the claim's criterion.
        figures: The measured figures.
        reason: Why the claim does not hold, or not entirely, in sentences that can be checked;
            empty where it holds.
    """

    verdict: Verdict
    figures: tuple[Figure, ...]
    reason: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """What a claim is judged by: runs under one reading.

    Attributes:
        reading: How the paper is read.
        runs: Runs of the shipped scenarios under it by name, all iterations of theirs measured.
    """

    reading: Reading
    runs: Mapping[str, RunData]

    def __getitem__(self, name: str) -> RunData:
        """The run of a shipped scenario."""
        return self.runs[name]


@dataclass(frozen=True, slots=True)
class Claim:
    """Something that the paper says, and how it is put to the test.

    Attributes:
        name: Short name, such as ``F3-1``.
        sentence: What the text of the paper says, in our words.
        place: Where in the paper it stands.
        measured: What is measured.
        criterion: When it holds and when it holds in part; stated before measuring, and the same
            for every reading.
        judge: Measures and decides.
        needs_runs: Whether it looks at the runs of the shipped scenarios; if not, it is judged
            beside them.
    """

    name: str
    sentence: str
    place: str
    measured: str
    criterion: str
    judge: Callable[[Evidence], Finding]
    needs_runs: bool = True
