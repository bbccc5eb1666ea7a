"""What ``hilc run`` prints, and bounds that the metrics of a run must keep, as it is told them.

First what matters, then a table, then what was probably not meant.
"""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from hilc_cli.errors import UsageError
from hilc_cli.reporting.terminal import two_columns
from hilc_cli.results.learning import quantities, says_more
from hilc_cli.results.metrics import MAX_ERROR, MAX_ERROR_SECOND_HALF, METRICS, stem_and_unit
from hilc_cli.wording import printable, suggestion
from hilc_cli.yaml_input.expressions import PLAIN, ExpressionError, evaluate

if TYPE_CHECKING:
    from rich.console import RenderableType

    from hilc_cli.results.summary import Summary

_FEWEST, _MOST = 4, 6  # significant digits of an estimate


def summary_report(summary: Summary, speed_limit: float | None) -> RenderableType:
    """A run in a few lines.

    Args:
        summary: The run.
        speed_limit: b_w [rad/s]; None for no limit.
    """
    from rich.console import Group
    from rich.text import Text

    size = f"{summary.path_size_m:.4g} m" if summary.path_size_m else "on the spot"
    title = f"{summary.name}: {summary.trajectory} ({size}), after {summary.iterations} iterations"
    return Group(
        Text(printable(title), style="bold"),
        Text(summary.headline),
        two_columns("", summary_rows(summary, speed_limit)),
        *(Text(f"warning: {printable(warning)}") for warning in summary.warnings),
    )


def summary_rows(summary: Summary, speed_limit: float | None) -> list[tuple[str, str]]:
    """Returns names and values of the figures of a run.

    Args:
        summary: The run.
        speed_limit: b_w [rad/s]; None for no limit.
    """
    final = summary.final
    limit = "no limit" if speed_limit is None else f"limit {speed_limit:g}"
    errors = [
        ("Position error, maximum", f"{final[MAX_ERROR]:.4g} m"),
        ("Position error, maximum of the second half", f"{final[MAX_ERROR_SECOND_HALF]:.4g} m"),
    ]
    settled, what = summary.settled_at, "Maximum error"
    if summary.starts_off:
        errors.reverse()
        settled, what = summary.settled_second_half_at, "Maximum error of the second half"
    rows = [
        *errors,
        ("Position error, mean", f"{final['mean_position_error_m']:.4g} m"),
        ("Position error, RMS", f"{final['rms_position_error_m']:.4g} m"),
        ("Position error at the end", f"{final['final_position_error_m']:.4g} m"),
        ("Heading error, maximum", f"{final['max_abs_error_heading_rad']:.4g} rad"),
        ("Fastest wheel", f"{final['max_wheel_speed_rad_s']:.4g} rad/s ({limit})"),
    ]
    for label, iteration in settled.items() if summary.path_size_m else ():
        reached = "not reached" if iteration is None else f"from iteration {iteration}"
        rows.append((f"{what} within {label} of the path's size", reached))
    rows += [
        (
            "Largest maximum error on the way",
            f"{summary.peak_max_position_error_m:.4g} m in iteration {summary.peak_iteration}",
        ),
        ("Samples at the speed limit, all iterations", f"{summary.saturated_share:.1%}"),
    ]
    return rows + learned_rows(summary.learning)


def learned_rows(figures: Mapping[str, float]) -> list[tuple[str, str]]:
    """What the law has learned by the last iteration, estimates with their standard errors."""
    rows, known = [], {column for column, value in figures.items() if not math.isnan(value)}
    for quantity in quantities(figures):
        if not says_more(quantity, known):
            continue
        series, unit = quantity.best, quantity.unit
        value = figures[series.value]
        if series.error is not None:
            text = _estimate(value, figures[series.error], unit)
        elif math.isnan(value):
            continue
        else:
            late = math.isinf(value) and unit == "s"
            text = "not by the end" if late else f"{value:.6g} {unit}".rstrip()
        rows.append((f"Learned: {quantity.name}", text))
    return rows


