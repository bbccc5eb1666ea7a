"""What hilc expects of laws and plants that are not its own, for the tests of their packages.

Each raises an AssertionError with one sentence that says what is broken.
"""

from __future__ import annotations

import json
import math
import pickle
from collections.abc import Mapping, Set as AbstractSet
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
from pydantic import ValidationError

from hilc_cli.disturbance.streams import Bounded, Disturbance
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.errors import DivergedError
from hilc_cli.laws.parameters import Controller
from hilc_cli.plants.kinematic import advance
from hilc_cli.plants.parameters import RobotSpec
from hilc_cli.plants.plant import Plant, Pose
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.trial import Trial
from hilc_cli.scenario.experiment import Scenario
from hilc_cli.scenario.loading import load_scenario
from hilc_cli.yaml_input.model import Model

AnyModel = TypeVar("AnyModel", bound=Model)

_PATH = {
    "name": "bend",
    "sample_time": "10 ms",
    "start": {"x": 0, "y": 0, "heading": 0},
    "segments": [
        {"line": {"length": 0.5, "speed": 1}},
        {"arc": {"radius": 0.5, "sweep": "60 deg", "turn": "left", "speed": 1}},
        {"line": {"length": 0.5, "speed": 1}},
    ],
}
_SCENARIO = {
    "name": "conformance",
    "trajectory": _PATH,
    "robot": {"wheel_radius": 0.05, "half_track": 0.15, "turn_convention": "paper"},
    "model": {"wheel_radius": 0.045, "half_track": 0.17},
    "initial_pose": {"x": -0.02, "y": 0.01, "heading": 0.05},
    "initial_trial": "feedback",
    "iterations": 6,
    "controller": {"law": "feedback"},
}
_LIMIT = 15.0  # [rad/s]; the path asks for up to 26
_POSE: Pose = (0.5, -0.25, 0.3)
_SAMPLE_TIME = 0.01
_WHEELS = [(3.0, 5.0), (10.0, -4.0), (-7.0, -6.5), (0.0, 0.0), (8.0, 8.0)]
"""Left and right wheel speeds [rad/s] that turn, reverse and stop."""
_NOISE = Bounded((0.005, 0.005, 0.02))


def check_law(model: type[Controller], parameters: Mapping[str, Any]) -> None:
    """Makes sure that a law does what hilc expects of every law.

    Args:
        model: The class of its parameters.
        parameters: Some that are valid, as they would stand below ``controller:``.

    Raises:
        AssertionError: It does not; says in a sentence what it does instead.
    """
    says_its_parameters(model, parameters)
    experiment = experiment_of(model, parameters)
    is_deterministic(experiment)
    can_be_sent(experiment)
    keeps_the_limit(experiment)
    survives_noise(experiment)
    survives_divergence(experiment)


def experiment_of(model: type[Controller], parameters: Mapping[str, Any]) -> Experiment:
    """Returns a short experiment of a law: a robot that starts beside a bent path.

    Raises:
        AssertionError: They are not valid, or make no law.
    """
    scenario = load_scenario(_SCENARIO)
    controller = _valid(model, parameters)
    made = Scenario(scenario.spec.model_copy(update={"controller": controller}))
    told = controller.in_words(made.setting)
    assert isinstance(told, str), "in_words must return a line of text"
    assert told.isprintable() and told, "in_words must return one line of text"
    return made.experiment()


def says_its_parameters(model: type[Controller], parameters: Mapping[str, Any]) -> None:
    """Makes sure that a law's parameters can be described, checked and written down."""
    assert issubclass(model, Controller), f"{model.__name__} must be a subclass of Controller"
    limited = "b_w" in model.model_fields
    assert limited, "the parameters must have a field b_w, the speed limit of the wheels"
    _describes_its_keys(model, parameters, {"law"})
    reference = load_scenario(_SCENARIO).setting.reference
    written = json.loads(json.dumps(_valid(model, parameters).resolved(reference)))
    again = json.loads(json.dumps(_valid(model, written).resolved(reference)))
    assert again == written, "the resolved parameters must be the same once they are read back"


