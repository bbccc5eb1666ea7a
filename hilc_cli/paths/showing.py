"""A path, shown before anything is simulated."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hilc_cli.files import merge_folder, write_file
from hilc_cli.paths.motion import Motion, PassedJump, motion_of, passed_jumps
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.profiled import Profile
from hilc_cli.reference.sampled import Reference
from hilc_cli.results.frames import frame
from hilc_cli.results.in_notebooks import InNotebooks
from hilc_cli.results.look import USUAL, Look
from hilc_cli.scenario.experiment import Scenario
from hilc_cli.scenario.loading import Overrides, ScenarioSource, load_path, refuse_overrides
from hilc_cli.scenario.trajectory import TrajectorySpec
from hilc_cli.theory.feasibility.demand import Demand, demand_of
from hilc_cli.theory.feasibility.feasibility import (
    Feasibility,
    feasibility_findings,
    path_warnings,
)
from hilc_cli.theory.feasibility.plausibility import implausible
from hilc_cli.wording import counted, listed, wrapped

if TYPE_CHECKING:
    from pandas import DataFrame

PICTURE = "path"
SAMPLES_HEADER = (
    *("sample", "t_s", "x_m", "y_m", "heading_rad"),
    *("distance_m", "speed_m_s", "yaw_rate_rad_s", "curvature_1_m"),
)
WHEELS_HEADER = ("left_wheel_rad_s", "right_wheel_rad_s")

_ANY = Robot(wheel_radius=1.0, half_track=1.0)
"""In the place of a robot that is not known: of what it demands, wheels are not told."""
_MOST_TOLD = 4  # warnings that a path shows of itself


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ShownPath(InNotebooks):
    """A path with all that can be told of it before a simulation.

    Attributes:
        name: Of the scenario, or of the trajectory that stands alone.
        reference: The sampled path.
        demand: What it demands, segment by segment; of wheels only if the robot is known.
        motion: What each of its steps does.
        jumps: Where its curvature jumps.
        feasibility: That beside what the robot can do; None of a trajectory that stands alone.
        warnings: What a robot cannot do, and what is probably not meant.
        profile: When it is where by its timing; None if its segments have their times.
        notes: What was done to files of points.
    """

    name: str
    reference: Reference
    demand: Demand
    motion: Motion
    jumps: tuple[PassedJump, ...]
    feasibility: Feasibility | None
    warnings: tuple[str, ...]
    profile: Profile | None = None
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        told = [f"warning: {text}" for text in self.warnings[:_MOST_TOLD]]
        more = len(self.warnings) - len(told)
        return wrapped(self.headline, *told, *([f"and {more} more"] if more else []))

    @property
    def title(self) -> str:
        """The name of the scenario, and of its trajectory if that is another one."""
        names = dict.fromkeys([self.name, self.reference.name])
        return ": ".join(names)

    @property
    def headline(self) -> str:
        """What it is, in a few words."""
        demand = self.demand
        return f"{self.title}: {demand.in_short}, {counted(len(demand.segments), 'segment')}"

    def csv(self) -> str:
        """The sampled path as CSV, a row per sample.

        Speeds and curvature are those of the step that starts at the sample, with corners left
        out, so that the last sample has none; nor has a step that stands or turns in place a
        curvature.
        """
        columns = self._columns()
        text = io.StringIO()
        text.write(",".join(columns) + "\n")
        for row in zip(*(column.tolist() for column in columns.values()), strict=True):
            cells = ("" if value != value else repr(value) for value in row)
            text.write(f"{','.join(cells)}\n")
        return text.getvalue()

    def _columns(self) -> dict[str, NDArray[Any]]:
        of_samples = [self.reference.times, *self.reference.poses.T, self.motion.distance]
        of_steps = [self.motion.speed, self.motion.yaw_rate, self.motion.curvature]
        known = self.feasibility is not None
        of_steps += self.demand.wheels if known else ()
        header = (*SAMPLES_HEADER, *(WHEELS_HEADER if known else ()))
        columns = [*of_samples, *(np.append(values, np.nan) for values in of_steps)]
        return dict(zip(header, [np.arange(len(of_samples[0])), *columns], strict=True))

    def to_pandas(self) -> DataFrame:
        """The sampled path as a data frame of pandas, with the columns of `csv`.

        Raises:
            MissingPackageError: pandas is not installed.
        """
        return frame({PICTURE: self._columns}, PICTURE)

    def write_csv(self, file: str | Path) -> None:
        """Writes `csv` to a file, as a whole; one that stands there is replaced.

        Raises:
            FileAccessError: The system refused.
        """

        def write(draft: Path) -> None:
            draft.write_text(self.csv(), encoding="ascii", newline="")

        write_file(Path(file), write)

    def plot(
        self,
        folder: str | Path,
        *,
        formats: Sequence[str] = ("png",),
        look: Look = USUAL,
        dpi: int = 150,
        may_replace: Callable[[Path], bool] = lambda file: False,
    ) -> list[Path]:
        """Draws the path, its curvature, and the speeds of the wheels or else of the robot.

        Args:
            folder: Where to put path.FORMAT; made if it is not there.
            formats: png, svg, pdf.
            look: How the picture is to look, from `picture_look`.
            dpi: Dots per inch of png.
            may_replace: Whether a file of that name that stands there may be replaced.

        Returns:
            The pictures.

        Raises:
            UsageError: There is no such format.
            ExistingResultsError: A file stands there that may not be replaced.
            FileAccessError: They cannot be written.
        """
        from hilc_cli.drawing.save import save_pictures
        from hilc_cli.paths.picture import path_figure  # Matplotlib starts slowly

        pictures = {PICTURE: lambda: path_figure(self, look)}
        return merge_folder(
            Path(folder),
            lambda draft: save_pictures(pictures, draft, formats, dpi),
            may_replace,
        )


def show(
    source: ScenarioSource | TrajectorySpec, overrides: Overrides = (), *, trust: bool = False
) -> ShownPath:
    """Shows a path before anything is simulated.

    Args:
        source: A trajectory or a scenario: a file, ``example:NAME``, a dictionary, or what
            `load_scenario` returns. Of an example that there is of both kinds, the scenario.
        overrides: Values by dotted key, or texts ``KEY=VALUE`` as on the command line; not of what
            has been loaded already.
        trust: Whether classes that the scenario names as ``package.module:Class`` may be imported.

    Raises:
        HilcError: The scenario or the trajectory is not valid, or cannot be read.
        UsageError: Overrides are given of what has been loaded already.
    """
    if not isinstance(source, Scenario | TrajectorySpec):
        loaded, notes = load_path(source, overrides, trust=trust)
        return replace(show(loaded), notes=notes)
    refuse_overrides(source.name, overrides)
    if isinstance(source, TrajectorySpec):
        reference, profile = source.reference(), source.profile()
        shown = show_reference(source.name, reference, source.segment_names, profile)
        warnings = [*source.warnings(), *shown.warnings, *_without_wheels(source)]
        return replace(shown, warnings=tuple(warnings))
    feasibility, spec = source.feasibility(), source.spec
    reference = spec.reference
    model = spec.model.model(feasibility.robot)
    shown = _shown(source.name, reference, feasibility.demand, feasibility, model, spec.profile)
    return replace(shown, warnings=(*spec.trajectory.warnings(), *shown.warnings))


def _without_wheels(spec: TrajectorySpec) -> list[str]:
    """Returns what is left out of a timing where no robot is known."""
    left_out = () if spec.timing is None else spec.timing.of_wheels
    if not left_out:
        return []
    keys = listed([f"timing.{key}" for key in left_out])
    return [f"no robot is known, so that {keys} cannot count; show a scenario"]


def show_reference(
    name: str,
    reference: Reference,
    segments: Sequence[str] = (),
    profile: Profile | None = None,
) -> ShownPath:
    """Shows a reference, of which no robot is known.

    Args:
        name: What to call it.
        reference: The sampled path. Without segments it counts as one.
        segments: Names of its segments.
        profile: When it is where by its timing.
    """
    if not reference.segment_ends:
        length = float(np.abs(reference.steps).sum())
        ends = {"segment_ends": (reference.samples,), "lengths": (length,), "corners": (0.0,)}
        reference = replace(reference, **ends)  # type: ignore[arg-type]  # each as it should be
        segments = segments or ("path",)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        demand = demand_of(reference, _ANY, segments)
    return _shown(name, reference, demand, None, None, profile)


def _shown(
    name: str,
    reference: Reference,
    demand: Demand,
    feasibility: Feasibility | None,
    model: Robot | None,
    profile: Profile | None,
) -> ShownPath:
    robot = None if feasibility is None else feasibility.robot
    heading = {"trajectory.start.heading": float(reference.heading[0])}
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        motion = motion_of(reference, demand, robot or _ANY)
        warnings = implausible(demand, robot, model, heading)
        if feasibility is None:
            warnings += path_warnings(demand)
        else:
            findings = feasibility_findings(feasibility)
            warnings = [*findings.failures, *warnings, *findings.warnings]
    names = [segment.name for segment in demand.segments]
    jumps = passed_jumps(reference, motion, names, robot or _ANY, profile)
    return ShownPath(name, reference, demand, motion, jumps, feasibility, tuple(warnings), profile)
