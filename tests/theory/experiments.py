"""Random experiments of every kind, and whether the theorems' condition held along a run."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from hilc_cli.disturbance.streams import Bounded, Distribution, Disturbance, Triple
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.errors import DivergedError
from hilc_cli.laws.gain_matrix import GainHeading, GainMatrix
from hilc_cli.plants.kinematic import Robot, control_matrices, feedforward
from hilc_cli.reference.path import build_reference
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.trial import Trial
from hilc_cli.theory.linear_law import paper_law
from hilc_cli.theory.matrices import GainParts
from hilc_cli.theory.proof.norms import wheel_map_norm
from hilc_cli.yaml_input.expressions import Affine
from tests.engine.experiments import MatrixName, experiment_of, law_of, matrix_of
from tests.reference.paths import Move, relative_plans

CONVENTIONS = ("paper", "rep103")
HEADINGS: tuple[GainHeading, ...] = ("measured", "previous", "reference")
MATRICES: tuple[MatrixName, ...] = ("model", "unit", "contradicting")
DISTRIBUTIONS: tuple[Distribution, ...] = ("uniform", "truncated-normal")


def euler_reference(robot: Robot, inputs: Floats, sample_time: float, heading: float) -> Reference:
    """What the plant itself does with wheel speeds of shape (n, 2), from the origin.

    With both sums of speeds positive the feedforward finds them again: nothing is left to reach.
    """
    speed = robot.wheel_radius * inputs.sum(axis=1) / 2
    rate = robot.wheel_radius * (inputs[:, 0] - inputs[:, 1]) / (2 * robot.signed_half_track)
    headings = heading + np.concatenate([[0], np.cumsum(sample_time * rate)])
    x, y = (
        np.concatenate([[0], np.cumsum(sample_time * speed * part(headings[:-1]))])
        for part in (np.cos, np.sin)
    )
    return Reference("euler", sample_time, x, y, headings)


def random_experiment(seed: int) -> Experiment:
    """One of them, disturbed; most laws learn to follow the reference, others do not."""
    draw = np.random.default_rng(seed)

    def uniform(low: float, high: float) -> float:
        return float(draw.uniform(low, high))

    def chance(probability: float) -> bool:
        return bool(draw.random() < probability)

    robot = Robot(uniform(0.05, 0.5), uniform(0.1, 1.5), "paper" if chance(0.7) else "rep103")
    sample_time = float(np.exp(uniform(math.log(0.005), math.log(0.2))))
    reference = _reference(draw, robot, sample_time)
    steps = reference.samples
    model = Robot(
        robot.wheel_radius * uniform(0.7, 1.3),
        robot.half_track * uniform(0.7, 1.3),
        robot.turn_convention,
    )
    l1, l2, l3 = (
        uniform(0.05, 1.9) / sample_time,
        uniform(0, 1) / sample_time * chance(0.5),
        uniform(0, 1) / sample_time * chance(0.4),
    )
    law = law_of(
        l1,
        l2,
        l3,
        matrix=_matrix(draw, model),
        gain_heading=HEADINGS[draw.integers(3)],
        compensation=chance(0.4),
        h=int(draw.integers(1, steps + 1)),
    )
    left, right = feedforward(reference, robot)
    fastest = max(np.abs(left).max(), np.abs(right).max())
    initial: tuple[Floats, Floats] = (np.zeros(steps), np.zeros(steps))
    if chance(0.3):
        initial = (left, right)
    elif chance(0.4):
        initial = (draw.normal(0, fastest, steps), draw.normal(0, fastest, steps))
    disturbed = draw.random(3) < 0.6
    disturbed[draw.integers(3)] = True
    state, output, pose = (_bounded(draw) if active else Bounded() for active in disturbed)
    offset = (0.0, 0.0, 0.0)
    if chance(0.4):
        offset = (uniform(-1, 1), uniform(-1, 1), uniform(-2, 2))
    return experiment_of(
        reference,
        law,
        initial_pose=(
            float(reference.x[0]) + offset[0],
            float(reference.y[0]) + offset[1],
            float(reference.heading[0]) + offset[2],
        ),
        robot=robot,
        initial_input=initial,
        learn_in_first=chance(0.3),
        iterations=int(np.exp(uniform(math.log(2), math.log(40)))),
        speed_limit=float(fastest) * uniform(0.8, 1.5) if chance(0.5) else math.inf,
        disturbance=Disturbance(int(draw.integers(2**32)), state, output, pose),
    )


def completed_trials(experiment: Experiment) -> list[Trial]:
    """The iterations of an experiment until it ends or diverges."""
    trials: list[Trial] = []
    try:
        for trial in simulate(experiment):
            trials.append(trial)
    except DivergedError:
        pass
    return trials


def _reference(draw: np.random.Generator, robot: Robot, sample_time: float) -> Reference:
    if draw.random() < 0.4:
        steps = int(draw.integers(1, 50))
        inputs = draw.uniform(1, 20) * (1 + draw.uniform(-0.5, 0.5, (steps, 2)))
        return euler_reference(robot, inputs, sample_time, float(draw.uniform(-3, 3)))
    moves = [
        Move(
            size=float(draw.uniform(0.2, 4)),
            sweep=float(draw.uniform(0.1, 3)),
            turn=(None, "left", "right")[draw.integers(3)],
            steps=int(draw.integers(5, 20)),
        )
        for _ in range(draw.integers(1, 4))
    ]
    start = (float(draw.uniform(-5, 5)), float(draw.uniform(-5, 5)), float(draw.uniform(-3, 3)))
    return build_reference("random", start, relative_plans(moves, sample_time), sample_time)


def _matrix(draw: np.random.Generator, model: Robot) -> GainMatrix:
    """Eq. 45 in most cases, Eqs. 56 and 57, or any other near to Eq. 45."""
    kind = draw.random()
    if kind < 0.6:
        return matrix_of("model", model)
    if kind < 0.8:
        return matrix_of(MATRICES[draw.integers(1, 3)], model)
    sizes = np.array(matrix_of("model", model).coefficients)
    sizes = sizes + draw.normal(0, 0.1 * np.abs(sizes).max(), 18)
    rows = [[Affine(*sizes[9 * i + 3 * j :][:3].tolist()) for j in range(3)] for i in range(2)]
    return GainMatrix((rows[0][0], rows[0][1], rows[0][2]), (rows[1][0], rows[1][1], rows[1][2]))


def _bounded(draw: np.random.Generator) -> Bounded:
    size = 10 ** draw.uniform(-4, -0.5)
    x, y, heading = (size * draw.uniform(0, 1, 3)).tolist()
    bound: Triple = (x, y, heading)
    deviation: Triple = (x / 2, y / 2, heading / 2)
    return Bounded(
        bound, DISTRIBUTIONS[draw.integers(2)], deviation, repeat=bool(draw.random() < 0.5)
    )


def along_run(experiment: Experiment, trials: Iterable[Trial]) -> tuple[Floats, Floats]:
    """What Eq. 23 demands along a run, measured.

    Args:
        experiment: What was run.
        trials: All iterations in order; they are gone through once, and not kept.

    Returns:
        For each learning update the largest ||I - L1 d_k B|| over the samples, L1 and B where they
        stood, and the largest angle between their headings [rad].

    Source:
        Qiao et al. 2021, Eqs. 23 and 30: L1 of iteration i + 1 with B of iteration i.
    """
    law, reference = paper_law(experiment), experiment.reference
    gain, parts = law.l1 * (law.derivative + reference.sample_time), GainParts.of(law.matrix)
    rhos: list[float] = []
    mismatches: list[float] = []
    before: Trial | None = None
    for trial in trials:
        if before is not None:
            if law.gain_heading == "reference":
                used = reference.heading
            else:
                source = trial if law.gain_heading == "measured" else before
                alpha = experiment.disturbance.of_output(source.iteration, len(source.heading))
                used = source.heading if alpha is None else source.heading + alpha[:, 2]
            gain_heading, heading = used[:-1], before.heading[:-1]
            product = parts.at(gain_heading) @ control_matrices(experiment.robot, heading)
            norms = wheel_map_norm(np.eye(2) - gain * product, "euclidean")
            rhos.append(float(norms.max()))
            mismatches.append(float(np.abs(gain_heading - heading).max()))
        before = trial
    return np.array(rhos), np.array(mismatches)
