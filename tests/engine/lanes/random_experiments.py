"""Experiments drawn at random, and the batch engine against the loop engine on them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import product
from typing import Literal

import numpy as np
from hypothesis import assume, strategies as st

from hilc_cli.disturbance.streams import Bounded, Distribution, Disturbance
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes.batch import NEVER, simulate_batch
from hilc_cli.engine.loop import MeasuredTrials
from hilc_cli.laws.feedback import FeedbackLaw
from hilc_cli.laws.gain_matrix import GainHeading, GainMatrix, model_gain, unit_gain
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.laws.law import Law
from hilc_cli.laws.pid import PidLaw
from hilc_cli.plants.drivetrain import Drivetrain, Slip
from hilc_cli.plants.imperfect_plant import ImperfectPlant
from hilc_cli.plants.kinematic import Robot, TurnConvention
from hilc_cli.plants.kinematic_plant import KinematicPlant
from hilc_cli.plants.motor import Motor
from hilc_cli.plants.plant import Plant
from hilc_cli.reference.path import ArcPlan, LinePlan, build_reference
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.metrics import MAX_ERROR, METRICS, MetricsTable
from hilc_cli.yaml_input.expressions import Affine

TOLERANCE = 1e-9
LIMIT = 20.0  # [rad/s]

CIRCLE = build_reference(
    "circle",
    (10.0, 0.0, math.pi / 2),
    [ArcPlan(2 * math.pi, "left", (0.0, 0.0), None, 2.0)],
    0.02,
)
BEND = build_reference(
    "bend",
    (1.0, 2.0, 0.3),
    [LinePlan(length=3.0, duration=0.5), ArcPlan(2.0, "right", None, 1.5, 0.7)],
    0.01,
)


def by_loop(experiment: Experiment) -> MetricsTable:
    """All metrics of all iterations, from the loop engine."""
    table = MetricsTable()
    for _, metrics in MeasuredTrials(experiment):
        table.append(metrics)
    return table


def assert_agree(found: Floats, expected: Floats) -> None:
    """Equal up to rounding: relative, and absolute for values far below a millimetre."""
    np.testing.assert_allclose(found, expected, rtol=TOLERANCE, atol=1e-12)


def assert_metrics_agree(found: Floats, expected: dict[str, float]) -> None:
    """The same of all metrics of an iteration.

    The change of the input is a difference of wheel speeds, and has their rounding.
    """
    change = "input_change_rms_rad_s"
    told = dict(zip(METRICS, found.tolist(), strict=True))
    rounding = 1e-12 + 2e-14 * expected["max_wheel_speed_rad_s"]
    np.testing.assert_allclose(told[change], expected[change], rtol=TOLERANCE, atol=rounding)
    others = [name for name in METRICS if name != change]
    assert_agree(*(np.array([row[name] for name in others]) for row in (told, expected)))


def triples(largest: float) -> st.SearchStrategy[tuple[float, float, float]]:
    part = st.floats(0, largest)
    return st.tuples(part, part, part)


@st.composite
def bounded(draw: st.DrawFn) -> Bounded:
    bound = draw(triples(1e-3))
    deviation = (bound[0] / 3 or 1.0, bound[1] / 3 or 1.0, bound[2] / 3 or 1.0)
    kinds: list[Distribution] = ["uniform", "truncated-normal"]
    kind = draw(st.sampled_from(kinds))
    return Bounded(bound, kind, deviation, draw(st.booleans()))


def disturbances() -> st.SearchStrategy[Disturbance]:
    seeds = st.integers(0, 2**64 - 1)
    return st.builds(Disturbance, seeds, bounded(), bounded(), bounded())


LawName = Literal["hybrid", "pid", "feedback"]


@dataclass(frozen=True)
class Code:
    """What the lanes' machine code is compiled for: each mixture is compiled for itself."""

    law: LawName = "hybrid"
    compensation: bool = False  # or the pulse of the law pid
    full_matrix: bool = False
    heading: GainHeading = "measured"
    disturbed: bool = False
    derivative: bool = False
    lateral: bool = False
    filtered: bool = False
    real_robot: bool = False
    own_reference: bool = False


