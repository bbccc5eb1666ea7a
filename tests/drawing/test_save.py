from __future__ import annotations

import time
from io import BytesIO
from itertools import product
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from PIL import Image

from hilc_cli.drawing.save import FORMATS, encode_png, render, save_figure
from hilc_cli.errors import UsageError
from hilc_cli.results.picture_kinds import RUN_PICTURES
from hilc_cli.runs.pictures.catalogue import draw
from tests.made_up_runs import USERS_SETTINGS, MakeRun


# Fonts take long to put into a file: there the sheet stands for the four kinds that are on it.
@pytest.mark.parametrize(
    ("kind", "picture_format"),
    [*((kind, "png") for kind in RUN_PICTURES), *product(("summary",), ("svg", "pdf"))],
)
def test_same_data_same_bytes(make_run: MakeRun, kind: str, picture_format: str) -> None:
    first = render(draw(kind, [make_run(saturated=3)]), picture_format, 50)
    if picture_format == "pdf":
        time.sleep(1.1)  # a date would differ by now
    with matplotlib.rc_context(USERS_SETTINGS):
        second = render(draw(kind, [make_run(saturated=3)]), picture_format, 50)
        assert matplotlib.rcParams["lines.linewidth"] == 9

    assert first == second


@pytest.mark.parametrize("picture_format", FORMATS)
def test_a_figure_can_be_saved_again(make_run: MakeRun, picture_format: str) -> None:
    figure = draw("summary", [make_run()])
    first = render(figure, picture_format, 50)
    before = figure.dpi

    assert render(figure, picture_format, 50) == first
    assert figure.dpi == before


def test_no_date_and_no_version_in_the_file(make_run: MakeRun) -> None:
    figure = draw("error", [make_run()])

    assert b"CreationDate" not in render(figure, "pdf")
    assert b"dc:date" not in render(figure, "svg")
    assert b"matplotlib" not in render(figure, "png").lower()


def test_path_gives_the_format(make_run: MakeRun, tmp_path: Path) -> None:
    figure = draw("error", [make_run()])
    save_figure(figure, tmp_path / "a.png", 100)

    with Image.open(tmp_path / "a.png") as image:
        width, height = figure.get_size_inches()
        assert image.size == pytest.approx((100 * width, 100 * height), abs=1)
        assert image.info["dpi"] == pytest.approx((100, 100), rel=1e-3)
    with pytest.raises(UsageError, match="unknown picture format 'jpg'"):
        save_figure(figure, tmp_path / "a.jpg")


def test_png_reads_back_as_it_was() -> None:
    pixels = np.random.default_rng(1).integers(0, 256, (7, 5, 3), dtype=np.uint8)

    with Image.open(BytesIO(encode_png(pixels, 150))) as image:
        np.testing.assert_array_equal(np.asarray(image), pixels)
