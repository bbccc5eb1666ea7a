"""``hilc learn``: learning on a real robot, one log at a time."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hilc_cli.cli import log_options, options
from hilc_cli.reporting.terminal import print_json, say, say_notes

if TYPE_CHECKING:
    from hilc_cli.labs.lab import Lab
    from hilc_cli.labs.state import LabState

learn = typer.Typer(
    rich_markup_mode=None,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 80},
)

LabArgument = Annotated[
    Path, typer.Argument(metavar="LAB", help="The lab's folder.", show_default=False)
]
NoPlots = Annotated[bool, typer.Option("--no-plots", help="Draw no pictures.")]


@learn.callback()
def about(version: options.Version = False) -> None:
    """Learn on a real robot: plans out, logs in.

    A lab is a folder that remembers all passes. The robot drives LAB/next/plan.csv, its log is
    added, and the next plan is there. All of it stays as it was if something goes wrong.

    \b
    Examples:
      hilc learn start my-robot.yaml --out lab
      hilc learn add lab log.csv
      hilc learn status lab
      hilc learn undo lab
    """


@learn.command()
def start(
    scenario: options.ScenarioArgument,
    set_: options.Overrides = None,
    out: options.OutputFolder = None,
    trust: options.Trust = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
    version: options.Version = False,
) -> None:
    """Begin a lab and write its first plan.

    The folder is --out, by default labs/NAME. The first input is the feedforward of the believed
    robot, unless initial_input of the scenario says otherwise. Without a limit of the wheel speed
    (safety.wheel_speed or controller.b_w) nothing is written.

    \b
    Examples:
      hilc learn start my-robot.yaml --out lab
      hilc learn start my-robot.yaml --set safety.wheel_speed=5 --out lab
    """
    from hilc_cli.labs.lab import Lab, warnings_before
    from hilc_cli.scenario.loading import load_scenario

    valid = load_scenario(scenario, set_ or [], trust=trust)
    say_notes(valid.notes, quiet=quiet)
    for warning in () if quiet else warnings_before(valid):
        say(f"warning: {warning}")
    lab = Lab.start(valid, out or Path("labs") / valid.name, trust=trust, command=sys.argv)
    _tell(lab, lab.state, json=json, quiet=quiet)


@learn.command()
def add(
    lab: LabArgument,
    log: Annotated[
        Path,
        typer.Argument(
            metavar="LOG", help="A CSV or TUM file, or a ROS 2 bag.", show_default=False
        ),
    ],
    columns: log_options.Columns = None,
    pose: log_options.PoseTopic = None,
    command: log_options.CommandTopic = None,
    wheels: log_options.WheelsTopic = None,
    frames: log_options.Frames = None,
    joints: log_options.Joints = None,
    marker: log_options.Marker = None,
    start_time: Annotated[
        float | None,
        typer.Option(
            metavar="T",
            help="When sample 0 was sent, in the log's clock [s]. [default: found]",
            show_default=False,
        ),
    ] = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Tell what would be learned; change nothing.")
    ] = False,
    no_plots: NoPlots = False,
    trust: options.Trust = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
    version: options.Version = False,
) -> None:
    """Take a log in, learn from it, and write the next plan.

    The log is that of LAB/next/plan.csv as it was driven. What is no trial of it is refused with
    exit code 3, and the lab stays as it was.

    \b
    Examples:
      hilc learn add lab log.csv
      hilc learn add lab log.csv --dry-run
      hilc learn add lab bag/ --pose /amcl_pose --command /cmd_vel
    """
    from hilc_cli.labs.lab import Lab

    reading = log_options.read_options(columns, pose, command, wheels, frames, joints, marker)
    known = Lab(lab, trust=trust)
    state = known.add_log(
        log,
        reading,
        start_time=start_time,
        dry_run=dry_run,
        plots=not no_plots,
        command=sys.argv,
    )
    if not quiet and not json:
        from hilc_cli.labs.report import print_alignment

        print_alignment(state)
    _tell(known, state, json=json, quiet=quiet)
    if dry_run and not quiet:
        say("a dry run: nothing was changed")


@learn.command()
def status(
    lab: LabArgument,
    trust: options.Trust = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
    version: options.Version = False,
) -> None:
    """Tell how the trials of a lab went, and what comes next.

    \b
    Examples:
      hilc learn status lab
      hilc learn status lab --json
    """
    from hilc_cli.labs.lab import Lab

    known = Lab(lab, trust=trust)
    _tell(known, known.state, json=json, quiet=quiet)


@learn.command()
def undo(
    lab: LabArgument,
    no_plots: NoPlots = False,
    trust: options.Trust = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
    version: options.Version = False,
) -> None:
    """Drop the last trial: the lab is as it was before that was added.

    \b
    Example:
      hilc learn undo lab
    """
    from hilc_cli.labs.lab import Lab

    known = Lab(lab, trust=trust)
    known.undo(plots=not no_plots, command=sys.argv)
    _tell(known, known.state, json=json, quiet=quiet)


def _tell(lab: Lab, state: LabState, *, json: bool, quiet: bool) -> None:
    from hilc_cli.labs.report import print_status, status_document

    if json:
        print_json({"lab": str(lab.folder), **status_document(state, lab.plan_file)})
    elif not quiet:
        print_status(state, lab.plan_file)
