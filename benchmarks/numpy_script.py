"""The experiment of benchmarks/sweep.py as a script would write it, with small NumPy arrays."""

import numpy as np

SAMPLE_TIME, WHEEL_RADIUS, HALF_TRACK, LIMIT = 0.001, 0.2, 0.518, 180.0
GAINS = (0.1, 0.25, 0.25)
STEPS = 2000


def last_maximum_error(iterations: int) -> float:
    """Runs iterations 0 to `iterations`; returns the largest position error of the last [m]."""
    angle = np.linspace(0, 2 * np.pi, STEPS + 1)
    desired = np.stack([10 * np.cos(angle), 10 * np.sin(angle), angle + np.pi / 2], axis=1)
    wheels = np.zeros((STEPS, 2))
    past = np.zeros((STEPS + 1, 3))
    errors = past
    for iteration in range(iterations + 1):
        pose = np.array([10.0, 0.0, np.pi / 2])
        errors = np.zeros((STEPS + 1, 3))
        errors[0] = desired[0] - pose
        before = np.zeros(3)
        for k in range(STEPS):
            cos, sin = np.cos(pose[2]), np.sin(pose[2])
            if iteration > 0:
                gain = np.array([[cos, sin, HALF_TRACK], [cos, sin, -HALF_TRACK]]) / WHEEL_RADIUS
                l1, l2, l3 = GAINS
                wheels[k] += gain @ (l1 * past[k + 1] + l2 * errors[k] + l3 * before)
            before = errors[k]
            fastest = np.abs(wheels[k]).max()
            if fastest > LIMIT:
                wheels[k] *= LIMIT / fastest
            turning = 1 / HALF_TRACK
            motion = WHEEL_RADIUS / 2 * np.array([[cos, cos], [sin, sin], [turning, -turning]])
            pose = pose + SAMPLE_TIME * motion @ wheels[k]
            errors[k + 1] = desired[k + 1] - pose
        past = errors
    return float(np.hypot(errors[:, 0], errors[:, 1]).max())
