#!/usr/bin/env python3
"""Plays plan.csv on a microcontroller at a serial line, a line 'left right' for each row.

python3 play_plan_serial.py lab/next/plan.csv /dev/ttyUSB0 --baud 115200

The microcontroller sets its wheels to the speeds of each line [rad/s], and has to stop by itself if
no line comes for 0.2 s: this program, or its cable, may fail. Needs: pip install pyserial
"""

import argparse
import csv
import time

import serial

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("plan")
parser.add_argument("port", help="such as /dev/ttyUSB0")
parser.add_argument("--baud", type=int, default=115200)
given = parser.parse_args()

with open(given.plan, newline="") as file:
    rows = [row for row in csv.DictReader(file) if row["left_wheel_rad_s"]]

with serial.Serial(given.port, given.baud, write_timeout=0.1) as line:

    def send(left: str, right: str) -> None:
        line.write(f"{left} {right}\n".encode())

    try:
        begin = time.monotonic() - float(rows[0]["t_s"])
        for row in rows:
            time.sleep(max(0.0, begin + float(row["t_s"]) - time.monotonic()))
            send(row["left_wheel_rad_s"], row["right_wheel_rad_s"])
    finally:
        for _ in range(5):
            send("0", "0")
            time.sleep(0.02)
