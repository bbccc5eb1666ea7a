"""The small scenario, loaded."""

from __future__ import annotations

import pytest

from hilc_cli.scenario.experiment import Scenario
from hilc_cli.scenario.loading import load_scenario
from tests.conftest import Write


@pytest.fixture
def scenario(write: Write) -> Scenario:
    write()
    return load_scenario("scenario.yaml")
