"""Iterative learning control for differential-drive robots.

The Python interface in short::

    import hilc_cli as hilc

    scenario = hilc.load_scenario("scenarios/fig3-circle.yaml", overrides={"iterations": 20})
    result = hilc.run(scenario)
    print(result.metrics["max_position_error_m"])
    result.write("runs/circle")

    plan = hilc.plan_sweep(scenario, {"controller.gains.l1": "0.1:10:40:log"})
    print(hilc.sweep(plan).columns["max_position_error_m"])

    hilc.reproduce(hilc.plan_reproduction(["fig3"])).write("runs/fig3-of-the-paper")
"""

import ast
from importlib import import_module
from pathlib import Path
from typing import Any


def _homes() -> dict[str, str]:
    """Returns the module of each public name, as the stub for type checkers has it."""
    stub = Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8")
    return {
        alias.name: node.module or ""
        for node in ast.parse(stub).body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }


_HOMES = _homes()
__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    """Loads what is asked for when it is first used: ``hilc --help`` needs none of it."""
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """Returns the public names, loaded or not."""
    return __all__
