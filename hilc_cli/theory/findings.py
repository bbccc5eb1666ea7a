"""What a part of theory has to say to people."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from hilc_cli.disturbance.streams import Bounded, Disturbance
from hilc_cli.engine.experiment import Experiment
from hilc_cli.reference.sampled import Floats

Rows = list[tuple[str, str]]
"""Names, and what there is to say of them, for a report."""


@dataclass(frozen=True, slots=True)
class Findings:
    """Sentences, each with its remedy.

    Attributes:
        failures: Why the experiment cannot work, the first one to be told first.
        warnings: What is possible, or not known to be impossible, but probably not meant.
    """

    failures: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()

    @classmethod
    def failure(cls, text: str) -> Findings:
        """Returns a single failure."""
        return cls(failures=(text,))

    @classmethod
    def warning(cls, text: str) -> Findings:
        """Returns a single warning."""
        return cls(warnings=(text,))


def joined(*parts: Findings) -> Findings:
    """Returns the findings of several parts, in their order."""
    return Findings(
        tuple(text for part in parts for text in part.failures),
        tuple(text for part in parts for text in part.warnings),
    )


LEVEL = 0.95
"""Share of runs, each with a seed of its own, whose error stays below what is foretold."""
SOURCES = ("initial_pose", "output", "state")
"""The disturbances of an experiment by name, as reports tell them: start, readings, state."""
RESOLUTION = 1e-3
"""Share of the path's size below which no error is foretold: what theory leaves out is as large."""


@dataclass(frozen=True, slots=True)
class ExpectedError:
    """The largest position error of the last iteration, as theory foretells it.

    Attributes:
        first_m: Of iteration 0 without disturbances [m].
        final_m: Of the last iteration without disturbances [m].
        foretold_m: Of the last iteration with disturbances [m]: 95 of 100 runs, each with a seed
            of its own, stay below. Not less than `final_m`.
        of_start_m: The part of it that the disturbance of the initial pose makes alone [m]; 0
            without one.
        of_readings_m: Likewise, that of the readings (``disturbance.output``).
        of_state_m: Likewise, that of the state.
        unsure: Why the figures may be off by more than a factor of two, as the part of a sentence
            that follows "since"; None if they are not.
        is_floor: Whether what is computed is less than `foretold_m`, below which what theory leaves
            out is as large.
    """

    first_m: float
    final_m: float
    foretold_m: float
    of_start_m: float = 0.0
    of_readings_m: float = 0.0
    of_state_m: float = 0.0
    unsure: str | None = None
    is_floor: bool = False


def extent(experiment: Experiment) -> float:
    """Returns the longer side of the path's bounding box [m], or the track if that is more.

    A path on the spot has no size, but who drives it has.
    """
    return max(experiment.reference.size, 2 * experiment.robot.half_track)


def share_of_path(error: float, experiment: Experiment) -> str:
    """Returns an error as a share of the path's size, or as a multiple of it."""
    sizes = error / extent(experiment)
    share = f"{100 * sizes:.2g} % of" if sizes < 1 else f"{sizes:.3g} times"
    return f"{share} the path's size"


def active_sources(disturbance: Disturbance) -> dict[str, Bounded]:
    """Returns the disturbances that there are, by their names, in the order of SOURCES."""
    sources = {name: getattr(disturbance, name) for name in SOURCES}
    return {name: source for name, source in sources.items() if source.active}


def expected_of_seeds(
    experiment: Experiment,
    first: float,
    final: float,
    errors: Floats,
    alone: Callable[[Experiment], Floats],
    unsure: str | None,
) -> ExpectedError:
    """Returns the error to be expected, of so many seeds that all of them are the LEVEL of runs.

    Args:
        experiment: With all of its disturbances.
        first: Largest error of iteration 0 without them [m].
        final: That of the last iteration without them [m].
        errors: Those of all seeds with them [m]; the first seed is not disturbed.
        alone: The same of an experiment with one of the disturbances.
        unsure: Why all this may be off, see `ExpectedError`.
    """
    added = dict.fromkeys(SOURCES, 0.0)
    active = active_sources(experiment.disturbance)
    for name, source in active.items():
        found = errors
        if len(active) > 1:
            only = replace(Disturbance(), **{name: source})  # type: ignore[arg-type]  # by its name
            found = alone(replace(experiment, disturbance=only))
        added[name] = max(0.0, float(found.max() - found[0]))
    largest, least = float(errors.max()), RESOLUTION * extent(experiment)
    foretold = max(final, largest, least)
    start, readings, state = added.values()
    is_floor = largest < least
    return ExpectedError(first, final, foretold, start, readings, state, unsure, is_floor)


def expected_rows(expected: ExpectedError, experiment: Experiment) -> Rows:
    """Returns the error to be expected of a law of which no iterations are predicted."""
    iterations = experiment.iterations
    if experiment.reference.size == expected.first_m == expected.final_m == 0:
        # No position tells how well it turns, and of the heading nothing is predicted.
        return disturbed_rows(expected)
    last = f"{length_text(expected.final_m)} in iteration {iterations}"
    if iterations:
        last = f"{length_text(expected.first_m)} in iteration 0, {last}"
    disturbed = disturbed_rows(expected)
    return [("Predicted", last + (", undisturbed" if disturbed else "")), *disturbed]


def disturbed_rows(expected: ExpectedError) -> Rows:
    """Returns what disturbances make of the last iteration, together and each alone."""
    parts = {
        "start": expected.of_start_m,
        "readings": expected.of_readings_m,
        "state": expected.of_state_m,
    }
    made = [f"{name} {error:.2g} m" for name, error in parts.items() if error > 0]
    if not made:
        return []
    alone = f" ({', '.join(made)})" if len(made) > 1 else ""
    shown = f"up to {expected.foretold_m:.4g} m in {LEVEL:.0%} of runs"
    if expected.is_floor:
        shown = f"less than theory tells apart, {expected.foretold_m:.2g} m"
    return [("Disturbed", shown + alone)]


def expected_document(expected: ExpectedError) -> dict[str, object]:
    """Returns the error to be expected as JSON."""
    return {
        "first_m": expected.first_m,
        "final_m": expected.final_m,
        "with_disturbances_m": expected.foretold_m,
        "with_disturbances_is_floor": expected.is_floor,
        "of_start_m": expected.of_start_m,
        "of_readings_m": expected.of_readings_m,
        "of_state_m": expected.of_state_m,
        "unsure_since": expected.unsure,
    }


def length_text(error: float) -> str:
    """Returns an error in metres as a report tells it."""
    return f"{error:.4g} m" if math.isfinite(error) else "not finite"
