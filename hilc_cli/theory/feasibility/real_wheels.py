"""What a path asks of the wheels of a robot as it is: with their own sizes, slip and friction."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.plants.imperfect_plant import ImperfectPlant
from hilc_cli.plants.kinematic import feedforward
from hilc_cli.theory.findings import Findings, Rows

_ROUNDING = 1e-9  # relative: a limit that is met exactly is met in spite of rounding


@dataclass(frozen=True, slots=True)
class RealWheels:
    """What the wheels have to be told, so that the robot follows its reference.

    Attributes:
        fastest: Largest speed that either is told [rad/s]: less is left by slip and friction.
        ideal: The same of equal wheels without slip and friction [rad/s].
        speed_limit: b_w [rad/s]; infinity for none.
    """

    fastest: float
    ideal: float
    speed_limit: float

    @property
    def within_limit(self) -> bool:
        """Whether no wheel has to be faster than the limit."""
        return self.fastest <= self.speed_limit * (1 + _ROUNDING)

    @property
    def findings(self) -> Findings:
        """What the motors cannot do."""
        if self.within_limit:
            return Findings()
        return Findings.warning(
            f"with its own wheels, slip and dead zone the robot needs {self.fastest:.4g} rad/s,"
            f" above b_w of {self.speed_limit:g} rad/s: it stays behind there; drive slower"
        )

    @property
    def rows(self) -> Rows:
        """The speed, beside the limit, where it is another one than an ideal robot's."""
        if math.isclose(self.fastest, self.ideal, rel_tol=_ROUNDING):
            return []
        of = f" of {self.speed_limit:g}" if math.isfinite(self.speed_limit) else ""
        return [("Its own wheels", f"{self.fastest:.4g}{of} rad/s with their sizes and losses")]

    @property
    def document(self) -> dict[str, object]:
        """The same as JSON."""
        return {
            "max_wheel_speed_rad_s": self.fastest,
        }


def real_wheels(experiment: Experiment) -> RealWheels | None:
    """Returns what the wheels of a robot as it is need; None of another plant."""
    plant, reference = experiment.plant, experiment.reference
    if not isinstance(plant, ImperfectPlant):
        return None
    drivetrain = plant.drivetrain
    ideal = feedforward(reference, experiment.robot)
    shares = drivetrain.shares(experiment.robot.wheel_radius)
    # What is true of either wheel: beyond slip and size it has to be told what friction takes.
    wheels = np.stack([wheel / share for wheel, share in zip(ideal, shares, strict=True)])
    told = drivetrain.motor.against_friction(wheels)
    fastest = float(np.abs(told).max())
    of_ideal = float(np.abs(ideal).max())
    return RealWheels(fastest, of_ideal, experiment.speed_limit)
