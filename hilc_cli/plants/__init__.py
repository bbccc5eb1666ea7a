"""Robots: how they move in one sample."""
