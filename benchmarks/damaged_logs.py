"""Logs of robots, damaged in thousands of ways: what hilc makes of each.

    python benchmarks/damaged_logs.py [--cases N] [--seed S]

Makes a CSV log and a bag of each kind once. Each case is a damage that follows from its seed, and a
process of its own that reads the log. A case has failed if anything but the log or an expected
failure comes of it, if that has more than one line or a character that would steer a terminal, or
if it takes more than 20 seconds of processor time or 1 GB more memory than there was. Prints a
table of the cases and those that failed; exit code 1 if any has.
"""

from __future__ import annotations

import argparse
import os
import random
import resource
import shutil
import sys
import tempfile
import traceback
from collections import Counter
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from rosbags.rosbag2 import CompressionMode, StoragePlugin

from hilc_cli.errors import HilcError
from hilc_cli.logs.options import ReadOptions
from hilc_cli.logs.reading import read_log
from tests.logs.damage import damage_bag, damaged_table
from tests.logs.made_up_bags import (
    joint_state,
    pose_rows,
    transform_stamped,
    transforms,
    twist_rows,
    write_bag,
)

SECONDS, BYTES = 20, 1_000_000_000
POSES = np.column_stack([np.arange(200) / 30 + 1e9, np.arange(200) / 100, np.zeros((200, 2))])
TWISTS = np.column_stack([POSES[:, 0], np.ones(200), np.zeros(200)])


def make_logs(place: Path) -> dict[str, ReadOptions]:
    """Makes the logs, and returns how each is read."""
    rows = [",".join(map(repr, row)) + ",1,2" for row in POSES.tolist()]
    header = "t_s,x_m,y_m,heading_rad,left_wheel_rad_s,right_wheel_rad_s"
    (place / "log.csv").write_text("\n".join([header, *rows]))
    (place / "log.tum").write_text("\n".join(f"{k} {k} 0 0 0 0 0 1" for k in range(200)))
    names = ["left_wheel", "right_wheel"]
    messages = [*pose_rows(POSES), *twist_rows(TWISTS)]
    for t in POSES[:, 0].tolist():
        messages.append(
            ("/joints", "sensor_msgs/msg/JointState", t, joint_state(t, names, [1.0, 2.0]))
        )
        chain = transforms(transform_stamped(t, 1.0, 2.0, 0.3))
        messages.append(("/tf", "tf2_msgs/msg/TFMessage", t, chain))
    logs = {"log.csv": ReadOptions(), "log.tum": ReadOptions()}
    for storage in StoragePlugin:
        for compression in CompressionMode:
            if (storage, compression) == (StoragePlugin.SQLITE3, CompressionMode.STORAGE):
                continue
            name = f"{storage.name}-{compression.name}".lower()
            write_bag(place / name, messages, storage, compression)
            logs[name] = ReadOptions(pose="/camera/pose")
    write_bag(place / "frames", messages)
    logs["frames"] = ReadOptions(frames=("map", "base_link"))
    return logs


def read_damaged(log: Path, options: ReadOptions, dice: random.Random) -> str:
    """Damages a log and returns what became of reading it."""
    if log.is_dir():
        damage_bag(log, dice)
    else:
        log.write_bytes(damaged_table(log.read_text(), dice))
    try:
        read_log(log, options)
    except HilcError as error:
        text = str(error)
        printable = text.isprintable() or all(line.isprintable() for line in text.split("\n"))
        return "refused" if printable and len(text) < 3000 else f"odd text: {text[:300]!r}"
    return "read"


def in_a_process(work: Callable[[], str]) -> str:
    """Runs work in a process of bounded time and memory, and returns what it says."""
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reader)
        try:
            resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
            pages = int(Path("/proc/self/statm").read_text().split()[0])
            most = pages * resource.getpagesize() + BYTES
            resource.setrlimit(resource.RLIMIT_AS, (most, most))
            told = work()
        except BaseException:
            told = f"failed: {traceback.format_exc()}"
        os.write(writer, told.encode("utf-8", "replace")[:60_000])
        os._exit(0)
    os.close(writer)
    with os.fdopen(reader, "rb") as stream:
        told = stream.read().decode("utf-8", "replace")
    _, status = os.waitpid(child, 0)
    return told if os.WIFEXITED(status) else f"failed: killed by signal {os.WTERMSIG(status)}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0] if __doc__ else "")
    parser.add_argument("--cases", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    counts: Counter[tuple[str, str]] = Counter()
    failures = []
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        logs = make_logs(place)
        for name, options in logs.items():  # what is loaded here is loaded once
            read_log(place / name, options)
        for case in range(arguments.seed, arguments.seed + arguments.cases):
            dice = random.Random(case)
            name = dice.choice(sorted(logs))
            own = place / f"case-{name}"
            (shutil.copytree if (place / name).is_dir() else shutil.copy)(place / name, own)
            told = in_a_process(partial(read_damaged, own, logs[name], dice))
            kind = told.partition(":")[0]
            counts[name, kind] += 1
            if kind not in ("read", "refused"):
                failures.append(f"case {case} ({name}): {told}")
            shutil.rmtree(own) if own.is_dir() else own.unlink()
    for (name, kind), count in sorted(counts.items()):
        print(f"{name:24} {kind:10} {count:6}")
    print("\n\n".join(failures[:20]))
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
