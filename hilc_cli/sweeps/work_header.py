"""What the folder of a sweep under way says of the sweep."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from hilc_cli.results.reading import Document, Length, Name
from hilc_cli.scenario.sweep_section import Robust
from hilc_cli.sweeps.happenings import CrossedCases, cases_of
from hilc_cli.sweeps.sweep_folder import Axes, CaseMetric, Over, may_happen
from hilc_cli.variation import Cases
from hilc_cli.yaml_input.quantities import MOST_CASES

CaseNumber = Annotated[int, Field(ge=0, le=MOST_CASES)]


class Header(Document):
    """What the folder of a sweep under way says of it: the manifest."""

    kind: str
    name: Name
    checksum: str
    first: CaseNumber
    last: CaseNumber
    shard: str | None
    iterations: Annotated[int, Field(ge=0, le=10_000_000)]
    bands: bool
    axes: Axes
    sample: Literal["grid", "random", "sobol"]
    cases: CaseNumber
    seed: Annotated[int, Field(ge=0, lt=2**64)]
    tolerance_m: Length | None
    metric: CaseMetric
    path_size_m: Length | None = None
    minimise: CaseMetric | None
    drawn: CaseNumber
    over: Over = ()
    robust: Robust = "worst"
    happenings: CaseNumber | None = None

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if not self.first < self.last <= self.cases:
            raise ValueError("its cases are none of the sweep")
        if not may_happen(self.over, self.axes):
            raise ValueError("its keys that happen are none of the axes")
        return self

    @property
    def of_all(self) -> Cases | CrossedCases:
        """All cases of the sweep.

        Raises:
            ValueError: The axes make others.
        """
        cases = cases_of(
            *(self.axes, self.sample, self.drawn, self.seed, self.over, self.happenings)
        )
        if cases.count != self.cases:
            raise ValueError("its axes do not fit")
        return cases
