"""Whether learning is expected to work, in one word: the only place where that is decided."""

from __future__ import annotations

import math
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
    DOES_NOT_LEARN = "does-not-learn"
    """The last error is neither half of that of iteration 0 nor small."""
    OUT_OF_RANGE = "out-of-range"
    """The last error is out of the range of the linear theory, so that it does not tell."""
    MADE_WORSE = "made-worse-by-disturbances"
    """The error becomes twice that of iteration 0 and more: learning multiplies disturbances."""
    DROWNED = "drowned-by-disturbances"
    """It would fall, but disturbances may leave as large an error as iteration 0 has."""
    GROWS_WITHIN = "learns-then-grows-within"
    """The error falls, but the last one is at least twice the smallest, and not small."""
    GROWS_LATER = "learns-then-grows-later"
    """It falls within the experiment's iterations, and grows again after them."""
    LEARNS = "learns"
    """It falls to less than half of that of iteration 0, or is small."""
    NOTHING = "nothing-to-learn"
    """The experiment has no learning updates."""


class Prospects(NamedTuple):
    """What an outcome depends on.

    Attributes:
        errors: Largest position errors of the experiment's iterations, without disturbances [m].
        later: Likewise of later ones, as far as they can be foretold.
        path_size: [m].
        settles: Whether the spectral radius may be below 1.
        rests: Whether there may be a motion near the path to rest at.
        ripples_grow: Whether an iteration makes some ripple of the wheel speeds grow.
        is_far: Whether the last iteration is out of the range of the linear theory.
        disturbed_first: Errors of iteration 0 with disturbances, one for each seed [m].
        disturbed_last: Likewise of the last iteration.
    """

    errors: Floats
    later: Floats
    path_size: float
    settles: bool = True
    rests: bool = True
    ripples_grow: bool = False
    is_far: bool = False
    disturbed_first: Floats = np.zeros(0)
    disturbed_last: Floats = np.zeros(0)


def predicted_outcome(found: Prospects) -> Outcome:
    """The outcome; without disturbances first, since what they spoil has to be there."""
    if len(found.errors) < 2:
        return Outcome.NOTHING
    plain = _without_disturbances(found)
    if len(found.disturbed_last) == 0 or plain is Outcome.CANNOT_CONVERGE:
        return plain
    small = NEAR * found.path_size
    first, last = float(found.disturbed_first.max()), found.disturbed_last
    if last.min() >= CLEARLY * max(first, small):
        return Outcome.MADE_WORSE
    if plain in LEARNING and last.max() > max(first, small):
        return Outcome.DROWNED
    return plain


def seen_outcome(errors: Floats, path_size: float) -> Outcome:
    """The outcome of an experiment that was run.

    Args:
        errors: Largest position errors of its iterations [m]; the last one infinite if it left the
            finite numbers.
        path_size: [m].
    """
    if len(errors) > 1 and not errors[-1] < CLEARLY * max(errors[0], NEAR * path_size):
        return Outcome.MADE_WORSE
    return predicted_outcome(Prospects(errors, np.zeros(0), path_size))


LEARNING = (Outcome.LEARNS, Outcome.GROWS_LATER, Outcome.GROWS_WITHIN)
"""Those with an error that falls clearly."""


def _without_disturbances(found: Prospects) -> Outcome:
    errors, small = found.errors, NEAR * found.path_size
    first, last, least = float(errors[0]), float(errors[-1]), float(errors.min())
    if found.is_far or not math.isfinite(last):
        # However rough, an error beyond all bounds is none that is half of the first.
        if last < CLEARLY * first or (found.settles and found.rests):
            return Outcome.OUT_OF_RANGE
        return Outcome.DOES_NOT_LEARN if found.settles else Outcome.CANNOT_CONVERGE
    grows = last > max(CLEARLY * least, small)
    if not found.settles:
        if last >= first / CLEARLY:
            return Outcome.CANNOT_CONVERGE if last >= STAYS * first else Outcome.DOES_NOT_LEARN
        return Outcome.GROWS_WITHIN if grows else Outcome.GROWS_LATER
    if grows:
        return Outcome.GROWS_WITHIN if least < first / CLEARLY else Outcome.DOES_NOT_LEARN
    if last > max(first / CLEARLY, small):
        return Outcome.DOES_NOT_LEARN
    ahead = np.append(last, found.later)
    after = float(ahead[int(ahead.argmin()) :].max())
    if (found.ripples_grow and not found.rests) or after > max(CLEARLY * ahead.min(), small):
        return Outcome.GROWS_LATER
    return Outcome.LEARNS
