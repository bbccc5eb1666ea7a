"""Bounded random disturbances, the same numbers for the same seed wherever they are drawn."""
