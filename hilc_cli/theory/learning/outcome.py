"""Whether learning is expected to work, in one word: the only place where that is decided."""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple

import numpy as np

from hilc_cli.reference.sampled import Floats

NEAR = 0.01
"""Share of the path's size up to which an error counts as small."""
CLEARLY = 2.0
"""Times: what grows or falls by less counts as staying."""
STAYS = 0.8
"""Share of the first error from which on the last one, predicted, surely is not half of it."""


class Outcome(StrEnum):
    """What learning is expected to do within an experiment's iterations, and afterwards."""

    CANNOT_CONVERGE = "cannot-converge"
    """The spectral radius is not below 1, and the error does not fall before that shows."""
    MADE_WORSE = "made-worse"
    """The last error is twice that of iteration 0 and more, and not small."""
    DOES_NOT_LEARN = "does-not-learn"
    """The last error is neither half of that of iteration 0 nor small."""
    OUT_OF_RANGE = "out-of-range"
    """The last error is out of the range of the linear theory, so that it does not tell."""
    DROWNED = "drowned-by-disturbances"
    """It would fall, but disturbances may leave as large an error as iteration 0 has."""
    GROWS_WITHIN = "learns-then-grows-within"
    """The error falls, but the last one is at least twice the smallest, and not small."""
    GROWS_LATER = "learns-then-grows-later"
    """It falls within the experiment's iterations, and grows again after them."""
    LEARNS = "learns"
    """It falls to less than half of that of iteration 0, or is small, or was without noise."""
    NOTHING = "nothing-to-learn"
    """The experiment has no learning updates."""


class Prospects(NamedTuple):
    """What an outcome depends on.

    Attributes:
        errors: Largest position errors of the experiment's iterations, without disturbances [m].
        later: Likewise of later ones, as far as they can be foretold.
        extent: Beside which errors are large or small [m].
        settles: Whether the spectral radius may be below 1.
        rests: Whether there may be a motion near the path to rest at.
        ripples_grow: Whether an iteration makes some ripple of the wheel speeds grow.
        is_far: Whether the last iteration is out of the range of the linear theory.
        disturbed_first: Errors of iteration 0 with disturbances, one for each seed [m].
        disturbed_last: Likewise of the last iteration.
    """

    errors: Floats
    later: Floats
    extent: float
    settles: bool = True
    rests: bool = True
    ripples_grow: bool = False
    is_far: bool = False
    disturbed_first: Floats = np.zeros(0)
    disturbed_last: Floats = np.zeros(0)


def predicted_outcome(found: Prospects) -> Outcome:
    """Returns the outcome; without disturbances first, since what they spoil has to be there."""
    if len(found.errors) < 2:
        return Outcome.NOTHING
    plain = _without_disturbances(found)
    if len(found.disturbed_last) == 0 or plain in FAILED:
        return plain
    least_large = CLEARLY * max(float(found.disturbed_first.max()), NEAR * found.extent)
    if found.disturbed_last.min() >= least_large:
        return Outcome.MADE_WORSE
    if plain in LEARNING and CLEARLY * found.disturbed_last.max() > least_large:
        return Outcome.DROWNED
    return plain


def _without_disturbances(found: Prospects) -> Outcome:
    errors, small = found.errors, NEAR * found.extent
    first, last, least = float(errors[0]), float(errors[-1]), float(errors.min())
    is_worse = not (last <= small or last < CLEARLY * first)
    # However rough a prediction is, an error that has nowhere to rest is none that has fallen.
    if found.is_far and (not is_worse or (found.settles and found.rests)):
        return Outcome.OUT_OF_RANGE
    if is_worse:
        return Outcome.MADE_WORSE if found.settles else Outcome.CANNOT_CONVERGE
    if not found.settles and last > small and last >= STAYS * first:
        return Outcome.CANNOT_CONVERGE
    if last > max(CLEARLY * least, small):
        return Outcome.GROWS_WITHIN if least < first / CLEARLY else Outcome.DOES_NOT_LEARN
    if last > max(first / CLEARLY, small):
        return Outcome.DOES_NOT_LEARN
    ahead = np.append(last, found.later)
    after = float(ahead[int(ahead.argmin()) :].max())
    grows = not found.settles or (found.ripples_grow and not found.rests)
    if grows or after > max(CLEARLY * ahead.min(), small):
        return Outcome.GROWS_LATER
    return Outcome.LEARNS


def seen_outcome(errors: Floats, extent: float, unlearned: float = np.nan) -> Outcome:
    """Returns the outcome of an experiment that was run.

    Args:
        errors: Largest position errors of its iterations [m]; the last one infinite if it left the
            finite numbers.
        extent: Beside which errors are large or small [m].
        unlearned: That of iteration 0 without disturbances [m], if it is known. Where that is
            small, nothing is there to be halved.
    """
    found = predicted_outcome(Prospects(errors, np.zeros(0), extent))
    if found is Outcome.DOES_NOT_LEARN and unlearned <= NEAR * extent:
        return Outcome.LEARNS
    return found


LEARNING = (Outcome.LEARNS, Outcome.GROWS_LATER, Outcome.GROWS_WITHIN)
"""Those with an error that falls clearly."""
FAILED = (Outcome.CANNOT_CONVERGE, Outcome.MADE_WORSE)
"""Those with which an experiment cannot work."""
