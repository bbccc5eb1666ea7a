"""What a user says about a log: which columns, topics and frames, and where the marker sits."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class ReadOptions:
    """How a log is to be read.

    Attributes:
        columns: Names of columns of a table, by what they are: see `log_columns.ROLES`.
        pose: Topic of the poses in a bag; None: the only one that has poses.
        command: Topic of the commands; None: the only one that has commands, if there is one.
        wheels: Topic of the measured wheel speeds; None: the only one that has them.
        frames: Parent and child frame of the poses on a topic of transforms.
        joints: Names of the left and right wheel's joint.
        marker: Where the measured point is, seen from the wheel midpoint: ahead and left [m].
    """

    columns: Mapping[str, str] = field(default_factory=dict)
    pose: str | None = None
    command: str | None = None
    wheels: str | None = None
    frames: tuple[str, str] | None = None
    joints: tuple[str, str] | None = None
    marker: tuple[float, float] = (0.0, 0.0)
