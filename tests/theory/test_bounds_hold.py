"""The bounds beside what 240 random disturbed experiments really did."""

from __future__ import annotations

from collections import Counter, defaultdict
from pathlib import Path

import numpy as np
import pytest

from hilc_cli.theory.proof.bounds import (
    AS_PRINTED,
    CORRECTED,
    WITH_SAMPLE_TIME,
    WITHIN_LIMIT,
    bounds,
    theories,
)
from hilc_cli.theory.proof.constants import constants
from hilc_cli.theory.proof.measured import Comparison, compare
from tests.theory.experiments import along_run, completed_trials, random_experiment

pytestmark = pytest.mark.slow

CASES = 240
DOCUMENT = Path(__file__).resolve().parents[2] / "docs" / "paper.md"
LAST = 5
ALONG_RUN = "corrected, with the headings of the run"
LARGE_LAMBDA = ", large lambda"

Found = dict[int, dict[str, Comparison]]


@pytest.fixture(scope="module")
def found() -> Found:
    """The comparisons of all cases, by their seeds."""
    cases: Found = {}
    for seed in range(CASES):
        experiment = random_experiment(seed)
        trials = completed_trials(experiment)
        given = theories(experiment)
        angle = float(along_run(experiment, trials)[1].max())
        given[ALONG_RUN] = bounds(experiment, constants(experiment, heading_mismatch=angle))
        for name in CORRECTED, WITHIN_LIMIT:
            if name in given:
                c = given[name].constants
                far = c.h2 + 100 * (given[name].lambda_ - c.h2)
                given[name + LARGE_LAMBDA] = bounds(experiment, c, far)
        cases[seed] = compare(experiment, given, trials)
    return cases


def violations(found: Found) -> dict[tuple[str, str], list[int]]:
    """Seeds of the cases that violate a bound, by the theory's name and the quantity."""
    seeds: dict[tuple[str, str], list[int]] = defaultdict(list)
    for seed, comparisons in found.items():
        for theory, comparison in comparisons.items():
            for quantity, part in comparison.parts.items():
                if len(part.violated) > 0:
                    seeds[theory, quantity].append(seed)
                if part.limit_violated(LAST):
                    seeds[theory, f"{quantity} limit"].append(seed)
    return seeds


def report(found: Found) -> str:
    """Looseness, log10(bound / measured), over all cases and iterations."""
    loose: dict[tuple[str, str], list[float]] = defaultdict(list)
    for comparisons in found.values():
        for theory, comparison in comparisons.items():
            for quantity, part in comparison.parts.items():
                loose[theory, quantity] += part.looseness[np.isfinite(part.looseness)].tolist()
    return "\n".join(
        f"{theory}, {quantity}: median {np.median(values):.2f}, from {min(values):.2f} to "
        f"{max(values):.2f}"
        for (theory, quantity), values in loose.items()
    )


def test_corrected_bounds_hold(found: Found) -> None:
    violated = violations(found)
    print(report(found))  # how loose they are, with pytest -s
    wrong = {key: seeds for key, seeds in violated.items() if key[0].startswith("corrected")}
    assert not wrong, f"{wrong}\n{report(found)}"


def test_printed_bounds_do_not(found: Found) -> None:
    violated = violations(found)
    counts = Counter({key: len(seeds) for key, seeds in violated.items()})
    for theory in AS_PRINTED, WITH_SAMPLE_TIME:
        for quantity in "input", "state", "output", "input limit":
            assert counts[theory, quantity] > 0, f"{counts}\n{report(found)}"


def test_document_tells_these_figures(found: Found) -> None:
    document = DOCUMENT.read_text(encoding="utf-8")
    violated = violations(found)
    quantities = ("input", "state", "output")
    printed = sum(len(violated[AS_PRINTED, quantity]) for quantity in quantities)
    assert f"printed, {printed} of {len(quantities) * len(found)} are violated" in document
    loose = np.concatenate([cases[CORRECTED].state.looseness for cases in found.values()])
    loose = loose[np.isfinite(loose)]
    told = f"{np.median(loose):.1f} decades above the state's error in the median"
    assert f"{told}, between {loose.min():.0f} and {loose.max():.0f}" in " ".join(document.split())


def test_bounds_are_nearly_attained(found: Found) -> None:
    """What holds is no mere infinity: the first input's bound is exact, others come near."""
    closest = {
        (theory, quantity): min(
            float(cases[theory].parts[quantity].looseness[1:].min())
            for cases in found.values()
            if theory in cases
        )
        for theory in (CORRECTED, WITHIN_LIMIT)
        for quantity in ("input", "state", "output")
    }
    assert max(closest.values()) < 0.1, closest


def test_cases_are_of_every_kind(found: Found) -> None:
    limits = Counter(
        (name, comparison.bounds.has_limit)
        for comparisons in found.values()
        for name, comparison in comparisons.items()
    )
    assert len(found) >= 200
    for name in CORRECTED, WITHIN_LIMIT, ALONG_RUN:
        assert limits[name, True] >= 20, limits
        assert limits[name, False] >= 10, limits
