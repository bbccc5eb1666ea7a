"""What makes a text no YAML, in the words of who has written it."""

from __future__ import annotations

import re

import yaml

from hilc_cli.spec.odd_characters import odd_mark, told

_MOST_LINES = 5
_HELP = "check quotes, colons, brackets and indentation"
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
        return 1, 1, f"is not valid YAML: {problem}; {_HELP}"
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
    return mark.line + 1, mark.column + 1, f"is not valid YAML: {problem}; {_HELP}"


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
