"""Texts of tables as LaTeX sets them: escaped, with units upright and gains as formulas."""

from __future__ import annotations

import re

_LATEX = str.maketrans(
    {
        **{character: f"\\{character}" for character in "{}$&#_%"},
        "\\": r"\textbackslash{}",
        "^": r"\textasciicircum{}",
        "~": r"\textasciitilde{}",
        "<": r"\textless{}",
        ">": r"\textgreater{}",
        "|": r"\textbar{}",
        "`": r"\textasciigrave{}",
    }
)
_SYMBOL = re.compile(r"(?P<letter>[A-Za-z])_?(?P<index>[0-9]{1,2}|[A-Za-z]|theta)?")
_GREEK = {"theta": r"\theta"}
_UNIT_PART = re.compile(r"(?P<name>[A-Za-z]{1,4})(?:\^(?P<power>-?[0-9]))?")
_SETTING = re.compile(r"(?P<name>[^=\s]+)=(?P<value>\S+)(?: (?P<unit>m|rad|s|rad/s|Hz)(?=\s|$))?")
_NUMBER = re.compile(r"(?P<mantissa>-?[0-9]+(?:\.[0-9]+)?)(?:e(?P<power>[+-]?[0-9]{1,3}))?")


def latex_escaped(text: str) -> str:
    """Any text, whose characters all stand for themselves."""
    # Two hyphens would become a dash.
    return re.sub("-(?=-)", "-{}", text.translate(_LATEX))


def latex_title(text: str) -> str:
    """A title, the unit in brackets at its end as it is set in print."""
    words, bracket, unit = text.rpartition("[")
    if not bracket or not unit.endswith("]"):
        return latex_escaped(text)
    return f"{latex_escaped(words)}[{_unit(unit[:-1])}]"


def _unit(unit: str) -> str:
    """A unit upright, its quotients as powers: rad/s becomes rad s^-1."""
    above, *below = unit.split("/")
    parts = [_UNIT_PART.fullmatch(part) for part in (*above.split(), *below)]
    if not all(parts):
        return latex_escaped(unit)
    texts = []
    for place, part in enumerate(parts):
        assert part is not None
        power = int(part["power"] or 1) * (1 if place < len(above.split()) else -1)
        texts.append(part["name"] + ("" if power == 1 else f"$^{{{power}}}$"))
    return r"\,".join(texts)


def latex_settings(text: str) -> str:
    """Symbols with their values as formulas; what has another form stays as it is, escaped."""
    parts, end = [], 0
    for found in _SETTING.finditer(text):
        parts += [latex_escaped(word) for word in text[end : found.start()].split()]
        end = found.end()
        unit = f"\\,{_unit(found['unit'])}" if found["unit"] else ""
        symbol, number = _symbol(found["name"]), _number(found["value"])
        if symbol and number:
            parts.append(f"${symbol} = {number}${unit}")
        else:
            value = f"${number}$" if number else latex_escaped(found["value"])
            parts.append(f"{latex_escaped(found['name'])} = {value}{unit}")
    parts += [latex_escaped(word) for word in text[end:].split()]
    return ", ".join(parts)


def _symbol(name: str) -> str:
    """A letter with an index, such as l_1 of l1; empty for a word."""
    found = _SYMBOL.fullmatch(name)
    if found is None:
        return ""
    index = found["index"] or ""
    index = _GREEK.get(index, index)
    return (
        f"{found['letter']}_{{{index}}}"
        if len(index) > 1
        else (f"{found['letter']}_{index}" if index else found["letter"])
    )


def _number(text: str) -> str:
    """A number within a formula; empty for what is none."""
    found = _NUMBER.fullmatch(text)
    if found is None:
        return ""
    power = f" \\times 10^{{{int(found['power'])}}}" if found["power"] else ""
    return found["mantissa"] + power
