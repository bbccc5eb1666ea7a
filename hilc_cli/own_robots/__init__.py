"""The first two files for somebody's own robot: a path that its wheels can follow, a scenario."""
