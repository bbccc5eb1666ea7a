"""What theory says of an experiment's law, whichever law it is."""

from __future__ import annotations

from hilc_cli.engine.experiment import Experiment
from hilc_cli.theory.findings import ExpectedError, Findings, Rows
from hilc_cli.theory.learning.forecast import Forecast
from hilc_cli.theory.learning.outcome import Outcome
from hilc_cli.theory.linear_law import LinearLaw, theory_class
from hilc_cli.theory.noise import WheelNoise


class LawTheory:
    """The theory of a law; as it stands here that of a law of which nothing is known.

    A law names its own, a subclass of this, as ``theory = "package.module:Class"``. Whatever takes
    time is computed when it is asked for.

    Attributes:
        title: What a report asks of the law.
        tells_the_way_in: Whether `way_in` says all about a start off the trajectory.
        linear: The law as the linear theory sees it; None if it does not speak of it.
    """

    title = "Does learning converge?"
    tells_the_way_in = False
    linear: LinearLaw | None = None

    def __init__(self, experiment: Experiment) -> None:
        self.experiment = experiment

    @property
    def is_known(self) -> bool:
        """Whether anything is known of the law before it is run."""
        return type(self) is not LawTheory

    @property
    def forecast(self) -> Forecast | None:
        """What the linear theory expects learning to do; None if it does not speak of the law."""
        return None

    @property
    def outcome(self) -> Outcome | None:
        """What comes of learning; None if that is not known."""
        return None if self.forecast is None else self.forecast.outcome

    @property
    def way_in(self) -> Findings:
        """What the law's way from a start off the trajectory means, where it is known."""
        return Findings()

    @property
    def expected(self) -> ExpectedError | None:
        """How large the error of the last iteration will be; None if that is not known."""
        return None

    @property
    def wheels(self) -> WheelNoise | None:
        """What disturbances make of the wheel speeds; None if that is not known, or nothing."""
        return None

    @property
    def findings(self) -> Findings:
        """What all this means for the experiment."""
        return Findings()

    @property
    def rows(self) -> Rows:
        """What a report tells of it."""
        return []

    @property
    def brief(self) -> Rows | None:
        """What a report of one screen tells of it; None for all of its rows."""
        return None

    @property
    def document(self) -> dict[str, object]:
        """What is known of it as JSON."""
        return {}


def law_theory(experiment: Experiment) -> LawTheory:
    """Returns what is known of the experiment's law on its plant."""
    theory: type[LawTheory] = theory_class(experiment) or LawTheory
    return theory(experiment)