def is_deterministic(experiment: Experiment) -> None:
    """Makes sure that a law gives the same numbers twice."""
    message = "the law must give the same wheel speeds when an experiment is repeated"
    _assert_same(_driven(experiment), _driven(experiment), message)


def can_be_sent(experiment: Experiment) -> None:
    """Makes sure that a law does the same in another process: that it can be pickled."""
    law = _sent(experiment.law, "law")
    message = "the law must give the same wheel speeds in another process"
    _assert_same(_driven(experiment), _driven(replace(experiment, law=law)), message)


def keeps_the_limit(experiment: Experiment) -> None:
    """Makes sure that a law learns within a speed limit, and is not carried away by it."""
    for trial in _driven(replace(experiment, speed_limit=_LIMIT)):
        fastest = float(np.abs([trial.left, trial.right]).max())
        assert fastest <= _LIMIT, f"a wheel does {fastest:g} rad/s within a limit of {_LIMIT:g}"


def survives_noise(experiment: Experiment) -> None:
    """Makes sure that a law gives finite wheel speeds where poses are disturbed."""
    noisy = Disturbance(seed=1, state=_NOISE, output=_NOISE, initial_pose=_NOISE)
    trials = _driven(replace(experiment, disturbance=noisy, speed_limit=_LIMIT))
    assert len(trials) == experiment.iterations + 1, "the law must go on where poses are disturbed"


def survives_divergence(experiment: Experiment) -> None:
    """Makes sure that a law stops nothing but the run where numbers leave the finite range."""
    for size in (1e100, 1e200, 1e308):
        huge = Disturbance(state=Bounded((size, size, size)))
        made = replace(experiment, disturbance=huge, speed_limit=math.inf)
        try:
            _driven(made, diverges=True)
        except Exception as error:  # a law may raise anything
            raise AssertionError(
                f"the law must let a run diverge, but raises {type(error).__name__}: {error}"
            ) from error


def check_plant(model: type[RobotSpec], parameters: Mapping[str, Any]) -> None:
    """Makes sure that a plant does what hilc expects of every plant.

    Args:
        model: The class of its parameters.
        parameters: Some that are valid, as they would stand below ``robot:``.

    Raises:
        AssertionError: It does not; says in a sentence what it does instead.
    """
    assert issubclass(model, RobotSpec), f"{model.__name__} must be a subclass of RobotSpec"
    _describes_its_keys(model, parameters, {"plant"})
    plant = _valid(model, parameters).as_plant()
    assert isinstance(plant, Plant), f"as_plant must return a Plant, not {type(plant).__name__}"
    begins_each_pass_anew(plant)
    same = _poses(_sent(plant, "plant")) == _poses(plant)
    assert same, "the plant must give the same poses in another process"
    starts_from_the_pose_that_it_is_handed(plant)
    agrees_with_its_linearisation(plant)
    agrees_with_its_lane_gains(plant)


def begins_each_pass_anew(plant: Plant) -> None:
    """Makes sure that a plant is deterministic, and keeps nothing from one pass to another."""
    one, other = plant.start(_POSE, _SAMPLE_TIME), plant.start(_POSE, _SAMPLE_TIME)
    pose, second = _POSE, _POSE
    for left, right in _WHEELS:  # in turns, so that what they share shows
        pose, second = one(pose, left, right), other(second, left, right)
        assert pose == second, "two passes of the plant with the same wheel speeds must be the same"
    assert np.isfinite(pose).all(), f"the poses must be finite, but one is {pose}"


def starts_from_the_pose_that_it_is_handed(plant: Plant) -> None:
    """Makes sure that a plant goes on from where a disturbance has moved it."""
    elsewhere = (-1.0, 2.0, 2.5)
    there = plant.start(elsewhere, _SAMPLE_TIME)(elsewhere, *_WHEELS[0])
    moved = plant.start(_POSE, _SAMPLE_TIME)(elsewhere, *_WHEELS[0])
    message = "a step of the plant must begin at the pose that it is handed"
    assert np.allclose(moved, there, rtol=0, atol=1e-12), message


