"""The conditions, constants and bounds of the paper's theorems."""
