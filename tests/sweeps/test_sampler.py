"""What a search tries next."""

from __future__ import annotations

import itertools
import math
import warnings
from collections.abc import Iterable

import optuna
import pytest

from hilc_cli.sweeps.sampler import Sampler, Values
from hilc_cli.variation import Axis, Cases, Choices, Range

AXES: dict[str, Axis] = {
    "linear": Range(-2.0, 3.0),
    "log": Range(1e-3, 1e3, "log", 7),
    "whole": Range(1.0, 9.0, "linear", whole=True),
    "whole-log": Range(1.0, 1000.0, "log", whole=True),
    "integer": Range(-3, 4, "integer"),
    "one": Range(5, 5, "integer"),
    "numbers": Choices((4.0, 1.0, 2.5)),
    "words": Choices(("a", None, True, 3)),
}


def tried(axes: dict[str, Axis], batches: int, seed: int = 0) -> list[Values]:
    """Batches of 8, of which 2 are drawn, with costs that depend on the numbers."""
    sampler = Sampler(Cases(axes, "sobol", 8 * batches, seed))
    found: list[Values] = []
    for _ in range(batches):
        values = sampler.ask(8, 2)
        assert len(values) == 8
        sampler.tell([math.fsum(v for v in row if isinstance(v, float)) for row in values])
        found += values
    return found


def test_values_are_those_of_the_axes() -> None:
    for row in tried(AXES, 6):
        values = dict(zip(AXES, row, strict=True))
        for key in ("linear", "log", "whole", "whole-log", "integer", "one"):
            value = values[key]
            low, high = AXES[key].ends
            assert low <= value <= high  # type: ignore[operator]
            assert type(value) is (float if key in ("linear", "log") else int)
        for key in ("numbers", "words"):
            axis = AXES[key]
            assert isinstance(axis, Choices)
            assert any(values[key] is value for value in axis.values)


def test_same_seed_same_cases() -> None:
    assert tried(AXES, 4) == tried(AXES, 6)[:32]
    assert tried(AXES, 4) != tried(AXES, 4, seed=1)
    assert tried(AXES, 1, seed=2**64 - 1) != tried(AXES, 1, seed=2**32 - 1)


def test_first_cases_are_drawn() -> None:
    cases = Cases(AXES, "sobol", 12, 3)
    values = Sampler(cases).ask(12, 12)
    assert [dict(zip(AXES, row, strict=True)) for row in values] == cases.values(0, 12)


def test_no_case_is_tried_twice_while_there_are_others() -> None:
    axes: dict[str, Axis] = {"n": Range(1, 6, "integer"), "w": Choices(("a", "b", "c", "d"))}
    every = set(itertools.product(range(1, 7), "abcd"))
    assert set(tried(axes, 3)) == every  # 24 of 24
    assert len(tried(axes, 5)) == 40


def test_ratios_are_searched_as_such() -> None:
    """Half of the points of a logarithmic range lie below the geometric mean of its ends."""
    axes: dict[str, Axis] = {"log": Range(1e-3, 1e3, "log")}
    points = [row[0] for row in Sampler(Cases(axes, "sobol", 64)).ask(64, 64)]
    below = [point for point in points if isinstance(point, float) and point < 1]
    assert len(below) == 32


def low_cases(worst: float) -> int:
    """How many of 70 cases lie below x = 0.3, where the cost is y; above it is the worst."""
    axes: dict[str, Axis] = {"x": Range(0.0, 1.0), "y": Range(0.0, 1.0)}
    sampler = Sampler(Cases(axes, "sobol", 100))
    batch, low = sampler.ask(20, 20), 0
    for _ in range(7):
        sampler.tell([worst if x > 0.3 else y for x, y in points(batch)])
        batch = sampler.ask(10, 0)
        low += sum(x <= 0.3 for x, _ in points(batch))
    return low


def points(batch: Iterable[Values]) -> list[tuple[float, float]]:
    return [(x, y) for x, y in batch if isinstance(x, float) and isinstance(y, float)]


def test_search_moves_away_from_what_is_worst() -> None:
    assert low_cases(math.inf) > 35  # 21 by chance, with a standard deviation of 4
    assert low_cases(math.inf) == low_cases(1e300)  # only the order counts


def test_nothing_good_is_no_failure() -> None:
    sampler = Sampler(Cases({"x": Range(0.0, 1.0)}, "sobol", 40))
    for _ in range(5):
        sampler.tell([math.inf for _ in sampler.ask(8, 2)])


def test_optuna_says_nothing(capfd: pytest.CaptureFixture[str]) -> None:
    before = optuna.logging.get_verbosity()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        tried(AXES, 2)
    assert capfd.readouterr() == ("", "")
    assert optuna.logging.get_verbosity() == before
