"""How fast learning takes away what changes quickly along the trajectory, or builds it up."""

from __future__ import annotations

import numpy as np

from hilc_cli.analysis.lifted import LiftedIteration


def short_wave_growth(lifted: LiftedIteration) -> float | None:
    """Growth per iteration of waves in the error that are short beside what the gains span.

    Away from the ends of the trajectory an iteration multiplies a wave of theta rad per sample by
    (z - 1 - g d l1 z) / (z - 1 + g d (l2 + l3 / z)), with z = exp(i theta) and g an eigenvalue of
    G_k B_k. For theta well above g d times the gains its absolute value is
    1 - g d / 2 (l1 - l2 - l3 - 2 l3 cos theta) to first order in d. Learning alone thus takes away
    half of what the eigenvalues 1 - g d l1 of the lifted operator promise, and only in proportion
    to the sample time; feedback in the iteration takes from it. With l2 + 3 l3 > l1 some waves grow
    in each iteration, though the spectral radius is below 1: in the end they spoil what was
    learned before.

    Args:
        lifted: The linearised experiment.

    Returns:
        The growth of the most stubborn waves, theta small, as a share per iteration; negative if
        they decay. None where this says nothing, since the law does not correct two motions of the
        wheels independently and each in the right sense at every sample.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        blocks = lifted.gains @ lifted.plant.inputs
    if not np.isfinite(blocks).all():
        return None
    eigenvalues = np.linalg.eigvals(blocks)  # g d
    if np.iscomplexobj(eigenvalues) or (eigenvalues <= 0).any():
        return None
    excess = lifted.l2 + 3 * lifted.l3 - lifted.l1
    return float((eigenvalues / 2 * excess).max())