def agrees_with_its_linearisation(plant: Plant) -> None:
    """Makes sure that a plant's linearisation, if it has one, is that of its steps."""
    heading = 0.7
    for left, right in _WHEELS:
        speeds = np.array([left]), np.array([right])
        found = plant.linearisation(np.array([heading]), *speeds, _SAMPLE_TIME)
        if found is None:
            return
        differences = _differences(plant, (0.3, -0.2, heading, left, right))
        given = np.hstack([found.states[0], found.inputs[0]])
        message = f"the linearisation must be that of the steps, also for wheels at {left}, {right}"
        assert np.allclose(given, differences, rtol=1e-6, atol=1e-8), message


def _differences(plant: Plant, state: tuple[float, ...]) -> Floats:
    """Returns central differences of a step by pose and wheel speeds, shape (3, 5)."""
    size = 1e-5

    def moved(change: Floats) -> Floats:
        x, y, heading, left, right = (np.array(state) + change).tolist()
        pose = x, y, heading
        return np.array(plant.start(pose, _SAMPLE_TIME)(pose, left, right))

    changes = size * np.eye(5)
    return np.array([(moved(each) - moved(-each)) / (2 * size) for each in changes]).T


def agrees_with_its_lane_gains(plant: Plant) -> None:
    """Makes sure that a plant which offers gains to the batch engine moves as they say."""
    gains = plant.lane_gains(_SAMPLE_TIME)
    if gains is None:
        return
    pose, step = _POSE, plant.start(_POSE, _SAMPLE_TIME)
    for left, right in _WHEELS:
        turned = math.cos(pose[2]), math.sin(pose[2])
        expected = advance(*pose, *turned, gains[0] * (left + right), gains[1] * (left - right))
        pose = step(pose, left, right)
        message = "the plant must move as its lane_gains say, or have none"
        assert np.allclose(pose, expected, rtol=0, atol=1e-9), message


def _sent(thing: Any, what: str) -> Any:
    """Returns what another process would get."""
    try:
        return pickle.loads(pickle.dumps(thing))
    except Exception as error:  # whatever pickling raises
        raise AssertionError(f"the {what} must be data that can be pickled: {error}") from error


def _poses(plant: Plant) -> list[Pose]:
    step, poses = plant.start(_POSE, _SAMPLE_TIME), [_POSE]
    for left, right in _WHEELS:
        poses.append(step(poses[-1], left, right))
    return poses


def _describes_its_keys(
    model: type[Model], parameters: Mapping[str, Any], but: AbstractSet[str]
) -> None:
    """Makes sure that each key has a description, and that others are refused."""
    fields, schema = model.model_fields, model.model_json_schema()["properties"]
    for name in fields.keys() - but:
        assert fields[name].description or "$ref" in json.dumps(schema[name]), (
            f"the parameter {name} must have a description, which documents and messages show"
        )
    _valid(model, parameters)
    try:
        model.model_validate({**parameters, "no_such_key": 1})
    except ValidationError:
        return
    raise AssertionError("the parameters must refuse keys that they do not know")


def _valid(model: type[AnyModel], parameters: Mapping[str, Any]) -> AnyModel:
    try:
        return model.model_validate(dict(parameters))
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        key = ".".join(map(str, first["loc"]))
        raise AssertionError(f"the parameters are not valid: {key}: {first['msg']}") from error


def _driven(experiment: Experiment, *, diverges: bool = False) -> list[Trial]:
    """All iterations, up to where they leave the finite numbers."""
    found: list[Trial] = []
    try:
        found.extend(simulate(experiment))
    except DivergedError as error:
        assert diverges, (
            f"the law must not diverge on a short path, but does in iteration {error.iteration}; "
            "give it smaller gains"
        )
    return found


def _assert_same(one: list[Trial], other: list[Trial], message: str) -> None:
    for first, second in zip(one, other, strict=True):
        same = all(
            np.array_equal(getattr(first, name), getattr(second, name))
            for name in ("left", "right")
        )
        assert same, f"{message}; iteration {first.iteration} differs"
