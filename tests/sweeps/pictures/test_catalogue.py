from __future__ import annotations

import subprocess
import sys
import zlib
from collections.abc import Callable, Mapping
from pathlib import Path

import matplotlib
import numpy as np
import pytest

from hilc_cli.drawing.save import FORMATS, render
from hilc_cli.errors import UsageError
from hilc_cli.sweeps.data import Bands, SweepData
from hilc_cli.sweeps.pictures.catalogue import draw_sweep, kinds_for, save_sweep_figures
from hilc_cli.variation import Axis, Choices, Range, Value
from tests.drawing.reading import overlaps
from tests.made_up_runs import USERS_SETTINGS
from tests.made_up_sweeps import (
    FAILED,
    HEADING,
    L1,
    L2,
    L3,
    LONG_KEY,
    NAME,
    RATES,
    SEED,
    SEEDS,
    SPEED,
    STEPS,
    WORDS,
    bowl,
    numbers,
    sweep,
)

BANDS = Bands(np.full(3, 9.0), np.array([[1.0, 2, 3, 4, 5]] * 3))
MANY_WORDS = Choices(tuple(f"word-{n}" for n in range(9)))


@pytest.mark.parametrize(
    ("axes", "kinds"),
    [
        ({L1: RATES}, "curve"),
        ({HEADING: WORDS}, "curve"),
        ({SEED: SEEDS}, "curve"),
        ({L1: RATES, SEED: SEEDS}, "curve"),
        ({L1: RATES, L2: numbers(3)}, "curve"),
        ({L1: RATES, L2: STEPS}, "map"),
        ({L1: RATES, L2: STEPS, SEED: SEEDS}, "map"),
        ({L1: RATES, HEADING: WORDS}, "curve"),
        ({L1: RATES, HEADING: WORDS, SEED: SEEDS}, "curve"),
        ({L1: RATES, SPEED: Choices((None, 100, 180))}, "curve"),
        ({SPEED: Choices((None, 100)), HEADING: WORDS}, "curve"),
        ({L1: RATES, HEADING: MANY_WORDS}, "map"),
        ({L1: RATES, L2: STEPS, L3: STEPS}, "best effects"),
        ({L1: RATES, L2: STEPS, HEADING: WORDS}, "best effects"),
    ],
)
def test_pictures_follow_from_the_keys(axes: dict[str, Axis], kinds: str) -> None:
    assert " ".join(kinds_for(sweep(axes, bowl))) == kinds
    assert " ".join(kinds_for(sweep(axes, bowl, bands=BANDS))) == f"{kinds} bands"


def test_pictures_that_do_not_fit_are_refused(tmp_path: Path) -> None:
    one, two = sweep({L1: RATES}, bowl), sweep({L1: RATES, L2: STEPS}, bowl)
    with pytest.raises(UsageError, match=r"'curve' needs one varied key.*this sweep: map"):
        draw_sweep("curve", two)
    with pytest.raises(UsageError, match=r"'map' needs two varied keys; .*this sweep: curve"):
        save_sweep_figures(one, tmp_path, formats=["png"], kinds=["curve", "map"])
    with pytest.raises(UsageError, match="'bands' needs the error over the iterations"):
        draw_sweep("bands", one)
    with pytest.raises(UsageError, match="unknown kind of picture 'curv'; did you mean 'curve'"):
        draw_sweep("curv", one)
    with pytest.raises(UsageError, match="unknown picture format 'gif'"):
        save_sweep_figures(one, tmp_path, formats=["png", "gif"])
    with pytest.raises(UsageError, match="no case"):
        draw_sweep("curve", sweep({L1: Range(1, 2)}, bowl, "random", 0))
    assert list(tmp_path.iterdir()) == []


def test_saves_each_kind_in_each_format(tmp_path: Path) -> None:
    data = sweep({L1: RATES, L2: STEPS, L3: STEPS}, bowl, bands=BANDS)
    paths = save_sweep_figures(data, tmp_path, formats=FORMATS, dpi=40)
    kinds = ("best", "effects", "bands")
    assert paths == [tmp_path / f"{kind}.{name}" for kind in kinds for name in FORMATS]
    starts = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}
    assert all(path.read_bytes().startswith(starts[path.suffix]) for path in paths)
    (effects,) = save_sweep_figures(data, tmp_path, formats=["png"], kinds=["effects"], dpi=40)
    assert effects == tmp_path / "effects.png"


def some_gone(case: Mapping[str, Value]) -> float:
    return [np.inf, FAILED, np.nan, 0.0, 5.0][zlib.crc32(str(case).encode()) % 5]


