"""One experiment: load, run, keep, read back, draw."""
