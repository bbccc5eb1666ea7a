"""The table that ``hilc run`` prints."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from hilc_cli.cli.terminal import two_columns

if TYPE_CHECKING:
    from rich.table import Table

    from hilc_cli.results.summary import Summary

_UNITS = {"_rad_s": "rad/s", "_m_s": "m/s", "_rad": "rad", "_m": "m", "_s": "s", "_percent": "%"}
_STANDARD_ERROR = "_standard_error"


def summary_table(summary: Summary, speed_limit: float | None) -> Table:
    """A run in a few lines.

    Args:
        summary: The run.
        speed_limit: b_w [rad/s]; None for no limit.
    """
    final = summary.final
    limit = "no limit" if speed_limit is None else f"limit {speed_limit:g}"
    rows = [
        ("Position error, maximum", f"{final['max_position_error_m']:.4g} m"),
        (
            "Position error, maximum of the second half",
            f"{final['max_position_error_second_half_m']:.4g} m",
        ),
        ("Position error, mean", f"{final['mean_position_error_m']:.4g} m"),
        ("Position error, RMS", f"{final['rms_position_error_m']:.4g} m"),
        ("Position error at the end", f"{final['final_position_error_m']:.4g} m"),
        ("Heading error, maximum", f"{final['max_abs_error_heading_rad']:.4g} rad"),
        ("Fastest wheel", f"{final['max_wheel_speed_rad_s']:.4g} rad/s ({limit})"),
    ]
    for label, iteration in summary.settled_at.items():
        reached = "not reached" if iteration is None else f"from iteration {iteration}"
        rows.append((f"Maximum error within {label} of the path's size", reached))
    rows += [
        (
            "Largest maximum error on the way",
            f"{summary.peak_max_position_error_m:.4g} m in iteration {summary.peak_iteration}",
        ),
        ("Samples at the speed limit, all iterations", f"{summary.saturated_share:.1%}"),
    ]
    rows += _learned(summary.learning)
    title = (
        f"{summary.name}: {summary.trajectory} ({summary.path_size_m:.4g} m), "
        f"after {summary.iterations} iterations"
    )
    return two_columns(title, rows)


def _learned(figures: Mapping[str, float | None]) -> list[tuple[str, str]]:
    """What the law tells of the last iteration, an estimate with its standard error."""
    rows = []
    for column, figure in figures.items():
        name, unit = _name_and_unit(column)
        if name.endswith(_STANDARD_ERROR):
            continue
        suffix = column.removeprefix(name)
        error = figures.get(f"{name}{_STANDARD_ERROR}{suffix}")
        text = "none" if figure is None else f"{figure:.6g} {unit}".rstrip()
        if error is not None:
            text += f", standard error {error:.2g} {unit}".rstrip()
        rows.append((f"Learned: {name.replace('_', ' ')}", text))
    return rows


def _name_and_unit(column: str) -> tuple[str, str]:
    """Name of a figure, and its unit, which stands at the end of the column's name."""
    for suffix, unit in _UNITS.items():
        if column.endswith(suffix):
            return column.removesuffix(suffix), unit
    return column, ""
