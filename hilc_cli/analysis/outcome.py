"""Whether learning is expected to work, in one word."""

from __future__ import annotations

from enum import StrEnum

from hilc_cli.analysis.transient import Transient

NEAR = 0.01
"""Share of the path's size up to which an error counts as small."""
_CLEARLY = 2.0  # times: what grows or falls by less counts as staying


class Outcome(StrEnum):
    """What learning is expected to do within an experiment's iterations, and afterwards."""

    CANNOT_CONVERGE = "cannot-converge"
    """The spectral radius is not below 1."""
    DOES_NOT_LEARN = "does-not-learn"
    """The last error is neither half of that of iteration 0 nor small."""
    OUT_OF_RANGE = "out-of-range"
    """The predicted errors leave the range of the linear theory, so that they do not tell."""
    GROWS_WITHIN = "learns-then-grows-within"
    """The error falls, but the last one is at least twice the smallest, and not small."""
    GROWS_LATER = "learns-then-grows-later"
    """It falls within the experiment's iterations, and grows again after them."""
    LEARNS = "learns"
    """It falls to less than half of that of iteration 0, or is small."""
    NOTHING = "nothing-to-learn"
    """The experiment has no learning updates."""


def predicted_outcome(
    transient: Transient, iterations: int, *, rests: bool, ripples_grow: bool
) -> Outcome:
    """What the predicted errors say.

    Args:
        transient: Predicted errors, over as many iterations as can be afforded.
        iterations: Of the experiment.
        rests: Whether there may be a motion to rest at that is not out of the theory's range.
        ripples_grow: Whether an iteration makes some ripple of the wheel speeds grow.
    """
    if iterations == 0:
        return Outcome.NOTHING
    iterations = min(iterations, transient.iterations)
    rough = transient.rough_from
    if rough is not None and rough <= iterations:
        return Outcome.OUT_OF_RANGE if rests else Outcome.DOES_NOT_LEARN
    errors, small = transient.max_position_error_m, NEAR * transient.path_size_m
    first, last, best = (float(errors[i]) for i in (0, iterations, errors.argmin()))
    least = float(errors[: iterations + 1].min())
    if last > max(_CLEARLY * least, small):
        fell = least < first / _CLEARLY
        return Outcome.GROWS_WITHIN if fell else Outcome.DOES_NOT_LEARN
    if last > max(first / _CLEARLY, small):
        return Outcome.DOES_NOT_LEARN
    after = float(errors[int(errors.argmin()) :].max())
    if (ripples_grow and not rests) or after > max(_CLEARLY * best, small):
        return Outcome.GROWS_LATER
    return Outcome.LEARNS
