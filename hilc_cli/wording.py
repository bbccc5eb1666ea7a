"""How texts are put: the word that was meant, lists and counts, what a terminal may get."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from typing import Any

_SHORT = 6
_WIDTH = 100


def suggestion(word: str, known: Iterable[str]) -> str:
    """The nearest known word as ``did you mean 'x'?``, or the list of all known words."""
    known = list(known)
    near = near_name(word, known)
    return f"did you mean '{near}'?" if near else f"known: {', '.join(sorted(known))}"


def near_name(word: str, known: Sequence[str]) -> str | None:
    """The nearest known name; if none is near, the first that has all words of what was written.

    So ``max_position_error_m`` is meant by ``max_error``.
    """
    near = near_word(word, known)
    words = set(_words(word))
    if near is None and len(words) > 1:
        near = next((each for each in known if words <= set(_words(each))), None)
    return near


def _words(name: str) -> list[str]:
    return name.lower().replace("-", "_").split("_")


def near_word(word: str, known: Iterable[str], alike: float = 0.7) -> str | None:
    """The nearest known word, if one is near.

    Case is ignored, digits are not: whoever writes ``fig2`` or ``l5`` has not mistyped ``fig8``
    or ``l1``.

    Args:
        word: What was written.
        known: The words that it may stand for.
        alike: How alike they must be, from 0 to 1, the ratio of `difflib`.
    """
    spellings = {each.lower(): each for each in sorted(known) if _digits(each) == _digits(word)}
    near = get_close_matches(word.lower(), spellings, n=1, cutoff=alike)
    if not near and len(word) <= _SHORT:  # a letter more or less makes a short word another
        close = get_close_matches(word.lower(), spellings, n=1, cutoff=0.6)
        near = [each for each in close if each[:3] == word.lower()[:3]]
    return spellings[near[0]] if near else None


def _digits(word: str) -> list[str]:
    return [letter for letter in word if letter.isdigit()]


def printable(text: str) -> str:
    """The text on one line, without characters that would steer a terminal."""
    return "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in text)


def shortened(text: str, most: int = 200) -> str:
    """The text, its end left out where it is long."""
    return text if len(text) <= most else f"{text[:most]}..."


def listed(names: Iterable[Any], most: int = 12) -> str:
    """Some names behind one another, and how many more there are."""
    texts = [str(name) for name in names]
    more = f", and {len(texts) - most} more" if len(texts) > most else ""
    return ", ".join(texts[:most]) + more


def counted(count: int, name: str) -> str:
    """``1 segment``, ``2 segments``."""
    return f"{count} {name}" if count == 1 else f"{count} {name}s"


def in_short(title: str, *lines: str) -> str:
    """What a result shows of itself: a title and lines below it, each cut where it is long."""
    texts = [title, *(f"  {line}" for line in lines)]
    return "\n".join(t if len(t) <= _WIDTH else f"{t[: _WIDTH - 3]}..." for t in texts)


def wrapped(title: str, *texts: str) -> str:
    """A title and sentences below it, each in as many lines as it needs."""
    lines = [
        textwrap.fill(text, _WIDTH, initial_indent="  ", subsequent_indent="    ") for text in texts
    ]
    return "\n".join([title, *lines])
