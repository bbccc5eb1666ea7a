"""What experiments must have in common to share vector lanes, and which the batch engine knows."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

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
    def of(cls, member: Member, own_reference: bool = False) -> Kind:
        """The kind of an experiment, whose lane may have a reference of its own."""
        (kind,) = kinds_of([member], own_reference)
        return kind

    @property
    def disturbed(self) -> bool:
        """Whether anything is drawn at each sample."""
        return self.state != NONE or self.output != NONE

    @property
    def drawn(self) -> bool:
        """Whether anything is drawn at all."""
        return self.disturbed or self.pose != NONE


def kinds_of(members: Sequence[Member], own_references: bool = False) -> Iterator[Kind]:
    """The kinds of experiments; what does not follow from the law is asked once of each part."""
    known: dict[tuple[int, int, bool], tuple[Any, ...]] = {}
    for member in members:
        experiment = member.experiment
        part = id(experiment.disturbance), id(member.wheels), experiment.learn_in_first
        if part not in known:
            known[part] = (*_all_but_law(member), own_references)
        yield Kind(*_of_law(member.law, experiment), *known[part])


def joined(kinds: Sequence[Kind]) -> list[Kind]:
    """For each kind one that can run it, few different ones in all.

    Those that differ in terms of their laws alone get the terms of all, which are zero where a law
    has none; those that draw nothing become the first that does. That takes longer than machine
    code of their own, but there is less of it to compile.
    """
    widest: dict[Kind, Kind] = {}
    for kind in kinds:
        bare = _bare(kind)
        widest[bare] = _wider(widest.get(bare, bare), kind)
    wide = [_wider(kind, widest[_bare(kind)]) for kind in kinds]
    drawn = {_undisturbed(kind): kind for kind in reversed(wide) if kind.drawn}
    return [drawn.get(kind, kind) for kind in wide]


def _wider(kind: Kind, other: Kind) -> Kind:
    """The first with the terms of both."""
    return kind._replace(
        derivative=kind.derivative or other.derivative,
        lateral=kind.lateral or other.lateral,
        full_matrix=kind.full_matrix or other.full_matrix,
    )


def _bare(kind: Kind) -> Kind:
    """What kinds have in common that can be joined."""
    return _undisturbed(kind)._replace(derivative=False, lateral=False, full_matrix=False)


def _undisturbed(kind: Kind) -> Kind:
    """The kind if nothing were drawn."""
    return kind._replace(state=NONE, output=NONE, pose=NONE)


def _of_law(law: LaneLaw, experiment: Experiment) -> tuple[Any, ...]:
    """The kind up to `Kind.planned`."""
    if isinstance(law, FeedbackLaw):
        return FeedbackLaw, False, False, "measured", False, False, False, False
    full_matrix = not law.matrix.is_kinematic
    if isinstance(law, PidLaw):
        planned = law.cutoff is not None or _returns(law, experiment)
        rectifying = law.rectifying is not None and not planned
        return PidLaw, False, False, law.gain_heading, False, full_matrix, rectifying, planned
    lateral = law.lateral != 0
    return (
        *(LaneParameters, law.compensation is not None, law.derivative != 0),
        *(law.gain_heading, lateral, full_matrix or lateral, False, False),
    )


def _all_but_law(member: Member) -> tuple[Any, ...]:
    """The kind behind `Kind.planned`, up to `Kind.wheels`."""
    experiment, wheels = member.experiment, member.wheels
    disturbance = experiment.disturbance
    return (
        experiment.learn_in_first,
        _distribution(disturbance.state),
        _distribution(disturbance.output),
        _distribution(disturbance.initial_pose),
        None if wheels is None else parts_of(wheels),
    )


def _returns(law: PidLaw, experiment: Experiment) -> bool:
    """Whether the law goes back to a first input that is not zero."""
    first = experiment.initial_left, experiment.initial_right
    return law.forgetting != 0 and any(wheel.any() for wheel in first)


class Member(NamedTuple):
    """An experiment that can be run in lanes, with what it offers for that.

    Attributes:
        experiment: The experiment.
        law: What its law offers.
        wheels: The wheels of its plant; None if it offers none, but gains.
        gains: The gains of its plant; of no meaning beside wheels.
    """

    experiment: Experiment
    law: LaneLaw
    wheels: LaneWheels | None
    gains: tuple[float, float]


def offers_of(experiments: Sequence[Experiment]) -> Iterator[Member | None]:
    """Experiments with what they offer to be run here; None where law or plant offers nothing.

    What a plant offers is asked once.
    """
    known: dict[tuple[int, float], tuple[LaneWheels | None, tuple[float, float] | None]] = {}
    for experiment in experiments:
        law, plant = getattr(experiment.law, "lane_parameters", None), experiment.plant
        sample_time = experiment.reference.sample_time
        part = id(plant), sample_time
        if part not in known:
            wheels = plant.lane_wheels(sample_time)
            known[part] = wheels, None if wheels is not None else plant.lane_gains(sample_time)
        wheels, gains = known[part]
        if law is None or (wheels is None and gains is None):
            yield None
        else:
            yield Member(experiment, law(), wheels, gains or _NO_GAINS)


def offered(experiment: Experiment) -> Member | None:
    """The same of one experiment."""
    return next(offers_of([experiment]))


def member(experiment: Experiment) -> Member:
    """The same of an experiment that offers something.

    Raises:
        UsageError: The batch engine does not know its law or its plant.
    """
    found = offered(experiment)
    if found is None:
        if not hasattr(experiment.law, "lane_parameters"):
            raise UsageError("the batch engine knows the laws hybrid, pid and feedback only")
        raise UsageError("the batch engine does not know the plant")
    return found


def knows(experiment: Experiment) -> bool:
    """Whether the batch engine runs here, and knows the experiment's law and plant."""
    return not DISABLED and offered(experiment) is not None


_NO_GAINS = (0.0, 0.0)


def _distribution(source: Bounded) -> int:
    if not source.active:
        return NONE
    return UNIFORM if source.distribution == "uniform" else NORMAL
