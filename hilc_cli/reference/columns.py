"""What the columns of a file with points are, and in which units: by the names in its header."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

X, Y, HEADING, SPEED, TIME, ITERATION = "x", "y", "heading", "speed", "t_s", "iteration"
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
        index: Its place in a line.
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


def _units(*units: tuple[float, str]) -> Mapping[str, tuple[str, float]]:
    """Units by their other names without spaces and strokes, the first of each as it is told."""
    return {
        name.replace("/", ""): (text.split()[0], per_unit)
        for per_unit, text in units
        for name in text.split()
    }


_LENGTH = _units(
    (1, "m meter meters metre metres"),
    (100, "cm centimeter centimeters centimetre centimetres"),
    (1e3, "mm millimeter millimeters millimetre millimetres"),
    (1e-3, "km kilometer kilometers kilometre kilometres"),
    (1 / 0.3048, "ft foot feet"),
    (1 / 0.0254, "in inch inches"),
)
_TIME = _units(
    (1, "s sec secs second seconds"),
    (1e3, "ms msec msecs millis millisec millisecs millisecond milliseconds"),
    (1e6, "us usec usecs micros microsec microsecs microsecond microseconds"),
    (1e9, "ns nsec nsecs nanos nanosec nanosecs nanosecond nanoseconds"),
    (1 / 60, "min mins minute minutes"),
    (1 / 3600, "h hr hrs hour hours"),
)
_SPEED = _units(
    (1, "m/s mps ms-1 ms^-1"),
    (100, "cm/s cmps"),
    (1e3, "mm/s mmps"),
    (3.6, "km/h kmh kph kmph kmh-1"),
    (1 / 0.44704, "mph miph"),
)
_ANGLE = _units(
    (1, "rad rads radian radians"), (180 / math.pi, "deg degs degree degrees \N{DEGREE SIGN}")
)
_CLOCKS = frozenset(name for name in _TIME if "sec" in name)
"""Units that are the whole name of a column of times."""
_EPOCHS = ((1e17, 1e9, "ns"), (1e14, 1e6, "us"), (1e11, 1e3, "ms"))
"""From these times on they are counted since 1970, and in so many parts of a second."""
_LATEST = 1e19


@dataclass(frozen=True, slots=True)
class _Role:
    """How columns of one kind are called.

    Attributes:
        names: The usual names, without a unit.
        words: First or last words of others.
        beside: Words that may stand beside those.
        units: In which it may be.
        owners: With one of these right before its last word, anything may stand before it.
    """

    names: frozenset[str]
    words: frozenset[str]
    beside: frozenset[str]
    units: Mapping[str, tuple[str, float]]
    owners: frozenset[str] = frozenset()

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


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


_OF_PLACES = _words(
    "center centre coord coordinate field gps loc local location map odom p path point points pos "
    "pose position ref transform translation utm waypoint world wp"
)
_OWNERS = _words("position translation")
_OF_SIGNALS = _words(
    "field orientation rotation pose ref target twist desired vehicle car robot ego"
)
_OF_CLOCKS = _words("elapsed epoch field header log msg ros rosbag sim stamp system unix")
_ROLES: Mapping[str, _Role] = {
    ITERATION: _Role(_words("iteration"), frozenset(), frozenset(), {}),
    X: _Role(
        _words("x posx px tx p_rs_r_x easting east rechtswert utm_e"),
        _words("x"),
        _OF_PLACES,
        _LENGTH,
        _OWNERS,
    ),
    Y: _Role(
        _words("y posy py ty p_rs_r_y northing north hochwert utm_n"),
        _words("y"),
        _OF_PLACES,
        _LENGTH,
        _OWNERS,
    ),
    HEADING: _Role(
        _words("heading theta yaw psi"), _words("heading theta yaw psi"), _OF_SIGNALS, _ANGLE
    ),
    SPEED: _Role(
        _words("speed velocity vel v vx geschwindigkeit vitesse velocidad"),
        _words("speed velocity vel v vx"),
        _OF_SIGNALS,
        _SPEED,
    ),
    TIME: _Role(
        _words("t time timestamp stamp zeit temps tiempo epoch elapsed"),
        _words("t time timestamp stamp"),
        _OF_CLOCKS,
        _TIME,
    ),
}
_SURELY_METRES = _words("easting northing rechtswert hochwert utm_e utm_n")
_BRACKETS = ("[", "{", "(", "<")
_DEGREES = _words("lat latitude lon long lng longitude")
_SIGNS = str.maketrans({"\N{MICRO SIGN}": "u", "\N{GREEK SMALL LETTER MU}": "u"})


def columns_of(names: Sequence[str]) -> list[Column]:
    """The columns that are needed of those that a header names, the iteration first.

    Speeds are not needed beside times.

    Raises:
        HeaderError: There are no columns x and y, or several, or a unit is not known.
    """
    found: dict[str, Column] = {}
    others: list[Column] = []
    for role, kind in _ROLES.items():
        ranked = sorted(_columns(role, kind, names), key=lambda each: each[0])
        if not ranked:
            continue
        best = [column for rank, column in ranked if rank == ranked[0][0]]
        if len(best) > 1 and role in (X, Y):
            raise HeaderError(f"names several columns that may be {role}; keep one of them")
        found[role] = best[0]
        others = [column for _, column in ranked] if role == TIME else others
    if X not in found or Y not in found:
        raise HeaderError(_none(names), has_columns=_are_degrees(names))
    if TIME in found or _is_component(found.get(SPEED), names):
        found.pop(SPEED, None)
    if TIME in found:
        found |= _clock(found[TIME], others)
        if not found[TIME].unit and any(name.startswith("field.") for name in names):
            # As rostopic writes the fields of a message, and all times.
            found[TIME] = replace(found[TIME], unit="ns", per_unit=1e9)
    for role in (X, Y, HEADING, SPEED, TIME):
        if role in found and found[role].per_unit == 0:
            known = list(dict.fromkeys(unit for unit, _ in _ROLES[role].units.values()))
            raise HeaderError(
                f"names a unit of {role} that is not known; give {', '.join(known[:-1])} or "
                f"{known[-1]}",
                has_columns=True,
            )
    return list(found.values())


def are_columns(names: Sequence[str]) -> bool:
    """Whether the cells of a comment tell what the columns are."""
    try:
        columns_of(names)
    except HeaderError as error:
        return error.has_columns
    return True


def is_unit(cell: str) -> bool:
    """Whether a cell holds the name of a unit, or nothing in its place."""
    unit = re.sub(r"[\s/_*.\[\]()-]", "", cell.translate(_SIGNS).lower())
    return not unit or any(unit in kind.units for kind in _ROLES.values())


def counted_since_1970(column: Column, first: float) -> Column:
    """A column of times that does not tell its unit, with the one that its first time tells."""
    if column.role != TIME or column.unit:
        return column
    for least, per_unit, unit in _EPOCHS:
        if least <= first < _LATEST:
            return replace(column, unit=unit, per_unit=per_unit)
    return column


def _columns(role: str, kind: _Role, names: Sequence[str]) -> Iterator[tuple[int, Column]]:
    """The columns that may be of one kind, each with its rank."""
    for index, name in enumerate(names):
        words, bracket = _parts(name)
        for count in range(len(words), -1, -1):
            stemmed, suffix = words[:count], "".join(words[count:])
            if suffix and suffix not in kind.units:
                continue
            if suffix and stemmed[-1:] == ["in"]:
                stemmed = stemmed[:-1]
            stem = "_".join(stemmed)
            rank = kind.rank(stemmed)
            if rank is None and role == TIME and suffix in _CLOCKS and not stem:
                rank = 0
            if rank is not None:
                unit = bracket or suffix or ("m" if stem in _SURELY_METRES else "")
                text, per_unit = kind.units.get(unit, (unit, 0.0)) if unit else ("", 1.0)
                yield rank, Column(role, index, text, per_unit, stem)
                break


def _is_component(speed: Column | None, names: Sequence[str]) -> bool:
    """Whether a speed is that along x, beside another along y."""
    if speed is None or not speed.stem.endswith("vx"):
        return False
    other = f"{speed.stem[:-1]}y"
    return any("_".join(_parts(name)[0]).startswith(other) for name in names)


def _clock(time: Column, others: Sequence[Column]) -> dict[str, Column]:
    """Seconds, and the nanoseconds that belong to them if they have a column of their own."""
    of_clock = [column for column in others if column.stem == time.stem]
    seconds = next((column for column in of_clock if column.unit == "s"), None)
    rest = next((column for column in of_clock if column.unit == "ns"), None)
    if seconds is None or rest is None:
        return {TIME: time}
    return {TIME: seconds, NANOSECONDS: replace(rest, role=NANOSECONDS)}


def _none(names: Sequence[str]) -> str:
    """What is wrong with a header, or what stands in its place, that names no columns x and y."""
    if names and names[0][:1] in _BRACKETS:
        return f"begins with a bracket, as no CSV does; save it as one with the header {HEADERS}"
    if len(names) == 1 and any(sign in names[0] for sign in "|:/&"):
        return "is parted neither by commas, semicolons nor white space; save it with commas"
    if _are_degrees(names):
        return "names latitude and longitude; project them to metres first, such as to UTM"
    return f"names no columns x and y; call them {HEADERS}"


HEADERS = "x,y (beside them heading, speed and t_s if they are known)"


def _are_degrees(names: Sequence[str]) -> bool:
    return sum(not _DEGREES.isdisjoint(_parts(name)[0]) for name in names) >= 2


def _parts(name: str) -> tuple[list[str], str | None]:
    """The words of a column's name in lower case, and its unit in brackets if it has one."""
    name = name.strip().strip("\"'").translate(_SIGNS)
    bracket = re.fullmatch(r"(.*?)\s*[\[({]([^\[\](){}]*)[\])}]", name)
    unit = None
    if bracket is not None:
        name, unit = bracket[1], re.sub(r"[\s/_*.]", "", bracket[2].lower())
    name = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name)
    return re.findall(r"[^\W_]+", name.lower()), unit
