"""What all pictures of sweeps have around their panels."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from hilc_cli.figures import labels
from hilc_cli.figures.sweep.picking import Groups, Integers, Outcome
from hilc_cli.figures.sweep.words import metric_text, value_text
from hilc_cli.results.sweep import SweepData


def heading_of(data: SweepData) -> str:
    """The scenario's name, and how many cases there are."""
    count = len(data)
    return f"{labels.shortened(data.name)}: {count:,} {'case' if count == 1 else 'cases'}"


def best_of(groups: Groups) -> int | None:
    """The group with the smallest median; None if no case of any group has a metric."""
    done = np.flatnonzero(groups.outcomes == Outcome.DONE)
    return int(done[groups.medians[done].argmin()]) if len(done) else None


def best_title(
    data: SweepData, groups: Groups, first: Integers, names: Mapping[str, str], *, median: bool
) -> str:
    """Names the best case, its metric and its values.

    Args:
        data: The sweep.
        groups: The cases, those together that differ by the seed only.
        first: A case of each group.
        names: What the keys are called, by key.
        median: Whether groups have several cases.
    """
    best = best_of(groups)
    if best is None:
        return "No case has a value"
    case = int(first[best])
    values = ", ".join(f"{name} = {value_text(data.values[k][case])}" for k, name in names.items())
    text = f"{metric_text(data, float(groups.medians[best]))} at {values}"
    return f"Best median: {text}" if median else f"Best: {text} (case {case})"
