"""``hilc new``: a scenario and a path for one's own robot, to start from."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hilc_cli.cli import options
from hilc_cli.reporting.terminal import print_json, print_text

Name = Annotated[str, typer.Argument(metavar="NAME", help="What to call it.", show_default=False)]
Radius = Annotated[
    str, typer.Option(metavar="LENGTH", help="Of the wheels, such as 33mm.", show_default=False)
]
Separation = Annotated[
    str,
    typer.Option(
        metavar="LENGTH", help="Distance of the two wheels, such as 16cm.", show_default=False
    ),
]
TopSpeed = Annotated[
    str,
    typer.Option(
        metavar="SPEED",
        help="Of the robot, such as 0.22m/s, or of a wheel, such as 60rpm.",
        show_default=False,
    ),
]
Rate = Annotated[
    str,
    typer.Option(metavar="HZ", help="How often it gets a command, such as 20.", show_default=False),
]


def new(
    name: Name,
    wheel_radius: Radius,
    wheel_separation: Separation,
    top_speed: TopSpeed,
    rate: Rate,
    out: Annotated[
        Path,
        typer.Option(
            "--out",
            metavar="DIR",
            help="Where to put the two files. [default: here]",
            callback=options.check_is_folder_name,
            show_default=False,
        ),
    ] = Path(),
    json: options.Json = False,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
    version: options.Version = False,
) -> None:
    """Write a scenario and a path for your own robot.

    Two commented files, NAME.yaml and NAME-path.yaml, that can be checked and run at once and are
    meant to be changed: a lap that the wheels can follow, and a robot whose wheels are not quite
    what its driver believes. Nothing that is there is replaced.

    \b
    Example:
      hilc new my-robot --wheel-radius 33mm --wheel-separation 16cm \\
        --top-speed 0.22m/s --rate 20
      hilc check my-robot.yaml
      hilc run my-robot.yaml
    """
    from hilc_cli.own_robots.writing import write_own_robot

    scenario, path = write_own_robot(
        name,
        wheel_radius=wheel_radius,
        wheel_separation=wheel_separation,
        top_speed=top_speed,
        rate=rate,
        folder=out,
    )
    if json:
        print_json({"scenario": str(scenario), "trajectory": str(path)})
    elif not quiet:
        commands = [f"hilc {command} {scenario}" for command in ("show", "check", "run")]
        print_text("\n".join([f"Wrote {scenario} and {path}. Next:", *commands]))
