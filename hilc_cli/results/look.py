"""How a user wants pictures to look: size, font, style, titles. Nothing is drawn here."""

from __future__ import annotations

import math
import re
import shlex
from dataclasses import dataclass, field

from hilc_cli.errors import UsageError

INCH = 0.0254  # [m]
NARROWEST, WIDEST = 0.06, 1.0  # [m]
SMALLEST_TEXT, LARGEST_TEXT = 4.0, 30.0  # [pt]

# A point is that of TeX, in which \the\columnwidth and \the\textwidth tell widths.
_UNITS = {"mm": 1e-3, "cm": 1e-2, "in": INCH, "inch": INCH, "pt": INCH / 72.27, "m": 1.0}
_LENGTH = re.compile(r"\s*(\d{1,6}(?:\.\d{0,12})?|\.\d{1,12})\s*([A-Za-z]*)\s*", re.ASCII)
_WIDTHS = "give a width with its unit, such as 85mm, 8.5cm or 3.4in"


@dataclass(frozen=True, slots=True)
class Look:
    """How pictures are to look; `picture_look` makes one of what a user says.

    Attributes:
        width: True width of the saved picture [m]; None for that of each kind.
        font: Family of all text; empty for that of hilc, which comes with Matplotlib.
        font_size: Size of axis labels [pt], by which all other text goes; None for 8.5, or for 8
            where a width is given.
        settings: Settings of Matplotlib, by their keys, from a style file.
        style_file: Where they stood; empty for nowhere.
        title: Whether the name of the run and the titles of panels stand above them.
    """

    width: float | None = None
    font: str = ""
    font_size: float | None = None
    settings: tuple[tuple[str, object], ...] = field(default=(), repr=False)
    style_file: str = ""
    title: bool = True

    @property
    def inches(self) -> float | None:
        """True width [inch]."""
        return None if self.width is None else self.width / INCH

    @property
    def options(self) -> str:
        """The options of the command line that ask for it, each behind a space."""
        size = self.font_size if not any(key == "font.size" for key, _ in self.settings) else None
        given = {
            "--width": "" if self.width is None else f"{1e3 * self.width:.6g}mm",
            "--font": self.font,
            "--font-size": "" if size is None else f"{size:g}",
            "--style": self.style_file,
        }
        words = [word for option, text in given.items() if text for word in (option, text)]
        return "".join(f" {shlex.quote(word)}" for word in (*words, *self._flags))

    @property
    def _flags(self) -> tuple[str, ...]:
        return () if self.title else ("--no-title",)


USUAL = Look()
"""How pictures look if nobody asks for anything else."""


def read_width(text: str | float, option: str = "width") -> float:
    """A width as a user gives it.

    Args:
        text: Such as ``8.5cm``, ``170 mm``, ``3.4in`` or ``252pt``, a point being TeX's; or a
            number of metres.
        option: What it was given as, for the message.

    Returns:
        The width [m].

    Raises:
        UsageError: It is no width, has no unit, or is out of range.
    """
    if isinstance(text, str):
        found = _LENGTH.fullmatch(text)
        unit = found[2].lower() if found else ""
        if not found or (unit and unit not in _UNITS):
            raise UsageError(f"{option} {text}: is no width; {_WIDTHS}")
        if not unit:
            raise UsageError(f"{option} {text}: has no unit; {_WIDTHS}")
        width = float(found[1]) * _UNITS[unit]
    else:
        width = float(text)
    # Widths at the very ends may be off by rounding, once turned into metres.
    if not NARROWEST - 1e-9 <= width <= WIDEST + 1e-9:
        ends = f"{1e3 * NARROWEST:g}mm to {1e3 * WIDEST:g}mm"
        got = f", got {1e3 * width:.4g}mm" if math.isfinite(width) else ""
        raise UsageError(f"{option} {text}: must be from {ends}{got}")
    return width