EVERY = [
    lambda metric, name: sweep({L1: RATES}, metric, name=name, bands=BANDS),
    lambda metric, name: sweep(
        {LONG_KEY: Range(0.1, 9, "log", 60), SEED: SEEDS}, metric, name=name
    ),
    lambda metric, name: sweep({L1: Range(0.0, 1.0)}, metric, "random", 300, name),
    lambda metric, name: sweep({L1: RATES, HEADING: WORDS, SEED: SEEDS}, metric, name=name),
    lambda metric, name: sweep({LONG_KEY: RATES, "b." + LONG_KEY: STEPS}, metric, name=name),
    lambda metric, name: sweep({L1: Range(0.1, 1), L2: Range(0.1, 1)}, metric, "sobol", 50, name),
    lambda metric, name: sweep({L1: RATES, HEADING: MANY_WORDS, SEED: SEEDS}, metric, name=name),
    lambda metric, name: sweep(
        {LONG_KEY: RATES, "b." + LONG_KEY: STEPS, HEADING: WORDS}, metric, name=name
    ),
    lambda metric, name: sweep(
        {f"controller.gains.l{n}": Range(0.1, 9, "log") for n in range(14)},
        metric,
        "random",
        60,
        name,
    ),
    lambda metric, name: sweep({L1: numbers(0.5)}, metric, name=name),
    lambda metric, name: sweep({L1: numbers(0.5, 0.5)}, metric, name=name),
    lambda metric, name: sweep({SEED: SEEDS}, metric, name=name),
]
METRICS = {
    "bowl": bowl,
    "some without": some_gone,
    "all diverged": lambda case: np.inf,
    "all failed": lambda case: FAILED,
    "all never": lambda case: np.nan,
    "all zero": lambda case: 0.0,
}


# A metric that is the same for all cases, if it is a number at all, leaves each kind of picture
# little to show: a sweep of each kind stands for the others.
EACH_KIND = (0, 3, 7)


@pytest.mark.parametrize(
    ("make", "metric"),
    [
        pytest.param(
            make,
            metric,
            id=f"{metric}-{number}",
            marks=() if number in EACH_KIND or not metric.startswith("all") else pytest.mark.slow,
        )
        for metric in METRICS
        for number, make in enumerate(EVERY)
    ],
)
def test_nothing_overlaps_whatever_becomes_of_the_cases(
    make: Callable[..., SweepData], metric: str
) -> None:
    data = make(METRICS[metric], NAME)
    for kind in kinds_for(data):
        assert overlaps(draw_sweep(kind, data)) == [], kind


def three_keys(cases: int) -> SweepData:
    axes = {f"controller.gains.l{n}": Range(0.1, 9, "log") for n in range(3)}
    return sweep(axes, bowl, "random", cases)


@pytest.mark.parametrize("picture_format", FORMATS)
def test_same_data_same_bytes(picture_format: str) -> None:
    data = three_keys(100)
    for kind in kinds_for(data):
        first = render(draw_sweep(kind, data), picture_format, 40)
        with matplotlib.rc_context(USERS_SETTINGS):
            assert render(draw_sweep(kind, data), picture_format, 40) == first


@pytest.mark.parametrize("picture_format", FORMATS)
def test_many_cases_make_no_large_files(picture_format: str) -> None:
    data = three_keys(6000)
    for kind in kinds_for(data):
        assert len(render(draw_sweep(kind, data), picture_format, 40)) < 500_000


def test_large_sweeps_are_drawn_with_few_artists() -> None:
    cases = 200_000
    metric = np.random.default_rng(1).lognormal(size=cases)
    many = Range(0.1, 10, "log", cases)
    for axes, sampling in (
        ({L1: many}, "grid"),
        ({L1: Range(0.1, 10)}, "random"),
        ({L1: Range(0.1, 10), L2: Range(0.1, 10)}, "random"),
        ({L1: Range(0.1, 10), L2: Range(0.1, 10), L3: Range(0, 1)}, "random"),
    ):
        data = sweep(axes, metric, sampling, cases)  # type: ignore[arg-type]
        for kind in kinds_for(data):
            for panel in draw_sweep(kind, data).axes:
                sizes = [len(np.asarray(line.get_xdata())) for line in panel.lines]
                sizes += [len(np.asarray(dots.get_offsets())) for dots in panel.collections]
                assert max(sizes, default=0) <= 5000


def test_drawing_changes_no_global_settings(tmp_path: Path) -> None:
    before = dict(matplotlib.rcParams)
    save_sweep_figures(sweep({L1: RATES}, bowl), tmp_path, formats=["png"], dpi=40)
    assert dict(matplotlib.rcParams) == before


def test_drawing_needs_no_pyplot() -> None:
    program = (
        "import sys, hilc_cli.sweeps.pictures.catalogue; print('matplotlib.pyplot' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (done.stdout.strip(), done.stderr) == ("False", "")
