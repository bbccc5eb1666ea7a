"""The paper's theorems about an experiment: what is asked for is computed, and loaded, then."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from hilc_cli.engine.experiment import Experiment

if TYPE_CHECKING:
    from hilc_cli.theory.proof.bounds import Bounds
    from hilc_cli.theory.proof.constants import Conditions


class Proof:
    """What the paper's theorems say of an experiment, computed when it is asked for."""

    def __init__(self, experiment: Experiment) -> None:
        """Takes an experiment of the hybrid law."""
        self._experiment = experiment

    @cached_property
    def conditions(self) -> Conditions:
        """Those of the theorems."""
        from hilc_cli.theory.proof.constants import conditions

        with _infinite():
            return conditions(self._experiment)

    @cached_property
    def theories(self) -> dict[str, Bounds]:
        """The bounds by name, see `theories`."""
        from hilc_cli.theory.proof.bounds import theories

        with _infinite():
            return theories(self._experiment)


def _infinite() -> np.errstate:
    """Where numbers leave the range of floating point, they end as infinite: above any limit."""
    return np.errstate(over="ignore", invalid="ignore", divide="ignore")