def _estimate(value: float, error: float, unit: str) -> str:
    """An estimate, with about as many digits as its standard error leaves."""
    if math.isnan(error):
        return f"not measured, taken as {value:.{_FEWEST}g} {unit}".rstrip()
    size = math.floor(math.log10(abs(value))) if value else 0
    sure = size - math.floor(math.log10(error)) + 2 if error else _MOST
    places = max(0, min(max(sure, _FEWEST), _MOST) - 1 - size)
    if error:
        # What is nothing beside its error has no digits of its own.
        places = min(places, max(0, 2 - math.floor(math.log10(error))))
    shown = (f"{number} {unit}".rstrip() for number in (f"{value:.{places}f}", f"{error:.2g}"))
    return ", standard error ".join(shown)


_RELATIONS: Mapping[str, Callable[[float, float], bool]] = {
    "<=": operator.le,
    ">=": operator.ge,
    "<": operator.lt,
    ">": operator.gt,
}
_IN_WORDS = {"le": "<=", "ge": ">=", "lt": "<", "gt": ">"}
"""Relations by the words of the shell's own comparisons."""
_FORM = re.compile(r"\s*(\w+)\s*(<=|>=|<|>|:(?:le|ge|lt|gt):)\s*([^<>=:\s].*)")


@dataclass(frozen=True, slots=True)
class Requirement:
    """A bound on a metric of the last iteration."""

    text: str
    metric: str
    relation: str
    bound: float

    def met(self, metrics: Mapping[str, float]) -> bool:
        """Whether the metrics of an iteration keep the bound; not-a-number keeps none."""
        return _RELATIONS[self.relation](metrics[self.metric], self.bound)

    def hint(self, initial_error: float) -> str:
        """Why it could not be met, if that is because of the initial position error [m]."""
        if self.metric != MAX_ERROR or self.relation not in ("<=", "<") or not initial_error:
            return ""
        if _RELATIONS[self.relation](initial_error, self.bound):
            return ""
        return (
            f"; the initial error alone is {initial_error:.6g} m, which "
            f"{MAX_ERROR_SECOND_HALF} leaves out"
        )


def parse_requirements(texts: Sequence[str], figures: Sequence[str] = ()) -> list[Requirement]:
    """The requirements that a command line states.

    Args:
        texts: As they stand there.
        figures: What the law tells of an iteration: metrics as well.

    Raises:
        UsageError: One has another form, an unknown metric, or a bound that is no number.
    """
    return [_parse(text, (*METRICS, *figures)) for text in texts]


def _parse(text: str, known: Sequence[str]) -> Requirement:
    label = f"--require {text}"
    match = _FORM.fullmatch(text)
    if match is None:
        raise UsageError(
            f"{label}: must read METRIC:le:VALUE, such as max_position_error_m:le:0.01, or in "
            "quotes 'METRIC<=VALUE'; le, lt, ge, gt stand for <=, <, >=, >"
        )
    metric, relation, value = match.groups()
    relation = _IN_WORDS.get(relation.strip(":"), relation)
    if metric not in known:
        raise UsageError(f"{label}: '{metric}' is no metric; {suggestion(metric, known)}")
    try:
        result = evaluate(value)
    except ExpressionError as error:
        problem, _, remedy = str(error).partition("; ")
        remedy = remedy or "give a number such as 0.01"
        raise UsageError(f"{label}: the bound {problem}; {remedy}") from None
    bound = result.number.constant
    if result.unit != PLAIN and result.unit.text != stem_and_unit(metric)[1]:
        raise UsageError(f"{label}: the bound has the wrong unit; give a number such as 0.01")
    if not math.isfinite(bound):
        raise UsageError(f"{label}: the bound must be finite; give a number such as 0.01")
    return Requirement(text, metric, relation, bound)
