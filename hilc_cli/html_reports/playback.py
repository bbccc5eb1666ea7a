"""A run as the page plays it: each recorded iteration thinned to what the eye sees, as numbers.

Positions, headings and speeds are whole numbers of a small step, which is far below what is seen.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from hilc_cli.drawing.view import View, leaving_note, view_of
from hilc_cli.html_reports.thinning import Thinned, thinned
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.run import RunData
from hilc_cli.results.trial import Trial
from hilc_cli.wording import counted

MOST_ITERATIONS = 60
_MOST_POINTS, _FEWEST_POINTS = 90_000, 120  # of all lines of a page, and of one line
_MOST_OF_A_LINE = 1_200
_SEEN = 1 / 1500  # of a panel's side
_SEEN_TURN = 0.01  # [rad]
_STEPS = 20_000  # of a panel's side
_STEP_TURN = 1e-3  # [rad]
_FARTHEST = 1e5  # of what is shown, in its sizes: farther than anybody looks
_DECADES = 5.0  # of the errors of an iteration that are told apart
_SEEN_DECADES = 0.012


@dataclass(frozen=True, slots=True)
class Playback:
    """What is played.

    Attributes:
        document: For the program on the page.
        notes: What was left out, a sentence each.
    """

    document: Mapping[str, Any]
    notes: Sequence[str]


def playback(
    run: RunData, iterations: Collection[int] | None = None, *, share: float = 1.0
) -> Playback:
    """Returns the recorded iterations of a run as the page plays them.

    Args:
        run: At least one iteration is recorded.
        iterations: Which of them; None: as many of all as are told apart.
        share: Of the points of a page that this run may have.
    """
    recorded = sorted(run.trials if iterations is None else set(iterations) & set(run.trials))
    chosen = _spread(recorded, MOST_ITERATIONS)
    trials = [run.trials[number] for number in chosen]
    view = view_of([run.reference], trials)
    most = int(share * _MOST_POINTS / (3 * len(trials)))
    most = max(_FEWEST_POINTS, min(most, _MOST_OF_A_LINE))
    lines = _Lines(run.reference, view, *_speed_range(run, trials), most)
    document = {
        "sampleTime": run.reference.sample_time,
        "samples": run.reference.samples,
        "last": len(run.metrics) - 1,
        "view": [view.x_min, view.x_max, view.y_min, view.y_max],
        "step": lines.step,
        "stepTurn": _STEP_TURN,
        "speedZero": lines.lowest,
        "speedStep": lines.speed_step,
        "limit": run.speed_limit,
        "robot": None
        if run.robot is None
        else {"halfTrack": run.robot.half_track, "wheelRadius": run.robot.wheel_radius},
        "reference": lines.poses(run.reference),
        "iterations": [
            {
                "number": trial.iteration,
                "pose": lines.poses(trial),
                "error": lines.errors(run.position_error(trial.iteration)),
                "speed": lines.speeds(trial),
            }
            for trial in trials
        ],
    }
    notes = _notes(run, chosen, recorded, lines, all_of=iterations is None)
    leaving = leaving_note(view, run.reference, trials)
    return Playback(document, [*notes, *(f"{each[:1].upper()}{each[1:]}." for each in leaving)])


def _notes(
    run: RunData, chosen: Sequence[int], recorded: Sequence[int], lines: _Lines, *, all_of: bool
) -> list[str]:
    notes = []
    if len(chosen) < len(recorded):
        what = "recorded" if all_of else "chosen"
        notes.append(f"{len(chosen)} of {len(recorded)} {what} iterations can be played.")
    elif len(chosen) < len(run.metrics):
        which = "recorded" if all_of else "chosen"
        count = counted(len(chosen), "iteration")
        notes.append(f"{count} of {len(run.metrics)} can be played: those that were {which}.")
    thin = "Lines have as few points as the eye needs"
    if lines.deviation > 1:
        off = 100 * _SEEN * lines.deviation
        notes.append(f"{thin}; the most restless one is off by up to {off:.2g} % of its panel.")
    else:
        notes.append(f"{thin}: none is off by more than {100 * _SEEN:.2g} % of its panel.")
    return notes


def _spread(numbers: Sequence[int], most: int) -> list[int]:
    """Returns some of the numbers, the first and the last among them."""
    if len(numbers) <= most:
        return list(numbers)
    places = np.linspace(0, len(numbers) - 1, most).round().astype(int)
    return [numbers[place] for place in places.tolist()]


def _speed_range(run: RunData, trials: Sequence[Trial]) -> tuple[float, float]:
    """Returns the slowest and the fastest wheel speed that is shown [rad/s]."""
    speeds = [each for trial in trials for each in (trial.left, trial.right) if len(each)]
    low = min((float(each.min()) for each in speeds), default=0.0)
    high = max((float(each.max()) for each in speeds), default=0.0)
    return (low, high) if high > low else (low - 1.0, high + 1.0)


class _Lines:
    """Makes lines of few whole numbers of what was sampled, and remembers how good they are.

    Attributes:
        step: Of positions [m].
        lowest: The wheel speed that is zero [rad/s].
        speed_step: Of wheel speeds [rad/s].
        deviation: The largest of all lines so far, in what is just seen.
    """

    def __init__(
        self, reference: Reference, view: View, lowest: float, highest: float, most: int
    ) -> None:
        self._side = max(view.width, view.height)
        self._center = np.array([[(view.x_min + view.x_max) / 2], [(view.y_min + view.y_max) / 2]])
        self._samples, self._most = reference.samples, most
        self.step = self._side / _STEPS
        self.lowest, self.speed_step = lowest, (highest - lowest) / _STEPS
        self.deviation = 0.0

    def poses(self, motion: Trial | Reference) -> dict[str, list[int]]:
        """Returns where something was."""
        far = _FARTHEST * self._side
        positions = np.array([motion.x, motion.y])
        positions = np.clip(positions, self._center - far, self._center + far)
        turns = np.clip(motion.heading, -1e6, 1e6)[None]
        kept = self._kept(np.vstack([positions / (_SEEN * self._side), turns / _SEEN_TURN]))
        x, y = np.rint(positions[:, kept.samples] / self.step).astype(int).tolist()
        heading = np.rint(turns[0, kept.samples] / _STEP_TURN).astype(int).tolist()
        return {"at": kept.samples.tolist(), "x": x, "y": y, "heading": heading}

    def errors(self, errors: Floats) -> dict[str, list[float]]:
        """Returns the position errors of an iteration [m], which are looked at on any scale."""
        largest = float(errors.max())
        if largest == 0:
            return {"at": [0, self._samples], "value": [0.0, 0.0]}
        seen = np.log10(np.maximum(errors / largest, 10**-_DECADES)) / _SEEN_DECADES
        plain = errors / (_SEEN * largest)
        kept = self._kept(np.array([seen, plain]), counts=False)
        values = [float(f"{value:.5g}") for value in errors[kept.samples].tolist()]
        return {"at": kept.samples.tolist(), "value": values}

    def speeds(self, trial: Trial) -> dict[str, list[int]]:
        """Returns the wheel speeds of an iteration, the last ones held to the end."""
        held = np.array([np.append(each, each[-1:]) for each in (trial.left, trial.right)])
        whole = (held - self.lowest) / self.speed_step
        kept = self._kept(whole / (_SEEN * _STEPS))
        left, right = np.rint(whole[:, kept.samples]).astype(int).tolist()
        return {"at": kept.samples.tolist(), "left": left, "right": right}

    def _kept(self, lines: Floats, *, counts: bool = True) -> Thinned:
        found = thinned(lines, self._most)
        if counts:
            self.deviation = max(self.deviation, found.deviation)
        return found
