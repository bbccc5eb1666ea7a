"""``hilc check``: what can be said of a scenario without simulating it."""

from __future__ import annotations

import typer

from hilc_cli.cli.options import Json, Overrides, Quiet, ScenarioArgument, Verbose, Version

WRONG = 3


def check(
    scenario: ScenarioArgument,
    set_: Overrides = None,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
    version: Version = False,
) -> None:
    """Check a scenario without simulating it.

    Is the file valid, can wheels and tyres follow the trajectory, is something set that is legal
    but unwise? Exits with 3 if the scenario cannot work, and says why and what would help.

    \b
    Examples:
      hilc check scenarios/fig3-circle.yaml
      hilc check my.yaml --set controller.b_w=100 --set robot.friction=0.8
      hilc check my.yaml -q && hilc run my.yaml
    """
    from hilc_cli import api
    from hilc_cli.cli.check_report import document, sections
    from hilc_cli.cli.section import print_section
    from hilc_cli.cli.terminal import print_json, print_text, say

    found = api.check(api.load_scenario(scenario, set_ or []))
    if json:
        print_json(document(found))
    elif not quiet:
        for number, section in enumerate(sections(found, verbose=verbose)):
            if number:
                print_text("")
            print_section(section)
    if found.failures:
        first, more = found.failures[0], len(found.failures) - 1
        say(f"{first} ({more} more in the report)" if more else first)
        raise typer.Exit(WRONG)
