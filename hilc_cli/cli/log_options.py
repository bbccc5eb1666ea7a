"""Options that say how the log of a robot is to be read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from hilc_cli.errors import UsageError

if TYPE_CHECKING:
    from hilc_cli.logs.options import ReadOptions

Columns = Annotated[
    str | None,
    typer.Option(
        metavar="ROLE=NAME,...",
        help="Columns of a table by what they are, such as t=stamp,x=px,y=py.",
        show_default=False,
    ),
]
Pose = Annotated[
    str | None,
    typer.Option(metavar="TOPIC", help="Topic of the poses in a bag.", show_default=False),
]
Command = Annotated[
    str | None,
    typer.Option(metavar="TOPIC", help="Topic of the commands in a bag.", show_default=False),
]
Wheels = Annotated[
    str | None,
    typer.Option(
        metavar="TOPIC", help="Topic of the measured wheel speeds in a bag.", show_default=False
    ),
]
Frames = Annotated[
    str | None,
    typer.Option(
        metavar="PARENT,CHILD", help="Frames of the poses on a topic of tf.", show_default=False
    ),
]
Joints = Annotated[
    str | None,
    typer.Option(
        metavar="LEFT,RIGHT", help="Joints of the wheels on a topic of them.", show_default=False
    ),
]
Marker = Annotated[
    str | None,
    typer.Option(
        metavar="AHEAD,LEFT",
        help="Where the measured point is, seen from the wheel midpoint [m].",
        show_default=False,
    ),
]


def read_options(
    columns: str | None,
    pose: str | None,
    command: str | None,
    wheels: str | None,
    frames: str | None,
    joints: str | None,
    marker: str | None,
) -> ReadOptions:
    """Returns what the options say.

    Raises:
        UsageError: One of them has another form.
    """
    from hilc_cli.logs.options import ReadOptions

    named: dict[str, str] = {}
    for part in (columns or "").split(",") if columns else ():
        role, equals, name = part.partition("=")
        if not (role.strip() and equals and name.strip()):
            raise UsageError(f"--columns {columns}: must be ROLE=NAME,..., such as t=stamp,x=px")
        named[role.strip()] = name.strip()
    return ReadOptions(
        named,
        pose,
        command,
        wheels,
        _pair("--frames", frames, "map,base_link"),
        _pair("--joints", joints, "left_wheel_joint,right_wheel_joint"),
        _lengths("--marker", marker),
    )


def _pair(option: str, text: str | None, example: str) -> tuple[str, str] | None:
    if text is None:
        return None
    parts = [part.strip() for part in text.split(",")]
    if len(parts) != 2 or not all(parts):
        raise UsageError(f"{option} {text}: must be two names, such as {example}")
    return parts[0], parts[1]


def _lengths(option: str, text: str | None) -> tuple[float, float]:
    if text is None:
        return 0.0, 0.0
    try:
        ahead, left = map(float, text.split(","))
    except ValueError:
        raise UsageError(f"{option} {text}: must be two lengths in m, such as 0.05,0") from None
    return ahead, left
