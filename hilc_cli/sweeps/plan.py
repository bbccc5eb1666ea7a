"""What a sweep is to compute, in full: any worker can do its part of it."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from importlib.metadata import version
from typing import Any

from hilc_cli.names import in_short, listed
from hilc_cli.numba_loading import DISABLED
from hilc_cli.results.metrics import ITERATIONS_TO_TOLERANCE, MAX_ERROR, MAX_ERROR_SECOND_HALF, PEAK
from hilc_cli.scenario.axis import axis_text
from hilc_cli.scenario.experiment import Scenario
from hilc_cli.scenario.sweep_section import SweepSpec
from hilc_cli.sweeps.data import SEED_KEY
from hilc_cli.sweeps.varied import TRAJECTORY, WITHOUT_EFFECT, Varied, root
from hilc_cli.variation.axes import Axis, axis_to_data
from hilc_cli.variation.cases import Cases
from hilc_cli.version import __version__
from hilc_cli.yaml_input.tree import to_yaml


@dataclass(frozen=True, eq=False, repr=False)
class Plan:
    """A sweep, every value validated.

    Attributes:
        varied: The scenario and the keys that vary.
        spec: How cases are made of the keys, and what is wanted of them.
    """

    varied: Varied
    spec: SweepSpec

    def __repr__(self) -> str:
        what = "search" if self.searches else "sweep"
        title = f"Plan of a {what} of {self.name!r}: {len(self.cases)} cases"
        return in_short(title, f"varied: {listed(self.axes)}")

    @property
    def name(self) -> str:
        """The scenario's name."""
        return self.varied.scenario.name

    @property
    def axes(self) -> Mapping[str, Axis]:
        """Values by key."""
        return self.varied.axes

    @property
    def in_lanes(self) -> bool:
        """Whether the batch engine does it; if not, cases run one by one and take longer."""
        spec = self.varied.scenario.spec
        return spec.controller.in_lanes and spec.robot.in_lanes and not DISABLED

    @cached_property
    def cases(self) -> Cases:
        """All cases; of a search as many points drawn from its ranges, with which it begins."""
        sample = "sobol" if self.searches else self.spec.sample
        return Cases(self.axes, sample, self.spec.cases or 0, self.spec.seed)

    @property
    def bands(self) -> bool:
        """Whether the errors of all iterations are kept: if asked for, or if seeds vary."""
        return self.spec.bands or SEED_KEY in self.axes

    @property
    def most_iterations(self) -> int:
        """The largest number of iterations of any case."""
        axis = self.axes.get("iterations")
        if axis is None:
            return self.varied.scenario.spec.iterations
        return max(int(end) for end in axis.ends if end is not None)

    @property
    def searches(self) -> bool:
        """Whether each case follows from the results of those before it."""
        return self.spec.minimise is not None

    def warnings(self) -> list[str]:
        """What is legal but probably not meant."""
        scenario, fullest = self.varied.scenario, self._fullest()
        # Of a law that does not learn it is warned if there is nothing to see in any case.
        found = (scenario if scenario.spec.controller.learns else fullest).warnings()
        if SEED_KEY in self.axes and not fullest.spec.disturbance.active:
            found.append("disturbance.seed varies, but there is no disturbance: all bounds are 0")
        if SEED_KEY in self.axes and self.searches:
            found.append(
                "disturbance.seed varies: the search will find lucky disturbances, not good values"
            )
        return found + hidden_by_initial_error(self.varied, self.spec)

    def _fullest(self) -> Scenario:
        """The scenario with the most iterations and the largest disturbances of any case."""
        largest = {
            key: axis.ends[-1]
            for key, axis in self.axes.items()
            if key == "iterations" or (key.startswith("disturbance.") and ".bound." in key)
        }
        return self.varied.case(largest)

    def resolved(self) -> dict[str, Any]:
        """The scenario with its sweep and its files as plain data.

        Values that follow from others, such as the model's from the robot's, are not filled in:
        they vary with those.
        """
        data = self.varied.scenario.inlined()
        # A search has no sampling, and ranks by what it minimises.
        without = {"vary", "sample", "metric"} if self.searches else {"vary"}
        sweep = self.spec.model_dump(mode="json", exclude=without, exclude_none=True)
        sweep["vary"] = {key: axis_text(axis) for key, axis in self.axes.items()}
        if self.varied.trajectories:
            sweep["vary"][TRAJECTORY] = [
                path.model_dump(mode="json", exclude_none=True)
                for path in self.varied.trajectories.values()
            ]
        return {**data, "sweep": sweep}

    def resolved_yaml(self) -> str:
        """A scenario file with which ``hilc sweep`` gives the same results."""
        return to_yaml(self.resolved())

    def checksum(self) -> str:
        """SHA-256 of all that the results depend on, the version of this program included."""
        data = self.resolved()
        for key in WITHOUT_EFFECT:
            *above, last = key.split(".")
            part = data
            for name in above:
                part = part[name]
            part.pop(last, None)
        # In order: which values a case has depends on it.
        data["axes"] = [[key, axis_to_data(axis)] for key, axis in self.axes.items()]
        data["paths"] = [path.model_dump(mode="json") for path in self.varied.trajectories.values()]
        data["bands"], data["tolerance"] = self.bands, self.spec.tolerance
        if self.searches:
            data["searched"] = [self.spec.minimise, self.spec.cases, self.spec.seed]
            data["optuna"] = version("optuna")
        elif self.spec.sample != "grid":
            data["drawn"] = [self.spec.sample, self.spec.cases, self.spec.seed]
        digest = hashlib.sha256(f"{__version__}\n{json.dumps(data, sort_keys=True)}".encode())
        for wheel in self.varied.scenario.initial_input or ():
            digest.update(wheel.tobytes())
        return digest.hexdigest()


_START = ("initial_pose", TRAJECTORY)
_BOUND = "disturbance.initial_pose"
_NONE = 1e-9  # [m]; less is rounding


def least_initial_error(varied: Varied) -> float:
    """What the position error of the first sample is at least, in all iterations of all cases.

    Returns:
        Distance of the initial pose from the trajectory's start, less what its disturbance may
        take away [m]; 0 if cases may start from different poses.
    """
    if any(root(key) in _START or key.startswith(_BOUND) for key in varied.axes):
        return 0.0
    spec = varied.scenario.spec
    offset, bound = spec.initial_error[:2], spec.disturbance.initial_pose.bound[:2]
    return math.hypot(*(max(0.0, abs(o) - b) for o, b in zip(offset, bound, strict=True)))


def hidden_by_initial_error(varied: Varied, spec: SweepSpec) -> list[str]:
    """Warnings of a metric or a tolerance that the initial error alone decides."""
    least = least_initial_error(varied)
    if least <= _NONE:
        return []
    option = "--metric" if spec.minimise is None else "--minimise"
    found = []
    if spec.tolerance is not None and least > spec.tolerance:
        problem = f"no case can settle within the tolerance of {spec.tolerance:g} m: "
        problem += f"its maximum error is at least the initial error of {least:.3g} m"
        if spec.metric == ITERATIONS_TO_TOLERANCE:
            problem += f"; {option} {MAX_ERROR_SECOND_HALF} tells cases apart"
        found.append(problem)
    if spec.metric in (MAX_ERROR, PEAK):
        found.append(
            f"{spec.metric} is at least the initial error of {least:.3g} m in every case, however "
            f"good it is; {option} {MAX_ERROR_SECOND_HALF} tells cases apart"
        )
    return found
