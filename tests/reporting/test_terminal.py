"""What goes to the terminal."""

from __future__ import annotations

import json
import math

import pytest

from hilc_cli.reporting.terminal import print_json


def test_json_has_null_for_what_is_no_number(capsys: pytest.CaptureFixture[str]) -> None:
    numbers = [1.5, math.nan, -math.inf, 3]
    print_json({"a": math.inf, "b": {"c": (math.nan,)}, "d": numbers, "e": True, "f": "nan"})
    told = {"a": None, "b": {"c": [None]}, "d": [1.5, None, None, 3], "e": True, "f": "nan"}
    assert json.loads(capsys.readouterr().out) == told
