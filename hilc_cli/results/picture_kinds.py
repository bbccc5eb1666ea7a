"""The kinds of pictures of runs and of sweeps: all that names them follows from here.

Nothing is drawn here, and Matplotlib, which starts slowly, is not loaded: the command line knows
the kinds by this list alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any


@dataclass(frozen=True, slots=True)
class PictureKind:
    """A kind of picture.

    Attributes:
        name: What users call it; its files are called so, too.
        shows: What it shows, in a line.
        home: The module whose ``PICTURE`` says how it is drawn, and of what.
    """

    name: str
    shows: str
    home: str

    def load(self) -> Any:
        """Imports what draws it, and Matplotlib with it."""
        return import_module(self.home).PICTURE


def _table(package: str, *kinds: tuple[str, str, str]) -> Mapping[str, PictureKind]:
    return {name: PictureKind(name, shows, f"{package}.{home}") for name, home, shows in kinds}


RUN_PICTURES = _table(
    "hilc_cli.runs.pictures",
    ("path-change", "path_change", "how the path changes over the iterations"),
    ("final-path", "final_path", "the last path and the reference"),
    ("error-along-path", "error_along_path", "the last errors along the path"),
    ("error", "error", "the position error over the iterations"),
    ("wheel-speeds", "wheel_speeds", "the wheel speeds of the last iteration"),
    ("summary", "summary", "four of these on one sheet"),
    ("learning", "learning", "what the law has learned of the robot"),
)
"""The kinds of pictures of runs by name, as `RunPicture` of their modules draws them."""

MOVING_PICTURES = _table(
    "hilc_cli.runs.pictures",
    ("animation", "animation", "the robot on its way, pass by pass, as a GIF"),
)
"""Those that move, as `MovingPicture` of their modules draws them: only if they are asked for."""

SWEEP_PICTURES = _table(
    "hilc_cli.sweeps.pictures",
    ("curve", "curve", "the metric against one key"),
    ("map", "heat_map", "the metric over two keys"),
    ("effects", "effects", "what each key does to the metric"),
    ("best", "best", "the best cases, and where they lie"),
    ("spread", "choice_spread", "how far apart what happens sets the cases of a choice"),
    ("bands", "bands", "how the error of all cases falls over the iterations"),
    ("search", "progress", "how a search went"),
)
"""The kinds of pictures of sweeps by name, as `SweepPicture` of their modules draws them."""
