"""What the columns of tables are, and in which units: by the names in their headers."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hilc_cli.reference.sampled import Floats

X, Y, HEADING, TIME, ITERATION = "x", "y", "heading", "t_s", "iteration"
NANOSECONDS = "nanoseconds"
"""What a clock adds to the whole seconds that stand in a column of their own."""


class HeaderError(ValueError):
    """A header does not say what is needed.

    Attributes:
        has_columns: Whether it is a header all the same.
    """

    def __init__(self, message: str, *, has_columns: bool = False) -> None:
        self.has_columns = has_columns
        super().__init__(message)


@dataclass(frozen=True, slots=True)
class Column:
    """A column that is read.

    Attributes:
        role: What it is.
        index: Its place in a row.
        unit: In which unit it says that it is; empty if it does not say so.
        per_unit: So many of that unit make one of hilc's.
        stem: Its name without the unit.
    """

    role: str
    index: int
    unit: str = ""
    per_unit: float = 1.0
    stem: str = ""

    @property
    def in_words(self) -> str:
        """What was read, as it is told."""
        if self.per_unit == 1:
            return self.role
        return f"{self.role} from {self.unit}"

    def converted(self, values: Floats) -> Floats:
        """Values of the column in hilc's unit; those that are too large for it are infinite."""
        with np.errstate(over="ignore"):
            converted: Floats = values / self.per_unit
        return converted


Units = Mapping[str, tuple[str, float]]
"""Units by their names without spaces and strokes: as they are told, and how many make one."""


def _units(*units: tuple[float, str]) -> Units:
    """Units by all of their names, the first of each as it is told."""
    return {
        name.replace("/", ""): (text.split()[0], per_unit)
        for per_unit, text in units
        for name in text.split()
    }


LENGTHS = _units(
    (1, "m meter meters metre metres"),
    (100, "cm centimeter centimeters centimetre centimetres"),
    (1e3, "mm millimeter millimeters millimetre millimetres"),
    (1e-3, "km kilometer kilometers kilometre kilometres"),
    (1 / 0.3048, "ft foot feet"),
    (1 / 0.0254, "in inch inches"),
)
TIMES = _units(
    (1, "s sec secs second seconds"),
    (1e3, "ms msec msecs millis millisec millisecs millisecond milliseconds"),
    (1e6, "us usec usecs micros microsec microsecs microsecond microseconds"),
    (1e9, "ns nsec nsecs nanos nanosec nanosecs nanosecond nanoseconds"),
    (1 / 60, "min mins minute minutes"),
    (1 / 3600, "h hr hrs hour hours"),
)
SPEEDS = _units(
    (1, "m/s mps ms-1 ms^-1"),
    (100, "cm/s cmps"),
    (1e3, "mm/s mmps"),
    (3.6, "km/h kmh kph kmph kmh-1"),
    (1 / 0.44704, "mph miph"),
)
ANGLES = _units(
    (1, "rad rads radian radians"), (180 / math.pi, "deg degs degree degrees \N{DEGREE SIGN}")
)
ANGULAR_SPEEDS = _units(
    (1, "rad/s rad/sec radps rads-1"),
    (180 / math.pi, "deg/s deg/sec degps degs-1 \N{DEGREE SIGN}/s"),
    (30 / math.pi, "rpm rev/min"),
    (0.5 / math.pi, "rev/s"),
)
_ALL_UNITS = (LENGTHS, TIMES, SPEEDS, ANGLES, ANGULAR_SPEEDS)
_EPOCHS = ((1e17, 1e9, "ns"), (1e14, 1e6, "us"), (1e11, 1e3, "ms"))
"""From these times on they are counted since 1970, and in so many parts of a second."""
_LATEST = 1e19


@dataclass(frozen=True, slots=True)
class Kind:
    """How columns of one kind are called.

    Attributes:
        names: The usual names, without a unit.
        units: In which it may be.
        words: First or last words of others.
        beside: Words that may stand beside those.
        owners: With one of these right before its last word, anything may stand before it.
        bare: Units that may be the whole name.
    """

    names: frozenset[str]
    units: Units
    words: frozenset[str] = frozenset()
    beside: frozenset[str] = frozenset()
    owners: frozenset[str] = frozenset()
    bare: frozenset[str] = frozenset()

    def unit(self, name: str) -> tuple[str, float]:
        """A unit as it is told, and how many of it make one of hilc's: 0 if it is not known."""
        return self.units.get(name, (name, 0.0)) if name else ("", 1.0)

    def rank(self, words: Sequence[str]) -> int | None:
        """How surely some words are a name of it, 0 the most; None if they are none."""
        if "_".join(words) in self.names:
            return 0
        if len(words) < 2:
            return None
        *before, last = words
        first, *behind = words
        is_other = (last in self.words and self.beside.issuperset(before)) or (
            first in self.words and self.beside.issuperset(behind)
        )
        is_owned = last in self.words and before[-1] in self.owners
        return 1 if is_other or is_owned else None


def words(text: str) -> frozenset[str]:
    """The words of a text."""
    return frozenset(text.split())


