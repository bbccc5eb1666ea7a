"""Damaged logs are read, or refused in one line; `benchmarks/damaged_logs.py` tries thousands."""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag2 import CompressionMode, StoragePlugin

from hilc_cli.errors import HilcError
from hilc_cli.logs.reading import read_log
from tests.logs.damage import damage_bag, damaged_table
from tests.logs.made_up_bags import pose_rows, twist_rows, write_bag

POSES = np.column_stack([np.arange(100) / 30 + 1e9, np.arange(100) / 100, np.zeros((100, 2))])
TWISTS = np.column_stack([POSES[:, 0], np.ones(100), np.zeros(100)])


def check(log: Path) -> None:
    try:
        found = read_log(log)
    except HilcError as error:
        assert str(error).isprintable()
        assert len(str(error)) < 1000
    else:
        assert np.isfinite(found.poses.x).all()
        assert (np.diff(found.poses.times) > 0).all()


def test_damaged_tables(tmp_path: Path) -> None:
    rows = [",".join(map(repr, row)) + ",1,2" for row in POSES.tolist()]
    text = "\n".join(["t_s,x_m,y_m,heading_rad,left_wheel_rad_s,right_wheel_rad_s", *rows])
    for seed in range(200):
        log = tmp_path / "log.csv"
        log.write_bytes(damaged_table(text, random.Random(seed)))
        check(log)


@pytest.mark.parametrize("storage", StoragePlugin)
@pytest.mark.parametrize("compression", [CompressionMode.NONE, CompressionMode.MESSAGE])
def test_damaged_bags(tmp_path: Path, storage: StoragePlugin, compression: CompressionMode) -> None:
    rows = [*pose_rows(POSES), *twist_rows(TWISTS)]
    whole = write_bag(tmp_path / "bag", rows, storage, compression)
    content = {file.name: file.read_bytes() for file in whole.iterdir()}
    for seed in range(25):
        for name, own in content.items():
            (whole / name).write_bytes(own)
        damage_bag(whole, random.Random(seed))
        check(whole)
