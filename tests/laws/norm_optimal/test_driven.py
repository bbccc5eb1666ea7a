"""A pass by all its readings, against its parts."""

from __future__ import annotations

import numpy as np
import pytest

from hilc_cli.laws.norm_optimal.driven import Driven, smooth_passes
from hilc_cli.laws.norm_optimal.motion_filter import Noise, run_filter, smoothed_poses
from hilc_cli.laws.norm_optimal.motor import Motor, body_steps, moved, steps_of

N, STEP = 40, 0.05
MOTOR = Motor(0.05, 0.052, -0.12, 0.065, 0.08, 0.4)
NOISE = Noise(1e-3**2, 1e-3**2, 2e-3**2, 5e-3**2, 0.01**2)
RANDOM = np.random.default_rng(1)


@pytest.mark.parametrize("lead", [0.0, 0.5])
def test_pass_is_filtered_smoothed_and_taken_apart(lead: float) -> None:
    sent = RANDOM.normal(6, 2, (N, 2))
    steps = steps_of(MOTOR, sent, STEP)
    poses = moved(np.zeros(3), steps, RANDOM.normal(0, 1e-3, (N, 3)), lead)
    measured = poses + RANDOM.normal(0, 5e-3, poses.shape)
    unread = [4, 5, 6, 30]
    measured[unread] = np.nan
    others = moved(np.ones(3), steps, np.zeros((N, 3)), lead)
    begun, white = np.zeros((2, 3)), np.zeros((2, N, 3))
    found = Driven(
        *smooth_passes(
            np.array([others, measured]), np.array([-sent, sent]), 1,
            MOTOR, STEP, lead, NOISE, 0.3, begun, white,
        )
    )  # fmt: skip
    whole = run_filter(measured, steps, lead, NOISE, 0.3, keep=True)
    expected, beyond = smoothed_poses(whole), found.beyond[1].T
    assert begun[1].tolist() == expected[0].tolist()
    assert found.poses.tolist() == expected.tolist()
    assert beyond == pytest.approx(
        body_steps(expected, lead) - steps[:, [0, 0, 1]] * [1, 0, 1], abs=1e-15
    )
    read = np.delete(np.arange(N), np.array(unread) - 1)
    assert np.isnan(np.delete(white[1], read, axis=0)).all()
    assert white[1][read].tolist() == whole.white[read].tolist()
    assert found.surprise == pytest.approx(np.square(whole.white[read]).mean(), rel=1e-12)
    # By what is beyond the model, the model moves as it was.
    again = moved(found.poses[0], steps, beyond, lead)
    assert again == pytest.approx(found.poses, abs=1e-12)
