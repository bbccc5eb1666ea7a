"""What a scenario says of its sweep: which keys are varied, and how cases are made of them."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field
from pydantic.types import StringConstraints

from hilc_cli.results.metrics import CASE_METRICS, ITERATIONS_TO_TOLERANCE
from hilc_cli.scenario.axis import AxisSpec, read_axis
from hilc_cli.variation.axes import Choices
from hilc_cli.variation.cases import Sampling
from hilc_cli.yaml_input.model import Flag, Located, Model
from hilc_cli.yaml_input.quantities import CaseCount, PositiveLength, Seed, such_as
from hilc_cli.yaml_input.tree import LONGEST_KEY

MOST_KEYS = 100

Key = Annotated[str, StringConstraints(pattern=r"^[^.\s=]+(\.[^.\s=]+)*$", max_length=LONGEST_KEY)]


class SweepSpec(Model):
    """Many runs of one scenario."""

    vary: dict[Key, AxisSpec] = Field(
        {}, max_length=MOST_KEYS, description="values by dotted key, such as controller.gains.l1"
    )
    sample: Sampling = Field(
        "grid", description="grid: every combination; random, sobol: points drawn from the ranges"
    )
    minimise: Literal[CASE_METRICS] | None = Field(  # type: ignore[valid-type]
        None, description="search the ranges for the case in which this metric is smallest"
    )
    cases: CaseCount | None = Field(None, description="number of points to draw, or to search")
    seed: Seed = Field(0, description="of the drawing, or of the search")
    tolerance: Annotated[float, such_as(PositiveLength, "0.05 or 5 cm")] | None = Field(
        None, description="maximum error [m] for iterations_to_tolerance"
    )
    bands: Flag = Field(False, description="write quantiles of the error over the cases")
    metric: Literal[CASE_METRICS] = Field(  # type: ignore[valid-type]
        "max_position_error_m", description="what pictures show and the best case is best in"
    )


class CompleteSweepSpec(SweepSpec):
    """A sweep as it is to run: what one part of it needs of another is there.

    What a scenario leaves out may still be given on the command line. What is minimised is what
    the cases are ranked by.
    """

    @classmethod
    def misfits(cls, data: dict[str, Any]) -> list[Located]:
        """What does not fit together, whatever else is wrong."""
        found = super().misfits(data)
        found += cls._of_sampling(data) if data.get("minimise") is None else cls._of_search(data)
        for key in ("metric", "minimise"):
            if data.get(key) == ITERATIONS_TO_TOLERANCE and data.get("tolerance") is None:
                remedy = "give it too, such as 'tolerance: 5 cm' or --tolerance '5 cm'"
                found.append(((key,), "needs a tolerance", remedy))
        return found

    @classmethod
    def _of_sampling(cls, data: dict[str, Any]) -> list[Located]:
        found: list[Located] = []
        sample = data.get("sample", "grid") or "grid"
        if sample == "grid":
            if data.get("cases") is not None:
                remedy = "remove it, or set 'sample: random' or 'sample: sobol'"
                found.append((("cases",), "has no meaning for a grid", remedy))
            vary = data.get("vary")
            for key, value in vary.items() if isinstance(vary, dict) else ():
                if _has_no_count(value):
                    remedy = "add it, such as 0.1:10:20, or draw from the range with 'sample'"
                    found.append(
                        (("vary", str(key)), "is a range without a number of values", remedy)
                    )
        elif sample in ("random", "sobol") and data.get("cases") is None:
            remedy = "give it too, such as 'cases: 1000' or --cases 1000"
            found.append((("sample",), "needs the number of cases to draw", remedy))
        return found

    @classmethod
    def _of_search(cls, data: dict[str, Any]) -> list[Located]:
        found: list[Located] = []
        if data.get("cases") is None:
            remedy = "give it too, such as 'cases: 200' or --cases 200"
            found.append((("minimise",), "needs the number of cases to try", remedy))
        if data.get("sample") is not None:
            remedy = "remove it, or 'minimise'"
            found.append((("sample",), "has no meaning for a search", remedy))
        if data.get("metric") not in (None, data["minimise"]):
            remedy = "remove it: cases are ranked by what is minimised"
            found.append((("metric",), "has no meaning for a search", remedy))
        return found


def _has_no_count(value: object) -> bool:
    try:
        axis = read_axis(value)
    except ValueError:
        return False
    return not isinstance(axis, Choices) and axis.count is None
