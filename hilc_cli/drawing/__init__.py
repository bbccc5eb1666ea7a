"""Pictures of results: one kind a file, arrays in, a Matplotlib figure out."""

from hilc_cli.drawing.loading import load_matplotlib

load_matplotlib()  # before any of these files imports it
