"""``hilc drive``: the controller of a pass over standard input and output."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from hilc_cli.cli import options
from hilc_cli.cli.completion import complete_scenario
from hilc_cli.errors import UsageError
from hilc_cli.reporting.terminal import say

Source = Annotated[
    str,
    typer.Argument(
        metavar="LAB|SCENARIO",
        help="The folder of a lab, a scenario file, or example:NAME.",
        autocompletion=complete_scenario,
        show_default=False,
    ),
]


def drive(
    source: Source,
    set_: options.Overrides = None,
    no_plots: Annotated[bool, typer.Option("--no-plots", help="Draw no pictures.")] = False,
    trust: options.Trust = False,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
    version: options.Version = False,
) -> None:
    """Be the controller of a robot, or of a simulator, line by line.

    Reads a line 't x y heading' (SI units) for each sample from standard input and answers each
    with 'left right' [rad/s] on standard output. No answer is beyond the limits. A line that is no
    pose, or two samples late, ends the pass: the wheels are brought to rest. The end of the input
    ends the pass, which a lab then learns from; a scenario is only driven, and nothing is kept.

    \b
    Examples:
      hilc drive lab < robot-to-hilc > hilc-to-robot
      socat EXEC:'hilc drive lab' /dev/ttyUSB0,b115200,rawer
      hilc drive my-robot.yaml --set controller.law=feedback
    """
    from hilc_cli.files import is_there
    from hilc_cli.labs.driving import Drive, serve
    from hilc_cli.labs.lab import Lab, check_limited
    from hilc_cli.scenario.loading import load_scenario

    is_lab = is_there(Path(source)) and Path(source).is_dir()
    lab = Lab(source, trust=trust) if is_lab else None
    if lab is None:
        if source == "-":
            raise UsageError("standard input is for poses; give the scenario as a file")
        scenario = load_scenario(source, set_ or [], trust=trust)
        check_limited(scenario)
        learning = scenario.robot_learning()
        pass_ = Drive(learning.plan(), learning.reference, scenario.spec.safety_limits)
    elif set_:
        raise UsageError(f"--set {set_[0]}: a lab keeps its scenario; begin another lab with it")
    else:
        pass_ = lab.drive()
    serve(pass_, sys.stdin.buffer, sys.stdout.buffer)
    if lab is None:
        if not quiet:
            end = f"stopped: {pass_.stopped}" if pass_.stopped else "the input ended"
            say(f"{end}, after {pass_.progress}")
        return
    state = lab.add_driven(pass_, plots=not no_plots, command=sys.argv)
    if not quiet:
        error = state.run.metrics.row(-1)["max_position_error_m"]
        say(
            f"trial {len(state.trials) - 1} is added: up to {error * 1e3:.3g} mm off; "
            f"the next plan is {lab.plan_file}"
        )