_OF_PLACES = words(
    "center centre coord coordinate field gps loc local location map odom p path point points pos "
    "pose position ref transform translation utm waypoint world wp"
)
_OWNERS = words("position translation")
OF_SIGNALS = words("field orientation rotation pose ref target twist desired vehicle car robot ego")
_OF_CLOCKS = words("elapsed epoch field header log msg ros rosbag sim stamp system unix")
POSE: Mapping[str, Kind] = {
    X: Kind(
        words("x posx px tx p_rs_r_x easting east rechtswert utm_e"),
        LENGTHS,
        words("x"),
        _OF_PLACES,
        _OWNERS,
    ),
    Y: Kind(
        words("y posy py ty p_rs_r_y northing north hochwert utm_n"),
        LENGTHS,
        words("y"),
        _OF_PLACES,
        _OWNERS,
    ),
    HEADING: Kind(
        words("heading theta yaw psi"), ANGLES, words("heading theta yaw psi"), OF_SIGNALS
    ),
    TIME: Kind(
        words("t time timestamp stamp zeit temps tiempo epoch elapsed"),
        TIMES,
        words("t time timestamp stamp"),
        _OF_CLOCKS,
        bare=frozenset(name for name in TIMES if "sec" in name),
    ),
}
"""How people call time and the parts of a pose."""
_SURELY_METRES = words("easting northing rechtswert hochwert utm_e utm_n")
_SIGNS = str.maketrans({"\N{MICRO SIGN}": "u", "\N{GREEK SMALL LETTER MU}": "u"})


def ranked(role: str, kind: Kind, names: Sequence[str]) -> list[tuple[int, Column]]:
    """The columns that may be of one kind, each with its rank, the surest first."""
    return sorted(_ranked(role, kind, names), key=lambda each: each[0])


def named(role: str, kind: Kind, index: int, name: str) -> Column:
    """A column of which somebody says that it is of a kind, in the unit that its name has."""
    found, bracket = words_of(name)
    suffixes = ("".join(found[count:]) for count in range(1, len(found)))
    unit = bracket or next((each for each in suffixes if each in kind.units), "")
    return Column(role, index, *kind.unit(unit))


def check_units(columns: Iterable[Column], kinds: Mapping[str, Kind]) -> None:
    """Makes sure that the units of columns are known.

    Raises:
        HeaderError: One is not.
    """
    for column in columns:
        if column.per_unit == 0:
            known = list(dict.fromkeys(unit for unit, _ in kinds[column.role].units.values()))
            raise HeaderError(
                f"names a unit of {column.role} that is not known; give {', '.join(known[:-1])} or "
                f"{known[-1]}",
                has_columns=True,
            )


def is_unit(cell: str) -> bool:
    """Whether a cell holds the name of a unit, or nothing in its place."""
    unit = re.sub(r"[\s/_*.\[\]()-]", "", cell.translate(_SIGNS).lower())
    return not unit or any(unit in units for units in _ALL_UNITS)


def clock(time: Column, others: Iterable[Column], names: Sequence[str]) -> list[Column]:
    """Times, or seconds and the nanoseconds that belong to them if those have their own column.

    Args:
        time: The column of times.
        others: Columns that may be of the same clock.
        names: Of all columns. With those of a message's fields, as rostopic writes them, it writes
            all times in nanoseconds.
    """
    of_rostopic = names[time.index] == "%time" or any(name.startswith("field.") for name in names)
    if not time.unit and of_rostopic:
        return [replace(time, unit="ns", per_unit=1e9)]
    of_clock = [column for column in others if column.stem == time.stem]
    seconds = next((column for column in of_clock if column.unit == "s"), None)
    rest = next((column for column in of_clock if column.unit == "ns"), None)
    if seconds is None or rest is None:
        return [time]
    return [seconds, replace(rest, role=NANOSECONDS)]


def whole_clock(seconds: Floats, nanoseconds: Floats) -> Floats | None:
    """Times of whole seconds and what a clock adds to them; None if they are not such.

    Args:
        seconds: Not-a-number where there is none [s], shape (m,).
        nanoseconds: The same of what is added, converted [s], shape (m,).
    """
    there = ~np.isnan(seconds)
    whole, rest = seconds[there], nanoseconds[there]
    fits = (whole == np.floor(whole)) & (rest >= 0) & (rest < 1)
    return seconds + nanoseconds if fits.all() else None


def counted_since_1970(column: Column, first: float) -> Column:
    """A column of times, in the unit that its first time tells where its name does not."""
    if column.unit:
        return column
    for least, per_unit, unit in _EPOCHS:
        if least <= first < _LATEST:
            return replace(column, unit=unit, per_unit=per_unit)
    return column


def _ranked(role: str, kind: Kind, names: Sequence[str]) -> Iterator[tuple[int, Column]]:
    """The columns that may be of one kind, each with its rank."""
    for index, name in enumerate(names):
        found, bracket = words_of(name)
        for count in range(len(found), -1, -1):
            stemmed, suffix = found[:count], "".join(found[count:])
            if suffix and suffix not in kind.units:
                continue
            if suffix and stemmed[-1:] == ["in"]:
                stemmed = stemmed[:-1]
            stem = "_".join(stemmed)
            rank = 0 if not stem and suffix in kind.bare else kind.rank(stemmed)
            if rank is not None:
                unit = bracket or suffix or ("m" if stem in _SURELY_METRES else "")
                yield rank, Column(role, index, *kind.unit(unit), stem)
                break


def words_of(name: str) -> tuple[list[str], str]:
    """The words of a column's name in lower case, and its unit in brackets if it has one."""
    name = name.strip().strip("\"'").translate(_SIGNS)
    bracket = re.fullmatch(r"(.*?)\s*[\[({]([^\[\](){}]*)[\])}]", name)
    unit = ""
    if bracket is not None:
        name, unit = bracket[1], re.sub(r"[\s/_*.]", "", bracket[2].lower())
    name = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name)
    return re.findall(r"[^\W_]+", name.lower()), unit
