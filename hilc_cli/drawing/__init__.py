"""What pictures of all kinds share: style, labels, layout, saving."""

from hilc_cli.drawing.loading import load_matplotlib

load_matplotlib()  # before any of these files imports it
