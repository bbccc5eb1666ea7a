#!/usr/bin/env python3
"""Plays plan.csv on a robot under ROS 2, as twists on /cmd_vel, and stops it in the end.

python3 play_plan_ros2.py lab/next/plan.csv --radius 0.033 --separation 0.16

Radius and separation are those that the robot's DRIVER is configured with: it turns the twists back
into wheel speeds with them. Stay beside the robot. Ctrl-C stops it; so does the driver itself, once
nothing comes any more (cmd_vel_timeout of diff_drive_controller).
"""

import argparse
import csv
import time

import rclpy
from geometry_msgs.msg import Twist, TwistStamped

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("plan")
parser.add_argument("--radius", type=float, required=True, help="wheel radius of the driver, m")
parser.add_argument("--separation", type=float, required=True, help="wheels of the driver, m")
parser.add_argument("--topic", default="/cmd_vel")
parser.add_argument("--unstamped", action="store_true", help="Twist instead of TwistStamped")
given = parser.parse_args()

with open(given.plan, newline="") as file:
    rows = [row for row in csv.DictReader(file) if row["left_wheel_rad_s"]]

rclpy.init()
node = rclpy.create_node("play_plan")
kind = Twist if given.unstamped else TwistStamped
publisher = node.create_publisher(kind, given.topic, 10)


def send(left: float, right: float) -> None:
    message = kind()
    twist = message if given.unstamped else message.twist
    twist.linear.x = given.radius * (left + right) / 2
    twist.angular.z = given.radius * (right - left) / given.separation
    if not given.unstamped:
        message.header.stamp = node.get_clock().now().to_msg()
    publisher.publish(message)


try:
    while publisher.get_subscription_count() == 0:
        print("waiting for the robot's driver ...")
        time.sleep(0.5)
    begin = time.monotonic() - float(rows[0]["t_s"])
    for row in rows:
        time.sleep(max(0.0, begin + float(row["t_s"]) - time.monotonic()))
        send(float(row["left_wheel_rad_s"]), float(row["right_wheel_rad_s"]))
finally:  # at the end, after Ctrl-C, and whatever goes wrong
    for _ in range(5):
        send(0.0, 0.0)
        time.sleep(0.02)
    node.destroy_node()
    rclpy.shutdown()
