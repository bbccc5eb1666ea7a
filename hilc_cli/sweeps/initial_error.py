"""What the initial error hides: metrics that no case of a sweep can bring below it."""

from __future__ import annotations

import math

from hilc_cli.results.metrics import ITERATIONS_TO_TOLERANCE, MAX_ERROR, MAX_ERROR_SECOND_HALF, PEAK
from hilc_cli.scenario.sweep_section import SweepSpec
from hilc_cli.sweeps.varied import TRAJECTORY, Varied, root

_START = ("initial_pose", TRAJECTORY)
_BOUND = "disturbance.initial_pose"
_NONE = 1e-9  # [m]; less is rounding


def least_initial_error(varied: Varied) -> float:
    """What the position error of the first sample is at least, in all iterations of all cases.

    Returns:
        Distance of the initial pose from the trajectory's start, less what its disturbance may
        take away [m]; 0 if cases may start from different poses.
    """
    if any(root(key) in _START or key.startswith(_BOUND) for key in varied.axes):
        return 0.0
    spec = varied.scenario.spec
    offset, bound = spec.initial_error[:2], spec.disturbance.initial_pose.bound[:2]
    return math.hypot(*(max(0.0, abs(o) - b) for o, b in zip(offset, bound, strict=True)))


def hidden_by_initial_error(varied: Varied, spec: SweepSpec) -> list[str]:
    """Warnings of a metric or a tolerance that the initial error alone decides."""
    least = least_initial_error(varied)
    if least <= _NONE:
        return []
    option = "--metric" if spec.minimise is None else "--minimise"
    found = []
    if spec.tolerance is not None and least > spec.tolerance:
        problem = f"no case can settle within the tolerance of {spec.tolerance:g} m: "
        problem += f"its maximum error is at least the initial error of {least:.3g} m"
        if spec.metric == ITERATIONS_TO_TOLERANCE:
            problem += f"; {option} {MAX_ERROR_SECOND_HALF} tells cases apart"
        found.append(problem)
    if spec.metric in (MAX_ERROR, PEAK):
        found.append(
            f"{spec.metric} is at least the initial error of {least:.3g} m in every case, however "
            f"good it is; {option} {MAX_ERROR_SECOND_HALF} tells cases apart"
        )
    return found
