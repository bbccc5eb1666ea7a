"""A stand-in for a robot: drives plan.csv and writes what a camera saw to log.csv.

python stand_in_robot.py plan.csv log.csv --delay 0.1 --unequal 0.02 --noise 0.002

Nothing but files passes between it and hilc. Its motors answer late and slowly, its wheels are
unequal, and its camera has noise, a rate and a clock of its own. With --mujoco it is a rigid body
with tyres that slide and motors with a torque limit. Turning follows ROS REP-103.
"""

import argparse
import csv
import math

import numpy as np

from hilc_cli.plants.drivetrain import Drivetrain
from hilc_cli.plants.imperfect_plant import ImperfectPlant
from hilc_cli.plants.kinematic import Robot
from hilc_cli.plants.motor import Motor
from hilc_cli.plants.mujoco_plant import MujocoSpec

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("plan", help="CSV with t_s, left_wheel_rad_s, right_wheel_rad_s")
parser.add_argument("log", help="CSV to write: t_s, x_m, y_m, heading_rad")
parser.add_argument("--start", type=float, nargs=3, default=(0.0, 0.0, 0.0), help="m, m, rad")
parser.add_argument("--wheel-radius", type=float, default=0.033, help="m")
parser.add_argument("--wheel-separation", type=float, default=0.16, help="m")
parser.add_argument("--unequal", type=float, default=0.0, help="left larger, right smaller")
parser.add_argument("--delay", type=float, default=0.0, help="from command to motor, s")
parser.add_argument("--lag", type=float, default=0.03, help="of the motors, not with --mujoco: s")
parser.add_argument("--mujoco", action="store_true", help="a rigid body; needs 'mujoco'")
parser.add_argument("--start-scatter", type=float, default=0.0, help="m, and as many rad")
parser.add_argument("--noise", type=float, default=0.0, help="of the camera: m, and as many rad")
parser.add_argument("--rate", type=float, default=30.0, help="of the camera: pictures a second")
parser.add_argument("--clock", type=float, default=100.0, help="of the camera, at its start: s")
parser.add_argument("--seed", type=int, default=0)
given = parser.parse_args()

with open(given.plan, newline="") as file:
    rows = [row for row in csv.DictReader(file) if row["left_wheel_rad_s"]]
times = np.array([float(row["t_s"]) for row in rows])
speeds = [(float(row["left_wheel_rad_s"]), float(row["right_wheel_rad_s"])) for row in rows]
sample = float(np.median(np.diff(times)))

random = np.random.default_rng(given.seed)
radius, half_track = given.wheel_radius, given.wheel_separation / 2
left_radius, right_radius = radius * (1 + given.unequal), radius * (1 - given.unequal)
if given.mujoco:
    body = {
        "plant": "mujoco",
        "wheel_radius": {"left": left_radius, "right": right_radius},
        "half_track": half_track,
        "turn_convention": "rep103",
        "motor": {"delay": given.delay},
    }
    plant, step_time = MujocoSpec.model_validate(body).as_plant(), 2e-3
else:
    wheels = Drivetrain(left_radius, right_radius, Motor(given.delay, given.lag))
    plant, step_time = ImperfectPlant(Robot(radius, half_track, "rep103"), wheels, exact=True), 1e-3
x, y, heading = np.array(given.start) + random.normal(0, given.start_scatter, 3)
pose = (float(x), float(y), float(heading))
drive = plant.start(pose, step_time)

STANDS = 0.6  # [s] before the plan and after it
duration = STANDS - times[0] + times[-1] + sample + STANDS + given.delay
pictures = 0
with open(given.log, "w", newline="") as file:
    log = csv.writer(file)
    log.writerow(["t_s", "x_m", "y_m", "heading_rad"])
    for step in range(math.ceil(duration / step_time)):
        now = step * step_time
        if pictures / given.rate <= now:
            seen = np.array(pose) + random.normal(0, given.noise, 3)
            seen[2] = math.remainder(seen[2], 2 * math.pi)
            log.writerow([repr(given.clock + now), *(f"{value:.6f}" for value in seen)])
            pictures += 1
        row = int(np.searchsorted(times, now - STANDS + 1e-9, side="right")) - 1
        driven = row >= 0 and now - STANDS < times[-1] + sample
        left, right = speeds[row] if driven else (0.0, 0.0)
        pose = drive(pose, left, right)
