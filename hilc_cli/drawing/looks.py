"""What a user asks of pictures, checked: the width, the font, and a style file by a list of keys.

A style file may come from anybody. It is read line by line by this module alone: keys that are not
on the list are refused, so that none chooses a program, a folder or a formula to be run.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.font_manager import fontManager

from hilc_cli.drawing.style import IN_POINTS, PRINT_SIZE
from hilc_cli.errors import InvalidInputError, Problem, UsageError
from hilc_cli.files import read_file
from hilc_cli.results.look import LARGEST_TEXT, SMALLEST_TEXT, Look, read_width
from hilc_cli.wording import listed, near_name, printable, shortened

_MOST_BYTES, _MOST_LETTERS = 64_000, 200  # of a style file, and of one of its values
_WIDEST_LINE = 20.0  # [pt]
_ROOM = 7.5e-3  # [m] of a picture's width that a point of text's size needs
_SHOWN = 60  # letters of a wrong value

Check = Callable[[Any], bool]


def _is_text_size(value: Any) -> bool:
    return isinstance(value, float) and SMALLEST_TEXT <= value <= LARGEST_TEXT


def _is_short(value: Any) -> bool:
    return isinstance(value, float) and 0 <= value <= _WIDEST_LINE


def _is_share(value: Any) -> bool:
    return value is None or (isinstance(value, float) and 0 <= value <= 1)


def _is_weight(value: Any) -> bool:
    return isinstance(value, str) or 0 <= value <= 1000


def _is_line_style(value: Any) -> bool:
    return value in ("-", "--", "-.", ":")


def _is_anything(value: Any) -> bool:
    return True


_SIZE = (_is_text_size, f"a number from {SMALLEST_TEXT:g} to {LARGEST_TEXT:g}, in points")
_POINTS = (_is_short, f"a number from 0 to {_WIDEST_LINE:g}, in points")
_SHARE = (_is_share, "a number from 0 to 1")
_COLOR = (_is_anything, "a colour, such as black, 0.3 or 1f77b4")
_SWITCH = (_is_anything, "True or False")
_FAMILIES = (_is_anything, "names of font families, with commas between them")
_WEIGHT = (_is_weight, "normal, bold or a number from 0 to 1000")


def _of_ticks(axis: str) -> dict[str, tuple[Check, str]]:
    sides = ("top", "bottom") if axis == "x" else ("left", "right")
    return {
        **dict.fromkeys((f"{axis}tick.{each}" for each in ("color", "labelcolor")), _COLOR),
        **dict.fromkeys((f"{axis}tick.{side}" for side in sides), _SWITCH),
        f"{axis}tick.direction": (_is_anything, "in, out or inout"),
    }


KEYS: Mapping[str, tuple[Check, str]] = {
    "font.size": _SIZE,
    "font.family": _FAMILIES,
    "font.serif": _FAMILIES,
    "font.sans-serif": _FAMILIES,
    "font.monospace": _FAMILIES,
    "font.weight": _WEIGHT,
    "text.color": _COLOR,
    "figure.facecolor": _COLOR,
    "axes.facecolor": _COLOR,
    "axes.edgecolor": _COLOR,
    "axes.labelcolor": _COLOR,
    "axes.titlecolor": _COLOR,
    "axes.labelweight": _WEIGHT,
    "axes.titleweight": _WEIGHT,
    **{f"axes.spines.{side}": _SWITCH for side in ("left", "right", "top", "bottom")},
    **_of_ticks("x"),
    **_of_ticks("y"),
    "grid.color": _COLOR,
    "grid.linestyle": (_is_line_style, "-, --, -. or :"),
    "grid.alpha": _SHARE,
    "legend.frameon": _SWITCH,
    "legend.fancybox": _SWITCH,
    "legend.facecolor": _COLOR,
    "legend.edgecolor": _COLOR,
    "legend.framealpha": _SHARE,
    "hatch.color": _COLOR,
    **dict.fromkeys(sorted(IN_POINTS), _POINTS),
}
"""All that a style file may say: for each key a check of its value, and what it may be."""

_GENERIC = ("serif", "sans-serif", "monospace")
_FONT_LISTS = tuple(f"font.{name}" for name in _GENERIC)


def picture_look(
    *,
    width: str | float | None = None,
    font: str = "",
    font_size: float | None = None,
    style: str | Path | None = None,
    title: bool = True,
) -> Look:
    """Says how pictures are to look.

    Args:
        width: True width of the saved pictures, such as ``8.5cm``, ``170 mm`` or ``3.4in``, or a
            number of metres; heights follow. By default each kind has its own.
        font: Family of all text, as the system knows it.
        font_size: Size of axis labels [pt], by which all other text goes.
        style: A style file of Matplotlib, of which the keys in `KEYS` may be set. What is given
            beside it counts more.
        title: Whether the name of the run and the titles of panels stand above them.

    Raises:
        UsageError: A width or size is out of range, or there is no such font.
        InvalidInputError: A line of the style file is none, or has a key that is not allowed.
        FileAccessError: The style file cannot be read.
    """
    true_width = None if width is None else read_width(width, "--width")
    if font:
        check_font(font, "--font")
    if font_size is not None and not SMALLEST_TEXT <= font_size <= LARGEST_TEXT:
        ends = f"{SMALLEST_TEXT:g} to {LARGEST_TEXT:g} points"
        raise UsageError(f"--font-size {font_size:g}: must be from {ends}")
    settings = {} if style is None else read_style(Path(style))
    size = settings.get("font.size")
    if font_size is None and isinstance(size, float):
        font_size = size
    elif font_size is not None:
        settings.pop("font.size", None)
    if true_width is not None:
        _check_room(true_width, font_size or PRINT_SIZE)
    return Look(
        width=true_width,
        font=font,
        font_size=font_size,
        settings=tuple(settings.items()),
        style_file="" if style is None else str(style),
        title=title,
    )


def _check_room(width: float, font_size: float) -> None:
    """Makes sure that panels have room beside their text.

    Args:
        width: Of the picture [m].
        font_size: [pt].

    Raises:
        UsageError: They have not.
    """
    needed = _ROOM * font_size
    if width < needed * (1 - 1e-9):
        raise UsageError(
            f"--width {1e3 * width:.6g}mm: is too narrow for text of {font_size:g} points; give "
            f"{1e3 * needed:.4g}mm or more, or a --font-size of {width / _ROOM:.3g} or less"
        )


def font_families() -> list[str]:
    """The families of all fonts that are known here."""
    return sorted({font.name for font in fontManager.ttflist})


def check_font(family: str, where: str) -> None:
    """Makes sure that pictures can be set in a font.

    Args:
        family: Its family.
        where: What named it, for the message.

    Raises:
        UsageError: The system has no such font, or one that PDF files cannot hold as it is.
    """
    problem = _font_problem(family)
    if problem:
        raise UsageError(f"{printable(where)} {shortened(printable(family), _SHOWN)}: {problem}")


def _font_problem(family: str) -> str:
    """What is wrong with a font; empty if nothing is."""
    files = [font.fname for font in fontManager.ttflist if font.name == family]
    if not files:
        known = font_families()
        words = family.lower().split()
        # A part of a name has no near spelling.
        like = [name for name in known if words and words[0] in name.lower()]
        near = near_name(family, known)
        if near:
            return f"there is no such font; did you mean '{near}'?"
        return f"there is no such font; known: {listed(like or known)}"
    if any(_is_postscript(Path(file)) for file in files):
        return (
            "its outlines are PostScript's, which cannot be embedded in a PDF as TrueType; "
            "give a TrueType font (.ttf)"
        )
    return ""


def _is_postscript(file: Path) -> bool:
    try:
        with file.open("rb") as content:
            return content.read(4) == b"OTTO"
    except OSError:  # listed, and gone: Matplotlib takes another
        return False


def read_style(path: Path) -> dict[str, object]:
    """The settings of a style file.

    Args:
        path: The file, with a ``key: value`` in each line and comments behind ``#``.

    Returns:
        Values by key, as Matplotlib checks them.

    Raises:
        InvalidInputError: A line is none, has a key that is not allowed, or a wrong value.
        FileAccessError: It cannot be read.
    """
    try:
        text = read_file(path, _MOST_BYTES).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise UsageError(f"{path}: is no text in UTF-8; give a style file of Matplotlib") from None
    found: dict[str, object] = {}
    problems: list[Problem] = []
    for number, line in enumerate(text.splitlines(), 1):
        content = _without_comment(line).strip()
        if not content:
            continue
        key, colon, value = (part.strip() for part in content.partition(":"))
        problem = "" if colon else "is no line 'key: value'"
        if not problem and key in found:
            problem = "stands there twice"
        if not problem:
            problem = _take(key, value.strip("\"'").strip(), found)
        if problem:
            shown = shortened(printable(key), _SHOWN)
            problems.append(Problem(f"{path}:{number}", shown, problem))
    if problems:
        raise InvalidInputError(problems)
    return found


def _without_comment(line: str) -> str:
    """The line up to its comment; a colour may be ``"#1f77b4"``, in quotes."""
    return re.match(r"""(?:[^"'#]|"[^"]*"|'[^']*'|["'])*""", line)[0]  # type: ignore[index]


def _take(key: str, value: str, found: dict[str, object]) -> str:
    """Takes a value in; returns what is wrong with it, or nothing."""
    if key not in KEYS:
        near = near_name(key, list(KEYS))
        meant = f"did you mean '{near}'? " if near else ""
        return (
            f"is not allowed in a style file; {meant}What may be set is how text, axes, ticks, "
            "grid and legend look"
        )
    check, allowed = KEYS[key]
    got = f"got {shortened(printable(value), _SHOWN) or 'nothing'}"
    if len(value) > _MOST_LETTERS:
        return f"is longer than {_MOST_LETTERS} letters; give {allowed}"
    try:
        # Of these keys none has a check that runs what it is given.
        checked: Any = matplotlib.RcParams({key: value})
        setting = checked[key]
    except (ValueError, TypeError, SyntaxError, RecursionError, MemoryError):
        return f"must be {allowed}, {got}"
    if not check(setting):
        return f"must be {allowed}, {got}"
    if key == "font.family" or key in _FONT_LISTS:
        names = [setting] if isinstance(setting, str) else list(setting)
        problems = {name: "" if name in _GENERIC else _font_problem(name) for name in names}
        setting = [name for name, problem in problems.items() if not problem]
        if not setting:  # of several, one that is there is enough
            first = shortened(printable(names[0]), _SHOWN) if names else "no font"
            return f"{first}: {problems[names[0]] if names else f'give {allowed}'}"
    found[key] = setting
    return ""
