"""The small scenario, loaded."""

from __future__ import annotations

import pytest

from hilc_cli.spec.loading import load_scenario
from hilc_cli.spec.valid import Scenario
from tests.conftest import Write


@pytest.fixture
def scenario(write: Write) -> Scenario:
    write()
    return load_scenario("scenario.yaml")
