"""Which of the shipped scenarios stand for the others where each takes long."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest

# They differ from others in the numbers of their gains and starts, or in their path, alone.
LIKE_OTHERS = (
    *("fig3-arc-and-line", "fig3-cardioid", "fig3-spiral", "fig5-cardioid", "fig5-spiral"),
    *("fig6a", "fig6b", "fig6c", "fig6d", "fig6e", "fig6f", "fig6h", "fig7b", "fig7c", "fig7d"),
    *("fig8a", "gain-map", "corridor", "parking", "slalom", "turn-in-place"),
)


def distinct(names: Iterable[str]) -> list[Any]:
    """Parameters of a test that sees each kind of scenario; the slow tests see every one."""
    return [
        pytest.param(name, marks=pytest.mark.slow if name in LIKE_OTHERS else ()) for name in names
    ]