OF_SHIPPED = [
    Code(),
    Code(compensation=True),
    Code(full_matrix=True),
    Code(disturbed=True),
    Code(real_robot=True),
]
"""Those of the shipped scenarios, which other tests compile as well."""

SOME = [
    *OF_SHIPPED,
    Code(compensation=True, heading="reference", derivative=True),
    Code(compensation=True, full_matrix=True, heading="previous"),
    Code("pid", real_robot=True),
    Code("pid", compensation=True, full_matrix=True, heading="previous", filtered=True),
    Code("feedback", disturbed=True, real_robot=True),
]
"""Each choice at least once; all mixtures take many minutes to compile."""

FLAGS = [False, True]
HEADINGS: list[GainHeading] = ["measured", "previous", "reference"]
MIXTURES = list(product(FLAGS, FLAGS, HEADINGS, FLAGS))
ALL = [
    *(
        Code(
            "hybrid",
            *mixture,
            derivative=i % 3 == 1,
            lateral=i % 5 == 2,
            real_robot=i % 2 == 0,
            own_reference=i % 4 == 3,
        )
        for i, mixture in enumerate(MIXTURES)
    ),
    *(
        Code("pid", *mixture, filtered=i % 3 == 1, real_robot=i % 2 == 1, own_reference=i % 7 == 3)
        for i, mixture in enumerate(MIXTURES)
        if i % 5 in (0, 2, 3)
    ),
    *(
        Code("feedback", disturbed=noise, real_robot=real, own_reference=noise != real)
        for noise in FLAGS
        for real in FLAGS
    ),
]


@st.composite
def matrices(draw: st.DrawFn, model: Robot, full: bool) -> GainMatrix:
    if not full:
        return draw(st.sampled_from([model_gain, unit_gain]))(model)
    small = st.floats(-1, 1)
    entries = [Affine(draw(small), draw(small), draw(small)) for _ in range(6)]
    a, b, c, d, e, f = entries
    return GainMatrix((a, b, c), (d, e, f))


def or_none(numbers: st.SearchStrategy[float], none: float = 0.0) -> st.SearchStrategy[float]:
    return st.one_of(st.just(none), numbers)


@st.composite
def plants(draw: st.DrawFn, robot: Robot, real: bool) -> Plant:
    """Of real robots any mixture of what they have, often one thing alone."""
    if not real:
        return KinematicPlant(robot)
    # A wheel that just reaches its limit in some samples may do so or not, but for rounding: limits
    # are round numbers, and these are not.
    accelerations = st.floats(5, 500).map(lambda acceleration: acceleration + 1 / math.e)
    motor = Motor(
        draw(or_none(st.floats(0.001, 0.1))),
        draw(or_none(st.floats(0.001, 0.2))),
        draw(or_none(accelerations, math.inf)),
        draw(or_none(st.floats(0.01, 2))),
    )
    slip = Slip(draw(or_none(st.floats(0.001, 0.2))), draw(or_none(st.floats(0.001, 0.1))))
    left, right = (robot.wheel_radius * draw(or_none(st.floats(0.9, 1.1), 1.0)) for _ in range(2))
    return ImperfectPlant(robot, Drivetrain(left, right, motor, slip), draw(st.booleans()))


