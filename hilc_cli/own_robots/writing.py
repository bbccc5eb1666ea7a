"""Writes a commented scenario and trajectory from four numbers of a robot."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import Any, get_args

from pydantic_core import PydanticCustomError

from hilc_cli.errors import ExistingResultsError, UsageError
from hilc_cli.files import output_place, write_file, writing
from hilc_cli.names import check_name
from hilc_cli.wording import printable, shortened
from hilc_cli.yaml_input.expressions import ExpressionError, Unit, evaluate
from hilc_cli.yaml_input.quantities import Quantity, RobotLength, WheelSeparation

_SPEED = Quantity(
    Unit(length=1, time=-1), "0.22 or 0.8 km/h, or of a wheel 60 rpm", above=0, smallest=1e-4,
    most=1e3,
)  # fmt: skip
_WHEEL_SPEED = Quantity(Unit(angle=1, time=-1), "60 rpm", above=0, smallest=1e-4, most=1e5)
_RATE = Quantity(Unit(time=-1), "20 or 20 Hz", above=0, smallest=0.1, most=1e5)

_WORN, _SLIPS = 0.97, 1.07  # of the wheels in the guess of what they really are
_USED = 0.9  # of the wheels' speed, the rest is for steering
_WIDTHS = 5.6  # length of a clothoid in wheel separations: bends of nearly two of them
_LATERAL = 2.0  # [m/s^2], which tyres hold and cups survive
_SPEED_UP = 1.0  # [s] until it is at full speed
_STEPS = 20  # samples in a clothoid at least
_MERGE = 3.0  # [s] to get onto the path
_FLOOR, _NOISE, _OFFSET = 6e-4, 0.02, 0.05  # of the wheel separation


def write_own_robot(
    name: str,
    *,
    wheel_radius: float | str,
    wheel_separation: float | str,
    top_speed: float | str,
    rate: float | str,
    folder: str | Path = ".",
) -> list[Path]:
    """Writes a scenario and a trajectory for a robot; never over files that are there.

    The path suits the robot: its wheels can follow it with a tenth of their speed to spare.

    Args:
        name: What the scenario is called; the files are NAME.yaml and NAME-path.yaml.
        wheel_radius: In metres, or a text with a unit, such as ``33 mm``.
        wheel_separation: Distance of the wheels, likewise.
        top_speed: Of the robot in m/s, or a text with a unit; ``60 rpm`` is that of a wheel.
        rate: How often the robot gets a command [Hz].
        folder: Where to put the files; made if it is not there.

    Returns:
        The scenario and the trajectory.

    Raises:
        UsageError: A number or the name cannot be.
        ExistingResultsError: One of the files is there; nothing has been written then.
        FileAccessError: They cannot be written.
    """
    try:
        check_name(name)
    except ValueError as error:
        raise UsageError(f"{shortened(printable(name), 60) or 'the name'}: {error}") from None
    radius = _number("--wheel-radius", wheel_radius, get_args(RobotLength)[1])
    separation = _number("--wheel-separation", wheel_separation, get_args(WheelSeparation)[1])
    if _unit(top_speed) == _WHEEL_SPEED.unit:
        top = _number("--top-speed", top_speed, _WHEEL_SPEED) * radius
    else:
        top = _number("--top-speed", top_speed, _SPEED)
    texts = _texts(name, radius, separation, top, _number("--rate", rate, _RATE))
    place = Path(folder)
    contents = {place / f"{name}.yaml": "scenario", place / texts["path_file"]: "trajectory"}
    with writing(place):
        output_place(place / "file")
        for file in contents:
            if os.path.lexists(file):
                raise ExistingResultsError(
                    f"{file}: exists, and nothing is replaced; choose another name, or another "
                    "folder with --out"
                )
        place.mkdir(parents=True, exist_ok=True)
    for file, kind in reversed(contents.items()):  # a scenario is never without its path
        template = (files("hilc_cli.own_robots") / f"{kind}.yaml.txt").read_text(encoding="utf-8")
        write_file(file, _writer(_aligned(Template(template).substitute(texts))))
    return list(contents)


def _writer(text: str) -> Callable[[Path], None]:
    def write(path: Path) -> None:
        path.write_text(text, encoding="utf-8")

    return write


_COMMENTS = 32  # column at which they begin


def _aligned(text: str) -> str:
    """The text with the comments behind values in one column."""
    lines = []
    for line in text.splitlines():
        value, mark, comment = line.partition("  # ")
        if mark and value.strip():
            line = f"{value.rstrip():<{_COMMENTS - 2}}  # {comment.lstrip()}"
        lines.append(line)
    return "\n".join([*lines, ""])


def _number(option: str, given: float | str, quantity: Quantity) -> float:
    try:
        return quantity(given)
    except PydanticCustomError as error:
        problem, remedy = _told(error)
        got = shortened(printable(str(given)), 60)
        raise UsageError(f"{option} {got}: {problem}; {remedy}") from None


def _told(error: PydanticCustomError) -> tuple[str, str]:
    context: Any = error.context or {}
    ((_, problem, remedy),) = context["problems"]
    return problem, remedy


def _unit(given: float | str) -> Unit | None:
    try:
        return evaluate(given).unit if isinstance(given, str) else None
    except ExpressionError:
        return None


def _texts(name: str, radius: float, separation: float, top: float, rate: float) -> dict[str, str]:
    """What stands in the files, by its name in the templates."""
    # On a bend of curvature k the outer wheel is faster than the robot by 1 + k W / 2.
    speed = _rounded(_USED * top / (1 + math.pi / _WIDTHS / 2), down=True)
    clothoid = max(
        _WIDTHS * separation, math.pi * speed**2 / _LATERAL, _STEPS * speed / rate
    )  # so that at its end, of curvature pi / length, it goes round at no more than that
    clothoid = _rounded(clothoid)
    short, long = _rounded(clothoid / 3), 2 * _rounded(clothoid / 3)
    length = 4 * clothoid + 2 * short + long
    acceleration = min(_rounded(speed / _SPEED_UP), _LATERAL)
    seconds = length / speed
    limit = top / radius
    return {
        "name": name,
        "file": f"{name}.yaml",
        "path_file": f"{name}-path.yaml",
        "radius": _text(radius),
        "separation": _text(separation),
        "true_radius": _text(_WORN * radius),
        "true_separation": _text(_SLIPS * separation),
        "top": _text(top),
        "limit": _text(_rounded(limit, 4, down=True)),
        "wheel_acceleration": _text(_rounded(2 * acceleration / radius)),
        "merge": str(max(1, min(round(_MERGE * rate), int(seconds * rate / 4)))),
        "floor": _text(_rounded(_FLOOR * separation)),
        "noise": _text(_rounded(_NOISE * separation)),
        "offset": _text(_rounded(_OFFSET * separation)),
        "length": _text(length),
        "bend": _text(_rounded(clothoid / math.pi)),
        "sample_time": f"{1e3 / rate:g} ms" if (1e3 / rate).is_integer() else f"1/{_text(rate)} s",
        "rate": _text(rate),
        "short": _text(short),
        "long": _text(long),
        "clothoid": _text(clothoid),
        "speed": _text(speed),
        "acceleration": _text(acceleration),
        "lateral": _text(_LATERAL),
    }


def _text(number: float) -> str:
    """A number as somebody writes it, without an exponent where that is short."""
    return f"{number:.10g}"


def _rounded(number: float, digits: int = 2, *, down: bool = False) -> float:
    """A number with few digits, away from 0, or towards it."""
    step = 10.0 ** (math.floor(math.log10(number)) + 1 - digits)
    whole = math.floor(number / step + 1e-9) if down else math.ceil(number / step - 1e-9)
    return float(f"{whole * step:.{digits}g}")
