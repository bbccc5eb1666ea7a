"""What logs of any motion tell of a robot: its wheels, its motors, and how sure that is."""