@st.composite
def laws(draw: st.DrawFn, reference: Reference, code: Code, model: Robot) -> Law:
    h = draw(st.integers(1, reference.samples))
    if code.law == "feedback":
        gains = (draw(st.floats(0.1, 10)), draw(st.floats(0.1, 8)), draw(st.floats(0.1, 6)))
        return FeedbackLaw(*gains, model)
    matrix = draw(matrices(model, code.full_matrix and not code.lateral))
    if code.law == "pid":
        cutoff = draw(st.one_of(st.none(), st.floats(0.5, 0.4 / reference.sample_time)))
        return PidLaw(
            draw(or_none(st.floats(0.01, 1))),
            draw(or_none(st.floats(0.01, 0.5))),
            draw(or_none(st.floats(0.001, 0.2))),
            draw(or_none(st.floats(0.01, 0.3))),
            matrix,
            code.heading,
            cutoff if code.filtered else None,
            h if code.compensation else None,
        )
    return HybridLaw(
        draw(st.floats(0, 1)),
        draw(st.floats(0, 2)),
        draw(st.floats(0, 1)),
        matrix,
        code.heading,
        code.compensation,
        h,
        draw(st.floats(1e-3, 0.1)) if code.derivative else 0.0,
        draw(st.floats(1e-3, 2)) if code.lateral else 0.0,
    )


@st.composite
def experiments(draw: st.DrawFn, reference: Reference, code: Code) -> Experiment:
    """Gentle enough that rounding errors do not grow: chaos would compare nothing."""
    conventions: list[TurnConvention] = ["paper", "rep103"]
    convention = draw(st.sampled_from(conventions))
    robot = Robot(draw(st.floats(0.05, 0.5)), draw(st.floats(0.2, 1)), convention)
    model = replace(robot, wheel_radius=draw(st.floats(0.05, 0.5)))
    law = draw(laws(reference, code, model))
    start = (float(reference.x[0]), float(reference.y[0]), float(reference.heading[0]))
    offset = draw(st.tuples(*[st.floats(-0.3, 0.3)] * 3))
    x, y, heading = (a + b for a, b in zip(start, offset, strict=True))
    # A wheel that is at its limit but for rounding may count as limited or not.
    wheels = st.floats(-30, 30).filter(lambda speed: abs(abs(speed) - LIMIT) > 1e-6)
    left, right = draw(wheels), draw(wheels)
    return Experiment(
        reference,
        draw(plants(robot, code.real_robot)),
        law,
        (x, y, heading),
        np.full(reference.samples, left),
        np.full(reference.samples, right),
        draw(st.booleans()),
        draw(st.integers(0, 5)),
        draw(st.sampled_from([math.inf, LIMIT, 180.0])),
        draw(disturbances()) if code.disturbed else Disturbance(),
    )


def clear_iterations(experiment: Experiment, expected: MetricsTable) -> int:
    """The first iterations that rounding does not decide.

    They end where a start that is off by a rounding leads elsewhere, in either engine: in any
    metric, since a largest error may be early while what follows is chaos.
    """
    x, y, heading = experiment.initial_pose
    left, right = (
        wheel * (1 + 1e-13) for wheel in (experiment.initial_left, experiment.initial_right)
    )
    moved = by_loop(
        replace(
            experiment,
            initial_pose=(x + 1e-13, y, heading + 1e-13),
            initial_left=left,
            initial_right=right,
        )
    )
    count = min(len(moved), len(expected))
    clear = np.ones(count, dtype=bool)
    for name in METRICS:
        clear &= np.isclose(moved[name][:count], expected[name][:count], rtol=1e-10, atol=1e-12)
    return int(np.argmin(clear)) if not clear.all() else count


def check_random_experiment(data: st.DataObject, codes: list[Code]) -> None:
    """Both engines give the same metrics in each iteration of an experiment."""
    reference, code = data.draw(st.sampled_from([CIRCLE, BEND])), data.draw(st.sampled_from(codes))
    experiment = data.draw(experiments(reference, code))
    expected = by_loop(experiment)
    count = clear_iterations(experiment, expected)
    assume(count > 0)
    # One case for each number of iterations: their last iterations are all iterations.
    cases = [replace(experiment, iterations=last) for last in range(count)]
    result = simulate_batch(cases, code.own_reference)
    for case in range(count):
        assert_metrics_agree(result.final[case], expected.row(case))
    assert_agree(result.errors[-1], expected[MAX_ERROR][:count])
    assert (result.diverged_at == NEVER).all()
