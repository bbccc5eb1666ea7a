"""Logs of real robots: reading them, and laying what was measured over what was planned."""
