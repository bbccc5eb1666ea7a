"""Identifies the robot of the Labyrinth dataset, and says what its documentation says beside it.

    python benchmarks/labyrinth.py FOLDER

FOLDER holds the dataset as it is published by Chemnitz University of Technology (Tim Pfeifer,
CC BY-SA 4.0): ``Indoor_UWB_Input.txt`` with speeds of two wheels, ``Indoor_UWB_GT.txt`` with
positions without headings. They become a CSV log in a temporary folder, which `hilc identify` is
given, once with the wheel speeds as measured ones, and once as commands.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path

DOCUMENTED_SEPARATION = 0.0785  # [m], column 6 of the odometry
ROLES = {
    "as measured wheel speeds": ("measured_left_wheel_rad_s", "measured_right_wheel_rad_s"),
    "as commands": ("left_wheel_rad_s", "right_wheel_rad_s"),
}


def rows_of(path: Path, kind: str) -> list[list[str]]:
    """Returns the words of all lines of a kind, without their name."""
    lines = path.read_text(encoding="utf-8").splitlines()
    return [words[1:] for words in map(str.split, lines) if words and words[0] == kind]


def write_log(folder: Path, path: Path, names: tuple[str, str]) -> None:
    """Writes the dataset as a log: speeds in m/s are those of wheels of 1 m in rad/s."""
    rows = [
        (float(t), f"{t},{x},{y},,")
        for t, x, y, *_ in rows_of(folder / "Indoor_UWB_GT.txt", "point2")
    ]
    # Its documentation: the right wheel first.
    rows += [
        (float(t), f"{t},,,{left},{right}")
        for t, right, left, *_ in rows_of(folder / "Indoor_UWB_Input.txt", "odom2diff")
    ]
    header = ",".join(["t_s", "x_m", "y_m", *names])
    path.write_text("\n".join([header, *(text for _, text in sorted(rows))]) + "\n")


def identified(log: Path) -> dict[str, object]:
    """Returns what `hilc identify --json` says of a log."""
    believed = {
        "wheel_radius": 1,
        "wheel_separation": DOCUMENTED_SEPARATION,
        "turn_convention": "ros",
    }
    sets = [word for key, value in believed.items() for word in ("--set", f"model.{key}={value}")]
    command = [sys.executable, "-m", "hilc_cli", "identify", str(log), *sets, "--json", "-q"]
    result: dict[str, object] = json.loads(subprocess.check_output(command, text=True))
    return result


def main() -> None:
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = Path(sys.argv[1])
    with tempfile.TemporaryDirectory() as temporary:
        for title, names in ROLES.items():
            log = Path(temporary) / "labyrinth.csv"
            write_log(folder, log, names)
            found = identified(log)
            print(f"\n{title}: {found['length_m']:.3g} m in {found['duration_s']:.3g} s")
            estimates = found["estimates"]
            assert isinstance(estimates, dict)
            for key, each in estimates.items():
                believed = each["believed"]
                told = f"   documentation: {believed:g}" if believed is not None else ""
                print(f"  {key:24} {each['value']:9.4f} +- {each['standard_error']:.4f}{told}")
            print(f"  left and right swapped: {found['swapped']}")
            print(
                f"  RMS over the path, driven blindly: {1e3 * found['rms_blind_m']:.1f} mm"  # type: ignore[operator]
                f"   documentation: {1e3 * found['rms_blind_believed_m']:.1f} mm"  # type: ignore[operator]
            )


if __name__ == "__main__":
    main()
