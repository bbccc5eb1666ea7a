"""Bounds that the metrics of a run must keep, as a command line states them."""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from hilc_cli.errors import UsageError
from hilc_cli.results.metrics import MAX_ERROR, MAX_ERROR_SECOND_HALF, METRICS, stem_and_unit
from hilc_cli.wording import suggestion
from hilc_cli.yaml_input.expressions import PLAIN, ExpressionError, evaluate

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
