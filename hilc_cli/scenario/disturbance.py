"""What a scenario says of the disturbances."""

from __future__ import annotations

from typing import Self

from pydantic import Field, model_validator

from hilc_cli.disturbance.streams import Bounded, Distribution, Disturbance, Triple
from hilc_cli.yaml_input.model import Flag, Model, wrong_at
from hilc_cli.yaml_input.quantities import AngleBound, LengthBound, Seed

Bounds = tuple[LengthBound, LengthBound, AngleBound]


class BoundedSpec(Model):
    """A random pose offset that never exceeds its bound."""

    bound: Bounds = Field((0.0, 0.0, 0.0), description="of x [m], y [m] and heading [rad]")
    distribution: Distribution = "uniform"
    standard_deviation: Bounds | None = Field(
        None,
        description="of truncated-normal before it is cut off at the bound; default: bound / 3",
    )
    repeat: Flag = Field(False, description="the same numbers in every iteration")

    @model_validator(mode="after")
    def _deviation_fits(self) -> Self:
        if self.standard_deviation is None:
            return self
        if self.distribution == "uniform":
            raise wrong_at(
                ("standard_deviation",),
                "has no meaning for a uniform distribution",
                "remove it or set 'distribution: truncated-normal'",
            )
        for index, (deviation, bound) in enumerate(
            zip(self.standard_deviation, self.bound, strict=True)
        ):
            if bound > 0 and deviation == 0:
                raise wrong_at(
                    ("standard_deviation", index),
                    "must be above 0",
                    "give a number above 0 or set this bound to 0",
                )
        return self

    def bounded(self) -> Bounded:
        """The offset for the engines."""
        x, y, heading = self.bound
        deviation: Triple = self.standard_deviation or (x / 3, y / 3, heading / 3)
        return Bounded(self.bound, self.distribution, deviation, self.repeat)


class DisturbanceSpec(Model):
    """Disturbances of the state (beta), the measured output (alpha) and the initial pose."""

    seed: Seed = Field(0, description="the same seed gives the same numbers everywhere")
    state: BoundedSpec = Field(BoundedSpec(), description="beta of Eq. 11, added at every step")
    output: BoundedSpec = Field(
        BoundedSpec(), description="alpha of Eq. 11: what the controller sees, not what is"
    )
    initial_pose: BoundedSpec = Field(
        BoundedSpec(), description="added to the initial pose of each iteration"
    )

    @property
    def active(self) -> bool:
        """Whether anything is disturbed."""
        sources = (self.state, self.output, self.initial_pose)
        return any(source.bounded().active for source in sources)

    def disturbance(self) -> Disturbance:
        """The disturbances for the engines."""
        return Disturbance(
            self.seed, self.state.bounded(), self.output.bounded(), self.initial_pose.bounded()
        )
