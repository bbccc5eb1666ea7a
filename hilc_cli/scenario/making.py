"""Makes the experiments of scenarios.

What one scenario has in common with the one before is made once: the cases of a sweep differ in a
few sections only.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from operator import is_
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np

from hilc_cli.disturbance.streams import Disturbance, Triple
from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.parameters import Setting
from hilc_cli.plants.kinematic import feedforward
from hilc_cli.plants.plant import Plant
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.scenario.scenario import ScenarioSpec

_Made = TypeVar("_Made")


class ExperimentMaker:
    """Makes experiments, one after another.

    A part of an experiment follows from some sections of its scenario. Sections cannot be changed,
    so that where a scenario has the very same ones as the scenario before, the part is the same.
    """

    def __init__(self) -> None:
        self._reference: _Kept[Reference] = _Kept()
        self._setting: _Kept[Setting] = _Kept()
        self._first_input: _Kept[tuple[Floats, Floats]] = _Kept()
        self._common: _Kept[_Common] = _Kept()
        self._plant, self._law, self._disturbance = (_Kept[Any]() for _ in range(3))

    def reference(self, spec: ScenarioSpec) -> Reference:
        """The trajectory of a scenario.

        Raises:
            TimingError: As for `ScenarioSpec.reference`.
        """
        trajectory = spec.trajectory
        if trajectory.timing is None:
            return self._reference.of(lambda: spec.reference, trajectory)
        sections = (spec.robot, spec.model, spec.controller, spec.safety)
        return self._reference.of(lambda: spec.reference, trajectory, *sections)

    def setting(self, spec: ScenarioSpec) -> Setting:
        """What the law may depend on beside its own parameters.

        Raises:
            TimingError: As for `reference`.
        """
        reference = self.reference(spec)
        return self._setting.of(
            lambda: _setting(spec, reference),
            reference,
            spec.trajectory,
            spec.robot,
            spec.model,
            spec.initial_pose,
            spec.disturbance.initial_pose,
        )

    def experiment(
        self, spec: ScenarioSpec, given: tuple[Floats, Floats] | None = None
    ) -> Experiment:
        """The scenario with every number resolved.

        Args:
            spec: The scenario.
            given: Left and right wheel speeds of the input file that it names, if any.

        Raises:
            TimingError: As for `reference`.
            ValueError: A number that follows from the law's parameters is not finite.
        """
        controller = spec.controller
        # The law's parameters lead into nothing else, but for a limit by which the path is timed.
        timing = None if spec.trajectory.timing is None else controller
        others = {**vars(spec), "controller": timing}.values()
        common = self._common.of(lambda: self._common_of(spec, given), given, *others)
        setting, plant, initial_pose, (left, right), disturbance = common
        return Experiment(
            setting.reference,
            plant,
            self._law.of(lambda: controller.law_on(setting), controller, setting),
            initial_pose,
            left,
            right,
            spec.learns_in_first,
            spec.iterations,
            math.inf if controller.b_w is None else controller.b_w,
            disturbance,
        )

    def _common_of(self, spec: ScenarioSpec, given: tuple[Floats, Floats] | None) -> _Common:
        setting, robot = self.setting(spec), spec.robot
        return _Common(
            setting,
            self._plant.of(robot.as_plant, robot),
            spec.start_pose,
            self._first_input.of(
                lambda: first_input(spec, given, setting), setting, spec.initial_input, given
            ),
            self._disturbance.of(spec.disturbance.disturbance, spec.disturbance),
        )


class _Common(NamedTuple):
    """What experiments that differ in their law have in common."""

    setting: Setting
    plant: Plant
    initial_pose: Triple
    first_input: tuple[Floats, Floats]
    disturbance: Disturbance


class _Kept(Generic[_Made]):
    """What was made last, for as long as what it is made of stays the same."""

    __slots__ = ("_made", "_parts")

    def __init__(self) -> None:
        self._parts: tuple[object, ...] = ()
        self._made: _Made

    def of(self, make: Callable[[], _Made], *parts: object) -> _Made:
        """What is made of parts: anew if any of them is another object than the last time."""
        if len(parts) != len(self._parts) or not all(map(is_, parts, self._parts)):
            self._made = make()
            self._parts = parts
        return self._made


def _setting(spec: ScenarioSpec, reference: Reference) -> Setting:
    robot = spec.robot.robot()
    return Setting(
        reference,
        spec.model.model(robot),
        spec.initial_error,
        spec.disturbance.initial_pose.bound,
        spec.robot.lead,
        spec.model.drivetrain(robot),
    )


def first_input(
    spec: ScenarioSpec, given: tuple[Floats, Floats] | None, setting: Setting
) -> tuple[Floats, Floats]:
    """u_0 of the left and the right wheel [rad/s], shape (n,) each.

    Args:
        spec: The scenario.
        given: What its input file says, if it names one.
        setting: Of the scenario, or of one with another reference.
    """
    reference, model, drivetrain = setting.reference, setting.model, setting.drivetrain
    if given is not None:
        return given
    if spec.initial_input == "feedforward":
        wheels = feedforward(reference, model)
        if drivetrain is None:
            return wheels
        return drivetrain.sent_for(*wheels, model.wheel_radius, reference.sample_time)
    nothing = _nothing(reference.samples)
    return nothing, nothing


@lru_cache(maxsize=16)
def _nothing(samples: int) -> Floats:
    """Wheels at rest, one array for all the cases of a sweep."""
    nothing = np.zeros(samples)
    nothing.setflags(write=False)
    return nothing
