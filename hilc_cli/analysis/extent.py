"""The size beside which errors are large or small."""

from __future__ import annotations

from hilc_cli.engine.experiment import Experiment


def extent(experiment: Experiment) -> float:
    """Longer side of the trajectory's bounding box [m], or the platform's track if that is more.

    A path on the spot has no size, but who drives it has.
    """
    return max(experiment.reference.size, 2 * experiment.robot.half_track)
