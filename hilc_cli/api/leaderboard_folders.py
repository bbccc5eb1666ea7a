"""The folders of leaderboards: what is in them, and the picture from that."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from hilc_cli.files import merge_folder
from hilc_cli.results.leaderboard import LeaderboardData
from hilc_cli.results.leaderboard_folder import is_leaderboard_folder, read_leaderboard_folder


def is_leaderboard(folder: str | Path) -> bool:
    """Whether a folder holds the results of a leaderboard."""
    return is_leaderboard_folder(Path(folder))


def read_leaderboard(folder: str | Path) -> LeaderboardData:
    """The results in the folder of a leaderboard, from its table of all runs and its manifest.

    Raises:
        HilcError: There is no such folder, or a file is missing or damaged.
    """
    return read_leaderboard_folder(Path(folder))


def plot_leaderboard(
    data: LeaderboardData,
    folder: str | Path,
    *,
    formats: Sequence[str] = ("png",),
    dpi: int = 150,
    may_replace: Callable[[Path], bool] = lambda file: False,
) -> list[Path]:
    """Draws the picture of a leaderboard.

    Args:
        data: From `read_leaderboard`, or the `data` of a `LawComparison`.
        folder: Where to put leaderboard.FORMAT; made if it is not there.
        formats: png, svg, pdf.
        dpi: Resolution of png.
        may_replace: Whether a picture of the same name that stands there may be replaced.

    Returns:
        The pictures written.

    Raises:
        UsageError: There is no such format.
        ExistingResultsError: A picture stands there that may not be replaced.
        FileAccessError: They cannot be written.
    """
    from hilc_cli.figures.leaderboard import save_leaderboard  # Matplotlib starts slowly

    names: list[str] = []

    def draw(into: Path) -> None:
        names.extend(path.name for path in save_leaderboard(data, into, formats, dpi))

    merge_folder(Path(folder), draw, may_replace)
    return [Path(folder) / name for name in names]
