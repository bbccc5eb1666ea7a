"""What makes a text no YAML, in the words of who has written it."""

from __future__ import annotations

import re
import unicodedata

import yaml

_SPACES = "\u00a0\u1680\u2000-\u200a\u202f\u205f\u3000"
_UNSEEN = "\u00ad\u200b-\u200f\u2028-\u202e\u2060-\u2064\u2066-\u206f\ufeff\u0085"
_QUOTES = "\u00ab\u00bb\u2018-\u201f\u2039\u203a\uff02\uff07"
_LIKE_MARKS = {
    "\uff1a": ":", "\ufe55": ":", "\ua789": ":", "\uff0c": ",", "\ufe50": ",", "\u3001": ",",
    "\uff5b": "{", "\uff5d": "}", "\uff3b": "[", "\uff3d": "]", "\uff03": "#",
    "\u2010": "-", "\u2011": "-", "\u2012": "-", "\u2013": "-", "\u2014": "-", "\u2212": "-",
    "\uff0d": "-",
}  # fmt: skip
_ODD = re.compile(f"[{_SPACES}{_UNSEEN}{_QUOTES}{''.join(_LIKE_MARKS)}]")
_CONTROL = re.compile(r"[\x00-\x1f\x7f]")
_NAMES = {"\ufeff": "byte order mark", "\u0085": "next line", "\t": "tab", "\n": "line break"}


def odd_character(text: str) -> re.Match[str] | None:
    """The first character of a text that is easily taken for another one, or not seen."""
    return _ODD.search(text)


def odd_mark(line: str) -> re.Match[str] | None:
    """The first such character of a line of YAML that stands where its structure is written.

    Within a text or a comment they are nothing odd.
    """
    for found in _ODD.finditer(line):
        before = _ODD.sub(" ", line[: found.start()]).rstrip()
        after = _ODD.sub(" ", line[found.end() :]).lstrip()
        if " #" in f" {before}":
            return None
        if before[-1:] in ("", ":", ",", "[", "{", "-") or after[:1] in (":", ",", "]", "}"):
            return found
        if found.group() in _LIKE_MARKS and _LIKE_MARKS[found.group()] in ":,{}[]":
            return found
    return None


def told(character: str) -> str:
    """What a character is, and what to write instead, as the end of a message."""
    if _CONTROL.match(character):
        return (
            f"has a {_name(character)}, since a backslash in double quotes starts an escape; "
            "write the text in single quotes, or / instead"
        )
    return f"has a {_name(character)} (U+{ord(character):04X}); {_remedy(character)}"


def hint(text: str, *, quoted: bool) -> str:
    """What is odd in a value that is wrong, to be put behind the message; mostly nothing.

    Args:
        text: The value.
        quoted: Whether it stands in double quotes, where a backslash starts an escape.
    """
    found = _ODD.search(text) or (_CONTROL.search(text) if quoted else None)
    return "" if found is None else f"; it {told(found.group()).replace('; ', ': ')}"


def _name(character: str) -> str:
    if character in _NAMES:
        return _NAMES[character]
    return unicodedata.name(character, "control character").lower()


def _remedy(character: str) -> str:
    if character in _LIKE_MARKS:
        return f"write a plain {_LIKE_MARKS[character]}"
    if re.match(f"[{_SPACES}]", character):
        return "write a plain space"
    if re.match(f"[{_QUOTES}]", character):
        return "write plain quotes, or none"
    return "remove it" if character not in "\u2028\u2029\u0085" else "start a new line there"


_MOST_LINES = 5
SYNTAX_HELP = "check quotes, colons, brackets and indentation"
_INDENTED_BY_TAB = re.compile(r" *\t(?=\s*[^\s#])")


def explained(text: str, error: yaml.MarkedYAMLError) -> tuple[int, int, str]:
    """Where a text stops being YAML, and why.

    Args:
        text: The text.
        error: What the parser says, mostly of a place behind the culprit.

    Returns:
        Line and column, from 1, and the message.
    """
    mark = error.problem_mark or error.context_mark
    problem = error.problem or error.context or ""
    if mark is None:
        return 1, 1, f"is not valid YAML: {problem}; {SYNTAX_HELP}"
    if "escape" in problem or "hexdecimal" in problem:
        at = text.rfind("\\", 0, mark.index + 1)
        if at >= 0:
            message = "has a backslash in double quotes, where it starts an escape"
            return (*_position(text, at), f"{message}; use single quotes, or / instead")
    for start, line in _lines_before(text, error):
        tab = _INDENTED_BY_TAB.match(line)
        if tab is not None:
            place = _position(text, start + tab.end() - 1)
            return (*place, "is indented with a tab; indent with spaces")
        odd = odd_mark(line)
        if odd is not None:
            return (*_position(text, start + odd.start()), told(odd.group()))
    above = error.context_mark
    line = text[text.rfind("\n", 0, mark.index) + 1 : mark.index]
    if problem == "did not find expected key" and above and not line.strip() and len(line):
        message = f"stands in column {mark.column + 1}, where nothing above it starts"
        return mark.line + 1, mark.column + 1, f"{message}; indent it as its neighbours are"
    return mark.line + 1, mark.column + 1, f"is not valid YAML: {problem}; {SYNTAX_HELP}"


def _lines_before(text: str, error: yaml.MarkedYAMLError) -> list[tuple[int, str]]:
    """The lines that the parser may mean, with where they start, the nearest first."""
    marks = [mark.index for mark in (error.context_mark, error.problem_mark) if mark is not None]
    end = text.find("\n", max(marks))
    first = text.rfind("\n", 0, max(text.rfind("\n", 0, min(marks)), 0)) + 1
    lines, start = [], first
    for line in text[first : len(text) if end < 0 else end].split("\n"):
        lines.append((start, line))
        start += len(line) + 1
    return lines[::-1][:_MOST_LINES]


def _position(text: str, index: int) -> tuple[int, int]:
    return text.count("\n", 0, index) + 1, index - text.rfind("\n", 0, index)
