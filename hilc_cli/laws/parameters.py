"""What the parameters of every law have in common, whatever the law."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, get_args

from pydantic import Field

from hilc_cli.disturbance.streams import Triple
from hilc_cli.laws.arriving import ArrivingLaw
from hilc_cli.laws.law import Law
from hilc_cli.plants.drivetrain import Drivetrain
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.sampled import Reference
from hilc_cli.yaml_input.model import Located, Model
from hilc_cli.yaml_input.quantities import PositiveWheelSpeed

DEFAULT_LAW = "hybrid"
DEFAULT_H = 200  # samples, the paper's choice in situation 3

SpeedLimit = Annotated[
    PositiveWheelSpeed | None,
    Field(description="speed limit of the wheels [rad/s]; null for none"),
]
"""The type of the field ``b_w`` that every law has."""

SLOWEST = 1.0  # [s]; no wheels are told less often what to do


@dataclass(frozen=True, eq=False)
class Setting:
    """What a law may depend on beside its own parameters.

    Attributes:
        reference: The trajectory.
        model: The platform as the controller believes it to be; its wheel radius is the mean.
        initial_error: Start of the reference less the initial pose [m, m, rad].
        initial_bound: Bound of the initial pose's disturbance, likewise.
        lead: Share of a sample's turn after which its way is gone: 0 as Eq. 8 has it, 0.5 on an
            arc between two samples.
        drivetrain: Wheels, motors and tyres as the controller believes them to be; None where
            equal wheels do at once what they are told and never slip.
    """

    reference: Reference
    model: Robot
    initial_error: Triple
    initial_bound: Triple
    lead: float = 0.0
    drivetrain: Drivetrain | None = None

    def has_initial_error(self, tolerance: float) -> bool:
        """Whether a run starts off the reference, so that a law may meet that.

        Decided once for a run, from what is known before it: noise in a measured output never
        switches the law.

        Args:
            tolerance: Components up to this count as no error [m and rad].

        Source:
            Qiao et al. 2021, Fig. 2.
        """
        return self._largest_initial_error > tolerance

    @cached_property
    def _largest_initial_error(self) -> float:
        """The largest component of what a run starts off by, or of its bound."""
        return max(*map(abs, self.initial_error), *self.initial_bound)


class Controller(Model):
    """A law by its name, with the law's own parameters.

    Each law has a model of its own. Its field ``law`` says what the scenario calls it; of hilc's
    own laws that has one value. A field ``b_w`` is the speed limit of the wheels [rad/s].
    """

    law: str
    if TYPE_CHECKING:  # each law says itself behind which of its keys it stands
        b_w: float | None

    learns: ClassVar[bool] = True
    """Whether an iteration depends on those before it."""

    tied_to_trajectory: ClassVar[tuple[str, ...]] = ()
    """Keys whose values must fit the trajectory, and fit any if there is none."""

    @classmethod
    def chosen_by(cls, data: object = None) -> tuple[str, str] | None:
        """Returns ``law`` and the name of this law, which of laws from elsewhere data tells."""
        names = get_args(cls.model_fields["law"].annotation)
        name = names[0] if names else law_named(data) if isinstance(data, Mapping) else None
        return None if name is None else ("law", str(name))

    @classmethod
    def meant_by(cls, data: object) -> type[Controller] | None:
        """Returns this model if data names its law."""
        meant = isinstance(data, Mapping) and cls.chosen_by() == ("law", law_named(data))
        return cls if meant else None

    @classmethod
    def relations(
        cls, data: Mapping[str, Any], reference: Reference | None, model: Robot | None
    ) -> list[Located]:
        """What does not fit the rest of the scenario.

        Args:
            data: The parameters, not yet validated or valid.
            reference: The trajectory, if that is valid by itself.
            model: The platform as the controller believes it to be, if that is valid by itself.
        """
        return []

    @abstractmethod
    def law_for(self, setting: Setting) -> Law:
        """The law by itself.

        Raises:
            ValueError: A number that follows from the parameters is not finite.
        """

    @property
    def in_lanes(self) -> bool:
        """Whether the batch engine knows the law."""
        return False

    @property
    def knows_drivetrains(self) -> bool:
        """Whether the law makes use of `Setting.drivetrain` by itself."""
        return False

    def learning_law(self, setting: Setting) -> Law:
        """The law with what else the parameters put around it.

        Raises:
            ValueError: As for `law_for`.
        """
        return self.law_for(setting)

    def law_on(self, setting: Setting) -> Law:
        """The law for the engines, behind the wheels, motors and tyres that are believed in.

        Raises:
            ValueError: As for `law_for`.
        """
        law = self.learning_law(setting)
        if setting.drivetrain is None or self.knows_drivetrains:
            return law
        return ArrivingLaw(law, setting.model, setting.drivetrain, setting.lead)

    @property
    def called(self) -> str:
        """The law as messages name it, with a choice that makes another law of it."""
        return f"law {self.law}"

    @abstractmethod
    def in_words(self, setting: Setting) -> str:
        """The law and its gains, in one line."""

    def in_short(self, setting: Setting) -> str:
        """Returns the law and what matters most of its gains, for a title."""
        return self.in_words(setting)

    def misfits_on(self, reference: Reference) -> list[Located]:
        """What does not fit a trajectory."""
        return []

    def compensates(self, setting: Setting) -> bool:
        """Whether the run compensates an initial error by Eq. 21."""
        return False

    def figures(self) -> tuple[str, ...]:
        """Columns of ``learning.csv`` that the law fills; most laws have nothing to tell."""
        return ()

    def yardsticks(self, setting: Setting) -> dict[str, dict[str, float]]:
        """Values of the law's own to hold some of them against, each with a name."""
        return {}

    def resolved(self, reference: Reference) -> dict[str, Any]:
        """The parameters as plain data with every default filled in."""
        return self.model_dump(mode="json")

    def warnings(self, setting: Setting) -> list[str]:
        """What is legal but probably not meant."""
        return []

    def warnings_after(self, figures: Mapping[str, float]) -> list[str]:
        """What the figures of the last iteration warn of."""
        return []


def law_named(data: Mapping[str, Any]) -> object:
    """What ``law:`` says in parameters that may not be valid."""
    law = data.get("law")
    return DEFAULT_LAW if law is None else law


def default_length(h: int | None, reference: Reference) -> int:
    """A number of samples ``h``; what it is if it is left out."""
    return min(DEFAULT_H, reference.samples) if h is None else h


def length_misfits(h: int | None, reference: Reference | None) -> list[Located]:
    """What is wrong with a number of samples ``h`` on a trajectory; either may be unknown."""
    if reference is None or h is None or h <= reference.samples:
        return []
    problem = f"must be at most the trajectory's {reference.samples} samples"
    remedy = f"give a whole number from 1 to {reference.samples}"
    if reference.sample_time > SLOWEST:
        remedy += f", or is trajectory.sample_time of {reference.sample_time:g} s in ms?"
    return [(("h",), problem, remedy)]
