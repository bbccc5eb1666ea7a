"""What tells a scenario from others of its kind, in a few characters each."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from hilc_cli.laws.norm_optimal.law import RATIO
from hilc_cli.results.learning import BELIEVED, TRUE
from hilc_cli.scenario.experiment import Scenario

# Shown elsewhere: the speed limit is a figure of its own, the switch has a text of its own.
_ELSEWHERE = frozenset({"law", "b_w", "compensation", "switch_tolerance"})

# To the paper's law, which is told without them.
_ADDED = frozenset({"lateral"})


def settings_of(scenario: Scenario) -> dict[str, str]:
    """Law, gains and start of a scenario, as a table of several runs tells them.

    Returns:
        ``law`` by its name; ``gains``, such as ``l1=0.5 l2=0 l3=0``: the law's own numbers, and
        its choices that are not the default ones; ``compensation``, on or off, of a law that has
        one; ``start_offset`` from the trajectory's start, in m and rad, if there is one.
    """
    controller = scenario.resolved()["controller"]
    fields = type(scenario.spec.controller).model_fields
    switched = "compensation" in controller
    left_out = _ELSEWHERE | ({"h"} if switched else set())
    own = {key: value for key, value in controller.items() if key not in left_out}
    numbers = _numbers(own)
    parts = [f"{name}={value:.10g}" for name, value in numbers if value or name not in _ADDED]
    parts += [
        f"{key}={str(value).lower() if isinstance(value, bool) else value}"
        for key, value in own.items()
        if isinstance(value, str | bool) and value != fields[key].default
    ]
    settings = {"law": str(controller["law"]), "gains": " ".join(parts)}
    if switched:
        on = f"on h={controller['h']}"
        settings["compensation"] = on if scenario.compensates else "off"
    # The initial error is the start of the reference less the initial pose.
    offset = zip(("x", "y", "heading"), scenario.spec.initial_error, ("m", "m", "rad"), strict=True)
    texts = [f"{name}={-error:.6g} {unit}" for name, error, unit in offset if error]
    if texts:
        settings["start_offset"] = " ".join(texts)
    return settings


def _numbers(data: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, float]]:
    """The numbers in nested data by dotted name, without the word ``gains``."""
    for key, value in data.items():
        if isinstance(value, Mapping):
            yield from _numbers(value, above if key == "gains" else f"{above}{key}.")
        elif isinstance(value, int | float) and not isinstance(value, bool):
            yield f"{above}{key}", float(value)


def yardsticks_of(scenario: Scenario) -> dict[str, dict[str, float]]:
    """Values to hold the law's figures against.

    Returns:
        By column of ``learning.csv``, and then by name: ``true``, as the robot is, ``believed``,
        as the law takes it to be at first, and what the law has of its own, such as ``h``.
    """
    controller, setting = scenario.spec.controller, scenario.setting
    robot, model = scenario.spec.robot.robot(), setting.model
    known = {
        "wheel_radius_m": {TRUE: robot.wheel_radius, BELIEVED: model.wheel_radius},
        "half_track_m": {TRUE: robot.half_track, BELIEVED: model.half_track},
        RATIO: {
            TRUE: robot.wheel_radius / robot.half_track,
            BELIEVED: model.wheel_radius / model.half_track,
        },
        **controller.yardsticks(setting),
    }
    told = controller.figures()
    return {column: values for column, values in known.items() if column in told}
