"""What the model does not explain, as an average that follows the gains."""

from __future__ import annotations

import numpy as np
import pytest

from hilc_cli.laws.norm_optimal.identification import MeasuredMotion


def driven(applied: float, slip: float, heading: float = 0.3) -> MeasuredMotion:
    """Three steps straight ahead with gain 0.1 a wheel, and as much slip."""
    steps = 2 * 0.1 * applied + slip
    distance = np.arange(4) * steps
    poses = np.stack(
        [distance * np.cos(heading), distance * np.sin(heading), np.full(4, heading)], axis=1
    )
    return MeasuredMotion.of(poses, np.full((3, 2), applied))


def test_motion_is_seen_from_the_platform() -> None:
    poses = np.array([[0, 0, np.pi / 2], [-2, 3, 1.0], [-2, 3, 1.0]])
    motion = MeasuredMotion.of(poses, np.ones((2, 2)))
    assert motion.moved[0] == pytest.approx([3, 2, 1 - np.pi / 2])
    assert motion.drift(0.5, 0.25)[0] == pytest.approx([3 - 1.0, 2, 1 - np.pi / 2])


def test_average_is_over_all_iterations_up_to_the_memory() -> None:
    motion = driven(10, 0.1).and_then(driven(20, 0.2), 3).and_then(driven(30, 0.6), 3)
    assert motion.drift(0.1, 0.1)[:, 0] == pytest.approx(0.3)
    # From here on the last one has a third.
    assert motion.and_then(driven(30, 0.9), 3).drift(0.1, 0.1)[:, 0] == pytest.approx(0.5)


def test_average_follows_new_gains() -> None:
    motion = driven(10, 0.0).and_then(driven(30, 0.0), 2)
    # A gain of 0.08 leaves 0.02 a wheel unexplained at the mean of 20 rad/s.
    assert motion.drift(0.08, 0.1)[:, 0] == pytest.approx(2 * 0.02 * 20)


def test_memory_of_one_is_the_last_iteration() -> None:
    motion = driven(10, 0.1).and_then(driven(20, 0.2), 1)
    assert motion.drift(0.1, 0.1)[:, 0] == pytest.approx(0.2)


def test_iteration_at_rest_tells_the_start_only() -> None:
    rest = MeasuredMotion.of(np.tile([1.0, 2.0, 3.0], (4, 1)), np.zeros((3, 2)))
    moving = driven(10, 0.1)
    for motion in (rest.and_then(moving, 4), moving.and_then(rest, 4)):
        assert motion.drift(0.1, 0.1) == pytest.approx(moving.drift(0.1, 0.1))
        assert motion.start == pytest.approx([0.5, 1.0, 1.65])
