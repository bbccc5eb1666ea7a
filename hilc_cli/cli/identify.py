"""``hilc identify``: what logs of any motion tell of a robot."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hilc_cli.cli import log_options, options
from hilc_cli.reporting.terminal import print_json, say, say_notes

Logs = Annotated[
    list[Path],
    typer.Argument(
        metavar="LOG...",
        help="CSV or TUM files, or bags of ROS 2, of one robot.",
        show_default=False,
    ),
]
Believed = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="model.KEY=VALUE",
        help="What is believed of the robot, such as model.wheel_radius=0.033; repeatable.",
        show_default=False,
    ),
]


def identify(
    logs: Logs,
    set_: Believed = None,
    columns: log_options.Columns = None,
    pose: log_options.PoseTopic = None,
    command: log_options.CommandTopic = None,
    wheels: log_options.WheelsTopic = None,
    frames: log_options.Frames = None,
    joints: log_options.Joints = None,
    marker: log_options.Marker = None,
    json: options.Json = False,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
    version: options.Version = False,
) -> None:
    """Identify a robot from logs of any motion.

    Tells the radius of each wheel, their separation, delay and lag, whether wheels are swapped,
    each with its standard error, and what the logs could not tell. Prints the section 'model' of a
    scenario and the multipliers of ros2_control. Positions without headings are enough.

    \b
    Examples:
      hilc identify log.csv
      hilc identify monday.csv tuesday.csv --set model.wheel_radius=0.033 \\
          --set model.wheel_separation=0.16 --set model.turn_convention=ros
      hilc identify bag/ --pose /camera/pose --command /cmd_vel \\
          --set model.wheel_radius=0.033 --set model.wheel_separation=0.16
    """
    from hilc_cli.identification.identifying import identify
    from hilc_cli.identification.report import document, print_report

    how = log_options.read_options(columns, pose, command, wheels, frames, joints, marker)
    found = identify(logs, set_ or [], how)
    say_notes(found.notes, quiet=quiet)
    for warning in () if quiet else found.warnings:
        say(f"warning: {warning}")
    if json:
        print_json(document(found))
    elif not quiet:
        print_report(found)
