"""How machine code is made, and when anew."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from types import ModuleType
from typing import Any

import pytest

from hilc_cli import compiling
from hilc_cli.engine.lanes import machine_code


def function() -> Callable[[float], float]:
    def double(value: float) -> float:
        return 2 * value

    return double


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[dict[str, Any]]:
    """What is asked of a compiler that finds no folder for its code."""
    found: list[dict[str, Any]] = []

    def njit(function: Callable[..., Any], **options: Any) -> Callable[..., Any]:
        found.append(options)
        return function

    def no_folder(function: Callable[..., Any]) -> None:
        raise RuntimeError("cannot cache function: no locator available")

    monkeypatch.setattr(compiling, "njit", njit)
    monkeypatch.setattr(compiling, "CodeCache", no_folder)
    return found


def test_code_is_compiled_without_a_folder_for_it(asked: list[dict[str, Any]]) -> None:
    double = function()
    assert compiling.cached(double) is double
    assert not hasattr(double, "_cache")
    assert len(asked) == 1


def test_laws_take_no_liberties_and_lane_loops_some(asked: list[dict[str, Any]]) -> None:
    compiling.cached(function())
    machine_code.cached(function(), ())
    liberties = [options["fastmath"] for options in asked]
    assert liberties == [set(), {"contract", "nsz", "arcp"}]
    assert all(options["error_model"] == "numpy" for options in asked)


def test_name_of_kept_code_tells_what_it_was_made_of(
    asked: list[dict[str, Any]], monkeypatch: pytest.MonkeyPatch
) -> None:
    def name(*parts: Callable[..., Any]) -> str:
        return compiling.cached(function(), parts=parts).__qualname__  # type: ignore[no-any-return]

    alone, with_part = name(), name(machine_code.formula)
    assert alone != with_part
    assert name() == alone
    assert name(machine_code.formula, machine_code.compiled) == with_part  # of the same file

    def changed(module: ModuleType) -> str:
        return f"{module.__name__} is not as it was"

    monkeypatch.setattr(inspect, "getsource", changed)
    assert len({alone, with_part, name(), name(machine_code.formula)}) == 4
