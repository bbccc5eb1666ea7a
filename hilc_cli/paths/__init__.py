"""Paths, shown before anything is simulated: drawn, and told segment by segment."""
