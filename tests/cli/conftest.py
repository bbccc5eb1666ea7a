from __future__ import annotations

import math

import pytest


@pytest.fixture
def alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Sweeps of this process start no workers that they are not told to start."""
    monkeypatch.setattr("hilc_cli.sweeps.compute._ALONE", math.inf)
