"""The table that ``hilc run`` prints."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hilc_cli.cli.terminal import two_columns

if TYPE_CHECKING:
    from rich.table import Table

    from hilc_cli.results.summary import Summary


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
    rows += [
        (f"Learned: {name}", "none" if figure is None else f"{figure:.6g}")
        for name, figure in summary.learning.items()
    ]
    title = (
        f"{summary.name}: {summary.trajectory} ({summary.path_size_m:.4g} m), "
        f"after {summary.iterations} iterations"
    )
    return two_columns(title, rows)
