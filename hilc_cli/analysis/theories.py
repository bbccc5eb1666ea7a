"""The convergence theory of an experiment, as printed and as it holds for the simulated system."""

from __future__ import annotations

import math
from dataclasses import asdict

from hilc_cli.analysis.bounds import Bounds, bounds, smallest_lambda
from hilc_cli.analysis.constants import Constants, constants
from hilc_cli.analysis.corrections import ALL, PRINTED, Correction
from hilc_cli.analysis.within_limit import constants_within_limit
from hilc_cli.engine.experiment import Experiment

AS_PRINTED = "as printed"
WITH_SAMPLE_TIME = "as printed, with the sample time"
CORRECTED = "corrected"
WITHIN_LIMIT = "corrected, within the speed limit"


def theories(experiment: Experiment) -> dict[str, Bounds]:
    """All bounds that can be given before a run, by name.

    Returns:
        ``as printed``: every equation as it stands; no bound of the simulated system.
        ``as printed, with the sample time``: with d_k B for B, else the same.
        ``corrected``: all corrections; holds in every iteration, and has a limit only where rho < 1
        for every heading that the law may use.
        ``corrected, within the speed limit``: all corrections, with rho on the reference; only with
        a speed limit.
        Those whose constants leave the range of floating point are missing.

    Raises:
        UsageError: The law is not the hybrid law.
    """
    found = {
        AS_PRINTED: constants(experiment, PRINTED),
        WITH_SAMPLE_TIME: constants(experiment, {Correction.SAMPLE_TIME}),
        CORRECTED: constants(experiment, ALL),
    }
    if math.isfinite(experiment.speed_limit):
        found[WITHIN_LIMIT] = constants_within_limit(experiment)
    all_bounds = {name: _bounds(experiment, each) for name, each in found.items()}
    return {name: each for name, each in all_bounds.items() if each is not None}


def _bounds(experiment: Experiment, found: Constants) -> Bounds | None:
    """The bounds; None if there are no numbers for them."""
    numbers = [value for value in asdict(found).values() if not isinstance(value, str)]
    if not all(map(math.isfinite, [*numbers, smallest_lambda(found)])):
        return None
    made = bounds(experiment, found)
    return made if all(map(math.isfinite, (made.lambda_, made.A, made.B))) else None
