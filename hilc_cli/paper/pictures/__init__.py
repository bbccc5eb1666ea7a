"""The paper's figures."""

import hilc_cli.drawing  # noqa: F401  # loads Matplotlib, whatever is set for it
