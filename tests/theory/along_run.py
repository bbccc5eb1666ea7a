"""Whether the theorems' condition held along a run, where L and B really stood."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.plants.kinematic import control_matrices
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.trial import Trial
from hilc_cli.theory.linear_law import paper_law
from hilc_cli.theory.matrices import GainParts
from hilc_cli.theory.proof.norms import wheel_map_norm


@dataclass(frozen=True, slots=True, eq=False)
class AlongRun:
    """What Eq. 23 demands of every iteration, measured; a number for each learning update.

    Attributes:
        rho: Largest ||I - L1 d_k B|| over the samples, L1 and B where they stood.
        heading_mismatch: Largest angle between their headings [rad].
    """

    rho: Floats
    heading_mismatch: Floats


def along_run(experiment: Experiment, trials: Iterable[Trial]) -> AlongRun:
    """The condition along a run.

    Args:
        experiment: What was run.
        trials: All iterations in order; they are gone through once, and not kept.

    Source:
        Qiao et al. 2021, Eqs. 23 and 30: L1 of iteration i + 1 with B of iteration i.
    """
    law, reference = paper_law(experiment), experiment.reference
    gain, parts = law.l1 * reference.sample_time, GainParts.of(law.matrix)
    rhos: list[float] = []
    mismatches: list[float] = []
    before: Trial | None = None
    for trial in trials:
        if before is not None:
            if law.gain_heading == "reference":
                used = reference.heading
            else:
                source = trial if law.gain_heading == "measured" else before
                alpha = experiment.disturbance.of_output(source.iteration, len(source.heading))
                used = source.heading if alpha is None else source.heading + alpha[:, 2]
            gain_heading, heading = used[:-1], before.heading[:-1]
            product = parts.at(gain_heading) @ control_matrices(experiment.robot, heading)
            norms = wheel_map_norm(np.eye(2) - gain * product, "euclidean")
            rhos.append(float(norms.max()))
            mismatches.append(float(np.abs(gain_heading - heading).max()))
        before = trial
    return AlongRun(np.array(rhos), np.array(mismatches))
