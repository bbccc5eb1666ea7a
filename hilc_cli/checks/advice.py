"""What is legal in an experiment but unwise, each with its remedy."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from hilc_cli.disturbance.streams import Bounded
from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.laws.pid import PidLaw
from hilc_cli.reference.path import POSITION_TOLERANCE
from hilc_cli.theory.feasibility.plausibility import ON_THE_SPOT
from hilc_cli.theory.learning.gains import loop_gains

_FACTOR = 10.0  # a gain matrix that is off by more hardly is so on purpose
_NOISE = 0.01  # of the path's size: what is larger hides whether 1 % is reached
_MARGIN = 1e-9  # beyond what rounding may make of a limiting case


def advice(experiment: Experiment) -> list[str]:
    """What is legal but unwise, in sentences that name keys of the scenario.

    Args:
        experiment: Any; what concerns gains is told of the laws hybrid and pid only.
    """
    found = [*_iterations(experiment), *_path(experiment), *_disturbances(experiment)]
    law = experiment.law
    if isinstance(law, HybridLaw | PidLaw):
        found += [*_strength(experiment, law), *_first_trial(experiment, law)]
    if isinstance(law, HybridLaw):
        found += [*_feedback(experiment, law), *_compensation(experiment, law)]
    return found


def _iterations(experiment: Experiment) -> list[str]:
    if experiment.iterations > 0 or experiment.learn_in_first:
        return []
    return ["iterations is 0: the first input is run, and nothing is learned"]


def _path(experiment: Experiment) -> list[str]:
    """Of the reference as a whole."""
    reference = experiment.reference
    gap = math.dist((reference.x[0], reference.y[0]), (reference.x[-1], reference.y[-1]))
    turned = math.remainder(float(reference.heading[-1] - reference.heading[0]), 2 * math.pi)
    closed = gap <= POSITION_TOLERANCE < reference.size
    if closed and abs(turned) > _MARGIN * reference.samples:
        return [
            f"trajectory ends where it starts, but heads {abs(turned):.4g} rad away from its "
            "start: a robot that drives it again has to turn on the spot first"
        ]
    return []


def _disturbances(experiment: Experiment) -> list[str]:
    reference, disturbance = experiment.reference, experiment.disturbance
    if reference.size <= ON_THE_SPOT * experiment.robot.half_track:
        return _headings(disturbance.output)  # on the spot there is no size to hold them against
    steps = np.hypot(np.diff(reference.x), np.diff(reference.y))
    step = float(np.median(steps))
    found = []
    if max(disturbance.state.bound[:2]) >= step > 0:
        found.append(
            f"disturbance.state.bound of {max(disturbance.state.bound[:2]):g} m is added at every "
            f"sample, in which the reference moves by {step:.3g} m only; make it smaller"
        )
    else:
        found += _wandering(experiment)
    seen = max(disturbance.output.bound[:2])
    if seen >= reference.size > 0:
        found.append(
            f"disturbance.output.bound of {max(disturbance.output.bound[:2]):g} m is as large as "
            f"the whole path, {reference.size:.3g} m; make it smaller"
        )
    elif seen > _NOISE * reference.size > 0:
        found.append(
            f"disturbance.output.bound of {seen:g} m is {100 * seen / reference.size:.2g} % of the "
            "path's size: the controller sees errors as large as that even on the reference, and "
            "cannot tell smaller ones from them in one iteration"
        )
    return [*found, *_headings(disturbance.output)]


def _headings(readings: Bounded) -> list[str]:
    if readings.bound[2] < math.pi / 2:
        return []
    return [
        f"disturbance.output.bound of {readings.bound[2]:g} rad hides whether the robot drives "
        "ahead or aside; make it less than pi/2"
    ]


def _wandering(experiment: Experiment) -> list[str]:
    """How far disturbances of the state, added up over the path, carry the robot from it."""
    reference, state = experiment.reference, experiment.disturbance.state
    if state.repeat or not state.active:
        return []
    spread_x, spread_y, spread_heading = _deviations(state)
    # A heading that is off from sample k + 1 on turns what is still to come about the pose there.
    ahead = np.hypot(reference.x[-1] - reference.x[1:], reference.y[-1] - reference.y[1:])
    wander = math.hypot(
        math.sqrt(reference.samples) * math.hypot(spread_x, spread_y),
        # However far it turns, the rest of the path ends on a circle about the pose.
        min(spread_heading * float(np.linalg.norm(ahead)), 2 * float(ahead.max())),
    )
    if wander <= _NOISE * reference.size or reference.size == 0:
        return []
    return [
        f"disturbance.state adds up to about {wander:.2g} m (RMS) at the end of the path, "
        f"{100 * wander / reference.size:.2g} % of its size, anew in each iteration: learning "
        "cannot take that away, feedback within the iteration lessens it"
    ]


def _deviations(noise: Bounded) -> list[float]:
    """Standard deviations of the components."""
    found = []
    for bound, deviation in zip(noise.bound, noise.deviation, strict=True):
        if noise.distribution == "uniform" or bound == 0:
            found.append(bound / math.sqrt(3))
        elif deviation == 0:
            found.append(0.0)
        else:  # of a normal that is cut off at +- z standard deviations
            z = bound / deviation
            density = math.exp(-z * z / 2) / math.sqrt(2 * math.pi)
            kept = 1 - 2 * z * density / math.erf(z / math.sqrt(2))
            found.append(min(deviation * math.sqrt(max(0.0, kept)), bound / math.sqrt(3)))
    return found


def _strength(experiment: Experiment, law: HybridLaw | PidLaw) -> list[str]:
    """How strongly the gain matrix acts on the true platform."""
    strength = np.abs(_loop_gains(experiment, law))
    weakest, strongest = float(strength.min()), float(strength.max())
    if not law.matrix.is_kinematic or (weakest >= 1 / _FACTOR and strongest <= _FACTOR):
        return []
    if not math.isfinite(strongest):
        return []  # told of learning
    least, most = f"{weakest:.3g}", f"{strongest:.3g}"
    return [
        "controller.gain_matrix acts on the true robot with "
        f"{least if least == most else f'{least} to {most}'} times the strength "
        "of Eq. 45 with its true R and B; check the units of robot and model, or make up for it in "
        "controller.gains"
    ]


def _feedback(experiment: Experiment, law: HybridLaw) -> list[str]:
    """Growth of an error e(k+1) = (1 - d l2 g) e(k) - d l3 g e(k-1) within an iteration."""
    if law.compensation or (law.l2 == 0 and law.l3 == 0):
        return []
    gains = experiment.reference.sample_time * _loop_gains(experiment, law)
    if (gains.real <= 0).any():
        return []  # told of the gain matrix
    half = (1 - law.l2 * gains) / 2
    root = np.sqrt(half**2 - law.l3 * gains)
    growth = float(max(np.abs(half + root).max(), np.abs(half - root).max()))
    if growth <= 1 + _MARGIN:
        return []
    return [
        f"controller.gains.l2 of {law.l2:g} and l3 of {law.l3:g} make the feedback within an "
        f"iteration unstable at this sample_time: an error grows to {growth:.3g} times its size "
        "from sample to sample; lower them, or shorten sample_time"
    ]


def _first_trial(experiment: Experiment, law: HybridLaw | PidLaw) -> list[str]:
    if isinstance(law, HybridLaw):
        has_effect = not law.compensation and (law.l2 > 0 or law.l3 > 0)
    else:
        has_effect = law.cutoff is not None  # it smooths the first input
    if not experiment.learn_in_first or has_effect:
        return []
    return ["initial_trial 'feedback' has no effect: the law has no feedback within an iteration"]


def _compensation(experiment: Experiment, law: HybridLaw) -> list[str]:
    if not law.compensation:
        return []
    found = []
    reference, disturbance = experiment.reference, experiment.disturbance
    if 2 * law.h > reference.samples:
        found.append(
            f"controller.h of {law.h} of {reference.samples} samples: Theorem 2 promises the "
            "reference for what comes after sample h only; make it shorter"
        )
    start = (reference.x[0], reference.y[0], reference.heading[0])
    pairs = zip(start, experiment.initial_pose, strict=True)
    off = any(abs(wanted - given) > POSITION_TOLERANCE for wanted, given in pairs)
    scattered = disturbance.initial_pose.active and not disturbance.initial_pose.repeat
    if scattered and not off:
        found.append(
            "disturbance.initial_pose differs in each iteration, and the law compensates each time "
            "what it has met the time before; set 'compensation: off', or 'repeat: true'"
        )
    return found


def _loop_gains(experiment: Experiment, law: HybridLaw | PidLaw) -> NDArray[np.complex128]:
    return loop_gains(law.matrix, experiment.robot, experiment.reference.heading[:-1])
