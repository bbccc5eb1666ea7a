"""Engines: an experiment in, its iterations out."""
