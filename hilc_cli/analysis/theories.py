"""The convergence theory of an experiment, as printed and as it holds for the simulated system."""

from __future__ import annotations

import math

from hilc_cli.analysis.bounds import Bounds, bounds
from hilc_cli.analysis.constants import constants
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

    Raises:
        UsageError: The law is not the hybrid law.
    """
    found = {
        AS_PRINTED: bounds(experiment, constants(experiment, PRINTED)),
        WITH_SAMPLE_TIME: bounds(experiment, constants(experiment, {Correction.SAMPLE_TIME})),
        CORRECTED: bounds(experiment, constants(experiment, ALL)),
    }
    if math.isfinite(experiment.speed_limit):
        found[WITHIN_LIMIT] = bounds(experiment, constants_within_limit(experiment))
    return found
