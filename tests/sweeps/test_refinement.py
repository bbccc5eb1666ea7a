"""The end of a search: down to the bottom of a hollow, in few cases, the same ones each time."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from hilc_cli.sweeps.refinement import Refinement, Values, refined_cases
from hilc_cli.variation import Axis, Cases, Choices, Range

X: dict[str, Axis] = {"x": Range(-1.0, 3.0)}
Cost = Callable[..., float]


def refined(axes: dict[str, Axis], cost: Cost, before: int, steps: int) -> list[Values]:
    """What is tried after so many points of a Sobol sequence."""
    drawn = [tuple(row.values()) for row in Cases(axes, "sobol", 200).values(0, before + 200)]
    rest = iter(drawn[before:])
    refinement = Refinement(
        axes, drawn[:before], [cost(*row) for row in drawn[:before]], lambda: next(rest)
    )
    found = []
    for _ in range(steps):
        values = refinement.ask()
        refinement.tell([cost(*values)])
        found.append(values)
    return found


def smallest(cost: Cost, tried: list[Values]) -> float:
    return min(cost(*values) for values in tried)


@pytest.mark.parametrize("power", [1, 2, 4])
def test_bottom_of_a_hollow(power: int) -> None:
    """A kink, a parabola, a flat bottom: in 15 steps nearer than 4000 points in equal steps."""

    def cost(x: float) -> float:
        return abs(x - math.sqrt(2)) ** power

    found = refined(X, cost, 20, 15)
    assert smallest(cost, found) < cost(math.sqrt(2) + 4 / 4000 / 2)


def test_several_keys() -> None:
    axes: dict[str, Axis] = {**X, "y": Range(0.01, 100.0, "log"), "z": Range(0.0, 1.0)}

    def cost(x: float, y: float, z: float) -> float:
        return (x - 1) ** 2 + abs(math.log10(y) - 0.5) + (z - x / 4) ** 2

    before = [tuple(row.values()) for row in Cases(axes, "sobol", 60).values(0, 60)]
    found = refined(axes, cost, 60, 60)
    assert smallest(cost, found) < 0.1 * smallest(cost, before)


def test_values_stay_within_their_ranges() -> None:
    whole = Range(1, 900, "log", whole=True)
    axes: dict[str, Axis] = {**X, "n": Range(1, 9, "integer"), "w": whole}
    for x, n, w in refined(axes, lambda x, n, w: n + w - x, 20, 40):
        assert isinstance(x, float) and -1 <= x <= 3
        assert type(n) is int and 1 <= n <= 9
        assert type(w) is int and 1 <= w <= 900


def test_best_at_an_end() -> None:
    found = refined(X, lambda x: x, 20, 12)
    assert min(values[0] for values in found) < -0.99  # type: ignore[type-var, operator]
    assert refined({**X, "y": Range(0.0, 1.0)}, lambda x, y: x + y, 20, 30)


def test_lists_stay_at_the_best_that_was_found() -> None:
    axes: dict[str, Axis] = {"word": Choices(("a", "b", True)), **X}
    costs = {"a": 1.0, "b": 0.0, True: 2.0}
    found = refined(axes, lambda word, x: costs[word] + abs(x - 1), 30, 8)
    assert {word for word, _ in found} == {"b"}


def test_points_that_differ_in_words_alone_are_told_apart() -> None:
    """Few whole numbers, which many cases of either word share."""
    whole: dict[str, Axis] = {"n": Range(1, 4, "integer"), "m": Range(1, 4, "integer")}
    axes: dict[str, Axis] = {"word": Choices(("bad", "good")), **whole, **X}
    found = refined(axes, lambda word, n, m, x: 9.0 * (word == "bad") + n + m + x * x, 40, 30)
    assert [values[0] for values in found[:20]] == ["good"] * 20


def test_no_case_twice_and_the_same_each_time() -> None:
    """Several hollows, plateaus, and points that diverge."""

    def cost(x: float) -> float:
        return math.inf if x > 2.5 else round(math.sin(9 * x) + x * x / 4, 2)

    found = refined(X, cost, 16, 100)
    drawn = [row["x"] for row in Cases(X, "sobol", 16).values(0, 16)]
    tried = [*drawn, *(values[0] for values in found)]
    assert len(set(tried)) == 116
    assert refined(X, cost, 16, 100) == found


def test_few_whole_numbers_run_out() -> None:
    axes: dict[str, Axis] = {"n": Range(1, 40, "integer")}
    drawn = [row["n"] for row in Cases(axes, "sobol", 4).values(0, 4)]
    for best in (11, 26, 40):
        found = [row[0] for row in refined(axes, lambda n, best=best: abs(n - best), 4, 20)]
        assert best in {*drawn, *found[:8]}
        assert len({*drawn, *found}) == 24


def test_nothing_good_is_no_failure() -> None:
    assert len(set(refined(X, lambda x: math.inf, 12, 12))) == 12


def test_how_many_cases_are_left_for_it() -> None:
    words: dict[str, Axis] = {"word": Choices(("a", "b")), "one": Range(5, 5, "integer")}
    assert [refined_cases(X, cases) for cases in (15, 16, 60, 203)] == [0, 4, 15, 50]
    assert refined_cases(words, 200) == 0
