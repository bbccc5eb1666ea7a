"""What becomes of each law of a leaderboard in each case."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from hilc_cli.results.in_notebooks import InNotebooks
from hilc_cli.wording import in_short, listed

if TYPE_CHECKING:
    from pandas import DataFrame


@dataclass(frozen=True, slots=True)
class Entry:
    """One law in one case.

    Errors are position errors over the second half of the trajectory, unless something else is
    said. A run that diverges has infinite errors from there on.

    Attributes:
        case: Name of the case.
        belief: Name of what the controller believes.
        disturbance: Name of the disturbance.
        law: Name of the law.
        max_m: Largest error after each number of iterations that is looked at [m].
        mean_m: Mean error, likewise [m].
        whole_max_m: Largest error over the whole path, likewise [m].
        within_at: First iteration whose largest error is within the tolerance; None if none is.
        within_share: Share of the iterations from that one to the last that are; None likewise.
        settled_at: First iteration from which on the largest error keeps the tolerance; None if
            the last does not.
        peak_m: Largest error over the whole path in any iteration but 0, which is mostly the first
            input alone and tells nothing of the law [m]; None if there is no other.
        fastest_wheel_rad_s: Largest wheel speed in any iteration [rad/s].
        speed_limit_rad_s: b_w [rad/s]; None for no limit.
        diverged_at: The iteration that left the finite numbers; None if none did.
        seconds_per_iteration: Processor time of the whole program for an iteration in the loop
            engine [s].
    """

    case: str
    belief: str
    disturbance: str
    law: str
    max_m: tuple[float, ...]
    mean_m: tuple[float, ...]
    whole_max_m: tuple[float, ...]
    within_at: int | None
    within_share: float | None
    settled_at: int | None
    peak_m: float | None
    fastest_wheel_rad_s: float
    speed_limit_rad_s: float | None
    diverged_at: int | None
    seconds_per_iteration: float

    @property
    def keeps_limit(self) -> bool | None:
        """Whether no wheel was faster than the limit in any sample of any iteration.

        None if there is no limit.
        """
        limit = self.speed_limit_rad_s
        return None if limit is None else self.fastest_wheel_rad_s <= limit


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class LeaderboardData(InNotebooks):
    """The entries of a leaderboard.

    Attributes:
        name: Of the leaderboard.
        after: Numbers of iterations after which errors are told.
        tolerance: Largest error that counts as reached [m].
        entries: Cases in their order; of each the beliefs, the disturbances, and the laws.
    """

    name: str
    after: tuple[int, ...]
    tolerance: float
    entries: tuple[Entry, ...]

    def __repr__(self) -> str:
        title = f"LeaderboardData {self.name!r}: {len(self.entries)} runs"
        return in_short(title, f"laws: {listed(self.laws)}")

    def to_pandas(self) -> DataFrame:
        """A data frame of pandas with a row per run and the columns of leaderboard.csv.

        Raises:
            MissingPackageError: pandas is not installed.
        """
        from hilc_cli.leaderboards.tables import entries_table  # which is made of this

        return entries_table(self).to_pandas()

    @property
    def laws(self) -> tuple[str, ...]:
        """Names of the laws in their order."""
        return tuple(dict.fromkeys(entry.law for entry in self.entries))

    @property
    def disturbances(self) -> tuple[str, ...]:
        """Names of the disturbances in their order."""
        return tuple(dict.fromkeys(entry.disturbance for entry in self.entries))

    def of(self, law: str, disturbance: str) -> list[Entry]:
        """The entries of a law with a disturbance."""
        return [
            entry for entry in self.entries if entry.law == law and entry.disturbance == disturbance
        ]

    @property
    def settings(self) -> tuple[tuple[str, str], ...]:
        """Beliefs with disturbances in their order."""
        return tuple(dict.fromkeys((entry.belief, entry.disturbance) for entry in self.entries))
