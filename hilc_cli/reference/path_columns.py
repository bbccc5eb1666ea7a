"""Which columns of a file with points are those of a path."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from hilc_cli.reference.columns import (
    HEADING,
    ITERATION,
    OF_SIGNALS,
    POSE,
    SPEEDS,
    TIME,
    Column,
    HeaderError,
    Kind,
    X,
    Y,
    check_units,
    clock,
    ranked,
    words,
    words_of,
)

SPEED = "speed"
HEADERS = "x,y (beside them heading, speed and t_s if they are known)"

_KINDS: Mapping[str, Kind] = {
    ITERATION: Kind(words("iteration"), {}),
    **{role: POSE[role] for role in (X, Y, HEADING)},
    SPEED: Kind(
        words("speed velocity vel v vx geschwindigkeit vitesse velocidad"),
        SPEEDS,
        words("speed velocity vel v vx"),
        OF_SIGNALS,
    ),
    TIME: POSE[TIME],
}
_BRACKETS = ("[", "{", "(", "<")
_DEGREES = words("lat latitude lon long lng longitude")


def columns_of(names: Sequence[str]) -> list[Column]:
    """The columns that are needed of those that a header names, the iteration first.

    Speeds are not needed beside times.

    Raises:
        HeaderError: There are no columns x and y, or several, or a unit is not known.
    """
    found: dict[str, Column] = {}
    times: list[Column] = []
    for role, kind in _KINDS.items():
        candidates = ranked(role, kind, names)
        if not candidates:
            continue
        best = [column for rank, column in candidates if rank == candidates[0][0]]
        if len(best) > 1 and role in (X, Y):
            raise HeaderError(f"names several columns that may be {role}; keep one of them")
        found[role] = best[0]
        times = [column for _, column in candidates]  # they come last
    if X not in found or Y not in found:
        raise HeaderError(_without_points(names), has_columns=_are_degrees(names))
    if TIME in found or _is_component(found.get(SPEED), names):
        found.pop(SPEED, None)
    if TIME in found:
        found |= {column.role: column for column in clock(found[TIME], times, names)}
    check_units(found.values(), _KINDS)
    return list(found.values())


def are_columns(names: Sequence[str]) -> bool:
    """Whether the cells of a line tell what the columns are."""
    try:
        columns_of(names)
    except HeaderError as error:
        return error.has_columns
    return True


def _is_component(speed: Column | None, names: Sequence[str]) -> bool:
    """Whether a speed is that along x, beside another along y."""
    if speed is None or not speed.stem.endswith("vx"):
        return False
    other = f"{speed.stem[:-1]}y"
    return any("_".join(words_of(name)[0]).startswith(other) for name in names)


def _without_points(names: Sequence[str]) -> str:
    """What is wrong with a header, or what stands in its place, that names no columns x and y."""
    if names and names[0][:1] in _BRACKETS:
        return f"begins with a bracket, as no CSV does; save it as one with the header {HEADERS}"
    if len(names) == 1 and any(sign in names[0] for sign in "|:/&"):
        return "is parted neither by commas, semicolons nor white space; save it with commas"
    if _are_degrees(names):
        return "names latitude and longitude; project them to metres first, such as to UTM"
    return f"names no columns x and y; call them {HEADERS}"


def _are_degrees(names: Sequence[str]) -> bool:
    return sum(not _DEGREES.isdisjoint(words_of(name)[0]) for name in names) >= 2
