"""Iterative learning control for differential-drive robots."""

from hilc_cli.version import __version__

__all__ = ["__version__"]
