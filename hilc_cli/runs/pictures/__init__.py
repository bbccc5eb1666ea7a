"""The pictures of a run, one kind a file."""

import hilc_cli.drawing  # noqa: F401  # loads Matplotlib, whatever is set for it
