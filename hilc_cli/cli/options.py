"""Options that several commands share."""

from __future__ import annotations

import re
from collections.abc import Collection
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hilc_cli.cli.completion import complete_font, complete_key, complete_scenario
from hilc_cli.errors import UsageError
from hilc_cli.results.look import LARGEST_TEXT, SMALLEST_TEXT, USUAL, Look
from hilc_cli.results.picture_kinds import MOVING_PICTURES, RUN_PICTURES, SWEEP_PICTURES
from hilc_cli.version import __version__


class PictureFormat(StrEnum):
    """File formats of pictures."""

    PNG = "png"
    SVG = "svg"
    PDF = "pdf"


_FILE_ENDINGS = frozenset(
    {
        *PictureFormat,
        *("jpg", "jpeg", "gif", "tif", "tiff", "webp", "eps", "ps"),
        *("csv", "tsv", "txt", "md", "tex", "html", "json", "yaml", "yml", "parquet"),
        *("tum", "mcap", "bag", "db3", "zip", "gz", "tar", "log", "mat", "npy", "npz", "xlsx"),
    }
)
"""Names that end like that are those of files, whatever kinds hilc writes."""


if TYPE_CHECKING:
    PictureKind = str
else:
    _KINDS = (*RUN_PICTURES, *MOVING_PICTURES, *SWEEP_PICTURES)
    PictureKind = StrEnum("PictureKind", {name: name for name in _KINDS})


def _show_version(context: typer.Context, wanted: bool) -> None:
    if not wanted:
        return
    # What stands behind this option is not parsed yet.
    given = () if context.obj is None else context.obj.arguments
    if any(word == "--verbose" or _SHORT_VERBOSE.fullmatch(word) for word in given):
        from hilc_cli.cli.about import about

        typer.echo(about())
    else:
        typer.echo(f"hilc {__version__}")
    raise typer.Exit


_SHORT_VERBOSE = re.compile("-[a-z]*v[a-z]*")


def _remember_verbose(context: typer.Context, verbose: bool) -> bool:
    if context.obj is not None:
        context.obj.verbose = verbose
    return verbose


def check_is_folder_name(option: typer.CallbackParam, folder: Path | None) -> Path | None:
    """Makes sure that what is to be a folder is not called like a file.

    Args:
        option: What it was given as.
        folder: The folder; None if none was given.

    Raises:
        UsageError: The name has the ending of a kind of file, such as ``.pdf``.
    """
    ending = "" if folder is None else folder.suffix.lower().removeprefix(".")
    if folder is not None and ending in _FILE_ENDINGS:
        remedy = f"give the name of a folder, such as {folder.stem}"
        if ending in set(PictureFormat):
            remedy += f", and --format {ending} where pictures are drawn"
        raise UsageError(f"{option.opts[0]} {folder}: is the name of a file; {remedy}")
    return folder


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
        autocompletion=complete_key,
        show_default=False,
    ),
]
OutputFolder = Annotated[
    Path | None,
    typer.Option(
        "--out",
        metavar="DIR",
        help="The very folder to write.",
        callback=check_is_folder_name,
        show_default=False,
    ),
]
Force = Annotated[
    bool, typer.Option("--force", help="Replace other results that stand in the folder.")
]
Formats = Annotated[
    list[PictureFormat] | None,
    typer.Option("--format", help="Of the pictures; repeatable. [default: png]"),
]
Dpi = Annotated[int, typer.Option(min=20, max=1200, help="Resolution of png.")]
Width = Annotated[
    str | None,
    typer.Option(
        metavar="WIDTH",
        help="True width of the pictures, such as 85mm, 8.5cm or 3.4in; heights follow.",
        show_default=False,
    ),
]
Font = Annotated[
    str,
    typer.Option(
        metavar="FAMILY",
        help="Font of the pictures.",
        autocompletion=complete_font,
        show_default=False,
    ),
]
FontSize = Annotated[
    float | None,
    typer.Option(
        metavar="PT",
        min=SMALLEST_TEXT,
        max=LARGEST_TEXT,
        help="Size of axis labels, by which all text goes. [default: 8.5, with --width 8]",
        show_default=False,
    ),
]
Style = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help="Colours, lines and fonts of the pictures, as a Matplotlib style file.",
        show_default=False,
    ),
]
NoTitle = Annotated[
    bool, typer.Option("--no-title", help="Leave titles out, for pictures with a caption.")
]
Trust = Annotated[
    bool,
    typer.Option(
        "--trust", help="Run code that the file names: package.module:Class, or a plant's command."
    ),
]


def picture_formats(chosen: list[PictureFormat] | None) -> list[str]:
    """The endings of the pictures' files: png if nothing is chosen."""
    return [choice.value for choice in chosen or [PictureFormat.PNG]]


def picture_look(
    width: str | None, font: str, font_size: float | None, style: Path | None, no_title: bool
) -> Look:
    """What the options say of how pictures are to look.

    Raises:
        HilcError: One of them cannot be followed.
    """
    if width is None and not font and font_size is None and style is None:
        return Look(title=False) if no_title else USUAL
    from hilc_cli.drawing.looks import picture_look  # Matplotlib starts slowly

    return picture_look(
        width=width, font=font, font_size=font_size, style=style, title=not no_title
    )


Iterations = Annotated[
    str | None,
    typer.Option(
        metavar="LIST",
        help="Recorded iterations, such as 0,1,20..100.",
        show_default=False,
    ),
]


def chosen_iterations(text: str | None, recorded: Collection[int]) -> set[int] | None:
    """Returns the iterations that ``--iterations`` names; None if it is not given.

    Args:
        text: What was given.
        recorded: Those that there are: of a range, they are meant.

    Raises:
        UsageError: It has another form.
    """
    if text is None:
        return None
    wanted = whole_numbers("--iterations", text)
    ranges = [(first, last) for first, last in wanted if last is not None]
    chosen = {first for first, last in wanted if last is None}
    return chosen | {i for i in recorded for first, last in ranges if first <= i <= last}


_PART = re.compile(r"\s*(\d{1,9})\s*(?:\.\.\s*(\d{1,9})\s*)?")


def whole_numbers(option: str, text: str) -> list[tuple[int, int | None]]:
    """Returns the numbers, and the first and last ones of ranges, that a list names.

    Args:
        option: The option that holds it, for the error message.
        text: The list.

    Raises:
        UsageError: It has another form.
    """
    found: list[tuple[int, int | None]] = []
    for part in text.split(","):
        match = _PART.fullmatch(part)
        if match is None:
            raise UsageError(f"{option} {text}: must be whole numbers such as 0,1,5..10,100")
        first, last = int(match[1]), None if match[2] is None else int(match[2])
        if last is not None and last < first:
            raise UsageError(f"{option} {text}: '{part.strip()}' is no range from low to high")
        found.append((first, last))
    return found


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
    typer.Option(
        "--version",
        help="Print the version; with -v of all that takes part.",
        callback=_show_version,
        is_eager=True,
    ),
]
