"""The Python interface to reproductions."""

from __future__ import annotations

from pathlib import Path

import pytest

import hilc_cli as hilc_api
from hilc_cli.errors import UsageError


@pytest.fixture(scope="module")
def result() -> hilc_api.Reproduction:
    return hilc_api.reproduce(hilc_api.plan_reproduction(["fig4"], overrides={"iterations": 0}))


def test_each_run_and_each_figure_is_a_step(tmp_path: Path) -> None:
    plan = hilc_api.plan_reproduction(["fig4"], reading="literal", overrides={"iterations": 0})
    steps: list[str] = []
    result = hilc_api.reproduce(plan, on_step=lambda: steps.append("run"))
    result.write(tmp_path / "out", dpi=20, on_step=lambda: steps.append("figure"))
    assert steps == ["run", "run", "figure"]
    assert plan.steps == 3


def test_a_single_iteration_is_drawn_too(result: hilc_api.Reproduction, tmp_path: Path) -> None:
    result.write(tmp_path / "out", dpi=20, formats=["svg", "png", "svg"])
    assert (tmp_path / "out/fig4-derivative.svg").stat().st_size > 0
    rows = (tmp_path / "out/data/fig4a1-literal.csv").read_text().splitlines()
    assert len(rows) == 1 + 2001  # the header and the samples of one iteration


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"formats": ["png", "gif"]}, "unknown picture format 'gif'"),
        ({"dpi": 0}, "dpi must be from 1 to 10000, got 0"),
    ],
)
def test_wrong_options_write_nothing(
    result: hilc_api.Reproduction, tmp_path: Path, options: dict[str, object], message: str
) -> None:
    with pytest.raises(UsageError, match=message):
        result.write(tmp_path / "out", **options)  # type: ignore[arg-type]  # several kinds
    assert list(tmp_path.iterdir()) == []
