"""What is kept of the iterations that moved, to tell repeated noise from new one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hilc_cli.laws.norm_optimal.level_fit import Contrasts, Earlier, LevelFit
from hilc_cli.reference.sampled import Floats


@dataclass(frozen=True, slots=True, eq=False)
class SeenMotion:
    """What was measured, and what the wheels did for it; of one iteration, or the mean of several.

    Attributes:
        headings: Measured headings [rad], shape (n + 1,).
        turned: Summed differences of the wheel speeds [rad/s], shape (n + 1,).
        steps: Measured steps in x and y [m], shape (n, 2).
        driven: Sums of the wheel speeds along the heading, in x and y [rad/s], shape (n, 2).
    """

    headings: Floats
    turned: Floats
    steps: Floats
    driven: Floats


@dataclass(frozen=True, slots=True, eq=False)
class EarlierMotion:
    """The iterations before.

    Attributes:
        iterations: Their number, >= 1.
        mean: Of what was seen in them.
        of_turn: Their contrasts in the fit of the turn gain.
        of_distance: Likewise of the distance gain.
    """

    iterations: int
    mean: SeenMotion
    of_turn: Contrasts
    of_distance: Contrasts

    def turning(self) -> Earlier:
        """For the fit of the turn gain."""
        return Earlier(self.iterations, self.mean.headings, self.mean.turned, self.of_turn)

    def ahead(self, along: Floats) -> Earlier:
        """For the fit of the distance gain, along the unit vectors of the steps, shape (n, 2)."""
        went, drove = (
            summed(np.sum(parts * along, axis=1)) for parts in (self.mean.steps, self.mean.driven)
        )
        return Earlier(self.iterations, went, drove, self.of_distance)


def with_latest(
    earlier: EarlierMotion | None, latest: SeenMotion, turn: LevelFit, distance: LevelFit
) -> EarlierMotion:
    """The iterations before the next: those before the last, and the last."""
    if earlier is None:
        return EarlierMotion(1, latest, turn.contrasts, distance.contrasts)
    count, mean = earlier.iterations + 1, earlier.mean
    return EarlierMotion(
        count,
        SeenMotion(
            mean.headings + (latest.headings - mean.headings) / count,
            mean.turned + (latest.turned - mean.turned) / count,
            mean.steps + (latest.steps - mean.steps) / count,
            mean.driven + (latest.driven - mean.driven) / count,
        ),
        turn.contrasts,
        distance.contrasts,
    )


def summed(steps: Floats) -> Floats:
    """The sums of all steps before each sample."""
    return np.concatenate([[0.0], np.cumsum(steps)])
