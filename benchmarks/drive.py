"""How fast ``hilc drive`` answers: a robot in C asks 1000 times a second, all on one core.

Usage: python benchmarks/drive.py [--rate 1000] [--seconds 20] [--law feedback]

An answer is late if it has not come when the next line is due. Needs a C compiler and taskset.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROBOT = r"""
#include <math.h>
#include <stdio.h>
#include <time.h>
static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return t.tv_sec + 1e-9 * t.tv_nsec;
}
int main(void) {
  double x = 0, y = 0, heading = 0, left, right, worst = 0, sum = 0, begin = 0;
  long late = 0, asked = 0;
  for (long k = 0; k <= STEPS; k++) {
    if (k) {
      double wait = begin + k * DT - now();
      if (wait > 0) {
        struct timespec t = {(time_t)wait, (long)(1e9 * fmod(wait, 1.0))};
        nanosleep(&t, NULL);
      }
    }
    double sent = now();
    printf("%.9f %.12f %.12f %.12f\n", k * DT, x, y, heading);
    fflush(stdout);
    if (scanf("%lf %lf", &left, &right) != 2) break;
    double took = now() - sent;
    if (!k) { begin = now(); continue; }  /* the program has started by now */
    asked++;
    sum += took;
    if (took > worst) worst = took;
    if (took > DT) late++;
    double way = 0.033 * (left + right) / 2 * DT, turn = 0.033 * (right - left) / 0.16 * DT;
    x += way * cos(heading + turn / 2);
    y += way * sin(heading + turn / 2);
    heading += turn;
  }
  fprintf(stderr, "%ld answers, %.0f us in the mean, %.0f us at worst, %ld late: %.3f %% in time\n",
          asked, 1e6 * sum / asked, 1e6 * worst, late, 100.0 - 100.0 * late / asked);
  return 0;
}
"""
SCENARIO = """\
name: fast
trajectory:
  name: fast
  sample_time: {step}
  start: {{x: 0, y: 0, heading: 0}}
  segments: [arc: {{radius: 0.5, sweep: {sweep}, turn: left}}]
  timing: {{speed: 0.15, acceleration: 0.3}}
robot: {{wheel_radius: 33 mm, wheel_separation: 160 mm, turn_convention: ros}}
controller: {{law: {law}}}
safety: {{wheel_speed: 6.67, wheel_acceleration: 50}}
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rate", type=float, default=1000.0)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--law", default="feedback")
    given = parser.parse_args()
    step = 1 / given.rate
    work = Path(tempfile.mkdtemp())
    text = SCENARIO.format(step=step, sweep=0.3 * (given.seconds + 2), law=given.law)
    (work / "fast.yaml").write_text(text)
    (work / "robot.c").write_text(ROBOT)
    constants = [f"-DSTEPS={round(given.seconds * given.rate)}", f"-DDT={step!r}"]
    subprocess.run(["cc", "-O2", "robot.c", "-o", "robot", *constants, "-lm"], cwd=work, check=True)
    one_core = ["taskset", "-c", str(min(os.sched_getaffinity(0)))]
    with subprocess.Popen(
        [*one_core, sys.executable, "-m", "hilc_cli", "drive", "fast.yaml", "-q"],
        cwd=work,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    ) as controller:
        assert controller.stdin is not None
        subprocess.run(
            [*one_core, "./robot"],
            cwd=work,
            stdin=controller.stdout,
            stdout=controller.stdin,
            check=True,
        )
        controller.stdin.close()


if __name__ == "__main__":
    main()
