"""What is legal in an experiment but unwise, each with its remedy."""

from __future__ import annotations

import math

import numpy as np

from hilc_cli.disturbance.streams import Bounded
from hilc_cli.engine.experiment import Experiment
from hilc_cli.reference.path import POSITION_TOLERANCE
from hilc_cli.theory.feasibility.plausibility import ON_THE_SPOT
from hilc_cli.theory.law_theory import LawTheory
from hilc_cli.theory.noise import deviations
from hilc_cli.theory.plain_arrays import median

_NOISE = 0.01  # of the path's size: what is larger hides whether 1 % is reached
_MARGIN = 1e-9  # beyond what rounding may make of a limiting case


def advice(theory: LawTheory) -> list[str]:
    """Returns what is legal but unwise, in sentences that name keys of the scenario.

    Args:
        theory: What is known of the experiment's law; what concerns gains is told only of a law of
            which the linear theory speaks.
    """
    experiment, law = theory.experiment, theory.linear
    found = [*_path(experiment), *_disturbances(experiment)]
    if experiment.iterations == 0 and not experiment.learn_in_first:
        found.insert(0, "iterations is 0: the first input is run, and nothing is learned")
    return found if law is None else found + law.advice()


def _path(experiment: Experiment) -> list[str]:
    """Returns what is to be said of the reference as a whole."""
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
    step = median(steps)
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
    """Tells how far disturbances of the state, added up over the path, carry the robot off."""
    reference, state = experiment.reference, experiment.disturbance.state
    if state.repeat or not state.active:
        return []
    spread_x, spread_y, spread_heading = deviations(state)
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
