"""What experiments must have in common to share vector lanes, and which the batch engine knows."""

from __future__ import annotations

from typing import NamedTuple

from hilc_cli.disturbance.streams import Bounded
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes.noise import NONE, NORMAL, UNIFORM
from hilc_cli.engine.lanes.wheels import parts_of
from hilc_cli.errors import UsageError
from hilc_cli.laws.feedback import FeedbackLaw
from hilc_cli.laws.gain_matrix import GainHeading, LaneParameters
from hilc_cli.laws.pid import PidLaw
from hilc_cli.numba_loading import DISABLED
from hilc_cli.plants.drivetrain import LaneWheels

LaneLaw = LaneParameters | PidLaw | FeedbackLaw
"""What a law may offer to be run in lanes."""


class Kind(NamedTuple):
    """What experiments in the lanes of one pack have in common, beside the reference.

    Attributes:
        law: The class of what their law offers.
        compensation: Whether they run Eq. 21, not Eq. 17.
        derivative: Whether they learn from the derivative of the error as well, by Eq. 17 or 21.
        gain_heading: As in `LaneParameters`.
        lateral: Whether an error aside turns the wheels as well.
        full_matrix: Whether the gain matrix has another form than that of Eq. 45.
        rectifying: Whether PID-type learning acts against the initial error.
        planned: Whether whole passes are filtered between them.
        learn_in_first: As in `Experiment`.
        state: NONE, UNIFORM or NORMAL: the distribution of the state's disturbance.
        output: The distribution of the output's disturbance.
        pose: The distribution of the initial pose's disturbance.
        wheels: What there is of a robot as it is, see `parts_of`; None for the paper's.
        own_reference: Whether each lane has a reference of its own.
    """

    law: type[LaneLaw] = LaneParameters
    compensation: bool = False
    derivative: bool = False
    gain_heading: GainHeading = "measured"
    lateral: bool = False
    full_matrix: bool = False
    rectifying: bool = False
    planned: bool = False
    learn_in_first: bool = False
    state: int = NONE
    output: int = NONE
    pose: int = NONE
    wheels: int | None = None
    own_reference: bool = False

    @classmethod
    def of(cls, experiment: Experiment, own_reference: bool = False) -> Kind:
        """The kind of an experiment, whose lane may have a reference of its own.

        Raises:
            UsageError: It has a law that the batch engine does not know.
        """
        law, disturbance = known_parameters(experiment), experiment.disturbance
        wheels = lane_wheels(experiment)
        kind = cls(
            type(law),
            learn_in_first=experiment.learn_in_first,
            state=_distribution(disturbance.state),
            output=_distribution(disturbance.output),
            pose=_distribution(disturbance.initial_pose),
            wheels=None if wheels is None else parts_of(wheels),
            own_reference=own_reference,
        )
        if isinstance(law, FeedbackLaw):
            return kind
        kind = kind._replace(gain_heading=law.gain_heading, full_matrix=not law.matrix.is_kinematic)
        if isinstance(law, PidLaw):
            planned = law.cutoff is not None or _returns(law, experiment)
            return kind._replace(
                planned=planned, rectifying=law.rectifying is not None and not planned
            )
        lateral = law.lateral != 0
        return kind._replace(
            compensation=law.compensation is not None,
            derivative=law.derivative != 0,
            lateral=lateral,
            full_matrix=lateral or kind.full_matrix,
        )

    @property
    def disturbed(self) -> bool:
        """Whether anything is drawn at each sample."""
        return self.state != NONE or self.output != NONE

    @property
    def drawn(self) -> bool:
        """Whether anything is drawn at all."""
        return self.disturbed or self.pose != NONE


def _returns(law: PidLaw, experiment: Experiment) -> bool:
    """Whether the law goes back to a first input that is not zero."""
    first = experiment.initial_left, experiment.initial_right
    return law.forgetting != 0 and any(wheel.any() for wheel in first)


def knows(experiment: Experiment) -> bool:
    """Whether the batch engine runs here, and knows the experiment's law and plant."""
    moves = lane_wheels(experiment) is not None or lane_gains(experiment) is not None
    return moves and _lane_parameters(experiment) is not None and not DISABLED


def lane_wheels(experiment: Experiment) -> LaneWheels | None:
    """Returns the wheels of the experiment's plant; None if it offers none to be run here."""
    return experiment.plant.lane_wheels(experiment.reference.sample_time)


def lane_gains(experiment: Experiment) -> tuple[float, float] | None:
    """Returns the gains of the experiment's plant; None if it moves in a way not known here."""
    return experiment.plant.lane_gains(experiment.reference.sample_time)


def _lane_parameters(experiment: Experiment) -> LaneLaw | None:
    """Returns what the experiment's law offers to be run here; None if it offers nothing."""
    offer = getattr(experiment.law, "lane_parameters", None)
    return None if offer is None else offer()


def known_parameters(experiment: Experiment) -> LaneLaw:
    """Returns the same of a law that offers something; of another one raises a UsageError."""
    parameters = _lane_parameters(experiment)
    if parameters is None:
        raise UsageError("the batch engine knows the laws hybrid, pid and feedback only")
    return parameters


def _distribution(source: Bounded) -> int:
    if not source.active:
        return NONE
    return UNIFORM if source.distribution == "uniform" else NORMAL
