"""The part of ``hilc check`` that tells what late wheels do, and what a pass tells of a robot."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hilc_cli.reporting.terminal import Section

if TYPE_CHECKING:
    from hilc_cli.checks.checking import Check


def motors_section(check: Check, *, whole: bool = False) -> Section:
    """Returns what is known of late wheels, and of what a pass tells.

    Args:
        check: What was found.
        whole: All of it; else what a report of one screen has.
    """
    late, identifiable = check.lateness, check.identifiable
    return Section(
        "motors",
        "What do late wheels do, and what does a pass tell of the robot?",
        [*late.rows, *identifiable.rows] if whole else [],
        document={"lateness": late.document, "a_pass_tells": identifiable.document}
        if whole
        else {},
        brief=late.brief,
    )
