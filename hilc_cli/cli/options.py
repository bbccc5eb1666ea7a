"""Options that several commands share."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from hilc_cli.shipped_files import PREFIX, examples
from hilc_cli.version import __version__


class PictureFormat(StrEnum):
    """File formats of pictures."""

    PNG = "png"
    SVG = "svg"
    PDF = "pdf"


class PictureKind(StrEnum):
    """Kinds of pictures, of runs and then of sweeps."""

    PATH_CHANGE = "path-change"
    FINAL_PATH = "final-path"
    ERROR = "error"
    WHEEL_SPEEDS = "wheel-speeds"
    SUMMARY = "summary"
    LEARNING = "learning"
    CURVE = "curve"
    MAP = "map"
    EFFECTS = "effects"
    BEST = "best"
    BANDS = "bands"
    SEARCH = "search"


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"hilc {__version__}")
        raise typer.Exit


def _remember_verbose(context: typer.Context, verbose: bool) -> bool:
    if context.obj is not None:
        context.obj.verbose = verbose
    return verbose


def complete_scenario(incomplete: str) -> list[str]:
    """Example names and YAML files that a scenario argument may go on with."""
    names = [f"{PREFIX}{path.stem}" for path in examples()]
    folder = Path(incomplete) if incomplete.endswith("/") else Path(incomplete).parent
    if folder.is_dir():
        names += [
            f"{path}/" if path.is_dir() else str(path)
            for path in sorted(folder.iterdir())
            if path.is_dir() or path.suffix in (".yaml", ".yml")
        ]
    return [name for name in names if name.startswith(incomplete)]


ScenarioArgument = Annotated[
    str,
    typer.Argument(
        metavar="SCENARIO",
        help="A scenario file, - for standard input, or example:NAME.",
        autocompletion=complete_scenario,
        show_default=False,
    ),
]
Overrides = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="Replace a value of the scenario, such as controller.gains.l1=0.5; repeatable.",
        show_default=False,
    ),
]
OutputFolder = Annotated[
    Path | None,
    typer.Option("--out", metavar="DIR", help="The very folder to write.", show_default=False),
]
Force = Annotated[
    bool, typer.Option("--force", help="Replace other results that stand in the folder.")
]
Formats = Annotated[
    list[PictureFormat] | None,
    typer.Option("--format", help="Of the pictures; repeatable. [default: png]"),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document instead of text.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")]
Verbose = Annotated[
    bool,
    typer.Option(
        "--verbose",
        "-v",
        help="Say more; show the traceback of a failure.",
        callback=_remember_verbose,
        is_eager=True,
    ),
]
Version = Annotated[
    bool,
    typer.Option("--version", help="Print the version.", callback=_show_version, is_eager=True),
]
