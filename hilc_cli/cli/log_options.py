"""Options of the commands that read logs of robots."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from hilc_cli.errors import UsageError
from hilc_cli.wording import shortened

if TYPE_CHECKING:
    from hilc_cli.logs.options import ReadOptions

Columns = Annotated[
    str | None,
    typer.Option(
        metavar="ROLE=NAME,...",
        help="What the columns of a table are called, such as t=stamp,x=pose.x,y=pose.y.",
        show_default=False,
    ),
]
PoseTopic = Annotated[
    str | None,
    typer.Option("--pose", metavar="TOPIC", help="Poses in a bag.", show_default=False),
]
CommandTopic = Annotated[
    str | None,
    typer.Option("--command", metavar="TOPIC", help="Commands in a bag.", show_default=False),
]
WheelsTopic = Annotated[
    str | None,
    typer.Option(
        "--wheels", metavar="TOPIC", help="Measured wheel speeds in a bag.", show_default=False
    ),
]
Frames = Annotated[
    str | None,
    typer.Option(
        metavar="PARENT,CHILD",
        help="Frames of poses among transforms, such as map,base_link.",
        show_default=False,
    ),
]
Joints = Annotated[
    str | None,
    typer.Option(
        metavar="LEFT,RIGHT", help="Joints of the wheels among joint states.", show_default=False
    ),
]
Marker = Annotated[
    str | None,
    typer.Option(
        metavar="X,Y",
        help="Where the measured point is, ahead and left of the wheel midpoint [m].",
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
    """What the options say of a log.

    Raises:
        UsageError: One of them says nothing.
    """
    from hilc_cli.logs.log_columns import parse_columns
    from hilc_cli.logs.options import ReadOptions

    return ReadOptions(
        {} if columns is None else parse_columns(columns),
        pose,
        command,
        wheels,
        None if frames is None else _two(frames, "--frames", "map,base_link"),
        None if joints is None else _two(joints, "--joints", "left_wheel_joint,right_wheel_joint"),
        (0.0, 0.0) if marker is None else _point(marker),
    )


def _two(text: str, option: str, example: str) -> tuple[str, str]:
    parts = [part.strip() for part in text.split(",")]
    if len(parts) != 2 or not all(parts):
        raise UsageError(f"{option}: must be two names like '{example}', got {shortened(text)!r}")
    return parts[0], parts[1]


def _point(text: str) -> tuple[float, float]:
    try:
        x, y = (float(part) for part in text.split(","))
    except ValueError:
        raise UsageError(
            f"--marker: must be two numbers like '0.12,-0.03', got {shortened(text)!r}"
        ) from None
    return x, y
