"""Each choice meets the same happenings, however both are made."""

from __future__ import annotations

import itertools

import pytest

from hilc_cli.sweeps.happenings import CrossedCases, cases_of
from hilc_cli.variation import Axis, Cases, Choices, Range

AXES: dict[str, Axis] = {
    "gain": Range(0.1, 10.0, "log", 3),
    "error": Range(-1.0, 1.0, "linear", 5),
    "law": Choices(("a", "b")),
    "seed": Range(1, 4, "integer"),
}
OVER = ("error", "seed")


def test_a_grid_stays_as_it_is() -> None:
    assert cases_of(AXES, "grid", 0, 0, OVER) == Cases(AXES)
    assert cases_of(AXES, "sobol", 9, 1) == Cases(AXES, "sobol", 9, 1)


@pytest.mark.parametrize("sample", ["grid", "random", "sobol"])
@pytest.mark.parametrize("happenings", [None, 7])
def test_every_choice_meets_the_same(sample: str, happenings: int | None) -> None:
    cases = cases_of(AXES, sample, 11, 3, OVER, happenings)  # type: ignore[arg-type]
    if sample == "grid" and happenings is None:
        return
    assert isinstance(cases, CrossedCases)
    choices, every = (6 if sample == "grid" else 11), happenings or 20
    rows = cases.values(0, len(cases))
    assert len(rows) == len(cases) == choices * every
    assert all(list(row) == list(AXES) for row in rows)
    per_choice = (
        list(itertools.batched(rows, every))
        if hasattr(itertools, "batched")
        else [rows[first : first + every] for first in range(0, len(rows), every)]
    )
    happened = [[(row["error"], row["seed"]) for row in part] for part in per_choice]
    assert all(part == happened[0] for part in happened)
    for part in per_choice:
        assert len({(row["gain"], row["law"]) for row in part}) == 1
    if happenings is None:
        assert set(happened[0]) == set(itertools.product((-1, -0.5, 0, 0.5, 1), (1, 2, 3, 4)))
    for key in AXES:
        assert cases.column(key) == [row[key] for row in rows]
    for first, last in ((0, 1), (5, 30), (every - 1, every + 1), (len(rows) - 1, len(rows))):
        assert cases.values(first, last) == rows[first:last]


def test_more_choices_leave_the_first_as_they_are() -> None:
    few, many = (cases_of(AXES, "random", count, 3, OVER, 7) for count in (3, 9))
    assert many.values(0, len(few)) == few.values(0, len(few))
    other = cases_of(AXES, "random", 3, 4, OVER, 7)
    assert other.column("error") != few.column("error")


def test_happenings_are_drawn_apart_from_choices() -> None:
    """The same range would otherwise give both the same numbers."""
    axes: dict[str, Axis] = {"one": Range(0.0, 1.0), "other": Range(0.0, 1.0)}
    for sample in ("random", "sobol"):
        cases = cases_of(axes, sample, 16, 5, ("other",), 16)
        assert isinstance(cases, CrossedCases)
        assert not set(cases.choices.column("one")) & set(cases.happenings.column("other"))


def test_cases_of_a_search() -> None:
    cases = cases_of(AXES, "sobol", 2, 0, OVER, 3)
    assert isinstance(cases, CrossedCases)
    listed = cases.searched([(0.5, "a"), (0.7, "b")])
    assert len(listed) == 6
    assert listed.column("gain") == [0.5] * 3 + [0.7] * 3
    assert listed.column("law") == ["a"] * 3 + ["b"] * 3
    assert list(zip(listed.column("error"), listed.column("seed"), strict=True)) == (
        2 * cases.happened()
    )


def test_what_is_drawn_twice_happens_once() -> None:
    axes: dict[str, Axis] = {"gain": Choices((1.0, 2.0)), "seed": Range(1, 3, "integer")}
    cases = cases_of(axes, "grid", 0, 1, ("seed",), 10)
    rows = cases.values(0, len(cases))
    assert sorted((row["gain"], row["seed"]) for row in rows) == [
        (gain, seed) for gain in (1.0, 2.0) for seed in (1, 2, 3)
    ]
    assert cases.count == 6
    assert cases.column("seed") == [row["seed"] for row in rows]
