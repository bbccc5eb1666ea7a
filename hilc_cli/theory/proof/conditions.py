"""The conditions of the paper's two theorems, along the reference."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.plants.kinematic import control_matrices
from hilc_cli.theory.linear_law import paper_law
from hilc_cli.theory.matrices import GainParts
from hilc_cli.theory.proof.norms import WheelNorm, wheel_map_norm

_EQUAL = 1e-12  # relative; norms that differ by less count as the same


@dataclass(frozen=True, slots=True)
class Contraction:
    """The number that a theorem wants below 1.

    Attributes:
        rho: The largest norm along the reference.
        sample: The first sample at which it is attained.
    """

    rho: float
    sample: int

    @property
    def holds(self) -> bool:
        """Whether it is below 1."""
        return self.rho < 1


@dataclass(frozen=True, slots=True)
class Conditions:
    """rho of both theorems, as they are printed and for the system that is simulated.

    The print has B of Eq. 9, the plant of Eq. 8 moves by d_k B in a sample. The proof of Theorem 1,
    Eq. 30, needs the condition of Theorem 2: L2 and L3 do not learn.

    Attributes:
        theorem: Which of the two speaks of this experiment's law: 1 of Eq. 17, 2 of Eq. 21.
        theorem_1_printed: max ||I - (L1 + L2 + L3) B||, Eq. 19.
        theorem_1_simulated: max ||I - (L1 + L2 + L3) d_k B||.
        theorem_2_printed: max ||I - L1 B||, Eq. 23.
        theorem_2_simulated: max ||I - L1 d_k B||.
        starts_on_reference: Whether y_i(0) = y_d(0), as both theorems want, in every iteration.
    """

    theorem: Literal[1, 2]
    theorem_1_printed: Contraction
    theorem_1_simulated: Contraction
    theorem_2_printed: Contraction
    theorem_2_simulated: Contraction
    starts_on_reference: bool

    @property
    def printed(self) -> Contraction:
        """The printed condition of the theorem that speaks of this law."""
        return self.theorem_1_printed if self.theorem == 1 else self.theorem_2_printed

    @property
    def simulated(self) -> Contraction:
        """The same for the system that is simulated."""
        return self.theorem_1_simulated if self.theorem == 1 else self.theorem_2_simulated


def conditions(experiment: Experiment) -> Conditions:
    """Returns the conditions of Theorems 1 and 2.

    B is that of the true robot, L that of the law, which knows the model; both at the heading of
    the reference.

    Raises:
        UsageError: The law is not the hybrid law.

    Source:
        Qiao et al. 2021, Eqs. 19 and 23.
    """
    law, reference = paper_law(experiment), experiment.reference
    all_gains = law.l1 + law.l2 + law.l3
    start = (reference.x[0], reference.y[0], reference.heading[0])
    disturbance = experiment.disturbance
    return Conditions(
        theorem=2 if law.compensation else 1,
        theorem_1_printed=contraction(experiment, all_gains),
        theorem_1_simulated=contraction(experiment, all_gains * reference.sample_time),
        theorem_2_printed=contraction(experiment, law.l1),
        theorem_2_simulated=contraction(experiment, law.l1 * reference.sample_time),
        starts_on_reference=experiment.initial_pose == start
        and not disturbance.initial_pose.active
        and not disturbance.output.active,
    )


def contraction(
    experiment: Experiment, gain: float, wheels: WheelNorm = "euclidean"
) -> Contraction:
    """Returns max_k ||I - gain L(q_d(k)) B(q_d(k))||, with the sample at which it is attained.

    Args:
        experiment: The experiment.
        gain: Scalar before the product, with the sample time or without.
        wheels: Norm of wheel speeds.
    """
    headings = experiment.reference.heading[:-1]
    control = control_matrices(experiment.robot, headings)  # Eq. 9
    product = GainParts.of(paper_law(experiment).matrix).at(headings) @ control
    norms = wheel_map_norm(np.eye(2) - gain * product, wheels)
    largest = float(norms.max())
    return Contraction(largest, int(np.argmax(norms >= largest * (1 - _EQUAL))))
