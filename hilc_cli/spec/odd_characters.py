"""Characters that look like others: no-break spaces, curly quotes, and what is not seen at all."""

from __future__ import annotations

import re
import unicodedata

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
