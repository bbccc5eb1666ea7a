"""A check in words."""
