"""Iterative learning control for differential-drive robots.

The Python interface in short::

    import hilc_cli as hilc

    scenario = hilc.load_scenario("scenarios/fig3-circle.yaml", overrides={"iterations": 20})
    result = hilc.run(scenario)
    print(result.metrics["max_position_error_m"])
    result.write("runs/circle")
"""

from typing import TYPE_CHECKING, Any

from hilc_cli.errors import HilcError
from hilc_cli.version import __version__

if TYPE_CHECKING:
    from hilc_cli.api import (
        Run,
        RunData,
        Scenario,
        Summary,
        check_folder,
        load_scenario,
        plot,
        read_run,
        run,
    )

__all__ = [
    "HilcError",
    "Run",
    "RunData",
    "Scenario",
    "Summary",
    "__version__",
    "check_folder",
    "load_scenario",
    "plot",
    "read_run",
    "run",
]


def __getattr__(name: str) -> Any:
    """Loads the interface when it is first used: ``hilc --help`` needs none of it."""
    if name in __all__:
        from hilc_cli import api

        return getattr(api, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """The public names, loaded or not."""
    return sorted(__all__)
